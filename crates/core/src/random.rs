//! Random numbers for scenes and rays: the same for a seed on every machine.

use crate::elementary::{self, cos, sin};
use glam::DVec3;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A stream of random numbers.
pub struct Random(Xoshiro256PlusPlus);

impl Random {
    /// Returns the stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Uniform in `0..1`.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in `0..1`, in single precision.
    pub fn single(&mut self) -> f32 {
        (self.0.next_u64() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Ten to a power that is uniform between two numbers.
    pub fn decades(&mut self, range: [f64; 2]) -> f64 {
        elementary::pow(10.0, self.between(range))
    }

    /// Uniform in `0..count`; 0 for none.
    pub fn index(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// True or false, at equal odds.
    pub fn coin(&mut self) -> bool {
        self.unit() < 0.5
    }

    /// 1 or -1.
    pub fn sign(&mut self) -> f64 {
        if self.coin() { 1.0 } else { -1.0 }
    }

    /// Uniform in the cube from -1 to 1.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::from(std::array::from_fn(|_| self.between([-1.0, 1.0])))
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        let (z, angle) = (self.between([-1.0, 1.0]), TAU * self.unit());
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos(angle), radius * sin(angle), z)
    }

    /// Uniform on the unit circle at right angles to a unit vector.
    pub fn perpendicular(&mut self, to: DVec3) -> DVec3 {
        let (side, other) = to.any_orthonormal_pair();
        let angle = TAU * self.unit();
        side * cos(angle) + other * sin(angle)
    }
}

/// Returns number `k` of object `i`: uniform in `0..1`, and independent of all others.
pub fn numbered(i: u64, k: u64) -> f32 {
    Random::new(i << 16 | k).single()
}

/// Returns the unit direction of a line that passes a point, which is `toward` away, at a distance: any direction if
/// none does.
pub fn direction_past(toward: DVec3, distance: f64, random: &mut Random) -> DVec3 {
    let length = toward.length();
    let sine = distance / length;
    if sine.is_nan() || sine >= 1.0 {
        return random.direction();
    }
    let forward = toward / length;
    forward * (1.0 - sine * sine).sqrt() + random.perpendicular(forward) * sine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_and_perpendiculars_perpendicular() {
        let mut random = Random::new(1);
        let mut mean = DVec3::ZERO;
        for _ in 0..4096 {
            let direction = random.direction();
            let side = random.perpendicular(direction);
            assert!(
                (direction.length() - 1.0).abs() < 1e-12 && (side.length() - 1.0).abs() < 1e-12
            );
            assert!(direction.dot(side).abs() < 1e-12);
            mean += direction / 4096.0;
        }
        // Standard deviation of each component of the mean: 1 / sqrt(3 x 4096) = 0.009.
        assert!(mean.abs().max_element() < 0.045, "{mean}");
    }

    #[test]
    fn numbers_stay_in_their_range() {
        let mut random = Random::new(2);
        for _ in 0..1000 {
            assert!((1e-3..=1e2).contains(&random.decades([-3.0, 2.0])));
            assert!(random.index(7) < 7 && random.index(0) == 0);
            assert!(random.in_cube().abs().max_element() <= 1.0);
        }
    }
}
