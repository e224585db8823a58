//! Estimates of the error of an image, from probes.

use crate::film::{Film, Pilot, Reading, Role, Tile};
use crate::image::Image;
use rayon::prelude::*;
use std::ops::Add;

/// Minimum fraction of renders whose error is below [`Noise::bound`].
pub const CONFIDENCE: f64 = 0.95;

/// Number of standard deviations from the estimate to the bound. A single decision with Gaussian terms
/// would need 1.64 for [`CONFIDENCE`]; this allows for several decisions and for heavy tails.
const DEVIATIONS: f64 = 3.0;

/// Weight of the third moment over the second in the bound: (2 x^2 + 1) / 6 for the same `x`.
const SKEW: f64 = (2.0 * DEVIATIONS * DEVIATIONS + 1.0) / 6.0;

/// The squared error of an image: its sum over pixels, averaged over channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredError {
    /// By probes, and by what they have not found.
    pub all: Estimate,
    /// Part of it that is only expected: light found by chance, which near misses predict and probes have
    /// not found.
    pub expected: f64,
}

/// An estimated number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its variance, rather too large than too small.
    pub variance: f64,
    /// Its third central moment, likewise; 0 if it is not skewed.
    pub third: f64,
}

/// The relative error of an image: the root of its mean squared error, over pixels and channels,
/// divided by its mean radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The estimate.
    pub error: f64,
    /// Upper bound of the error with the probability [`CONFIDENCE`].
    pub bound: f64,
    /// Fraction of the squared error that no probe has found: it is expected of light that few samples
    /// find, by the rays that narrowly miss it.
    pub expected: f64,
}

impl Noise {
    /// Computes the error from the sum of the squared errors of `pixels` pixels, and their mean
    /// radiance. An image without error has an error of 0 even if it is black.
    pub fn new(squared: SquaredError, pixels: u64, mean: Estimate) -> Self {
        let SquaredError { all: squared, expected } = squared;
        if squared.value == 0.0 && squared.variance == 0.0 {
            return Self { error: 0.0, bound: 0.0, expected: 0.0 };
        }
        // An estimate from products of two signs may be below 0 by chance.
        let value = squared.value.max(0.0);
        let expected = if value > 0.0 { expected / value } else { 0.0 };
        if mean.value == 0.0 {
            return Self { error: f64::INFINITY, bound: f64::INFINITY, expected };
        }
        let relative = |squared: f64| (squared / pixels as f64).sqrt() / mean.value;
        // The variances of the sum and of the squared mean.
        let of_mean = 4.0 * mean.variance / mean.value.powi(2);
        let deviation = (squared.variance + value * value * of_mean).sqrt();
        // Skewness correction of Cornish and Fisher, for terms of which few are large.
        let skew = squared.third / squared.variance.max(f64::MIN_POSITIVE);
        let bound = value + DEVIATIONS * deviation + SKEW * skew;
        Self { error: relative(value), bound: relative(bound), expected }
    }
}

impl Estimate {
    /// Returns the contribution of a reading to the sum of squared errors. The error of the actual
    /// image deviates from its expectation too: its pixels are `weight` times as many as the probes.
    fn of_squared(reading: &Reading) -> Self {
        let value = reading.weight * reading.squared;
        let deviation = 1.0 + 1.0 / reading.weight.max(1.0);
        Self { value, variance: value * value * deviation, third: value.powi(3) }
    }

    /// Combines two estimates of the same number, weighted by their variances.
    fn combined_with(self, other: Self) -> Self {
        let total = self.variance + other.variance;
        if self.variance == 0.0 || other.variance == 0.0 {
            return self;
        }
        Self {
            value: (self.value * other.variance + other.value * self.variance) / total,
            variance: self.variance * other.variance / total,
            third: 0.0,
        }
    }
}

impl Add for Estimate {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            variance: self.variance + other.variance,
            third: self.third + other.third,
        }
    }
}

/// Estimates the sum of the squared errors of all pixels, averaged over channels.
pub fn squared_error(film: &Film) -> SquaredError {
    let of_tile = |tile: &Tile| {
        let readings = tile.probes.readings(Role::Judge);
        readings.map(|reading| Estimate::of_squared(&reading)).fold(Estimate::default(), Add::add)
    };
    // In the order of the tiles, so that the sum has the same bits for any number of threads.
    let tiles: Vec<Estimate> = film.tiles.par_iter().map(of_tile).collect();
    let measured = tiles.into_iter().fold(Estimate::default(), Add::add);
    let missing = missing(film);
    SquaredError { all: measured + missing, expected: missing.value }
}

/// Estimates the part of the sum of squared errors that is due to light which near misses predict and judging probes
/// have not found.
pub fn missing(film: &Film) -> Estimate {
    let (mut expected, mut found, mut variance) = (0.0, 0.0, 0.0);
    for tile in &film.tiles {
        let (chance, pixels) = (tile.probes.chance_variance(Role::Judge), f64::from(tile.len()));
        expected += chance.expected * pixels;
        found += chance.found * pixels;
        // That of the estimate, and that of the actual error about its expectation.
        variance += chance.uncertainty * pixels * pixels + chance.spread * pixels;
    }
    let missing = f64::max(expected - found, 0.0);
    let variance = if missing > 0.0 { variance } else { 0.0 };
    Estimate { value: missing, variance, third: 0.0 }
}

/// Estimates the sum of the squared errors of any image of the film's region that does not depend on the samples of its
/// probes of this role.
///
/// The two streams of a probe are independent, so the product of their differences from the image's pixel is an
/// unbiased estimate of its squared error. Single products, and even their sum, may be negative.
///
/// `expected` has an expectation of each pixel's squared error, row by row, that does not depend on these probes either,
/// or is empty. Then probes estimate what it lacks (Cochran, "Sampling Techniques", 7.3): right or wrong, it adds no
/// bias, but makes up for errors in few pixels that probes miss.
pub fn squared_error_of(film: &Film, image: &Image, expected: &[f32], role: Role) -> Estimate {
    let pairs = film.tiles.iter().flat_map(|tile| tile.probes.pairs(role));
    let expected_of = |pixel: usize| expected.get(pixel).map_or(0.0, |&error| f64::from(error));
    let total = sum(expected, |&error| f64::from(error));
    let total = Estimate { value: total, ..Estimate::default() };
    let products = pairs.map(|pair| {
        let (x, y) = (pair.x - film.region.x, pair.y - film.region.y);
        let at = y as usize * image.width as usize + x as usize;
        let value = pair.weight * (pair.squared_error(image.pixels[at]) - expected_of(at));
        // Products of both signs: their third moments cancel, or add to the upper tail.
        Estimate { value, variance: value * value, third: value.powi(3).max(0.0) }
    });
    products.fold(total, Add::add)
}

/// Returns the sum of a value of each pixel, with the same bits for any number of threads.
pub(crate) fn sum<T: Sync>(pixels: &[T], value: impl Fn(&T) -> f64 + Sync) -> f64 {
    /// Pixels that one thread adds up.
    const TOGETHER: usize = 1 << 14;
    let sums = pixels.par_chunks(TOGETHER).map(|pixels| pixels.iter().map(&value).sum());
    let sums: Vec<f64> = sums.collect();
    sums.iter().sum()
}

/// Estimates the mean radiance over pixels and channels from pilot and probes, independently of the
/// image's own samples.
pub fn mean_radiance(film: &Film) -> Estimate {
    let pixels = film.pixels() as f64;
    let scale = |sum: Estimate| Estimate {
        value: sum.value / pixels,
        variance: sum.variance / (pixels * pixels),
        third: 0.0,
    };
    let pilot = film.tiles.iter().map(pilot).fold(Estimate::default(), Add::add);
    let probes = film.tiles.iter().map(probes).fold(Estimate::default(), Add::add);
    scale(pilot).combined_with(scale(probes))
}

/// Returns the sum of a tile's radiance from its pilot.
fn pilot(tile: &Tile) -> Estimate {
    let Pilot { sum, variance } = tile.probes.pilot.unwrap_or_default();
    Estimate { value: sum, variance, third: 0.0 }
}

/// Returns the same from its probes; from its pilot, which is exact, if it needs no probes.
fn probes(tile: &Tile) -> Estimate {
    if tile.probes.streams() == 0 {
        return pilot(tile);
    }
    let pairs = tile.probes.readings(Role::Steer).zip(tile.probes.readings(Role::Judge));
    let sums = pairs.map(|(a, b)| Estimate {
        value: a.weight * (a.radiance + b.radiance) / 2.0,
        variance: (a.weight * (a.radiance - b.radiance) / 2.0).powi(2),
        third: 0.0,
    });
    sums.fold(Estimate::default(), Add::add)
}

/// Returns a tile and its neighbors, row by row, with their weights in pooled estimates.
pub(super) fn neighbors(
    tile: usize,
    columns: usize,
    count: usize,
) -> impl Iterator<Item = (usize, f64)> {
    let (column, row, rows) = (tile % columns, tile / columns, count / columns);
    let around = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let weight = move |at: usize, middle: usize| if at == middle { 2.0 } else { 1.0 };
    around(row, rows).flat_map(move |y| {
        around(column, columns).map(move |x| (y * columns + x, weight(x, column) * weight(y, row)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{mix, stream, unit};

    /// Returns a number in (0, 1) of a stream.
    fn uniform(key: u64, index: u64) -> f64 {
        (f64::from(unit(stream(mix(key), index) as u32)) + 1e-8).min(1.0)
    }

    /// Returns the fraction of 4000 estimates, with `probes` probes of 64 pixels each, whose bound
    /// holds, and their mean error.
    fn coverage(probes: u64, squared: impl Fn(u64, u64) -> f64, truth: f64) -> (f64, f64) {
        const RUNS: u64 = 4000;
        let pixels = probes * 64;
        let mean = Estimate { value: 1.0, ..Estimate::default() };
        let (mut held, mut sum) = (0, 0.0);
        for run in 0..RUNS {
            let readings = (0..probes).map(|probe| Reading {
                weight: 64.0,
                radiance: 0.0,
                squared: squared(run, probe),
                independent: 0.0,
            });
            let terms = readings.map(|reading| Estimate::of_squared(&reading));
            let total = terms.fold(Estimate::default(), Add::add);
            let squared = SquaredError { all: total, expected: 0.0 };
            held += u64::from(Noise::new(squared, pixels, mean).bound.powi(2) >= truth);
            sum += total.value / pixels as f64;
        }
        (held as f64 / RUNS as f64, sum / RUNS as f64)
    }

    /// Returns half the squared difference of two Gaussians of variance 1, by Box and Muller.
    fn gaussian(run: u64, probe: u64) -> f64 {
        let key = run << 32 | probe;
        let (u, v) = (uniform(key, 0), uniform(key, 1));
        -2.0 * u.ln() * (std::f64::consts::TAU * v).cos().powi(2)
    }

    #[test]
    fn bounds_hold_for_gaussian_errors() {
        for probes in [32, 128, 1024] {
            let (held, mean) = coverage(probes, gaussian, 1.0);
            assert!(held > 0.97, "{probes}: {held}");
            assert!((mean - 1.0).abs() < 5.0 * (2.0 / (4000.0 * probes as f64)).sqrt(), "{mean}");
        }
    }

    #[test]
    fn bounds_hold_for_rare_and_for_heavy_errors() {
        // One pixel in thirty has all the noise.
        let rare = |run: u64, probe: u64| {
            let key = 1 << 60 | run << 32 | probe;
            if uniform(key, 2) < 1.0 / 30.0 { 30.0 * gaussian(run, probe) } else { 0.0 }
        };
        let (held, _) = coverage(1024, rare, 1.0);
        assert!(held > 0.95, "rare: {held}");
        // Variances that are log-normal of deviation 1.5, mean e^(1.125).
        let heavy = |run: u64, probe: u64| {
            let key = 1 << 61 | run << 32 | probe;
            let normal = (-2.0 * uniform(key, 2).ln()).sqrt()
                * (std::f64::consts::TAU * uniform(key, 3)).cos();
            (1.5 * normal).exp() * gaussian(run, probe)
        };
        let (held, _) = coverage(1024, heavy, 1.125_f64.exp());
        assert!(held > 0.95, "heavy: {held}");
    }

    #[test]
    fn a_picture_without_error_has_none_whatever_its_brightness() {
        let nothing = Estimate::default();
        let exact = Noise::new(SquaredError::default(), 5, nothing);
        assert_eq!(exact, Noise { error: 0.0, bound: 0.0, expected: 0.0 });
        let squared = SquaredError { all: Estimate { value: 1.0, ..nothing }, expected: 0.5 };
        let dim = Noise::new(squared, 4, nothing);
        let (error, bound) = (f64::INFINITY, f64::INFINITY);
        assert_eq!(dim, Noise { error, bound, expected: 0.5 });
    }

    #[test]
    fn neighbors_are_those_of_the_grid() {
        let all = |tile| neighbors(tile, 3, 6).map(|(at, _)| at).collect::<Vec<_>>();
        assert_eq!(all(0), [0, 1, 3, 4]);
        assert_eq!(all(4), [0, 1, 2, 3, 4, 5]);
        assert_eq!(neighbors(0, 1, 1).collect::<Vec<_>>(), [(0, 4.0)]);
    }

    #[test]
    fn neighbors_weigh_less_than_the_middle() {
        let weights = neighbors(4, 3, 6).map(|(_, weight)| weight);
        assert_eq!(weights.collect::<Vec<_>>(), [1.0, 2.0, 1.0, 2.0, 4.0, 2.0]);
    }

    #[test]
    fn the_bound_adds_the_relative_variances_of_error_and_mean() {
        let estimate = |value, variance| Estimate { value, variance, third: 0.0 };
        let squared = SquaredError { all: estimate(4.0, 1.0), expected: 0.0 };
        let noise = Noise::new(squared, 4, estimate(2.0, 0.5));
        assert_eq!(noise.error, 0.5);
        let variance: f64 = 1.0 / 16.0 + 4.0 * 0.5 / 4.0;
        let bound = 0.25 * (1.0 + DEVIATIONS * variance.sqrt());
        assert!((noise.bound.powi(2) - bound).abs() < 1e-12, "{}", noise.bound);
    }

    #[test]
    fn estimates_are_pooled_by_their_variances() {
        let estimate = |value, variance| Estimate { value, variance, third: 0.0 };
        assert_eq!(estimate(1.0, 1.0).combined_with(estimate(5.0, 3.0)), estimate(2.0, 0.75));
        assert_eq!(estimate(1.0, 0.0).combined_with(estimate(5.0, 3.0)), estimate(1.0, 0.0));
    }
}
