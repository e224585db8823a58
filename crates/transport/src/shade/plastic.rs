//! Plastic: a diffuse base under a smooth dielectric coat, conserving energy.
//!
//! The coat reflects light or lets it enter; the base scatters it, the coat partly reflects it back to
//! the base any number of times, and it leaves: the geometric series over the internal reflections
//! (Weidlich and Wilkie, "Arbitrarily Layered Micro-Facet Surfaces", GRAPHITE 2007, with the series
//! summed). A white base reflects exactly all light.

use super::{BroadcastParams, Bsdf, Material, Params, Scatter, fresnel, in_doubles, is_black};
use crate::color::Rgb;
use crate::lanes::{F64x8, Lanes};
use crate::sampling::cosine_hemispheres;
use crate::vec3::Vec3;
use bytemuck::{Pod, Zeroable};
use std::f32::consts::FRAC_1_PI;
use std::mem::offset_of;

/// A row of the table of coated materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// Albedo of the base.
    pub color: Rgb,
    /// Index of refraction of the coat.
    pub ior: f32,
    /// Share of diffuse light from below that the coat reflects back down.
    pub internal_reflectance: f32,
}

/// Parameters of a [`PlasticBsdf`].
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct PlasticParams {
    base: Rgb,
    ior: f32,
}

/// A row of coated surfaces.
pub struct PlasticBsdf<L> {
    ior: L,
    /// BSDF of the base, times pi, without the coat's transmittance for either direction.
    base: Vec3<L>,
}

impl<L: Lanes> PlasticBsdf<L> {
    /// Returns the reflectance of the coat at this cosine.
    #[inline(always)]
    fn coat(&self, cosine: L) -> L {
        in_doubles([cosine, self.ior], |[cosine, ior]| {
            fresnel::dielectric(cosine, F64x8::splat(1.0) / ior).0
        })
    }

    /// Returns the probability with which the mirrored direction is sampled, for this reflectance of the coat: its
    /// share of the light if all directions are equally bright, so that dark bases are sampled less.
    #[inline(always)]
    fn mirrored_probability(&self, coat: L) -> L {
        let base = (L::splat(1.0) - coat) * self.base.max_element();
        // 1 where neither reflects.
        let sum = (coat + base).max(L::splat(f32::MIN_POSITIVE));
        L::splat(1.0) - base / sum
    }
}

impl Plastic {
    /// Returns the probability with which the mirrored direction is sampled at this cosine, with the sphere's color as
    /// a factor.
    pub(crate) fn mirrored_probability(&self, color: Rgb, cosine: f32) -> f32 {
        let bsdf: PlasticBsdf<f32> = Self::row(&BroadcastParams(self.params(color)));
        bsdf.mirrored_probability(bsdf.coat(cosine))
    }
}

impl Material for Plastic {
    const DIFFUSE: bool = false;
    const HAS_DIFFUSE_BASE: bool = true;
    type Params = PlasticParams;
    type Bsdf<L: Lanes> = PlasticBsdf<L>;

    #[inline(always)]
    fn params(&self, color: Rgb) -> PlasticParams {
        let base = (self.color * color).map(|albedo| {
            let kept = 1.0 - albedo * self.internal_reflectance;
            albedo / (kept * (self.ior * self.ior))
        });
        PlasticParams { base, ior: self.ior }
    }

    #[inline(always)]
    fn row<L: Lanes>(params: &impl Params<L>) -> PlasticBsdf<L> {
        PlasticBsdf {
            base: params.color(offset_of!(PlasticParams, base)),
            ior: params.float(offset_of!(PlasticParams, ior)),
        }
    }
}

impl<L: Lanes> Bsdf<L> for PlasticBsdf<L> {
    #[inline(always)]
    fn is_delta(&self) -> L::Mask {
        is_black(self.base)
    }

    #[inline(always)]
    fn eval(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> Vec3<L> {
        let one = L::splat(1.0);
        let cosine = incoming.z.max(L::splat(0.0));
        let passes = (one - self.coat(outgoing.z)) * (one - self.coat(cosine));
        self.base * (passes * L::splat(FRAC_1_PI) * cosine)
    }

    #[inline(always)]
    fn pdf(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> L {
        let base = L::splat(1.0) - self.mirrored_probability(self.coat(outgoing.z));
        base * L::splat(FRAC_1_PI) * incoming.z.max(L::splat(0.0))
    }

    #[inline(always)]
    fn sample(&self, outgoing: Vec3<L>, direction: [L; 2], choice: L) -> Scatter<L> {
        let one = L::splat(1.0);
        let coat = self.coat(outgoing.z);
        let mirrored = self.mirrored_probability(coat);
        // No base is sampled if the probability is 1.
        let below = (one - mirrored).max(L::splat(f32::MIN_POSITIVE));
        let incoming = cosine_hemispheres(direction);
        let base = Scatter {
            incoming,
            weight: self.base * ((one - coat) * (one - self.coat(incoming.z)) / below),
            pdf: (one - mirrored) * L::splat(FRAC_1_PI) * incoming.z,
        };
        let weight = coat / mirrored.max(L::splat(f32::MIN_POSITIVE));
        let coated = Scatter::mirrored(outgoing, Vec3::new(weight, weight, weight));
        Scatter::select(choice.lt(mirrored), &coated, &base)
    }

    #[inline(always)]
    fn mirrored(&self, outgoing: Vec3<L>) -> Vec3<L> {
        let coat = self.coat(outgoing.z);
        Vec3::new(coat, coat, coat)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{albedo_by_quadrature, albedo_by_sampling, at};
    use crate::shade::tests::{
        rows_equal_their_lanes, samples_follow_density, samples_match_density,
    };
    use glam::Vec3;

    fn plastic(color: f32) -> Plastic {
        let internal_reflectance = fresnel::internal_diffuse_reflectance(1.5) as f32;
        Plastic { color: Rgb::splat(color), ior: 1.5, internal_reflectance }
    }

    fn coat(plastic: Plastic, cosine: f32) -> f64 {
        f64::from(Plastic::row::<f32>(&BroadcastParams(plastic.params(Rgb::ONE))).coat(cosine))
    }

    #[test]
    fn rows() {
        rows_equal_their_lanes(&std::array::from_fn(|i| plastic(0.06 * i as f32)));
    }

    #[test]
    fn a_white_base_conserves_energy() {
        for outgoing in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.995, 0.0, 0.1).normalize()]
        {
            let (albedo, error) = albedo_by_sampling(&plastic(1.0), outgoing);
            assert!((albedo - 1.0).abs() < 4.0 * error + 1e-5, "{albedo} {error}");
        }
    }

    #[test]
    fn directions_follow_the_density() {
        for cosine in [1.0, 0.5, 0.1, 0.01] {
            for color in [0.1, 0.5] {
                let (bsdf, outgoing) = (plastic(color), at(cosine));
                let mirrored = f64::from(bsdf.mirrored_probability(Rgb::ONE, outgoing.z));
                samples_follow_density(&bsdf, outgoing, Grid::hemisphere(Vec3::Z), Some(mirrored));
                samples_match_density(&bsdf, outgoing);
            }
        }
    }

    #[test]
    fn samples_match_the_response() {
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        samples_match_density(&plastic(0.5), outgoing);
        let (all, e1) = albedo_by_sampling(&plastic(0.5), outgoing);
        let (base, e2) = albedo_by_quadrature(&plastic(0.5), outgoing);
        let coat = coat(plastic(0.5), outgoing.z);
        assert!((all - base - coat).abs() < 4.0 * e1.hypot(e2), "{all} {base} {coat}");
    }
}
