//! Ambient occlusion: the cosine-weighted share of directions in which nothing is nearer than a
//! limit.
//!
//! Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", EGWR 1998. Surfaces are tinted
//! by their color, whatever their material; rays that hit nothing see the environment.

use super::Job;
use super::path::cast_shadow;
use super::stages::{self, Local};
use super::workspace::Workspace;
use crate::ray::MISS;
use crate::sampling::cosine_hemisphere;
use crate::world::{Kind, LightSample};

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
        for &row in &rows {
            let row = row as usize;
            let local = Local::new(work, row);
            let sample = &work.paths.sample[work.place[row] as usize];
            let draw = job.sampler.scatter(sample, 0);
            let direction = local.to_world(cosine_hemisphere(draw.direction));
            let hit = work.hits.sphere[row];
            let color = job.world.albedo(hit);
            let sky = LightSample {
                direction,
                t: distance,
                target: MISS,
                weight: color,
                pdf: None,
                close: false,
            };
            cast_shadow(job, work, row, (&sky, color), local.inside);
        }
        work.bins.kind[kind as usize] = rows;
    }
    stages::occlude(job, work);
}
