//! Columns of a tile's pixels and of those around it, for the regression.

use crate::Input;
use crate::box_sums::BoxSums;
use crate::observations::{
    ALBEDO, COLUMNS, COVERAGE, DEVIATION, DEVIATIONS, FEATURES, ID, INSIDE, IRRADIANCE, MEAN,
    MEAN_VARIANCE, OBSERVED, VARIANCE, WEIGHT,
};
use crate::regression::{REACH, SQUARE};
use crate::rows::{MARGIN, Row, Rows, STRIDE};
use crate::similarity::Similarities;
use spherule_transport::film::Region;
use spherule_transport::lanes::{F32x16, Lanes, MAX_LANES};
use std::ops::Range;

/// Number of rows that are kept: those between the first whose squares a prediction needs and the last whose deviation the
/// weights of such squares need.
pub(crate) const KEPT: usize = 32;

/// Least albedo that radiance is divided by: darker surfaces reflect too little light for a ratio.
const MIN_ALBEDO: f32 = 0.02;

/// Variance at which a pixel has half of the weight, as a multiple of the squared mean deviation of its neighbors.
/// Pixels of much more variance are rare paths of much light, which would show as stains.
const OUTLIERS: f32 = 16.0;

/// Edge of the squares over which the deviation of neighbors is averaged.
const DEVIATION_EDGE: usize = 7;

/// Pixels of a tile and its margins, from row to row. Pixels outside of the image have no weight.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    pub(crate) pixels: Rows<COLUMNS, KEPT>,
    /// Means over the squares of [`SQUARE`] pixels around each pixel, and the sphere in the middle; where there is noise.
    pub(crate) squares: Rows<OBSERVED, KEPT>,
    /// Similarities of pixels to their neighbors, where there is noise.
    pub(crate) similarities: Similarities,
    /// The row after the last whose weights are known.
    weighed: usize,
    /// The row after the last whose squares are known.
    averaged: usize,
    around: BoxSums<2, DEVIATION_EDGE>,
    over_squares: BoxSums<{ WEIGHT + 1 }, SQUARE>,
}

impl Columns {
    /// Forgets all rows, for another tile.
    pub(crate) fn begin(&mut self) {
        self.weighed = 0;
        self.averaged = 0;
        self.around.begin();
        self.over_squares.begin();
        self.similarities.begin();
    }

    /// Makes known what the predictions of row `y` need.
    pub(crate) fn advance(&mut self, input: &Input, tile: Region, y: usize) {
        let reach = REACH + SQUARE / 2;
        let end = y + reach + 1;
        for row in self.weighed.max(y - reach)..end {
            self.weigh(input, tile, row);
        }
        self.weighed = end;
        // Deviations are not negative.
        if self.pixels.row(y)[DEVIATIONS].iter().any(|&sum| sum > 0.0) {
            self.similarities.measure(y, &self.pixels);
            let end = y + REACH + 1;
            for row in self.averaged.max(y - REACH)..end {
                self.average(row);
            }
            self.averaged = end;
        }
    }

    /// Computes the weights of a row, by the deviation of each pixel beside that of its neighbors.
    fn weigh(&mut self, input: &Input, tile: Region, y: usize) {
        let pixels = &mut self.pixels;
        let read = |y: usize, out: &mut Row<2>| {
            let row = pixels.row_mut(y);
            read_row(input, tile, y, row);
            *out = [row[DEVIATION], row[INSIDE]];
        };
        let mut sums = [[0.0; STRIDE]; 2];
        self.around.add(y, read, &mut sums);
        let row = self.pixels.row_mut(y);
        for (x, (&sum, &count)) in sums[0].iter().zip(&sums[1]).enumerate() {
            let usual = sum / count.max(1.0);
            let usual = OUTLIERS * usual * usual + f32::MIN_POSITIVE;
            let deviation = row[DEVIATION][x];
            row[WEIGHT][x] = row[INSIDE][x] * usual / (usual + deviation * deviation);
        }
        row[DEVIATIONS] = sums[0];
    }

    /// Computes the means over the squares of a row. The pixels of a square count by their weights, and the square has their
    /// mean weight.
    fn average(&mut self, y: usize) {
        let pixels = &self.pixels;
        let multiply = |y: usize, products: &mut Row<{ WEIGHT + 1 }>| {
            let row = pixels.row(y);
            let weights = &row[WEIGHT];
            for (products, values) in products.iter_mut().zip(row).take(WEIGHT) {
                let factors = values.iter().zip(weights);
                for (product, (value, weight)) in products.iter_mut().zip(factors) {
                    *product = value * weight;
                }
            }
            products[WEIGHT] = *weights;
        };
        let squares = self.squares.row_mut(y);
        let sums = squares.first_chunk_mut().expect("weights come before spheres");
        self.over_squares.add(y, multiply, sums);
        let (sums, weights) = sums.split_at_mut(WEIGHT);
        for sums in sums {
            for (sum, weight) in sums.iter_mut().zip(&weights[0]) {
                *sum /= weight.max(f32::MIN_POSITIVE);
            }
        }
        for weight in &mut weights[0] {
            *weight /= (SQUARE * SQUARE) as f32;
        }
        squares[ID] = pixels.row(y)[ID];
    }
}

/// Reads a row of the image, and what is around it.
fn read_row(input: &Input, tile: Region, y: usize, row: &mut Row<COLUMNS>) {
    let (width, height) = (input.image.width as usize, input.image.height as usize);
    // The column of the image's first pixels, which may be left of all.
    let left = MARGIN[0] as isize - tile.x as isize;
    let pixel_of = |column: isize| (column - left).clamp(0, width as isize) as usize;
    let y = (y + tile.y as usize).checked_sub(MARGIN[1]).filter(|&y| y < height);
    for first in (0..STRIDE).step_by(MAX_LANES) {
        let from = pixel_of(first as isize);
        let to = y.map_or(from, |_| pixel_of((first + MAX_LANES) as isize));
        let lane = (from as isize + left - first as isize) as usize;
        let y = y.unwrap_or(0);
        let gathered = gather(input, y * width + from..y * width + to, lane);
        set::<F32x16>(row, first, &gathered);
    }
}

/// Sets the pixels of a row from `x` on, one in each lane.
#[inline(always)]
fn set<L: Lanes>(row: &mut Row<COLUMNS>, x: usize, gathered: &Gathered) {
    let load = |column: &[f32; MAX_LANES]| L::load(column);
    for (feature, column) in gathered.features.iter().zip(&mut *row) {
        load(feature).store(&mut column[x..]);
    }
    load(&gathered.id).store(&mut row[ID][x..]);
    load(&gathered.inside).store(&mut row[INSIDE][x..]);
    let coverage = load(&gathered.features[COVERAGE]);
    let (mut mean, mut mean_variance) = (L::splat(0.0), L::splat(0.0));
    for channel in 0..3 {
        let albedo = load(&gathered.albedo[channel]) + L::splat(1.0) - coverage;
        let albedo = Lanes::max(albedo, L::splat(MIN_ALBEDO));
        let light = load(&gathered.radiance[channel]) / albedo;
        let variance = load(&gathered.variance[channel]) / (albedo * albedo);
        mean = mean + light;
        mean_variance = mean_variance + variance;
        light.store(&mut row[IRRADIANCE + channel][x..]);
        albedo.store(&mut row[ALBEDO + channel][x..]);
        variance.store(&mut row[VARIANCE + channel][x..]);
    }
    let [mean, mean_variance] = [mean, mean_variance].map(|sum| sum / L::splat(3.0));
    mean.store(&mut row[MEAN][x..]);
    mean_variance.store(&mut row[MEAN_VARIANCE][x..]);
    mean_variance.sqrt().store(&mut row[DEVIATION][x..]);
}

/// Pixels of the image, one in each lane; those outside of it are 0.
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
const _: () =
    assert!(2 * (REACH + SQUARE / 2) + 1 + DEVIATION_EDGE / 2 <= KEPT, "rows are overwritten");
