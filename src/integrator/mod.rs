//! From rays to radiance: loops over columns, no recursion.
//!
//! All three integrators begin with [`generate`], alternate [`stages::intersect`] with
//! shading, one system for each kind of material that was hit, and leave the radiance of each path
//! in [`workspace::Paths`]. A stage whose column is empty does nothing.

pub mod ao;
pub mod arrival;
pub mod bins;
pub mod block;
pub mod carried;
mod caustics;
pub mod clock;
pub mod counters;
mod found;
pub mod gather;
pub mod generate;
mod glass;
pub mod looks;
mod onward;
pub mod path;
mod scatter;
pub mod shadows;
pub mod skips;
pub mod stages;
mod struck;
pub mod surface;
pub mod whitted;
pub mod workspace;

use crate::sampling::{PixelFilter, Sampler};
use crate::scene::{Integrator, Settings};
use crate::trace::Tracer;
use crate::world::{Ground, MaterialId, World};
use glam::DVec3;
use skips::Skips;
use workspace::Workspace;

/// What an integrator reads.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// What there is.
    pub world: &'a World,
    /// How the picture is made.
    pub settings: &'a Settings,
    /// Where samples lie.
    pub sampler: &'a Sampler,
    /// How samples become pixels.
    pub filter: &'a PixelFilter,
    /// How rays find spheres.
    pub tracer: Tracer,
    /// What is left out where it changes nothing.
    pub skips: Skips,
}

impl Job<'_> {
    /// The most scatterings of a path.
    pub fn depth(&self) -> u32 {
        self.settings.depth.unwrap_or(Settings::HARD_DEPTH)
    }

    /// Whether the place on the lens is sampled.
    pub fn has_lens(&self) -> bool {
        self.world.features.lens || !self.skips.lens
    }

    /// Whether lights are sampled.
    pub fn has_lights(&self) -> bool {
        self.world.features.lights || !self.skips.lights
    }

    /// A ground that no ray reaches, where there is none and tests against it are not left out.
    pub fn unseen_ground(&self) -> Option<Ground> {
        let (normal, material) = (DVec3::Z, MaterialId::default());
        let far = Ground { normal, height: f64::NEG_INFINITY, material };
        (self.world.ground.is_none() && !self.skips.plane).then_some(far)
    }

    /// Follows the paths that were generated to their ends.
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
