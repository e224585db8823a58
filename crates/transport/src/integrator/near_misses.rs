//! Near misses: rays of probes that pass close to a light which paths find only by chance.
//!
//! Next-event estimation cannot find a small light straight from the camera or by way of several specular
//! surfaces; few paths hit it, and those that do are bright. A render may have no such hit in its probes,
//! and yet some in its picture. But hits can be predicted: the density of the rays that pass a light hardly
//! changes within a few degrees. If it does not change at all in a cone of solid angle W about a light of
//! solid angle w, a ray in that cone hits the light with probability w / W.
//!
//! Let X be the light that a sample finds in this way, V if its ray hits and 0 otherwise, and let X' and V'
//! be those of another sample of the same pixel. The variance of X in the pixel is the expectation of
//! (X - X')^2 / 2. Averaged over all places of the light in the cone, with rays at an angle d to each other,
//! that is
//!
//! (V^2 + V'^2 - 2 V V' overlap(d)) / 2 w / W,
//!
//! where overlap is the common part of two discs of the light's size at distance d. If the rays of a pixel
//! spread much farther than the light, hits are rare in it. Otherwise only pixels at the image's edge are
//! noisy, and well-distributed samples find how much of them it covers.

use super::Job;
use super::caustics;
use super::probe_batch::ProbeSample;
use super::workspace::Workspace;
use crate::elementary::acos;
use crate::film::{ChanceLight, Term};
use crate::ray::MISS;
use crate::sampling::{Basis, Cone, cap, mix, next_in_square};
use crate::scene::{Integrator, Rgb};
use crate::shade::{MaterialKind, fresnel};
use crate::world::{CausticSource, World};
use glam::{DVec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::FRAC_2_PI;
use std::ops::Add;

/// Minimum of 1 - cos of the half-angle of the cone about a light: 0.15 radian.
const CONE: f32 = 0.01125;

/// Maximum of 1 - cos of the half-angle of a light that is found by chance: 0.2 radian. Probes find larger
/// lights, and their edges.
const LARGEST: f32 = 0.02;

/// Maximum number of emissive spheres that are tested for each ray; of more, some are chosen at random.
const TESTED: usize = 16;

/// Near misses of a batch of probes.
#[derive(Default)]
pub struct NearMisses {
    rows: Vec<NearMiss>,
    /// [`part_in_view`] of each light that a camera ray has passed.
    in_view: HashMap<Light, Option<f32>>,
}

/// A ray that passes, or hits, a light that its path can find only by chance.
#[derive(Clone, Copy, Debug)]
struct NearMiss {
    sample: ProbeSample,
    bounce: u32,
    light: Light,
    /// Sphere at which the ray starts, or [`MISS`].
    own: u32,
    /// Direction of the ray, less that toward the light's center.
    offset: Vec3,
    /// Light that a hit adds to the path.
    value: Rgb,
    /// Half-angle of the light.
    angle: f32,
    /// Probability of a hit.
    probability: f32,
    hit: bool,
}

/// Index of an emissive sphere or sun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Light {
    Emitter(usize),
    Sun(usize),
}

/// A small light near a ray.
struct Target {
    light: Light,
    source: CausticSource,
    radiance: Rgb,
    /// Unit direction of its center.
    center: Vec3,
    /// 1 - cos of its half-angle.
    height: f32,
    /// The point of an emissive sphere, or the direction in a sun, that is nearest to the ray.
    nearest: Vec3,
    hit: bool,
}

/// Records the near misses of the current rays, once their hits are known.
pub(super) fn record(job: &Job, work: &mut Workspace, bounce: u32) {
    if work.probes.is_empty() {
        return;
    }
    let NearMisses { mut rows, mut in_view } = std::mem::take(&mut work.near_misses);
    let lights = &job.world.lights;
    for row in 0..work.len() {
        let previous = work.states.previous(row);
        // The Whitted integrator does not sample the lights in directions of bounces.
        let by_chance = !previous.light_sampled()
            || matches!(job.settings.integrator, Integrator::Whitted { .. });
        if !by_chance {
            continue;
        }
        for sun in 0..lights.suns.len() {
            rows.extend(
                near_sun(job.world, work, row, sun)
                    .and_then(|target| near_miss(job, work, row, bounce, &target, 1.0)),
            );
        }
        let stride = lights.emitters.len().div_ceil(TESTED).max(1);
        let sample = work.probes.sample(work.states.path(row) as u32);
        let first = Group::of(sample).hash(bounce) as usize % stride;
        for emitter in (first..lights.emitters.len()).step_by(stride) {
            rows.extend(near_emitter(job.world, work, row, emitter).and_then(|target| {
                let density = density(job.world, work.rays.own[row], target.light, &mut in_view)?;
                near_miss(job, work, row, bounce, &target, stride as f32 / density)
            }));
        }
    }
    work.near_misses = NearMisses { rows, in_view };
}

/// Returns a sun if the ray in a row leaves the scene near it.
fn near_sun(world: &World, work: &Workspace, row: usize, index: usize) -> Option<Target> {
    let sun = &world.lights.suns[index];
    let (toward, disc) = (work.rays.direction.row(row), sun.disc?);
    if work.hits.sphere[row] != MISS || !is_near(toward, sun.direction, disc.height()) {
        return None;
    }
    let hit = sun.is_toward(toward);
    let offset = toward - sun.direction;
    let inside = (2.0 * disc.height()).sqrt() / offset.length();
    Some(Target {
        light: Light::Sun(index),
        source: CausticSource::Sun(index),
        radiance: sun.radiance,
        center: sun.direction,
        height: disc.height(),
        nearest: if hit { toward } else { (sun.direction + offset * inside).normalize() },
        hit,
    })
}

/// Returns an emissive sphere if the ray in a row hits it, or passes near it.
fn near_emitter(world: &World, work: &Workspace, row: usize, index: usize) -> Option<Target> {
    let sphere = world.lights.emitters[index];
    let (origin, toward) = (work.rays.origin.row(row), work.rays.direction.row(row));
    let (center, radius) =
        (world.spheres.center(sphere as usize), world.spheres.radius(sphere as usize));
    let to_center = center - origin;
    let distance = to_center.length();
    let cone = Cone::toward_sphere(f64::from(distance).powi(2), radius.into())?;
    let direction = to_center / distance;
    if !is_near(toward, direction, cone.height()) {
        return None;
    }
    let hit = work.hits.sphere[row] == sphere;
    let along = to_center.dot(toward);
    let passes = work.hits.t[row] >= f64::from(along - radius);
    let closest = origin + toward * along - center;
    (hit || passes).then(|| Target {
        light: Light::Emitter(index),
        source: CausticSource::Sphere(sphere),
        radiance: world.lights.radiance[index],
        center: direction,
        height: cone.height(),
        nearest: if hit {
            work.surface.point.row(row)
        } else {
            center + closest.normalize_or(-toward) * radius
        },
        hit,
    })
}

/// Returns whether a direction is in the cone about a small light.
fn is_near(toward: Vec3, center: Vec3, height: f32) -> bool {
    height <= LARGEST && (toward - center).length_squared() / 2.0 <= cone_height(height)
}

/// Returns 1 - cos of the half-angle of the cone about a light.
fn cone_height(light: f32) -> f32 {
    CONE.max(2.0 * light)
}

/// Returns the part of the cone about a light in which there are rays from sphere `own` or from the camera;
/// `None` if the camera does not see the light's center.
fn density(
    world: &World,
    own: u32,
    light: Light,
    in_view: &mut HashMap<Light, Option<f32>>,
) -> Option<f32> {
    if own != MISS || world.camera.is_orthographic() {
        return Some(1.0);
    }
    *in_view.entry(light).or_insert_with(|| part_in_view(world, light))
}

/// Returns the part of the cone about a light that is in the picture, as seen from the middle of the lens; `None`
/// if the light's center is not.
fn part_in_view(world: &World, light: Light) -> Option<f32> {
    const DIRECTIONS: usize = 64;
    let camera = &world.camera;
    let (center, height) = match light {
        Light::Sun(index) => {
            let sun = &world.lights.suns[index];
            (sun.direction, sun.disc?.height())
        }
        Light::Emitter(index) => {
            let (center, radius) = world.spheres.exact(world.lights.emitters[index] as usize);
            let toward = center - camera.eye;
            let cone = Cone::toward_sphere(toward.length_squared(), radius)?;
            (toward.normalize().as_vec3(), cone.height())
        }
    };
    let in_view = |toward: Vec3| {
        let seen = camera.view(camera.eye + toward.as_dvec3());
        let size = DVec2::new(camera.width.into(), camera.height.into());
        let pixel = camera.pixel(seen);
        seen.z > 0.0 && pixel.cmpge(DVec2::ZERO).all() && pixel.cmple(size).all()
    };
    let (basis, mut place) = (Basis::new(center), [0.5; 2]);
    let directions = (0..DIRECTIONS).filter(|_| {
        place = next_in_square(place);
        in_view(basis.to_world(cap(place, cone_height(height)).into()))
    });
    in_view(center).then(|| (directions.count().max(1) as f32) / DIRECTIONS as f32)
}

/// Returns the near miss of the ray in a row, which stands for `count` of them; `None` if a hit would have no
/// weight.
fn near_miss(
    job: &Job,
    work: &Workspace,
    row: usize,
    bounce: u32,
    target: &Target,
    count: f32,
) -> Option<NearMiss> {
    let mut weight = caustics::weight(job, work, row, target.source, target.nearest);
    if weight == 0.0 {
        // The camera sees the light, and it is sampled in this pixel.
        weight = work.seen_lights.deviation(job, work.states.path(row), target.source);
    }
    if work.states.previous(row).mirrored_light_sampled() {
        // Every path adds the light in the mirrored direction, times the reflectance; this is one of the
        // few that follow that direction.
        weight *= mirrored_probability(job.world, work, row).sqrt();
    }
    let toward = work.rays.direction.row(row);
    let near = NearMiss {
        sample: work.probes.sample(work.states.path(row) as u32),
        bounce,
        light: target.light,
        own: work.rays.own[row],
        offset: toward - target.center,
        value: work.states.throughput(row) * target.radiance * weight,
        angle: (2.0 * target.height).sqrt(),
        probability: count * target.height / cone_height(target.height),
        hit: target.hit,
    };
    (near.value.max_element() > 0.0 && near.value.is_finite()).then_some(near)
}

/// Returns the probability with which the smooth surface at which the ray in a row starts has mirrored it.
fn mirrored_probability(world: &World, work: &Workspace, row: usize) -> f32 {
    let own = work.rays.own[row];
    let (origin, toward) = (work.rays.origin.row(row), work.rays.direction.row(row));
    let Some(normal) = world.normal_at(own, origin, toward) else { return 1.0 };
    let (id, cosine) = (world.material(own), normal.dot(toward).abs().min(1.0));
    match id.kind() {
        MaterialKind::Dielectric => {
            let ior = world.materials.dielectric[id.row()].ior;
            fresnel::dielectric(f64::from(cosine), 1.0 / f64::from(ior)).0 as f32
        }
        MaterialKind::Plastic => {
            let plastic = &world.materials.plastic[id.row()];
            plastic.mirrored_probability(world.color(own), cosine)
        }
        _ => 1.0,
    }
}

/// Returns the common part of two discs of radius `angle` at `distance`, as a fraction of one.
fn overlap(distance: f32, angle: f32) -> f32 {
    let x = distance / (2.0 * angle);
    if x < 1.0 { FRAC_2_PI * (acos(x.into()) as f32 - x * (1.0 - x * x).sqrt()) } else { 0.0 }
}

impl NearMisses {
    /// Adds the near misses of a batch to the sums of its tiles, with the number of streams of each.
    pub fn finish<'a>(&mut self, tiles: impl Iterator<Item = (&'a mut ChanceLight, usize)>) {
        let tile = |near: &NearMiss| near.sample.tile;
        let event = |near: &NearMiss| (Group::of(near.sample), near.bounce, near.light, near.own);
        self.rows.sort_unstable_by_key(|near| (tile(near), event(near), near.sample.stream));
        let mut rows = self.rows.as_slice();
        for ((sums, streams), number) in tiles.zip(0..) {
            let (of_tile, rest) = rows.split_at(rows.partition_point(|near| tile(near) <= number));
            rows = rest;
            for near in of_tile.iter().filter(|near| near.hit) {
                let light = near.value.to_array().map(f64::from);
                sums.add_hit(near.sample.stream as usize, streams, light);
            }
            for same in of_tile.chunk_by(|a, b| event(a) == event(b)) {
                let term = match same {
                    [a, b] => pair(a, b),
                    _ => same.iter().map(single).fold(Term::default(), Add::add),
                };
                sums.add(Group::of(same[0].sample).probe as usize, streams / 2, term);
            }
        }
        self.rows.clear();
    }
}

/// The two paths of one sample of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Group {
    probe: u32,
    sample: u32,
}

impl Group {
    fn of(sample: ProbeSample) -> Self {
        Self { probe: sample.stream / 2, sample: sample.sample }
    }

    /// Returns a hash of the group at a bounce.
    fn hash(self, bounce: u32) -> u64 {
        mix(mix(u64::from(self.probe) << 32 | u64::from(self.sample)) ^ u64::from(bounce))
    }
}

/// Returns the mean over channels.
fn mean(value: Rgb) -> f64 {
    value.to_array().map(f64::from).iter().sum::<f64>() / 3.0
}

/// Returns the term of a near miss whose partner in the other stream passes no light.
fn single(near: &NearMiss) -> Term {
    let square = mean(near.value * near.value) / 2.0;
    let probability = f64::from(near.probability);
    Term {
        rare: square * probability,
        fourth: 2.0 * square * square * probability,
        ..Term::default()
    }
}

/// Returns the term of two samples of a pixel that pass the same light.
fn pair(a: &NearMiss, b: &NearMiss) -> Term {
    let (angle, distance) = (a.angle.max(b.angle), a.offset.distance(b.offset));
    if distance >= angle {
        return single(a) + single(b);
    }
    let both = mean(a.value * a.value + b.value * b.value);
    let product = 2.0 * mean(a.value * b.value) * f64::from(overlap(distance, angle));
    let probability = f64::from(a.probability + b.probability) / 2.0;
    Term { edges: (both - product) / 2.0 * probability, ..Term::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Role;
    use crate::sampling::{stream, unit};

    fn near(sample: ProbeSample, across: f32, hit: bool) -> NearMiss {
        NearMiss {
            sample,
            bounce: 0,
            light: Light::Emitter(0),
            own: MISS,
            offset: Vec3::new(across, 0.0, 0.0),
            value: Rgb::splat(2.0),
            angle: 0.01,
            probability: 0.25,
            hit,
        }
    }

    #[test]
    fn discs_overlap_by_the_area_that_they_share() {
        const POINTS: u64 = 200_000;
        for distance in [0.0, 0.3_f32, 1.0, 1.7, 2.0, 2.5] {
            let point = |i: u64| [2 * i, 2 * i + 1].map(|j| 2.0 * unit(stream(7, j) as u32) - 1.0);
            let inside = |[x, y]: [f32; 2]| x * x + y * y < 1.0;
            let (mut one, mut both) = (0.0, 0.0);
            for [x, y] in (0..POINTS).map(point).filter(|&point| inside(point)) {
                one += 1.0;
                both += f64::from(u8::from(inside([x - distance, y])));
            }
            let shared = f64::from(overlap(0.1 * distance, 0.1));
            assert!((shared - both / one).abs() < 5e-3, "{distance}: {shared}");
        }
    }

    #[test]
    fn rays_that_pass_a_light_far_apart_are_rare_hits_and_close_ones_edges() {
        let near =
            |stream, across, hit| near(ProbeSample { tile: 0, stream, sample: 0 }, across, hit);
        let far = pair(&near(0, 0.0, false), &near(1, 0.05, false));
        // Each of two samples, of which the variance is half the sum.
        assert_eq!((far.rare, far.edges), (2.0 * 2.0 * 0.25, 0.0));
        let close = pair(&near(0, 0.0, false), &near(1, 0.005, false));
        assert!(close.rare == 0.0 && close.edges > 0.0 && close.edges < far.rare);
        assert_eq!(pair(&near(0, 0.0, true), &near(1, 0.0, true)).edges, 0.0);
    }

    #[test]
    fn near_misses_are_added_to_their_tiles() {
        // Streams 0 and 1 are a steering probe, 2 and 3 a judge: samples 9 of the first are a pair. Another tile
        // in the batch has none.
        let rows = |tile| {
            let near = |stream, sample, across, hit| {
                near(ProbeSample { tile, stream, sample }, across, hit)
            };
            [near(1, 9, 0.004, false), near(0, 9, 0.0, true), near(2, 10, 0.0, false)]
        };
        let finish = |rows: Vec<NearMiss>| {
            let mut tiles = [(); 3].map(|()| ChanceLight::default());
            NearMisses { rows, ..NearMisses::default() }
                .finish(tiles.iter_mut().map(|sums| (sums, 4)));
            tiles
        };
        let [sums, none, same] = finish([rows(2), rows(0)].concat());
        assert_eq!((&sums, &none), (&same, &ChanceLight::default()));
        assert_eq!([sums.clone(), none.clone(), none], finish(rows(0).to_vec()));
        let steer = sums.variance(Role::Steer, 1, 4);
        let judge = sums.variance(Role::Judge, 1, 4);
        assert_eq!(steer.expected, judge.expected);
        assert!(steer.expected > 0.0 && judge.found == 0.0);
        // One hit of light 2 among four samples of one stream: half its square.
        assert_eq!(steer.found, (2.0_f64 / 4.0).powi(2) / 2.0);
    }
}
