//! Ideally diffuse surfaces: the lambertian material, and the reflection of emitters.

use super::{Bsdf, Material, Params, Scatter, is_black};
use crate::color::Rgb;
use crate::lanes::Lanes;
use crate::sampling::cosine_hemispheres;
use crate::vec3::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A row of the table of diffuse materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambertian {
    /// Albedo.
    pub color: Rgb,
}

/// A row of the table of emitters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Emitted radiance.
    pub radiance: Rgb,
    /// Albedo of its diffuse surface.
    pub albedo: Rgb,
}

/// A row of diffuse surfaces.
pub struct LambertianBsdf<L> {
    albedo: Vec3<L>,
}

impl Material for Lambertian {
    const DIFFUSE: bool = true;
    const HAS_DIFFUSE_BASE: bool = true;
    type Params = Rgb;
    type Bsdf<L: Lanes> = LambertianBsdf<L>;

    /// Returns the albedo.
    #[inline(always)]
    fn params(&self, color: Rgb) -> Rgb {
        self.color * color
    }

    #[inline(always)]
    fn row<L: Lanes>(params: &impl Params<L>) -> LambertianBsdf<L> {
        LambertianBsdf { albedo: params.color(0) }
    }
}

impl<L: Lanes> Bsdf<L> for LambertianBsdf<L> {
    #[inline(always)]
    fn is_delta(&self) -> L::Mask {
        is_black(self.albedo)
    }

    #[inline(always)]
    fn eval(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> Vec3<L> {
        self.albedo * self.pdf(outgoing, incoming)
    }

    #[inline(always)]
    fn pdf(&self, _outgoing: Vec3<L>, incoming: Vec3<L>) -> L {
        L::splat(FRAC_1_PI) * incoming.z.max(L::splat(0.0))
    }

    /// Samples the cosine-weighted hemisphere: the weight is exactly the albedo.
    #[inline(always)]
    fn sample(&self, _outgoing: Vec3<L>, direction: [L; 2], _choice: L) -> Scatter<L> {
        let incoming = cosine_hemispheres(direction);
        Scatter { incoming, weight: self.albedo, pdf: L::splat(FRAC_1_PI) * incoming.z }
    }

    #[inline(always)]
    fn mirrored(&self, _outgoing: Vec3<L>) -> Vec3<L> {
        Vec3::splat(0.0, 0.0, 0.0)
    }
}

impl Emitter {
    /// Returns the material of the emitter's surface.
    pub fn surface(&self) -> Lambertian {
        Lambertian { color: self.albedo }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{
        albedo_by_quadrature, rows_equal_their_lanes, samples_follow_density, samples_match_density,
    };
    use glam::Vec3;

    #[test]
    fn rows() {
        rows_equal_their_lanes(&std::array::from_fn(|i| Lambertian {
            color: Rgb::new(0.05 * i as f32, 0.3, 0.9),
        }));
    }

    #[test]
    fn scatters_its_albedo() {
        let bsdf = Lambertian { color: Rgb::splat(0.8) };
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        samples_match_density(&bsdf, outgoing);
        samples_follow_density(&bsdf, outgoing, Grid::hemisphere(Vec3::Z), Some(0.0));
        let (albedo, error) = albedo_by_quadrature(&bsdf, outgoing);
        assert!((albedo - 0.8).abs() < 4.0 * error, "{albedo} {error}");
    }
}
