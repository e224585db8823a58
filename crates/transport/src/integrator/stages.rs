//! Stages that integrators share.

use super::Job;
use super::clock::Stage;
use super::shadow_queue;
use super::workspace::Workspace;
use crate::film::View;
use crate::ray::MISS;
use crate::trace;

/// Traces the rays, computes the surface points, and fills the material queues.
pub fn intersect(job: &Job, work: &mut Workspace) {
    if let Some(ground) = job.unreachable_ground() {
        trace::intersect_ground(&ground, &work.rays, &mut work.hits);
    }
    match std::mem::replace(&mut work.view, View::Anything) {
        View::Background => trace::closest_ground(job.world, &work.rays, &mut work.hits),
        View::Anything => {
            work.counters.exact_decisions += if work.rays.own.first() == Some(&MISS) {
                work.trace_camera_rays(job)
            } else {
                trace::closest(job.tracer, job.world, &work.rays, &mut work.hits)
            };
        }
    }
    work.probes.count_rays((0..work.rays.len()).map(|row| work.states.path(row) as u32));
    work.clock.end(Stage::Trace);
    work.surface.compute(job.world, &work.rays, &work.hits);
    work.record_features(job.world);
    work.sort(job.world);
    work.clock.end(Stage::Surface);
}

/// Ends a bounce: traces its shadow rays, and makes the next rays the current ones. Returns whether any
/// path is alive.
pub fn end_bounce(job: &Job, work: &mut Workspace) -> bool {
    shadow_queue::trace_shadow_rays(job, work);
    work.advance();
    work.clock.end(Stage::Shade);
    work.counters.bounce_rays += work.len() as u64;
    !work.is_empty()
}
