//! Metals: smooth mirrors, or rough by GGX.

use super::{Bsdf, Scatter, fresnel, ggx, mirror};
use crate::scene::{ConductorFresnel, Rgb};
use crate::world::Conductor;
use glam::Vec3;

impl Conductor {
    /// The color in which it reflects what is seen from above.
    pub fn color(&self) -> Rgb {
        self.reflectance(1.0)
    }

    /// Share that is reflected at this cosine between direction and facet.
    fn reflectance(&self, cosine: f32) -> Rgb {
        let reflectance = match self.fresnel {
            // The tint is part of the color that Schlick's curve takes to white at grazing angles.
            ConductorFresnel::Schlick(color) => fresnel::schlick(cosine, color * self.tint),
            ConductorFresnel::Constant(color) => color * self.tint,
            ConductorFresnel::Exact { eta, k } => {
                let channel = |eta, k| fresnel::conductor(cosine, eta, k);
                self.tint * Rgb::new(channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z))
            }
        };
        reflectance.min(Rgb::ONE)
    }
}

impl Bsdf for Conductor {
    const DIFFUSE: bool = false;

    fn tinted(self, color: Rgb) -> Self {
        Self { tint: self.tint * color, ..self }
    }

    fn is_delta(&self) -> bool {
        self.roughness == 0.0
    }

    fn eval(&self, outgoing: Vec3, incoming: Vec3) -> Rgb {
        if self.is_delta() || incoming.z <= 0.0 {
            return Rgb::ZERO;
        }
        let normal = (outgoing + incoming).normalize_or(Vec3::Z);
        let alpha = self.roughness;
        let masking = 1.0 / (1.0 + ggx::lambda(alpha, outgoing) + ggx::lambda(alpha, incoming));
        self.reflectance(outgoing.dot(normal))
            * (ggx::distribution(alpha, normal) * masking / (4.0 * outgoing.z))
    }

    fn pdf(&self, outgoing: Vec3, incoming: Vec3) -> f32 {
        if self.is_delta() || incoming.z <= 0.0 {
            return 0.0;
        }
        let normal = (outgoing + incoming).normalize_or(Vec3::Z);
        ggx::visible_normal_pdf(self.roughness, outgoing, normal) / (4.0 * outgoing.dot(normal))
    }

    fn sample(&self, outgoing: Vec3, direction: [f32; 2], _choice: f32) -> Option<Scatter> {
        if self.is_delta() {
            let weight = self.reflectance(outgoing.z);
            return Some(Scatter { incoming: mirror(outgoing), weight, pdf: None });
        }
        let alpha = self.roughness;
        let normal = ggx::sample_visible_normal(alpha, outgoing, direction);
        let cosine = outgoing.dot(normal);
        let incoming = (normal * (2.0 * cosine) - outgoing).normalize();
        if incoming.z <= 0.0 || cosine <= 0.0 {
            return None;
        }
        // Masking of both directions given that of one: all that is left of response over density.
        let one = 1.0 + ggx::lambda(alpha, outgoing);
        let both = one + ggx::lambda(alpha, incoming);
        Some(Scatter {
            incoming,
            weight: self.reflectance(cosine) * (one / both),
            pdf: Some(ggx::visible_normal_pdf(alpha, outgoing, normal) / (4.0 * cosine)),
        })
    }

    fn mirrored(&self, _outgoing: Vec3) -> Option<Rgb> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{albedo_by_quadrature, albedo_by_sampling, at};
    use crate::shade::tests::{samples_follow_density, samples_match_density};

    fn rough(roughness: f32) -> Conductor {
        Conductor { fresnel: ConductorFresnel::Constant(Rgb::ONE), roughness, tint: Rgb::ONE }
    }

    #[test]
    fn a_smooth_mirror_mirrors() {
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        let scatter = rough(0.0).sample(outgoing, [0.3, 0.4], 0.5).unwrap();
        assert_eq!(scatter.incoming, Vec3::new(-0.6, 0.0, 0.8));
        assert_eq!((scatter.weight, scatter.pdf), (Rgb::ONE, None));
    }

    #[test]
    fn directions_follow_the_density() {
        for roughness in [0.02, 0.1, 0.4, 1.0] {
            for cosine in [1.0, 0.7, 0.2, 0.05] {
                let (bsdf, outgoing) = (rough(roughness), at(cosine));
                samples_follow_density(&bsdf, outgoing, Grid::lobe(mirror(outgoing)), None);
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
