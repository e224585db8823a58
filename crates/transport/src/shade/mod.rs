//! BSDFs: scattering of light at surfaces, one file per kind of material.
//!
//! A row of a material's table is a [`Material`]; with the sphere's color it gives the parameters of a
//! BSDF, and those of sixteen surfaces, or one, make a [`Bsdf`]. Directions are local: unit vectors that point away from the surface, with z
//! along the normal on the side that the ray comes from. Glass is not a `Bsdf`: its scattering depends
//! on the medium around it ([`dielectric`]).

pub mod conductor;
pub mod dielectric;
pub mod fresnel;
pub mod ggx;
pub mod lambertian;
pub mod materials;
mod params;
pub mod plastic;
pub mod reflective;

pub use materials::{KindVisitor, MaterialId, MaterialKind, Materials};
pub use params::{BroadcastParams, GatheredParams, Params, floats};

use crate::color::Rgb;
use crate::lanes::{F64x8, Lanes, MAX_LANES, store_rounded};
use crate::vec3::Vec3;
use bytemuck::Pod;

/// An opaque material.
pub trait Material: Copy {
    /// True if the material is so diffuse that light samples alone are best for lights that are not
    /// close.
    const DIFFUSE: bool;

    /// True if the material is a diffuse base with a mirror component, so that light samples find
    /// all but mirrored light; otherwise the BSDF must be sampled.
    const HAS_DIFFUSE_BASE: bool;

    /// The parameters of the BSDF, a `#[repr(C)]` struct of `f32` and [`Rgb`].
    type Params: Pod;

    /// The BSDFs of a row of materials.
    type Bsdf<L: Lanes>: Bsdf<L>;

    /// Returns the parameters of the BSDF, with the sphere's color as a factor.
    fn params(&self, color: Rgb) -> Self::Params;

    /// Creates BSDFs from a row of parameters.
    fn row<L: Lanes>(params: &impl Params<L>) -> Self::Bsdf<L>;
}

/// The BSDFs of a row of surfaces.
pub trait Bsdf<L: Lanes> {
    /// Returns the lanes that are purely specular, so that no light sample can contribute.
    fn is_delta(&self) -> L::Mask;

    /// Evaluates the BSDF times the cosine of `incoming`, by channel; without mirrored light, and 0
    /// from below.
    fn eval(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> Vec3<L>;

    /// Returns the density by solid angle with which [`Bsdf::sample`] finds `incoming`; without
    /// mirrored directions.
    fn pdf(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> L;

    /// Samples incoming directions, from two random numbers in [0, 1) for the direction and one for the
    /// choice of a lobe.
    fn sample(&self, outgoing: Vec3<L>, direction: [L; 2], choice: L) -> Scatter<L>;

    /// Returns the fraction of light that is mirrored, by channel, of a material with a [diffuse
    /// base](Material::HAS_DIFFUSE_BASE).
    fn mirrored(&self, outgoing: Vec3<L>) -> Vec3<L>;
}

/// Sampled directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter<L> {
    /// Directions toward the incoming light.
    pub incoming: Vec3<L>,
    /// BSDF times cosine over density, by channel; black where the light is absorbed.
    pub weight: Vec3<L>,
    /// Density by solid angle; 0 for a mirrored direction.
    pub pdf: L,
}

impl<L: Lanes> Scatter<L> {
    /// Selects one of two samples, lane by lane.
    #[inline(always)]
    fn select(mask: L::Mask, yes: &Self, no: &Self) -> Self {
        Self {
            incoming: Vec3::select_lanes(mask, yes.incoming, no.incoming),
            weight: Vec3::select_lanes(mask, yes.weight, no.weight),
            pdf: L::select(mask, yes.pdf, no.pdf),
        }
    }

    /// Returns the mirrored direction with this weight.
    #[inline(always)]
    fn mirrored(outgoing: Vec3<L>, weight: Vec3<L>) -> Self {
        Self { incoming: mirror(outgoing), weight, pdf: L::splat(0.0) }
    }
}

/// Returns directions mirrored at the normal, z.
#[inline(always)]
pub fn mirror<L: Lanes>(outgoing: Vec3<L>) -> Vec3<L> {
    Vec3::new(-outgoing.x, -outgoing.y, outgoing.z)
}

/// Returns the lanes in which all channels are 0.
#[inline(always)]
fn is_black<L: Lanes>(color: Vec3<L>) -> L::Mask {
    color.max_element().le(L::splat(0.0))
}

/// Evaluates a formula in double precision, and rounds the result.
#[inline(always)]
fn in_doubles<L: Lanes, const N: usize>(row: [L; N], of: impl Fn([F64x8; N]) -> F64x8) -> L {
    let mut rounded = [0.0; MAX_LANES];
    for first in (0..L::WIDTH).step_by(8) {
        store_rounded(of(row.map(|column| column.doubles(first))), &mut rounded[first..]);
    }
    L::load(&rounded)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::lanes::{F32x16, Mask};
    use crate::sampling::statistics::Grid;
    use crate::sampling::{stream, uniform_sphere, unit};
    use std::f32::consts::PI;

    /// Returns uniform random numbers for tests.
    pub(crate) fn numbers(seed: u64, count: usize) -> impl Iterator<Item = [f32; 3]> {
        (0..count as u64).map(move |i| {
            let draw = |k| unit(stream(seed, 3 * i + k) as u32);
            [draw(0), draw(1), draw(2)]
        })
    }

    /// Returns a direction at an angle to the normal.
    pub(crate) fn at(cosine: f32) -> glam::Vec3 {
        glam::Vec3::new(0.6, 0.8, 0.0) * (1.0 - cosine * cosine).sqrt() + glam::Vec3::Z * cosine
    }

    /// A sampled direction of one surface.
    pub(crate) struct Sampled {
        pub(crate) incoming: glam::Vec3,
        pub(crate) weight: Rgb,
        /// Density; `None` for a mirrored direction.
        pub(crate) pdf: Option<f32>,
    }

    /// Samples the BSDF of one material.
    pub(crate) fn sample(
        material: &impl Material,
        outgoing: glam::Vec3,
        [u, v, choice]: [f32; 3],
    ) -> Option<Sampled> {
        let bsdf = bsdf_of(material);
        let Scatter { incoming, weight, pdf } = bsdf.sample(outgoing.into(), [u, v], choice);
        let weight = Rgb::from(weight);
        let pdf = (pdf > 0.0).then_some(pdf);
        (weight != Rgb::ZERO).then_some(Sampled { incoming: incoming.into(), weight, pdf })
    }

    pub(crate) fn eval(m: &impl Material, outgoing: glam::Vec3, incoming: glam::Vec3) -> Rgb {
        bsdf_of(m).eval(outgoing.into(), incoming.into()).into()
    }

    pub(crate) fn pdf(m: &impl Material, outgoing: glam::Vec3, incoming: glam::Vec3) -> f32 {
        bsdf_of(m).pdf(outgoing.into(), incoming.into())
    }

    fn bsdf_of<M: Material>(material: &M) -> M::Bsdf<f32> {
        M::row(&BroadcastParams(material.params(Rgb::ONE)))
    }

    /// Checks that sixteen surfaces at once equal each one alone, to the bit.
    pub(crate) fn rows_equal_their_lanes<M: Material>(each: &[M; MAX_LANES]) {
        let row: M::Bsdf<F32x16> =
            M::row(&GatheredParams(each.each_ref().map(|material| material.params(Rgb::ONE))));
        let u: Vec<[f32; 3]> = numbers(5, MAX_LANES).collect();
        let direction = |seed| {
            let directions: Vec<glam::Vec3> = numbers(seed, MAX_LANES)
                .map(|[u, v, _]| crate::sampling::cosine_hemisphere([u, v]))
                .collect();
            directions
        };
        let lanes = |v: &[glam::Vec3]| {
            let axis = |axis: usize| F32x16::new(std::array::from_fn(|lane| v[lane][axis]));
            Vec3::new(axis(0), axis(1), axis(2))
        };
        let (outgoing, incoming) = (direction(6), direction(7));
        let column = |i: usize| F32x16::new(std::array::from_fn(|lane| u[lane][i]));
        let (wo, wi) = (lanes(&outgoing), lanes(&incoming));
        let all = (row.eval(wo, wi), row.pdf(wo, wi), row.mirrored(wo));
        let scatter = row.sample(wo, [column(0), column(1)], column(2));
        for lane in 0..MAX_LANES {
            let one = bsdf_of(&each[lane]);
            assert_eq!(row.is_delta().bits() >> lane & 1 == 1, one.is_delta());
            let (wo, wi) = (outgoing[lane].into(), incoming[lane].into());
            let at = |v: Vec3<F32x16>| v.map(|row| row.to_array()[lane]);
            assert_eq!(at(all.0), one.eval(wo, wi));
            assert_eq!(all.1.to_array()[lane], one.pdf(wo, wi));
            assert_eq!(at(all.2), one.mirrored(wo));
            let [a, b, c] = u[lane];
            let Scatter { incoming, weight, pdf } = one.sample(wo, [a, b], c);
            assert_eq!((at(scatter.incoming), at(scatter.weight)), (incoming, weight));
            assert_eq!(scatter.pdf.to_array()[lane], pdf);
        }
    }

    /// Checks that sampled directions follow the density, and that mirrored directions have their
    /// probability, `None` if that is not known. The grid is around the mirrored direction if the lobe
    /// is narrow.
    pub(crate) fn samples_follow_density<M: Material>(
        material: &M,
        outgoing: glam::Vec3,
        grid: Grid,
        none: Option<f64>,
    ) {
        let samples = numbers(9, 250_000).map(|u| {
            let scatter = sample(material, outgoing, u)?;
            scatter.pdf.map(|_| scatter.incoming)
        });
        grid.check(samples, |incoming| pdf(material, outgoing, incoming), none);
    }

    /// Estimates the albedo by BSDF sampling; returns it with its standard error.
    pub(crate) fn albedo_by_sampling<M: Material>(
        material: &M,
        outgoing: glam::Vec3,
    ) -> (f64, f64) {
        let n = 200_000;
        let (mut sum, mut sum2) = (0.0, 0.0);
        for u in numbers(1, n) {
            let weight = sample(material, outgoing, u).map_or(0.0, |s| s.weight.x);
            sum += f64::from(weight);
            sum2 += f64::from(weight).powi(2);
        }
        let mean = sum / n as f64;
        (mean, ((sum2 / n as f64 - mean * mean).max(0.0) / n as f64).sqrt())
    }

    /// Estimates the albedo without mirrored light by uniform directions on the hemisphere; returns it
    /// with its standard error.
    pub(crate) fn albedo_by_quadrature<M: Material>(
        material: &M,
        outgoing: glam::Vec3,
    ) -> (f64, f64) {
        let n = 400_000;
        let (mut sum, mut sum2) = (0.0, 0.0);
        for u in numbers(2, n) {
            let mut incoming = uniform_sphere([u[0], u[1]]);
            incoming.z = incoming.z.abs();
            let value = f64::from(eval(material, outgoing, incoming).x * 2.0 * PI);
            sum += value;
            sum2 += value * value;
        }
        let mean = sum / n as f64;
        (mean, ((sum2 / n as f64 - mean * mean) / n as f64).sqrt())
    }

    /// Checks that sampled weights are BSDF times cosine over density.
    pub(crate) fn samples_match_density<M: Material>(material: &M, outgoing: glam::Vec3) {
        for u in numbers(3, 20_000) {
            let Some(scatter) = sample(material, outgoing, u) else { continue };
            let Some(density) = scatter.pdf else { continue };
            assert!(density.is_finite(), "{density} {u:?}");
            assert!(scatter.incoming.is_normalized() && scatter.incoming.z >= 0.0);
            let expected = eval(material, outgoing, scatter.incoming);
            let other = pdf(material, outgoing, scatter.incoming);
            assert!((density - other).abs() <= 2e-3 * other, "{density} {other}");
            let got = scatter.weight * density;
            assert!(
                (got - expected).abs().max_element() <= 2e-3 * expected.max_element().max(1e-6)
            );
        }
    }
}
