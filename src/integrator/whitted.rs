//! The paper's integrator: direct light with stratified shadow samples, and mirror and glass
//! bounces.
//!
//! After Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980, and Cook, Porter
//! and Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984. Diffuse surfaces take light from the
//! lights and the environment, by N samples each, and do not light one another. A path does not
//! branch: a mirror share goes on with its weight while the diffuse share is done with; glass and
//! rough metal choose one direction by chance.

use super::Job;
use super::clock::Stage;
use super::path::{cast_shadow, survival};
use super::stages::{self, Local, ShadeKind};
use super::workspace::{Arrival, Workspace};
use crate::ray::MISS;
use crate::sampling::cosine_hemisphere;
use crate::scene::Rgb;
use crate::shade::{Bsdf, mirror};
use crate::world::{Kind, LightSample, MaterialId};
use std::f32::consts::PI;

/// Follows all paths to their ends, with `samples` shadow samples per light and hit.
pub fn integrate(job: &Job, work: &mut Workspace, samples: u32) {
    // The environment is one more light where it is seen by diffuse surfaces and has no light of
    // its own.
    let sky = job.world.environment.illuminates
        && !job.world.environment.is_black()
        && !job.world.lights.sky;
    for bounce in 0.. {
        stages::intersect(job, work);
        escape(job, work);
        emit(job, work);
        if bounce == job.depth() {
            work.counters.cut_paths += work.bins.scattered();
            return;
        }
        stages::glass(job, work, bounce);
        stages::by_kind(job, work, &mut Shade { job, bounce, samples, sky });
        stages::occlude(job, work);
        work.compact();
        work.clock.end(Stage::Shade);
        if work.is_empty() {
            return;
        }
        work.counters.bounce_rays += work.len() as u64;
    }
}

/// What leaves the scene has come from the camera by mirrors and glass alone, and sees the
/// environment and the suns.
fn escape(job: &Job, work: &mut Workspace) {
    for i in 0..work.bins.escaped.len() {
        let row = work.bins.escaped[i] as usize;
        let place = work.place[row] as usize;
        let direction = work.rays.direction.row(row);
        let suns: Rgb = job.world.lights.suns_toward(direction).map(|(radiance, _)| radiance).sum();
        let light = job.world.environment.radiance(direction) + suns;
        work.paths.radiance[place] += work.paths.throughput[place] * light;
        work.end(row);
    }
}

/// Likewise for emitters.
fn emit(job: &Job, work: &mut Workspace) {
    for i in 0..work.bins.kind[Kind::Emitter as usize].len() {
        let row = work.bins.kind[Kind::Emitter as usize][i] as usize;
        let place = work.place[row] as usize;
        let material = job.world.material(work.hits.sphere[row]);
        let radiance = job.world.materials.emitter[material.row()].radiance;
        work.paths.radiance[place] += work.paths.throughput[place] * radiance;
    }
}

/// One bounce's shading.
struct Shade<'a> {
    job: &'a Job<'a>,
    bounce: u32,
    samples: u32,
    sky: bool,
}

impl ShadeKind for Shade<'_> {
    fn shade<B: Bsdf>(&mut self, work: &mut Workspace, kind: Kind, bsdf: impl Fn(MaterialId) -> B) {
        let rows = std::mem::take(&mut work.bins.kind[kind as usize]);
        for &row in &rows {
            let row = row as usize;
            let hit = work.hits.sphere[row];
            debug_assert_ne!(hit, MISS);
            let bsdf = bsdf(self.job.world.material(hit)).tinted(self.job.world.color(hit));
            let local = Local::new(work, row);
            if bsdf.mirrored(local.outgoing).is_some() && !bsdf.is_delta() {
                for light in 0..self.job.world.lights.len() {
                    self.direct(work, row, light, (&bsdf, &local));
                }
                if self.sky {
                    self.skylight(work, row, &bsdf, &local);
                }
            }
            self.go_on(work, row, &bsdf, &local);
        }
        work.bins.kind[kind as usize] = rows;
    }
}

impl Shade<'_> {
    /// Number of the event in which light `light` is sampled: each has its own strata.
    fn event(&self, light: usize) -> u32 {
        self.bounce.wrapping_mul(0x9e37_79b9).wrapping_add(light as u32)
    }

    /// Light from one light, by stratified samples; one is enough for a light without extent.
    fn direct<B: Bsdf>(
        &self,
        work: &mut Workspace,
        row: usize,
        light: usize,
        (bsdf, local): (&B, &Local),
    ) {
        let world = self.job.world;
        let place = work.place[row] as usize;
        let count = if world.lights.is_delta(light) { 1 } else { self.samples };
        let share = work.paths.throughput[place] / count as f32;
        let origin = (work.surface.point[row], work.hits.sphere[row]);
        let Some(aim) = world.lights.aim(world, light, origin) else { return };
        let points = self.job.sampler.split(&work.paths.sample[place], self.event(light), count);
        for i in 0..count {
            let Some(sample) = aim.sample(points.pair(i)) else { continue };
            let incoming = local.frame.to_local(sample.direction);
            if incoming.z > 0.0 {
                let response = bsdf.eval(local.outgoing, incoming);
                let light = share * response * sample.weight;
                cast_shadow(self.job, work, row, (&sample, light), local.inside);
            }
        }
    }

    /// Light from a constant or gradient environment, by stratified cosine-distributed samples.
    fn skylight<B: Bsdf>(&self, work: &mut Workspace, row: usize, bsdf: &B, local: &Local) {
        let place = work.place[row] as usize;
        let share = work.paths.throughput[place] / self.samples as f32;
        let event = self.event(self.job.world.lights.len());
        let points = self.job.sampler.split(&work.paths.sample[place], event, self.samples);
        for i in 0..self.samples {
            let incoming = cosine_hemisphere(points.pair(i));
            let direction = local.to_world(incoming);
            let radiance = self.job.world.environment.radiance(direction);
            let sample = LightSample {
                direction,
                t: f64::INFINITY,
                target: MISS,
                weight: radiance * (PI / incoming.z.max(f32::MIN_POSITIVE)),
                pdf: None,
                close: false,
            };
            let light = share * bsdf.eval(local.outgoing, incoming) * sample.weight;
            cast_shadow(self.job, work, row, (&sample, light), local.inside);
        }
    }

    /// Sends the mirrored share on, or what has no other share.
    fn go_on<B: Bsdf>(&self, work: &mut Workspace, row: usize, bsdf: &B, local: &Local) {
        let place = work.place[row] as usize;
        let draw = self.job.sampler.scatter(&work.paths.sample[place], self.bounce);
        let next = match bsdf.mirrored(local.outgoing) {
            Some(share) => Some((mirror(local.outgoing), share)),
            None => bsdf
                .sample(local.outgoing, draw.direction, draw.lobe)
                .map(|scatter| (scatter.incoming, scatter.weight)),
        };
        let Some((incoming, weight)) = next else { return work.end(row) };
        let throughput = work.paths.throughput[place] * weight;
        let survival = survival(self.job.settings.roulette, throughput, self.bounce);
        if throughput == Rgb::ZERO || draw.roulette >= survival {
            return work.end(row);
        }
        work.paths.throughput[place] = throughput / survival;
        work.paths.arrival[place] = Arrival::CAMERA;
        let direction = local.to_world(incoming);
        work.go_on(self.job.world, row, direction, local.inside);
    }
}
