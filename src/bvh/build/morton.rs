//! Along Morton's curve, which fills space: one sort, and then there is next to nothing to decide.
//!
//! A part is cut where the highest bit changes in which its spheres' places on the curve differ
//! (Lauterbach, Garland, Sengupta, Luebke, Manocha, "Fast BVH Construction on GPUs", Eurographics
//! 2009), moved to the next multiple of a leaf. Where all are at one place it is halved.

use super::item::{Extent, Item, along, spread};
use super::median::Median;
use super::{Cut, snapped};
use glam::Vec3;
use rayon::prelude::*;

/// Bits of a place on the curve, of each axis.
const BITS: u32 = 10;

/// So many spheres are worth a task.
const CHUNK: usize = 1 << 14;

/// Cuts along the curve.
pub(super) struct Morton {
    /// In the order on the curve: each sphere's place on it in the upper half, and in the lower one
    /// the row that it had before.
    keys: Vec<u64>,
    median: Median,
}

impl Morton {
    /// Puts spheres into the order on the curve.
    pub(super) fn sort(items: &mut Vec<Item>) -> Self {
        let cells = Cells::over(items);
        let key = |(row, item): (usize, &Item)| u64::from(cells.code(item)) << 32 | row as u64;
        let mut keys: Vec<u64> = items.par_iter().enumerate().map(key).collect();
        keys.par_sort_unstable();
        let item = |key: u64| &items[key as u32 as usize];
        // What is at one place has been ordered by the row, which is to mean nothing.
        let runs = keys.par_chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|run| run.len() > 1);
        runs.for_each(|run| run.sort_unstable_by(|&a, &b| along(0, item(a), item(b))));
        *items = keys.par_iter().map(|&key| *item(key)).collect();
        Self { keys, median: Median::default() }
    }
}

impl Cut for Morton {
    fn cut(&self, items: &mut [Item], first: usize) -> usize {
        let keys = &self.keys[first..first + items.len()];
        let differ = (keys[0] ^ keys[keys.len() - 1]) >> 32;
        if differ == 0 {
            return self.median.cut(items, first);
        }
        let bit = 1 << (32 + differ.ilog2());
        let place = keys.partition_point(|key| key & bit == 0);
        snapped(place, items.len())
    }

    fn median(&self) -> &Median {
        &self.median
    }
}

/// Cubes that hold the centers.
struct Cells {
    low: Vec3,
    /// One for all axes, so flat scenes are not cut flatter.
    scale: f32,
}

impl Cells {
    fn over(items: &[Item]) -> Self {
        let all = items.par_chunks(CHUNK).map(spread).reduce(|| Extent::EMPTY, |a, b| a.union(&b));
        let width = (all.high - all.low).truncate().max_element();
        Self { low: all.low.truncate(), scale: ((1 << BITS) as f32 / width).min(f32::MAX) }
    }

    /// The place on the curve of a sphere's center.
    #[inline(always)]
    fn code(&self, item: &Item) -> u32 {
        let place = (item.vector().truncate() - self.low) * self.scale;
        let last = ((1 << BITS) - 1) as f32;
        let [x, y, z] = place.to_array().map(|cell| spaced(cell.min(last) as u32));
        x | y << 1 | z << 2
    }
}

/// The lowest ten bits with two zeros above each.
#[inline(always)]
fn spaced(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
