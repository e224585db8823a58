//! The stages that integrators share, in the order of a path's life.

use super::Job;
use super::clock::Stage;
use super::surface::solve;
use super::workspace::Workspace;
use crate::film::{Tile, View};
use crate::lanes::{F64x8, Lanes, MAX_LANES, load_doubles};
use crate::ray::MISS;
use crate::sampling::{self, Sampler};
use crate::shade::{Material, dielectric};
use crate::trace;
use crate::world::{Kind, MaterialId, World};
use glam::Vec3;
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
        let rows = count..count + samples.len();
        sampler.start_all(x, y, samples.start, &mut work.paths.sample[rows.clone()]);
        work.rays.origin.x[rows.clone()].fill(x as f32);
        work.rays.origin.y[rows.clone()].fill(y as f32);
        count = rows.end;
    }
    work.begin(count);
    draw_places(job, work);
    start_at_camera(job, work);
}

/// Begins a path through the center of each of the tile's pixels, and through that of the lens.
pub fn generate_centers(job: &Job, tile: &Tile, work: &mut Workspace) {
    let mut count = 0;
    for (x, y) in tile.pixels() {
        work.rays.origin.set(count, Vec3::new(x as f32, y as f32, 0.0));
        work.rays.direction.set(count, Vec3::ZERO);
        count += 1;
    }
    work.begin(count);
    start_at_camera(job, work);
}

/// Turns pixels and places into paths that have left the camera.
fn start_at_camera(job: &Job, work: &mut Workspace) {
    aim_camera(job, work);
    let count = work.len();
    if work.paths.keeps_inside() {
        (0..count).for_each(|path| enter_glass(job.world, work, path));
    }
    work.counters.camera_rays += count as u64;
    work.clock.end(Stage::Generate);
}

/// Puts the offset from the pixel in the first two columns of directions, and the place on the lens
/// in the third ones of origins and directions.
fn draw_places(job: &Job, work: &mut Workspace) {
    let count = work.len();
    let (origin, direction) = (&mut work.rays.origin, &mut work.rays.direction);
    for (i, row) in
        work.paths.sample.as_chunks().0.iter().enumerate().take(count.div_ceil(MAX_LANES))
    {
        let first = i * MAX_LANES;
        let [dx, dy] = job.filter.offset_row(job.sampler.pixel_row(row));
        dx.store(&mut direction.x[first..]);
        dy.store(&mut direction.y[first..]);
        if job.has_lens() {
            let [x, y] = sampling::concentric_disk(job.sampler.lens_row(row));
            x.store(&mut origin.z[first..]);
            y.store(&mut direction.z[first..]);
        }
    }
}

/// Turns pixels and places into rays, where they stand.
fn aim_camera(job: &Job, work: &mut Workspace) {
    let (count, half) = (work.len(), F64x8::splat(0.5));
    let (origin, direction) = (&mut work.rays.origin, &mut work.rays.direction);
    for row in (0..count).step_by(8) {
        let place = |pixel: &[f32], offset: &[f32]| {
            load_doubles(&pixel[row..]) + half + load_doubles(&offset[row..])
        };
        let x = place(&origin.x, &direction.x);
        let y = place(&origin.y, &direction.y);
        let lens = job
            .has_lens()
            .then(|| [load_doubles(&origin.z[row..]), load_doubles(&direction.z[row..])]);
        let (from, toward) = job.world.camera.rays([x, y], lens);
        origin.set_row(row, from);
        direction.set_row(row, toward);
    }
}

/// Notes the glass spheres in which a camera ray starts. On a surface, its direction decides.
fn enter_glass(world: &World, work: &mut Workspace, path: usize) {
    let ray = work.rays.exact(path);
    for &row in &world.features.glass_at_camera {
        let offset = ray.origin - world.spheres.center(row as usize).as_dvec3();
        let radius = f64::from(world.spheres.radius(row as usize));
        let outside = offset.length_squared() - radius * radius;
        let inward = offset.dot(ray.direction) < 0.0;
        if (outside < 0.0 || (outside == 0.0 && inward))
            && !dielectric::insert(world, work.paths.inside(path), row)
        {
            work.counters.nesting_overflows += 1;
        }
    }
}

/// Finds what each path hits next, where, and sorts the rows by what it is.
pub fn intersect(job: &Job, work: &mut Workspace) {
    if let Some(ground) = job.unseen_ground() {
        trace::stop_at(&ground, &work.rays, &mut work.hits);
    }
    match std::mem::replace(&mut work.view, View::Anything) {
        View::Background => job.tracer.ground(job.world, &work.rays, &mut work.hits),
        View::Anything => {
            work.counters.exact_decisions +=
                job.tracer.closest(job.world, &work.rays, &mut work.hits);
        }
    }
    work.clock.end(Stage::Trace);
    solve(job.world, work);
    let count = work.len();
    work.bins.sort(job.world, &work.hits, count);
    work.clock.end(Stage::Surface);
}

/// The surface that a row has hit, as its material sees it.
#[derive(Clone, Copy)]
pub struct Local {
    /// To world space and back; z is the normal on the side that is looked at.
    pub frame: sampling::Frame,
    /// Local unit vector toward where the path came from.
    pub outgoing: Vec3,
    /// Whether the sphere is seen from inside.
    pub inside: bool,
}

impl Local {
    /// The surface under row `row`.
    #[inline]
    pub fn new(work: &Workspace, row: usize) -> Self {
        let direction = work.rays.direction.row(row);
        let normal = work.surface.normal.row(row);
        let inside = normal.dot(direction.as_dvec3()) > 0.0;
        let facing = if inside { -normal } else { normal };
        let frame = sampling::Frame::new(facing.as_vec3());
        let mut outgoing = frame.to_local(-direction);
        // At the limb, rounding may put the viewer below the horizon.
        outgoing.z = outgoing.z.max(f32::EPSILON);
        Self { frame, outgoing, inside }
    }

    /// A sampled direction in world space, of unit length.
    #[inline]
    pub fn to_world(&self, incoming: Vec3) -> Vec3 {
        self.frame.to_world(incoming).normalize()
    }
}

/// Traces the shadow rays and gives their light to the paths that it reaches.
pub fn occlude(job: &Job, work: &mut Workspace) {
    work.clock.end(Stage::Shade);
    let shadows = &mut work.shadows;
    if let Some(ground) = job.unseen_ground() {
        trace::hide_behind(&ground, &shadows.rays, &mut shadows.hits);
    }
    work.counters.exact_decisions += if job.skips.nearest_occluder {
        job.tracer.occluded(job.world, &shadows.rays, &mut shadows.hits)
    } else {
        job.tracer.closest(job.world, &shadows.rays, &mut shadows.hits)
    };
    for row in 0..shadows.rays.len() {
        if shadows.hits.sphere[row] == MISS {
            work.paths.radiance[shadows.place[row] as usize] += shadows.light[row];
        }
    }
    work.counters.shadow_rays += shadows.rays.len() as u64;
    shadows.rays.truncate(0);
    work.clock.end(Stage::Shadow);
}

/// A system that shades the rows of one kind of material.
pub trait ShadeKind {
    /// Shades the rows whose materials `material` finds.
    fn shade<M: Material>(
        &mut self,
        work: &mut Workspace,
        kind: Kind,
        material: impl Fn(MaterialId) -> M,
    );
}

/// Runs a system over every kind of material that was hit, but glass.
pub fn by_kind(job: &Job, work: &mut Workspace, system: &mut impl ShadeKind) {
    let tables = &job.world.materials;
    system.shade(work, Kind::Lambertian, |id| tables.lambertian[id.row()]);
    system.shade(work, Kind::Conductor, |id| tables.conductor[id.row()]);
    system.shade(work, Kind::Plastic, |id| tables.plastic[id.row()]);
    system.shade(work, Kind::Reflective, |id| tables.reflective[id.row()]);
    system.shade(work, Kind::Emitter, |id| tables.emitter[id.row()].surface());
}
