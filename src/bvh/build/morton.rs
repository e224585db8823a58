//! Along Morton's curve, which fills space: one sort, and then there is next to nothing to decide.
//!
//! A part is cut where the highest bit changes in which its spheres' places on the curve differ
//! (Lauterbach, Garland, Sengupta, Luebke, Manocha, "Fast BVH Construction on GPUs", Eurographics
//! 2009), moved to the next multiple of a leaf. Where all are at one place it is halved.

use super::Cut;
use super::item::{Extent, Item, along, spread};
use super::median::Median;
use crate::spheres::LEAF;
use glam::Vec3;
use rayon::prelude::*;

/// Bits of a place on the curve, of each axis.
const BITS: u32 = 10;

/// So many spheres are worth a task.
const CHUNK: usize = 1 << 14;

/// Cuts along the curve; the spheres are in its order.
pub(super) struct Morton {
    low: Vec3,
    scale: f32,
    median: Median,
}

impl Morton {
    /// Puts spheres into the order on the curve.
    pub(super) fn sort(items: &mut Vec<Item>) -> Self {
        let all = items.par_chunks(CHUNK).map(spread).reduce(|| Extent::EMPTY, |a, b| a.union(&b));
        // All axes have one scale: cells are cubes, so flat scenes are not cut flatter.
        let width = (all.high - all.low).truncate().max_element();
        let scale = ((1 << BITS) as f32 / width).min(f32::MAX);
        let morton = Self { low: all.low.truncate(), scale, median: Median::default() };
        let key = |(row, item): (usize, &Item)| u64::from(morton.code(item)) << 32 | row as u64;
        let mut keys: Vec<u64> =
            items.par_iter().enumerate().map(|(i, item)| key((i, item))).collect();
        keys.par_sort_unstable();
        let mut sorted: Vec<_> = keys.par_iter().map(|&key| items[key as u32 as usize]).collect();
        drop(keys);
        // What is at one place has been ordered by the row, which is to mean nothing.
        let runs = sorted.par_chunk_by_mut(|a, b| morton.code(a) == morton.code(b));
        runs.filter(|run| run.len() > 1)
            .for_each(|run| run.sort_unstable_by(|a, b| along(0, a, b)));
        *items = sorted;
        morton
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

impl Cut for Morton {
    fn cut(&self, items: &mut [Item]) -> usize {
        let (first, last) = (self.code(&items[0]), self.code(&items[items.len() - 1]));
        if first == last {
            return self.median.cut(items);
        }
        let bit = 1 << (first ^ last).ilog2();
        let place = items.partition_point(|item| self.code(item) & bit == 0);
        let whole = (items.len() - 1) / LEAF;
        ((place + LEAF / 2) / LEAF).clamp(1, whole) * LEAF
    }

    fn median(&self) -> &Median {
        &self.median
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
