//! Path tracing with next-event estimation and multiple importance sampling.
//!
//! At each surface a path looks for light at one light, chosen by what each would give there, and
//! goes on in a direction sampled from the material. Light that both ways can find is weighted by the power heuristic
//! (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH
//! 1995), but from a diffuse surface a light that is not close, a sun or a point is left to the
//! light samples alone: adding the other way would only add variance. A constant or gradient
//! environment is left to the material's samples alone.

use super::Job;
use super::clock::Stage;
use super::diffuse;
use super::look::Look;
use super::stages::{self, Local, ShadeKind};
use super::workspace::{Arrival, Workspace};
use crate::lanes::MAX_LANES;
use crate::ray::GROUND;
use crate::sampling::ScatterDraw;
use crate::scene::{Rgb, Roulette};
use crate::shade::Bsdf;
use crate::world::{Kind, LightSample, MaterialId, Receiver, World};
use glam::Vec3;

/// Follows all paths to their ends.
pub fn integrate(job: &Job, work: &mut Workspace) {
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
        stages::by_kind(job, work, &mut Shade { job, bounce, faint });
        stages::occlude(job, work);
        work.compact();
        work.clock.end(Stage::Shade);
        if work.is_empty() {
            return;
        }
        work.counters.bounce_rays += work.len() as u64;
    }
}

/// Gives the environment's light, and the suns', to paths that leave the scene.
fn escape(job: &Job, work: &mut Workspace) {
    let world = job.world;
    for i in 0..work.bins.escaped.len() {
        let row = work.bins.escaped[i] as usize;
        let place = work.place[row] as usize;
        let arrival = work.paths.arrival[place];
        let direction = work.rays.direction.row(row);
        let mut light = Rgb::ZERO;
        if world.environment.illuminates || arrival.unscattered {
            let weight = heuristic(arrival.pdf, || {
                world.lights.sky_pdf(&world.environment, direction, &receiver(work, row))
            });
            light += world.environment.radiance(direction) * weight;
        }
        if !arrival.diffuse {
            for (sun, radiance) in world.lights.suns_toward(direction) {
                let pdf = || world.lights.sun_pdf(sun, &receiver(work, row));
                light += radiance * heuristic(arrival.pdf, pdf);
            }
        }
        work.paths.radiance[place] += work.paths.throughput[place] * light;
        work.end(row);
    }
}

/// Gives the light of emitters to paths that hit them.
fn emit(job: &Job, work: &mut Workspace) {
    let world = job.world;
    for i in 0..work.bins.kind[Kind::Emitter as usize].len() {
        let row = work.bins.kind[Kind::Emitter as usize][i] as usize;
        let place = work.place[row] as usize;
        let arrival = work.paths.arrival[place];
        let hit = work.hits.sphere[row];
        let weight = match arrival.pdf {
            None => 1.0,
            Some(pdf) => {
                match world.lights.emitter_pdf(&world.spheres, hit, &receiver(work, row)) {
                    (_, false) if arrival.diffuse => 0.0,
                    (other, _) => heuristic(Some(pdf), || other),
                }
            }
        };
        let radiance = world.materials.emitter[world.material(hit).row()].radiance;
        work.paths.radiance[place] += work.paths.throughput[place] * radiance * weight;
    }
}

/// Where the path in `row` looked for light last.
fn receiver(work: &Workspace, row: usize) -> Receiver {
    let normal = work.paths.normal.get(work.place[row] as usize).copied().unwrap_or_default();
    Receiver { point: work.rays.origin.row(row), normal, own: work.rays.own[row] }
}

/// Weight of what was found with density `found` and might have been found with density `other`.
/// `None` is a density that is infinite.
pub fn heuristic(found: Option<f32>, other: impl FnOnce() -> f32) -> f32 {
    let Some(found) = found else { return 1.0 };
    let other = other();
    if other == 0.0 {
        return 1.0;
    }
    // By the ratio, whose square may overflow to the right limit.
    1.0 / (1.0 + (other / found).powi(2))
}

/// One bounce's shading.
struct Shade<'a> {
    job: &'a Job<'a>,
    bounce: u32,
    faint: f32,
}

impl ShadeKind for Shade<'_> {
    fn shade<B: Bsdf>(&mut self, work: &mut Workspace, kind: Kind, bsdf: impl Fn(MaterialId) -> B) {
        let rows = std::mem::take(&mut work.bins.kind[kind as usize]);
        if B::DIFFUSE {
            for rows in rows.chunks(MAX_LANES) {
                diffuse::shade(self.job, work, self.bounce, (rows, &bsdf));
            }
        } else {
            rows.chunks(MAX_LANES).for_each(|rows| self.shade_row(work, rows, &bsdf));
        }
        work.bins.kind[kind as usize] = rows;
    }
}

impl Shade<'_> {
    /// Samples a light for each of at most sixteen rows, and sends their paths on or ends them.
    fn shade_row<B: Bsdf>(
        &self,
        work: &mut Workspace,
        rows: &[u32],
        bsdf: &impl Fn(MaterialId) -> B,
    ) {
        let (job, world) = (self.job, self.job.world);
        let samples = work.samples(rows);
        let look = job.has_lights().then(|| Look::new(job, &samples, self.bounce, rows.len()));
        let draws = job.sampler.scatter_row(&samples, self.bounce, true).each();
        for ((lane, &row), draw) in rows.iter().enumerate().zip(&draws) {
            let row = row as usize;
            let hit = work.hits.sphere[row];
            let bsdf = bsdf(world.material(hit)).tinted(world.color(hit));
            let local = Local::new(work, row);
            if let Some(look) = look.as_ref().filter(|_| !bsdf.is_delta()) {
                let sampled = look.sample(job, work, (lane, row), local.frame.normal);
                if let Some(sampled) = sampled {
                    self.light(work, row, (&bsdf, &local), &sampled);
                }
            }
            self.go_on(work, row, (&bsdf, &local), draw);
        }
    }

    /// Takes the light of a sample, if nothing is in between; it comes with the probability with which
    /// its light was chosen.
    #[inline(always)]
    fn light<B: Bsdf>(
        &self,
        work: &mut Workspace,
        row: usize,
        (bsdf, local): (&B, &Local),
        (sample, probability): &(LightSample, f32),
    ) {
        let incoming = local.frame.to_local(sample.direction);
        if incoming.z <= 0.0 {
            return;
        }
        let weight = sample.pdf.map_or(1.0, |pdf| {
            heuristic(Some(pdf * probability), || bsdf.pdf(local.outgoing, incoming))
        });
        let response = bsdf.eval(local.outgoing, incoming);
        let throughput = work.paths.throughput[work.place[row] as usize];
        let light = throughput * response * sample.weight * (weight / probability);
        cast_shadow(self.job, work, row, (sample, light), local.inside);
    }

    /// Sends the path on, or ends it.
    #[inline(always)]
    fn go_on<B: Bsdf>(
        &self,
        work: &mut Workspace,
        row: usize,
        (bsdf, local): (&B, &Local),
        draw: &ScatterDraw,
    ) {
        let place = work.place[row] as usize;
        let Some(scatter) = bsdf.sample(local.outgoing, draw.direction, draw.lobe) else {
            return work.end(row);
        };
        let throughput = work.paths.throughput[place] * scatter.weight;
        let survival = survival(self.job.settings.roulette, throughput, self.bounce, self.faint);
        if draw.roulette >= survival || throughput == Rgb::ZERO {
            return work.end(row);
        }
        let unscattered = work.paths.arrival[place].unscattered && scatter.pdf.is_none();
        work.paths.throughput[place] = throughput / survival;
        work.paths.arrival[place] = Arrival { pdf: scatter.pdf, diffuse: false, unscattered };
        if let Some(normal) = work.paths.normal.get_mut(place) {
            *normal = local.frame.normal;
        }
        let direction = local.to_world(scatter.incoming);
        work.go_on(self.job.world, row, direction, local.inside);
    }
}

/// The probability with which Russian roulette lets a path go on after scattering number `bounce`,
/// from 0. By throughput it ends only paths of less than `faint`.
///
/// Paths of a white furnace then never end by chance: that picture has no noise at all.
pub fn survival(roulette: Roulette, throughput: Rgb, bounce: u32, faint: f32) -> f32 {
    match roulette {
        Roulette::None => 1.0,
        Roulette::Fixed(p) => p as f32,
        Roulette::Throughput if !may_end(roulette, bounce) => 1.0,
        Roulette::Throughput => (throughput.max_element() / faint).clamp(0.05, 1.0),
    }
}

/// Whether there is a chance to end after scattering number `bounce`.
pub fn may_end(roulette: Roulette, bounce: u32) -> bool {
    match roulette {
        Roulette::None => false,
        Roulette::Fixed(_) => true,
        Roulette::Throughput => bounce >= 3,
    }
}

/// Throughput from which on paths are worth their time whatever they find.
///
/// Under a sky nearly every path finds light, and its variance is little: there a quarter is best,
/// by 1.1 to 2.5 in variance times time against roulette by throughput itself, over fields, volumes,
/// mirrors and glass, a sun and the last scene of "Ray Tracing in One Weekend". With lamps alone it is
/// a half, by 1.02 to 1.1, over fields with 1 to 1000 lamps and smallpt's box. No roulette at all
/// takes up to 2.8 times the time.
pub fn faint(world: &World) -> f32 {
    let sky = world.environment.illuminates && !world.environment.is_black();
    if sky { 0.25 } else { 0.5 }
}

/// Whether a sphere hides a light from a point of its inside: what lies behind its far side.
pub fn hides(world: &World, work: &Workspace, row: usize, sample: &LightSample) -> bool {
    let own = work.hits.sphere[row];
    own != GROUND && work.chord(world, row, sample.direction) < sample.t
}

/// Queues the shadow ray of a light sample; traces the queue when it is full.
#[inline]
pub fn cast_shadow(
    job: &Job,
    work: &mut Workspace,
    row: usize,
    (sample, light): (&LightSample, Rgb),
    inside: bool,
) {
    if light.max_element() <= 0.0 {
        return;
    }
    if inside && hides(job.world, work, row, sample) {
        return;
    }
    let from: (Vec3, u32) = (work.surface.point[row], work.hits.sphere[row]);
    work.shadows.push(from, sample, (work.place[row], light));
    if !work.shadows.has_room(1) {
        stages::occlude(job, work);
    }
}
