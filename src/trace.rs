//! Finding what rays hit: the ground first, if there is one, then the tree, or what slices leave of
//! it.

mod ground;
mod pieces;

pub(crate) use self::ground::{hide_behind, stop_at};
use self::pieces::Pieces;
use crate::bvh::Bvh;
use crate::bvh::walk::{self, Any, Closest, Method, Query};
use crate::lanes::{F32x4, F32x8, F32x16};
use crate::ray::{Hits, MISS, Rays};
use crate::spheres::Spheres;
use crate::world::World;

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

/// Spheres, and the tree over them.
#[derive(Clone, Copy)]
struct Tree<'a> {
    bvh: &'a Bvh,
    spheres: &'a Spheres,
}

impl Tracer {
    /// Finds what each ray hits first. On entry `hits.t` bounds the search, and `hits.sphere` is
    /// what is at that bound, if anything; on return both tell of the hit.
    pub fn closest(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        self.ground(world, rays, hits);
        self.spheres::<Closest>(world, rays, hits)
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
        self.spheres::<Any>(world, rays, hits)
    }

    /// Finds what is hit of the spheres that are there for these rays.
    fn spheres<Q: Query>(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        if world.seen.is_none() && world.cut.is_empty() {
            return self.walk::<Q>(Tree { bvh: &world.bvh, spheres: &world.spheres }, rays, hits);
        }
        self.sliced::<Q>(world, rays, hits)
    }

    /// The same where slices hide spheres from the camera, or cut them.
    #[cold]
    fn sliced<Q: Query>(self, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
        // Rays that start on nothing are the camera's, and never mixed with others.
        let from_camera = rays.own.first() == Some(&MISS);
        let Some(seen) = world.seen.as_ref().filter(|_| from_camera) else {
            let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
            return self.cut::<Q>(world, tree, rays, hits);
        };
        let exact =
            self.cut::<Q>(world, Tree { bvh: &seen.bvh, spheres: &seen.spheres }, rays, hits);
        for hit in &mut hits.sphere[..rays.len()] {
            *hit = seen.row.get(*hit as usize).copied().unwrap_or(*hit);
        }
        exact
    }

    /// The same, and where they are cut off.
    fn cut<Q: Query>(self, world: &World, tree: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        if world.cut.is_empty() {
            return self.walk::<Q>(tree, rays, hits);
        }
        let mut pieces = Pieces::new(world, tree, rays, hits);
        let exact = self.walk::<Q>(tree, &pieces.rays, &mut pieces.hits);
        pieces.give_back(hits);
        exact
    }

    #[inline(never)]
    fn walk<Q: Query>(self, Tree { bvh, spheres }: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        match self.width {
            Width::One => walk::trace::<f32, Q>(self.method, bvh, spheres, rays, hits),
            Width::Four => walk::trace::<F32x4, Q>(self.method, bvh, spheres, rays, hits),
            Width::Eight => walk::trace::<F32x8, Q>(self.method, bvh, spheres, rays, hits),
            Width::Sixteen => walk::trace::<F32x16, Q>(self.method, bvh, spheres, rays, hits),
        }
    }
}
