//! A diffuse base under a smooth dielectric coat, conserving energy.
//!
//! Light is mirrored by the coat or enters it, is scattered by the base, is partly thrown back by
//! the coat from inside any number of times, and leaves: the geometric series over the internal
//! reflections (Weidlich and Wilkie, "Arbitrarily Layered Micro-Facet Surfaces", GRAPHITE 2007,
//! with the series summed). A white base gives back exactly what it gets.

use super::{Bsdf, Scatter, fresnel, mirror};
use crate::sampling::cosine_hemisphere;
use crate::scene::Rgb;
use crate::world::Plastic;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

impl Plastic {
    /// Share that the coat mirrors at this cosine.
    #[inline(always)]
    fn coat(&self, cosine: f32) -> f32 {
        fresnel::dielectric(f64::from(cosine), f64::from(self.ior).recip()).0 as f32
    }

    /// Response of the base, times pi, without the coat's share for either direction.
    fn base(&self) -> Rgb {
        self.color / ((Rgb::ONE - self.color * self.internal_reflectance) * (self.ior * self.ior))
    }
}

impl Bsdf for Plastic {
    const DIFFUSE: bool = false;

    fn tinted(self, color: Rgb) -> Self {
        Self { color: self.color * color, ..self }
    }

    fn is_delta(&self) -> bool {
        self.color == Rgb::ZERO
    }

    #[inline(always)]
    fn eval(&self, outgoing: Vec3, incoming: Vec3) -> Rgb {
        if incoming.z <= 0.0 {
            return Rgb::ZERO;
        }
        let passes = (1.0 - self.coat(outgoing.z)) * (1.0 - self.coat(incoming.z));
        self.base() * (passes * FRAC_1_PI * incoming.z)
    }

    #[inline(always)]
    fn pdf(&self, outgoing: Vec3, incoming: Vec3) -> f32 {
        (1.0 - self.coat(outgoing.z)) * FRAC_1_PI * incoming.z.max(0.0)
    }

    #[inline(always)]
    fn sample(&self, outgoing: Vec3, direction: [f32; 2], choice: f32) -> Option<Scatter> {
        let mirrored = self.coat(outgoing.z);
        if choice < mirrored {
            // Chosen as often as light is mirrored: the weight is 1.
            return Some(Scatter { incoming: mirror(outgoing), weight: Rgb::ONE, pdf: None });
        }
        let incoming = cosine_hemisphere(direction);
        let weight = self.base() * (1.0 - self.coat(incoming.z));
        (weight != Rgb::ZERO).then_some(Scatter {
            incoming,
            weight,
            pdf: Some((1.0 - mirrored) * FRAC_1_PI * incoming.z),
        })
    }

    fn mirrored(&self, outgoing: Vec3) -> Option<Rgb> {
        Some(Rgb::splat(self.coat(outgoing.z)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{albedo_by_quadrature, albedo_by_sampling, at};
    use crate::shade::tests::{samples_follow_density, samples_match_density};

    fn plastic(color: f32) -> Plastic {
        let internal_reflectance = fresnel::internal_diffuse_reflectance(1.5) as f32;
        Plastic { color: Rgb::splat(color), ior: 1.5, internal_reflectance }
    }

    #[test]
    fn a_white_base_loses_nothing() {
        for outgoing in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.995, 0.0, 0.1).normalize()]
        {
            let (albedo, error) = albedo_by_sampling(&plastic(1.0), outgoing);
            assert!((albedo - 1.0).abs() < 4.0 * error + 1e-5, "{albedo} {error}");
        }
    }

    #[test]
    fn directions_follow_the_density() {
        for cosine in [1.0, 0.5, 0.1, 0.01] {
            let (bsdf, outgoing) = (plastic(0.5), at(cosine));
            let coat = f64::from(bsdf.coat(outgoing.z));
            samples_follow_density(&bsdf, outgoing, Grid::hemisphere(Vec3::Z), Some(coat));
            samples_match_density(&bsdf, outgoing);
        }
    }

    #[test]
    fn samples_match_the_response() {
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        samples_match_density(&plastic(0.5), outgoing);
        let (all, e1) = albedo_by_sampling(&plastic(0.5), outgoing);
        let (base, e2) = albedo_by_quadrature(&plastic(0.5), outgoing);
        let coat = f64::from(plastic(0.5).coat(outgoing.z));
        assert!((all - base - coat).abs() < 4.0 * e1.hypot(e2), "{all} {base} {coat}");
    }
}
