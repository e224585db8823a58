//! Halves on the longest axis: the oldest way, and what the others fall back on.
//!
//! (Kay & Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986.)

use super::cut::{CROWD, Cut};
use super::partition::Grid;
use super::segment::Segment;
use crate::bvh::WIDTH;
use crate::spheres::LEAF;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Halves on the axis on which the centers are spread widest.
#[derive(Default)]
pub(super) struct Median {
    /// Set where a crowd of spheres has one center.
    pub(super) crowded: AtomicBool,
}

impl Cut for Median {
    fn cut(&self, segment: &mut Segment, _first: usize) -> usize {
        self.cut_on(segment, &Grid::over(segment.items))
    }

    fn median(&self) -> &Median {
        self
    }
}

impl Median {
    /// Cuts where the grid over the items is known already.
    pub(super) fn cut_on(&self, segment: &mut Segment, grid: &Grid) -> usize {
        let width = grid.spread.size();
        if width.truncate().max_element() <= 0.0 && segment.len() >= CROWD {
            self.crowded.store(true, Relaxed);
        }
        let axis = width.truncate().max_position();
        let place = half(segment.len().div_ceil(LEAF)) * LEAF;
        grid.part(segment, axis, &grid.count(segment.items, axis), place);
        place
    }
}

/// The leaves of the first half: as many as fill subtrees of eight children each.
pub(super) fn half(leaves: usize) -> usize {
    let mut full = 1;
    while full * WIDTH < leaves {
        full *= WIDTH;
    }
    leaves.div_ceil(full) / 2 * full
}
