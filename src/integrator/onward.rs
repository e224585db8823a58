//! The rows of the next bounce: where paths are sent on.

use super::surface::Normals;
use super::workspace::{BATCH, ROWS};
use crate::lanes::{F32x16, MAX_LANES};
use crate::ray::{Hits, MISS, Rays};

/// The next segments of the paths that have been sent on so far.
pub(super) struct Onward {
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Normals of the spheres that rays go inside of, where they enter.
    pub(super) entry: Normals,
    pub(super) place: Vec<u32>,
}

/// The next segments of a row of paths.
pub(super) struct Segments {
    /// Where they start.
    pub(super) origin: [F32x16; 3],
    /// Where they go.
    pub(super) direction: [F32x16; 3],
    /// What they start on.
    pub(super) own: [u32; MAX_LANES],
    /// What is known of their ends: as [`Hits::t`] and [`Hits::sphere`].
    pub(super) end: ([f64; MAX_LANES], [u32; MAX_LANES]),
    /// Outward normals where they start.
    pub(super) normal: [[f64; MAX_LANES]; 3],
    /// Which paths they belong to.
    pub(super) place: [u32; MAX_LANES],
}

impl Onward {
    pub(super) fn new() -> Self {
        Self {
            rays: Rays::with_capacity(BATCH),
            hits: Hits::with_capacity(BATCH),
            entry: Normals::with_rows(ROWS),
            place: vec![MISS; ROWS],
        }
    }

    /// Sends the first `count` paths of a row on.
    #[inline(always)]
    pub(super) fn append(&mut self, count: usize, row: &Segments) {
        let rows = self.rays.len()..self.rays.len() + MAX_LANES;
        self.rays.append(count, &row.origin, &row.direction);
        self.rays.own[rows.clone()].copy_from_slice(&row.own);
        self.hits.t[rows.clone()].copy_from_slice(&row.end.0);
        self.hits.sphere[rows.clone()].copy_from_slice(&row.end.1);
        self.entry.copy(rows.start, &row.normal);
        self.place[rows].copy_from_slice(&row.place);
    }
}
