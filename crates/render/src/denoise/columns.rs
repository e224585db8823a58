//! Columns of a tile's pixels and of those around it, for the regression.

use super::box_sums::BoxSums;
use super::observations::{COVERAGE, FEATURES, Observations, PITCH, WEIGHT};
use super::regression::SQUARE;
use super::similarity::{Pixels, Similarities};
use super::tile::{Input, TILE};
use crate::film::Region;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask};
use std::ops::Range;

/// Columns and rows of pixels around a tile that its result depends on, and a few columns more, so that rows of lanes
/// fit.
pub(super) const MARGIN: [usize; 2] = [20, 17];

/// Number of pixels in a row, margins included.
pub(super) const STRIDE: usize = TILE[0] as usize + 2 * MARGIN[0];

/// Index of a tile's first pixel.
pub(super) const ORIGIN: usize = MARGIN[1] * STRIDE + MARGIN[0];

/// Least albedo that radiance is divided by: darker surfaces reflect too little light for a ratio.
const MIN_ALBEDO: f32 = 0.02;

/// Variance at which a pixel has half of the weight, as a multiple of the squared mean deviation of its neighbors.
/// Pixels of much more variance are rare paths of much light, which would show as stains.
const OUTLIERS: f32 = 16.0;

/// Distance within which the deviation of neighbors is averaged.
const DEVIATION_RADIUS: usize = 3;

/// Pixels of a tile and its margins, row by row. Pixels outside of the picture have no weight.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// Number of rows, margins included.
    pub(super) rows: usize,
    pub(super) pixels: Observations,
    /// Means over the squares of [`SQUARE`] pixels around each pixel, if there is any noise.
    pub(super) squares: Observations,
    /// Similarities of pixels to their neighbors, if there is any noise.
    pub(super) similarities: Similarities,
    /// Weight of each pixel, which its observations have, too.
    pub(super) weight: Vec<f32>,
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
    boxes: BoxSums,
}

impl Columns {
    /// Returns whether there is any noise around the pixels from `at` on, one in each lane.
    #[inline(always)]
    pub(super) fn has_noise<L: Lanes>(&self, at: usize) -> bool {
        Lanes::lt(L::splat(0.0), L::load(&self.sums[0][at..])).bits() != 0
    }

    /// Fills the columns with the pixels of a tile and those around it.
    pub(super) fn fill(&mut self, input: &Input, tile: Region) {
        self.rows = tile.height as usize + 2 * MARGIN[1];
        let columns = [&mut self.id, &mut self.deviation, &mut self.inside, &mut self.weight];
        let columns = columns.into_iter().chain(&mut self.albedo).chain(&mut self.variance);
        for column in columns.chain(&mut self.mean) {
            column.resize(self.rows * STRIDE, 0.0);
        }
        self.pixels.values.resize(self.rows * PITCH, 0.0);
        let (width, height) = (input.image.width as usize, input.image.height as usize);
        // The column of the picture's first pixels, which may be left of all.
        let left = MARGIN[0] as isize - tile.x as isize;
        let pixel_of = |column: isize| (column - left).clamp(0, width as isize) as usize;
        for row in 0..self.rows {
            let y = (row + tile.y as usize).checked_sub(MARGIN[1]).filter(|&y| y < height);
            for first in (0..STRIDE).step_by(MAX_LANES) {
                let from = pixel_of(first as isize);
                let to = y.map_or(from, |_| pixel_of((first + MAX_LANES) as isize));
                let lane = (from as isize + left - first as isize) as usize;
                let y = y.unwrap_or(0);
                let gathered = gather(input, y * width + from..y * width + to, lane);
                self.set::<F32x16>(row, first, &gathered);
            }
        }
        self.weigh();
        if self.variance.iter().flatten().any(|&variance| variance > 0.0) {
            self.compare();
            self.average();
        }
    }

    /// Sets the pixels of a row from `first` on, one in each lane.
    #[inline(always)]
    fn set<L: Lanes>(&mut self, row: usize, first: usize, gathered: &Gathered) {
        let at = row * STRIDE + first;
        let load = |column: &[f32; MAX_LANES]| L::load(column);
        let mut observed = self.pixels.row_mut(row).map(|column| &mut column[first..]);
        for (feature, column) in gathered.features.iter().zip(&mut observed) {
            load(feature).store(column);
        }
        load(&gathered.id).store(&mut self.id[at..]);
        load(&gathered.inside).store(&mut self.inside[at..]);
        let coverage = load(&gathered.features[COVERAGE]);
        let (mut mean, mut mean_variance) = (L::splat(0.0), L::splat(0.0));
        for (channel, column) in observed.take(3).enumerate() {
            let albedo = load(&gathered.albedo[channel]) + L::splat(1.0) - coverage;
            let albedo = Lanes::max(albedo, L::splat(MIN_ALBEDO));
            let light = load(&gathered.radiance[channel]) / albedo;
            let variance = load(&gathered.variance[channel]) / (albedo * albedo);
            mean = mean + light;
            mean_variance = mean_variance + variance;
            light.store(column);
            albedo.store(&mut self.albedo[channel][at..]);
            variance.store(&mut self.variance[channel][at..]);
        }
        let [mean, mean_variance] = [mean, mean_variance].map(|sum| sum / L::splat(3.0));
        mean.store(&mut self.mean[0][at..]);
        mean_variance.store(&mut self.mean[1][at..]);
        mean_variance.sqrt().store(&mut self.deviation[at..]);
    }

    /// Computes the weights, by the deviation of each pixel beside that of its neighbors.
    fn weigh(&mut self) {
        let [deviation, count] = &mut self.sums;
        for (sums, values) in [(&mut *deviation, &self.deviation), (&mut *count, &self.inside)] {
            self.boxes.add(values, STRIDE, DEVIATION_RADIUS, sums);
        }
        let around = deviation.iter().zip(count.iter());
        let pixels = self.inside.iter().zip(&self.deviation).zip(around);
        let weights = &mut self.weight;
        for (weight, ((&inside, &deviation), (&sum, &count))) in weights.iter_mut().zip(pixels) {
            let usual = sum / count.max(1.0);
            let usual = OUTLIERS * usual * usual + f32::MIN_POSITIVE;
            *weight = inside * usual / (usual + deviation * deviation);
        }
        for (row, weights) in weights.chunks_exact(STRIDE).enumerate() {
            for column in self.pixels.row_mut(row).skip(WEIGHT) {
                column.copy_from_slice(weights);
            }
        }
    }

    /// Computes the similarities of pixels.
    fn compare(&mut self) {
        let [mean, variance] = &self.mean;
        let inside = &self.inside;
        self.similarities.measure(Pixels { stride: STRIDE, mean, variance, inside });
    }

    /// Computes the means over squares. The pixels of a square count by their weights, and the square has their mean weight.
    fn average(&mut self) {
        let Self { pixels, squares, weight, boxes, .. } = self;
        let multiply = |row: usize, products: &mut [f32]| {
            let columns = products.chunks_exact_mut(STRIDE);
            let weights = &weight[row * STRIDE..][..STRIDE];
            for (products, values) in columns.zip(pixels.row(row)).take(WEIGHT) {
                let factors = values.iter().zip(weights);
                for (product, (value, weight)) in products.iter_mut().zip(factors) {
                    *product = value * weight;
                }
            }
            products[WEIGHT * STRIDE..].copy_from_slice(weights);
        };
        let divide = |sums: &mut [f32]| {
            let (sums, weights) = sums.split_at_mut(WEIGHT * STRIDE);
            for sums in sums.chunks_exact_mut(STRIDE) {
                for (sum, weight) in sums.iter_mut().zip(&*weights) {
                    *sum /= weight.max(f32::MIN_POSITIVE);
                }
            }
            for weight in weights {
                *weight /= (SQUARE * SQUARE) as f32;
            }
        };
        squares.values.resize(pixels.values.len(), 0.0);
        boxes.add_rows(multiply, PITCH, SQUARE / 2, &mut squares.values, divide);
    }
}

/// Pixels of the picture, one in each lane; those outside of it are 0.
#[derive(Default)]
struct Gathered {
    /// Normal and coverage.
    features: [[f32; MAX_LANES]; FEATURES],
    albedo: [[f32; MAX_LANES]; 3],
    radiance: [[f32; MAX_LANES]; 3],
    variance: [[f32; MAX_LANES]; 3],
    /// Compared by its bits only.
    id: [f32; MAX_LANES],
    inside: [f32; MAX_LANES],
}

/// Gathers pixels into lanes, from `lane` on.
#[inline(always)]
fn gather(input: &Input, pixels: Range<usize>, lane: usize) -> Gathered {
    let mut gathered = Gathered::default();
    let [radiance, variance] =
        [input.image, input.variance].map(|image| &image.pixels[pixels.clone()]);
    let rows = input.features[pixels].iter().zip(radiance).zip(variance);
    for (lane, ((features, radiance), variance)) in (lane..MAX_LANES).zip(rows) {
        for axis in 0..3 {
            gathered.features[axis][lane] = features.normal[axis];
            gathered.albedo[axis][lane] = features.albedo[axis];
            gathered.radiance[axis][lane] = radiance[axis];
            gathered.variance[axis][lane] = variance[axis];
        }
        gathered.features[COVERAGE][lane] = features.coverage;
        gathered.id[lane] = f32::from_bits(features.id);
        gathered.inside[lane] = 1.0;
    }
    gathered
}

const _: () = assert!(STRIDE.is_multiple_of(MAX_LANES));
