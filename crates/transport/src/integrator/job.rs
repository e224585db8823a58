//! Jobs: everything that integrators read.

use super::elisions::Elisions;
use crate::sampling::{PixelFilter, Sampler};
use crate::scene::Settings;
use crate::shade::MaterialId;
use crate::trace::Tracer;
use crate::world::{DevicePaths, Ground, World};
use glam::{DVec3, Vec3};

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

    /// Returns the density by solid angle of the camera rays of a pixel, from a point of the lens.
    pub(super) fn camera_pdf(&self, [x, y]: [u32; 2], origin: Vec3, toward: Vec3) -> f32 {
        let (place, area) = self.world.camera.place(origin.as_dvec3(), toward.as_dvec3());
        let offset = [place.x - f64::from(x) - 0.5, place.y - f64::from(y) - 0.5];
        (self.filter.pdf(offset) * area) as f32
    }
}
