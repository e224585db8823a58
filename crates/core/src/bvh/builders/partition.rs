//! Parting spheres at a place in their order on an axis, in time proportional to their number.
//!
//! A histogram over [`BINS`] intervals says in which of them the place is, and so on in that one; only
//! when spheres are few are they ordered. Many threads do it where there is much of it.

use super::item::{AXES, Extent, Item, along, spread};
use super::segment::Segment;
use glam::Vec4;
use rayon::prelude::*;

/// Number of bins of an axis.
pub(super) const BINS: usize = 16;

/// Number of spheres that are worth a task; independent of the number of threads.
pub(super) const CHUNK: usize = 1 << 14;

/// Number of spheres in each bin of an axis.
pub(super) type Counts = [u32; BINS];

/// Number of spheres in each bin of an axis, of all spheres and of each chunk of them.
pub(super) struct BinCounts {
    pub(super) all: Counts,
    /// Empty if there is one.
    pub(super) chunks: Vec<Counts>,
}

/// Intervals of equal width on every axis, over the spread of some spheres' centers and radii.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) spread: Extent,
    low: Vec4,
    scale: Vec4,
}

/// With fewer spheres comparing them is faster.
const FEW: usize = 256;

/// Adding this to a number up to [`BINS`] moves its integer part to [`BIN_SHIFT`] in its bits; rounding to the
/// 2048th part does not matter. (Conversions to integers take care of what does not occur here.)
const BIN_OFFSET: f32 = (1 << (f32::MANTISSA_DIGITS - 1 - BIN_SHIFT)) as f32;

/// Place of the integer part.
const BIN_SHIFT: u32 = 11;

impl Grid {
    pub(super) fn over(items: &[Item]) -> Self {
        let spread = if items.len() <= CHUNK {
            spread(items)
        } else {
            let all = items.par_chunks(CHUNK).map(spread);
            all.reduce(|| Extent::EMPTY, |a, b| a.union(&b))
        };
        // Where the width is so small that this is infinite, or 0, there are fewer intervals, or
        // one.
        let scale = Vec4::splat(BINS as f32) / spread.size();
        Self { spread, low: spread.low(), scale: scale.min(Vec4::splat(f32::MAX)) }
    }

    /// Returns the bin of a sphere on each axis.
    #[inline(always)]
    pub(super) fn bins(&self, item: &Item) -> [usize; AXES] {
        let place = (item.vector() - self.low) * self.scale;
        let last = Vec4::splat((BINS - 1) as f32);
        let shifted = place.min(last) + Vec4::splat(BIN_OFFSET);
        shifted.to_array().map(|place| (place.to_bits() >> BIN_SHIFT) as usize % BINS)
    }

    /// Returns the bin of a sphere on one axis.
    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let place = (item.sphere[axis] - self.low[axis]) * self.scale[axis];
        let shifted = place.min((BINS - 1) as f32) + BIN_OFFSET;
        (shifted.to_bits() >> BIN_SHIFT) as usize % BINS
    }

    /// Counts the spheres in each bin of an axis.
    pub(super) fn count(&self, items: &[Item], axis: usize) -> BinCounts {
        let count = |items: &[Item]| {
            let mut counts = [0; BINS];
            for item in items {
                counts[self.bin(item, axis)] += 1;
            }
            counts
        };
        if items.len() <= CHUNK {
            return BinCounts { all: count(items), chunks: Vec::new() };
        }
        let chunks: Vec<_> = items.par_chunks(CHUNK).map(count).collect();
        let all = std::array::from_fn(|bin| chunks.iter().map(|counts| counts[bin]).sum());
        BinCounts { all, chunks }
    }

    /// Puts the first `place` spheres on an axis before all others; `counts` is how many are in
    /// each of its intervals.
    pub(super) fn part(
        &self,
        segment: &mut Segment,
        axis: usize,
        counts: &BinCounts,
        place: usize,
    ) {
        if segment.spare.is_empty() {
            let mut spare = segment.items.to_vec();
            let mut all = Segment::new(segment.items, &mut spare);
            self.part(&mut all, axis, counts, place);
            all.settle();
            return;
        }
        let (mut bin, mut below) = (0, 0);
        while bin < BINS - 1 && below + counts.all[bin] as usize <= place {
            below += counts.all[bin] as usize;
            bin += 1;
        }
        let inside = below..below + counts.all[bin] as usize;
        // Before the bin, in it, or behind it.
        let side = |item: &Item| {
            let of_item = self.bin(item, axis);
            usize::from(of_item >= bin) + usize::from(of_item > bin)
        };
        let (before, spare) = segment.spare.split_at_mut(inside.start);
        let (within, behind) = spare.split_at_mut(inside.len());
        let mut places = [before, within, behind];
        if counts.chunks.is_empty() {
            distribute(segment.items, places, side);
        } else {
            let taken = |counts: &Counts| {
                let [below, above] = [&counts[..bin], &counts[bin + 1..]];
                let mut counts = [below, &counts[bin..=bin], above].into_iter();
                places.each_mut().map(|places| {
                    let count = counts.next().map_or(0, |counts| counts.iter().sum::<u32>());
                    places.split_off_mut(..count as usize).unwrap_or_default()
                })
            };
            let places: Vec<_> = counts.chunks.iter().map(taken).collect();
            let chunks = segment.items.par_chunks(CHUNK).zip(places);
            chunks.for_each(|(items, places)| distribute(items, places, side));
        }
        segment.exchange();
        if below < place {
            let (items, spare) = (&mut segment.items[inside.clone()], &mut segment.spare[inside]);
            part_some(Segment::new(items, spare), axis, place - below);
        }
    }
}

/// Parts the spheres of one bin: with all threads and bins of its own if they are many.
fn part_some(mut segment: Segment, axis: usize, place: usize) {
    if segment.len() > FEW {
        let grid = Grid::over(segment.items);
        let counts = grid.count(segment.items, axis);
        if counts.all.iter().all(|&count| (count as usize) < segment.len()) {
            grid.part(&mut segment, axis, &counts, place);
            segment.settle();
            return;
        }
    }
    segment.items.select_nth_unstable_by(place, |a, b| along(axis, a, b));
}

/// Writes each of some spheres to the one of three places that `side` tells, without a branch on it, which is hard to
/// predict.
fn distribute(items: &[Item], places: [&mut [Item]; 3], side: impl Fn(&Item) -> usize) {
    let mut places = places.map(|places| places.iter_mut());
    for item in items {
        if let Some(place) = places[side(item)].next() {
            *place = *item;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::numbered;

    type Values = fn(f32) -> f32;

    fn items(count: u64, value: impl Fn(f32) -> f32) -> Vec<Item> {
        let number = |i, axis| value(numbered(i, axis));
        let item =
            |i| Item { sphere: std::array::from_fn(|axis| number(i, axis as u64)), id: i as u32 };
        (0..count).map(item).collect()
    }

    #[test]
    fn the_lowest_on_an_axis_come_first() {
        let values: [(&str, Values); 5] = [
            ("even", |u| u),
            ("skewed", |u| (-200.0 * u).exp()),
            ("few", |u| (4.0 * u).floor()),
            ("equal", |_| 0.5),
            ("denormal", |u| f32::from_bits((u * 9.0) as u32)),
        ];
        for ((name, value), count) in values.into_iter().flat_map(|v| [(v, 900), (v, 70_000)]) {
            let items = items(count, value);
            for (axis, place) in (0..AXES).flat_map(|axis| [(axis, 8), (axis, 600)]) {
                let mut sorted = items.clone();
                sorted.sort_by(|a, b| along(axis, a, b));
                let (mut parted, mut spare) = (items.clone(), items.clone());
                let grid = Grid::over(&parted);
                let counts = grid.count(&parted, axis);
                for spare in [&mut *spare, &mut []] {
                    parted.copy_from_slice(&items);
                    let mut segment = Segment::new(&mut parted, spare);
                    grid.part(&mut segment, axis, &counts, place);
                    segment.settle();
                    parted[..place].sort_by(|a, b| along(axis, a, b));
                    parted[place..].sort_by(|a, b| along(axis, a, b));
                    assert!(parted == sorted, "{name}, {count}, axis {axis} at {place}");
                }
            }
        }
    }
}
