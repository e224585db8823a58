//! Filter importance sampling: the position of a sample around its pixel.
//!
//! Samples are distributed by the reconstruction filter instead of being weighted by it, so that all
//! have weight 1 and belong to one pixel: Ernst, Stamminger & Greiner, "Filter Importance Sampling", RT
//! 2006. The filters are products of one profile per axis and never negative.

use super::warp::centered;
use crate::elementary::{cos, exp};
use crate::lanes::F32x16;
use crate::settings::Filter;
use std::f64::consts::FRAC_PI_2;

/// Cells over the radius for the integration of a profile, which counts as constant within each.
const CELLS: usize = 8192;

/// Steps of the table of offsets.
const STEPS: usize = 1024;

/// Half-width of the tabulated filters, in pixels.
const RADIUS: f32 = 2.0;

/// A [`Filter`], prepared for sampling.
#[derive(Clone, Debug)]
pub struct PixelFilter {
    /// `None` for the box filter.
    table: Option<Table>,
}

/// A filter that is not constant.
#[derive(Clone, Debug)]
struct Table {
    offsets: Offsets,
    profile: fn(f64) -> f64,
    /// Integral of the profile over the filter's width.
    mass: f64,
}

/// The inverse of a profile's positive half: row `i` holds the distance beyond which the fraction `w^2`
/// of the mass lies, `w = i / STEPS`. The square root makes the table fine in the tail; linear
/// interpolation between rows changes the variance by less than 2e-5.
type Offsets = Box<[f32; STEPS + 1]>;

impl PixelFilter {
    /// Tabulates a filter.
    pub fn new(filter: Filter) -> Self {
        let table = match filter {
            Filter::Box => None,
            Filter::Gaussian => Some(tabulate(gaussian)),
            Filter::BlackmanHarris => Some(tabulate(blackman_harris)),
        };
        Self { table }
    }

    /// Returns the table of offsets; `None` for the box filter.
    pub fn offsets(&self) -> Option<&[f32]> {
        self.table.as_ref().map(|table| &table.offsets[..])
    }

    /// Returns the offset (dx, dy) from the pixel's center in pixels, for two numbers in [0, 1).
    ///
    /// Each coordinate increases with its draw, so that strata of draws are strata of the filter.
    #[inline]
    pub fn offset(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        match &self.table {
            None => [u - 0.5, v - 0.5],
            Some(Table { offsets, .. }) => [offset(offsets, u), offset(offsets, v)],
        }
    }

    /// [`PixelFilter::offset`] for a row of numbers.
    #[inline(always)]
    pub fn offset_row(&self, row: [F32x16; 2]) -> [F32x16; 2] {
        match &self.table {
            None => row.map(|u| u - F32x16::splat(0.5)),
            Some(Table { offsets, .. }) => {
                row.map(|u| F32x16::new(u.to_array().map(|u| offset(offsets, u))))
            }
        }
    }

    /// Returns the density of [`PixelFilter::offset`] per square pixel.
    pub fn pdf(&self, offset: [f64; 2]) -> f64 {
        let density = |x: f64| match &self.table {
            _ if x.abs() > f64::from(self.radius()) => 0.0,
            None => 1.0,
            Some(Table { profile, mass, .. }) => profile(x) / mass,
        };
        density(offset[0]) * density(offset[1])
    }

    /// Returns the largest absolute offset on either axis, in pixels.
    pub fn radius(&self) -> f32 {
        if self.table.is_some() { RADIUS } else { 0.5 }
    }
}

#[inline]
fn offset(offsets: &Offsets, u: f32) -> f32 {
    let signed = centered(u);
    let w = (1.0 - signed.abs()).sqrt() * STEPS as f32;
    let row = (w as usize).min(STEPS - 1);
    let (outer, inner) = (offsets[row], offsets[row + 1]);
    (outer + (inner - outer) * (w - row as f32)).copysign(signed)
}

/// Integrates a profile over each cell by Simpson's rule, and inverts the cumulative sum.
fn tabulate(profile: fn(f64) -> f64) -> Table {
    let step = f64::from(RADIUS) / CELLS as f64;
    let masses: Vec<f64> = (0..CELLS)
        .map(|cell| cell as f64 * step)
        .map(|x| profile(x) + 4.0 * profile(x + 0.5 * step) + profile(x + step))
        .collect();
    let total: f64 = masses.iter().sum();
    let (mut cell, mut within) = (0, 0.0);
    let mut offsets = Box::new([0.0; STEPS + 1]);
    for (row, offset) in offsets.iter_mut().enumerate().rev() {
        let wanted = total * (1.0 - (row as f64 / STEPS as f64).powi(2));
        while cell + 1 < CELLS && within + masses[cell] <= wanted {
            within += masses[cell];
            cell += 1;
        }
        let part = ((wanted - within) / masses[cell]).clamp(0.0, 1.0);
        *offset = ((cell as f64 + part) * step) as f32;
    }
    // By Simpson's rule, of both halves.
    Table { offsets, profile, mass: 2.0 * total * step / 6.0 }
}

/// A Gaussian with a standard deviation of 0.5 pixels.
fn gaussian(x: f64) -> f64 {
    exp(-2.0 * x * x)
}

/// The four-term window of -92 dB, over a width of 4 pixels: Harris, "On the Use of Windows for
/// Harmonic Analysis with the Discrete Fourier Transform", Proc. IEEE 1978.
fn blackman_harris(x: f64) -> f64 {
    let cosine = |harmonic: f64| cos(harmonic * FRAC_PI_2 * x);
    0.358_75 + 0.488_29 * cosine(1.0) + 0.141_28 * cosine(2.0) + 0.011_68 * cosine(3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::ONE_BELOW;
    use crate::sampling::statistics::{assert_chi_squared, random_pairs};
    use std::f64::consts::PI;

    /// Mean and variance of dx by quadrature over the draw.
    fn moments(filter: Filter) -> (f64, f64) {
        const STEPS: u32 = 1 << 18;
        let filter = PixelFilter::new(filter);
        let offsets = (0..STEPS)
            .map(|i| (i as f32 + 0.5) / STEPS as f32)
            .map(|u| f64::from(filter.offset([u, 0.5])[0]));
        let (sum, squares) = offsets.fold((0.0, 0.0), |(a, b), dx| (a + dx, b + dx * dx));
        let mean = sum / f64::from(STEPS);
        (mean, squares / f64::from(STEPS) - mean * mean)
    }

    #[test]
    fn mean_and_variance_in_closed_form() {
        // Gaussian truncated at 4 standard deviations: 1 - 2 c phi(c) / (2 Phi(c) - 1) of sigma^2, c =
        // 4.
        let gaussian = 0.25 * (1.0 - 8.0 * 1.338_302_257_648_9e-4 / 0.999_936_657_516_3);
        // Second moments of the cosines over -2..2, over the window's area.
        let series = (-0.488_29 + 0.141_28 / 4.0 - 0.011_68 / 9.0) / 0.358_75;
        let blackman_harris = 4.0 / 3.0 + 8.0 / (PI * PI) * series;
        let truths = [
            (Filter::Box, 1.0 / 12.0),
            (Filter::Gaussian, gaussian),
            (Filter::BlackmanHarris, blackman_harris),
        ];
        for (filter, truth) in truths {
            let (mean, variance) = moments(filter);
            assert!(mean.abs() < 1e-6, "{filter:?}: {mean}");
            assert!((variance - truth).abs() < 5e-5, "{filter:?}: {variance}, not {truth}");
        }
    }

    /// Returns the draw at which the filter's table has this row.
    fn draw_of_row(row: u32) -> f32 {
        (1.0 - f64::from(row).powi(2) / f64::from(1 << 21)) as f32
    }

    #[test]
    fn offsets_are_quantiles_of_the_profile() {
        // Quantiles of a normal distribution of deviation 0.5 truncated at 2, by SciPy's `truncnorm`.
        let truths = [
            (100, 1.294_966_137),
            (400, 0.715_131_469),
            (724, 0.337_303_986),
            (1000, 0.029_044_805),
        ];
        let filter = PixelFilter::new(Filter::Gaussian);
        for (row, truth) in truths {
            let [dx, _] = filter.offset([draw_of_row(row), 0.5]);
            assert!((f64::from(dx) - truth).abs() < 3e-6, "{row}: {dx}, not {truth}");
        }
        // The integral of the four terms from the middle on, over the integral of all.
        let below = |x: f64| {
            let sine = |harmonic: f64| (harmonic * FRAC_PI_2 * x).sin() / (harmonic * FRAC_PI_2);
            let terms = 0.488_29 * sine(1.0) + 0.141_28 * sine(2.0) + 0.011_68 * sine(3.0);
            0.5 + (0.358_75 * x + terms) / (4.0 * 0.358_75)
        };
        let filter = PixelFilter::new(Filter::BlackmanHarris);
        for row in [8, 100, 400, 724, 1000] {
            let u = draw_of_row(row);
            let [dx, _] = filter.offset([u, 0.5]);
            let quantile = below(f64::from(dx));
            assert!((quantile - f64::from(u)).abs() < 1e-6, "{row}: {quantile}, not {u}");
        }
    }

    #[test]
    fn rows_of_offsets_are_those_of_their_lanes() {
        for kind in [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris] {
            let filter = PixelFilter::new(kind);
            let us: Vec<[f32; 2]> = random_pairs(16, 4).collect();
            let lanes = [0, 1].map(|axis| F32x16::new(std::array::from_fn(|i| us[i][axis])));
            let rows = filter.offset_row(lanes).map(F32x16::to_array);
            for (lane, u) in us.into_iter().enumerate() {
                assert_eq!(rows.map(|row| row[lane]), filter.offset(u), "{kind:?}");
            }
        }
    }

    #[test]
    fn densities_are_those_of_the_offsets() {
        const STEPS: u32 = 400;
        for kind in [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris] {
            let filter = PixelFilter::new(kind);
            // The area of cells of equal probability times the density in their middle.
            let place = |i: u32| f64::from(filter.offset([i as f32 / STEPS as f32, 0.5])[0]);
            let at = filter.pdf([0.0, 0.0]).sqrt();
            for i in STEPS / 20..STEPS - STEPS / 20 {
                let (low, high) = (place(i), place(i + 1));
                let mass = (high - low) * filter.pdf([low.midpoint(high), 0.0]) / at;
                assert!((mass * f64::from(STEPS) - 1.0).abs() < 2e-3, "{kind:?}, {i}: {mass}");
            }
            assert_eq!(filter.pdf([2.1, 0.0]), 0.0);
        }
    }

    #[test]
    fn the_middle_of_the_draws_is_the_middle_of_the_pixel() {
        // Between the multiples of 2^-24 lies a draw at the very end of the table.
        for kind in [Filter::Gaussian, Filter::BlackmanHarris] {
            assert_eq!(PixelFilter::new(kind).offset([0.5_f32.next_down(); 2]), [0.0; 2]);
        }
    }

    #[test]
    fn offsets_follow_the_profile() {
        for (filter, profile) in [
            (Filter::Box, (|x| f64::from(x.abs() < 0.5)) as fn(f64) -> f64),
            (Filter::Gaussian, gaussian),
            (Filter::BlackmanHarris, blackman_harris),
        ] {
            const CELLS: usize = 40;
            let sampled = PixelFilter::new(filter);
            let mut observed = [vec![0_u64; CELLS], vec![0_u64; CELLS]];
            for u in random_pairs(1_000_000, 21) {
                for (observed, offset) in observed.iter_mut().zip(sampled.offset(u)) {
                    observed[((offset + 2.0) * 10.0) as usize] += 1;
                }
            }
            let mass = |cell: usize| {
                let center = (cell as f64 + 0.5) / 10.0 - 2.0;
                (-8..=8).map(|i| profile(center + f64::from(i) / 170.0)).sum::<f64>()
            };
            let masses: Vec<f64> = (0..CELLS).map(mass).collect();
            let total: f64 = masses.iter().sum();
            let probabilities: Vec<f64> = masses.iter().map(|mass| mass / total).collect();
            for observed in &observed {
                assert_chi_squared(observed, &probabilities);
            }
        }
    }

    #[test]
    fn offsets_stay_within_the_radius_and_rise_with_the_draw() {
        for filter in [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris] {
            let filter = PixelFilter::new(filter);
            let draws = (0..1000).map(|i| i as f32 / 1000.0).chain([ONE_BELOW]);
            let offsets: Vec<f32> = draws.map(|u| filter.offset([u, u])[1]).collect();
            assert!(offsets.is_sorted());
            assert!(offsets.iter().all(|offset| offset.abs() <= filter.radius()));
            assert!(*offsets.last().expect("not empty") > 0.95 * filter.radius());
        }
        assert_eq!(PixelFilter::new(Filter::Box).offset([0.0, 0.5]), [-0.5, 0.0]);
    }
}
