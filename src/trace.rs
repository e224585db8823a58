//! Finding what rays hit: the ground first, if there is one, then the tree.

use crate::bvh::walk::{self, Any, Closest, Method, Query};
use crate::intersect;
use crate::lanes::{F32x4, F32x8, F32x16};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::world::{Ground, World};

/// How rays find spheres: never what they find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracer {
    /// Which walk takes which rays.
    pub method: Method,
    /// Rays in a packet.
    pub width: Width,
}

/// Rays in a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// One: a packet of a single ray.
    One,
    /// Four.
    Four,
    /// Eight.
    Eight,
    /// Sixteen.
    Sixteen,
}

impl Tracer {
    /// Finds what each ray hits first. On entry `hits.t` bounds the search, and `hits.sphere` is
    /// what is at that bound, if anything; on return both tell of the hit.
    pub fn closest(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        self.ground(world, rays, hits);
        self.walk::<Closest>(world, rays, hits)
    }

    /// [`Tracer::closest`] for rays that hit no sphere.
    pub fn ground(self, world: &World, rays: &Rays, hits: &mut Hits) {
        if let Some(ground) = &world.ground {
            stop_at(ground, rays, hits);
        }
    }

    /// Finds whether anything is nearer than `hits.t`: on return `hits.sphere` is [`MISS`] where
    /// nothing is. On entry it is `MISS` for every ray that is to be traced.
    pub fn occluded(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        if let Some(ground) = &world.ground {
            hide_behind(ground, rays, hits);
        }
        self.walk::<Any>(world, rays, hits)
    }

    fn walk<Q: Query>(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        let (bvh, spheres) = (&world.bvh, &world.spheres);
        match self.width {
            Width::One => walk::trace::<f32, Q>(self.method, bvh, spheres, rays, hits),
            Width::Four => walk::trace::<F32x4, Q>(self.method, bvh, spheres, rays, hits),
            Width::Eight => walk::trace::<F32x8, Q>(self.method, bvh, spheres, rays, hits),
            Width::Sixteen => walk::trace::<F32x16, Q>(self.method, bvh, spheres, rays, hits),
        }
    }
}

/// Ends rays at the ground, where they reach it.
pub(crate) fn stop_at(ground: &Ground, rays: &Rays, hits: &mut Hits) {
    for row in 0..rays.len() {
        if rays.own[row] == GROUND {
            continue;
        }
        let t = intersect::plane(&rays.exact(row), ground.normal, ground.height);
        if let Some(t) = t.filter(|&t| t < hits.t[row]) {
            hits.set(row, t, GROUND);
        }
    }
}

/// The same where it only counts whether they do.
pub(crate) fn hide_behind(ground: &Ground, rays: &Rays, hits: &mut Hits) {
    for row in 0..rays.len() {
        if rays.own[row] == GROUND || hits.sphere[row] != MISS {
            continue;
        }
        let t = intersect::plane(&rays.exact(row), ground.normal, ground.height);
        if t.is_some_and(|t| t < hits.t[row]) {
            hits.sphere[row] = GROUND;
        }
    }
}
