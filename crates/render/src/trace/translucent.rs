//! Rays in worlds with translucent bodies.
//!
//! Rays are first traced as if all bodies were opaque, which is right for those whose first hit is opaque. The others are
//! traced again, one by one, with all bodies that they intersect ([`TranslucentBodies`](crate::translucency::TranslucentBodies)).

use super::bodies::Bodies;
use super::clipped::{ClippedRays, Crossing};
use super::{Query, Tracer};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::sampling::{mix, stream, unit};
use crate::translucency::{AttenuatedRay, Fragment, OpticalDepth};
use crate::world::World;
use glam::Vec3;

/// Uniform random numbers that decide at which translucent bodies rays end.
#[derive(Clone, Copy)]
pub(super) enum Thresholds<'a> {
    /// A hash of each ray.
    Hashed,
    /// A number for each ray, from 0 up to 1.
    Given(&'a [f32]),
}

impl Thresholds<'_> {
    /// The depth at which the ray of a row ends.
    fn of(self, rays: &Rays, row: usize) -> OpticalDepth {
        OpticalDepth::threshold(match self {
            Self::Hashed => hashed(rays, row),
            Self::Given(numbers) => numbers[row],
        })
    }
}

/// Returns a number that depends on a ray alone.
fn hashed(rays: &Rays, row: usize) -> f32 {
    let [x, y, z] = rays.origin.row(row).to_array().map(|value| u64::from(value.to_bits()));
    let [u, v, w] = rays.direction.row(row).to_array().map(|value| u64::from(value.to_bits()));
    let bits = stream(mix(x << 32 | u), stream(mix(y << 32 | v), mix(z << 32 | w)));
    unit((bits >> 32) as u32)
}

/// Traces rays, those of the camera among the bodies that it sees. Returns the number of decisions made by exact integer
/// arithmetic.
#[cold]
pub(super) fn trace(
    tracer: Tracer,
    query: Query,
    world: &World,
    (rays, hits): (&Rays, &mut Hits),
    thresholds: Thresholds,
) -> u64 {
    let from_camera = rays.own.first() == Some(&MISS);
    let bodies = if from_camera { Bodies::visible(world) } else { Bodies::all(world) };
    let all: Vec<OpticalDepth> = (0..rays.len()).map(|row| thresholds.of(rays, row)).collect();
    let mut job = TranslucentTrace { tracer, query, world, bodies, from_camera, thresholds: all };
    let exact = if world.cut.is_empty() {
        job.trace(rays, hits)
    } else {
        let cap = |row, point, crossing| job.cap(row, point, crossing);
        let mut clipped = ClippedRays::new(world, rays, hits, cap);
        let exact = job.trace(&clipped.rays, &mut clipped.hits);
        clipped.write_hits(hits);
        exact
    };
    if from_camera {
        for hit in &mut hits.sphere[..rays.len()] {
            *hit = bodies.hit_in(world, *hit);
        }
    }
    exact
}

/// A query of a batch of rays, with the optical depth at which each ends.
struct TranslucentTrace<'a> {
    tracer: Tracer,
    query: Query,
    world: &'a World,
    bodies: Bodies<'a>,
    /// True if the bodies are those that the camera sees.
    from_camera: bool,
    thresholds: Vec<OpticalDepth>,
}

impl TranslucentTrace<'_> {
    /// The optical depth of the body of a hit.
    fn depth(&self, hit: u32) -> OpticalDepth {
        if hit >= GROUND {
            return OpticalDepth::OPAQUE;
        }
        let hit = if self.from_camera { self.bodies.hit_in(self.world, hit) } else { hit };
        self.world.optical_depth(hit)
    }

    /// Returns the body whose cap a ray hits at a point of a cut. The cap of a translucent body has its opacity where rays
    /// enter the region that is kept, and is not there where they leave it.
    fn cap(&mut self, row: usize, point: Vec3, crossing: Crossing) -> Option<u32> {
        for body in self.bodies.all_enclosing(point) {
            let depth = self.depth(body);
            let threshold = &mut self.thresholds[row];
            match crossing {
                _ if depth.is_opaque() => return Some(body),
                Crossing::Entry if depth >= *threshold => return Some(body),
                Crossing::Entry => *threshold = threshold.after(depth),
                Crossing::Exit => {}
            }
        }
        None
    }

    /// Traces rays that no cut clips any more.
    fn trace(&self, rays: &Rays, hits: &mut Hits) -> u64 {
        let known: Vec<(f64, u32)> =
            (0..rays.len()).map(|row| (hits.t[row], hits.sphere[row])).collect();
        let mut exact = self.bodies.trace(self.tracer, self.query, rays, hits);
        let bodies = self.bodies.translucent(|hit| self.depth(hit));
        let mut fragments: Vec<Fragment> = Vec::new();
        for (row, &known) in known.iter().enumerate() {
            let attenuated = || AttenuatedRay {
                ray: rays.exact(row),
                ends: [rays.own[row], rays.target[row]],
                threshold: self.thresholds[row],
                known,
            };
            match self.query {
                Query::Closest if !self.depth(hits.sphere[row]).is_opaque() => {
                    let (t, hit, decided) = bodies.closest(&attenuated(), &mut fragments);
                    hits.set(row, t, hit);
                    exact += decided;
                }
                // One opaque body is enough.
                Query::Any if known.1 == MISS && !self.depth(hits.sphere[row]).is_opaque() => {
                    let (occluded, decided) = bodies.occluded(&attenuated());
                    if !occluded {
                        hits.sphere[row] = MISS;
                    }
                    exact += decided;
                }
                _ => {}
            }
        }
        exact
    }
}
