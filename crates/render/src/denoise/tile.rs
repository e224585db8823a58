//! Denoising of a tile: predictions, their errors, and the choice among them.

use super::box_sums::BoxSums;
use super::columns::{Columns, MARGIN, ORIGIN, STRIDE};
use super::observations::{IRRADIANCE, index};
use super::regression::{
    Prediction, RADII, SQUARE, SQUARES_RADIUS, WINDOWS, load, pixels, predict, predict_by_squares,
};
use crate::film::Region;
use crate::image::Image;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask};
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
    /// Sum of the errors of the best choice.
    chosen: Vec<f32>,
    /// Sum of the weights of errors.
    weights: Vec<f32>,
    boxes: BoxSums,
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
        self.columns.fill(input, tile);
        self.predict(input.floor * FLOOR, tile);
        self.choose();
        self.blend(input, tile)
    }

    /// Computes predictions and errors of the tile's pixels and those around it.
    fn predict(&mut self, floor: f32, tile: Region) {
        let count = STRIDE * self.columns.rows;
        let all = self.predictions.iter_mut().flatten().chain(&mut self.errors);
        for column in all.chain([&mut self.scale]) {
            column.resize(count, 0.0);
        }
        let first = ORIGIN - BORDER * STRIDE - BORDER;
        for row in 0..tile.height as usize + 2 * BORDER {
            for column in (0..tile.width as usize + 2 * BORDER).step_by(MAX_LANES) {
                self.predict_row::<F32x16>(floor, first + row * STRIDE + column);
            }
        }
    }

    /// Does the same for a row of lanes.
    #[inline(always)]
    fn predict_row<L: Lanes>(&mut self, floor: f32, at: usize) {
        let columns = &self.columns;
        let albedo: [L; 3] = load(&columns.albedo, at);
        let irradiance: [L; 3] = columns.pixels.at(index(at)).columns(IRRADIANCE);
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
        let weight = L::load(&columns.weight[at..]) / scale;
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
        for (sums, errors) in self.sums.iter_mut().zip(&self.errors) {
            self.boxes.add(errors, STRIDE, ERROR_RADIUS, sums);
        }
        self.boxes.add(&self.columns.weight, STRIDE, ERROR_RADIUS, &mut self.weights);
        let count = self.weights.len();
        self.best.iter_mut().chain([&mut self.chosen]).for_each(|column| column.resize(count, 0.0));
        for at in (0..count).step_by(MAX_LANES) {
            self.choose_row::<F32x16>(at);
        }
        for (shares, best) in self.sums.iter_mut().zip(&self.best) {
            self.boxes.add(best, STRIDE, CHOICE_RADIUS, shares);
        }
    }

    /// Finds that of the pixels from `at` on, one in each lane.
    #[inline(always)]
    fn choose_row<L: Lanes>(&mut self, at: usize) {
        let sums: [L; CHOICES] = load(&self.sums, at);
        let mut handicapped = sums;
        let mut least = L::splat(f32::INFINITY);
        for (sum, kept) in handicapped.iter_mut().zip(KEPT) {
            *sum = *sum + L::splat(CAUTION * kept) * sums[0];
            least = Lanes::min(*sum, least);
        }
        let (mut open, mut chosen) = (L::splat(1.0), L::splat(0.0));
        // The first of equals.
        for ((best, sum), handicapped) in self.best.iter_mut().zip(sums).zip(handicapped) {
            let share = L::select(Lanes::le(handicapped, least), open, L::splat(0.0));
            open = open - share;
            chosen = chosen + share * sum;
            share.store(&mut best[at..]);
        }
        chosen.store(&mut self.chosen[at..]);
    }

    /// Blends the choices of neighbors, so that they leave no edges.
    fn blend(&self, input: &Input, tile: Region) -> Vec<([f32; 3], f32)> {
        let mut pixels = Vec::with_capacity((tile.width * tile.height) as usize);
        for row in 0..tile.height as usize {
            let first = (tile.y as usize + row) * input.image.width as usize + tile.x as usize;
            let originals = &input.image.pixels[first..][..tile.width as usize];
            let first = ORIGIN + row * STRIDE;
            for (at, originals) in (first..).step_by(MAX_LANES).zip(originals.chunks(MAX_LANES)) {
                let (blended, are_kept) = self.blend_row::<F32x16>(at);
                let mut rows = [[0.0; MAX_LANES]; 4];
                for (row, column) in rows.iter_mut().zip(blended) {
                    column.store(row);
                }
                pixels.extend(originals.iter().enumerate().map(|(lane, original)| {
                    let [red, green, blue, error] = rows.each_ref().map(|row| row[lane]);
                    let is_kept = (are_kept >> lane) & 1 == 1;
                    (if is_kept { *original } else { [red, green, blue] }, error)
                }));
            }
        }
        pixels
    }

    /// Returns radiance and squared error of the pixels from `at` on, one in each lane, and the bits of those that stay as
    /// they are.
    #[inline(always)]
    fn blend_row<L: Lanes>(&self, at: usize) -> ([L; 4], u32) {
        let columns = &self.columns;
        let zero = L::splat(0.0);
        let all = L::splat(((2 * CHOICE_RADIUS + 1) * (2 * CHOICE_RADIUS + 1)) as f32);
        let shares: [L; CHOICES] = load(&self.sums, at);
        let albedo: [L; 3] = load(&columns.albedo, at);
        let irradiance: [L; 3] = columns.pixels.at(index(at)).columns(IRRADIANCE);
        let usual: [L; 3] = load(&self.predictions[0], at);
        let outlier = outlier_share(columns, usual, at);
        let outlier = L::select(Lanes::lt(zero, shares[0]), outlier, zero);
        let [error, chosen, weights] =
            [&self.scale, &self.chosen, &self.weights].map(|column| L::load(&column[at..]));
        let error = Lanes::max(chosen / (L::splat(3.0) * weights) * error, zero);
        let mut blended = [error; 4];
        for channel in 0..3 {
            let own = irradiance[channel];
            let usual = Lanes::max(usual[channel], zero);
            let mut mixed = shares[0] * outlier.mul_add(usual - own, own);
            for (share, prediction) in shares[1..].iter().zip(&self.predictions) {
                mixed = mixed + *share * Lanes::max(L::load(&prediction[channel][at..]), zero);
            }
            blended[channel] = mixed / all * albedo[channel];
        }
        let are_kept = Lanes::le(all, shares[0]) & Lanes::le(outlier, zero);
        (blended, are_kept.bits())
    }
}

/// Returns the share that a prediction has in the values of pixels that keep their own otherwise: that of its difference
/// that its noise explains, if the pixel is less reliable than its neighbors. It vanishes as samples grow.
#[inline(always)]
fn outlier_share<L: Lanes>(columns: &Columns, prediction: [L; 3], at: usize) -> L {
    let (mut noise, mut change) = (L::splat(0.0), L::splat(f32::MIN_POSITIVE));
    let [albedo, variance]: [[L; 3]; 2] = [load(&columns.albedo, at), load(&columns.variance, at)];
    let irradiance: [L; 3] = columns.pixels.at(index(at)).columns(IRRADIANCE);
    for channel in 0..3 {
        let squared = albedo[channel] * albedo[channel];
        let difference = prediction[channel] - irradiance[channel];
        noise = noise + squared * variance[channel];
        change = change + squared * (difference * difference);
    }
    let explained = Lanes::min(L::splat(OUTLIER_VARIANCES) * noise / change, L::splat(1.0));
    (L::splat(1.0) - L::load(&columns.weight[at..])) * explained
}

const _: () = assert!((TILE[0] as usize + 2 * BORDER).is_multiple_of(MAX_LANES));
const _: () = assert!(BORDER + SQUARES_RADIUS * SQUARE + SQUARE / 2 + 3 <= MARGIN[1]);
