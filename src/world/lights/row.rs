//! Light samples in rows, sixteen at a time: each is a long chain of arithmetic, and in lanes the
//! chains run side by side.

use super::{Aim, Disc, LightSample};
use crate::intersect::{self, Pairs};
use crate::lanes::{F32x16, F64x8, Mask, set_bits, widen};
use crate::ray::{ExactRay, MISS};
use crate::scene::Rgb;
use crate::vec3::Vec3;

/// Samples in a row.
pub const ROW: usize = 16;

/// Light that arrives from several directions, if nothing is in between; lane by lane what
/// [`LightSample`] is.
#[derive(Clone, Copy, Debug)]
pub struct LightRow {
    /// Unit vectors toward the light.
    pub direction: Vec3<F32x16>,
    /// Distances of the light.
    pub t: [f64; ROW],
    /// The light's row if it is a sphere, otherwise [`MISS`].
    pub target: u32,
    /// Radiance over density, by channel; black where there is no light.
    pub weight: Vec3<F32x16>,
    /// How many of the lanes are samples: the first.
    pub count: usize,
}

impl LightRow {
    /// Light from infinity, the same from everywhere.
    #[inline(always)]
    pub fn distant(direction: Vec3<F32x16>, weight: Rgb, count: usize) -> Self {
        Self { direction, t: [f64::INFINITY; ROW], target: MISS, weight: every(weight), count }
    }

    /// One of the samples.
    #[inline]
    pub fn sample(&self, lane: usize) -> LightSample {
        let direction = self.direction.map(|lanes| lanes.to_array()[lane]).into();
        let weight = self.weight.map(|lanes| lanes.to_array()[lane]).into();
        let (t, target) = (self.t[lane], self.target);
        LightSample { direction, t, target, weight, pdf: None, close: false }
    }
}

#[inline(always)]
fn every(color: Rgb) -> Vec3<F32x16> {
    Vec3::splat(color.x, color.y, color.z)
}

impl Aim<'_> {
    /// [`Aim::sample`] for the first `count` lanes of a row of numbers; densities are left out.
    #[inline(always)]
    pub fn sample_row(&self, u: [F32x16; 2], count: usize) -> LightRow {
        match self {
            Self::Disc(disc) => disc.sample_row(u, count),
            Self::Sun(sun) => match &sun.disc {
                Some(cone) => {
                    let direction = sun.frame.row_to_world(cone.sample_row(u));
                    LightRow::distant(direction, sun.weight, count)
                }
                None => self.sample_each(u, count),
            },
            Self::Delta(_) | Self::Sky(_) => self.sample_each(u, count),
        }
    }

    fn sample_each(&self, u: [F32x16; 2], count: usize) -> LightRow {
        let [u, v] = u.map(F32x16::to_array);
        let (mut direction, mut weight) = ([[0.0; ROW]; 3], [[0.0; ROW]; 3]);
        let mut row = LightRow::distant(Vec3::splat(0.0, 0.0, 1.0), Rgb::ZERO, count);
        for lane in 0..count {
            let Some(sample) = self.sample([u[lane], v[lane]]) else { continue };
            row.t[lane] = sample.t;
            for axis in 0..3 {
                direction[axis][lane] = sample.direction[axis];
                weight[axis][lane] = sample.weight[axis];
            }
        }
        let lanes = |[x, y, z]: [[f32; ROW]; 3]| Vec3::new(x, y, z).map(F32x16::new);
        LightRow { direction: lanes(direction), weight: lanes(weight), ..row }
    }
}

impl Disc {
    #[inline(always)]
    fn sample_row(&self, u: [F32x16; 2], count: usize) -> LightRow {
        let direction = self.frame.row_to_world(self.cone.sample_row(u));
        LightRow {
            direction,
            t: self.distances(direction, count),
            target: self.row,
            weight: every(self.weight),
            count,
        }
    }

    /// [`Disc::distance`] for each of the first `count` lanes.
    #[inline(always)]
    fn distances(&self, direction: Vec3<F32x16>, count: usize) -> [f64; ROW] {
        let splat = |v: glam::DVec3| Vec3::from(v).map(F64x8::splat);
        let one = ExactRay::new(self.origin, glam::Vec3::Z, true);
        let [x, y, z] = [direction.x, direction.y, direction.z].map(widen);
        let mut t = [0.0; ROW];
        for (half, t) in t.chunks_exact_mut(8).enumerate().take(count.div_ceil(8)) {
            let (plain, near) = intersect::confirm_plain(&Pairs {
                origin: splat(one.origin),
                direction: Vec3::new(x[half], y[half], z[half]),
                origin_error: F64x8::splat(one.origin_error),
                center: splat(self.center),
                radius: F64x8::splat(self.radius),
            });
            t.copy_from_slice(&near.to_array());
            let samples = (1_u32 << (count - 8 * half).min(8)) - 1;
            for lane in set_bits(!plain.bits() & samples) {
                t[lane] = self.distance(direction.map(|c| c.to_array()[8 * half + lane]).into());
            }
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{mix, stream, unit_pair};
    use crate::spheres::Spheres;
    use crate::world::Sun;
    use glam::{DVec3, Vec3};

    fn check(aim: &Aim, count: usize, seed: u64) {
        let draws: [[f32; 2]; ROW] =
            std::array::from_fn(|lane| unit_pair(stream(mix(seed), lane as u64)));
        let u = [0, 1].map(|axis| F32x16::new(draws.map(|draw| draw[axis])));
        let row = aim.sample_row(u, count);
        assert_eq!(row.count, count);
        for (lane, &draw) in draws.iter().enumerate().take(count) {
            let (sample, one) = (row.sample(lane), aim.sample(draw).expect("there is light"));
            assert_eq!(sample.direction, one.direction, "lane {lane}");
            assert_eq!((sample.t, sample.target), (one.t, one.target), "lane {lane}");
            assert_eq!(sample.weight, one.weight, "lane {lane}");
        }
    }

    #[test]
    fn a_row_is_what_its_lanes_are_one_by_one() {
        let spheres = Spheres::from_columns(&[0.3], &[-0.5], &[0.7], &[0.25]);
        // From afar, from near, and from where half of the lanes may be in doubt.
        for distance in [0.250_001, 0.3, 1.0, 100.0, 1e7] {
            let origin = Vec3::new(0.3, -0.5, 0.7) + Vec3::new(0.48, -0.6, 0.64) * distance;
            let disc =
                Disc::new(&spheres, 0, Rgb::ONE, (origin, 1.0)).expect("the point is outside");
            let aim = Aim::Disc(disc);
            (1..=ROW).for_each(|count| check(&aim, count, count as u64));
        }
        for angle in [0.0, 0.27, 90.0] {
            let sun = Sun::new(DVec3::new(0.6, 0.0, 0.8), Rgb::ONE, angle);
            check(&Aim::Sun(&sun), ROW, 1);
        }
    }
}
