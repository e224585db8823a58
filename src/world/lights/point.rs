//! Point lights.

use super::LightSample;
use crate::ray::MISS;
use crate::scene::{BRIGHTEST, Rgb};
use glam::{DVec3, Vec3};

/// A point light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub(super) position: DVec3,
    /// Radiant intensity; irradiance if there is no fall-off.
    pub(super) intensity: Rgb,
    /// World units per unit of the user, by whose distance light falls off; `None` if it does not.
    pub(super) falloff: Option<f64>,
}

impl Point {
    /// Light at a point; `None` at the light itself.
    pub(super) fn sample(&self, origin: Vec3) -> Option<LightSample> {
        let toward = self.position - origin.as_dvec3();
        let distance = toward.length();
        if distance == 0.0 {
            return None;
        }
        // In double precision: in units far from 1, intensity and fall-off may each leave single
        // precision. Next to a surface, light has no bound but this.
        let falloff = self.falloff.map_or(1.0, |scale| (scale / distance).powi(2));
        let most = DVec3::splat(f64::from(BRIGHTEST));
        Some(LightSample {
            direction: (toward / distance).as_vec3(),
            t: distance,
            target: MISS,
            weight: (self.intensity.as_dvec3() * falloff).min(most).as_vec3(),
            pdf: None,
            close: false,
        })
    }
}
