//! The surface-area heuristic where spheres are few: all multiples of a leaf on every axis are
//! tried.
//!
//! The spheres are ordered once on each axis; parts keep the order.

use super::CROWD;
use super::branch::{Branch, Top};
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

/// Spheres in their order on each axis.
struct Sweep {
    items: Vec<Item>,
    /// Their boxes.
    extent: Vec<Extent>,
    /// By axis: places in `items`, which is in the order on the first one.
    order: [[u8; SWEEP]; AXES],
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
    let mut sweep = Sweep::over(segment.items, axes(&spread));
    let top = sweep.grow(0, segment.len(), branches);
    for (item, &from) in segment.destination().0.iter_mut().zip(&sweep.order[0]) {
        *item = sweep.items[from as usize];
    }
    top
}

impl Sweep {
    fn over(items: &[Item], axes: usize) -> Self {
        let items = sorted(items);
        let mut sweep = Self {
            extent: items.iter().map(Extent::of).collect(),
            items,
            order: [[0; SWEEP]; AXES],
            axes,
            behind: [false; SWEEP],
            later: [0; SWEEP],
        };
        for axis in 0..axes {
            let mut keys = [0; SWEEP];
            let keys = keys_on(axis, &sweep.items, &mut keys);
            if axis > 0 {
                keys.sort_unstable();
            }
            for (place, &key) in sweep.order[axis].iter_mut().zip(&*keys) {
                *place = key as u8;
            }
        }
        sweep
    }

    fn grow(&mut self, from: usize, to: usize, branches: &mut [Branch]) -> Top {
        let Some((root, rest)) = branches.split_first_mut() else {
            return Top::leaf(&self.extent_of(&self.order[0][from..to]));
        };
        let (axis, first) = self.best(from, to);
        let border = from + first * LEAF;
        self.part(axis, from..to, border);
        let (left, right) = rest.split_at_mut(first - 1);
        let (a, b) = (self.grow(from, border, left), self.grow(border, to, right));
        *root = Branch { top: Top::join(&a, &b), first: first as u32 };
        root.top
    }

    /// The box of some spheres.
    #[inline(always)]
    fn extent_of(&self, places: &[u8]) -> Extent {
        let extents = places.iter().map(|&i| self.extent[i as usize]);
        extents.fold(Extent::EMPTY, |all, extent| all.union(&extent))
    }

    /// The axis and the number of leaves of the cheapest first part.
    fn best(&self, from: usize, to: usize) -> (usize, usize) {
        let leaves = (to - from).div_ceil(LEAF);
        let mut best = (f32::INFINITY, 0, leaves / 2);
        let mut unit = 0.0;
        for axis in 0..self.axes {
            let mut leaf = [Extent::EMPTY; SWEEP / LEAF];
            for (extent, of_leaf) in leaf.iter_mut().zip(self.order[axis][from..to].chunks(LEAF)) {
                *extent = self.extent_of(of_leaf);
            }
            let mut above = [Extent::EMPTY; SWEEP / LEAF];
            let mut all = Extent::EMPTY;
            for i in (0..leaves).rev() {
                all = all.union(&leaf[i]);
                above[i] = all;
            }
            unit = if axis == 0 { all.unit() } else { unit };
            let mut below = Extent::EMPTY;
            for first in 1..leaves {
                below = below.union(&leaf[first - 1]);
                let cost = below.half_area(unit) * weight(first)
                    + above[first].half_area(unit) * weight(leaves - first);
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
        for other in (0..self.axes).filter(|&other| other != axis) {
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
        }
    }
}

/// Returns sort keys: an item's coordinate on an axis in the upper half, its place in the lower half.
fn keys_on<'a>(axis: usize, items: &[Item], keys: &'a mut [u64; SWEEP]) -> &'a mut [u64] {
    for (i, (key, item)) in keys.iter_mut().zip(items).enumerate() {
        *key = u64::from(ordered(item.sphere[axis])) << 32 | i as u64;
    }
    &mut keys[..items.len()]
}

/// The items in their order on the first axis.
fn sorted(items: &[Item]) -> Vec<Item> {
    let mut keys = [0; SWEEP];
    let keys = keys_on(0, items, &mut keys);
    keys.sort_unstable();
    let item = |key: u64| &items[key as u8 as usize];
    for equal in keys.chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|equal| equal.len() > 1) {
        equal.sort_unstable_by(|&a, &b| along(0, item(a), item(b)));
    }
    keys.iter().map(|&key| *item(key)).collect()
}

/// Returns the cost of leaves and of the nodes that they fill: a node that is not full is visited as
/// often as a full one.
fn weight(leaves: usize) -> f32 {
    leaves as f32 + NODE * leaves.div_ceil(WIDTH) as f32
}

/// Bits that are ordered as [`f32::total_cmp`] orders.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ (((bits as i32 >> 31) as u32) | 1 << 31)
}
