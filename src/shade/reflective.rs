//! The paper's material: a diffuse and a mirror component of one color, with given weights.

use super::{Bsdf, Material, Params, Scatter};
use crate::lanes::Lanes;
use crate::sampling::cosine_hemispheres;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::Reflective;
use std::f32::consts::FRAC_1_PI;

/// A row of the paper's surfaces.
pub struct ReflectiveBsdf<L> {
    color: Vec3<L>,
    diffuse: L,
    mirror: L,
    /// Probability of the mirror component.
    mirror_probability: L,
}

impl Reflective {
    /// Returns the probability of the mirror component: its fraction of the reflected light.
    fn mirror_probability(&self) -> f32 {
        let all = self.diffuse + self.mirror;
        if all > 0.0 { self.mirror / all } else { 0.0 }
    }
}

impl Material for Reflective {
    const DIFFUSE: bool = false;
    const HAS_DIFFUSE_BASE: bool = true;
    const PARAMS: usize = 6;
    type Bsdf<L: Lanes> = ReflectiveBsdf<L>;

    fn tinted(self, color: Rgb) -> Self {
        Self { color: self.color * color, ..self }
    }

    #[inline(always)]
    fn param(&self, i: usize) -> f32 {
        match i {
            0..3 => self.color[i],
            3 => self.diffuse,
            4 => self.mirror,
            _ => self.mirror_probability(),
        }
    }

    #[inline(always)]
    fn row<L: Lanes>(params: &impl Params<L>) -> ReflectiveBsdf<L> {
        ReflectiveBsdf {
            color: params.color(0),
            diffuse: params.row(3),
            mirror: params.row(4),
            mirror_probability: params.row(5),
        }
    }
}

impl<L: Lanes> ReflectiveBsdf<L> {
    /// Returns the density of a cosine, times the probability of the diffuse component.
    #[inline(always)]
    fn density(&self, cosine: L) -> L {
        (L::splat(1.0) - self.mirror_probability) * L::splat(FRAC_1_PI) * cosine
    }
}

impl<L: Lanes> Bsdf<L> for ReflectiveBsdf<L> {
    #[inline(always)]
    fn is_delta(&self) -> L::Mask {
        self.diffuse.le(L::splat(0.0))
    }

    #[inline(always)]
    fn eval(&self, _outgoing: Vec3<L>, incoming: Vec3<L>) -> Vec3<L> {
        self.color * (self.diffuse * L::splat(FRAC_1_PI) * incoming.z.max(L::splat(0.0)))
    }

    #[inline(always)]
    fn pdf(&self, _outgoing: Vec3<L>, incoming: Vec3<L>) -> L {
        self.density(incoming.z.max(L::splat(0.0)))
    }

    #[inline(always)]
    fn sample(&self, outgoing: Vec3<L>, direction: [L; 2], choice: L) -> Scatter<L> {
        let weight = self.color * (self.diffuse + self.mirror);
        let incoming = cosine_hemispheres(direction);
        let diffuse = Scatter { incoming, weight, pdf: self.density(incoming.z) };
        let mirrored = Scatter::mirrored(outgoing, weight);
        Scatter::select(choice.lt(self.mirror_probability), &mirrored, &diffuse)
    }

    #[inline(always)]
    fn mirrored(&self, _outgoing: Vec3<L>) -> Vec3<L> {
        self.color * self.mirror
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::Grid;
    use crate::shade::tests::{albedo_by_quadrature, albedo_by_sampling};
    use crate::shade::tests::{
        rows_equal_their_lanes, samples_follow_density, samples_match_density,
    };
    use glam::Vec3;

    #[test]
    fn rows() {
        rows_equal_their_lanes(&std::array::from_fn(|i| Reflective {
            color: Rgb::new(0.9, 0.5, 0.05 * i as f32),
            diffuse: 0.04 * (i % 7) as f32,
            mirror: 0.1 * (i % 5) as f32,
        }));
    }

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
