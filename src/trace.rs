//! Traces rays in a world: the ground first, if there is one, then the tree, or the part of it that
//! slices leave.

mod clipped;
mod ground;

pub(crate) use self::ground::{hide_behind, stop_at};
pub use crate::bvh::{PacketWidth, Tracer, Traversal};

use self::clipped::ClippedRays;
use crate::bvh::Tree;
use crate::ray::{Hits, MISS, Rays};
use crate::world::World;

/// The answer that is looked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Query {
    /// The first hit of each ray.
    Closest,
    /// Whether each ray hits anything.
    Any,
}

/// Finds the first hit of each ray. On entry `hits.t` bounds the search, and `hits.sphere` is what is
/// at that bound, if anything; on return both describe the hit.
///
/// Returns how many decisions were made on integers.
pub fn closest(tracer: Tracer, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    closest_ground(world, rays, hits);
    trace(tracer, Query::Closest, world, rays, hits)
}

/// Does what [`closest`] does, for rays that hit no sphere.
pub fn closest_ground(world: &World, rays: &Rays, hits: &mut Hits) {
    if let Some(ground) = &world.ground {
        stop_at(ground, rays, hits);
    }
}

/// Finds whether each ray hits anything nearer than `hits.t`. On entry `hits.sphere` is [`MISS`] for
/// each ray that is to be traced; on return it is `MISS` where nothing is hit.
///
/// Returns how many decisions were made on integers.
pub fn occluded(tracer: Tracer, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    if let Some(ground) = &world.ground {
        hide_behind(ground, rays, hits);
    }
    trace(tracer, Query::Any, world, rays, hits)
}

/// Traces rays among the spheres that exist for them.
fn trace(tracer: Tracer, query: Query, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    if world.seen.is_none() && world.cut.is_empty() {
        let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
        return query.trace(tracer, tree, rays, hits);
    }
    trace_sliced(tracer, query, world, rays, hits)
}

/// Does what [`trace`] does where slices hide spheres from the camera, or cut them.
#[cold]
fn trace_sliced(tracer: Tracer, query: Query, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    // Rays that start on nothing are the camera's, and never mixed with others.
    let from_camera = rays.own.first() == Some(&MISS);
    let Some(seen) = world.seen.as_ref().filter(|_| from_camera) else {
        let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
        return trace_clipped(tracer, query, world, tree, rays, hits);
    };
    let tree = Tree { bvh: &seen.bvh, spheres: &seen.spheres };
    let exact = trace_clipped(tracer, query, world, tree, rays, hits);
    for hit in &mut hits.sphere[..rays.len()] {
        *hit = seen.row.get(*hit as usize).copied().unwrap_or(*hit);
    }
    exact
}

/// Traces the parts of rays that slices leave.
fn trace_clipped(
    tracer: Tracer,
    query: Query,
    world: &World,
    tree: Tree,
    rays: &Rays,
    hits: &mut Hits,
) -> u64 {
    if world.cut.is_empty() {
        return query.trace(tracer, tree, rays, hits);
    }
    let mut clipped = ClippedRays::new(world, tree, rays, hits);
    let exact = query.trace(tracer, tree, &clipped.rays, &mut clipped.hits);
    clipped.write_hits(hits);
    exact
}

impl Query {
    fn trace(self, tracer: Tracer, tree: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        match self {
            Self::Closest => tracer.closest(tree, rays, hits),
            Self::Any => tracer.occluded(tree, rays, hits),
        }
    }
}
