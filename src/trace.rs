//! Finding what rays hit: the ground first, if there is one, then the tree.

use crate::bvh::walk::{self, Any, Closest, Method, Query};
use crate::intersect;
use crate::lanes::{F32x4, F32x8, F32x16};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::world::World;

/// How rays find spheres: never what they find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracer {
    /// With the tree or without.
    pub traversal: Traversal,
    /// Rays in a packet.
    pub width: Width,
}

/// With the tree or without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traversal {
    /// With the tree; rays that have been scattered go in packets where that pays.
    Auto,
    /// With the tree, all rays in packets.
    Tree,
    /// By testing every sphere.
    Brute,
}

/// Rays in a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// One ray at a time: the scalar walk.
    One,
    /// Four.
    Four,
    /// Eight.
    Eight,
    /// Sixteen.
    Sixteen,
}

/// Whether neighbors in a column of rays go the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coherence {
    /// They do.
    Coherent,
    /// They do not.
    Incoherent,
}

impl Tracer {
    /// Finds what each ray hits first. On entry `hits.t` bounds the search, and `hits.sphere` is
    /// what is at that bound, if anything; on return both tell of the hit.
    pub fn closest(self, world: &World, rays: &Rays, hits: &mut Hits, coherence: Coherence) -> u64 {
        if let Some(ground) = &world.ground {
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
        self.walk::<Closest>(world, rays, hits, coherence)
    }

    /// Finds whether anything is nearer than `hits.t`: on return `hits.sphere` is [`MISS`] where
    /// nothing is. On entry it is `MISS` for every ray that is to be traced.
    pub fn occluded(
        self,
        world: &World,
        rays: &Rays,
        hits: &mut Hits,
        coherence: Coherence,
    ) -> u64 {
        if let Some(ground) = &world.ground {
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
        self.walk::<Any>(world, rays, hits, coherence)
    }

    fn walk<Q: Query>(
        self,
        world: &World,
        rays: &Rays,
        hits: &mut Hits,
        coherence: Coherence,
    ) -> u64 {
        let method = match self.traversal {
            Traversal::Brute => Method::Brute,
            Traversal::Auto => Method::Auto,
            Traversal::Tree => Method::Packet,
        };
        let _ = coherence;
        let (bvh, spheres) = (&world.bvh, &world.spheres);
        match self.width {
            Width::One => walk::trace::<f32, Q>(method, bvh, spheres, rays, hits),
            Width::Four => walk::trace::<F32x4, Q>(method, bvh, spheres, rays, hits),
            Width::Eight => walk::trace::<F32x8, Q>(method, bvh, spheres, rays, hits),
            Width::Sixteen => walk::trace::<F32x16, Q>(method, bvh, spheres, rays, hits),
        }
    }
}
