//! The paper's material: a diffuse and a mirror share of one color, weights given.

use super::{Bsdf, Scatter, mirror};
use crate::sampling::cosine_hemisphere;
use crate::scene::Rgb;
use crate::world::Reflective;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

impl Reflective {
    /// How often the mirror is chosen: by its part of what is reflected at all.
    fn mirror_probability(&self) -> f32 {
        let all = self.diffuse + self.mirror;
        if all > 0.0 { self.mirror / all } else { 0.0 }
    }
}

impl Bsdf for Reflective {
    const DIFFUSE: bool = false;

    fn tinted(self, color: Rgb) -> Self {
        Self { color: self.color * color, ..self }
    }

    fn is_delta(&self) -> bool {
        self.diffuse == 0.0
    }

    fn eval(&self, _outgoing: Vec3, incoming: Vec3) -> Rgb {
        self.color * (self.diffuse * FRAC_1_PI * incoming.z.max(0.0))
    }

    fn pdf(&self, _outgoing: Vec3, incoming: Vec3) -> f32 {
        (1.0 - self.mirror_probability()) * FRAC_1_PI * incoming.z.max(0.0)
    }

    fn sample(&self, outgoing: Vec3, direction: [f32; 2], choice: f32) -> Option<Scatter> {
        let weight = self.color * (self.diffuse + self.mirror);
        if weight == Rgb::ZERO {
            return None;
        }
        let mirrored = self.mirror_probability();
        if choice < mirrored {
            return Some(Scatter { incoming: mirror(outgoing), weight, pdf: None });
        }
        let incoming = cosine_hemisphere(direction);
        Some(Scatter { incoming, weight, pdf: Some((1.0 - mirrored) * FRAC_1_PI * incoming.z) })
    }

    fn mirrored(&self, _outgoing: Vec3) -> Option<Rgb> {
        Some(self.color * self.mirror)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{albedo_by_quadrature, albedo_by_sampling};
    use crate::shade::tests::{samples_follow_density, samples_match_density};

    #[test]
    fn shares_add_up() {
        let bsdf = Reflective { color: Rgb::splat(0.9), diffuse: 0.5, mirror: 0.3 };
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        samples_match_density(&bsdf, outgoing);
        samples_follow_density(&bsdf, outgoing, Grid::hemisphere(Vec3::Z), Some(0.375));
        let (all, _) = albedo_by_sampling(&bsdf, outgoing);
        let (diffuse, error) = albedo_by_quadrature(&bsdf, outgoing);
        assert!((all - 0.72).abs() < 1e-6, "{all}");
        assert!((diffuse - 0.45).abs() < 4.0 * error, "{diffuse}");
    }
}
