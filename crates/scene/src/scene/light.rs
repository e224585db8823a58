//! Lights that are not spheres, and the environment.

use super::Rgb;
use glam::DVec3;
use std::sync::Arc;

/// The greatest radiance and irradiance in each channel, so that sums over bounces stay in the range of
/// single precision.
pub const BRIGHTEST: f32 = 1e30;

/// Returns whether a value of a picture, finite and 0 or more, is a valid radiance after scaling.
pub fn is_radiance(value: f32, scale: f32) -> bool {
    value >= 0.0 && value * scale <= BRIGHTEST
}

/// A light that is not a sphere of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A disc at infinity.
    Sun {
        /// Unit vector from the scene to the middle of the sun.
        direction: DVec3,
        /// Irradiance on a plane that faces the sun, at most [`BRIGHTEST`].
        irradiance: Rgb,
        /// Degrees, 0..90; 0 gives sharp shadows (and cannot be seen in a mirror).
        angular_radius: f64,
    },
    /// A point.
    Point {
        /// Position.
        position: DVec3,
        /// Radiant intensity, per steradian; without fall-off, the irradiance at any distance. No point
        /// receives more than [`BRIGHTEST`].
        intensity: Rgb,
        /// True: light falls off by the square of the distance, as in nature. False: it does not, as in
        /// Haines' NFF files.
        falloff: bool,
    },
}

/// The environment: radiance of rays that leave the scene.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Radiance by direction, at most [`BRIGHTEST`].
    pub map: EnvironmentMap,
    /// True if it lights the scene; otherwise it is only a backdrop for the camera, mirrors and glass.
    pub illuminates: bool,
}

/// Radiance of the environment by direction.
#[derive(Clone, Debug)]
pub enum EnvironmentMap {
    /// The same everywhere; black for none.
    Constant(Rgb),
    /// `bottom` to `top`, linear in the cosine of the angle to `up`.
    Gradient {
        /// Radiance seen along `-up`.
        bottom: Rgb,
        /// Radiance seen along `up`.
        top: Rgb,
        /// Unit vector.
        up: DVec3,
    },
    /// A latitude-longitude picture, row 0 at `up`.
    Picture {
        /// Linear radiance; every value times `scale` is 0 to [`BRIGHTEST`].
        image: Arc<crate::image::Image>,
        /// Unit vector toward the picture's top row.
        up: DVec3,
        /// Degrees, turns the picture about `up`.
        rotation: f64,
        /// Factor on the picture's values.
        scale: f32,
    },
}

impl EnvironmentMap {
    /// Returns the name of the kind in scene files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Constant(_) => "constant",
            Self::Gradient { .. } => "gradient",
            Self::Picture { .. } => "picture",
        }
    }
}

impl Default for Environment {
    fn default() -> Self {
        Self { map: EnvironmentMap::Constant(Rgb::ONE), illuminates: true }
    }
}
