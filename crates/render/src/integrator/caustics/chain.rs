//! Chains of specular bounces since the last diffuse surface, for the MIS weights of caustics.

use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use crate::ray::{GROUND, MISS, Rays};
use crate::shade::MaterialKind;
use crate::world::{CausticHit, World};
use glam::Vec3;

/// A path's specular bounces since it left a diffuse surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecularChain {
    /// Point and normal where it left the diffuse surface.
    start: [Vec3; 2],
    toward: Vec3,
    pdf: f32,
    /// The only sphere of the chain; [`MISS`] if there is none, or more than one.
    sphere: u32,
    /// True if the path is, or was, inside the sphere.
    inside: bool,
}

impl SpecularChain {
    pub(super) const NONE: Self =
        Self { start: [Vec3::ZERO; 2], toward: Vec3::ZERO, pdf: 0.0, sphere: MISS, inside: false };
}

/// Updates the chains of all paths, before they are scattered.
pub(in crate::integrator) fn track_chains(job: &Job, work: &mut Workspace) {
    let Some(casters) = job.casters() else { return };
    for kind in [MaterialKind::Conductor, MaterialKind::Dielectric, MaterialKind::Plastic] {
        let Some(queue) = work.queues.of(kind) else { continue };
        for (i, row) in queue.ray_rows().enumerate() {
            let (hit, previous) = (work.hits.sphere[row], queue.states.previous(i));
            let chain = &mut work.caustics.chains[queue.states.path(i)];
            let repeated = chain.sphere == hit && work.rays.own[row] == hit && !chain.inside;
            *chain = if previous.after_diffuse() && casters.has(hit) {
                start_chain(job.world, &work.rays, row, (previous.density(), hit))
            } else if repeated && !previous.light_sampled() {
                SpecularChain { inside: true, ..*chain }
            } else {
                SpecularChain::NONE
            };
        }
    }
}

/// Returns the chain of a path that has reached a sphere from a diffuse surface, on the outside of a
/// sphere or above the ground.
fn start_chain(world: &World, rays: &Rays, row: usize, (pdf, sphere): (f32, u32)) -> SpecularChain {
    let (point, toward) = (rays.origin.row(row), rays.direction.row(row));
    let normal = match (rays.own[row], &world.ground) {
        (GROUND, Some(ground)) => ground.normal.as_vec3(),
        (own, _) => (point - world.spheres.center(own as usize)).normalize(),
    };
    if normal.dot(toward) <= 0.0 {
        return SpecularChain::NONE;
    }
    SpecularChain { start: [point, normal], toward, pdf, sphere, inside: false }
}

/// Returns the MIS weight of the emitter that a path has hit, beside caustic samples.
pub(in crate::integrator) fn mis_weight(
    job: &Job,
    work: &Workspace,
    row: usize,
    path: usize,
) -> f32 {
    let Some(casters) = job.casters() else { return 1.0 };
    let chain = &work.caustics.chains[path];
    if chain.sphere == MISS || work.rays.own[row] != chain.sphere {
        return 1.0;
    }
    casters.weight(&CausticHit {
        start: chain.start,
        toward: chain.toward,
        pdf: chain.pdf,
        sphere: chain.sphere,
        through: chain.inside,
        emitter: work.hits.sphere[row],
        end: [work.surface.point.row(row), work.rays.direction.row(row)],
    })
}
