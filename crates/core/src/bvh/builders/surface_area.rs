//! Cuts where the surfaces of both parts, weighed with what is in them, are least.
//!
//! A random line that meets a box meets one inside it with the probability that is the ratio of their
//! surfaces (`MacDonald` & Booth, "Heuristics for Ray Tracing Using Space Subdivision", The Visual
//! Computer 1990). Places to cut are the borders of a few intervals on each axis (Wald, "On Fast
//! Construction of SAH-based Bounding Volume Hierarchies", RT 2007), moved to the next multiple of a
//! full subtree or at least of a leaf; where spheres are few, every multiple of a leaf is tried
//! (`sweep`).
//!
//! Besides by where they are, spheres are parted by how large they are: a large one among many that
//! are small would spoil the boxes of all parts that it is in.

use super::branch::{Branch, Top};
use super::item::{AXES, Extent, Item};
use super::median::Median;
use super::partition::{BINS, Grid};
use super::sweep::{self, SWEEP};
use super::{Cut, snapped};
use crate::bvh::WIDTH;
use crate::spheres::LEAF;
use rayon::prelude::*;

/// Number of spheres that are worth a task.
const CHUNK: usize = 1 << 14;

/// Radii matter if the largest is more than this part of how widely the centers are spread.
const LARGE: f32 = 1.0 / 8.0;

/// The surface-area heuristic.
#[derive(Default)]
pub(super) struct SurfaceArea {
    pub(super) median: Median,
}

impl Cut for SurfaceArea {
    fn cut(&self, items: &mut [Item], _first: usize) -> usize {
        let grid = Grid::over(items);
        let axes = axes(&grid.spread);
        let histogram = Histogram::of(items, &grid, axes);
        match histogram.best(axes, items.len()) {
            Some((axis, place)) => {
                grid.part(items, axis, &histogram.count[axis], place);
                place
            }
            None => self.median.cut_on(items, &grid),
        }
    }

    fn median(&self) -> &Median {
        &self.median
    }

    fn finishes(&self, items: usize) -> bool {
        items <= SWEEP
    }

    fn finish(&self, items: &mut [Item], branches: &mut [Branch]) -> Top {
        sweep::grow(items, branches, &self.median.crowded)
    }
}

/// On how many axes to look: on that of the radii only if boxes are much larger for them.
pub(super) fn axes(spread: &Extent) -> usize {
    let width = (spread.high - spread.low).truncate().max_element();
    let radii = spread.high.w - spread.low.w;
    if radii > LARGE * width { AXES } else { AXES - 1 }
}

/// Extents and counts of the spheres in the bins of a grid.
struct Histogram {
    extent: [[Extent; BINS]; AXES],
    count: [[usize; BINS]; AXES],
}

impl Histogram {
    const EMPTY: Self = Self { extent: [[Extent::EMPTY; BINS]; AXES], count: [[0; BINS]; AXES] };

    fn of(items: &[Item], grid: &Grid, axes: usize) -> Self {
        if items.len() <= CHUNK {
            return Self::of_few(items, grid, axes);
        }
        let all = items.par_chunks(CHUNK).map(|items| Self::of_few(items, grid, axes));
        all.reduce(|| Self::EMPTY, |a, b| a.sum(&b))
    }

    fn of_few(items: &[Item], grid: &Grid, axes: usize) -> Self {
        let mut histogram = Self::EMPTY;
        for item in items {
            let (bins, extent) = (grid.bins(item), Extent::of(item));
            for (axis, bin) in bins.into_iter().enumerate().take(axes) {
                let of_bin = &mut histogram.extent[axis][bin];
                *of_bin = of_bin.union(&extent);
                histogram.count[axis][bin] += 1;
            }
        }
        histogram
    }

    fn sum(mut self, other: &Self) -> Self {
        for axis in 0..AXES {
            for bin in 0..BINS {
                self.count[axis][bin] += other.count[axis][bin];
                let extent = &mut self.extent[axis][bin];
                *extent = extent.union(&other.extent[axis][bin]);
            }
        }
        self
    }

    /// The axis and the place of the cheapest cut; `None` if none parts anything.
    fn best(&self, axes: usize, items: usize) -> Option<(usize, usize)> {
        let all = self.extent[0].iter().fold(Extent::EMPTY, |all, extent| all.union(extent));
        let unit = all.unit();
        let mut best = (f32::INFINITY, None);
        for axis in 0..axes {
            let mut costs_above = [f32::INFINITY; BINS];
            let (mut above, mut count) = (Extent::EMPTY, 0);
            for bin in (1..BINS).rev() {
                above = above.union(&self.extent[axis][bin]);
                count += self.count[axis][bin];
                if count > 0 {
                    costs_above[bin] = above.half_area(unit) * count as f32;
                }
            }
            let (mut below, mut count) = (Extent::EMPTY, 0);
            for bin in 0..BINS - 1 {
                below = below.union(&self.extent[axis][bin]);
                count += self.count[axis][bin];
                let cost = below.half_area(unit) * count as f32 + costs_above[bin + 1];
                if count > 0 && cost < best.0 {
                    best = (cost, Some((axis, aligned(count, items))));
                }
            }
        }
        best.1
    }
}

/// The multiple of a leaf that is next to `place`; if it is not far, one of eight leaves, of 64 and so
/// on: nodes that are full are fewer (measured: up to 5 % of all that rays visit).
fn aligned(place: usize, items: usize) -> usize {
    let near = place.min(items - place) / 4;
    let mut best = snapped(place, items);
    let mut unit = LEAF * WIDTH;
    while unit < items {
        let multiple = (place + unit / 2) / unit * unit;
        if multiple.abs_diff(place) <= near {
            best = multiple;
        }
        unit *= WIDTH;
    }
    best
}
