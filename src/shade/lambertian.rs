//! Ideally diffuse surfaces: the lambertian material, and what emitters reflect.

use super::{Bsdf, Scatter};
use crate::sampling::cosine_hemisphere;
use crate::scene::Rgb;
use crate::world::{Emitter, Lambertian};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

impl Bsdf for Lambertian {
    const DIFFUSE: bool = true;

    fn tinted(self, color: Rgb) -> Self {
        Self { color: self.color * color }
    }

    fn albedo(&self) -> Rgb {
        self.color
    }

    fn is_delta(&self) -> bool {
        self.color == Rgb::ZERO
    }

    #[inline]
    fn eval(&self, _outgoing: Vec3, incoming: Vec3) -> Rgb {
        self.color * (FRAC_1_PI * incoming.z.max(0.0))
    }

    #[inline]
    fn pdf(&self, _outgoing: Vec3, incoming: Vec3) -> f32 {
        FRAC_1_PI * incoming.z.max(0.0)
    }

    /// Cosine-weighted, so the weight is the albedo exactly.
    #[inline]
    fn sample(&self, _outgoing: Vec3, direction: [f32; 2], _choice: f32) -> Option<Scatter> {
        let incoming = cosine_hemisphere(direction);
        (self.color != Rgb::ZERO).then_some(Scatter {
            incoming,
            weight: self.color,
            pdf: Some(FRAC_1_PI * incoming.z),
        })
    }

    fn mirrored(&self, _outgoing: Vec3) -> Option<Rgb> {
        Some(Rgb::ZERO)
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
        albedo_by_quadrature, samples_follow_density, samples_match_density,
    };

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
