//! Devices that follow whole paths, in place of the processor.
//!
//! A device gets a job as numbers, and returns the radiance of each sample with the bits of the processor's, or says
//! that it does not know it: then the processor follows that path.

use super::{
    CameraTerms, DeviceCaustics, DeviceIntegration, DeviceLights, DevicePicture, DeviceSky, World,
};
use crate::scene::Rgb;
use bytemuck::{Pod, Zeroable};
use std::fmt::Debug;
use std::ops::Range;

/// A device that follows the paths of a world whose spheres it has.
pub trait DeviceIntegrator: Debug + Send + Sync {
    /// Prepares for a job; `None` if the device fails.
    fn begin(&self, job: &DeviceJob) -> Option<Box<dyn DevicePaths>>;
}

/// A device that is prepared for a job.
pub trait DevicePaths: Send + Sync {
    /// Follows the paths of these samples of pixels, given by column and row, and replaces what was found before. False if
    /// the device fails; then nothing is found.
    fn follow(&self, pixels: &[(u32, u32)], samples: Range<u32>, found: &mut DevicePixels) -> bool;
}

/// What a device has found of samples of pixels.
#[derive(Clone, Debug, Default)]
pub struct DevicePixels {
    /// The pixels.
    pub pixels: Vec<DevicePixel>,
    /// The samples of the pixels that are not summed, by their places.
    pub samples: Vec<DevicePath>,
}

/// The exact sums of a pixel's samples, unless the device does not know one of them, or the sums might be rounded.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DevicePixel {
    total: [f64; 3],
    /// The sum of squares is that of both levels.
    squares: [[f64; 3]; 2],
    place: u32,
    bounce_rays: u32,
    shadow_rays: u32,
    unused: u32,
}

impl DevicePixel {
    /// Returns the place of the samples among those of pixels that are not summed, if this one is not.
    pub fn place(&self) -> Option<usize> {
        (self.place != u32::MAX).then_some(self.place as usize)
    }

    /// Returns the sum of the samples, and the sum of their squares in two levels.
    pub fn sums(&self) -> ([f64; 3], [[f64; 3]; 2]) {
        (self.total, self.squares)
    }

    /// Returns the number of rays of bounces, those of unknown paths included.
    pub fn bounce_rays(&self) -> u64 {
        self.bounce_rays.into()
    }

    /// Returns the number of shadow rays, those of unknown paths included.
    pub fn shadow_rays(&self) -> u64 {
        self.shadow_rays.into()
    }
}

/// A path that a device has followed.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DevicePath {
    radiance: [f32; 3],
    /// Bit 0 is set if the radiance is not known; up to bit 15, the others count rays of bounces, and then shadow rays.
    state: u32,
}

impl DevicePath {
    /// A path that the device has not followed.
    pub const UNKNOWN: Self = Self { radiance: [0.0; 3], state: 1 };

    /// Returns the radiance, if it is known.
    pub fn radiance(&self) -> Option<Rgb> {
        (self.state & 1 == 0).then_some(self.radiance.into())
    }

    /// Returns the number of rays of bounces.
    pub fn bounce_rays(&self) -> u64 {
        u64::from(self.state as u16 >> 1)
    }

    /// Returns the number of shadow rays.
    pub fn shadow_rays(&self) -> u64 {
        u64::from(self.state >> 16)
    }
}

/// The numbers of a job.
#[derive(Clone, Debug)]
pub struct DeviceJob<'a> {
    /// The world.
    pub world: &'a World,
    /// The integrator.
    pub integration: DeviceIntegration,
    /// The lights; none for ambient occlusion.
    pub lights: DeviceLights,
    /// The specular spheres and emitters of caustics; none without.
    pub caustics: DeviceCaustics,
    /// The camera.
    pub camera: CameraTerms,
    /// The sky.
    pub sky: DeviceSky,
    /// Its picture, in place of the radiance, if it has one.
    pub picture: Option<DevicePicture>,
    /// Hash of the seed of samples.
    pub seed: u64,
    /// Sobol's direction vectors: [`Sampler::table`](crate::sampling::Sampler::table).
    pub sobol: Vec<[u32; 4]>,
    /// Offsets of the pixel filter, if it is tabulated.
    pub offsets: Option<&'a [f32]>,
}
