//! Tests of goodness of fit for random samples.

use super::Basis;
use super::hash::{mix, stream, unit_pair};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Upper quantile of the normal distribution for a significance of 1e-6, which is 1e-4 for a hundred
/// tests (Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions",
/// JASA 1967).
const Z: f64 = 4.753_424_3;

/// Fails unless counts fit probabilities by Pearson's chi-squared test.
///
/// Cells with an expected count below 5 are pooled. The probabilities must sum to 1.
pub(crate) fn assert_chi_squared(observed: &[u64], probabilities: &[f64]) {
    let sum: f64 = probabilities.iter().sum();
    assert!((sum - 1.0).abs() < 1e-4, "the probabilities sum to {sum}");
    let count = observed.iter().sum::<u64>() as f64;
    let (mut statistic, mut cells) = (0.0, 0_u32);
    let mut pooled = (0.0, 0.0);
    let mut add = |observed: f64, expected: f64| {
        statistic += (observed - expected).powi(2) / expected;
        cells += 1;
    };
    for (&observed, &probability) in observed.iter().zip(probabilities) {
        let expected = probability * count;
        if expected < 5.0 {
            pooled = (pooled.0 + observed as f64, pooled.1 + expected);
        } else {
            add(observed as f64, expected);
        }
    }
    if pooled.1 > 1.0 {
        add(pooled.0, pooled.1);
    } else {
        assert!(pooled.0 < 15.0, "{} samples where {} are expected", pooled.0, pooled.1);
        assert!(pooled.0 == 0.0 || pooled.1 > 0.0, "{} samples where none can be", pooled.0);
    }
    let limit = chi_squared_quantile(f64::from(cells.max(2) - 1));
    assert!(statistic < limit, "chi-squared {statistic} >= {limit} of {cells} cells");
}

/// Wilson & Hilferty, "The Distribution of Chi-Square", PNAS 1931.
fn chi_squared_quantile(degrees: f64) -> f64 {
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + Z * spread.sqrt()).powi(3)
}

/// Returns pairs of random numbers in [0, 1).
pub(crate) fn random_pairs(count: u64, seed: u64) -> impl Iterator<Item = [f32; 2]> {
    (0..count).map(move |position| unit_pair(stream(mix(seed), position)))
}

/// A grid of cells of directions about an axis: rings of angles up to a maximum, each divided into
/// sectors.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) basis: Basis,
    /// Largest angle to the axis, in radians.
    pub(crate) angle: f64,
    /// Exponent of the ring spacing: rings are at equally spaced numbers to this power, times the
    /// angle; more than 1 makes cells near the axis finer.
    pub(crate) power: f64,
    pub(crate) rings: usize,
    pub(crate) sectors: usize,
    /// Number of points per side of a cell at which densities are evaluated.
    pub(crate) steps: usize,
}

impl Grid {
    /// Returns a grid of directions within `angle` of an axis.
    pub(crate) fn cone(axis: Vec3, angle: f64) -> Self {
        Self { basis: Basis::new(axis), angle, power: 1.0, rings: 20, sectors: 20, steps: 12 }
    }

    /// Returns a grid of the hemisphere about an axis.
    pub(crate) fn hemisphere(axis: Vec3) -> Self {
        Self::cone(axis, PI / 2.0)
    }

    /// Returns a grid of all directions, which is fine near an axis.
    pub(crate) fn lobe(axis: Vec3) -> Self {
        Self { power: 3.0, steps: 48, ..Self::cone(axis, PI) }
    }

    /// Returns the cell of a direction; the nearest if rounding has moved it out of the grid.
    fn cell(&self, direction: Vec3) -> Option<usize> {
        let direction = direction.as_dvec3();
        let [x, y, z] = [self.basis.tangent, self.basis.bitangent, self.basis.normal]
            .map(|axis| direction.dot(axis.as_dvec3()));
        let part = x.hypot(y).atan2(z) / self.angle;
        let ring = (part.powf(1.0 / self.power) * self.rings as f64) as usize;
        let sector = (y.atan2(x) / TAU).rem_euclid(1.0) * self.sectors as f64;
        let start = ring.min(self.rings - 1) * self.sectors;
        (part < 1.0 + 1e-4).then(|| start + (sector as usize).min(self.sectors - 1))
    }

    /// Integrates a density by solid angle over each cell, with the midpoint rule.
    fn integrals(&self, pdf: impl Fn(Vec3) -> f32) -> Vec<f64> {
        let steps = self.steps;
        let (rows, columns) = (self.rings * steps, self.sectors * steps);
        let mut integrals = vec![0.0; self.rings * self.sectors];
        let middle = |column: usize| (TAU * (column as f64 + 0.5) / columns as f64).sin_cos();
        let middles: Vec<(f64, f64)> = (0..columns).map(middle).collect();
        for row in 0..rows {
            let part = (row as f64 + 0.5) / rows as f64;
            let (sine, cosine) = (self.angle * part.powf(self.power)).sin_cos();
            // The angle's extent of a row, and its solid angle per column.
            let width = self.angle * self.power * part.powf(self.power - 1.0) / rows as f64;
            let area = sine * width * TAU / columns as f64;
            for (column, &(sin, cos)) in middles.iter().enumerate() {
                let local = DVec3::new(sine * cos, sine * sin, cosine);
                let density = f64::from(pdf(self.basis.to_world(local.as_vec3())));
                integrals[row / steps * self.sectors + column / steps] += density * area;
            }
        }
        integrals
    }

    /// Fails unless samples follow a density by solid angle, which must be positive at each sample, and
    /// all samples are in the grid. `none` is the probability of no sample; by default the complement
    /// of the density's integral.
    pub(crate) fn check(
        &self,
        samples: impl Iterator<Item = Option<Vec3>>,
        pdf: impl Fn(Vec3) -> f32,
        none: Option<f64>,
    ) {
        let mut probabilities = self.integrals(&pdf);
        let all: f64 = probabilities.iter().sum();
        assert!(all < 1.0 + 1e-4, "the density integrates to {all}");
        let missing = probabilities.len();
        probabilities.push(none.unwrap_or(1.0 - all).max(0.0));
        let mut observed = vec![0_u64; missing + 1];
        for sample in samples {
            let cell = sample.map_or(missing, |direction| {
                assert!((direction.length() - 1.0).abs() < 1e-6, "{direction}");
                assert!(pdf(direction) > 0.0, "density {} at {direction}", pdf(direction));
                self.cell(direction).unwrap_or_else(|| panic!("{direction} is out of bounds"))
            });
            observed[cell] += 1;
        }
        assert_chi_squared(&observed, &probabilities);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::uniform_sphere;

    #[test]
    fn quantile_of_the_tables() {
        // Exact values, from the incomplete gamma function; the approximation errs on the safe side.
        for (degrees, quantile) in [(15.0, 56.493_442), (63.0, 131.369_702), (255.0, 377.078_115)] {
            let approximation = chi_squared_quantile(degrees);
            let ratio = approximation / quantile;
            assert!((1.0..1.025).contains(&ratio), "{degrees}: {approximation}");
        }
    }

    #[test]
    #[should_panic(expected = "chi-squared")]
    fn a_bias_is_found() {
        let observed: Vec<u64> = (0..64).map(|i| if i < 32 { 1050 } else { 950 }).collect();
        assert_chi_squared(&observed, &[1.0 / 64.0; 64]);
    }

    /// Checks samples on the sphere with this density; 2 % more are on one side.
    fn check_sphere(density: impl Fn(Vec3) -> f32) {
        let samples = random_pairs(500_000, 1).map(|u| Some(uniform_sphere(u)));
        Grid::cone(Vec3::X, PI).check(samples, density, Some(0.0));
    }

    #[test]
    #[should_panic(expected = "chi-squared")]
    fn a_density_that_is_off_by_a_part_is_found() {
        check_sphere(|direction| (1.0 + 0.02_f32.copysign(direction.y)) / (4.0 * PI as f32));
    }

    #[test]
    #[should_panic(expected = "integrates to")]
    fn a_density_that_is_too_large_is_found() {
        check_sphere(|_| 1.02 / (4.0 * PI as f32));
    }

    #[test]
    #[should_panic(expected = "sum to")]
    fn a_density_that_is_too_small_is_found() {
        check_sphere(|_| 0.98 / (4.0 * PI as f32));
    }
}
