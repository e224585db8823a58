//! Direct light by next-event estimation: a light sample for each path at each surface.

use super::Job;
use super::shading_row::ShadingRow;
use super::shadow_queue::enqueue_shadow_rays;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask};
use crate::sampling::power_heuristic;
use crate::shade::{Bsdf, Material};

/// Samples one light for each path in `lanes`, and enqueues a shadow ray toward it.
#[inline(always)]
pub(super) fn sample_direct_light<M: Material>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    shading: &ShadingRow,
    bsdf: &M::Bsdf<F32x16>,
    lanes: u32,
) {
    if lanes == 0 {
        return;
    }
    let state = &shading.surface_row.state;
    let lights = &job.world.lights;
    let numbers = if lights.len() == 1 && lights.is_delta(0) {
        // A single light without extent needs no random numbers.
        [F32x16::splat(0.0); 4]
    } else {
        job.sampler.light_row(&work.paths.sampler_row(state), bounce)
    };
    let samples = job.world.sample_light_row(&shading.surface_row.at, numbers, lanes);
    let incoming = shading.bases.to_local(samples.direction);
    // Lanes whose light BSDF sampling may find as well.
    let both = if M::DIFFUSE {
        F32x16::lanes(samples.close)
    } else {
        Lanes::lt(F32x16::splat(0.0), samples.pdf)
    };
    let weight = if M::DIFFUSE && samples.close == 0 {
        F32x16::splat(1.0)
    } else {
        let weights = power_heuristic(samples.pdf, bsdf.pdf(shading.outgoing, incoming));
        Lanes::select(both, weights, F32x16::splat(1.0))
    };
    let response = bsdf.eval(shading.outgoing, incoming) * weight;
    let light = state.throughput.times(response).times(samples.weight);
    let above = Lanes::lt(F32x16::splat(0.0), incoming.z).bits();
    let lanes = samples.lanes & above;
    enqueue_shadow_rays(job, work, shading.surface_row, &samples, lanes, light);
}
