//! Builds along the Morton curve: one sort by Morton codes, then cuts where their highest bits change.
//!
//! A part is cut where the highest bit changes in which its spheres' places on the curve differ
//! (Lauterbach, Garland, Sengupta, Luebke, Manocha, "Fast BVH Construction on GPUs", Eurographics
//! 2009), moved to the next multiple of a leaf. Where all are at one place it is halved.

use super::cut::{Cut, snapped};
use super::item::{Extent, Item, along, spread};
use super::median::Median;
use super::segment::Segment;
use super::tasks::collected;
use crate::radix::{sort_by_digits, spaced};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Bits of a place on the curve, of each axis.
const BITS: u32 = 10;

/// Stretches of the curve into which spheres are put before each is sorted for itself, in memory that
/// is near. Cubes, eight along each axis.
const STRETCHES: usize = 512;

/// Number of spheres that are worth a task.
const CHUNK: usize = 1 << 14;

/// With fewer keys comparing them is faster, and with more on one stretch there may be no work for
/// other threads but on them.
const BY_DIGITS: Range<usize> = 1 << 10..1 << 18;

/// Cuts along the curve.
pub(super) struct Morton {
    /// Each sphere's place on the curve.
    codes: Vec<u32>,
    median: Median,
}

impl Morton {
    /// Puts spheres into the order on the curve; and memory that is not needed any more.
    pub(super) fn sort(items: &mut [Item]) -> (Self, Vec<Item>) {
        let cells = Cells::over(items);
        let mut codes = collected(items.len(), |_| 0);
        // One stretch, whose keys are compared.
        if items.len() < BY_DIGITS.start {
            let spare = items.to_vec();
            cells.sort(&spare, items, &mut codes);
            return (Self { codes, median: Median::default() }, spare);
        }
        let (mut spare, counts) = cells.spread_out(items);
        let (mut to, mut from, mut to_codes) = (items, &mut *spare, &mut *codes);
        let mut stretches = Vec::with_capacity(STRETCHES);
        for count in counts.into_iter().filter(|&count| count > 0) {
            let stretch = (to.split_off_mut(..count), from.split_off_mut(..count));
            stretches.extend(stretch.0.zip(stretch.1).zip(to_codes.split_off_mut(..count)));
        }
        let sort = |((to, from), codes): ((&mut _, &mut _), &mut _)| cells.sort(from, to, codes);
        stretches.into_par_iter().for_each(sort);
        (Self { codes, median: Median::default() }, spare)
    }
}

impl Cut for Morton {
    fn cut(&self, segment: &mut Segment, first: usize) -> usize {
        let codes = &self.codes[first..first + segment.len()];
        let differ = codes[0] ^ codes[codes.len() - 1];
        if differ == 0 {
            return self.median.cut(segment, first);
        }
        let bit = 1 << differ.ilog2();
        let place = codes.partition_point(|code| code & bit == 0);
        snapped(place, segment.len())
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
        let width = all.size().truncate().max_element();
        Self { low: all.low().truncate(), scale: ((1 << BITS) as f32 / width).min(f32::MAX) }
    }

    /// The place on the curve of a sphere's center.
    #[inline(always)]
    fn code(&self, item: &Item) -> u32 {
        let place = (item.vector().truncate() - self.low) * self.scale;
        let last = ((1 << BITS) - 1) as f32;
        let [x, y, z] = place.to_array().map(|cell| spaced(cell.min(last) as u32));
        x | y << 1 | z << 2
    }

    /// On which stretch of the curve it is.
    #[inline(always)]
    fn stretch(&self, item: &Item) -> usize {
        self.code(item) as usize / ((1 << (3 * BITS)) / STRETCHES) % STRETCHES
    }

    /// The spheres stretch by stretch, and how many are on each.
    fn spread_out(&self, items: &[Item]) -> (Vec<Item>, Vec<usize>) {
        let count = |items: &[Item]| {
            let mut counts = vec![0_u32; STRETCHES];
            for item in items {
                counts[self.stretch(item)] += 1;
            }
            counts
        };
        let counts: Vec<_> = items.par_chunks(CHUNK).map(count).collect();
        // Any values will do, written by all threads, for the system to give the memory to all.
        let mut spread: Vec<_> = items.par_iter().with_min_len(CHUNK).copied().collect();
        let mut places: Vec<_> = counts.iter().map(|_| Vec::with_capacity(STRETCHES)).collect();
        let (mut rest, mut sums) = (&mut *spread, vec![0; STRETCHES]);
        for (stretch, sum) in sums.iter_mut().enumerate() {
            for (places, counts) in places.iter_mut().zip(&counts) {
                let count = counts[stretch] as usize;
                places.push(rest.split_off_mut(..count).unwrap_or_default().iter_mut());
                *sum += count;
            }
        }
        items.par_chunks(CHUNK).zip(places).for_each(|(items, mut places)| {
            for item in items {
                if let Some(place) = places[self.stretch(item)].next() {
                    *place = *item;
                }
            }
        });
        (spread, sums)
    }

    /// Puts the spheres of a stretch into the order on the curve.
    fn sort(&self, from: &[Item], to: &mut [Item], codes: &mut [u32]) {
        // The place on the curve in the upper half, and in the lower one the row.
        let key = |(row, item): (usize, &Item)| u64::from(self.code(item)) << 32 | row as u64;
        let keys = from.par_iter().with_min_len(CHUNK).enumerate().map(key);
        let mut keys: Vec<u64> = keys.collect();
        match keys.len() {
            count if BY_DIGITS.contains(&count) => {
                sort_by_digits(&mut keys, &mut Vec::new(), 32, 2);
            }
            _ => keys.par_sort_unstable(),
        }
        let item = |key: u64| &from[key as u32 as usize];
        // What is at one place has been ordered by the row, which is to mean nothing.
        let runs = keys.par_chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|run| run.len() > 1);
        runs.for_each(|run| run.sort_unstable_by(|&a, &b| along(0, item(a), item(b))));
        let to = to.par_iter_mut().zip(codes).zip(keys).with_min_len(CHUNK);
        to.for_each(|((to, code), key)| (*to, *code) = (*item(key), (key >> 32) as u32));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::numbered;

    #[test]
    fn spheres_are_sorted_by_morton_code() {
        // All over the curve, most of them on one stretch, all at one place.
        let scenes = [1, 9, 200]
            .into_iter()
            .flat_map(|power| [900, 3000, 70_000].map(|count| (power, count)));
        for (power, count) in scenes {
            let number = |i, axis| numbered(i, axis).powi(power);
            let sphere = |i| std::array::from_fn(|axis| number(i, axis as u64));
            let mut items: Vec<_> =
                (0..count).map(|id| Item { sphere: sphere(u64::from(id) / 2), id }).collect();
            let cells = Cells::over(&items);
            let mut sorted = items.clone();
            sorted.sort_by(|a, b| cells.code(a).cmp(&cells.code(b)).then(along(0, a, b)));
            let (morton, _) = Morton::sort(&mut items);
            assert!(items == sorted, "{power}, {count}");
            assert!(morton.codes.into_iter().eq(items.iter().map(|item| cells.code(item))));
        }
    }
}
