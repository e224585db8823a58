//! Random numbers for generators: one sequence per seed, the same on every machine.

use crate::elementary::{cos, ln, power_of_two};
use crate::scene::{Rgb, linear_from_srgb};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A sequence of random numbers.
pub(super) struct Random(Xoshiro256PlusPlus);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Returns a number uniform in 0..1.
    pub(super) fn unit(&mut self) -> f64 {
        // A double holds the upper 53 bits.
        (self.0.next_u64() >> 11) as f64 * power_of_two(-53)
    }

    /// Returns a number uniform from `low` to `high`.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        (high - low).mul_add(self.unit(), low)
    }

    /// Returns a normal number with mean 0 and standard deviation 1 (Box, Muller, "A Note on the
    /// Generation of Random Normal Deviates", Annals of Mathematical Statistics 1958).
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * ln(1.0 - self.unit())).sqrt();
        radius * cos(TAU * self.unit())
    }

    /// Returns three values, each uniform from `low` to `high`.
    pub(super) fn rgb(&mut self, low: f64, high: f64) -> Rgb {
        let mut component = || self.between(low, high) as f32;
        Rgb::new(component(), component(), component())
    }

    /// Returns a color of a harmonious palette: warm from red to yellow or cool from green to blue, of
    /// moderate saturation.
    pub(super) fn pleasant_color(&mut self) -> Rgb {
        let warm = self.unit() < 0.55;
        let hue = if warm { self.between(-0.15, 0.95) } else { self.between(2.6, 3.7) };
        let saturation = self.between(0.3, 0.75);
        let value = self.between(0.6, 0.95);
        from_hsv(hue, saturation, value)
    }
}

/// Returns the linear color of hue (in sixths of the circle), saturation and value in the sRGB cube.
fn from_hsv(hue: f64, saturation: f64, value: f64) -> Rgb {
    let component = |offset: f64| {
        let sixth = (offset + hue).rem_euclid(6.0);
        let weight = sixth.min(4.0 - sixth).clamp(0.0, 1.0);
        linear_from_srgb((value * (1.0 - saturation * weight)) as f32)
    };
    Rgb::new(component(5.0), component(3.0), component(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_are_where_they_belong() {
        assert_eq!(from_hsv(0.0, 1.0, 1.0), Rgb::X);
        assert_eq!(from_hsv(1.0, 1.0, 1.0), Rgb::new(1.0, 1.0, 0.0));
        assert_eq!(from_hsv(2.0, 1.0, 1.0), Rgb::Y);
        assert_eq!(from_hsv(4.0, 1.0, 1.0), Rgb::Z);
        assert_eq!(from_hsv(3.3, 0.0, 1.0), Rgb::ONE);
    }

    #[test]
    fn normal_numbers_have_their_moments() {
        let mut random = Random::new(3);
        let count = 40_000;
        let numbers: Vec<f64> = (0..count).map(|_| random.normal()).collect();
        let mean = numbers.iter().sum::<f64>() / f64::from(count);
        let square = numbers.iter().map(|number| number * number).sum::<f64>() / f64::from(count);
        // Five standard errors.
        assert!(mean.abs() < 5.0 / f64::from(count).sqrt(), "{mean}");
        assert!((square - 1.0).abs() < 5.0 * (2.0 / f64::from(count)).sqrt(), "{square}");
    }
}
