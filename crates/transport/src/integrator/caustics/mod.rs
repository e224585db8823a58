//! Caustics: samples of emitters by way of a specular sphere, from surfaces that are not specular.
//!
//! [`enqueue_queries`] chooses which path of light each surface point samples; the queries of a kind of
//! material wait until they fill a row. Their shadow rays have two segments: all first segments, from surfaces to spheres,
//! are traced at once; the second segments of those that are not occluded, from spheres to emitters,
//! join the shadow queue. [`track_chains`] and [`weight`] compute the weight of
//! caustics that BSDF samples find.

mod chain;
mod queues;

pub(super) use chain::{ReachedEmitter, mirrored_weight, track_chains, weight};
pub(super) use queues::CameraSegment;

use super::Job;
use super::columns::BATCH_PATHS;
use super::material_table::{MaterialsOfKind, gather_bsdfs};
use super::shading_row::ShadingRow;
use super::shadow_queue::{self, ShadowRay};
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, set_bits};
use crate::ray::MISS;
use crate::sampling::{Bases, LightDraw, next_in_square, power_heuristic};
use crate::scene::{ConductorFresnel, Rgb};
use crate::shade::conductor::Conductor;
use crate::shade::{BroadcastParams, Bsdf, GatheredParams, Material, MaterialId, MaterialKind};
use crate::vec3::Vec3;
use crate::world::{CausticCasters, CausticPath, CausticQuery, World};
use chain::SpecularChain;
use queues::{FirstSegments, QueryQueue, QueryRow};

/// Queues of caustic samples.
#[derive(Default)]
pub(super) struct Caustics {
    /// By path: specular bounces since the last surface that is not specular.
    chains: Vec<SpecularChain>,
    queries: QueryQueue,
    first_segments: FirstSegments,
}

impl Caustics {
    /// Allocates what a world needs: nothing if it has no caustics.
    pub(super) fn new(world: &World) -> Self {
        if world.caustic_casters.is_empty() {
            return Self::default();
        }
        Self {
            chains: vec![SpecularChain::NONE; BATCH_PATHS],
            queries: QueryQueue::new(),
            first_segments: FirstSegments::new(),
        }
    }
}

impl Job<'_> {
    /// Returns the spheres that cast caustics, if caustics are sampled.
    #[inline(always)]
    fn casters(&self) -> Option<&CausticCasters> {
        Some(&self.world.caustic_casters)
            .filter(|casters| self.settings.caustics && !casters.is_empty())
    }
}

/// Chooses a path of light to sample, or none, for each path in `lanes`, and enqueues the queries.
#[inline(always)]
pub(super) fn enqueue_queries<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    shading: &ShadingRow,
    lanes: u32,
    materials: &MaterialsOfKind<impl Fn(MaterialId) -> M>,
) {
    let lanes = lanes & !shading.surface_row.inside;
    if lanes == 0 || bounce + 2 > job.depth() {
        return;
    }
    let Some(casters) = job.casters() else { return };
    let (at, state) = (&shading.surface_row.at, &shading.surface_row.state);
    let numbers = job.sampler.caustic_row(&work.paths.sampler_row(state), bounce);
    let (draw, mut place, mut lanes) =
        (LightDraw::light_row(numbers), [numbers[0], numbers[1]], lanes);
    for number in 0.. {
        let chosen = casters.choose_row(at, draw, number, lanes);
        lanes = chosen.lanes;
        if lanes == 0 {
            return;
        }
        let row = QueryRow {
            own: at.own,
            path: state.path.to_array(),
            code: chosen.code,
            emitter: chosen.emitter,
            rate: chosen.rate,
            place,
            throughput: state.throughput,
            point: at.point,
            normal: at.normal,
            outgoing: shading.outgoing,
        };
        work.caustics.queries.push(&row, lanes);
        if work.caustics.queries.len() >= MAX_LANES {
            sample_queries(job, work, bounce, materials);
        }
        place = next_in_square(place);
    }
}

/// Samples all waiting queries, from surfaces of one kind.
pub(super) fn sample_all<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    materials: &MaterialsOfKind<impl Fn(MaterialId) -> M>,
) {
    while work.caustics.queries.len() > 0 {
        sample_queries(job, work, bounce, materials);
    }
}

/// Traces the first segments that are waiting.
pub(super) fn flush(job: &Job, work: &mut Workspace) {
    if job.casters().is_some() {
        trace_first_segments(job, work);
    }
}

/// Samples a row of waiting queries, from surfaces of one kind.
#[inline(never)]
fn sample_queries<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    materials: &MaterialsOfKind<impl Fn(MaterialId) -> M>,
) {
    let world = job.world;
    let (row, lanes) = work.caustics.queries.take();
    let query = CausticQuery {
        point: row.point,
        pairs: world.caustic_casters.pair_row(&row.code, &row.emitter, lanes),
        path: row.code.map(CausticPath::of),
        rate: row.rate,
    };
    let sample = query.sample(row.place);
    let bsdf = gather_bsdfs(world, work.material_table.as_ref(), materials, &row.own);
    let incoming = Bases::about(row.normal).to_local(sample.toward);
    let response = bsdf.eval(row.outgoing, incoming);
    // The power heuristic, divided by the density.
    let one = F32x16::splat(1.0);
    let mirrored = if world.caustic_casters.mirrored_light { sample.reflected } else { 0 };
    let chance = Lanes::select(F32x16::lanes(mirrored), one, sample.kept);
    let own = bsdf.pdf(row.outgoing, incoming) * chance;
    let weight = sample.kept * power_heuristic(sample.pdf, own) / sample.pdf;
    let light = row.throughput.times(response).times(colors(world, &query, sample.incidence));
    let light = light * weight;
    let lit = Lanes::lt(F32x16::splat(0.0), light.max_element())
        & Lanes::lt(light.max_element(), F32x16::splat(f32::INFINITY))
        & Lanes::lt(F32x16::splat(0.0), incoming.z);
    // Light through glass has one more bounce.
    let through = |lane: &usize| query.path[*lane] != CausticPath::Reflected;
    let deep = (0..MAX_LANES).filter(|lane| bounce + 3 > job.depth() && through(lane));
    let lanes = deep.fold(lanes & sample.lanes & lit.bits(), |lanes, lane| lanes & !(1 << lane));
    if !work.caustics.first_segments.has_room() {
        trace_first_segments(job, work);
    }
    work.caustics.first_segments.push_row(&query, &sample, &row, light, lanes);
}

/// Returns the radiance of the emitters, times the color of the spheres.
#[inline(always)]
fn colors(world: &World, query: &CausticQuery, incidence: F32x16) -> Vec3<F32x16> {
    let white =
        Conductor { fresnel: ConductorFresnel::Constant(Rgb::ONE), tint: Rgb::ONE, roughness: 0.0 };
    let mut metals = [white.params(Rgb::ONE); MAX_LANES];
    let mut tints = [Rgb::ONE; MAX_LANES];
    let mut mirrors = false;
    for lane in set_bits(query.pairs.lanes) {
        let sphere = query.pairs.sphere[lane];
        let (id, own) = (world.material(sphere), world.color(sphere));
        tints[lane] = query.pairs.radiance[lane];
        if id.kind() == MaterialKind::Conductor {
            metals[lane] = world.materials.conductor[id.row()].params(own);
            mirrors = true;
        } else {
            let through = query.path[lane] != CausticPath::Reflected;
            tints[lane] *= specular_color(world, sphere, through, 1.0);
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
    let metals = <Conductor as Material>::row::<F32x16>(&GatheredParams(metals));
    tints.times(metals.sample(outgoing, [zero; 2], zero).weight)
}

/// Returns the color of a smooth specular sphere: the factor on what it mirrors, or passes on, at this cosine
/// of the angle of incidence, beside Fresnel's for dielectrics.
pub(super) fn specular_color(world: &World, sphere: u32, through: bool, cosine: f32) -> Rgb {
    let (id, own) = (world.material(sphere), world.color(sphere));
    match id.kind() {
        MaterialKind::Conductor => {
            let params = world.materials.conductor[id.row()].params(own);
            Conductor::row::<f32>(&BroadcastParams(params)).reflectance(cosine).into()
        }
        MaterialKind::Dielectric => {
            let color = world.materials.dielectric[id.row()].color * own;
            if through { color * color } else { color }
        }
        // A coat has no color.
        _ => Rgb::ONE,
    }
}

/// Enqueues a shadow ray that starts at a specular sphere, after a segment from the camera to it;
/// or one that starts at the camera itself.
pub(super) fn push_segments(
    job: &Job,
    work: &mut Workspace,
    first: Option<&CameraSegment>,
    ray: &ShadowRay,
) {
    let Some(first) = first else {
        if !work.shadow_queue.has_room(1) {
            shadow_queue::trace_shadow_rays(job, work);
        }
        work.shadow_queue.push(ray);
        return;
    };
    if !work.caustics.first_segments.has_room() {
        trace_first_segments(job, work);
    }
    work.caustics.first_segments.push(first, ray);
}

/// Traces the first segments, and enqueues the second ones of those that are not occluded.
fn trace_first_segments(job: &Job, work: &mut Workspace) {
    let mut first = std::mem::take(&mut work.caustics.first_segments);
    work.counters.exact_decisions +=
        shadow_queue::test_occlusion(job, &first.rays, &mut first.hits);
    work.counters.shadow_rays += first.rays.len() as u64;
    work.probes.count_rays(first.second.iter().map(|next| next.path));
    for (row, next) in first.second.iter().enumerate() {
        if first.hits.sphere[row] != MISS {
            continue;
        }
        if !work.shadow_queue.has_room(1) {
            shadow_queue::trace_shadow_rays(job, work);
        }
        work.shadow_queue.push(next);
    }
    first.clear();
    work.caustics.first_segments = first;
}
