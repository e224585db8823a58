//! Camera rays: the start of paths.

use super::Job;
use super::clock::Stage;
use super::interior;
use super::workspace::Workspace;
use crate::lanes::{F32x16, F64x8, MAX_LANES, widen};
use crate::sampling::{self, SampleRow, Sampler};
use crate::world::World;
use std::ops::Range;

/// Number of the event at which the numbers of [`Workspace::thresholds`] are sampled.
const THRESHOLD: u32 = u32::MAX;

/// Starts a path for each of `samples` of each of some pixels, no more than a batch. In the order of
/// [`Tile::pixels`](crate::film::Tile::pixels), packets are square.
pub fn generate(
    job: &Job,
    pixels: impl Iterator<Item = (u32, u32)>,
    samples: Range<u32>,
    work: &mut Workspace,
) {
    generate_streams(job, &mut pixels.map(|(x, y)| (x, y, job.sampler)), samples, work);
}

/// Starts paths for streams of samples: column and row of a pixel, and the sampler of its numbers.
///
/// For any iterator there is one machine code, which is compiled with the other kernels.
pub fn generate_streams(
    job: &Job,
    streams: &mut dyn Iterator<Item = (u32, u32, Sampler)>,
    samples: Range<u32>,
    work: &mut Workspace,
) {
    let count = start(job, streams, samples, work);
    work.start_paths(count);
    for first in (0..count).step_by(MAX_LANES) {
        let state = work.states.init_camera(first);
        let numbers = work.paths.sampler_row(&state);
        let offset = job.filter.offset_row(job.sampler.pixel_row(&numbers));
        let lens =
            job.has_lens().then(|| sampling::concentric_disk(job.sampler.lens_row(&numbers)));
        generate_rays(job, work, first, offset, lens);
    }
    sample_thresholds(job, work, count);
    finish_camera_rays(job, work);
}

/// Samples at which translucent bodies camera rays end.
fn sample_thresholds(job: &Job, work: &mut Workspace, count: usize) {
    if work.thresholds.is_empty() {
        return;
    }
    for row in 0..count {
        let [number, _] = job.sampler.split(&work.sampler_state(row), THRESHOLD, 1).pair(0);
        work.thresholds[row] = number;
    }
}

/// Starts the samples of streams, and returns their number.
fn start(
    job: &Job,
    streams: &mut dyn Iterator<Item = (u32, u32, Sampler)>,
    samples: Range<u32>,
    work: &mut Workspace,
) -> usize {
    let mut count = 0;
    if samples.len().is_multiple_of(MAX_LANES) {
        for (x, y, sampler) in streams {
            let end = count + samples.len();
            work.start_pixel(&sampler, x, y, samples.start, count..end);
            count = end;
        }
        return count;
    }
    let mut row = SampleRow::default();
    for (x, y, sampler) in streams {
        for index in samples.clone() {
            row.set(count % MAX_LANES, x, y, index, &sampler);
            count += 1;
            if count.is_multiple_of(MAX_LANES) {
                work.start_samples(&job.sampler, &row, count - MAX_LANES);
            }
        }
    }
    if !count.is_multiple_of(MAX_LANES) {
        work.start_samples(&job.sampler, &row, count - count % MAX_LANES);
    }
    count
}

/// Replaces the numbers that decide at which translucent bodies the camera rays of some pixels end by a pattern of dots: in
/// each square of four by four pixels, as many see a body as its part is of 16.
///
/// Bayer, "An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures", ICC 1973.
pub fn dither_thresholds(pixels: impl Iterator<Item = (u32, u32)>, work: &mut Workspace) {
    const ORDER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    for (number, (x, y)) in work.thresholds.iter_mut().zip(pixels) {
        *number = (f32::from(ORDER[y as usize % 4][x as usize % 4]) + 0.5) / 16.0;
    }
}

/// Starts a path through the center of each of some pixels, no more than a batch, and of the lens. Camera rays end at the first
/// body, translucent or not.
pub fn generate_centers(job: &Job, pixels: impl Iterator<Item = (u32, u32)>, work: &mut Workspace) {
    start_centers(job, &mut pixels.map(|(x, y)| (x, y, job.sampler)), work);
}

/// Starts paths through the centers of the pixels of streams.
fn start_centers(
    job: &Job,
    streams: &mut dyn Iterator<Item = (u32, u32, Sampler)>,
    work: &mut Workspace,
) {
    let count = start(job, streams, 0..1, work);
    work.start_paths(count);
    work.thresholds.fill(0.0);
    let middle = [F32x16::splat(0.0); 2];
    for first in (0..count).step_by(MAX_LANES) {
        work.states.init_camera(first);
        generate_rays(job, work, first, middle, Some(middle));
    }
    finish_camera_rays(job, work);
}

/// Replaces sixteen pixel coordinates, stored as ray origins, by rays, with offsets from the pixels'
/// centers and points on the lens.
#[inline(always)]
fn generate_rays(
    job: &Job,
    work: &mut Workspace,
    first: usize,
    offset: [F32x16; 2],
    lens: Option<[F32x16; 2]>,
) {
    let (origin, direction) = (&mut work.rays.origin, &mut work.rays.direction);
    work.seen_lights.set_pixels(first, &origin.x[first..], &origin.y[first..]);
    let pixel = origin.load::<F32x16>(first);
    let (columns, rows) = (widen(pixel.x), widen(pixel.y));
    let [across, down] = [widen(offset[0]), widen(offset[1])];
    let lens = lens.map(|[u, v]| [widen(u), widen(v)]);
    for half in 0..2 {
        let middle = F64x8::splat(0.5);
        let place = [columns[half] + middle + across[half], rows[half] + middle + down[half]];
        let (from, toward) = job.world.camera.rays(place, lens.map(|[u, v]| [u[half], v[half]]));
        origin.set_row(first + 8 * half, from);
        direction.set_row(first + 8 * half, toward);
    }
}

/// Counts the camera rays, and initializes the interior lists.
fn finish_camera_rays(job: &Job, work: &mut Workspace) {
    let count = work.len();
    if work.paths.tracks_interiors() {
        (0..count).for_each(|path| init_interior_list(job.world, work, path));
    }
    work.counters.camera_rays += count as u64;
    work.clock.end(Stage::Generate);
}

/// Adds the glass spheres that contain the origin of a camera ray to its interior list. For an origin
/// on a surface, the direction decides.
fn init_interior_list(world: &World, work: &mut Workspace, row: usize) {
    let ray = work.rays.exact(row);
    let path = work.states.path(row);
    for &sphere in &world.features.glass_at_camera {
        let offset = ray.origin - world.spheres.center(sphere as usize).as_dvec3();
        let radius = f64::from(world.spheres.radius(sphere as usize));
        let outside = offset.length_squared() - radius * radius;
        let inward = offset.dot(ray.direction) < 0.0;
        if (outside < 0.0 || (outside == 0.0 && inward))
            && !interior::insert(world, work.paths.interior_list(path), sphere)
        {
            work.counters.nesting_overflows += 1;
        }
    }
}
