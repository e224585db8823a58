//! What flat cuts leave of rays: see [`Cut`](crate::world::Cut).

use super::Tree;
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::world::{Span, World};

/// The bound of a ray that is not to be traced: nothing counts below 0.
const NOWHERE: f64 = -1.0;

/// The kept pieces of rays, row by row, and what is known of their hits.
pub(super) struct Pieces {
    /// Rays that come from what is cut away begin where they enter; the others are as they were.
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Where each piece begins, in distances of its ray.
    start: Vec<f64>,
}

impl Pieces {
    /// The pieces of rays. What is known from the start goes to `hits`: caps that are hit where a
    /// ray enters.
    pub(super) fn new(world: &World, tree: Tree, rays: &Rays, hits: &mut Hits) -> Self {
        let mut pieces = Self {
            rays: Rays::with_capacity(rays.len()),
            hits: Hits::with_capacity(rays.len()),
            start: vec![0.0; rays.len()],
        };
        for row in 0..rays.len() {
            pieces.rays.push(rays.origin.row(row), rays.direction.row(row), rays.own[row]);
            pieces.rays.target[row] = rays.target[row];
            let span = world.cut.clip(&rays.exact(row), rays.own[row]);
            if span.from > 0.0 {
                pieces.enter(tree, rays, (row, &span), hits);
            } else {
                pieces.stay(world, tree, rays, (row, &span), hits);
            }
        }
        pieces
    }

    /// A ray that comes from what is cut away.
    fn enter(&mut self, tree: Tree, rays: &Rays, (row, span): (usize, &Span), hits: &mut Hits) {
        self.hits.set(row, NOWHERE, MISS);
        let bound = hits.t[row];
        if span.is_empty() || span.from >= bound {
            return;
        }
        let point = rays.exact(row).at(span.from).as_vec3();
        if let Some(sphere) = tree.bvh.holder(tree.spheres, point) {
            return hits.set(row, span.from, sphere);
        }
        self.start[row] = span.from;
        self.rays.set(row, point, rays.direction.row(row), MISS);
        self.rays.target[row] = rays.target[row];
        self.hits.set(row, bound.min(span.to) - span.from, MISS);
    }

    /// A ray that starts in what is kept. One from inside a sphere hits its cap from there.
    fn stay(
        &mut self,
        world: &World,
        tree: Tree,
        rays: &Rays,
        (row, span): (usize, &Span),
        hits: &Hits,
    ) {
        let (bound, known) = (hits.t[row], hits.sphere[row]);
        if span.to >= bound {
            return self.hits.set(row, bound, known);
        }
        // It goes on inside the sphere that it starts on, or the camera may be inside a sphere, and
        // then so may the ground and other spheres.
        let around = || {
            let holder = |point| tree.bvh.holder(tree.spheres, point);
            let inside = world.features.around_camera
                && span.to > 0.0
                && holder(rays.origin.row(row)).is_some();
            let cap = inside.then(|| holder(rays.exact(row).at(span.to).as_vec3())).flatten();
            // Rounding may put the exit of a ray that grazes its own sphere inside of that.
            cap.filter(|&sphere| sphere != rays.own[row])
        };
        let sphere = if known < GROUND { Some(known) } else { around() };
        self.hits.set(row, span.to, sphere.unwrap_or(MISS));
    }

    /// Tells of the spheres that were hit.
    pub(super) fn give_back(&self, hits: &mut Hits) {
        for row in 0..self.rays.len() {
            if self.hits.sphere[row] < GROUND {
                hits.set(row, self.start[row] + self.hits.t[row], self.hits.sphere[row]);
            }
        }
    }
}
