//! Suns: discs at infinity.

use super::LightSample;
use crate::ray::MISS;
use crate::sampling::{Cone, Frame};
use crate::scene::{BRIGHTEST, Rgb};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Degrees: a sun that is smaller has no extent, lest its radiance overflow. Single precision does
/// not tell directions as close as that.
const NO_DISC: f64 = 1e-6;

/// A disc at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    pub(super) frame: Frame,
    pub(super) direction: Vec3,
    pub(super) irradiance: Rgb,
    /// `None`: of no extent.
    pub(super) disc: Option<Cone>,
}

impl Sun {
    /// `direction` is a unit vector toward it; `angular_radius` is in degrees, 0 or more.
    pub(super) fn new(direction: DVec3, irradiance: Rgb, angular_radius: f64) -> Self {
        Self {
            frame: Frame::new(direction.as_vec3()),
            direction: direction.as_vec3(),
            irradiance,
            disc: (angular_radius > NO_DISC)
                .then(|| Cone::from_half_angle(angular_radius.to_radians())),
        }
    }

    /// Radiance of its disc, `cone`.
    pub(super) fn radiance(&self, cone: Cone) -> Rgb {
        // Irradiance on a facing plane is radiance times pi sin^2; sin^2 = h (2 - h) with h = 1 -
        // cos.
        let radiance = self.irradiance / (PI * cone.height() * (2.0 - cone.height()));
        radiance.min(Rgb::splat(BRIGHTEST))
    }

    /// Light from a point of it.
    pub(super) fn sample(&self, u: [f32; 2]) -> LightSample {
        let sample = |direction, weight, pdf| LightSample {
            direction,
            t: f64::INFINITY,
            target: MISS,
            weight,
            pdf,
            close: false,
        };
        match &self.disc {
            None => sample(self.direction, self.irradiance, None),
            Some(cone) => sample(
                self.frame.to_world(cone.sample(u)),
                self.radiance(*cone) / cone.pdf(),
                Some(cone.pdf()),
            ),
        }
    }
}
