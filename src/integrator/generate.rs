//! Where paths begin: rays from the camera.

use super::Job;
use super::clock::Stage;
use super::workspace::Workspace;
use crate::film::Tile;
use crate::lanes::{F32x16, F64x8, MAX_LANES, widen};
use crate::sampling::{self, Sampler};
use crate::shade::dielectric;
use crate::world::World;
use std::ops::Range;

/// Begins a path for each of `samples` of each of the tile's pixels. Neighbors in the columns are
/// neighbors in the picture: packets are square.
pub fn generate(job: &Job, tile: &Tile, samples: Range<u32>, work: &mut Workspace) {
    generate_streams(job, tile.pixels().map(|(x, y)| (x, y, *job.sampler)), samples, work);
}

/// The same for streams of samples: column and row of a pixel, and the sampler of its numbers.
pub fn generate_streams(
    job: &Job,
    streams: impl Iterator<Item = (u32, u32, Sampler)>,
    samples: Range<u32>,
    work: &mut Workspace,
) {
    let mut count = 0;
    for (x, y, sampler) in streams {
        work.start(&sampler, (x, y, samples.start), count..count + samples.len());
        count += samples.len();
    }
    work.begin(count);
    for first in (0..count).step_by(MAX_LANES) {
        let carried = work.carried.leave_camera(first);
        let numbers = work.paths.numbers(&carried);
        let offset = job.filter.offset_row(job.sampler.pixel_row(&numbers));
        let lens =
            job.has_lens().then(|| sampling::concentric_disk(job.sampler.lens_row(&numbers)));
        aim(job, work, first, (offset, lens));
    }
    leave_camera(job, work);
}

/// Begins a path through the center of each of the tile's pixels, and through that of the lens.
pub fn generate_centers(job: &Job, tile: &Tile, work: &mut Workspace) {
    let mut count = 0;
    for (x, y) in tile.pixels() {
        work.start(job.sampler, (x, y, 0), count..count + 1);
        count += 1;
    }
    work.begin(count);
    let middle = [F32x16::splat(0.0); 2];
    for first in (0..count).step_by(MAX_LANES) {
        work.carried.leave_camera(first);
        aim(job, work, first, (middle, Some(middle)));
    }
    leave_camera(job, work);
}

/// Turns sixteen pixels, where rays start, into rays, by offsets from the pixels' middles and
/// places on the lens.
#[inline(always)]
fn aim(
    job: &Job,
    work: &mut Workspace,
    first: usize,
    (offset, lens): ([F32x16; 2], Option<[F32x16; 2]>),
) {
    let (origin, direction) = (&mut work.rays.origin, &mut work.rays.direction);
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

/// Notes that paths have left the camera, and where.
fn leave_camera(job: &Job, work: &mut Workspace) {
    let count = work.len();
    if work.paths.keeps_inside() {
        (0..count).for_each(|path| enter_glass(job.world, work, path));
    }
    work.counters.camera_rays += count as u64;
    work.clock.end(Stage::Generate);
}

/// Notes the glass spheres in which a camera ray starts. On a surface, its direction decides.
fn enter_glass(world: &World, work: &mut Workspace, row: usize) {
    let ray = work.rays.exact(row);
    let path = work.carried.place(row);
    for &sphere in &world.features.glass_at_camera {
        let offset = ray.origin - world.spheres.center(sphere as usize).as_dvec3();
        let radius = f64::from(world.spheres.radius(sphere as usize));
        let outside = offset.length_squared() - radius * radius;
        let inward = offset.dot(ray.direction) < 0.0;
        if (outside < 0.0 || (outside == 0.0 && inward))
            && !dielectric::insert(world, work.paths.inside(path), sphere)
        {
            work.counters.nesting_overflows += 1;
        }
    }
}
