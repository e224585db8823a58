//! Ambient occlusion: the cosine-weighted share of directions in which nothing is nearer than a
//! limit.
//!
//! Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", EGWR 1998. Surfaces are tinted
//! by their color, whatever their material; rays that hit nothing see the environment.

use super::Job;
use super::gather::Gathered;
use super::shadows::cast;
use super::stages;
use super::workspace::Workspace;
use crate::lanes::F32x16;
use crate::sampling::cosine_hemispheres;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::{Kind, LightRow, ROW};

/// One direction for each path; `distance` is in world units.
pub fn integrate(job: &Job, work: &mut Workspace, distance: f64) {
    stages::intersect(job, work);
    for i in 0..work.bins.escaped.len() {
        let row = work.bins.escaped[i] as usize;
        let direction = work.rays.direction.row(row);
        let place = work.place[row] as usize;
        work.paths.radiance[place] = job.world.environment.radiance(direction);
    }
    for kind in Kind::ALL {
        let rows = std::mem::take(&mut work.bins.kind[kind as usize]);
        for rows in rows.chunks(ROW) {
            let paths = Gathered::new(work, rows);
            let draw = job.sampler.scatter_row(&paths.sample, 0, false);
            let direction = paths.to_world(cosine_hemispheres(draw.direction));
            let sky = LightRow {
                t: [distance; ROW],
                ..LightRow::distant(direction, Rgb::ONE, paths.lanes)
            };
            let colors = paths.starts.at.own.map(|hit| job.world.albedo(hit));
            let channel = |i: usize| F32x16::new(colors.map(|color| color[i]));
            let light = Vec3::new(channel(0), channel(1), channel(2));
            cast(job, work, &paths.starts, (&sky, paths.lanes), light);
        }
        work.bins.kind[kind as usize] = rows;
    }
    stages::occlude(job, work);
}
