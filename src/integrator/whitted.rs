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
use super::path::{faint, hides, survival};
use super::stages::{self, Local, ShadeKind};
use super::workspace::{Arrival, Workspace};
use crate::lanes::{F32x16, set_bits};
use crate::ray::MISS;
use crate::sampling::cosine_hemispheres;
use crate::scene::Rgb;
use crate::shade::{Bsdf, mirror};
use crate::vec3::Vec3 as Row3;
use crate::world::{Kind, LightRow, MaterialId, ROW};
use glam::Vec3;
use std::f32::consts::PI;

/// Follows all paths to their ends, with `samples` shadow samples per light and hit.
pub fn integrate(job: &Job, work: &mut Workspace, samples: u32) {
    // The environment is one more light where it is seen by diffuse surfaces and has no light of
    // its own.
    let sky = job.world.environment.illuminates
        && !job.world.environment.is_black()
        && !job.world.lights.sky;
    let faint = faint(job.world);
    for bounce in 0.. {
        stages::intersect(job, work);
        escape(job, work);
        emit(job, work);
        if bounce == job.depth() {
            work.counters.cut_paths += work.bins.scattered();
            return;
        }
        stages::glass(job, work, bounce);
        stages::by_kind(job, work, &mut Shade { job, bounce, samples, sky, faint });
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
        let suns: Rgb = job.world.lights.suns_toward(direction).map(|(_, radiance)| radiance).sum();
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
    faint: f32,
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
        for (first, count) in rows(count) {
            let samples = aim.sample_row(points.row(first, count), count);
            self.cast(work, row, (bsdf, local), (share, &samples));
        }
    }

    /// Light from a constant or gradient environment, by stratified cosine-distributed samples.
    fn skylight<B: Bsdf>(&self, work: &mut Workspace, row: usize, bsdf: &B, local: &Local) {
        let place = work.place[row] as usize;
        let share = work.paths.throughput[place] / self.samples as f32;
        let event = self.event(self.job.world.lights.len());
        let points = self.job.sampler.split(&work.paths.sample[place], event, self.samples);
        for (first, count) in rows(self.samples) {
            let incoming = cosine_hemispheres(points.row(first, count));
            let direction = local.row_to_world(incoming);
            let mut samples = LightRow::distant(direction, Rgb::ZERO, count);
            let mut weight = [[0.0; ROW]; 3];
            for (lane, cosine) in incoming.z.to_array().into_iter().enumerate().take(count) {
                let radiance = self.job.world.environment.radiance(samples.sample(lane).direction);
                let light = radiance * (PI / cosine.max(f32::MIN_POSITIVE));
                (0..3).for_each(|channel| weight[channel][lane] = light[channel]);
            }
            let [r, g, b] = weight.map(F32x16::new);
            samples.weight = Row3::new(r, g, b);
            self.cast(work, row, (bsdf, local), (share, &samples));
        }
    }

    /// Queues the shadow rays of a row of light samples; traces the queue when it is full.
    #[inline]
    fn cast<B: Bsdf>(
        &self,
        work: &mut Workspace,
        row: usize,
        (bsdf, local): (&B, &Local),
        (share, samples): (Rgb, &LightRow),
    ) {
        let Row3 { x, y, z } = local.frame.row_to_local(samples.direction).map(F32x16::to_array);
        let weight = samples.weight.map(F32x16::to_array);
        let (mut light, mut lanes) = ([Rgb::ZERO; ROW], 0);
        for lane in 0..samples.count {
            let response = bsdf.eval(local.outgoing, Vec3::new(x[lane], y[lane], z[lane]));
            let weight = Rgb::new(weight.x[lane], weight.y[lane], weight.z[lane]);
            light[lane] = share * response * weight;
            let arrives = z[lane] > 0.0 && light[lane].max_element() > 0.0;
            lanes |= u32::from(arrives) << lane;
        }
        if local.inside {
            let hidden = |&lane: &usize| hides(self.job.world, work, row, &samples.sample(lane));
            lanes = set_bits(lanes).filter(hidden).fold(lanes, |lanes, lane| lanes ^ 1 << lane);
        }
        if !work.shadows.has_room(ROW) {
            stages::occlude(self.job, work);
        }
        let from = (work.surface.point[row], work.hits.sphere[row]);
        work.shadows.push_row(from, (samples, lanes), (work.place[row], &light));
    }

    /// Sends the mirrored share on, or what has no other share.
    fn go_on<B: Bsdf>(&self, work: &mut Workspace, row: usize, bsdf: &B, local: &Local) {
        let mirrored = bsdf.mirrored(local.outgoing);
        if mirrored == Some(Rgb::ZERO) {
            return work.end(row);
        }
        let place = work.place[row] as usize;
        let draw = self.job.sampler.scatter(&work.paths.sample[place], self.bounce);
        let next = match mirrored {
            Some(share) => Some((mirror(local.outgoing), share)),
            None => bsdf
                .sample(local.outgoing, draw.direction, draw.lobe)
                .map(|scatter| (scatter.incoming, scatter.weight)),
        };
        let Some((incoming, weight)) = next else { return work.end(row) };
        let throughput = work.paths.throughput[place] * weight;
        let survival = survival(self.job.settings.roulette, throughput, self.bounce, self.faint);
        if throughput == Rgb::ZERO || draw.roulette >= survival {
            return work.end(row);
        }
        work.paths.throughput[place] = throughput / survival;
        work.paths.arrival[place] = Arrival::CAMERA;
        let direction = local.to_world(incoming);
        work.go_on(self.job.world, row, direction, local.inside);
    }
}

/// Divides so many samples into rows: the first of each, and how many it has.
fn rows(count: u32) -> impl Iterator<Item = (u32, usize)> {
    (0..count).step_by(ROW).map(move |first| (first, ROW.min((count - first) as usize)))
}
