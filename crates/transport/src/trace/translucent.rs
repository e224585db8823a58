//! Rays in worlds with translucent bodies.
//!
//! Rays are first traced as if all bodies were opaque, which is right for those whose first hit is opaque. The others are
//! traced again, one by one, with all bodies that they intersect ([`TranslucentBodies`](crate::translucency::TranslucentBodies)).
//!
//! Rays of the camera choose one of their bodies even if they could pass all of them, and get the light behind the bodies besides:
//! what would be a few bright dots among many dark ones has no noise. Where a cut clips them, they end or pass by chance.

use super::bodies::Bodies;
use super::clipped::{ClippedRays, Crossing};
use super::{Query, Tracer};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::sampling::{mix, stream, unit};
use crate::scene::Rgb;
use crate::translucency::{self, AttenuatedRay, Fragment, OpticalDepth, SeenBody};
use crate::world::World;
use glam::Vec3;
use std::borrow::Cow;

/// The choice of the bodies at which rays end.
pub(super) enum Choice<'a> {
    /// Each ray ends or passes, decided by a hash of the ray.
    Hashed,
    /// By a number for each ray, from 0 up to 1. Those that nothing opaque stops choose one of the bodies always.
    Given(Chosen<'a>),
    /// No body: shadow rays pass all of them, and find the part of their light that does, by row; 1 on entry.
    Transmittance(&'a mut [f32]),
}

/// Numbers of camera rays, and what their hits stand for.
pub(crate) struct Chosen<'a> {
    /// By row: a number from 0 up to 1.
    pub numbers: &'a [f32],
    /// By row: 1 on entry, and on return the part of the ray's light that its hit stands for, from 0 to 1; the rest comes from
    /// behind all bodies.
    pub coverage: &'a mut [f32],
    /// By row: 0 on entry, and on return the sum of the albedos of all bodies on the ray, less that of its hit, each times the part
    /// of the ray's light that it stands for. Empty if it is not asked for.
    pub missing_albedo: &'a mut [Rgb],
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
    rays: &Rays,
    hits: &mut Hits,
    choice: Choice,
) -> u64 {
    let from_camera = rays.own.first() == Some(&MISS);
    let bodies = if from_camera { Bodies::visible(world) } else { Bodies::all(world) };
    let rays = &*if from_camera { super::toward_seen(world, rays) } else { Cow::Borrowed(rays) };
    let threshold = |row| {
        OpticalDepth::threshold(f64::from(match &choice {
            Choice::Hashed | Choice::Transmittance(_) => hashed(rays, row),
            Choice::Given(Chosen { numbers, .. }) => numbers[row],
        }))
    };
    let thresholds = (0..rays.len()).map(threshold).collect();
    let mut job = TranslucentTrace { tracer, query, world, bodies, from_camera, thresholds };
    let exact = if world.cut.is_empty() {
        job.trace(rays, hits, choice)
    } else {
        let cap = |row, point, crossing| job.cap(row, point, crossing);
        let mut clipped = ClippedRays::new(world, rays, hits, cap);
        let exact = job.trace(&clipped.rays, &mut clipped.hits, Choice::Hashed);
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

    /// Returns the composited albedo of the bodies on a ray of the camera, less that of the one that is seen.
    fn missing_albedo(&self, seen: &SeenBody, fragments: &[Fragment]) -> Rgb {
        let mut missing = Rgb::ZERO;
        for (hit, share) in translucency::shares(fragments) {
            let share = share - if hit == seen.hit { seen.coverage } else { 0.0 };
            missing += share as f32 * self.world.albedo(self.bodies.hit_in(self.world, hit));
        }
        missing
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
    fn trace(&self, rays: &Rays, hits: &mut Hits, mut choice: Choice) -> u64 {
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
                    let (body, decided) = if let Choice::Given(chosen) = &mut choice {
                        let number = f64::from(chosen.numbers[row]);
                        let seen = bodies.choose(&attenuated(), number, &mut fragments);
                        chosen.coverage[row] = seen.0.coverage as f32;
                        if let Some(missing) = chosen.missing_albedo.get_mut(row) {
                            *missing = self.missing_albedo(&seen.0, &fragments);
                        }
                        seen
                    } else {
                        bodies.closest(&attenuated(), &mut fragments)
                    };
                    hits.set(row, body.t, body.hit);
                    exact += decided;
                }
                // One opaque body is enough.
                Query::Any if known.1 == MISS && !self.depth(hits.sphere[row]).is_opaque() => {
                    let (occluded, decided) = if let Choice::Transmittance(passing) = &mut choice {
                        let (part, decided) = bodies.transmittance(&attenuated());
                        passing[row] = part as f32;
                        (part == 0.0, decided)
                    } else {
                        bodies.occluded(&attenuated())
                    };
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
