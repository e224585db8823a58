//! Emission: the light of the environment and of emitters that paths reach.

use super::Job;
use super::caustics;
use super::columns::{LaneRows, row};
use super::mirrored_light;
use super::path_state::{PathStateRow, PreviousBounce};
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, bits, bits_of, first_lanes, set_bits};
use crate::ray::MISS;
use crate::sampling::power_heuristic;
use crate::scene::Rgb;
use crate::shade::MaterialKind;
use crate::vec3::Vec3;
use crate::world::{CausticSource, Receiver, ReceiverRow, SkyLight};

/// Adds the light of the environment and the suns to paths that leave the scene, and to those that the camera sees among
/// translucent bodies with nothing opaque behind. The camera may see a background instead: in place of both, or
/// behind glass in place of the environment.
pub(super) fn add_environment(job: &Job, work: &mut Workspace, bounce: u32) {
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    if let Some(background) = environment.background.filter(|_| bounce == 0) {
        return add_background(work, background);
    }
    let sampled = lights.sky_parts > 0 || lights.suns_have_discs();
    let has_glass = job.world.features.has(MaterialKind::Dielectric);
    let behind_glass = environment.background.filter(|_| has_glass);
    if environment.is_black() && !sampled && behind_glass.is_none() {
        return;
    }
    let constant = environment.constant().filter(|_| !sampled);
    let translucent = bounce == 0 && job.world.features.translucent;
    for first in (0..work.len()).step_by(MAX_LANES) {
        let there = first_lanes(work.len() - first);
        let missed = bits_of::<F32x16>(&work.hits.sphere[first..]).has_bits_of(bits(MISS));
        let escaped = there & if translucent { !0 } else { missed.bits() };
        if escaped == 0 {
            continue;
        }
        let mut state = work.states.load(first);
        if translucent {
            state.throughput = gather_light(there, |lane| work.throughput_behind(first + lane));
        }
        let specular_only = state.previous.specular_only().bits();
        let lit =
            if sampled || environment.illuminates { escaped } else { escaped & specular_only };
        let seen = if environment.illuminates { lit } else { lit & specular_only };
        let mut light = match constant {
            Some(color) => Vec3::splat(color.x, color.y, color.z),
            None => environment_light(job, work, LaneRows { first, lanes: seen }, &state),
        };
        if let Some(Rgb { x, y, z }) = behind_glass {
            let glass = F32x16::lanes(left_glass(job, work, first, lit & specular_only));
            light = Vec3::select_lanes(glass, Vec3::splat(x, y, z), light);
        }
        if lights.suns_have_discs() {
            add_suns(job, work, LaneRows { first, lanes: lit }, &mut light);
        }
        work.paths.add(state.path, state.throughput.times(light), lit);
    }
}

/// Returns those of `lanes` of sixteen rows whose rays start on glass.
fn left_glass(job: &Job, work: &Workspace, first: usize, lanes: u32) -> u32 {
    let is_glass = |lane: &usize| {
        let own = work.rays.own[first + lane];
        own != MISS && job.world.material(own).kind() == MaterialKind::Dielectric
    };
    set_bits(lanes).filter(is_glass).fold(0, |lanes, lane| lanes | 1 << lane)
}

/// Adds the background to camera rays that nothing opaque ends.
fn add_background(work: &mut Workspace, background: Rgb) {
    for row in 0..work.len() {
        let light = work.throughput_behind(row) * background;
        work.paths.radiance[work.states.path(row)] += light;
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

/// Returns the light of the environment along the rays of sixteen rows, with MIS weights where
/// light samples may find it too; 0 in lanes that do not count.
#[inline(always)]
fn environment_light(
    job: &Job,
    work: &Workspace,
    rows: LaneRows,
    state: &PathStateRow,
) -> Vec3<F32x16> {
    let LaneRows { first, lanes } = rows;
    let (environment, lights) = (&job.world.environment, &job.world.lights);
    let Some(picture) = environment.picture() else {
        return gather_light(lanes, |lane| {
            environment.radiance(work.rays.direction.row(first + lane))
        });
    };
    let toward = work.rays.direction.load::<F32x16>(first);
    let none = Vec3::splat(0.0, 0.0, 0.0);
    let sampled = lanes & state.previous.light_sampled().bits();
    if lights.sky_parts == 0 || sampled == 0 {
        let radiance = picture.radiances(toward, lanes);
        return Vec3::select_lanes(<F32x16 as Lanes>::lanes(lanes), radiance, none);
    }
    let SkyLight { radiance, pdf, part } = picture.light(toward, lanes);
    let at = ReceiverRow {
        point: work.rays.origin.load(first),
        normal: state.normal,
        own: *row(&work.rays.own, first),
    };
    let probability = lights.sky_probabilities(&at, part, sampled);
    // 1 where no light sample could have found the light: the density is infinite.
    let weight = power_heuristic(state.previous.density(), pdf * F32x16::new(probability));
    Vec3::select_lanes(<F32x16 as Lanes>::lanes(lanes), radiance * weight, none)
}

/// Adds the light of suns along the rays of sixteen rows, with MIS weights where light samples may
/// find it too.
fn add_suns(job: &Job, work: &Workspace, rows: LaneRows, light: &mut Vec3<F32x16>) {
    let lights = &job.world.lights;
    for lane in set_bits(rows.lanes) {
        let (row, channels) = (rows.first + lane, [&mut light.x, &mut light.y, &mut light.z]);
        let previous = work.states.previous(row);
        if previous.after_diffuse() {
            continue;
        }
        let channels = channels.map(|channel| &mut channel.as_mut_array()[lane]);
        let direction = work.rays.direction.row(row);
        for (sun, radiance) in lights.suns_toward(direction) {
            let pdf = || lights.sun_pdf(sun, &receiver(work, row));
            let weight = if previous.light_sampled() {
                mis_weight(previous, pdf)
            } else if previous.mirrored_light_sampled() {
                0.0
            } else {
                caustics::weight(job, work, row, CausticSource::Sun(sun), direction)
            };
            let radiance = radiance * weight;
            (0..3).for_each(|i| *channels[i] += radiance[i]);
        }
    }
}

/// Adds the light of emitters to the paths that hit them.
pub(super) fn add_emitted(job: &Job, work: &mut Workspace) {
    let world = job.world;
    let Some(queue) = work.queues.take(MaterialKind::Emitter) else { return };
    for LaneRows { first, lanes } in queue.rows() {
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
            let row = queue.ray(first + lane);
            weight[lane] = if left_out(job, work, row) {
                0.0
            } else {
                let emitter = CausticSource::Sphere(work.hits.sphere[row]);
                caustics::weight(job, work, row, emitter, work.surface.point.row(row))
            };
        }
        let light = state.throughput.times(radiance) * F32x16::new(weight);
        work.paths.add(state.path, light, lanes);
    }
    work.queues.put(MaterialKind::Emitter, queue);
}

/// Returns whether the emitter that the path in a row has hit was added where the path was mirrored.
fn left_out(job: &Job, work: &Workspace, row: usize) -> bool {
    work.states.previous(row).mirrored_light_sampled()
        && mirrored_light::is_sampled(job.world, work.hits.sphere[row], work.rays.origin.row(row))
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
