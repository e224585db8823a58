//! The rows of the next bounce: where paths are sent on.

use super::carried::{Carried, CarriedRow};
use super::surface::Normals;
use super::workspace::{BATCH, ROWS};
use crate::lanes::{F32x16, MAX_LANES, Packing};
use crate::ray::{Hits, MISS, Rays};
use crate::vec3::Vec3;

/// The next segments of the paths that have been sent on so far.
pub(super) struct Onward {
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Normals of the spheres that rays go inside of, where they enter.
    pub(super) entry: Normals,
    pub(super) carried: Carried,
}

/// The next segments of a row of paths.
pub(super) struct Segments<'a> {
    /// Where they start.
    pub(super) origin: Vec3<F32x16>,
    /// Where they go.
    pub(super) direction: Vec3<F32x16>,
    /// What they start on.
    pub(super) own: &'a [u32; MAX_LANES],
    /// What the paths take along.
    pub(super) carried: &'a CarriedRow,
}

impl Onward {
    /// With room for normals of the last surfaces if `normals`.
    pub(super) fn new(normals: bool) -> Self {
        Self {
            rays: Rays::with_capacity(BATCH),
            hits: Hits::with_capacity(BATCH),
            entry: Normals::with_rows(ROWS),
            carried: Carried::new(normals),
        }
    }

    /// Sends some paths of a row on, whose ends are not known; returns where the first has come to.
    #[inline(always)]
    pub(super) fn append(&mut self, packing: &Packing, row: &Segments) -> usize {
        let first = self.rays.len();
        self.rays.append_packed(packing, (row.origin, row.direction), row.own);
        self.carried.pack(first, packing, row.carried);
        self.hits.t[first..first + MAX_LANES].fill(f64::INFINITY);
        self.hits.sphere[first..first + MAX_LANES].fill(MISS);
        first
    }
}
