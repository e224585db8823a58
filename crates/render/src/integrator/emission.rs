//! Emission: the light of the environment and of emitters that paths reach.

use super::Job;
use super::caustics;
use super::direct_light::power_heuristic;
use super::path_state::PreviousBounce;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, bits, bits_of, first_lanes, set_bits};
use crate::ray::MISS;
use crate::scene::Rgb;
use crate::shade::MaterialKind;
use crate::vec3::Vec3;
use crate::world::Receiver;

/// Adds the light of the environment and the suns to paths that leave the scene.
pub(super) fn add_environment(job: &Job, work: &mut Workspace) {
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    let sampled = lights.sky || lights.suns_have_discs();
    if environment.is_black() && !sampled {
        return;
    }
    let constant = environment.constant().filter(|_| !sampled);
    for first in (0..work.len()).step_by(MAX_LANES) {
        let missed = bits_of::<F32x16>(&work.hits.sphere[first..]).has_bits_of(bits(MISS));
        let escaped = missed.bits() & first_lanes(work.len() - first);
        if escaped == 0 {
            continue;
        }
        let state = work.states.load(first);
        let specular_only = state.previous.specular_only().bits();
        let lit =
            if sampled || environment.illuminates { escaped } else { escaped & specular_only };
        let light = match constant {
            Some(color) => Vec3::splat(color.x, color.y, color.z),
            None if sampled => gather_light(lit, |lane| sky_light(job, work, first + lane)),
            None => gather_light(lit, |lane| {
                environment.radiance(work.rays.direction.row(first + lane))
            }),
        };
        work.paths.add(state.path, state.throughput.times(light), lit);
    }
}

/// Evaluates the light of each path in `lanes`.
#[inline(always)]
fn gather_light(lanes: u32, light: impl Fn(usize) -> Rgb) -> Vec3<F32x16> {
    let mut row = [[0.0; MAX_LANES]; 3];
    for lane in set_bits(lanes) {
        let light = light(lane);
        (row[0][lane], row[1][lane], row[2][lane]) = (light.x, light.y, light.z);
    }
    let [x, y, z] = row;
    Vec3::new(F32x16::new(x), F32x16::new(y), F32x16::new(z))
}

/// Returns the light of environment and suns along the ray of a row, with MIS weights where light
/// samples may find it too.
fn sky_light(job: &Job, work: &Workspace, row: usize) -> Rgb {
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    let (previous, direction) = (work.states.previous(row), work.rays.direction.row(row));
    let mut light = Rgb::ZERO;
    if environment.illuminates || previous.specular_only() {
        let pdf = || lights.sky_pdf(environment, direction, &receiver(work, row));
        light += environment.radiance(direction) * mis_weight(previous, pdf);
    }
    if !previous.after_diffuse() {
        for (sun, radiance) in lights.suns_toward(direction) {
            let pdf = || lights.sun_pdf(sun, &receiver(work, row));
            light += radiance * mis_weight(previous, pdf);
        }
    }
    light
}

/// Adds the light of emitters to the paths that hit them.
pub(super) fn add_emitted(job: &Job, work: &mut Workspace) {
    let world = job.world;
    let Some(queue) = work.queues.take(MaterialKind::Emitter) else { return };
    for (first, lanes) in queue.rows() {
        let state = queue.state_row(first);
        let radiance = gather_light(lanes, |lane| {
            let material = world.material(queue.hit(first + lane));
            world.materials.emitter[material.row()].radiance
        });
        let mut weight = [1.0; MAX_LANES];
        for lane in set_bits(lanes & state.previous.light_sampled().bits()) {
            weight[lane] = emitter_weight(job, work, queue.ray(first + lane));
        }
        for lane in set_bits(lanes & !state.previous.light_sampled().bits()) {
            let path = state.path.to_array()[lane];
            weight[lane] = caustics::mis_weight(job, work, queue.ray(first + lane), path as usize);
        }
        let light = state.throughput.times(radiance) * F32x16::new(weight);
        work.paths.add(state.path, light, lanes);
    }
    work.queues.put(MaterialKind::Emitter, queue);
}

/// Returns the MIS weight of the emitter that the path in a row has hit, where light samples may find
/// it too.
fn emitter_weight(job: &Job, work: &Workspace, row: usize) -> f32 {
    let world = job.world;
    let (previous, receiver) = (work.states.previous(row), receiver(work, row));
    let hit = work.hits.sphere[row];
    let diffuse = previous.after_diffuse();
    mis_weight(previous, || world.lights.emitter_pdf(&world.spheres, hit, &receiver, diffuse))
}

/// Returns the last point of the path in a row, at which it sampled a light.
fn receiver(work: &Workspace, row: usize) -> Receiver {
    let (point, normal) = (work.rays.origin.row(row), work.states.last_normal(row));
    Receiver { point, normal, own: work.rays.own[row] }
}

/// Returns the MIS weight of light that a path has found, and that a light sample finds with density
/// `other`.
fn mis_weight(previous: PreviousBounce<f32>, other: impl FnOnce() -> f32) -> f32 {
    if previous.light_sampled() { power_heuristic(previous.density(), other()) } else { 1.0 }
}
