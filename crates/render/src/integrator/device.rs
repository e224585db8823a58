//! Devices that follow whole paths, in place of the processor.
//!
//! A device gets a job as numbers, and returns the radiance of each sample with the bits of the processor's, or says that
//! it does not know it: then the processor follows that path.

use super::Job;
use super::elisions::Elisions;
use super::roulette::roulette_threshold;
use crate::scene::{Integrator, Rgb, Roulette};
use crate::settings::SamplerKind;
use crate::shade::MaterialKind;
use crate::world::{CameraTerms, Radiance, World};
use bytemuck::{Pod, Zeroable};
use spherule_core::internals::ray::GROUND;
use std::fmt::Debug;
use std::ops::Range;

/// A device that follows the paths of a world whose spheres it has.
pub trait DeviceIntegrator: Debug + Send + Sync {
    /// Prepares for a job; `None` if the device fails.
    fn begin(&self, job: &DeviceJob) -> Option<Box<dyn DevicePaths>>;
}

/// A device that is prepared for a job.
pub trait DevicePaths: Send + Sync {
    /// Follows the paths of these samples of pixels, given by column and row: sample by sample of the first pixel, then of
    /// the next. `None` if the device fails.
    fn follow(&self, pixels: &[(u32, u32)], samples: Range<u32>) -> Option<Vec<DevicePath>>;
}

/// A path that a device has followed.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DevicePath {
    radiance: [f32; 3],
    /// Bit 0 is set if the radiance is not known; the others count rays after the camera's.
    state: u32,
}

impl DevicePath {
    /// Returns the radiance, if it is known.
    pub fn radiance(&self) -> Option<Rgb> {
        (self.state & 1 == 0).then_some(self.radiance.into())
    }

    /// Returns the number of rays, but for the camera's.
    pub fn rays(&self) -> u64 {
        u64::from(self.state >> 1)
    }
}

/// The integrator of a job, as far as devices have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceIntegration {
    /// Ambient occlusion, with a distance in the world's unit.
    Occlusion {
        /// Distance beyond which nothing occludes.
        distance: f64,
    },
    /// Paths among diffuse surfaces under the sky alone.
    Diffuse {
        /// Maximum number of bounces.
        depth: u32,
        /// Russian roulette.
        roulette: DeviceRoulette,
    },
}

/// Russian roulette.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceRoulette {
    /// None.
    None,
    /// From some bounce on, of paths with a throughput below this.
    ByThroughput(f32),
    /// Paths survive each bounce with this probability.
    Fixed(f32),
}

/// Radiance of the sky: `middle`, plus `slope` times the cosine of the angle to `up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceSky {
    /// The mean.
    pub middle: Rgb,
    /// Half of the difference between top and bottom, and the direction; `None` if the sky is even.
    pub gradient: Option<(Rgb, glam::Vec3)>,
    /// Radiance that the camera sees in its place.
    pub background: Option<Rgb>,
    /// True if it lights diffuse surfaces.
    pub illuminates: bool,
}

/// The numbers of a job.
#[derive(Clone, Debug)]
pub struct DeviceJob<'a> {
    /// The world.
    pub world: &'a World,
    /// The integrator.
    pub integration: DeviceIntegration,
    /// The camera.
    pub camera: CameraTerms,
    /// The sky.
    pub sky: DeviceSky,
    /// Hash of the seed of samples.
    pub seed: u64,
    /// Sobol's direction vectors: [`Sampler::table`](crate::sampling::Sampler::table).
    pub sobol: Vec<[u32; 4]>,
    /// Offsets of the pixel filter, if it is tabulated.
    pub offsets: Option<&'a [f32]>,
}

impl<'a> DeviceJob<'a> {
    /// Returns the numbers of a job, or what it has that devices do not do.
    ///
    /// # Errors
    /// A reason, which completes "the processor shades, for".
    pub fn new(job: &Job<'a>) -> Result<Self, &'static str> {
        let world = job.world;
        let integration = match job.settings.integrator {
            Integrator::Ao { distance } => DeviceIntegration::Occlusion { distance },
            Integrator::Whitted { .. } => return Err("devices have no whitted integrator"),
            Integrator::Path => DeviceIntegration::Diffuse {
                depth: job.depth(),
                roulette: match job.settings.roulette {
                    Roulette::None => DeviceRoulette::None,
                    Roulette::Throughput => DeviceRoulette::ByThroughput(roulette_threshold(world)),
                    Roulette::Fixed(p) => DeviceRoulette::Fixed(p as f32),
                },
            },
        };
        if let Some(reason) = unsupported(world, integration) {
            return Err(reason);
        }
        if job.settings.sampler != SamplerKind::Sobol {
            return Err("devices have Sobol points only");
        }
        if job.elisions != Elisions::ALL {
            return Err("no work is to be skipped");
        }
        let Some(sky) = sky(world) else { return Err("the sky is a picture") };
        Ok(Self {
            world,
            integration,
            camera: world.camera.terms(),
            sky,
            seed: job.sampler.hashed_seed(),
            sobol: job.sampler.table(),
            offsets: job.filter.offsets(),
        })
    }

    /// Returns the color of the ground, if there is one.
    pub fn ground_albedo(&self) -> Option<Rgb> {
        self.world.ground.map(|_| self.world.albedo(GROUND))
    }
}

/// Returns what a world has that devices do not do.
fn unsupported(world: &World, integration: DeviceIntegration) -> Option<&'static str> {
    if world.is_sliced() {
        return Some("the scene has slices");
    }
    if let DeviceIntegration::Occlusion { .. } = integration {
        return None;
    }
    if !world.lights.is_empty() {
        return Some("the scene has lights other than an even sky");
    }
    let others = MaterialKind::ALL.into_iter().filter(|&kind| kind != MaterialKind::Lambertian);
    others.clone().any(|kind| world.features.has(kind)).then_some("not all materials are diffuse")
}

/// Returns the sky, unless it is a picture.
fn sky(world: &World) -> Option<DeviceSky> {
    let environment = &world.environment;
    let (middle, gradient) = match &environment.radiance {
        Radiance::Constant(color) => (*color, None),
        Radiance::Gradient { middle, slope, up } => (*middle, Some((*slope, *up))),
        Radiance::Picture(_) => return None,
    };
    let (background, illuminates) = (environment.background, environment.illuminates);
    Some(DeviceSky { middle, gradient, background, illuminates })
}
