//! What paths have met since they left a diffuse surface.

use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use crate::ray::{GROUND, MISS, Rays};
use crate::world::{Found, Kind, World};
use glam::Vec3;

/// What a path has met since it left a diffuse surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chain {
    /// Where it left the surface, and the normal there.
    start: [Vec3; 2],
    toward: Vec3,
    pdf: f32,
    /// The one ball that it has met; [`MISS`] if it was another thing or more than one.
    ball: u32,
    /// Whether it is in the ball, or was.
    inside: bool,
}

impl Chain {
    pub(super) const NONE: Self =
        Self { start: [Vec3::ZERO; 2], toward: Vec3::ZERO, pdf: 0.0, ball: MISS, inside: false };
}

/// Notes which paths have met a ball, before they go on.
pub(in crate::integrator) fn follow(job: &Job, work: &mut Workspace) {
    let Some(casters) = job.casters() else { return };
    for kind in [Kind::Conductor, Kind::Dielectric, Kind::Plastic] {
        let Some(bin) = work.bins.of(kind) else { continue };
        for (i, row) in bin.each().enumerate() {
            let (hit, arrival) = (work.hits.sphere[row], bin.carried.arrival(i));
            let chain = &mut work.caustics.chains[bin.carried.place(i)];
            let again = chain.ball == hit && work.rays.own[row] == hit && !chain.inside;
            *chain = if arrival.diffuse() && casters.has(hit) {
                begin(job.world, &work.rays, row, (arrival.density(), hit))
            } else if again && !arrival.sampled() {
                Chain { inside: true, ..*chain }
            } else {
                Chain::NONE
            };
        }
    }
}

/// A path that has come to a ball from a diffuse surface, on the outside of a sphere or above the
/// ground.
fn begin(world: &World, rays: &Rays, row: usize, (pdf, ball): (f32, u32)) -> Chain {
    let (point, toward) = (rays.origin.row(row), rays.direction.row(row));
    let normal = match (rays.own[row], &world.ground) {
        (GROUND, Some(ground)) => ground.normal.as_vec3(),
        (own, _) => (point - world.spheres.center(own as usize)).normalize(),
    };
    if normal.dot(toward) <= 0.0 {
        return Chain::NONE;
    }
    Chain { start: [point, normal], toward, pdf, ball, inside: false }
}

/// What the light counts of a lamp that the path in a row and of a place has met, beside samples that look for it.
pub(in crate::integrator) fn weight(job: &Job, work: &Workspace, row: usize, place: usize) -> f32 {
    let Some(casters) = job.casters() else { return 1.0 };
    let chain = &work.caustics.chains[place];
    if chain.ball == MISS || work.rays.own[row] != chain.ball {
        return 1.0;
    }
    casters.weight(&Found {
        start: chain.start,
        toward: chain.toward,
        pdf: chain.pdf,
        ball: chain.ball,
        through: chain.inside,
        lamp: work.hits.sphere[row],
        end: [work.surface.point.row(row), work.rays.direction.row(row)],
    })
}
