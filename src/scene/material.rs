//! What surfaces are made of, and the ground, which is the one surface that is not a sphere.

use super::Rgb;
use glam::DVec3;

/// A material and the name by which a scene file speaks of it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Unique in its scene.
    pub name: String,
    /// What it does with light.
    pub material: Material,
}

/// What a surface does with light. A sphere's own color is a factor on `color` (`albedo` for an
/// emitter).
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Ideally diffuse.
    Lambertian {
        /// Albedo, 0..=1.
        color: Rgb,
    },
    /// Metal: a smooth mirror, or rough by GGX.
    Conductor {
        /// What it reflects, by the angle.
        fresnel: ConductorFresnel,
        /// GGX alpha, 0..=1; 0 is a smooth mirror.
        roughness: f64,
    },
    /// Smooth clear glass or liquid. Where several overlap, the smallest sphere wins.
    Dielectric {
        /// Index of refraction, more than 0; 1.5 is glass.
        ior: f64,
        /// Factor on what is transmitted and reflected, 0..=1; white for clear glass.
        color: Rgb,
    },
    /// Lambertian under a smooth dielectric coat, conserving energy.
    Plastic {
        /// Albedo of the base, 0..=1.
        color: Rgb,
        /// Index of refraction of the coat, more than 1.
        ior: f64,
    },
    /// The paper's: a diffuse share and a mirror share of one color. `diffuse + mirror <= 1`.
    Reflective {
        /// Factor on both shares, 0..=1.
        color: Rgb,
        /// Diffuse share, 0..=1.
        diffuse: f64,
        /// Mirror share, 0..=1.
        mirror: f64,
    },
    /// Emits light on both of its sides; what falls on it is reflected diffusely.
    Emitter {
        /// Emitted radiance, the same in all directions, 0 or more.
        radiance: Rgb,
        /// Albedo, 0..=1; black by default.
        albedo: Rgb,
    },
}

/// How much a metal reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorFresnel {
    /// Reflectance at normal incidence, 0..=1, and Schlick's curve up to 1 at grazing angles.
    Schlick(Rgb),
    /// The same reflectance, 0..=1, at every angle: the mirror of textbooks.
    Constant(Rgb),
    /// Complex index of refraction `eta + i k` per channel: the exact equations. Both are more than
    /// 0.
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
