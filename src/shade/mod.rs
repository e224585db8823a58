//! What surfaces do with light: one file for each kind of material.
//!
//! A row of a material's table, tinted by the sphere's color, is a [`Bsdf`]. Directions are local:
//! unit vectors that point away from the surface, with z along the normal on the side that is
//! looked at. Glass is not a `Bsdf`: what it does depends on what surrounds it ([`dielectric`]).

pub mod conductor;
pub mod dielectric;
pub mod fresnel;
pub mod ggx;
pub mod lambertian;
pub mod plastic;
pub mod reflective;

use crate::scene::Rgb;
use glam::Vec3;

/// How a surface that lets nothing through scatters light.
pub trait Bsdf: Copy {
    /// Whether it is so even that light is best looked for at the lights alone.
    const DIFFUSE: bool;

    /// The albedo of a surface that is [`Bsdf::DIFFUSE`], all that there is to know of it; black for
    /// others.
    fn albedo(&self) -> Rgb {
        Rgb::ZERO
    }

    /// The same, with the sphere's color as a factor.
    #[must_use]
    fn tinted(self, color: Rgb) -> Self;

    /// Whether it only mirrors, so that no light sample can contribute.
    fn is_delta(&self) -> bool;

    /// Scattered radiance per irradiance, times the cosine of `incoming`; without any mirrored
    /// part.
    fn eval(&self, outgoing: Vec3, incoming: Vec3) -> Rgb;

    /// Density by solid angle with which [`Bsdf::sample`] finds `incoming`; without any mirrored
    /// part.
    fn pdf(&self, outgoing: Vec3, incoming: Vec3) -> f32;

    /// A direction that light may come from, from two numbers in [0, 1) for the direction and one
    /// for the choice between parts; `None` if the light is lost.
    fn sample(&self, outgoing: Vec3, direction: [f32; 2], choice: f32) -> Option<Scatter>;

    /// Share of the light that is mirrored, where the light samples of [`Bsdf::eval`] take care of
    /// all the rest; `None` if the surface has no diffuse part and must be sampled.
    fn mirrored(&self, outgoing: Vec3) -> Option<Rgb>;
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Toward where the light comes from.
    pub incoming: Vec3,
    /// Response times cosine over density.
    pub weight: Rgb,
    /// Density by solid angle; `None` for a mirrored direction.
    pub pdf: Option<f32>,
}

/// The direction mirrored at the normal, z.
#[inline]
pub fn mirror(outgoing: Vec3) -> Vec3 {
    Vec3::new(-outgoing.x, -outgoing.y, outgoing.z)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::sampling::{stream, uniform_sphere, unit};
    use std::f32::consts::PI;

    /// Uniform random numbers for tests.
    pub(crate) fn numbers(seed: u64, count: usize) -> impl Iterator<Item = [f32; 3]> {
        (0..count as u64).map(move |i| {
            let draw = |k| unit(stream(seed, 3 * i + k) as u32);
            [draw(0), draw(1), draw(2)]
        })
    }

    /// A direction at an angle to the normal.
    pub(crate) fn at(cosine: f32) -> Vec3 {
        Vec3::new(0.6, 0.8, 0.0) * (1.0 - cosine * cosine).sqrt() + Vec3::Z * cosine
    }

    /// Sampled directions follow the density, and what is mirrored comes as often as it should: none if
    /// that is not known. Around the mirrored direction where the lobe is narrow.
    pub(crate) fn samples_follow_density<B: Bsdf>(
        bsdf: &B,
        outgoing: Vec3,
        grid: Grid,
        none: Option<f64>,
    ) {
        let samples = numbers(9, 500_000).map(|u| {
            let scatter = bsdf.sample(outgoing, [u[0], u[1]], u[2])?;
            scatter.pdf.map(|_| scatter.incoming)
        });
        grid.check(samples, |incoming| bsdf.pdf(outgoing, incoming), none);
    }

    /// The share of light that is scattered: by the surface's own sampling, and with a standard
    /// error.
    pub(crate) fn albedo_by_sampling<B: Bsdf>(bsdf: &B, outgoing: Vec3) -> (f64, f64) {
        let n = 200_000;
        let (mut sum, mut sum2) = (0.0, 0.0);
        for u in numbers(1, n) {
            let weight = bsdf.sample(outgoing, [u[0], u[1]], u[2]).map_or(0.0, |s| s.weight.x);
            sum += f64::from(weight);
            sum2 += f64::from(weight).powi(2);
        }
        let mean = sum / n as f64;
        (mean, ((sum2 / n as f64 - mean * mean).max(0.0) / n as f64).sqrt())
    }

    /// What is left after the mirrored part: by uniform directions on the hemisphere, and with a
    /// standard error.
    pub(crate) fn albedo_by_quadrature<B: Bsdf>(bsdf: &B, outgoing: Vec3) -> (f64, f64) {
        let n = 400_000;
        let (mut sum, mut sum2) = (0.0, 0.0);
        for u in numbers(2, n) {
            let mut incoming = uniform_sphere([u[0], u[1]]);
            incoming.z = incoming.z.abs();
            let value = f64::from(bsdf.eval(outgoing, incoming).x * 2.0 * PI);
            sum += value;
            sum2 += value * value;
        }
        let mean = sum / n as f64;
        (mean, ((sum2 / n as f64 - mean * mean) / n as f64).sqrt())
    }

    /// Sampled weights are response over density, and densities of what is not mirrored add up to
    /// at most 1.
    pub(crate) fn samples_match_density<B: Bsdf>(bsdf: &B, outgoing: Vec3) {
        for u in numbers(3, 20_000) {
            let Some(scatter) = bsdf.sample(outgoing, [u[0], u[1]], u[2]) else { continue };
            let Some(pdf) = scatter.pdf else { continue };
            assert!(pdf > 0.0 && pdf.is_finite(), "{pdf} {scatter:?}");
            assert!(scatter.incoming.is_normalized() && scatter.incoming.z >= 0.0);
            let (expected, density) =
                (bsdf.eval(outgoing, scatter.incoming), bsdf.pdf(outgoing, scatter.incoming));
            assert!((pdf - density).abs() <= 2e-3 * density, "{pdf} {density}");
            let got = scatter.weight * pdf;
            assert!(
                (got - expected).abs().max_element() <= 2e-3 * expected.max_element().max(1e-6)
            );
        }
    }
}
