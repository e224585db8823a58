//! Conductors: metals that are smooth mirrors, or rough by GGX.

use super::{BroadcastParams, Bsdf, Material, Params, Scatter, fresnel, ggx, in_doubles};
use crate::lanes::{Lanes, Mask};
use crate::scene::{ConductorFresnel, Rgb};
use crate::vec3::Vec3;
use crate::world::Conductor;

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
        Self::row::<f32>(&BroadcastParams(self)).reflectance(1.0).into()
    }

    /// Whether the metal has an index of refraction.
    fn is_exact(&self) -> bool {
        matches!(self.fresnel, ConductorFresnel::Exact { .. })
    }

    /// Returns real and imaginary part of the index of refraction; arbitrary if the color is given.
    fn index(&self) -> [Rgb; 2] {
        match self.fresnel {
            ConductorFresnel::Exact { eta, k } => [eta, k],
            ConductorFresnel::Schlick(_) | ConductorFresnel::Constant(_) => {
                [Rgb::splat(2.0), Rgb::ZERO]
            }
        }
    }

    /// Returns the color at normal incidence. The tint is part of it, so that Schlick's approximation
    /// raises it to white.
    fn normal_incidence(&self) -> Rgb {
        match self.fresnel {
            ConductorFresnel::Schlick(color) | ConductorFresnel::Constant(color) => {
                color * self.tint
            }
            ConductorFresnel::Exact { .. } => Rgb::ZERO,
        }
    }
}

impl<L: Lanes> ComplexIor<L> {
    /// Returns the indices of refraction of these metals; `None` if none has one.
    #[inline(always)]
    fn of(params: &impl Params<L>) -> Option<Self> {
        let exact = L::splat(0.0).lt(params.row(5));
        (exact.bits() != 0).then(|| Self {
            eta: params.color(6),
            k: params.color(9),
            tint: params.color(12),
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
    fn reflectance(&self, cosine: L) -> Vec3<L> {
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
    const PARAMS: usize = 15;
    type Bsdf<L: Lanes> = ConductorBsdf<L>;

    fn tinted(self, color: Rgb) -> Self {
        Self { tint: self.tint * color, ..self }
    }

    #[inline(always)]
    fn param(&self, i: usize) -> f32 {
        let number = |yes: bool| f32::from(u8::from(yes));
        match i {
            0..3 => self.normal_incidence()[i],
            3 => number(matches!(self.fresnel, ConductorFresnel::Schlick(_))),
            4 => self.roughness,
            5 => number(self.is_exact()),
            6..9 => self.index()[0][i - 6],
            9..12 => self.index()[1][i - 9],
            _ if self.is_exact() => self.tint[i - 12],
            _ => 0.0,
        }
    }

    #[inline(always)]
    fn row<L: Lanes>(params: &impl Params<L>) -> ConductorBsdf<L> {
        ConductorBsdf {
            normal_incidence: params.color(0),
            schlick_weight: params.row(3),
            exact: ComplexIor::of(params),
            alpha: params.row(4),
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
    fn rough_metal_samples_what_it_reflects() {
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
