//! Materials, and the ground, which is the one surface that is not a sphere.

use super::Rgb;
use glam::DVec3;

/// A material and its name in scene files.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Name, unique in its scene.
    pub name: String,
    /// The material.
    pub material: Material,
}

/// A material of surfaces. A sphere's own color is a factor on `color` (`albedo` for an emitter).
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Ideally diffuse.
    Lambertian {
        /// Albedo, 0..=1.
        color: Rgb,
    },
    /// Metal: a smooth mirror, or rough by GGX.
    Conductor {
        /// Reflectance by angle.
        fresnel: ConductorFresnel,
        /// GGX alpha, 0..=1; 0 is a smooth mirror.
        roughness: f64,
    },
    /// Smooth clear glass or liquid. Where several overlap, the smallest sphere wins.
    Dielectric {
        /// Index of refraction, more than 0; 1.5 is glass.
        ior: f64,
        /// Factor on transmitted and reflected light, 0..=1; white for clear glass.
        color: Rgb,
    },
    /// Lambertian under a smooth dielectric coat, conserving energy.
    Plastic {
        /// Albedo of the base, 0..=1.
        color: Rgb,
        /// Index of refraction of the coat, more than 1.
        ior: f64,
    },
    /// The paper's: a diffuse and a mirror fraction of one color. `diffuse + mirror <= 1`.
    Reflective {
        /// Factor on both fractions, 0..=1.
        color: Rgb,
        /// Diffuse fraction, 0..=1.
        diffuse: f64,
        /// Mirror fraction, 0..=1.
        mirror: f64,
    },
    /// Emits light on both sides, and reflects light diffusely.
    Emitter {
        /// Emitted radiance, the same in all directions, 0 or more.
        radiance: Rgb,
        /// Albedo, 0..=1; black by default.
        albedo: Rgb,
    },
    /// A part of another material, so that what is behind is seen too, without refraction. A body is seen where a ray enters
    /// it, and lets light pass there; rays leave it freely.
    Translucent {
        /// Part of what is behind that is hidden, 0..=1.
        opacity: f64,
        /// The material of the surface, neither glass nor an emitter, and not translucent itself.
        surface: Box<Self>,
    },
}

impl Material {
    /// The material of the surface: the material itself if it is not translucent.
    pub fn surface(&self) -> &Self {
        match self {
            Self::Translucent { surface, .. } => surface,
            _ => self,
        }
    }

    /// The part of what is behind that a body hides, 1 of all materials but translucent ones; glass refracts, and has its own
    /// ways.
    pub fn opacity(&self) -> f64 {
        match self {
            Self::Translucent { opacity, .. } => *opacity,
            _ => 1.0,
        }
    }

    /// Returns whether any body can have the material; glass and emitters are for spheres alone.
    pub fn is_solid(&self) -> bool {
        !matches!(self, Self::Dielectric { .. } | Self::Emitter { .. })
    }

    /// The same material with another opacity, 0..=1; glass and emitters stay as they are.
    #[must_use]
    pub fn with_opacity(&self, opacity: f64) -> Self {
        match self.surface() {
            Self::Dielectric { .. } | Self::Emitter { .. } => self.clone(),
            surface if opacity >= 1.0 => surface.clone(),
            surface => Self::Translucent { opacity, surface: Box::new(surface.clone()) },
        }
    }
}

/// Reflectance of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorFresnel {
    /// Reflectance at normal incidence, 0..=1, and Schlick's curve up to 1 at grazing angles.
    Schlick(Rgb),
    /// The same reflectance, 0..=1, at every angle: the usual mirror of textbooks.
    Constant(Rgb),
    /// Complex index of refraction `eta + i k` per channel, for the exact Fresnel equations. Both are
    /// more than 0.
    Exact {
        /// Real part.
        eta: Rgb,
        /// Imaginary part.
        k: Rgb,
    },
}

/// An infinite plane: the points `p` with `normal . p = height`. Both of its sides are visible.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Unit normal.
    pub normal: DVec3,
    /// Signed distance of the plane from the origin along `normal`.
    pub height: f64,
    /// A row of [`Scene::materials`](super::Scene::materials); neither dielectric nor emitter.
    pub material: u32,
}
