//! Denoising of a tile: predictions, their errors, and the choice among them.

use super::columns::{Columns, MARGIN, box_sums};
use super::regression::{
    Prediction, RADII, SQUARE, SQUARES_RADIUS, WINDOWS, load, pixels, predict, predict_by_squares,
};
use crate::film::Region;
use crate::image::Image;
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::layers::Features;

/// Size of a tile. Predictions are also needed for [`BORDER`] pixels around it, which together fill rows of lanes.
pub(super) const TILE: [u32; 2] = [120, 64];

/// Distance within which errors are averaged before the choice, and choices after it.
const ERROR_RADIUS: usize = 3;
const CHOICE_RADIUS: usize = 1;

/// Distance of the pixels whose predictions a tile needs.
const BORDER: usize = ERROR_RADIUS + CHOICE_RADIUS;

/// Fraction of the picture's mean square that is added to the square of radiance in relative errors.
const FLOOR: f32 = 0.3;

/// Squared difference from the prediction that noise explains, in variances of the pixel.
const OUTLIER_VARIANCES: f32 = 4.0;

/// Number of choices: the pixel itself, and the prediction of each window.
const CHOICES: usize = 1 + WINDOWS;

/// Fraction of the pixel's variance by which a choice is handicapped, times the noise that it keeps: estimated errors are
/// uncertain, and noise that stays shows more than a little blur.
const CAUTION: f32 = 1.0;

/// Fraction of the variance that each choice keeps: that of a mean over its pixels.
const KEPT: [f32; CHOICES] = [
    1.0,
    1.0 / pixels(RADII[0]) as f32,
    1.0 / pixels(RADII[1]) as f32,
    1.0 / (SQUARE * SQUARE * pixels(SQUARES_RADIUS)) as f32,
];

/// The picture that is denoised.
pub(super) struct Input<'a> {
    pub(super) image: &'a Image,
    /// Variance of each pixel's mean.
    pub(super) variance: &'a Image,
    pub(super) features: &'a [Features],
    /// Mean square of the radiance.
    pub(super) floor: f32,
}

/// Columns of a tile and its margins.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    columns: Columns,
    /// Irradiance by each window.
    predictions: [[Vec<f32>; 3]; WINDOWS],
    /// Relative squared error of each choice, times the pixel's weight.
    errors: [Vec<f32>; CHOICES],
    /// Their sums over neighbors.
    sums: [Vec<f32>; CHOICES],
    /// The square that relative errors are relative to.
    scale: Vec<f32>,
    /// For each choice, 1 where it is the best.
    best: [Vec<f32>; CHOICES],
    /// Least sum of errors, handicaps included.
    least: Vec<f32>,
    /// Sum of the errors of the best choice.
    chosen: Vec<f32>,
    /// Sum of the weights of errors.
    weights: Vec<f32>,
    scratch: Vec<f32>,
}

/// Returns the tiles of a picture.
pub(super) fn tiles(width: u32, height: u32) -> impl Iterator<Item = Region> {
    let steps = |count: u32, size: u32| {
        (0..count).step_by(size as usize).map(move |from| (from, size.min(count - from)))
    };
    steps(height, TILE[1]).flat_map(move |(y, height)| {
        steps(width, TILE[0]).map(move |(x, width)| Region { x, y, width, height })
    })
}

impl Workspace {
    /// Returns radiance and squared error of a tile's pixels, row by row.
    pub(super) fn denoise(&mut self, input: &Input, tile: Region) -> Vec<([f32; 3], f32)> {
        self.columns.fill(input, tile, TILE[0] as usize);
        self.predict(input.floor * FLOOR, tile);
        self.choose();
        self.blend(input, tile)
    }

    /// Computes predictions and errors of the tile's pixels and those around it.
    fn predict(&mut self, floor: f32, tile: Region) {
        let count = self.columns.stride * self.columns.rows;
        let all = self.predictions.iter_mut().flatten().chain(&mut self.errors);
        for column in all.chain([&mut self.scale]) {
            column.clear();
            column.resize(count, 0.0);
        }
        let first = self.columns.origin() - BORDER * self.columns.stride - BORDER;
        for row in 0..tile.height as usize + 2 * BORDER {
            for column in (0..TILE[0] as usize + 2 * BORDER).step_by(MAX_LANES) {
                self.predict_row::<F32x16>(floor, first + row * self.columns.stride + column);
            }
        }
    }

    /// Does the same for a row of lanes.
    #[inline(always)]
    fn predict_row<L: Lanes>(&mut self, floor: f32, at: usize) {
        let columns = &self.columns;
        let [albedo, irradiance]: [[L; 3]; 2] =
            [load(&columns.albedo, at), load(&columns.pixels.irradiance, at)];
        let variance: [L; 3] = load(&columns.variance, at);
        let predictions = if columns.has_noise::<L>(at) {
            let [near, wide] = predict::<L>(columns, at);
            [near, wide, predict_by_squares(columns, at)]
        } else {
            [Prediction { irradiance, leverage: L::splat(0.0) }; WINDOWS]
        };
        let [_, wide, _] = &predictions;
        let mut scale = L::splat(floor);
        let mut own = L::splat(0.0);
        for channel in 0..3 {
            let radiance = wide.irradiance[channel] * albedo[channel];
            let noise = variance[channel] * albedo[channel] * albedo[channel];
            scale = radiance.mul_add(radiance, scale + noise);
            own = own + noise;
        }
        // Black pictures have no error.
        scale = Lanes::max(scale, L::splat(f32::MIN_POSITIVE));
        scale.store(&mut self.scale[at..]);
        // Rare bright paths would keep themselves: their variance is not that of well-distributed samples.
        let weight = L::load(&columns.pixels.weight[at..]) / scale;
        (weight * own).store(&mut self.errors[0][at..]);
        for (window, Prediction { irradiance: predicted, leverage }) in
            predictions.iter().enumerate()
        {
            let penalty = L::splat(2.0) * *leverage - L::splat(1.0);
            let mut error = L::splat(0.0);
            for channel in 0..3 {
                let squared = albedo[channel] * albedo[channel];
                let change = predicted[channel] - irradiance[channel];
                let risk = change.mul_add(change, penalty * variance[channel]);
                error = squared.mul_add(risk, error);
                predicted[channel].store(&mut self.predictions[window][channel][at..]);
            }
            (weight * error).store(&mut self.errors[1 + window][at..]);
        }
    }

    /// Finds the choice with the least error around each pixel.
    fn choose(&mut self) {
        let stride = self.columns.stride;
        for (sums, errors) in self.sums.iter_mut().zip(&self.errors) {
            box_sums(errors, stride, ERROR_RADIUS, sums, &mut self.scratch);
        }
        let weight = &self.columns.pixels.weight;
        box_sums(weight, stride, ERROR_RADIUS, &mut self.weights, &mut self.scratch);
        let [own, ..] = &self.sums;
        let handicapped = |(sum, own): (&f32, &f32), kept: f32| sum + CAUTION * kept * own;
        self.least.clear();
        self.least.resize(own.len(), f32::INFINITY);
        for (sums, kept) in self.sums.iter().zip(KEPT) {
            let sums = sums.iter().zip(own).map(|row| handicapped(row, kept));
            self.least.iter_mut().zip(sums).for_each(|(least, sum)| *least = least.min(sum));
        }
        let mut open = std::mem::take(&mut self.scratch);
        open.clear();
        open.resize(self.least.len(), 1.0);
        self.chosen.clear();
        self.chosen.resize(self.least.len(), 0.0);
        for ((best, sums), kept) in self.best.iter_mut().zip(&self.sums).zip(KEPT) {
            best.clear();
            // The first of equals.
            let rows = sums.iter().zip(own).zip(&self.least).zip(&mut open).zip(&mut self.chosen);
            best.extend(rows.map(|(((row, least), open), chosen)| {
                let best = if handicapped(row, kept) <= *least { *open } else { 0.0 };
                *open -= best;
                *chosen += best * row.0;
                best
            }));
        }
        self.scratch = open;
    }

    /// Blends the choices of neighbors, so that they leave no edges.
    fn blend(&mut self, input: &Input, tile: Region) -> Vec<([f32; 3], f32)> {
        let Self { columns, sums, best, scratch, .. } = self;
        let stride = columns.stride;
        for (shares, best) in sums.iter_mut().zip(best.iter()) {
            box_sums(best, stride, CHOICE_RADIUS, shares, scratch);
        }
        let all = (2 * CHOICE_RADIUS + 1).pow(2) as f32;
        let mut pixels = Vec::with_capacity((tile.width * tile.height) as usize);
        for row in 0..tile.height as usize {
            let first = columns.origin() + row * stride;
            for at in first..first + tile.width as usize {
                let pixel = (tile.y as usize + row) * input.image.width as usize
                    + tile.x as usize
                    + (at - first);
                let outlier = if sums[0][at] > 0.0 {
                    outlier_share(columns, &self.predictions[0], at)
                } else {
                    0.0
                };
                let radiance = std::array::from_fn(|channel| {
                    if sums[0][at] == all && outlier == 0.0 {
                        return input.image.pixels[pixel][channel];
                    }
                    let own = columns.pixels.irradiance[channel][at];
                    let usual = self.predictions[0][channel][at].max(0.0);
                    let own = sums[0][at] * outlier.mul_add(usual - own, own);
                    let windows = sums[1..].iter().zip(&self.predictions);
                    let mixed = windows.fold(own, |sum, (shares, prediction)| {
                        sum + shares[at] * prediction[channel][at].max(0.0)
                    });
                    mixed / all * columns.albedo[channel][at]
                });
                let error = self.chosen[at] / (3.0 * self.weights[at]) * self.scale[at];
                pixels.push((radiance, error.max(0.0)));
            }
        }
        pixels
    }
}

/// Returns the share that a prediction has in the value of a pixel that keeps its own otherwise: that of its difference
/// that its noise explains, if the pixel is less reliable than its neighbors. It vanishes as samples grow.
fn outlier_share(columns: &Columns, prediction: &[Vec<f32>; 3], at: usize) -> f32 {
    let (mut noise, mut change) = (0.0, f32::MIN_POSITIVE);
    for (channel, prediction) in prediction.iter().enumerate() {
        let squared = columns.albedo[channel][at].powi(2);
        noise += squared * columns.variance[channel][at];
        change += squared * (prediction[at] - columns.pixels.irradiance[channel][at]).powi(2);
    }
    (1.0 - columns.pixels.weight[at]) * (OUTLIER_VARIANCES * noise / change).min(1.0)
}

const _: () = assert!((TILE[0] as usize + 2 * BORDER).is_multiple_of(MAX_LANES));
const _: () = assert!(BORDER + SQUARES_RADIUS * SQUARE + SQUARE / 2 + 3 <= MARGIN[1]);
