//! Light that paths find by themselves: where they leave the scene, and where they hit lamps.

use super::Job;
use super::arrival::Arrival;
use super::caustics;
use super::path::heuristics;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, bits, bits_of, first_lanes, set_bits};
use crate::ray::MISS;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::{Kind, Receiver};

/// Gives the environment's light, and the suns', to paths that leave the scene.
pub(super) fn in_the_sky(job: &Job, work: &mut Workspace) {
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
        let carried = work.carried.load(first);
        let unscattered = carried.arrival.unscattered().bits();
        let lit = if sampled || environment.illuminates { escaped } else { escaped & unscattered };
        let light = match constant {
            Some(color) => Vec3::splat(color.x, color.y, color.z),
            None if sampled => each(lit, |lane| sky(job, work, first + lane)),
            None => each(lit, |lane| environment.radiance(work.rays.direction.row(first + lane))),
        };
        work.paths.add(carried.place, carried.throughput.times(light), lit);
    }
}

/// A row of what light there is for each path in `lanes`.
#[inline(always)]
fn each(lanes: u32, light: impl Fn(usize) -> Rgb) -> Vec3<F32x16> {
    let mut row = [[0.0; MAX_LANES]; 3];
    for lane in set_bits(lanes) {
        let light = light(lane);
        (row[0][lane], row[1][lane], row[2][lane]) = (light.x, light.y, light.z);
    }
    let [x, y, z] = row;
    Vec3::new(F32x16::new(x), F32x16::new(y), F32x16::new(z))
}

/// What the path in a row finds in the sky, where light samples may find it as well.
fn sky(job: &Job, work: &Workspace, row: usize) -> Rgb {
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    let (arrival, direction) = (work.carried.arrival(row), work.rays.direction.row(row));
    let mut light = Rgb::ZERO;
    if environment.illuminates || arrival.unscattered() {
        let pdf = || lights.sky_pdf(environment, direction, &receiver(work, row));
        light += environment.radiance(direction) * heuristic(arrival, pdf);
    }
    if !arrival.diffuse() {
        for (sun, radiance) in lights.suns_toward(direction) {
            let pdf = || lights.sun_pdf(sun, &receiver(work, row));
            light += radiance * heuristic(arrival, pdf);
        }
    }
    light
}

/// Gives the light of emitters to paths that hit them.
pub(super) fn at_lamps(job: &Job, work: &mut Workspace) {
    let world = job.world;
    let Some(bin) = work.bins.take(Kind::Emitter) else { return };
    for (first, lanes) in bin.rows() {
        let carried = bin.carried_row(first);
        let radiance = each(lanes, |lane| {
            let material = world.material(bin.hit(first + lane));
            world.materials.emitter[material.row()].radiance
        });
        let mut weight = [1.0; MAX_LANES];
        for lane in set_bits(lanes & carried.arrival.sampled().bits()) {
            weight[lane] = lamp(job, work, bin.ray(first + lane));
        }
        for lane in set_bits(lanes & !carried.arrival.sampled().bits()) {
            let place = carried.place.to_array()[lane];
            weight[lane] = caustics::weight(job, work, bin.ray(first + lane), place as usize);
        }
        let light = carried.throughput.times(radiance) * F32x16::new(weight);
        work.paths.add(carried.place, light, lanes);
    }
    work.bins.put(Kind::Emitter, bin);
}

/// How much of an emitter's light counts that the path in a row has found, where light samples may
/// find it as well.
fn lamp(job: &Job, work: &Workspace, row: usize) -> f32 {
    let world = job.world;
    let (arrival, receiver) = (work.carried.arrival(row), receiver(work, row));
    let hit = work.hits.sphere[row];
    let diffuse = arrival.diffuse();
    heuristic(arrival, || world.lights.emitter_pdf(&world.spheres, hit, &receiver, diffuse))
}

/// Where the path in a row looked for light last.
fn receiver(work: &Workspace, row: usize) -> Receiver {
    let (point, normal) = (work.rays.origin.row(row), work.carried.last_normal(row));
    Receiver { point, normal, own: work.rays.own[row] }
}

/// Weight of what a path has found, and a light sample might have found with density `other`.
fn heuristic(arrival: Arrival<f32>, other: impl FnOnce() -> f32) -> f32 {
    if arrival.sampled() { heuristics(arrival.density(), other()) } else { 1.0 }
}
