//! Columns of a tile's pixels and of those around it, for the regression.

use super::regression::{REGRESSORS, SQUARE};
use super::similarity::{Pixels, Similarities};
use super::tile::Input;
use crate::film::Region;
use crate::lanes::{Lanes, Mask};
use crate::layers::Features;

/// Columns and rows of pixels around a tile that its result depends on, and a few columns more, so that rows of lanes
/// fit.
pub(super) const MARGIN: [usize; 2] = [20, 17];

/// Least albedo that radiance is divided by: darker surfaces reflect too little light for a ratio.
const MIN_ALBEDO: f32 = 0.02;

/// Variance at which a pixel has half of the weight, as a multiple of the squared mean deviation of its neighbors.
/// Pixels of much more variance are rare paths of much light, which would show as stains.
const OUTLIERS: f32 = 16.0;

/// Distance within which the deviation of neighbors is averaged.
const DEVIATION_RADIUS: usize = 3;

/// Observations that regressions are fitted to: of pixels, or of squares of pixels.
#[derive(Debug, Default)]
pub(super) struct Observations {
    /// Normal and coverage.
    pub(super) features: [Vec<f32>; REGRESSORS - 1],
    /// Mean radiance over albedo.
    pub(super) irradiance: [Vec<f32>; 3],
    /// Reliability: 0 outside of the picture, 1 without noise.
    pub(super) weight: Vec<f32>,
}

/// Pixels of a tile and its margins, row by row. Pixels outside of the picture have no weight.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// Number of pixels in a row, margins included.
    pub(super) stride: usize,
    pub(super) rows: usize,
    pub(super) pixels: Observations,
    /// Means over the squares of [`SQUARE`] pixels around each pixel, if there is any noise.
    pub(super) squares: Observations,
    /// Similarities of pixels to their neighbors, if there is any noise.
    pub(super) similarities: Similarities,
    /// The sphere at the pixel's center.
    pub(super) id: Vec<f32>,
    /// Mean albedo; 1 for the background, whose radiance is its color.
    pub(super) albedo: [Vec<f32>; 3],
    /// Variance of the irradiance.
    pub(super) variance: [Vec<f32>; 3],
    /// Means over channels of irradiance and of its variance.
    mean: [Vec<f32>; 2],
    /// Standard deviation over channels.
    deviation: Vec<f32>,
    /// Number of pixels: 1 inside of the picture.
    inside: Vec<f32>,
    /// Sums of deviations and of pixels around each pixel.
    sums: [Vec<f32>; 2],
    /// One column of the pixels' observations, times their weights.
    products: Vec<f32>,
    scratch: Vec<f32>,
}

impl Columns {
    /// Returns the index of a tile's first pixel.
    pub(super) fn origin(&self) -> usize {
        MARGIN[1] * self.stride + MARGIN[0]
    }

    /// Returns the index of the pixel this many columns and rows away.
    #[inline(always)]
    pub(super) fn neighbor(&self, at: usize, [x, y]: [isize; 2]) -> usize {
        at.wrapping_add_signed(y * self.stride as isize + x)
    }

    /// Returns whether there is any noise around the pixels from `at` on, one in each lane.
    #[inline(always)]
    pub(super) fn has_noise<L: Lanes>(&self, at: usize) -> bool {
        Lanes::lt(L::splat(0.0), L::load(&self.sums[0][at..])).bits() != 0
    }

    /// Fills the columns with the pixels of a tile, at most `width` wide, and those around it.
    pub(super) fn fill(&mut self, input: &Input, tile: Region, width: usize) {
        (self.stride, self.rows) = (width + 2 * MARGIN[0], tile.height as usize + 2 * MARGIN[1]);
        let count = self.stride * self.rows;
        let Observations { features, irradiance, weight } = &mut self.pixels;
        let columns = [&mut self.id, weight, &mut self.deviation, &mut self.inside];
        let columns = columns.into_iter().chain(features).chain(&mut self.albedo);
        let columns = columns.chain(irradiance).chain(&mut self.variance);
        for column in columns.chain(&mut self.mean) {
            column.clear();
            column.resize(count, 0.0);
        }
        let (image_width, image_height) = (input.image.width as usize, input.image.height as usize);
        let (left, top) = (tile.x as usize, tile.y as usize);
        let columns = left.saturating_sub(MARGIN[0])..(left + width + MARGIN[0]).min(image_width);
        let rows = top.saturating_sub(MARGIN[1])..(top + self.rows - MARGIN[1]).min(image_height);
        for y in rows {
            for x in columns.clone() {
                let at = (y + MARGIN[1] - top) * self.stride + x + MARGIN[0] - left;
                self.set(at, input, y * image_width + x);
            }
        }
        self.weigh();
        if self.variance.iter().flatten().any(|&variance| variance > 0.0) {
            self.compare();
            self.average();
        }
    }

    /// Sets pixel `at` to that of the picture.
    fn set(&mut self, at: usize, input: &Input, pixel: usize) {
        let features: &Features = &input.features[pixel];
        let [x, y, z] = features.normal;
        for (column, feature) in self.pixels.features.iter_mut().zip([x, y, z, features.coverage]) {
            column[at] = feature;
        }
        // Compared by its bits only.
        self.id[at] = f32::from_bits(features.id);
        let (mut irradiance, mut sum) = (0.0, 0.0);
        for channel in 0..3 {
            let albedo = (features.albedo[channel] + 1.0 - features.coverage).max(MIN_ALBEDO);
            let variance = input.variance.pixels[pixel][channel] / (albedo * albedo);
            self.albedo[channel][at] = albedo;
            let light = input.image.pixels[pixel][channel] / albedo;
            self.pixels.irradiance[channel][at] = light;
            self.variance[channel][at] = variance;
            irradiance += light;
            sum += variance;
        }
        (self.mean[0][at], self.mean[1][at]) = (irradiance / 3.0, sum / 3.0);
        self.deviation[at] = (sum / 3.0).sqrt();
        self.inside[at] = 1.0;
    }

    /// Computes the weights, by the deviation of each pixel beside that of its neighbors.
    fn weigh(&mut self) {
        let [deviation, count] = &mut self.sums;
        for (sums, values) in [(&mut *deviation, &self.deviation), (&mut *count, &self.inside)] {
            box_sums(values, self.stride, DEVIATION_RADIUS, sums, &mut self.scratch);
        }
        let around = deviation.iter().zip(count.iter());
        let pixels = self.inside.iter().zip(&self.deviation).zip(around);
        let weights = &mut self.pixels.weight;
        for (weight, ((&inside, &deviation), (&sum, &count))) in weights.iter_mut().zip(pixels) {
            let usual = sum / count.max(1.0);
            let usual = OUTLIERS * usual * usual + f32::MIN_POSITIVE;
            *weight = inside * usual / (usual + deviation * deviation);
        }
    }

    /// Computes the similarities of pixels.
    fn compare(&mut self) {
        let [mean, variance] = &self.mean;
        let inside = &self.inside;
        self.similarities.measure(Pixels { stride: self.stride, mean, variance, inside });
    }

    /// Computes the means over squares. The pixels of a square count by their weights, and the square has their mean weight.
    fn average(&mut self) {
        let Self { pixels, squares, products, scratch, stride, .. } = self;
        box_sums(&pixels.weight, *stride, SQUARE / 2, &mut squares.weight, scratch);
        let columns = pixels.features.iter().chain(&pixels.irradiance);
        let means = squares.features.iter_mut().chain(&mut squares.irradiance);
        for (column, mean) in columns.zip(means) {
            products.clear();
            products
                .extend(column.iter().zip(&pixels.weight).map(|(value, weight)| value * weight));
            box_sums(products, *stride, SQUARE / 2, mean, scratch);
            for (mean, weight) in mean.iter_mut().zip(&squares.weight) {
                *mean /= weight.max(f32::MIN_POSITIVE);
            }
        }
        squares.weight.iter_mut().for_each(|weight| *weight /= (SQUARE * SQUARE) as f32);
    }
}

/// Computes the sums over squares of `2 radius + 1` pixels, of rows of `stride` pixels. Those nearer than `radius` to a
/// side are undefined.
pub(super) fn box_sums(
    values: &[f32],
    stride: usize,
    radius: usize,
    sums: &mut Vec<f32>,
    scratch: &mut Vec<f32>,
) {
    add_shifted(values, radius, 1, scratch);
    add_shifted(scratch, radius, stride, sums);
}

/// Number of sums that are computed at once: few enough that they stay in the first-level cache.
const BLOCK: usize = 1024;

/// Computes the sums of `2 radius + 1` values, each `step` apart. At the ends, where there are fewer, they are 0.
fn add_shifted(values: &[f32], radius: usize, step: usize, sums: &mut Vec<f32>) {
    let span = 2 * radius * step;
    sums.resize(values.len(), 0.0);
    let Some(count) = values.len().checked_sub(span) else {
        sums.fill(0.0);
        return;
    };
    let (before, rest) = sums.split_at_mut(radius * step);
    let (inner, after) = rest.split_at_mut(count);
    before.fill(0.0);
    after.fill(0.0);
    for (first, block) in (0..).step_by(BLOCK).zip(inner.chunks_mut(BLOCK)) {
        block.copy_from_slice(&values[first..first + block.len()]);
        for shift in 1..=2 * radius {
            let shifted = &values[first + shift * step..];
            block.iter_mut().zip(shifted).for_each(|(sum, value)| *sum += value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_sums_are_those_of_squares() {
        let (stride, rows) = (90, 24);
        let values: Vec<f32> = (0..stride * rows).map(|i| (i * i % 17) as f32).collect();
        let (mut sums, mut scratch) = (Vec::new(), Vec::new());
        for radius in [0, 1, 3] {
            box_sums(&values, stride, radius, &mut sums, &mut scratch);
            for (y, x) in
                (radius..rows - radius).flat_map(|y| (radius..stride - radius).map(move |x| (y, x)))
            {
                let window = (y - radius..=y + radius)
                    .flat_map(|v| values[v * stride + x - radius..=v * stride + x + radius].iter());
                assert_eq!(sums[y * stride + x], window.sum::<f32>(), "{radius} {x} {y}");
            }
        }
    }
}
