//! The paper's material: a diffuse and a mirror component of one color, with given weights.

use super::{Bsdf, Material, Params, Scatter};
use crate::color::Rgb;
use crate::lanes::Lanes;
use crate::sampling::cosine_hemispheres;
use crate::vec3::Vec3;
use bytemuck::{Pod, Zeroable};
use std::f32::consts::FRAC_1_PI;
use std::mem::offset_of;

/// A row of the table of the paper's materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflective {
    /// Factor on both shares.
    pub color: Rgb,
    /// Diffuse share.
    pub diffuse: f32,
    /// Mirror share.
    pub mirror: f32,
}

/// Parameters of a [`ReflectiveBsdf`].
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct ReflectiveParams {
    color: Rgb,
    diffuse: f32,
    mirror: f32,
    mirror_probability: f32,
}

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
    pub fn mirror_probability(&self) -> f32 {
        let all = self.diffuse + self.mirror;
        if all > 0.0 { self.mirror / all } else { 0.0 }
    }
}

impl Material for Reflective {
    const DIFFUSE: bool = false;
    const HAS_DIFFUSE_BASE: bool = true;
    type Params = ReflectiveParams;
    type Bsdf<L: Lanes> = ReflectiveBsdf<L>;

    #[inline(always)]
    fn params(&self, color: Rgb) -> ReflectiveParams {
        ReflectiveParams {
            color: self.color * color,
            diffuse: self.diffuse,
            mirror: self.mirror,
            mirror_probability: self.mirror_probability(),
        }
    }

    #[inline(always)]
    fn row<L: Lanes>(params: &impl Params<L>) -> ReflectiveBsdf<L> {
        ReflectiveBsdf {
            color: params.color(offset_of!(ReflectiveParams, color)),
            diffuse: params.float(offset_of!(ReflectiveParams, diffuse)),
            mirror: params.float(offset_of!(ReflectiveParams, mirror)),
            mirror_probability: params.float(offset_of!(ReflectiveParams, mirror_probability)),
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
    fn lobes_add_up() {
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
