//! Parting spheres at a place in their order on an axis, in time proportional to their number.
//!
//! A histogram over [`BINS`] intervals says in which of them the place is, and so on in that one; only
//! when spheres are few are they ordered. All of it is done in place, and by many threads where there is much of it.

use super::item::{AXES, Extent, Item, along, spread};
use glam::Vec4;
use rayon::prelude::*;

/// Number of bins of an axis.
pub(super) const BINS: usize = 16;

/// Number of spheres that are worth a task; independent of the number of threads.
const CHUNK: usize = 1 << 14;

/// Intervals of equal width on every axis, over the spread of some spheres' centers and radii.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) spread: Extent,
    scale: Vec4,
}

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
        let scale = Vec4::splat(BINS as f32) / (spread.high - spread.low);
        Self { spread, scale: scale.min(Vec4::splat(f32::MAX)) }
    }

    /// Returns the extent of the spheres' centers.
    pub(super) fn width(&self) -> Vec4 {
        self.spread.high - self.spread.low
    }

    /// Returns the bin of a sphere on each axis.
    #[inline(always)]
    pub(super) fn bins(&self, item: &Item) -> [usize; AXES] {
        let place = (item.vector() - self.spread.low) * self.scale;
        let last = Vec4::splat((BINS - 1) as f32);
        place.min(last).to_array().map(|bin| bin as usize % BINS)
    }

    /// Counts the spheres in each bin of an axis.
    pub(super) fn count(&self, items: &[Item], axis: usize) -> [usize; BINS] {
        let count = |items: &[Item]| {
            let mut counts = [0; BINS];
            for item in items {
                counts[self.bins(item)[axis]] += 1;
            }
            counts
        };
        if items.len() <= CHUNK {
            return count(items);
        }
        let sum = |a: [usize; BINS], b: [usize; BINS]| std::array::from_fn(|i| a[i] + b[i]);
        items.par_chunks(CHUNK).map(count).reduce(|| [0; BINS], sum)
    }

    /// Puts the first `place` spheres on an axis before all others; `counts` is how many are in
    /// each of its intervals.
    pub(super) fn part(
        &self,
        items: &mut [Item],
        axis: usize,
        counts: &[usize; BINS],
        place: usize,
    ) {
        let (mut bin, mut below) = (0, 0);
        while bin < BINS - 1 && below + counts[bin] <= place {
            below += counts[bin];
            bin += 1;
        }
        partition(items, |item| self.bins(item)[axis] < bin);
        if below < place {
            let rest = &mut items[below..];
            partition(rest, |item| self.bins(item)[axis] == bin);
            part_some(&mut rest[..counts[bin]], axis, place - below);
        }
    }
}

/// Partitions the spheres of one bin: with all threads and bins of its own if they are many.
fn part_some(items: &mut [Item], axis: usize, place: usize) {
    if items.len() > CHUNK {
        let grid = Grid::over(items);
        let counts = grid.count(items, axis);
        if counts.iter().all(|&count| count < items.len()) {
            return grid.part(items, axis, &counts, place);
        }
    }
    items.select_nth_unstable_by(place, |a, b| along(axis, a, b));
}

/// Puts what satisfies a condition first; returns how many do.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool + Sync) -> usize {
    if items.len() <= CHUNK {
        return partition_chunk(items, &first);
    }
    let counts: Vec<usize> =
        items.par_chunks_mut(CHUNK).map(|chunk| partition_chunk(chunk, &first)).collect();
    let total = counts.iter().sum();
    let (mut ahead, mut behind) = misplaced(items, &counts, total);
    let mut swaps = Vec::new();
    while let (Some(a), Some(b)) = (ahead.pop(), behind.pop()) {
        let length = a.len().min(b.len());
        let ((a, rest_a), (b, rest_b)) = (a.split_at_mut(length), b.split_at_mut(length));
        swaps.push((a, b));
        ahead.extend((!rest_a.is_empty()).then_some(rest_a));
        behind.extend((!rest_b.is_empty()).then_some(rest_b));
    }
    swaps.into_par_iter().for_each(|(a, b)| a.swap_with_slice(b));
    total
}

/// Partitions few spheres, without a branch on the condition, which is hard to predict.
fn partition_chunk(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        let is_first = first(&items[i]);
        items.swap(i, count);
        count += usize::from(is_first);
    }
    count
}

/// Returns the parts of chunks that are on the wrong side of `total`: as many before as after it.
fn misplaced<'a>(
    mut items: &'a mut [Item],
    counts: &[usize],
    total: usize,
) -> (Vec<&'a mut [Item]>, Vec<&'a mut [Item]>) {
    let (mut ahead, mut behind) = (Vec::new(), Vec::new());
    let mut start = 0;
    for &count in counts {
        let (chunk, rest) = items.split_at_mut(CHUNK.min(items.len()));
        items = rest;
        let end = start + chunk.len();
        let border = total.clamp(start, end) - start;
        if border > count {
            ahead.push(&mut chunk[count..border]);
        } else if border < count {
            behind.push(&mut chunk[border..count]);
        }
        start = end;
    }
    (ahead, behind)
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
                let mut parted = items.clone();
                let grid = Grid::over(&parted);
                let counts = grid.count(&parted, axis);
                grid.part(&mut parted, axis, &counts, place);
                parted[..place].sort_by(|a, b| along(axis, a, b));
                parted[place..].sort_by(|a, b| along(axis, a, b));
                assert!(parted == sorted, "{name}, {count}, axis {axis} at {place}");
            }
        }
    }
}
