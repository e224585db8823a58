//! The environment: radiance of rays that hit nothing.

mod irradiance;
mod picture;
mod region;

pub use irradiance::Irradiance;
pub(super) use picture::luminance;
pub use picture::{PartBounds, Picture, SkyLight, SkySamples};

use crate::scene::{self, Background, EnvironmentMap, Look, Rgb};
use glam::Vec3;
use std::sync::Arc;

/// The environment: radiance by direction, and whether it lights the scene.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Radiance by direction.
    pub radiance: Radiance,
    /// True if it lights diffuse surfaces: otherwise it is a backdrop for the camera, mirrors and
    /// glass.
    pub illuminates: bool,
    /// Radiance that the camera sees instead of environment and suns, and behind glass instead of the
    /// environment.
    pub background: Option<Rgb>,
}

/// Radiance by direction.
#[derive(Clone, Debug)]
pub enum Radiance {
    /// The same everywhere.
    Constant(Rgb),
    /// Linear in the cosine of the angle to `up`.
    Gradient {
        /// Mean of bottom and top.
        middle: Rgb,
        /// Half of top minus bottom.
        slope: Rgb,
        /// Unit vector.
        up: Vec3,
    },
    /// A latitude-longitude picture.
    Picture(Arc<Picture>),
}

impl Environment {
    /// Returns the peak bytes of the environment while it is built, without the picture itself.
    pub(super) fn bytes(scene: &scene::Environment) -> u64 {
        match &scene.map {
            EnvironmentMap::Picture { image, .. } => Picture::bytes(image),
            EnvironmentMap::Constant(_) | EnvironmentMap::Gradient { .. } => 0,
        }
    }

    pub(super) fn build(scene: &scene::Environment, look: &Look) -> Self {
        let radiance = match &scene.map {
            EnvironmentMap::Constant(color) => Radiance::Constant(*color),
            EnvironmentMap::Gradient { bottom, top, up } => Radiance::Gradient {
                middle: (*bottom + *top) / 2.0,
                slope: (*top - *bottom) / 2.0,
                up: up.as_vec3(),
            },
            EnvironmentMap::Picture { image, up, rotation, scale } => Radiance::Picture(Arc::new(
                Picture::new(image.clone(), *up, rotation.to_radians(), *scale),
            )),
        };
        let mut environment = Self { radiance, illuminates: scene.illuminates, background: None };
        environment.set_background(look.background);
        environment
    }

    /// Sets what the camera sees directly.
    pub(super) fn set_background(&mut self, background: Background) {
        self.background = match background {
            Background::Color(color) => Some(color),
            Background::Sky | Background::Transparent => None,
        };
    }

    /// Returns the radiance from unit direction `toward`.
    #[inline]
    pub fn radiance(&self, toward: Vec3) -> Rgb {
        match &self.radiance {
            Radiance::Constant(color) => *color,
            // Not below 0 if rounding makes the cosine greater than 1.
            Radiance::Gradient { middle, slope, up } => {
                (*middle + *slope * up.dot(toward)).max(Rgb::ZERO)
            }
            Radiance::Picture(picture) => picture.radiance(toward),
        }
    }

    /// Returns the radiance of all directions, if it is the same.
    pub fn constant(&self) -> Option<Rgb> {
        match &self.radiance {
            Radiance::Constant(color) => Some(*color),
            _ => None,
        }
    }

    /// Returns whether all directions are black.
    pub fn is_black(&self) -> bool {
        match &self.radiance {
            Radiance::Constant(color) => *color == Rgb::ZERO,
            Radiance::Gradient { middle, slope, .. } => *middle == Rgb::ZERO && *slope == Rgb::ZERO,
            Radiance::Picture(picture) => picture.is_black(),
        }
    }

    /// Returns the picture, if it is worth sampling: for a constant or a gradient, BSDF sampling
    /// suffices, with half as many rays.
    pub fn picture(&self) -> Option<&Picture> {
        match &self.radiance {
            Radiance::Picture(picture) if !picture.is_black() => Some(picture),
            _ => None,
        }
    }
}
