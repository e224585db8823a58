//! Shading in rows of sixteen paths: a light sample for each, and where each goes on.

use super::Job;
use super::bins::Bin;
use super::carried::CarriedRow;
use super::caustics;
use super::gather::{Gathered, Starts};
use super::looks::surfaces;
use super::path::{heuristics, may_end, survival};
use super::shadows::cast;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask};
use crate::shade::{Bsdf, Material};
use crate::world::{Kind, MaterialId};

/// One scattering: its number, and the throughput of paths that are worth their time.
#[derive(Clone, Copy)]
pub(super) struct Event {
    pub(super) bounce: u32,
    pub(super) faint: f32,
}

/// Samples a light for each of at most sixteen rows of a bin, and sends their paths on or ends
/// them.
pub(super) fn shade<M: Material>(
    job: &Job,
    work: &mut Workspace,
    event: Event,
    (bin, rows): (&Bin, (usize, u32)),
    material: (Kind, &impl Fn(MaterialId) -> M),
) {
    let starts = Starts::of(bin, rows.0);
    let paths = Gathered::new(bin, rows, &starts);
    let looks = (job.world, work.looks.as_ref());
    let bsdf = surfaces(looks, material, &paths.starts.at.own);
    if job.has_lights() {
        let lanes = paths.lanes & !bsdf.is_delta().bits();
        look_for_light::<M>(job, work, event.bounce, (&paths, &bsdf, lanes));
        caustics::look::<M>(job, work, event.bounce, (&paths, &bsdf, lanes));
    }
    go_on::<M>(job, work, event, (&paths, &bsdf));
}

/// Samples one light for each path in `lanes`.
#[inline(always)]
fn look_for_light<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    (paths, bsdf, lanes): (&Gathered, &M::Bsdf<F32x16>, u32),
) {
    if lanes == 0 {
        return;
    }
    let carried = &paths.starts.carried;
    let lights = &job.world.lights;
    let numbers = if lights.len() == 1 && lights.is_delta(0) {
        // Nothing is drawn for what is certain.
        [F32x16::splat(0.0); 4]
    } else {
        job.sampler.light_row(&work.paths.numbers(carried), bounce)
    };
    let samples = lights.sample_row(job.world, &paths.starts.at, numbers, lanes);
    let incoming = paths.frames.to_local(samples.direction);
    // Whether the surface's own directions look for that light as well.
    let both = if M::DIFFUSE {
        F32x16::lanes(samples.close)
    } else {
        Lanes::lt(F32x16::splat(0.0), samples.pdf)
    };
    let weight = if M::DIFFUSE && samples.close == 0 {
        F32x16::splat(1.0)
    } else {
        let weights = heuristics(samples.pdf, bsdf.pdf(paths.outgoing, incoming));
        Lanes::select(both, weights, F32x16::splat(1.0))
    };
    let response = bsdf.eval(paths.outgoing, incoming) * weight;
    let light = carried.throughput.times(response).times(samples.weight);
    let above = Lanes::lt(F32x16::splat(0.0), incoming.z).bits();
    cast(job, work, paths.starts, (&samples, samples.lanes & above), light);
}

/// Sends each path on, or ends it.
#[inline(always)]
fn go_on<M: Material>(
    job: &Job,
    work: &mut Workspace,
    Event { bounce, faint }: Event,
    (paths, bsdf): (&Gathered, &M::Bsdf<F32x16>),
) {
    let (roulette, carried) = (job.settings.roulette, &paths.starts.carried);
    // Nothing is drawn for what is certain.
    let choose = !M::DIFFUSE || may_end(roulette, bounce);
    let draw = job.sampler.scatter_row(&work.paths.numbers(carried), bounce, choose);
    let scatter = bsdf.sample(paths.outgoing, draw.direction, draw.lobe);
    let throughput = carried.throughput.times(scatter.weight);
    let greatest = throughput.max_element();
    let survival = survival(roulette, greatest, bounce, faint);
    let goes_on = Lanes::lt(draw.roulette, survival) & Lanes::lt(F32x16::splat(0.0), greatest);
    let next = CarriedRow {
        throughput: throughput.map(|channel| channel / survival),
        arrival: carried.arrival.onward(scatter.pdf, M::DIFFUSE),
        normal: paths.starts.at.normal,
        ..*carried
    };
    let (lanes, direction) = (paths.lanes & goes_on.bits(), paths.to_world(scatter.incoming));
    work.go_on(job.world, (paths.starts, lanes), direction, &next);
}
