//! Irradiance by the environment, as a polynomial of the normal.
//!
//! Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment Maps", SIGGRAPH 2001: of the
//! spherical harmonics of the radiance, those of degree 2 and less give the irradiance within some percent.

use super::Environment;
use crate::lanes::Lanes;
use crate::sampling::uniform_sphere;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use std::f32::consts::PI;

/// Number of spherical harmonics of degree 0, 1 and 2.
const HARMONICS: usize = 9;

/// Factors of each degree by which irradiance follows from radiance.
const DEGREES: [f32; HARMONICS] = {
    let [a, b, c] = [PI, 2.0 * PI / 3.0, PI / 4.0];
    [a, b, b, b, c, c, c, c, c]
};

/// Directions in which the radiance is evaluated, by height and around.
const GRID: [u32; 2] = [64, 128];

/// Irradiance of surfaces that see the whole hemisphere above them.
#[derive(Clone, Debug)]
pub struct Irradiance {
    /// Coefficients of the spherical harmonics of the normal, by channel.
    coefficients: [Rgb; HARMONICS],
}

impl Irradiance {
    /// Returns the same irradiance for all normals.
    pub fn constant(irradiance: Rgb) -> Self {
        let mut coefficients = [Rgb::ZERO; HARMONICS];
        let [unit, ..] = harmonics(glam::Vec3::Z.into());
        coefficients[0] = irradiance / unit;
        Self { coefficients }
    }

    /// Returns the irradiance by an environment, without the suns; black if it does not illuminate. Suns in a picture
    /// are blurred, and those smaller than a degree may be missed.
    pub fn of(environment: &Environment) -> Self {
        if !environment.illuminates || environment.is_black() {
            return Self::constant(Rgb::ZERO);
        }
        if let Some(radiance) = environment.constant() {
            return Self::constant(radiance * PI);
        }
        let [heights, around] = GRID;
        let mut coefficients = [Rgb::ZERO; HARMONICS];
        for (row, column) in (0..heights).flat_map(|row| (0..around).map(move |c| (row, c))) {
            let place = [(row, heights), (column, around)];
            let direction = uniform_sphere(place.map(|(at, of)| (at as f32 + 0.5) / of as f32));
            let radiance = environment.radiance(direction);
            let each = coefficients.iter_mut().zip(harmonics(direction.into()));
            each.for_each(|(sum, harmonic)| *sum += radiance * harmonic);
        }
        let angle = 4.0 * PI / (heights * around) as f32;
        let each = coefficients.iter_mut().zip(DEGREES);
        each.for_each(|(sum, factor)| *sum *= angle * factor);
        Self { coefficients }
    }

    /// Returns the mean over all normals.
    pub fn mean(&self) -> Rgb {
        let [unit, ..] = harmonics(glam::Vec3::Z.into());
        self.coefficients[0] * unit
    }

    /// Returns the irradiance of surfaces with these unit normals, by channel.
    #[inline(always)]
    pub fn at<L: Lanes>(&self, normal: Vec3<L>) -> Vec3<L> {
        let mut sums = Vec3::splat(0.0, 0.0, 0.0);
        for (&Rgb { x, y, z }, harmonic) in self.coefficients.iter().zip(harmonics(normal)) {
            sums = sums + Vec3::splat(x, y, z) * harmonic;
        }
        // Sharp light makes them negative on the other side.
        sums.map(|channel| Lanes::max(channel, L::splat(0.0)))
    }
}

/// Returns the real spherical harmonics of degree 0, 1 and 2 in unit directions.
#[inline(always)]
fn harmonics<L: Lanes>(Vec3 { x, y, z }: Vec3<L>) -> [L; HARMONICS] {
    let [a, b, c, d, e] = [0.282_095, 0.488_603, 1.092_548, 0.315_392, 0.546_274].map(L::splat);
    let [xy, yz, zx] = [x * y, y * z, z * x];
    let tall = L::splat(3.0) * z * z - L::splat(1.0);
    [a, b * y, b * z, b * x, c * xy, c * yz, c * zx, d * tall, e * (x * x - y * y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, EnvironmentMap, Look};

    #[test]
    fn irradiance_of_a_gradient_is_its_closed_form() {
        let (bottom, top) = (Rgb::new(0.1, 0.4, 0.0), Rgb::new(0.9, 0.2, 0.0));
        let up = glam::DVec3::new(2.0, -1.0, 2.0) / 3.0;
        let map = EnvironmentMap::Gradient { bottom, top, up };
        let environment =
            Environment::build(&scene::Environment { map, illuminates: true }, &Look::default());
        let irradiance = Irradiance::of(&environment);
        for [x, y, z] in [[0.0, 0.0, 1.0], [-0.6, 0.0, 0.8], [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0]] {
            let normal = glam::Vec3::new(x, y, z);
            let cosine = normal.dot(up.as_vec3());
            // The mean, and the slope of a linear radiance times 2/3.
            let expected = ((bottom + top) / 2.0 + (top - bottom) / 2.0 * cosine * 2.0 / 3.0) * PI;
            let found = Rgb::from(irradiance.at::<f32>(normal.into()));
            assert!((found - expected).abs().max_element() < 1e-3, "{found} {expected}");
        }
        let white = Irradiance::constant(Rgb::ONE).at::<f32>(glam::Vec3::X.into());
        assert!((Rgb::from(white) - Rgb::ONE).abs().max_element() < 1e-6);
    }
}
