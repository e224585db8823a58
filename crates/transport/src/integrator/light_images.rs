//! Small lights that the camera sees: in their pixels, more directions are tested for each sample.
//!
//! A light in view, or its image in a smooth sphere, is often much brighter than the rest; if it is small, or
//! at its edge, few of a pixel's samples find it. But whether a camera ray reaches a given light, directly or
//! by a given sphere, is known from these two alone. So for each sample of such a pixel, sixteen places in
//! the pixel are tested, and one of those that see the light is tested for occlusion. That counts in place of
//! what the camera ray finds in the same way.
//!
//! If the image is smaller than a pixel, a point of the light is sampled instead, as for surfaces, with the
//! pixel's filter in place of a BSDF. By way of a sphere, it is weighted against what the camera ray finds.

use super::Job;
use super::caustics::{self, CameraSegment};
use super::seen_lights::PLACES;
use super::shadow_queue::{self, ShadowRay};
use super::workspace::Workspace;
use crate::lanes::{Doubles, F32x16, F64x8, Lanes, MAX_LANES, first_lanes, set_bits, widen};
use crate::ray::MISS;
use crate::sampling::{ONE_BELOW, concentric_disk, next_in_square, power_heuristic};
use crate::scene::Rgb;
use crate::shade::fresnel;
use crate::vec3::Vec3 as Row;
use crate::world::{Caster, CausticPath, CausticSource, SeenLight, World};
use glam::{DVec3, Vec3};

/// Ways of camera rays to a light.
#[derive(Clone, Copy)]
struct Ways<D: Doubles> {
    origin: Row<D>,
    /// Directions at the camera.
    toward: Row<D>,
    /// Distances of the specular sphere, if there is one.
    entry: D,
    /// The point at which the rays leave it.
    exit: Row<D>,
    /// Directions there.
    toward_light: Row<D>,
    /// Distances of the light from there; infinite for a sun.
    length: D,
    /// Cosines of the angles of incidence.
    cosine: D,
    /// Fractions of light that reflection or refraction keeps, without colors; 0 for rays that do not reach
    /// the light.
    kept: D,
}

/// A way of one ray.
struct Way {
    origin: Vec3,
    toward: Vec3,
    entry: f64,
    exit: Vec3,
    toward_light: Vec3,
    length: f64,
    cosine: f32,
}

/// Paths of a row that belong to one pixel, with their random numbers.
struct PixelRow<'a> {
    pixel: [u32; 2],
    /// The first of the row's paths.
    first: usize,
    lanes: u32,
    numbers: &'a [F32x16; 4],
    lens: Option<[F32x16; 2]>,
}

/// Samples the lights that camera rays may see, in their pixels: first those by way of spheres, then the others, and
/// traces the rays to them, so that the light of a path is added in an order that does not depend on other paths.
pub(super) fn sample(job: &Job, work: &mut Workspace) {
    if work.seen_lights.is_empty() {
        return;
    }
    sample_lights(job, work, |light| light.sphere != MISS);
    caustics::flush(job, work);
    // Rays from spheres and those from the camera, which some bodies are hidden from, are not traced together.
    shadow_queue::trace_shadow_rays(job, work);
    sample_lights(job, work, |light| light.sphere == MISS);
    shadow_queue::trace_shadow_rays(job, work);
}

/// Samples those of the lights that `selected` returns true for.
fn sample_lights(job: &Job, work: &mut Workspace, selected: impl Fn(&SeenLight) -> bool) {
    let (mut lights, mut last) = (Vec::new(), None);
    for first in (0..work.len()).step_by(MAX_LANES) {
        let mut numbers = None;
        let end = MAX_LANES.min(work.len() - first);
        let mut lane = 0;
        while lane < end {
            let pixels = &work.seen_lights.pixels[first..first + end];
            let pixel = pixels[lane];
            let same = pixels[lane..].iter().take_while(|&&other| other == pixel).count();
            let lanes = first_lanes(lane + same) & !first_lanes(lane);
            lane += same;
            if last.replace(pixel) != Some(pixel) {
                work.seen_lights.collect(job, pixel, &selected, &mut lights);
            }
            if lights.is_empty() {
                continue;
            }
            let (numbers, lens) = numbers.get_or_insert_with(|| {
                let numbers = work.paths.sampler_row(&work.states.load(first));
                let lens = || concentric_disk(job.sampler.lens_row(&numbers));
                (job.sampler.image_row(&numbers), job.has_lens().then(lens))
            });
            let row = PixelRow { pixel, first, lanes, numbers, lens: *lens };
            for (light, tiny) in &lights {
                if *tiny {
                    sample_points(job, work, &row, light);
                } else {
                    set_bits(lanes).for_each(|lane| sample_places(job, work, &row, lane, light));
                }
            }
        }
    }
}

/// Samples points of a light with a tiny image, and weights them by the pixel's filter at their images.
fn sample_points(job: &Job, work: &mut Workspace, row: &PixelRow, light: &SeenLight) {
    let origins = work.rays.origin.load::<F32x16>(row.first);
    let [u, v, ..] = *row.numbers;
    if light.sphere == MISS {
        for lane in set_bits(row.lanes) {
            let u = [u, v].map(|row| row.to_array()[lane]);
            sample_point(job, work, row, lane, light, u);
        }
        return;
    }
    let casters = &job.world.caustic_casters;
    for path in CausticPath::ALL {
        if (path != CausticPath::Reflected) != light.through {
            continue;
        }
        let query = casters.query(light.sphere, light.source, path, origins, row.lanes);
        let Some(query) = query else { return };
        let sample = query.sample([u, v]);
        for lane in set_bits(sample.lanes & row.lanes) {
            let one = |v: Row<F32x16>| -> Vec3 { v.map(|row| row.to_array()[lane]).into() };
            let number = |row: F32x16| row.to_array()[lane];
            let (origin, toward) = (one(origins), one(sample.toward));
            let camera = job.camera_pdf(row.pixel, origin, toward);
            let (pdf, kept) = (number(sample.pdf), number(sample.kept));
            // The probability with which a camera ray goes on to the light.
            let chance = if light.through || !casters.mirrored_light { kept } else { 1.0 };
            let mis = power_heuristic(pdf, camera * chance);
            let way = Way {
                origin,
                toward,
                entry: sample.length[0][lane],
                exit: one(sample.exit),
                toward_light: one(sample.toward_emitter),
                length: sample.length[1][lane],
                cosine: number(sample.incidence),
            };
            push(job, work, row.first + lane, light, &way, mis * kept * camera / pdf);
        }
    }
}

/// Samples a point of a light that is seen directly.
fn sample_point(
    job: &Job,
    work: &mut Workspace,
    row: &PixelRow,
    lane: usize,
    light: &SeenLight,
    u: [f32; 2],
) {
    let origin = work.rays.origin.row(row.first + lane);
    let (lights, world) = (&job.world.lights, job.world);
    let index = match light.source {
        CausticSource::Sphere(row) => lights.emitter_index(&world.spheres, row),
        CausticSource::Sun(sun) => Some(lights.sun_index(sun)),
    };
    let sample = index.and_then(|index| world.sample_light(index, origin, MISS, u));
    let Some((sample, pdf)) = sample.and_then(|sample| Some((sample, sample.pdf?))) else { return };
    let camera = job.camera_pdf(row.pixel, origin, sample.direction);
    let way = Way {
        origin,
        toward: sample.direction,
        entry: 0.0,
        exit: origin,
        toward_light: sample.direction,
        length: sample.t,
        cosine: 1.0,
    };
    push(job, work, row.first + lane, light, &way, camera / pdf);
}

/// Samples a light for one path: tests places in its pixel.
fn sample_places(job: &Job, work: &mut Workspace, row: &PixelRow, lane: usize, light: &SeenLight) {
    let one = |row: F32x16| row.to_array()[lane];
    let [u, v, choice, _] = row.numbers.map(one);
    let places = job.filter.offset_row(rotated(places_in_square(), [u, v]));
    let middle = row.pixel.map(|x| F64x8::splat(f64::from(x) + 0.5));
    let lens = row.lens.map(|lens| lens.map(|x| F64x8::splat(f64::from(one(x)))));
    let [across, down] = places.map(widen);
    let halves = [0, 1].map(|half| {
        let place = [middle[0] + across[half], middle[1] + down[half]];
        let (origin, toward) = job.world.camera.rays(place, lens);
        find_ways(job.world, light, origin, toward)
    });
    let kept = halves.each_ref().map(|ways| ways.kept.to_array());
    let total: f64 = kept.iter().flatten().sum();
    if total <= 0.0 {
        return;
    }
    // One is chosen in proportion to what it keeps.
    let mut left = f64::from(choice) * total;
    let lit = (0..MAX_LANES).filter(|lane| kept[lane / 8][lane % 8] > 0.0);
    let mut chosen = 0;
    for lane in lit {
        chosen = lane;
        left -= kept[lane / 8][lane % 8];
        if left < 0.0 {
            break;
        }
    }
    let way = halves[chosen / 8].way(chosen % 8);
    push(job, work, row.first + lane, light, &way, (total / PLACES as f64) as f32);
}

/// Returns sixteen well-distributed points of the unit square.
fn places_in_square() -> [F32x16; 2] {
    let mut places = [[0.0, 0.0]; MAX_LANES];
    (1..MAX_LANES).for_each(|lane| places[lane] = next_in_square(places[lane - 1]));
    [0, 1].map(|axis| F32x16::new(places.map(|place| place[axis])))
}

/// Returns points of the unit square, moved by others, modulo 1.
fn rotated(places: [F32x16; 2], by: [f32; 2]) -> [F32x16; 2] {
    let one = F32x16::splat(1.0);
    std::array::from_fn(|axis| {
        let x = places[axis] + F32x16::splat(by[axis]);
        Lanes::select(Lanes::lt(x, one), x, x - one).min(F32x16::splat(ONE_BELOW))
    })
}

/// Returns the ways of camera rays to a light; other spheres may occlude it.
#[inline(always)]
fn find_ways<D: Doubles>(
    world: &World,
    light: &SeenLight,
    origin: Row<D>,
    toward: Row<D>,
) -> Ways<D> {
    let one = D::splat(1.0);
    let direct = Ways {
        origin,
        toward,
        entry: D::splat(0.0),
        exit: origin,
        toward_light: toward,
        length: D::splat(f64::INFINITY),
        cosine: one,
        kept: one,
    };
    let ways = match world.caustic_casters.caster(light.sphere) {
        Some(caster) => by_sphere(caster, light.through, direct),
        None => direct,
    };
    let (length, reached) = match light.source {
        CausticSource::Sun(sun) => {
            let sun = &world.lights.suns[sun];
            let off = ways.toward_light - every(sun.direction.as_dvec3());
            let most = sun.disc.map_or(0.0, |disc| 2.0 * f64::from(disc.height()));
            (ways.length, off.dot_unfused(off).lt(D::splat(most)))
        }
        CausticSource::Sphere(row) => {
            let (center, radius) = world.spheres.exact(row as usize);
            first_hit(ways.exit, ways.toward_light, center, radius)
        }
    };
    let kept = D::select(reached, ways.kept, D::splat(0.0));
    Ways { length, kept, ..ways }
}

fn every<D: Doubles>(v: DVec3) -> Row<D> {
    Row::from(v).map(D::splat)
}

/// Returns the distances at which rays from outside of a sphere hit it, and those that do.
#[inline(always)]
fn first_hit<D: Doubles>(
    origin: Row<D>,
    toward: Row<D>,
    center: DVec3,
    radius: f64,
) -> (D, D::Mask) {
    let (zero, radius2) = (D::splat(0.0), D::splat(radius * radius));
    let offset = every(center) - origin;
    let along = offset.dot_unfused(toward);
    let off = offset - toward * along;
    let inside2 = radius2 - off.dot_unfused(off);
    let ahead = zero.lt(along) & radius2.lt(offset.dot_unfused(offset));
    let hit = ahead & zero.lt(inside2);
    (along - D::select(hit, inside2, zero).sqrt(), hit)
}

/// Returns the ways of camera rays by a specular sphere, mirrored outside or refracted twice.
#[inline(always)]
fn by_sphere<D: Doubles>(caster: &Caster, through: bool, rays: Ways<D>) -> Ways<D> {
    let (zero, one, two) = (D::splat(0.0), D::splat(1.0), D::splat(2.0));
    let (entry, hit) = first_hit(rays.origin, rays.toward, caster.center, caster.radius);
    let point = rays.origin + rays.toward * entry;
    let normal = (point - every(caster.center)) * D::splat(caster.radius.recip());
    let cosine = -normal.dot_unfused(rays.toward);
    let index = D::splat(caster.index);
    let (reflected, refracted) =
        if caster.index > 0.0 { fresnel::dielectric(cosine, index) } else { (one, zero) };
    let only_hits = |kept| D::select(hit, kept, zero);
    if !through {
        let toward_light = rays.toward + normal * (two * cosine);
        return Ways {
            entry,
            cosine,
            exit: point,
            toward_light,
            kept: only_hits(reflected),
            ..rays
        };
    }
    let inside = rays.toward * index + normal * (index * cosine - refracted);
    let exit = point + inside * (D::splat(2.0 * caster.radius) * refracted);
    let outward = (exit - every(caster.center)) * D::splat(caster.radius.recip());
    // The angles at the exit are those of the entry.
    let toward_light = (inside - outward * refracted) * (one / index) + outward * cosine;
    let kept = only_hits((one - reflected) * (one - reflected));
    Ways { entry, exit, toward_light, cosine, kept, ..rays }
}

impl Ways<F64x8> {
    /// Returns the way in a lane.
    fn way(&self, lane: usize) -> Way {
        let one = |v: Row<F64x8>| -> Vec3 {
            let [x, y, z] = [v.x, v.y, v.z].map(|row| row.to_array()[lane] as f32);
            Vec3::new(x, y, z)
        };
        Way {
            origin: one(self.origin),
            toward: one(self.toward).normalize(),
            entry: self.entry.to_array()[lane],
            exit: one(self.exit),
            toward_light: one(self.toward_light).normalize(),
            length: self.length.to_array()[lane],
            cosine: self.cosine.to_array()[lane] as f32,
        }
    }
}

/// Returns the radiance of a light, times the color of the specular sphere.
fn color(world: &World, light: &SeenLight, cosine: f32) -> Rgb {
    let radiance = match light.source {
        CausticSource::Sun(sun) => world.lights.suns[sun].radiance,
        CausticSource::Sphere(row) => world.materials.emitter[world.material(row).row()].radiance,
    };
    if light.sphere == MISS {
        return radiance;
    }
    radiance * caustics::specular_color(world, light.sphere, light.through, cosine)
}

/// Enqueues the shadow rays of a way, with a weight.
fn push(job: &Job, work: &mut Workspace, row: usize, light: &SeenLight, way: &Way, weight: f32) {
    let color = color(job.world, light, way.cosine) * weight;
    if !(color.max_element() > 0.0 && color.is_finite()) {
        return;
    }
    let target = match light.source {
        CausticSource::Sun(_) => MISS,
        CausticSource::Sphere(row) => row,
    };
    let ray = ShadowRay {
        start: (way.exit, light.sphere),
        direction: way.toward_light,
        end: (way.length, target),
        path: work.states.path(row) as u32,
        light: color,
    };
    let first = CameraSegment { origin: way.origin, direction: way.toward, length: way.entry };
    caustics::push_segments(job, work, (light.sphere != MISS).then_some(&first), &ray);
}
