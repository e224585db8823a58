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
use super::glass;
use super::scatter::{self, Event};
use super::stages::{self, ShadeKind};
use super::workspace::Workspace;
use crate::lanes::Lanes;
use crate::scene::{Rgb, Roulette};
use crate::shade::Material;
use crate::world::{Kind, MaterialId, ROW, Receiver, World};

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
        glass::pass(job, work, bounce);
        stages::by_kind(job, work, &mut Shade { job, event: Event { bounce, faint } });
        stages::occlude(job, work);
        work.advance();
        work.clock.end(Stage::Shade);
        if work.is_empty() {
            return;
        }
        work.counters.bounce_rays += work.len() as u64;
    }
}

/// Gives the environment's light, and the suns', to paths that leave the scene.
fn escape(job: &Job, work: &mut Workspace) {
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    let sampled = lights.sky || lights.suns_have_discs();
    for i in 0..work.bins.escaped.len() {
        let row = work.bins.escaped[i] as usize;
        let place = work.place[row] as usize;
        let light = if sampled {
            sky(job, work, row)
        } else if environment.illuminates || work.paths.arrival[place].unscattered {
            environment.radiance(work.rays.direction.row(row))
        } else {
            continue;
        };
        work.paths.radiance[place] += work.paths.throughput[place] * light;
    }
}

/// What the path in `row` finds in the sky, where light samples may find it as well.
fn sky(job: &Job, work: &Workspace, row: usize) -> Rgb {
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    let arrival = work.paths.arrival[work.place[row] as usize];
    let direction = work.rays.direction.row(row);
    let mut light = Rgb::ZERO;
    if environment.illuminates || arrival.unscattered {
        let weight =
            heuristic(arrival.pdf, || lights.sky_pdf(environment, direction, &receiver(work, row)));
        light += environment.radiance(direction) * weight;
    }
    if !arrival.diffuse {
        for (sun, radiance) in lights.suns_toward(direction) {
            let pdf = || lights.sun_pdf(sun, &receiver(work, row));
            light += radiance * heuristic(arrival.pdf, pdf);
        }
    }
    light
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
fn heuristic(found: Option<f32>, other: impl FnOnce() -> f32) -> f32 {
    found.map_or(1.0, |found| heuristics(found, other()))
}

/// Weights of what was found with densities `found`, more than 0, and might have been found with
/// densities `other`.
#[inline(always)]
pub fn heuristics<L: Lanes>(found: L, other: L) -> L {
    // By the ratio, whose square may overflow to the right limit.
    let ratio = other / found;
    L::splat(1.0) / ratio.mul_add(ratio, L::splat(1.0))
}

/// One bounce's shading.
struct Shade<'a> {
    job: &'a Job<'a>,
    event: Event,
}

impl ShadeKind for Shade<'_> {
    fn shade<M: Material>(
        &mut self,
        work: &mut Workspace,
        kind: Kind,
        material: impl Fn(MaterialId) -> M,
    ) {
        let rows = std::mem::take(&mut work.bins.kind[kind as usize]);
        for rows in rows.chunks(ROW) {
            scatter::shade(self.job, work, self.event, (rows, &material));
        }
        work.bins.kind[kind as usize] = rows;
    }
}

/// The probability with which Russian roulette lets a path go on after scattering number `bounce`,
/// from 0, by the greatest channel of its throughput: it ends only paths of less than `faint`.
///
/// Paths of a white furnace then never end by chance: that picture has no noise at all.
#[inline(always)]
pub fn survival<L: Lanes>(roulette: Roulette, throughput: L, bounce: u32, faint: f32) -> L {
    match roulette {
        Roulette::None => L::splat(1.0),
        Roulette::Fixed(p) => L::splat(p as f32),
        Roulette::Throughput if !may_end(roulette, bounce) => L::splat(1.0),
        Roulette::Throughput => {
            (throughput / L::splat(faint)).max(L::splat(0.05)).min(L::splat(1.0))
        }
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
