//! The choice of a caustic path for a surface point, by estimated contributions.
//!
//! The estimates take few operations, since every diffuse point needs them: they affect the noise, not
//! the expected image.

use super::connection::CausticPath;
use super::{CasterPair, CausticCasters};
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask};
use crate::vec3::Vec3;

/// Probability of a path that brings as much light as reaches the sphere: the most efficient value in
/// the images of `tools/references`; values up to four times as large make little difference.
const IRRADIANCE_TO_PROBABILITY: f64 = 0.5;

/// Least divergence of rays that is assumed: a focus is not sharper than that.
const LEAST_RATE: f32 = 0.2;

/// Data of a pair for the estimates, in single precision.
#[derive(Clone, Debug, Default)]
pub(super) struct ContributionEstimate {
    center: glam::Vec3,
    radius: f32,
    /// Unit vector from the sphere to the emitter.
    axis: glam::Vec3,
    /// Radius of the sphere over the distance of the emitter.
    radius_over_distance: f32,
    /// Squared angular radius of the emitter.
    emitter_radius2: f32,
    index: f32,
    clear: bool,
    /// Reflectance of the glass at normal incidence.
    normal_reflectance: f32,
    /// Factor from irradiance to probability, and the probability's maximum.
    probability_scale: f32,
    max_probability: f32,
}

impl CasterPair {
    /// Sets the estimate's data, from the share of the pair in the light that reaches its sphere, and
    /// the number of paths by all spheres.
    pub(super) fn with_estimate(self, share: f64, paths: usize) -> Self {
        let far = self.offset.length();
        let index = self.index;
        let estimate = ContributionEstimate {
            center: self.center.as_vec3(),
            radius: self.radius as f32,
            axis: (self.offset / far).as_vec3(),
            radius_over_distance: (self.radius / far) as f32,
            emitter_radius2: (self.emitter_radius / far).powi(2) as f32,
            index: index as f32,
            clear: self.clear,
            normal_reflectance: ((1.0 - index) / (1.0 + index)).powi(2) as f32,
            probability_scale: (IRRADIANCE_TO_PROBABILITY * share) as f32,
            max_probability: (share / paths as f64) as f32,
        };
        Self { estimate, ..self }
    }
}

/// A row of choices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SelectedPaths {
    /// Number of the pair, times [`CausticPath::COUNT`], plus that of the path.
    pub(crate) code: [u32; MAX_LANES],
    /// Probabilities of the choices.
    pub(crate) probability: F32x16,
    /// Lanes in which a path was chosen.
    pub(crate) lanes: u32,
}

impl CausticCasters {
    /// Chooses paths for points on surfaces with these normals, by random numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn choose(
        &self,
        point: Vec3<F32x16>,
        normal: Vec3<F32x16>,
        draw: F32x16,
    ) -> SelectedPaths {
        let zero = F32x16::splat(0.0);
        let (mut sum, mut probability, mut code) = (zero, zero, zero);
        let mut open = Lanes::le(zero, draw);
        for (number, pair) in self.pairs.iter().enumerate() {
            let chances = pair.estimate.chances(point, normal);
            for (chance, path) in chances.into_iter().zip(pair.paths()) {
                sum += chance;
                let here = open & Lanes::lt(draw, sum);
                probability = Lanes::select(here, chance, probability);
                let this = number as u32 * CausticPath::COUNT + *path as u32;
                code = Lanes::select(here, F32x16::splat(this as f32), code);
                open = open & !here;
            }
        }
        let code = code.to_array().map(|code| code as u32);
        SelectedPaths { code, probability, lanes: (!open).bits() }
    }

    /// Returns the probability with which [`CausticCasters::choose`] chooses a path of a pair.
    pub(super) fn probability(
        &self,
        pair: usize,
        path: CausticPath,
        [point, normal]: [glam::Vec3; 2],
    ) -> f32 {
        self.pairs[pair].estimate.chances::<f32>(point.into(), normal.into())[path as usize]
    }
}

impl ContributionEstimate {
    /// Estimates the probability of each path: the unoccluded irradiance that it brings, relative to
    /// that of the sphere, times a factor.
    #[inline(always)]
    fn chances<L: Lanes>(
        &self,
        point: Vec3<L>,
        normal: Vec3<L>,
    ) -> [L; CausticPath::COUNT as usize] {
        let splat = |v: glam::Vec3| Vec3::<L>::splat(v.x, v.y, v.z);
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        let toward = splat(self.center) - point;
        let inverse = one / toward.dot(toward).sqrt();
        let near = L::splat(self.radius) * inverse;
        let above = (normal.dot(toward) * inverse + near).min(one).max(zero);
        let level =
            L::select(near.lt(one), above * near * near * L::splat(self.probability_scale), zero);
        let max = L::splat(self.max_probability);
        // Cosine of the angle at the sphere between the point and the emitter.
        let between = -(toward.dot(splat(self.axis)) * inverse);
        let ends = near + L::splat(self.radius_over_distance);
        let facing = (one + between) * L::splat(0.5);
        let rate = two - ends * facing;
        let reflected = level / (rate * rate);
        if self.index == 0.0 {
            let seen = (near * L::splat(0.5) - one).lt(between);
            return [L::select(seen, reflected.min(max), zero), zero, zero, zero];
        }
        let rise = one - facing;
        let reflectance = L::splat(self.normal_reflectance)
            + L::splat(1.0 - self.normal_reflectance) * (rise * rise * rise);
        let reflected = (reflected * reflectance).min(max);
        if !self.clear {
            return [reflected, zero, zero, zero];
        }
        let through = self.through((between, ends), level).map(|chance| chance.min(max));
        [reflected, through[0], through[1], through[2]]
    }

    /// Estimates the probabilities of the paths through glass.
    #[inline(always)]
    fn through<L: Lanes>(&self, (between, ends): (L, L), level: L) -> [L; 3] {
        let (zero, least) = (L::splat(0.0), L::splat(LEAST_RATE));
        // Divergence of rays near the axis: 0 if a focus lies between both points.
        let straight = L::splat(2.0 - 2.0 * self.index);
        let rate = straight - ends;
        let beyond = zero.lt(rate);
        let edge = 2.0 * self.index * self.index - 1.0;
        let beam = ((-between - L::splat(edge)) * L::splat(1.0 / (1.0 - edge))).max(zero);
        let parting = L::select(beyond, rate.max(least), straight);
        let crossed = level * (beam * beam * beam) / (parting * parting);
        // An approximation of the least turn on this side of the focus.
        let depth = (-rate).max(zero);
        let bend = 0.7 + 2.0 * self.index * (1.0 - self.index * self.index);
        let least_turn2 = depth * depth * depth * L::splat(6.0 * 4.0 / 27.0 / bend);
        let reach = least_turn2 + L::splat(self.emitter_radius2);
        let within = (L::splat(1.0) + between).lt(reach) & zero.lt(depth);
        let parting = depth.max(least);
        let paraxial = L::select(within, level / (parting * parting), zero);
        [crossed, paraxial, paraxial * L::splat(0.5)]
    }
}
