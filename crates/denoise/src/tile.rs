//! Denoising of a tile: predictions, their errors, and the choice among them.

use crate::Input;
use crate::box_sums::BoxSums;
use crate::columns::Columns;
use crate::observations::{ALBEDO, COLUMNS, DEVIATIONS, IRRADIANCE, VARIANCE, WEIGHT, load};
use crate::regression::{
    Prediction, RADII, REACH, SQUARE, SQUARES_RADIUS, WINDOWS, pixels, predict, predict_by_squares,
};
use crate::rows::{MARGIN, Row, Rows, STRIDE, TILE};
use spherule_transport::film::Region;
use spherule_transport::lanes::{F32x16, Lanes, MAX_LANES, Mask};

/// Edges of the squares over which errors are averaged before the choice, and choices after it.
const ERROR_EDGE: usize = 7;
const CHOICE_EDGE: usize = 3;

/// Distance of the pixels whose predictions a tile needs.
const BORDER: usize = ERROR_EDGE / 2 + CHOICE_EDGE / 2;

/// Fraction of the image's mean square that is added to the square of radiance in relative errors.
const FLOOR: f32 = 0.3;

/// Squared difference from the prediction that noise explains, in variances of the pixel.
const OUTLIER_VARIANCES: f32 = 4.0;

/// Number of choices: the pixel itself, and the prediction of each window.
const CHOICES: usize = 1 + WINDOWS;

/// Fraction of the pixel's variance by which a choice is handicapped, times the noise that it keeps: estimated errors are
/// uncertain, and noise that stays shows more than a little blur.
const CAUTION: f32 = 1.0;

/// Fraction of the variance that each choice keeps: that of a mean over its pixels.
const KEPT_NOISE: [f32; CHOICES] = [
    1.0,
    1.0 / pixels(RADII[0]) as f32,
    1.0 / pixels(RADII[1]) as f32,
    1.0 / (SQUARE * SQUARE * pixels(SQUARES_RADIUS)) as f32,
];

/// Columns of predictions: irradiance by each window, and the square that relative errors are relative to.
const SCALE: usize = 3 * WINDOWS;
const PREDICTED: usize = SCALE + 1;

/// Columns of errors: the relative squared error of each choice, times the pixel's weight, and that weight.
const ERRORS: usize = CHOICES + 1;

/// Rows of predictions that are kept: those of the pixels whose errors are averaged, and one more until it is blended.
const KEPT: usize = 8;

/// Columns of a tile and its margins, from row to row.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    columns: Columns,
    predictions: Rows<PREDICTED, KEPT>,
    errors: BoxSums<ERRORS, ERROR_EDGE>,
    /// Sum of the errors of the best choice, and of the weights of errors.
    chosen: Rows<2, CHOICE_EDGE>,
    /// For each choice, number of pixels around where it is the best.
    shares: BoxSums<CHOICES, CHOICE_EDGE>,
}

/// Returns the tiles of an image.
pub(crate) fn tiles(width: u32, height: u32) -> impl Iterator<Item = Region> {
    let steps = |count: u32, size: u32| {
        (0..count).step_by(size as usize).map(move |from| (from, size.min(count - from)))
    };
    steps(height, TILE[1]).flat_map(move |(y, height)| {
        steps(width, TILE[0]).map(move |(x, width)| Region { x, y, width, height })
    })
}

impl Workspace {
    /// Returns radiance and squared error of a tile's pixels, row by row.
    // Profiles shall name it.
    #[inline(never)]
    pub(crate) fn denoise(&mut self, input: &Input, tile: Region) -> Vec<([f32; 3], f32)> {
        let Self { columns, predictions, errors, chosen, shares } = self;
        columns.begin();
        errors.begin();
        shares.begin();
        let mut pixels = Vec::with_capacity((tile.width * tile.height) as usize);
        for row in 0..tile.height as usize {
            let y = MARGIN[1] + row;
            let mut predict = |y: usize, errors: &mut Row<ERRORS>| {
                columns.advance(input, tile, y);
                predict_row(columns, input.floor * FLOOR, y, predictions.row_mut(y), errors);
            };
            let choose = |y: usize, best: &mut Row<CHOICES>| {
                let mut sums = [[0.0; STRIDE]; ERRORS];
                errors.add(y, &mut predict, &mut sums);
                choose_row(&sums, best, chosen.row_mut(y));
            };
            let mut sums = [[0.0; STRIDE]; CHOICES];
            shares.add(y, choose, &mut sums);
            let first = (tile.y as usize + row) * input.image.width as usize + tile.x as usize;
            let originals = &input.image.pixels[first..][..tile.width as usize];
            let blended = Blended {
                columns: columns.pixels.row(y),
                predictions: predictions.row(y),
                chosen: chosen.row(y),
                shares: &sums,
            };
            blended.add_to(originals, &mut pixels);
        }
        pixels
    }
}

/// Computes predictions and errors of a row's pixels.
fn predict_row(
    columns: &Columns,
    floor: f32,
    y: usize,
    predictions: &mut Row<PREDICTED>,
    errors: &mut Row<ERRORS>,
) {
    errors[CHOICES] = columns.pixels.row(y)[WEIGHT];
    for x in (MARGIN[0] - BORDER..STRIDE - MARGIN[0] + BORDER).step_by(MAX_LANES) {
        predict_lanes::<F32x16>(columns, floor, [y, x], predictions, errors);
    }
}

/// Computes those of the pixels from `x` on, one in each lane.
#[inline(always)]
fn predict_lanes<L: Lanes>(
    columns: &Columns,
    floor: f32,
    [y, x]: [usize; 2],
    row: &mut Row<PREDICTED>,
    errors: &mut Row<ERRORS>,
) {
    let pixels = columns.pixels.row(y);
    let [albedo, irradiance, variance]: [[L; 3]; 3] =
        [ALBEDO, IRRADIANCE, VARIANCE].map(|first| load(pixels, first, x));
    let has_noise = Lanes::lt(L::splat(0.0), L::load(&pixels[DEVIATIONS][x..])).bits() != 0;
    let predictions = if has_noise {
        let [near, wide] = predict::<L>(columns, y, x);
        [near, wide, predict_by_squares(columns, y, x)]
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
    // Black images have no error.
    scale = Lanes::max(scale, L::splat(f32::MIN_POSITIVE));
    scale.store(&mut row[SCALE][x..]);
    // Rare bright paths would keep themselves: their variance is not that of well-distributed samples.
    let weight = L::load(&pixels[WEIGHT][x..]) / scale;
    (weight * own).store(&mut errors[0][x..]);
    for (window, Prediction { irradiance: predicted, leverage }) in predictions.iter().enumerate() {
        let penalty = L::splat(2.0) * *leverage - L::splat(1.0);
        let mut error = L::splat(0.0);
        for channel in 0..3 {
            let squared = albedo[channel] * albedo[channel];
            let change = predicted[channel] - irradiance[channel];
            let risk = change.mul_add(change, penalty * variance[channel]);
            error = squared.mul_add(risk, error);
            predicted[channel].store(&mut row[3 * window + channel][x..]);
        }
        (weight * error).store(&mut errors[1 + window][x..]);
    }
}

/// Finds the choice with the least error around each pixel of a row: 1 in its column of `best`. `chosen` gets the sums of
/// its errors and of weights.
fn choose_row(sums: &Row<ERRORS>, best: &mut Row<CHOICES>, chosen: &mut Row<2>) {
    chosen[1] = sums[CHOICES];
    for x in (0..STRIDE).step_by(MAX_LANES) {
        choose_lanes::<F32x16>(sums, x, best, &mut chosen[0]);
    }
}

/// Finds that of the pixels from `x` on, one in each lane.
#[inline(always)]
fn choose_lanes<L: Lanes>(
    sums: &Row<ERRORS>,
    x: usize,
    best: &mut Row<CHOICES>,
    chosen_sum: &mut [f32; STRIDE],
) {
    let sums: [L; CHOICES] = load(sums, 0, x);
    let mut handicapped = sums;
    let mut least = L::splat(f32::INFINITY);
    for (sum, kept) in handicapped.iter_mut().zip(KEPT_NOISE) {
        *sum = *sum + L::splat(CAUTION * kept) * sums[0];
        least = Lanes::min(*sum, least);
    }
    let (mut open, mut chosen) = (L::splat(1.0), L::splat(0.0));
    // The first of equals.
    for ((best, sum), handicapped) in best.iter_mut().zip(sums).zip(handicapped) {
        let share = L::select(Lanes::le(handicapped, least), open, L::splat(0.0));
        open = open - share;
        chosen = chosen + share * sum;
        share.store(&mut best[x..]);
    }
    chosen.store(&mut chosen_sum[x..]);
}

/// Sources that a row of the denoised image is blended from.
struct Blended<'a> {
    columns: &'a Row<COLUMNS>,
    predictions: &'a Row<PREDICTED>,
    chosen: &'a Row<2>,
    shares: &'a Row<CHOICES>,
}

impl Blended<'_> {
    /// Blends the choices of neighbors, so that they leave no edges, and adds radiance and squared error of the row's pixels.
    fn add_to(&self, originals: &[[f32; 3]], pixels: &mut Vec<([f32; 3], f32)>) {
        let starts = (MARGIN[0]..).step_by(MAX_LANES);
        for (x, originals) in starts.zip(originals.chunks(MAX_LANES)) {
            let (blended, are_kept) = self.lanes::<F32x16>(x);
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

    /// Returns radiance and squared error of the pixels from `x` on, one in each lane, and the bits of those that stay as
    /// they are.
    #[inline(always)]
    fn lanes<L: Lanes>(&self, x: usize) -> ([L; 4], u32) {
        let zero = L::splat(0.0);
        let all = L::splat((CHOICE_EDGE * CHOICE_EDGE) as f32);
        let shares: [L; CHOICES] = load(self.shares, 0, x);
        let [albedo, irradiance]: [[L; 3]; 2] =
            [ALBEDO, IRRADIANCE].map(|first| load(self.columns, first, x));
        let usual: [L; 3] = load(self.predictions, 0, x);
        let outlier = outlier_share(self.columns, usual, x);
        let outlier = L::select(Lanes::lt(zero, shares[0]), outlier, zero);
        let scale = L::load(&self.predictions[SCALE][x..]);
        let [chosen, weights]: [L; 2] = load(self.chosen, 0, x);
        let error = Lanes::max(chosen / (L::splat(3.0) * weights) * scale, zero);
        let mut blended = [error; 4];
        for channel in 0..3 {
            let own = irradiance[channel];
            let usual = Lanes::max(usual[channel], zero);
            let mut mixed = shares[0] * outlier.mul_add(usual - own, own);
            for (share, prediction) in shares[1..].iter().zip(self.predictions.chunks(3)) {
                mixed = mixed + *share * Lanes::max(L::load(&prediction[channel][x..]), zero);
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
fn outlier_share<L: Lanes>(columns: &Row<COLUMNS>, prediction: [L; 3], x: usize) -> L {
    let (mut noise, mut change) = (L::splat(0.0), L::splat(f32::MIN_POSITIVE));
    let [albedo, irradiance, variance]: [[L; 3]; 3] =
        [ALBEDO, IRRADIANCE, VARIANCE].map(|first| load(columns, first, x));
    for channel in 0..3 {
        let squared = albedo[channel] * albedo[channel];
        let difference = prediction[channel] - irradiance[channel];
        noise = noise + squared * variance[channel];
        change = change + squared * (difference * difference);
    }
    let explained = Lanes::min(L::splat(OUTLIER_VARIANCES) * noise / change, L::splat(1.0));
    (L::splat(1.0) - L::load(&columns[WEIGHT][x..])) * explained
}

const _: () = assert!((TILE[0] as usize + 2 * BORDER).is_multiple_of(MAX_LANES));
const _: () = assert!(BORDER + REACH + SQUARE / 2 + 3 <= MARGIN[1]);
const _: () = assert!(BORDER < KEPT);
