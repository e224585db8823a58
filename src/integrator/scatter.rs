//! Shading in rows of sixteen paths: a light sample for each, and where each goes on.

use super::Job;
use super::gather::Gathered;
use super::path::{heuristics, may_end, survival};
use super::shadows::cast;
use super::workspace::{Arrival, Workspace};
use crate::lanes::{F32x16, Lanes, Mask, set_bits};
use crate::shade::{Bsdf, Material, Scatter};
use crate::vec3::Vec3;
use crate::world::{MaterialId, ROW};

/// One scattering: its number, and the throughput of paths that are worth their time.
#[derive(Clone, Copy)]
pub(super) struct Event {
    pub(super) bounce: u32,
    pub(super) faint: f32,
}

/// Samples a light for each of at most sixteen rows, and sends their paths on or ends them.
pub(super) fn shade<M: Material>(
    job: &Job,
    work: &mut Workspace,
    event: Event,
    (rows, material): (&[u32], &impl Fn(MaterialId) -> M),
) {
    let paths = Gathered::new(work, rows);
    let surfaces: [M; ROW] = std::array::from_fn(|lane| {
        let hit = paths.starts.at.own[lane];
        material(job.world.material(hit)).tinted(job.world.color(hit))
    });
    let bsdf = M::row(&surfaces);
    if job.has_lights() {
        let delta = |lane: usize| u32::from(surfaces[lane].is_delta()) << lane;
        let delta = (0..ROW).fold(0, |lanes, lane| lanes | delta(lane));
        look_for_light::<M>(job, work, event.bounce, (&paths, &bsdf, paths.lanes & !delta));
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
    let numbers = job.sampler.light_row(&paths.sample, bounce);
    let samples = job.world.lights.sample_row(job.world, &paths.starts.at, numbers, lanes);
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
    let light = paths.throughput.times(response).times(samples.weight);
    let above = Lanes::lt(F32x16::splat(0.0), incoming.z).bits();
    cast(job, work, &paths.starts, (&samples, samples.lanes & above), light);
}

/// Sends each path on, or ends it.
#[inline(always)]
fn go_on<M: Material>(
    job: &Job,
    work: &mut Workspace,
    Event { bounce, faint }: Event,
    (paths, bsdf): (&Gathered, &M::Bsdf<F32x16>),
) {
    let roulette = job.settings.roulette;
    // Nothing is drawn for what is certain.
    let choose = !M::DIFFUSE || may_end(roulette, bounce);
    let draw = job.sampler.scatter_row(&paths.sample, bounce, choose);
    let scatter = bsdf.sample(paths.outgoing, draw.direction, draw.lobe);
    let throughput = paths.throughput.times(scatter.weight);
    let greatest = throughput.max_element();
    let survival = survival(roulette, greatest, bounce, faint);
    let goes_on = Lanes::lt(draw.roulette, survival) & Lanes::lt(F32x16::splat(0.0), greatest);
    let next = Scatter {
        incoming: paths.to_world(scatter.incoming),
        weight: throughput.map(|channel| channel / survival),
        ..scatter
    };
    send::<M>(job, work, paths, (&next, goes_on.bits()));
}

/// Sends the paths in these lanes on, in world space; the others end.
#[inline(always)]
fn send<M: Material>(
    job: &Job,
    work: &mut Workspace,
    paths: &Gathered,
    (next, goes_on): (&Scatter<F32x16>, u32),
) {
    work.go_on_row(job.world, (&paths.starts, paths.lanes & goes_on), next.incoming);
    let throughput = Each::new(next.weight);
    let (normal, pdf) = (Each::new(paths.starts.at.normal), next.pdf.to_array());
    for lane in set_bits(paths.lanes & goes_on) {
        let row = paths.starts.rows[lane] as usize;
        let place = work.place[row] as usize;
        let unscattered = work.paths.arrival[place].unscattered && pdf[lane] == 0.0;
        let density = (pdf[lane] > 0.0).then_some(pdf[lane]);
        work.paths.throughput[place] = throughput.at(lane);
        work.paths.arrival[place] = Arrival { pdf: density, diffuse: M::DIFFUSE, unscattered };
        if let Some(last) = work.paths.normal.get_mut(place) {
            *last = normal.at(lane);
        }
    }
}

/// A row of vectors to be taken one by one.
struct Each(Vec3<[f32; ROW]>);

impl Each {
    #[inline(always)]
    fn new(row: Vec3<F32x16>) -> Self {
        Self(row.map(F32x16::to_array))
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> glam::Vec3 {
        glam::Vec3::new(self.0.x[lane], self.0.y[lane], self.0.z[lane])
    }
}
