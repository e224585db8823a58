//! Conductors: metals that are smooth mirrors, or rough by GGX.

use super::{BroadcastParams, Bsdf, Material, Params, Scatter, fresnel, ggx, in_doubles};
use crate::lanes::{Lanes, Mask};
use crate::scene::{ConductorFresnel, Rgb};
use crate::vec3::Vec3;
use bytemuck::{Pod, Zeroable};
use std::mem::offset_of;

/// A row of the table of metals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Reflectance by angle.
    pub fresnel: ConductorFresnel,
    /// Factor on the color.
    pub tint: Rgb,
    /// GGX alpha; 0 is a smooth mirror.
    pub roughness: f32,
}

/// Parameters of a [`ConductorBsdf`].
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct ConductorParams {
    normal_incidence: Rgb,
    schlick_weight: f32,
    alpha: f32,
    /// 1 if the metal has an index of refraction, 0 if its color is given.
    exact: f32,
    eta: Rgb,
    k: Rgb,
    tint: Rgb,
}

/// A row of metals.
pub struct ConductorBsdf<L: Lanes> {
    /// Reflectance at normal incidence.
    normal_incidence: Vec3<L>,
    /// 1 if Schlick's approximation raises the reflectance to 1 at grazing angles, 0 if it is constant.
    schlick_weight: L,
    /// Complex indices of refraction, if any lane has one.
    exact: Option<ComplexIor<L>>,
    alpha: L,
}

/// Complex indices of refraction; the tint of other lanes is black.
struct ComplexIor<L> {
    eta: Vec3<L>,
    k: Vec3<L>,
    tint: Vec3<L>,
}

impl Conductor {
    /// Returns the reflectance at normal incidence.
    pub fn color(&self) -> Rgb {
        Self::row::<f32>(&BroadcastParams(self.params(Rgb::ONE))).reflectance(1.0).into()
    }
}

impl<L: Lanes> ComplexIor<L> {
    /// Returns the indices of refraction of these metals; `None` if none has one.
    #[inline(always)]
    fn of(params: &impl Params<L>) -> Option<Self> {
        let exact = L::splat(0.0).lt(params.float(offset_of!(ConductorParams, exact)));
        (exact.bits() != 0).then(|| Self {
            eta: params.color(offset_of!(ConductorParams, eta)),
            k: params.color(offset_of!(ConductorParams, k)),
            tint: params.color(offset_of!(ConductorParams, tint)),
        })
    }

    /// Returns the reflectance at this cosine between direction and facet.
    #[inline(always)]
    fn reflectance(&self, cosine: L) -> Vec3<L> {
        let channel = |eta, k| {
            in_doubles([cosine, eta, k], |[cosine, eta, k]| fresnel::conductor(cosine, eta, k))
        };
        let share = Vec3::new(
            channel(self.eta.x, self.k.x),
            channel(self.eta.y, self.k.y),
            channel(self.eta.z, self.k.z),
        );
        share.times(self.tint)
    }
}

impl<L: Lanes> ConductorBsdf<L> {
    /// Returns the reflectance at this cosine between direction and facet.
    #[inline(always)]
    pub fn reflectance(&self, cosine: L) -> Vec3<L> {
        let one = L::splat(1.0);
        let rise = fresnel::schlick_rise(cosine) * self.schlick_weight;
        let schlick = self.normal_incidence.map(|color| color + (one - color) * rise);
        let all = match &self.exact {
            Some(exact) => schlick + exact.reflectance(cosine),
            None => schlick,
        };
        all.map(|channel| channel.min(one))
    }

    #[inline(always)]
    fn smooth(&self) -> L::Mask {
        self.alpha.le(L::splat(0.0))
    }
}

impl Material for Conductor {
    const DIFFUSE: bool = false;
    const HAS_DIFFUSE_BASE: bool = false;
    type Params = ConductorParams;
    type Bsdf<L: Lanes> = ConductorBsdf<L>;

    /// The tint is part of the color, so that Schlick's approximation raises it to white.
    #[inline(always)]
    fn params(&self, color: Rgb) -> ConductorParams {
        let tint = self.tint * color;
        let by_color = ConductorParams {
            normal_incidence: Rgb::ZERO,
            schlick_weight: 0.0,
            alpha: self.roughness,
            exact: 0.0,
            eta: Rgb::splat(2.0),
            k: Rgb::ZERO,
            tint: Rgb::ZERO,
        };
        match self.fresnel {
            ConductorFresnel::Constant(color) => {
                ConductorParams { normal_incidence: color * tint, ..by_color }
            }
            ConductorFresnel::Schlick(color) => {
                ConductorParams { normal_incidence: color * tint, schlick_weight: 1.0, ..by_color }
            }
            ConductorFresnel::Exact { eta, k } => {
                ConductorParams { exact: 1.0, eta, k, tint, ..by_color }
            }
        }
    }

    #[inline(always)]
    fn row<L: Lanes>(params: &impl Params<L>) -> ConductorBsdf<L> {
        ConductorBsdf {
            normal_incidence: params.color(offset_of!(ConductorParams, normal_incidence)),
            schlick_weight: params.float(offset_of!(ConductorParams, schlick_weight)),
            exact: ComplexIor::of(params),
            alpha: params.float(offset_of!(ConductorParams, alpha)),
        }
    }
}

impl<L: Lanes> Bsdf<L> for ConductorBsdf<L> {
    #[inline(always)]
    fn is_delta(&self) -> L::Mask {
        self.smooth()
    }

    #[inline(always)]
    fn eval(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> Vec3<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let normal = ggx::upward(outgoing + incoming);
        let both = ggx::lambda(self.alpha, outgoing) + ggx::lambda(self.alpha, incoming);
        let facets = ggx::distribution(self.alpha, normal);
        let response = facets / ((one + both) * (L::splat(4.0) * outgoing.z));
        let rough = zero.lt(self.alpha) & zero.lt(incoming.z);
        self.reflectance(outgoing.dot(normal)) * L::select(rough, response, zero)
    }

    #[inline(always)]
    fn pdf(&self, outgoing: Vec3<L>, incoming: Vec3<L>) -> L {
        let zero = L::splat(0.0);
        let normal = ggx::upward(outgoing + incoming);
        let density = ggx::visible_normal_pdf(self.alpha, outgoing, normal)
            / (L::splat(4.0) * outgoing.dot(normal));
        L::select(zero.lt(self.alpha) & zero.lt(incoming.z), density, zero)
    }

    #[inline(always)]
    fn sample(&self, outgoing: Vec3<L>, direction: [L; 2], _choice: L) -> Scatter<L> {
        let smooth = Scatter::mirrored(outgoing, self.reflectance(outgoing.z));
        if (!self.smooth()).bits() == 0 {
            return smooth;
        }
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let normal = ggx::sample_visible_normal(self.alpha, outgoing, direction);
        let cosine = outgoing.dot(normal);
        let incoming = (normal * (cosine + cosine) - outgoing).normalize();
        // The weight is the masking-shadowing of both directions over the masking of one.
        let seen = one + ggx::lambda(self.alpha, outgoing);
        let both = seen + ggx::lambda(self.alpha, incoming);
        let kept = zero.lt(incoming.z) & zero.lt(cosine);
        let density =
            ggx::visible_normal_pdf(self.alpha, outgoing, normal) / (L::splat(4.0) * cosine);
        let rough = Scatter {
            incoming,
            weight: self.reflectance(cosine) * L::select(kept, seen / both, zero),
            pdf: density.max(L::splat(f32::MIN_POSITIVE)),
        };
        Scatter::select(self.smooth(), &smooth, &rough)
    }

    #[inline(always)]
    fn mirrored(&self, _outgoing: Vec3<L>) -> Vec3<L> {
        Vec3::splat(0.0, 0.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::mirror;
    use crate::shade::tests::{albedo_by_quadrature, albedo_by_sampling, at};
    use crate::shade::tests::{
        rows_equal_their_lanes, sample, samples_follow_density, samples_match_density,
    };
    use glam::Vec3;

    fn rough(roughness: f32) -> Conductor {
        Conductor { fresnel: ConductorFresnel::Constant(Rgb::ONE), roughness, tint: Rgb::ONE }
    }

    #[test]
    fn rows() {
        let (eta, k) = (Rgb::new(0.143, 0.375, 1.442), Rgb::new(3.983, 2.386, 1.603));
        let color = Rgb::new(0.9, 0.6, 0.3);
        let fresnel = [
            ConductorFresnel::Constant(color),
            ConductorFresnel::Schlick(color),
            ConductorFresnel::Exact { eta, k },
        ];
        for kinds in 1..=3 {
            rows_equal_their_lanes(&std::array::from_fn(|i| Conductor {
                fresnel: fresnel[i % kinds],
                roughness: 0.1 * (i % 7) as f32,
                tint: Rgb::splat(0.06 * i as f32),
            }));
        }
    }

    #[test]
    fn a_smooth_mirror_mirrors() {
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        let scatter = sample(&rough(0.0), outgoing, [0.3, 0.4, 0.5]).unwrap();
        assert_eq!(scatter.incoming, Vec3::new(-0.6, 0.0, 0.8));
        assert_eq!((scatter.weight, scatter.pdf), (Rgb::ONE, None));
    }

    #[test]
    fn directions_follow_the_density() {
        for roughness in [0.02, 0.1, 0.4, 1.0] {
            for cosine in [1.0, 0.7, 0.2, 0.05] {
                let (bsdf, outgoing) = (rough(roughness), at(cosine));
                samples_follow_density(
                    &bsdf,
                    outgoing,
                    Grid::lobe(mirror::<f32>(outgoing.into()).into()),
                    None,
                );
                samples_match_density(&bsdf, outgoing);
            }
        }
    }

    #[test]
    fn rough_metal_samples_match_its_albedo() {
        for roughness in [0.1, 0.5, 1.0] {
            let outgoing = Vec3::new(0.6, 0.0, 0.8);
            samples_match_density(&rough(roughness), outgoing);
            let (sampled, e1) = albedo_by_sampling(&rough(roughness), outgoing);
            let (integrated, e2) = albedo_by_quadrature(&rough(roughness), outgoing);
            assert!((sampled - integrated).abs() < 4.0 * e1.hypot(e2), "{sampled} {integrated}");
            assert!(sampled <= 1.0);
        }
    }
}
