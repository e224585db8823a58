//! Light that smooth coats and glass mirror: suns and emitters in the mirrored direction.
//!
//! A path that meets such a surface chooses at random whether it is mirrored, with the small probability
//! of the reflectance; the few paths that find a bright light in this way would bring most of the noise.
//! But the direction is known, so a shadow ray finds the same light without chance, weighted by the
//! reflectance. Paths that are mirrored, and reach such a light next, leave it out.

use super::Job;
use super::caustics::{self, ReachedEmitter};
use super::path_state::PreviousBounce;
use super::shadow_queue::{self, ShadowRay};
use super::workspace::Workspace;
use crate::intersect;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, U32x16, set_bits};
use crate::ray::{ExactRay, MISS};
use crate::scene::{Integrator, Rgb};
use crate::vec3::Vec3;
use crate::world::{CausticSource, World};

/// A row of smooth surfaces.
pub(super) struct MirrorRow<'a> {
    /// Rows of the rays that hit them.
    pub(super) rays: U32x16,
    /// Spheres that the points lie on.
    pub(super) own: &'a [u32; MAX_LANES],
    /// Indices of the paths.
    pub(super) path: U32x16,
    /// Previous bounces of the paths.
    pub(super) previous: PreviousBounce<F32x16>,
    pub(super) point: Vec3<F32x16>,
    /// Mirrored directions.
    pub(super) direction: Vec3<F32x16>,
}

/// A light in a mirrored direction.
struct Target {
    source: CausticSource,
    radiance: Rgb,
    /// Distance, and row of an emissive sphere.
    end: (f64, u32),
}

impl Job<'_> {
    /// Returns whether mirrored light is sampled: only in path tracing, which leaves it out of the paths
    /// that find it.
    pub(super) fn samples_mirrored_light(&self) -> bool {
        self.settings.caustics
            && self.settings.integrator == Integrator::Path
            && self.world.lights.samples_mirrored_light()
    }
}

/// Enqueues shadow rays toward lights in the mirrored directions of `lanes`, on the outside of smooth
/// surfaces. `factor` computes the throughput times the reflectance.
#[inline(always)]
pub(super) fn sample_mirrored_light(
    job: &Job,
    work: &mut Workspace,
    row: &MirrorRow,
    lanes: u32,
    factor: impl FnOnce() -> Vec3<F32x16>,
) {
    let near = lanes & lights_toward(job.world, row);
    if near != 0 {
        enqueue(job, work, row, near, factor());
    }
}

/// Returns the lanes whose mirrored direction may meet a light.
#[inline(never)]
fn lights_toward(world: &World, row: &MirrorRow) -> u32 {
    let mut lanes = 0;
    for sun in &world.lights.suns {
        let Some(disc) = sun.disc else { continue };
        let Vec3 { x, y, z } = row.direction;
        let center = sun.direction;
        let (x, y, z) =
            (x - F32x16::splat(center.x), y - F32x16::splat(center.y), z - F32x16::splat(center.z));
        let height = (x * x + y * y + z * z) * F32x16::splat(0.5);
        // Wider than rounding.
        lanes |= Lanes::le(height, F32x16::splat(disc.height() * 1.001)).bits();
    }
    for &emitter in &world.lights.emitters {
        let (center, radius) =
            (world.spheres.center(emitter as usize), world.spheres.radius(emitter as usize));
        let toward = Vec3::splat(center.x, center.y, center.z) - row.point;
        let along = toward.dot(row.direction);
        let off = toward - row.direction * along;
        let most =
            toward.dot(toward) * F32x16::splat(1e-6) + F32x16::splat(1.001 * radius * radius);
        let meets = Lanes::le(off.dot(off), most) & Lanes::lt(F32x16::splat(0.0), along);
        lanes |= meets.bits();
    }
    lanes
}

#[inline(never)]
fn enqueue(job: &Job, work: &mut Workspace, row: &MirrorRow, lanes: u32, factor: Vec3<F32x16>) {
    for lane in set_bits(lanes) {
        let one = |v: Vec3<F32x16>| -> glam::Vec3 { v.map(|row| row.to_array()[lane]).into() };
        let (point, direction, factor) = (one(row.point), one(row.direction), one(factor));
        let ray = row.rays.to_array()[lane] as usize;
        let previous = PreviousBounce(row.previous.0.to_array()[lane]);
        let suns = 0..job.world.lights.suns.len();
        let emitters = 0..job.world.lights.emitters.len();
        let targets = suns.filter_map(|sun| sun_toward(job.world, sun, direction)).chain(
            emitters.filter_map(|emitter| {
                emitter_toward(job.world, emitter, point, direction, row.own[lane])
            }),
        );
        for target in targets {
            let end = match target.source {
                CausticSource::Sphere(_) => point + direction * target.end.0 as f32,
                CausticSource::Sun(_) => direction,
            };
            let reached = ReachedEmitter { source: target.source, end, toward: direction };
            let weight = caustics::mirrored_weight(job, work, ray, previous, &reached);
            let light = factor * target.radiance * weight;
            if light.max_element() <= 0.0 {
                continue;
            }
            if !work.shadow_queue.has_room(1) {
                shadow_queue::trace_shadow_rays(job, work);
            }
            work.shadow_queue.push(&ShadowRay {
                start: (point, row.own[lane]),
                direction,
                end: target.end,
                path: row.path.to_array()[lane],
                light,
            });
        }
    }
}

/// Returns a sun if it is in this direction.
fn sun_toward(world: &World, index: usize, direction: glam::Vec3) -> Option<Target> {
    let sun = &world.lights.suns[index];
    sun.is_toward(direction).then_some(Target {
        source: CausticSource::Sun(index),
        radiance: sun.radiance,
        end: (f64::INFINITY, MISS),
    })
}

/// Returns an emissive sphere if a ray from outside of it meets it.
fn emitter_toward(
    world: &World,
    index: usize,
    point: glam::Vec3,
    direction: glam::Vec3,
    own: u32,
) -> Option<Target> {
    let row = world.lights.emitters[index];
    if row == own || !is_outside(world, row, point) {
        return None;
    }
    let (center, radius) = world.spheres.exact(row as usize);
    let root =
        intersect::confirm(&ExactRay::new(point, direction, true), center, radius, || false)?;
    Some(Target {
        source: CausticSource::Sphere(row),
        radiance: world.lights.radiance[index],
        end: (root.t, row),
    })
}

/// Returns whether mirrored light of an emissive sphere is sampled at a point.
pub(super) fn is_sampled(world: &World, row: u32, point: glam::Vec3) -> bool {
    world.lights.emitter_index(&world.spheres, row).is_some() && is_outside(world, row, point)
}

/// Returns whether a point is outside of a sphere.
fn is_outside(world: &World, row: u32, point: glam::Vec3) -> bool {
    let (center, radius) = world.spheres.exact(row as usize);
    center.distance_squared(point.as_dvec3()) > radius * radius
}
