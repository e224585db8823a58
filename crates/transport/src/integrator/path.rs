//! Path tracing with next-event estimation and multiple importance sampling.
//!
//! At each surface a path samples one light, chosen by its estimated contribution there, and continues
//! in a direction sampled from the BSDF. Light that both techniques can find is weighted by the power
//! heuristic (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering",
//! SIGGRAPH 1995), except that from a diffuse surface an emitter that is not close, a sun or a point
//! light is left to light samples alone: BSDF samples would only add variance. A constant or gradient
//! environment is left to BSDF samples alone. Surfaces that are not specular also sample caustics:
//! emitters seen by one mirror, coat or glass sphere.

use super::Job;
use super::caustics;
use super::columns::LaneRows;
use super::direct_light::sample_direct_light;
use super::emission;
use super::glass;
use super::light_images;
use super::material_queues::MaterialQueue;
use super::material_table::{MaterialsOfKind, gather_bsdfs};
use super::mirrored_light::{MirrorRow, sample_mirrored_light};
use super::near_misses;
use super::path_state::PathStateRow;
use super::roulette::{roulette_active, roulette_threshold, survival_probability};
use super::shading_row::{ShadingRow, SurfaceLanes};
use super::stages;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask};
use crate::shade::{Bsdf, KindVisitor, Material, MaterialId, MaterialKind, mirror};

/// Follows all paths to their ends.
pub fn integrate(job: &Job, work: &mut Workspace) {
    let threshold = roulette_threshold(job.world);
    light_images::sample(job, work);
    for bounce in 0.. {
        stages::intersect(job, work);
        near_misses::record(job, work, bounce);
        emission::add_environment(job, work, bounce);
        emission::add_emitted(job, work);
        if bounce == job.depth() {
            work.counters.cut_paths += work.queues.hit_count();
            return;
        }
        caustics::track_chains(job, work);
        glass::scatter(job, work, bounce);
        job.world.materials.for_each_kind(&mut Shade {
            job,
            work,
            bounce: Bounce { index: bounce, threshold },
        });
        caustics::flush(job, work);
        if !stages::end_bounce(job, work) {
            return;
        }
    }
}

/// A bounce: its index from 0, and the throughput below which roulette may end paths.
#[derive(Clone, Copy)]
struct Bounce {
    index: u32,
    threshold: f32,
}

/// A visitor that shades the queues of one bounce.
struct Shade<'a> {
    job: &'a Job<'a>,
    work: &'a mut Workspace,
    bounce: Bounce,
}

impl KindVisitor for Shade<'_> {
    fn visit<M: Material>(&mut self, kind: MaterialKind, table: impl Fn(MaterialId) -> M) {
        let Some(queue) = self.work.queues.take(kind) else { return };
        let materials = MaterialsOfKind { kind, table };
        for rows in queue.rows() {
            shade(self.job, self.work, self.bounce, &queue, rows, &materials);
        }
        caustics::sample_all(self.job, self.work, self.bounce.index, &materials);
        self.work.queues.put(kind, queue);
    }
}

/// Samples a light for each of at most sixteen hits of a queue, and spawns the next rays.
fn shade<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: Bounce,
    queue: &MaterialQueue,
    rows: LaneRows,
    materials: &MaterialsOfKind<impl Fn(MaterialId) -> M>,
) {
    let surface_row = SurfaceLanes::load(queue, rows.first);
    let shading = ShadingRow::new(queue, rows, &surface_row);
    let lookup = work.material_table.as_ref();
    let bsdf = gather_bsdfs(job.world, lookup, materials, &shading.surface_row.at.own);
    if job.has_lights() {
        let lanes = shading.lanes & !bsdf.is_delta().bits();
        sample_direct_light::<M>(job, work, bounce.index, &shading, &bsdf, lanes);
    }
    let mirrors = M::HAS_DIFFUSE_BASE && job.samples_mirrored_light();
    if mirrors {
        let row = MirrorRow {
            rays: shading.surface_row.rows,
            own: &shading.surface_row.at.own,
            path: shading.surface_row.state.path,
            previous: shading.surface_row.state.previous,
            point: shading.surface_row.at.point,
            direction: shading.to_world(mirror(shading.outgoing)),
        };
        let lanes = shading.lanes & !shading.surface_row.inside;
        let throughput = shading.surface_row.state.throughput;
        let factor = || throughput.times(bsdf.mirrored(shading.outgoing));
        sample_mirrored_light(job, work, &row, lanes, factor);
    }
    // After all other light of these paths, which is added in this order for any composition of batches.
    if job.has_lights() {
        let lanes = shading.lanes & !bsdf.is_delta().bits();
        caustics::enqueue_queries(job, work, bounce.index, &shading, lanes, materials);
    }
    spawn_rays::<M>(job, work, bounce, &shading, &bsdf, mirrors);
}

/// Samples the BSDFs, applies Russian roulette, and spawns the next rays of the paths that survive.
/// `mirrors` is true if mirrored light has been sampled.
#[inline(always)]
fn spawn_rays<M: Material>(
    job: &Job,
    work: &mut Workspace,
    Bounce { index, threshold }: Bounce,
    shading: &ShadingRow,
    bsdf: &M::Bsdf<F32x16>,
    mirrors: bool,
) {
    let (roulette, state) = (job.settings.roulette, &shading.surface_row.state);
    // Without a choice between lobes and without roulette, no random numbers are needed for them.
    let choose = !M::DIFFUSE || roulette_active(roulette, index);
    let draw = job.sampler.scatter_row(&work.paths.sampler_row(state), index, choose);
    let scatter = bsdf.sample(shading.outgoing, draw.direction, draw.lobe);
    let throughput = state.throughput.times(scatter.weight);
    let greatest = throughput.max_element();
    let survival = survival_probability(roulette, greatest, index, threshold);
    let survives = Lanes::lt(draw.roulette, survival) & Lanes::lt(F32x16::splat(0.0), greatest);
    let mut previous = state.previous.next(scatter.pdf, M::DIFFUSE);
    if mirrors {
        let outside = F32x16::lanes(!shading.surface_row.inside);
        previous =
            previous.with_mirrored_light(Lanes::le(scatter.pdf, F32x16::splat(0.0)) & outside);
    }
    let next = PathStateRow {
        throughput: throughput.map(|channel| channel / survival),
        previous,
        normal: shading.surface_row.at.normal,
        ..*state
    };
    let (lanes, direction) = (shading.lanes & survives.bits(), shading.to_world(scatter.incoming));
    work.spawn_rays(job.world, shading.surface_row, lanes, direction, &next);
}
