//! Ideally diffuse surfaces: the lambertian material, and what emitters reflect.

use super::{Bsdf, Material, Numbers, Scatter, is_black};
use crate::lanes::Lanes;
use crate::sampling::cosine_hemispheres;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::{Emitter, Lambertian};
use std::f32::consts::FRAC_1_PI;

/// A row of diffuse surfaces.
pub struct Diffuse<L> {
    albedo: Vec3<L>,
}

impl Material for Lambertian {
    const DIFFUSE: bool = true;
    const BASE: bool = true;
    const NUMBERS: usize = 3;
    type Bsdf<L: Lanes> = Diffuse<L>;

    fn tinted(self, color: Rgb) -> Self {
        Self { color: self.color * color }
    }

    #[inline(always)]
    fn number(&self, i: usize) -> f32 {
        self.color[i]
    }

    #[inline(always)]
    fn row<L: Lanes>(numbers: &impl Numbers<L>) -> Diffuse<L> {
        Diffuse { albedo: numbers.color(0) }
    }
}

impl<L: Lanes> Bsdf<L> for Diffuse<L> {
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

    /// Cosine-weighted, so the weight is the albedo exactly.
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
    /// What it does with the light that falls on it.
    pub fn surface(&self) -> Lambertian {
        Lambertian { color: self.albedo }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{
        albedo_by_quadrature, rows_are_what_their_lanes_are, samples_follow_density,
        samples_match_density,
    };
    use glam::Vec3;

    #[test]
    fn rows() {
        rows_are_what_their_lanes_are(&std::array::from_fn(|i| Lambertian {
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
