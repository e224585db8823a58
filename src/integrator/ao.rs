//! Ambient occlusion: the cosine-weighted share of directions in which nothing is nearer than a
//! limit.
//!
//! Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", EGWR 1998. Surfaces are tinted
//! by their color, whatever their material; rays that hit nothing see the environment.

use super::Job;
use super::gather::{Gathered, Starts};
use super::shadows::cast;
use super::stages;
use super::workspace::Workspace;
use crate::lanes::F32x16;
use crate::ray::MISS;
use crate::sampling::cosine_hemispheres;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::{Kind, LightRow, ROW};

/// One direction for each path; `distance` is in world units.
pub fn integrate(job: &Job, work: &mut Workspace, distance: f64) {
    stages::intersect(job, work);
    for row in (0..work.len()).filter(|&row| work.hits.sphere[row] == MISS) {
        let direction = work.rays.direction.row(row);
        work.paths.radiance[work.carried.place(row)] = job.world.environment.radiance(direction);
    }
    for kind in Kind::ALL {
        let Some(bin) = work.bins.take(kind) else { continue };
        for rows in bin.rows() {
            let starts = Starts::of(&bin, rows.0);
            let paths = Gathered::new(&bin, rows, &starts);
            let numbers = work.paths.numbers(&paths.starts.carried);
            let draw = job.sampler.scatter_row(&numbers, 0, false);
            let direction = paths.to_world(cosine_hemispheres(draw.direction));
            let sky = LightRow {
                t: [distance; ROW],
                ..LightRow::distant(direction, Rgb::ONE, paths.lanes)
            };
            let colors = paths.starts.at.own.map(|hit| job.world.albedo(hit));
            let channel = |i: usize| F32x16::new(colors.map(|color| color[i]));
            let light = Vec3::new(channel(0), channel(1), channel(2));
            cast(job, work, &starts, (&sky, paths.lanes), light);
        }
        work.bins.put(kind, bin);
    }
    stages::occlude(job, work);
}
