//! Rays clipped to the half spaces that are kept: see [`Cut`](crate::world::Cut).

use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::world::{Span, World};
use glam::Vec3;

/// Upper bound of a ray that is not traced: all hits are farther.
const NOT_TRACED: f64 = -1.0;

/// The side on which a ray crosses a cut.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Crossing {
    /// Into the region that is kept.
    Entry,
    /// Out of it.
    Exit,
}

/// Rays clipped to the region that is kept, row by row, and their hits.
pub(super) struct ClippedRays {
    /// Rays whose origin is cut away start where they enter the region; the others are unchanged.
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Distances along the original rays at which the clipped ones start.
    start: Vec<f64>,
}

impl ClippedRays {
    /// Clips rays. Hits that are known at once go to `hits`: caps that are hit where a ray enters. `cap` returns the body whose
    /// cap a ray hits at a point of a cut, from the ray's row.
    pub(super) fn new(
        world: &World,
        rays: &Rays,
        hits: &mut Hits,
        mut cap: impl FnMut(usize, Vec3, Crossing) -> Option<u32>,
    ) -> Self {
        let mut clipped = Self {
            rays: Rays::with_capacity(rays.len()),
            hits: Hits::with_capacity(rays.len()),
            start: vec![0.0; rays.len()],
        };
        for row in 0..rays.len() {
            clipped.rays.push(rays.origin.row(row), rays.direction.row(row), rays.own[row]);
            clipped.rays.target[row] = rays.target[row];
            let span = world.cut.clip(&rays.exact(row), rays.own[row]);
            if span.from > 0.0 {
                clipped.clip_entering(rays, row, &span, hits, &mut cap);
            } else {
                clipped.clip_inside(world, rays, row, &span, hits, &mut cap);
            }
        }
        clipped
    }

    /// Clips a ray that starts outside of the region.
    fn clip_entering(
        &mut self,
        rays: &Rays,
        row: usize,
        span: &Span,
        hits: &mut Hits,
        cap: &mut impl FnMut(usize, Vec3, Crossing) -> Option<u32>,
    ) {
        self.hits.set(row, NOT_TRACED, MISS);
        let bound = hits.t[row];
        if span.is_empty() || span.from >= bound {
            return;
        }
        let point = rays.exact(row).at(span.from).as_vec3();
        if let Some(sphere) = cap(row, point, Crossing::Entry) {
            return hits.set(row, span.from, sphere);
        }
        self.start[row] = span.from;
        self.rays.set(row, point, rays.direction.row(row), MISS);
        self.rays.target[row] = rays.target[row];
        self.hits.set(row, bound.min(span.to) - span.from, MISS);
    }

    /// Clips a ray that starts within the region. A ray that leaves the region inside a sphere hits
    /// its cap from within.
    fn clip_inside(
        &mut self,
        world: &World,
        rays: &Rays,
        row: usize,
        span: &Span,
        hits: &Hits,
        cap: &mut impl FnMut(usize, Vec3, Crossing) -> Option<u32>,
    ) {
        let (bound, known) = (hits.t[row], hits.sphere[row]);
        if span.to >= bound {
            return self.hits.set(row, bound, known);
        }
        // The ray is inside the sphere that it starts on; or the camera is inside a sphere, and then so
        // may be points of the ground and of other spheres.
        let mut around = || {
            let mut enclosing = |point| cap(row, point, Crossing::Exit);
            let inside = world.features.around_camera
                && span.to > 0.0
                && enclosing(rays.origin.row(row)).is_some();
            let cap = inside.then(|| enclosing(rays.exact(row).at(span.to).as_vec3())).flatten();
            // Rounding may put the exit of a grazing ray inside of the ray's own sphere.
            cap.filter(|&sphere| sphere != rays.own[row])
        };
        let sphere = if known < GROUND { Some(known) } else { around() };
        self.hits.set(row, span.to, sphere.unwrap_or(MISS));
    }

    /// Writes the spheres that were hit to the hits of the original rays.
    pub(super) fn write_hits(&self, hits: &mut Hits) {
        for row in 0..self.rays.len() {
            if self.hits.sphere[row] < GROUND {
                hits.set(row, self.start[row] + self.hits.t[row], self.hits.sphere[row]);
            }
        }
    }
}
