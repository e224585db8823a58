//! The surface-area heuristic where spheres are few: all multiples of a leaf on every axis are
//! tried.
//!
//! The spheres are ordered once on each axis; parts keep the order.

use super::branch::{Branch, Top};
use super::cut::CROWD;
use super::item::{AXES, Extent, Item, along, spread};
use super::segment::Segment;
use super::surface_area::axes;
use crate::bvh::WIDTH;
use crate::spheres::LEAF;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Number of spheres up to which every cut is tried.
pub(super) const SWEEP: usize = 256;

/// Weight of a node of leaves beside that of a leaf. More than its time, which is about the same:
/// what is measured best over all scenes, between 1 and 16 nearly the same.
const NODE: f32 = 4.0;

/// Leaves of [`SWEEP`] spheres.
const LEAVES: usize = SWEEP / LEAF;

/// The cost of leaves and of the nodes that they fill, by number of leaves: a node that is not full is visited as often as
/// a full one.
const WEIGHT: [f32; LEAVES + 1] = {
    let (mut weight, mut leaves) = ([0.0; LEAVES + 1], 0);
    while leaves <= LEAVES {
        weight[leaves] = leaves as f32 + NODE * leaves.div_ceil(WIDTH) as f32;
        leaves += 1;
    }
    weight
};

/// Intervals of an axis into which keys are put before neighbors are exchanged.
const BUCKETS: usize = 256;

/// Adding this to a number up to [`BUCKETS`] rounds it to an integer, the lowest bits of the sum.
const BUCKET_OFFSET: f32 = (1_u32 << (f32::MANTISSA_DIGITS - 1)) as f32;

/// With more keys than this in an interval another sort is faster.
const CROWDED: u16 = 16;

/// Spheres in their order on each axis.
struct Sweep {
    items: Vec<Item>,
    /// Their boxes.
    extent: [Extent; SWEEP],
    /// By axis: places in `items`, which is in the order on the first one.
    order: [[u8; SWEEP]; AXES],
    /// By axis: the boxes of leaves in that order, while a part has more than two.
    leaf: [[Extent; LEAVES]; AXES],
    axes: usize,
    /// By place in `items`: whether it is in the second part. Of use only while parting.
    behind: [bool; SWEEP],
    /// The second part. Of use only while parting.
    later: [u8; SWEEP],
}

/// Makes the branches over at most [`SWEEP`] items; tells if they are a crowd about one center.
pub(super) fn grow(segment: Segment, branches: &mut [Branch], crowded: &AtomicBool) -> Top {
    let spread = spread(segment.items);
    if segment.len() >= CROWD && spread.size().truncate().max_element() <= 0.0 {
        crowded.store(true, Relaxed);
    }
    let mut sweep = Sweep::over(segment.items, &spread);
    let top = sweep.grow(0..segment.len(), 0, branches);
    for (item, &from) in segment.destination().iter_mut().zip(&sweep.order[0]) {
        *item = sweep.items[from as usize];
    }
    top
}

impl Sweep {
    fn over(items: &[Item], spread: &Extent) -> Self {
        let (axes, items) = (axes(spread), sorted(items, spread));
        let mut sweep = Self {
            items,
            extent: [Extent::EMPTY; SWEEP],
            order: [[0; SWEEP]; AXES],
            leaf: [[Extent::EMPTY; LEAVES]; AXES],
            axes,
            behind: [false; SWEEP],
            later: [0; SWEEP],
        };
        for (extent, item) in sweep.extent.iter_mut().zip(&sweep.items) {
            *extent = Extent::of(item);
        }
        for axis in 0..axes {
            let places = &mut sweep.order[axis];
            if axis == 0 {
                *places = std::array::from_fn(|i| i as u8);
            } else {
                let keys = &mut [0; SWEEP];
                let keys = sorted_keys(axis, &sweep.items, spread, keys);
                for (place, key) in places.iter_mut().zip(keys) {
                    *place = *key as u8;
                }
            }
            sweep.measure_leaves(axis, 0..sweep.items.len());
        }
        sweep
    }

    /// Makes the branches over the items in a range, whose leaves on `axis` are measured.
    fn grow(&mut self, rows: Range<usize>, axis: usize, branches: &mut [Branch]) -> Top {
        let Some((root, rest)) = branches.split_first_mut() else {
            return Top::leaf(&self.leaf[axis][rows.start / LEAF]);
        };
        let (axis, first) = self.best(&rows);
        let border = rows.start + first * LEAF;
        self.part(axis, rows.clone(), border);
        let (left, right) = rest.split_at_mut(first - 1);
        let a = self.grow(rows.start..border, axis, left);
        let b = self.grow(border..rows.end, axis, right);
        *root = Branch { top: Top::join(&a, &b), first: first as u32 };
        root.top
    }

    /// The axis and the number of leaves of the cheapest first part.
    fn best(&self, rows: &Range<usize>) -> (usize, usize) {
        let leaves = rows.start / LEAF..rows.end.div_ceil(LEAF);
        let all = &self.leaf[0][leaves.clone()];
        let unit = all.iter().fold(Extent::EMPTY, |all, leaf| all.union(leaf)).unit();
        let mut best = (f32::INFINITY, 0, leaves.len() / 2);
        let mut costs = [0.0; LEAVES];
        for axis in 0..self.axes {
            let leaf = &self.leaf[axis][leaves.clone()];
            let mut above = Extent::EMPTY;
            for first in (1..leaf.len()).rev() {
                above = above.union(&leaf[first]);
                costs[first] = above.half_area(unit) * WEIGHT[leaf.len() - first];
            }
            let mut below = Extent::EMPTY;
            for first in 1..leaf.len() {
                below = below.union(&leaf[first - 1]);
                let cost = below.half_area(unit) * WEIGHT[first] + costs[first];
                if cost < best.0 {
                    best = (cost, axis, first);
                }
            }
        }
        (best.1, best.2)
    }

    /// Puts what comes before `border` on an axis before it on all.
    fn part(&mut self, axis: usize, rows: Range<usize>, border: usize) {
        for (place, &i) in self.order[axis][rows.clone()].iter().enumerate() {
            self.behind[i as usize] = rows.start + place >= border;
        }
        // Of two leaves only the order on the first axis is needed, in which they are in the tree.
        let are_leaves = rows.len() <= 2 * LEAF;
        let others = if are_leaves { 1 } else { self.axes };
        for other in (0..others).filter(|&other| other != axis) {
            let order = &mut self.order[other][rows.clone()];
            let (mut first, mut second) = (0, 0);
            for place in 0..order.len() {
                let i = order[place];
                let is_behind = self.behind[i as usize];
                order[first] = i;
                self.later[second % SWEEP] = i;
                first += usize::from(!is_behind);
                second += usize::from(is_behind);
            }
            order[first..].copy_from_slice(&self.later[..second]);
            if !are_leaves {
                self.measure_leaves(other, rows.clone());
            }
        }
    }

    /// Measures the boxes of leaves in their order on an axis.
    fn measure_leaves(&mut self, axis: usize, rows: Range<usize>) {
        let leaves = rows.start / LEAF..rows.end.div_ceil(LEAF);
        let places = self.order[axis][rows].chunks(LEAF);
        for (leaf, places) in self.leaf[axis][leaves].iter_mut().zip(places) {
            let around = |all: Extent, &i: &u8| all.union(&self.extent[i as usize]);
            // All but the last of a tree are full.
            *leaf = match <&[u8; LEAF]>::try_from(places) {
                Ok(full) => full.iter().fold(Extent::EMPTY, around),
                Err(_) => places.iter().fold(Extent::EMPTY, around),
            };
        }
    }
}

/// Returns sort keys in their order: an item's coordinate on an axis in the upper half, its place in the lower half.
fn sorted_keys<'a>(
    axis: usize,
    items: &[Item],
    spread: &Extent,
    sorted: &'a mut [u64; SWEEP],
) -> &'a mut [u64] {
    let (low, size) = (spread.low()[axis], spread.size()[axis]);
    let scale = ((BUCKETS - 1) as f32 / size).min(f32::MAX);
    let bucket = |item: &Item| {
        let place = (item.sphere[axis] - low) * scale;
        (place + BUCKET_OFFSET).to_bits() as usize % BUCKETS
    };
    let key = |i: usize, item: &Item| u64::from(ordered(item.sphere[axis])) << 32 | i as u64;
    let mut counts = [0_u16; BUCKETS];
    for item in items {
        counts[bucket(item)] += 1;
    }
    let (mut below, mut most) = (0, 0);
    for count in &mut counts {
        most = most.max(*count);
        below += std::mem::replace(count, below);
    }
    for (i, item) in items.iter().enumerate() {
        let place = &mut counts[bucket(item)];
        sorted[*place as usize % SWEEP] = key(i, item);
        *place += 1;
    }
    let sorted = &mut sorted[..items.len()];
    if most > CROWDED {
        sorted.sort_unstable();
    } else {
        for i in 1..sorted.len() {
            let (key, mut place) = (sorted[i], i);
            while place > 0 && sorted[place - 1] > key {
                sorted[place] = sorted[place - 1];
                place -= 1;
            }
            sorted[place] = key;
        }
    }
    sorted
}

/// The items in their order on the first axis.
fn sorted(items: &[Item], spread: &Extent) -> Vec<Item> {
    let mut keys = [0; SWEEP];
    let keys = sorted_keys(0, items, spread, &mut keys);
    let item = |key: u64| &items[key as u8 as usize];
    for equal in keys.chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|equal| equal.len() > 1) {
        equal.sort_unstable_by(|&a, &b| along(0, item(a), item(b)));
    }
    keys.iter().map(|&key| *item(key)).collect()
}

/// Bits that are ordered as [`f32::total_cmp`] orders.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ (((bits as i32 >> 31) as u32) | 1 << 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::numbered;

    #[test]
    fn keys_are_sorted() {
        let values: [fn(f32) -> f32; 6] = [
            |u| u,
            |u| 2.0 * u - 1.0,
            |u| (-80.0 * u).exp(),
            |u| (4.0 * u).floor(),
            |_| -0.0,
            |u| if u < 0.01 { 1e30 } else { u },
        ];
        for (value, count) in values.into_iter().flat_map(|v| [9, 100, SWEEP].map(|n| (v, n))) {
            let number = |i, axis| value(numbered(i, axis));
            let sphere = |i| std::array::from_fn(|axis| number(i, axis as u64));
            let items: Vec<_> =
                (0..count as u32).map(|id| Item { sphere: sphere(id.into()), id }).collect();
            let spread = spread(&items);
            for axis in 0..AXES {
                let mut by_library: Vec<_> = (0..count).collect();
                by_library
                    .sort_by(|&a, &b| items[a].sphere[axis].total_cmp(&items[b].sphere[axis]));
                let mut keys = [0; SWEEP];
                let keys = sorted_keys(axis, &items, &spread, &mut keys);
                let places = keys.iter().map(|&key| key as u32 as usize);
                assert!(places.eq(by_library), "{count}, axis {axis}");
            }
            let mut by_library = items.clone();
            by_library.sort_by(|a, b| along(0, a, b));
            assert_eq!(sorted(&items, &spread), by_library);
        }
    }
}
