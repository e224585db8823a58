//! Chains of specular bounces since the last diffuse surface, for the MIS weights of caustics.

use crate::integrator::Job;
use crate::integrator::path_state::PreviousBounce;
use crate::integrator::workspace::Workspace;
use crate::ray::{MISS, Rays};
use crate::shade::MaterialKind;
use crate::world::{
    CausticCasters, CausticHit, CausticSource, LightImage, Receiver, SeenLight, World,
};
use glam::Vec3;

/// A path's specular bounces since it left a surface that is not specular, or the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecularChain {
    /// Point and normal where it left that surface.
    start: [Vec3; 2],
    /// The hit on that surface; [`MISS`] for the camera, which has no density.
    own: u32,
    toward: Vec3,
    pdf: f32,
    /// The only sphere of the chain; [`MISS`] if there is none, or more than one.
    sphere: u32,
    /// True if the path is, or was, inside the sphere.
    inside: bool,
}

impl SpecularChain {
    pub(super) const NONE: Self = Self {
        start: [Vec3::ZERO; 2],
        own: MISS,
        toward: Vec3::ZERO,
        pdf: 0.0,
        sphere: MISS,
        inside: false,
    };
}

/// An emitter that a path has reached by specular surfaces.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct ReachedEmitter {
    pub(in crate::integrator) source: CausticSource,
    /// Point of an emissive sphere; of a sun, the direction toward it.
    pub(in crate::integrator) end: Vec3,
    /// Direction of the ray there.
    pub(in crate::integrator) toward: Vec3,
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
            let from_camera = work.rays.own[row] == MISS && !work.seen_lights.is_empty();
            *chain = if from_camera && casters.has(hit) {
                start_at_camera(&work.rays, row, hit)
            } else if previous.light_sampled() && casters.has(hit) {
                start_chain(job.world, &work.rays, row, previous.density(), hit)
            } else if repeated && !previous.light_sampled() {
                SpecularChain { inside: true, ..*chain }
            } else {
                SpecularChain::NONE
            };
        }
    }
}

/// Returns the chain of a camera ray that has reached a sphere.
fn start_at_camera(rays: &Rays, row: usize, sphere: u32) -> SpecularChain {
    let (point, toward) = (rays.origin.row(row), rays.direction.row(row));
    SpecularChain { start: [point, toward], toward, sphere, ..SpecularChain::NONE }
}

/// Returns the chain of a path that has reached a sphere from a surface that is not specular, on the
/// outside of a sphere or above the ground, by a direction of density `pdf`.
fn start_chain(world: &World, rays: &Rays, row: usize, pdf: f32, sphere: u32) -> SpecularChain {
    let (point, toward) = (rays.origin.row(row), rays.direction.row(row));
    let normal = world.normal_at(rays.own[row], point, toward);
    let Some(normal) = normal else { return SpecularChain::NONE };
    if normal.dot(toward) <= 0.0 {
        return SpecularChain::NONE;
    }
    SpecularChain { start: [point, normal], own: rays.own[row], toward, pdf, sphere, inside: false }
}

/// Returns the MIS weight of an emitter that the path in a row reaches by specular surfaces alone,
/// with [`end`](ReachedEmitter::end), beside caustic samples; 0 if the camera sees it, and samples
/// it in its pixels.
pub(in crate::integrator) fn weight(
    job: &Job,
    work: &Workspace,
    row: usize,
    source: CausticSource,
    end: Vec3,
) -> f32 {
    let path = work.states.path(row);
    let seen_in = |sphere, through| {
        let light = SeenLight { source, sphere, through };
        work.seen_lights.find(job, path, &light)
    };
    if work.rays.own[row] == MISS {
        return if seen_in(MISS, false).is_some() { 0.0 } else { 1.0 };
    }
    let Some(casters) = job.casters() else { return 1.0 };
    let chain = &work.caustics.chains[path];
    if chain.sphere == MISS || work.rays.own[row] != chain.sphere {
        return 1.0;
    }
    let reached = ReachedEmitter { source, end, toward: work.rays.direction.row(row) };
    if chain.own != MISS {
        return chain.weight(casters, &reached, None);
    }
    let image = seen_in(chain.sphere, chain.inside);
    image.map_or(1.0, |image| chain.weight_at_camera(job, work, path, image, &reached))
}

/// Returns the MIS weight of an emitter that the ray in a row sees in the mirroring sphere that it
/// has hit, beside caustic samples.
pub(in crate::integrator) fn mirrored_weight(
    job: &Job,
    work: &Workspace,
    row: usize,
    previous: PreviousBounce<f32>,
    reached: &ReachedEmitter,
) -> f32 {
    let (Some(casters), hit) = (job.casters(), work.hits.sphere[row]) else { return 1.0 };
    if work.rays.own[row] == MISS {
        let light = SeenLight { source: reached.source, sphere: hit, through: false };
        let path = work.states.path(row);
        let chain = start_at_camera(&work.rays, row, hit);
        let image = work.seen_lights.find(job, path, &light);
        return image.map_or(1.0, |image| chain.weight_at_camera(job, work, path, image, reached));
    }
    if !previous.light_sampled() || !casters.has(hit) {
        return 1.0;
    }
    let chain = start_chain(job.world, &work.rays, row, previous.density(), hit);
    if chain.sphere == MISS {
        return 1.0;
    }
    chain.weight(casters, reached, None)
}

impl SpecularChain {
    /// Returns the weight of an emitter of which the camera sees this image, beside samples in its pixels.
    fn weight_at_camera(
        &self,
        job: &Job,
        work: &Workspace,
        path: usize,
        image: &LightImage,
        reached: &ReachedEmitter,
    ) -> f32 {
        let Some(casters) = job.casters().filter(|_| image.is_tiny()) else { return 0.0 };
        let ([origin, toward], pixel) = (self.start, work.seen_lights.pixel(path));
        let pdf = job.camera_pdf(pixel, origin, toward);
        Self { pdf, ..*self }.weight(casters, reached, Some(1.0))
    }

    /// Returns the MIS weight of an emitter.
    fn weight(&self, casters: &CausticCasters, reached: &ReachedEmitter, rate: Option<f64>) -> f32 {
        let [point, normal] = self.start;
        casters.weight(&CausticHit {
            start: Receiver { point, normal, own: self.own },
            toward: self.toward,
            pdf: self.pdf,
            sphere: self.sphere,
            through: self.inside,
            emitter: reached.source,
            end: reached.end,
            toward_emitter: reached.toward,
            rate,
        })
    }
}
