//! Next rays: the rays of the next bounce, without gaps (compaction).

use super::columns::{BATCH_PATHS, ROWS};
use super::path_state::{PathStateRow, PathStates};
use super::surface::Normals;
use crate::lanes::{F32x16, MAX_LANES, Packing};
use crate::ray::{Hits, MISS, Rays};
use crate::vec3::Vec3;

/// Rays of the next bounce, in columns, with the states of their paths.
pub(super) struct NextRays {
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Normals where rays enter the spheres that they pass through.
    pub(super) entry: Normals,
    pub(super) states: PathStates,
}

/// A row of next rays.
pub(super) struct RayRow<'a> {
    /// Origins.
    pub(super) origin: Vec3<F32x16>,
    /// Directions.
    pub(super) direction: Vec3<F32x16>,
    /// Spheres on which they start.
    pub(super) own: &'a [u32; MAX_LANES],
    /// States of the paths.
    pub(super) state: &'a PathStateRow,
}

impl NextRays {
    /// Creates empty columns, with normals of the last surfaces if `normals`.
    pub(super) fn new(normals: bool) -> Self {
        Self {
            rays: Rays::with_capacity(BATCH_PATHS),
            hits: Hits::with_capacity(BATCH_PATHS),
            entry: Normals::with_rows(ROWS),
            states: PathStates::new(normals),
        }
    }

    /// Appends the lanes of a row that `packing` selects, with unknown hits; returns the row of the
    /// first.
    #[inline(always)]
    pub(super) fn push(&mut self, packing: &Packing, row: &RayRow) -> usize {
        let first = self.rays.len();
        self.rays.append_packed(packing, (row.origin, row.direction), row.own);
        self.states.pack(first, packing, row.state);
        self.hits.t[first..first + MAX_LANES].fill(f64::INFINITY);
        self.hits.sphere[first..first + MAX_LANES].fill(MISS);
        first
    }
}
