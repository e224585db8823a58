//! Ambient occlusion: the cosine-weighted fraction of directions in which nothing is nearer than a
//! limit.
//!
//! Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", EGWR 1998. Surfaces are tinted by
//! their color, whatever their material; rays that hit nothing see the background. With a limit of 0 nothing is near, and surfaces
//! show their color alone.

use super::Job;
use super::shading_row::{ShadingRow, SurfaceLanes};
use super::shadow_queue::{self, enqueue_shadow_rays};
use super::stages;
use super::workspace::Workspace;
use crate::sampling::cosine_hemispheres;
use crate::scene::Rgb;
use crate::shade::MaterialKind;
use crate::world::{LANES, LightLanes};

/// Traces one ambient occlusion ray per path; `distance` is in world units.
pub fn integrate(job: &Job, work: &mut Workspace, distance: f64) {
    if distance == 0.0 {
        work.composite_colors();
    }
    stages::intersect(job, work);
    for row in 0..work.len() {
        let throughput = work.throughput_behind(row);
        if throughput == Rgb::ZERO {
            continue;
        }
        let environment = &job.world.environment;
        let direction = work.rays.direction.row(row);
        let seen = environment.background.unwrap_or_else(|| environment.radiance(direction));
        work.paths.radiance[work.states.path(row)] += throughput * seen;
    }
    for kind in MaterialKind::ALL {
        let Some(queue) = work.queues.take(kind) else { continue };
        for rows in queue.rows() {
            let surface_row = SurfaceLanes::load(&queue, rows.first);
            let shading = ShadingRow::new(&queue, rows, &surface_row);
            let light = surface_row.state.throughput.times(surface_row.albedo(job.world));
            if distance == 0.0 {
                work.paths.add(surface_row.state.path, light, shading.lanes);
                continue;
            }
            let numbers = work.paths.sampler_row(&shading.surface_row.state);
            let draw = job.sampler.scatter_row(&numbers, 0, false);
            let direction = shading.to_world(cosine_hemispheres(draw.direction));
            let sky = LightLanes {
                t: [distance; LANES],
                ..LightLanes::distant(direction, Rgb::ONE, shading.lanes)
            };
            enqueue_shadow_rays(job, work, &surface_row, &sky, shading.lanes, light);
        }
        work.queues.put(kind, queue);
    }
    if distance == 0.0 {
        work.add_missing_colors(Rgb::ONE);
    }
    shadow_queue::trace_shadow_rays(job, work);
}
