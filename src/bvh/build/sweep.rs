//! The surface-area heuristic where spheres are few: all multiples of a leaf on every axis are
//! tried.
//!
//! The spheres are ordered once on each axis; parts keep the order.

use super::CROWD;
use super::branch::{Branch, Top};
use super::item::{AXES, Extent, Item, along, spread};
use super::surface_area::axes;
use crate::spheres::LEAF;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// So many spheres are few.
pub(super) const SWEEP: usize = 256;

/// Spheres in their order on each axis.
struct Sweep {
    items: [Item; SWEEP],
    /// By axis: places in `items`, which is in the order on the first one.
    order: [[u8; SWEEP]; AXES],
    axes: usize,
}

/// Makes the branches over at most [`SWEEP`] items; tells if they are a crowd about one center.
pub(super) fn grow(items: &mut [Item], branches: &mut [Branch], crowded: &AtomicBool) -> Top {
    let spread = spread(items);
    if items.len() >= CROWD && (spread.high - spread.low).truncate().max_element() <= 0.0 {
        crowded.store(true, Relaxed);
    }
    items.sort_unstable_by(|a, b| along(0, a, b));
    let mut sweep = Sweep::over(items, axes(&spread));
    let top = sweep.grow(0, items.len(), branches);
    for (item, &from) in items.iter_mut().zip(&sweep.order[0]) {
        *item = sweep.items[from as usize];
    }
    top
}

impl Sweep {
    fn over(items: &[Item], axes: usize) -> Self {
        const NONE: Item = Item { sphere: [0.0; AXES], id: 0 };
        let mut sweep = Self { items: [NONE; SWEEP], order: [[0; SWEEP]; AXES], axes };
        sweep.items[..items.len()].copy_from_slice(items);
        let mut keys = [0_u64; SWEEP];
        for axis in 0..axes {
            let keys = &mut keys[..items.len()];
            for (i, (key, item)) in keys.iter_mut().zip(items).enumerate() {
                *key = u64::from(ordered(item.sphere[axis])) << 32 | i as u64;
            }
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
            return Top::leaf(self.order[0][from..to].iter().map(|&i| &self.items[i as usize]));
        };
        let (axis, first) = self.best(from, to);
        let border = from + first * LEAF;
        self.part(axis, from..to, border);
        let (left, right) = rest.split_at_mut(first - 1);
        let (a, b) = (self.grow(from, border, left), self.grow(border, to, right));
        *root = Branch { top: Top::join(&a, &b), first: first as u32 };
        root.top
    }

    /// The axis and the number of leaves of the cheapest first part.
    fn best(&self, from: usize, to: usize) -> (usize, usize) {
        let leaves = (to - from).div_ceil(LEAF);
        let mut best = (f32::INFINITY, 0, leaves / 2);
        let mut unit = 0.0;
        for axis in 0..self.axes {
            let mut leaf = [Extent::EMPTY; SWEEP / LEAF];
            for (extent, of_leaf) in leaf.iter_mut().zip(self.order[axis][from..to].chunks(LEAF)) {
                let extents = of_leaf.iter().map(|&i| Extent::of(&self.items[i as usize]));
                *extent = extents.fold(Extent::EMPTY, |all, extent| all.union(&extent));
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
                let cost = below.half_area(unit) * first as f32
                    + above[first].half_area(unit) * (leaves - first) as f32;
                if cost < best.0 {
                    best = (cost, axis, first);
                }
            }
        }
        (best.1, best.2)
    }

    /// Puts what comes before `border` on an axis before it on all.
    fn part(&mut self, axis: usize, rows: std::ops::Range<usize>, border: usize) {
        let mut behind = [false; SWEEP];
        for &i in &self.order[axis][border..rows.end] {
            behind[i as usize] = true;
        }
        for other in (0..self.axes).filter(|&other| other != axis) {
            let order = &mut self.order[other][rows.clone()];
            let (mut first, mut second) = (0, 0);
            let mut later = [0; SWEEP];
            for place in 0..order.len() {
                let i = order[place];
                let is_behind = behind[i as usize];
                order[first] = i;
                later[second] = i;
                first += usize::from(!is_behind);
                second += usize::from(is_behind);
            }
            order[first..].copy_from_slice(&later[..second]);
        }
    }
}

/// Bits that are ordered as [`f32::total_cmp`] orders.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ (((bits as i32 >> 31) as u32) | 1 << 31)
}
