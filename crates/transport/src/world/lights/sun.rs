//! Suns: discs at infinity.

use super::{LightLanes, LightSample};
use crate::lanes::F32x16;
use crate::ray::MISS;
use crate::sampling::{Basis, Cone};
use crate::scene::{BRIGHTEST, Rgb};
use crate::vec3::Vec3 as Row3;
use crate::world::DeviceSun;
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Angular radius in degrees, up to which a sun has no extent: its radiance would overflow, and single
/// precision does not distinguish such directions.
const NO_DISC: f64 = 1e-6;

/// A disc at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    pub(super) basis: Basis,
    pub(crate) direction: Vec3,
    pub(super) irradiance: Rgb,
    /// The disc; `None` if it has no extent.
    pub(crate) disc: Option<Cone>,
    /// Radiance of the disc.
    pub(crate) radiance: Rgb,
    /// Weight of a sample: radiance over density, or the irradiance if there is no extent.
    pub(super) weight: Rgb,
}

impl Sun {
    /// Creates a sun; `direction` is a unit vector toward it, `angular_radius` is in degrees, 0 or
    /// more.
    pub(super) fn new(direction: DVec3, irradiance: Rgb, angular_radius: f64) -> Self {
        let disc =
            (angular_radius > NO_DISC).then(|| Cone::from_half_angle(angular_radius.to_radians()));
        // Irradiance on a facing plane is radiance times pi sin^2; sin^2 = h (2 - h) with h = 1 -
        // cos.
        let radiance = disc.map_or(Rgb::ZERO, |cone| {
            let radiance = irradiance / (PI * cone.height() * (2.0 - cone.height()));
            radiance.min(Rgb::splat(BRIGHTEST))
        });
        Self {
            basis: Basis::new(direction.as_vec3()),
            direction: direction.as_vec3(),
            irradiance,
            disc,
            radiance,
            weight: disc.map_or(irradiance, |cone| radiance / cone.pdf()),
        }
    }

    /// Returns its numbers for devices.
    pub(crate) fn terms(&self) -> DeviceSun {
        let disc = self.disc.map(|cone| [cone.height(), cone.pdf()]);
        DeviceSun { basis: self.basis, disc, radiance: self.radiance, weight: self.weight }
    }

    /// Returns whether the disc is visible in unit direction `toward`.
    #[inline]
    pub(crate) fn is_toward(&self, toward: Vec3) -> bool {
        // 1 - cos by the chord, without cancellation.
        let height = (toward - self.direction).length_squared() / 2.0;
        self.disc.is_some_and(|disc| height <= disc.height())
    }

    /// Samples a direction toward the disc.
    #[inline(always)]
    pub(super) fn sample(&self, u: [f32; 2]) -> LightSample {
        LightSample {
            direction: match &self.disc {
                None => self.direction,
                Some(cone) => self.basis.to_world(cone.sample(u)),
            },
            t: f64::INFINITY,
            target: MISS,
            weight: self.weight,
            pdf: self.disc.map(|cone| cone.pdf()),
            close: false,
        }
    }

    /// Does what [`Sun::sample`] does for `lanes` of a row of random numbers.
    #[inline(always)]
    pub(super) fn sample_row(&self, u: [F32x16; 2], lanes: u32) -> LightLanes {
        let (direction, pdf) = match &self.disc {
            None => (Row3::from(self.direction).map(F32x16::splat), 0.0),
            Some(cone) => (self.basis.row_to_world(cone.sample_row(u)), cone.pdf()),
        };
        LightLanes { pdf: F32x16::splat(pdf), ..LightLanes::distant(direction, self.weight, lanes) }
    }
}
