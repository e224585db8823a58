//! Ray tracing in a world: tests the ground, then the tree of the visible spheres, then those of other bodies.

mod bodies;
mod clipped;
mod ground;
mod translucent;

pub(crate) use self::ground::{intersect_ground, occlude_by_ground};
pub use crate::bvh::{PacketWidth, Tracer, Traversal};

use self::bodies::Bodies;
use self::clipped::ClippedRays;
use self::translucent::Choice;
pub(crate) use self::translucent::Chosen;
use crate::ray::{Hits, MISS, Rays};
use crate::world::World;
use std::borrow::Cow;

/// A kind of ray query.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Query {
    /// The first hit of each ray.
    Closest,
    /// Existence of a hit on each ray.
    Any,
}

/// Finds the first hit of each ray. On entry `hits.t` bounds the search, and `hits.sphere` is the hit
/// at that bound, if any; on return both describe the hit. Translucent bodies end rays at random, decided by a hash of the ray.
///
/// Returns the number of decisions made by exact integer arithmetic.
pub fn closest(tracer: Tracer, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    closest_by(tracer, world, rays, hits, Choice::Hashed)
}

/// Finds what [`closest`] does for rays of the camera, whose translucent bodies are chosen by numbers; these are empty if there
/// are no such bodies.
pub(crate) fn closest_from_camera(
    tracer: Tracer,
    world: &World,
    rays: &Rays,
    hits: &mut Hits,
    chosen: Chosen,
) -> u64 {
    closest_by(tracer, world, rays, hits, Choice::Given(chosen))
}

fn closest_by(tracer: Tracer, world: &World, rays: &Rays, hits: &mut Hits, choice: Choice) -> u64 {
    closest_ground(world, rays, hits);
    if world.features.translucent {
        return translucent::trace(tracer, Query::Closest, world, rays, hits, choice);
    }
    trace(tracer, Query::Closest, world, rays, hits)
}

/// Finds the first hit of rays that hit no sphere.
pub fn closest_ground(world: &World, rays: &Rays, hits: &mut Hits) {
    if let Some(ground) = &world.ground {
        intersect_ground(ground, rays, hits);
    }
}

/// Finds whether each ray hits anything nearer than `hits.t`. On entry `hits.sphere` is [`MISS`] for
/// each ray to trace; on return it is `MISS` where nothing is hit.
///
/// Returns the number of decisions made by exact integer arithmetic.
pub fn occluded(tracer: Tracer, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    occluded_by(tracer, world, rays, hits, Choice::Hashed)
}

/// Finds what [`occluded`] does; `transmittance` is 1 on entry, and on return what translucent bodies let pass of the light of each
/// ray that is not occluded. It is empty if there are no such bodies.
pub(crate) fn attenuated(
    tracer: Tracer,
    world: &World,
    rays: &Rays,
    hits: &mut Hits,
    transmittance: &mut [f32],
) -> u64 {
    occluded_by(tracer, world, rays, hits, Choice::Transmittance(transmittance))
}

fn occluded_by(tracer: Tracer, world: &World, rays: &Rays, hits: &mut Hits, choice: Choice) -> u64 {
    if let Some(ground) = &world.ground {
        occlude_by_ground(ground, rays, hits);
    }
    if world.features.translucent {
        return translucent::trace(tracer, Query::Any, world, rays, hits, choice);
    }
    trace(tracer, Query::Any, world, rays, hits)
}

/// Traces rays among the bodies that they can hit.
fn trace(tracer: Tracer, query: Query, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    if world.is_sliced() {
        return trace_sliced(tracer, query, world, rays, hits);
    }
    Bodies::all(world).trace(tracer, query, rays, hits)
}

/// Traces rays where slices hide bodies from the camera, or cut them.
#[cold]
fn trace_sliced(tracer: Tracer, query: Query, world: &World, rays: &Rays, hits: &mut Hits) -> u64 {
    // Only camera rays start on no surface, and they are never mixed with other rays.
    if rays.own.first() != Some(&MISS) {
        return trace_clipped(tracer, query, world, Bodies::all(world), rays, hits);
    }
    let (bodies, rays) = (Bodies::visible(world), toward_seen(world, rays));
    let exact = trace_clipped(tracer, query, world, bodies, &rays, hits);
    for hit in &mut hits.sphere[..rays.len()] {
        *hit = bodies.hit_in(world, *hit);
    }
    exact
}

/// Returns rays of the camera whose targets are rows of the spheres that it sees, in place of those of the world.
fn toward_seen<'a>(world: &World, rays: &'a Rays) -> Cow<'a, Rays> {
    let targets = |rays: &Rays| rays.target[..rays.len()].iter().any(|&target| target != MISS);
    let Some(visible) = world.camera_visible.as_ref().filter(|_| targets(rays)) else {
        return Cow::Borrowed(rays);
    };
    let (mut rays, count) = (rays.clone(), rays.len());
    for target in rays.target[..count].iter_mut().filter(|target| **target != MISS) {
        *target = visible.row_of(*target).unwrap_or(MISS);
    }
    Cow::Owned(rays)
}

/// Traces the parts of rays that are kept.
fn trace_clipped(
    tracer: Tracer,
    query: Query,
    world: &World,
    bodies: Bodies,
    rays: &Rays,
    hits: &mut Hits,
) -> u64 {
    if world.cut.is_empty() {
        return bodies.trace(tracer, query, rays, hits);
    }
    let mut clipped = ClippedRays::new(world, rays, hits, |_, point, _| bodies.enclosing(point));
    let exact = bodies.trace(tracer, query, &clipped.rays, &mut clipped.hits);
    clipped.write_hits(hits);
    exact
}
