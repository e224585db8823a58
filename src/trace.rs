//! Finding what rays hit: the ground first, if there is one, then the tree.

use crate::bvh::walk::{self, Any, Closest, Method, Query};
use crate::intersect;
use crate::lanes::{F32x4, F32x8, F32x16, Lanes};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::world::World;

/// How rays find spheres: never what they find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracer {
    /// With the tree, or by testing every sphere.
    pub method: Method,
    /// Packets of rays that start and go alike: camera rays, and shadow rays toward one light.
    pub coherent: Width,
    /// Packets of rays that have been scattered.
    pub incoherent: Width,
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
        let width = match coherence {
            Coherence::Coherent => self.coherent,
            Coherence::Incoherent => self.incoherent,
        };
        match width {
            Width::One => self.run::<f32, Q>(world, rays, hits),
            Width::Four => self.run::<F32x4, Q>(world, rays, hits),
            Width::Eight => self.run::<F32x8, Q>(world, rays, hits),
            Width::Sixteen => self.run::<F32x16, Q>(world, rays, hits),
        }
    }

    fn run<L: Lanes, Q: Query>(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        walk::trace::<L, Q>(self.method, &world.bvh, &world.spheres, rays, hits)
    }
}
