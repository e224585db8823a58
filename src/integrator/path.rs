//! Path tracing with next-event estimation and multiple importance sampling.
//!
//! At each surface a path looks for light at one light, chosen by what each would give there, and
//! goes on in a direction sampled from the material. Light that both ways can find is weighted by the power heuristic
//! (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH
//! 1995), but from a diffuse surface a light that is not close, a sun or a point is left to the
//! light samples alone: adding the other way would only add variance. A constant or gradient
//! environment is left to the material's samples alone. Lamps that are seen by way of one mirror or one
//! ball of glass are looked for from diffuse surfaces too.

use super::Job;
use super::caustics;
use super::clock::Stage;
use super::found;
use super::glass;
use super::scatter::{self, Event};
use super::stages::{self, ByKind};
use super::workspace::Workspace;
use crate::lanes::Lanes;
use crate::scene::Roulette;
use crate::shade::Material;
use crate::world::{Kind, MaterialId, World};

/// Follows all paths to their ends.
pub fn integrate(job: &Job, work: &mut Workspace) {
    let faint = faint(job.world);
    for bounce in 0.. {
        stages::intersect(job, work);
        found::in_the_sky(job, work);
        found::at_lamps(job, work);
        if bounce == job.depth() {
            work.counters.cut_paths += work.bins.scattered();
            return;
        }
        caustics::follow(job, work);
        glass::pass(job, work, bounce);
        stages::by_kind(job.world, &mut Shade { job, work, event: Event { bounce, faint } });
        caustics::flush(job, work, bounce);
        stages::occlude(job, work);
        work.advance();
        work.clock.end(Stage::Shade);
        if work.is_empty() {
            return;
        }
        work.counters.bounce_rays += work.len() as u64;
    }
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
    work: &'a mut Workspace,
    event: Event,
}

impl ByKind for Shade<'_> {
    fn visit<M: Material>(&mut self, kind: Kind, table: impl Fn(MaterialId) -> M) {
        let Some(bin) = self.work.bins.take(kind) else { return };
        for rows in bin.rows() {
            scatter::shade(self.job, self.work, self.event, (&bin, rows), (kind, &table));
        }
        self.work.bins.put(kind, bin);
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
