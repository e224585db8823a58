//! Caustics: the light of lamps by way of a ball, looked for from diffuse surfaces.
//!
//! [`look`] chooses who looks for which way of light; those wait until they fill a row. Their rays
//! are traced in two legs: all from the surfaces to the balls, then, of those that nothing stops, from
//! the balls to the lamps among the other shadow rays. [`follow`] and [`weight`] tell what such
//! light counts that a path finds by chance.

mod chain;
mod legs;
mod waiting;

pub(super) use chain::{follow, weight};

use super::Job;
use super::gather::Gathered;
use super::stages;
use super::workspace::{BATCH, Workspace};
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask};
use crate::ray::MISS;
use crate::scene::{ConductorFresnel, Rgb};
use crate::shade::{Bsdf, Each, Material};
use crate::vec3::Vec3;
use crate::world::{Casters, Conductor, Kind, Looking, Way, World};
use chain::Chain;
use legs::Legs;
use waiting::{Row, Waiting};

/// Who looks for caustics.
#[derive(Default)]
pub(super) struct Caustics {
    /// Places: what paths have met since they left a diffuse surface.
    chains: Vec<Chain>,
    waiting: Waiting,
    legs: Legs,
}

impl Caustics {
    /// Room for what a world needs: none where nothing casts light.
    pub(super) fn new(world: &World) -> Self {
        if world.casters.is_empty() {
            return Self::default();
        }
        Self { chains: vec![Chain::NONE; BATCH], waiting: Waiting::new(), legs: Legs::new() }
    }
}

impl Job<'_> {
    /// What casts light, if it is looked for.
    #[inline(always)]
    fn casters(&self) -> Option<&Casters> {
        Some(&self.world.casters).filter(|casters| self.settings.caustics && !casters.is_empty())
    }
}

/// Chooses a way of light to look for, or none, for each path in `lanes`.
#[inline(always)]
pub(super) fn look<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    (paths, bsdf, lanes): (&Gathered, &M::Bsdf<F32x16>, u32),
) {
    if !M::DIFFUSE || bounce + 2 > job.depth() {
        return;
    }
    let Some(casters) = job.casters() else { return };
    let (at, carried) = (&paths.starts.at, &paths.starts.carried);
    let (draw, place) = job.sampler.caustic_row(&work.paths.numbers(carried), bounce);
    let chosen = casters.choose(at.point, at.normal, draw);
    let lanes = lanes & chosen.lanes & !paths.starts.inside;
    if lanes == 0 {
        return;
    }
    let facing = bsdf.eval(paths.outgoing, Vec3::splat(0.0, 0.0, 1.0));
    let row = Row {
        own: at.own,
        path: carried.place.to_array(),
        code: chosen.code,
        probability: chosen.probability,
        place,
        factor: carried.throughput.times(facing),
        point: at.point,
        normal: at.normal,
    };
    work.caustics.waiting.push(&row, lanes);
    if work.caustics.waiting.len() >= MAX_LANES {
        send(job, work, bounce);
    }
}

/// Sends the rays of all that wait on their first leg, and those that come so far on the second.
pub(super) fn flush(job: &Job, work: &mut Workspace, bounce: u32) {
    if job.casters().is_some() {
        while work.caustics.waiting.len() > 0 {
            send(job, work, bounce);
        }
        pass(job, work);
    }
}

/// Finds the ways of a row of those that wait.
#[inline(never)]
fn send(job: &Job, work: &mut Workspace, bounce: u32) {
    let world = job.world;
    let (row, lanes) = work.caustics.waiting.take();
    let looking = Looking {
        point: row.point,
        normal: row.normal,
        pair: row.code.map(|code| world.casters.pair(code)),
        way: row.code.map(Way::of),
        probability: row.probability,
    };
    let sent = looking.sample(row.place);
    let light = row.factor.times(colors(world, &looking, sent.incidence)) * sent.weight;
    let lit = Lanes::lt(F32x16::splat(0.0), light.max_element()).bits();
    // What passes through glass scatters once more.
    let through = |lane: &usize| looking.way[*lane] != Way::Reflected;
    let deep = (0..MAX_LANES).filter(|lane| bounce + 3 > job.depth() && through(lane));
    let lanes = deep.fold(lanes & sent.lanes & lit, |lanes, lane| lanes & !(1 << lane));
    if !work.caustics.legs.has_room() {
        pass(job, work);
    }
    work.caustics.legs.push_row((&looking, &sent), (&row.own, &row.path), light, lanes);
}

/// Radiance of the lamps, as balls color it.
#[inline(always)]
fn colors(world: &World, looking: &Looking, incidence: F32x16) -> Vec3<F32x16> {
    let white =
        Conductor { fresnel: ConductorFresnel::Constant(Rgb::ONE), tint: Rgb::ONE, roughness: 0.0 };
    let (mut metals, mut tints) = ([white; MAX_LANES], [Rgb::ONE; MAX_LANES]);
    let mut mirrors = false;
    for (lane, pair) in looking.pair.iter().enumerate() {
        let (id, own) = (world.material(pair.ball), world.color(pair.ball));
        tints[lane] = pair.radiance;
        match id.kind() {
            Kind::Conductor => {
                metals[lane] = world.materials.conductor[id.row()].tinted(own);
                mirrors = true;
            }
            Kind::Dielectric => {
                let times = if looking.way[lane] == Way::Reflected { 1 } else { 2 };
                let color = world.materials.dielectric[id.row()].color * own;
                (0..times).for_each(|_| tints[lane] *= color);
            }
            // A coat has no color.
            _ => {}
        }
    }
    let channel = |i: usize| F32x16::new(tints.each_ref().map(|tint| tint[i]));
    let tints = Vec3::new(channel(0), channel(1), channel(2));
    if !mirrors {
        return tints;
    }
    let (zero, one) = (F32x16::splat(0.0), F32x16::splat(1.0));
    let sine = (one - incidence * incidence).max(zero).sqrt();
    let outgoing = Vec3::new(sine, zero, incidence);
    let metals = <Conductor as Material>::row::<F32x16>(&Each(&metals));
    tints.times(metals.sample(outgoing, [zero; 2], zero).weight)
}

/// Traces the first legs, and lets those that nothing stops go on among the shadow rays.
fn pass(job: &Job, work: &mut Workspace) {
    let mut legs = std::mem::take(&mut work.caustics.legs);
    work.counters.exact_decisions += stages::find_hidden(job, &legs.rays, &mut legs.hits);
    work.counters.shadow_rays += legs.rays.len() as u64;
    for (row, next) in legs.next.iter().enumerate() {
        if legs.hits.sphere[row] != MISS {
            continue;
        }
        if !work.shadows.has_room(1) {
            stages::occlude(job, work);
        }
        work.shadows.push(next);
    }
    legs.clear();
    work.caustics.legs = legs;
}
