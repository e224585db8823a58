//! Integrators: estimate radiance along camera rays by wavefront path tracing.
//!
//! A batch of paths passes one stage after the other, in loops over columns. All three integrators
//! start with [`generate`], alternate [`stages::intersect`] with shading, one kernel per kind of
//! material, and leave the radiance of each path in [`workspace::Paths`]. A stage whose queue is empty
//! does nothing.

pub mod ao;
mod caustics;
pub mod clock;
pub mod columns;
pub mod counters;
pub mod device;
mod direct_light;
pub mod elisions;
mod emission;
pub mod features;
pub mod generate;
mod glass;
mod interior;
pub mod light_images;
pub mod material_queues;
pub mod material_table;
mod mirrored_light;
pub mod near_misses;
mod next_rays;
pub mod path;
pub mod path_state;
pub mod preview;
pub mod probe_batch;
mod roulette;
pub mod shading_row;
pub mod shadow_queue;
pub mod stages;
pub mod surface;
pub mod whitted;
pub mod workspace;

use crate::sampling::{PixelFilter, Sampler};
use crate::scene::{Integrator, Settings};
use crate::shade::MaterialId;
use crate::trace::Tracer;
use crate::world::{DevicePaths, Ground, World};
use elisions::Elisions;
use glam::DVec3;
use workspace::Workspace;

/// Everything that an integrator reads.
#[derive(Clone)]
pub struct Job<'a> {
    /// The scene.
    pub world: &'a World,
    /// Settings of the render.
    pub settings: &'a Settings,
    /// Sample points.
    pub sampler: Sampler,
    /// Pixel filter.
    pub filter: PixelFilter,
    /// Ray traversal.
    pub tracer: Tracer,
    /// Work that may be omitted without changing the image.
    pub elisions: Elisions,
    /// The device that follows the paths of the picture's samples, if one does.
    pub device: Option<&'a dyn DevicePaths>,
}

impl<'a> Job<'a> {
    /// Creates a job that no device takes part in, for pixels of `samples` samples.
    pub fn new(
        world: &'a World,
        settings: &'a Settings,
        samples: u32,
        tracer: Tracer,
        elisions: Elisions,
    ) -> Self {
        let sampler = Sampler::new(settings.sampler, settings.seed, samples);
        let filter = PixelFilter::new(settings.filter);
        Self { world, settings, sampler, filter, tracer, elisions, device: None }
    }

    /// Returns the maximum number of bounces.
    pub fn depth(&self) -> u32 {
        self.settings.depth.unwrap_or(Settings::HARD_DEPTH)
    }

    /// Returns whether points on the lens are sampled.
    pub fn has_lens(&self) -> bool {
        self.world.features.lens || !self.elisions.lens
    }

    /// Returns whether lights are sampled.
    pub fn has_lights(&self) -> bool {
        self.world.features.lights || !self.elisions.lights
    }

    /// Returns a ground that no ray reaches, if the world has none and tests against it are not
    /// omitted.
    pub fn unreachable_ground(&self) -> Option<Ground> {
        let (normal, material) = (DVec3::Z, MaterialId::default());
        let far = Ground { normal, height: f64::NEG_INFINITY, material };
        (self.world.ground.is_none() && !self.elisions.plane).then_some(far)
    }

    /// Follows the generated paths to their ends.
    pub fn integrate(&self, work: &mut Workspace) {
        match self.settings.integrator {
            Integrator::Path => path::integrate(self, work),
            Integrator::Whitted { shadow_samples } => {
                whitted::integrate(self, work, shadow_samples);
            }
            Integrator::Ao { distance } => ao::integrate(self, work, distance),
        }
    }
}
