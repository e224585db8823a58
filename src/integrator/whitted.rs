//! The paper's integrator: direct light with stratified shadow samples, and mirror and glass
//! bounces.
//!
//! After Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980, and Cook, Porter
//! and Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984. Diffuse surfaces take light from the
//! lights and the environment, by N samples each, and do not light one another. A path does not
//! branch: a mirror share goes on with its weight while the diffuse share is done with; glass and
//! rough metal choose one direction by chance.

use super::Job;
use super::bins::Bin;
use super::carried::CarriedRow;
use super::clock::Stage;
use super::gather::Starts;
use super::glass;
use super::path::{faint, survival};
use super::shadows;
use super::stages::{self, ByKind, Local};
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask, first_lanes};
use crate::ray::MISS;
use crate::sampling::{Frames, cosine_hemispheres};
use crate::scene::Rgb;
use crate::shade::{Bsdf, Material, One, mirror};
use crate::vec3::Vec3 as Row3;
use crate::world::{Kind, LightRow, MaterialId, ROW};
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
        glass::pass(job, work, bounce);
        let shade = Shade { job, bounce, samples, sky, faint };
        stages::by_kind(job.world, &mut ShadeAll { shade, work });
        stages::occlude(job, work);
        work.advance();
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
    for row in (0..work.len()).filter(|&row| work.hits.sphere[row] == MISS) {
        let direction = work.rays.direction.row(row);
        let suns: Rgb = job.world.lights.suns_toward(direction).map(|(_, radiance)| radiance).sum();
        let light = job.world.environment.radiance(direction) + suns;
        work.paths.radiance[work.carried.place(row)] += work.carried.throughput(row) * light;
    }
}

/// Likewise for emitters.
fn emit(job: &Job, work: &mut Workspace) {
    for row in work.bins.of(Kind::Emitter).into_iter().flat_map(Bin::each) {
        let material = job.world.material(work.hits.sphere[row]);
        let radiance = job.world.materials.emitter[material.row()].radiance;
        work.paths.radiance[work.carried.place(row)] += work.carried.throughput(row) * radiance;
    }
}

/// One bounce's shading.
#[derive(Clone, Copy)]
struct Shade<'a> {
    job: &'a Job<'a>,
    bounce: u32,
    samples: u32,
    sky: bool,
    faint: f32,
}

/// The same of the rows of a workspace.
struct ShadeAll<'a> {
    shade: Shade<'a>,
    work: &'a mut Workspace,
}

impl ByKind for ShadeAll<'_> {
    fn visit<M: Material>(&mut self, kind: Kind, table: impl Fn(MaterialId) -> M) {
        let Some(bin) = self.work.bins.take(kind) else { return };
        let world = self.shade.job.world;
        for row in bin.each() {
            let hit = self.work.hits.sphere[row];
            debug_assert_ne!(hit, MISS);
            let surface = table(world.material(hit)).tinted(world.color(hit));
            self.shade.shade(self.work, row, &surface);
        }
        self.work.bins.put(kind, bin);
    }
}

/// A surface that all of a row of shadow rays start from.
struct Base<M: Material> {
    row: usize,
    bsdf: M::Bsdf<F32x16>,
    frames: Frames<F32x16>,
    outgoing: Row3<F32x16>,
    starts: Starts,
}

impl<M: Material> Base<M> {
    fn new(work: &Workspace, row: usize, (surface, local): (&M, &Local)) -> Self {
        let starts = Starts::one(work, row, local);
        Self {
            row,
            bsdf: M::row(&One(surface)),
            frames: Frames::about(starts.at.normal),
            outgoing: Row3::from(local.outgoing).map(F32x16::splat),
            starts,
        }
    }
}

impl Shade<'_> {
    /// Number of the event in which light `light` is sampled: each has its own strata.
    fn event(&self, light: usize) -> u32 {
        self.bounce.wrapping_mul(0x9e37_79b9).wrapping_add(light as u32)
    }

    /// Shades what the path in a row has hit.
    fn shade<M: Material>(&self, work: &mut Workspace, row: usize, surface: &M) {
        let local = Local::new(work, row);
        let base = Base::<M>::new(work, row, (surface, &local));
        if M::BASE && base.bsdf.is_delta().bits() == 0 {
            for light in 0..self.job.world.lights.len() {
                self.direct(work, light, &base);
            }
            if self.sky {
                self.skylight(work, &base);
            }
        }
        self.go_on(work, (surface, &local), &base.starts);
    }

    /// Light from one light, by stratified samples; one is enough for a light without extent.
    fn direct<M: Material>(&self, work: &mut Workspace, light: usize, base: &Base<M>) {
        let world = self.job.world;
        let count = if world.lights.is_delta(light) { 1 } else { self.samples };
        let share = work.carried.throughput(base.row) / count as f32;
        let origin = (work.surface.point.row(base.row), work.hits.sphere[base.row]);
        let Some(aim) = world.lights.aim(world, light, origin) else { return };
        let points = self.job.sampler.split(&work.state(base.row), self.event(light), count);
        for (first, count) in rows(count) {
            let samples = aim.sample_row(points.row(first, count), count);
            self.cast(work, base, (share, &samples));
        }
    }

    /// Light from a constant or gradient environment, by stratified cosine-distributed samples.
    fn skylight<M: Material>(&self, work: &mut Workspace, base: &Base<M>) {
        let share = work.carried.throughput(base.row) / self.samples as f32;
        let event = self.event(self.job.world.lights.len());
        let points = self.job.sampler.split(&work.state(base.row), event, self.samples);
        for (first, count) in rows(self.samples) {
            let incoming = cosine_hemispheres(points.row(first, count));
            let direction = base.frames.to_world(incoming).normalize();
            let mut samples = LightRow::distant(direction, Rgb::ZERO, first_lanes(count));
            let mut weight = [[0.0; ROW]; 3];
            for (lane, cosine) in incoming.z.to_array().into_iter().enumerate().take(count) {
                let radiance = self.job.world.environment.radiance(samples.sample(lane).direction);
                let light = radiance * (PI / cosine.max(f32::MIN_POSITIVE));
                (0..3).for_each(|channel| weight[channel][lane] = light[channel]);
            }
            let [r, g, b] = weight.map(F32x16::new);
            samples.weight = Row3::new(r, g, b);
            self.cast(work, base, (share, &samples));
        }
    }

    /// Queues the shadow rays of a row of light samples.
    #[inline(always)]
    fn cast<M: Material>(
        &self,
        work: &mut Workspace,
        base: &Base<M>,
        (share, samples): (Rgb, &LightRow),
    ) {
        let incoming = base.frames.to_local(samples.direction);
        let response = base.bsdf.eval(base.outgoing, incoming);
        let share = Row3::from(share).map(F32x16::splat);
        let light = share.times(response).times(samples.weight);
        let above = Lanes::lt(F32x16::splat(0.0), incoming.z).bits();
        shadows::cast(self.job, work, &base.starts, (samples, samples.lanes & above), light);
    }

    /// Sends the mirrored share on, or what has no other share.
    fn go_on<M: Material>(
        &self,
        work: &mut Workspace,
        (surface, local): (&M, &Local),
        starts: &Starts,
    ) {
        let bsdf: M::Bsdf<f32> = M::row(&One(surface));
        let outgoing = local.outgoing.into();
        let row = starts.rows.to_array()[0] as usize;
        let draw = self.job.sampler.scatter(&work.state(row), self.bounce);
        let (incoming, weight) = if M::BASE {
            (mirror(outgoing), bsdf.mirrored(outgoing))
        } else {
            let scatter = bsdf.sample(outgoing, draw.direction, draw.lobe);
            (scatter.incoming, scatter.weight)
        };
        let throughput = work.carried.throughput(row) * Rgb::from(weight);
        let greatest = throughput.max_element();
        let survival = survival(self.job.settings.roulette, greatest, self.bounce, self.faint);
        if throughput == Rgb::ZERO || draw.roulette >= survival {
            return;
        }
        let splat = |v: glam::Vec3| Row3::from(v).map(F32x16::splat);
        let direction = splat(local.to_world(incoming.into()));
        let carried = CarriedRow { throughput: splat(throughput / survival), ..starts.carried };
        work.go_on(self.job.world, (starts, 1), direction, &carried);
    }
}

/// Divides so many samples into rows: the first of each, and how many it has.
fn rows(count: u32) -> impl Iterator<Item = (u32, usize)> {
    (0..count).step_by(ROW).map(move |first| (first, ROW.min((count - first) as usize)))
}
