//! Similarity of neighbors by their radiance, for edges that features don't have: of caustics, highlights, and whatever is
//! seen in glass and mirrors.
//!
//! Two pixels are similar if squares of pixels around them differ by no more than their noise explains (Buades, Coll and
//! Morel, "A Non-Local Algorithm for Image Denoising", CVPR 2005; with the variance of each pixel as in Rousselle, Knaus
//! and Zwicker, "Adaptive Rendering with Non-Local Means Filtering", TOG 2012).

use super::box_sums::BoxSums;
use super::regression::{OFFSETS, RADII, pixels};
use crate::lanes::Lanes;

/// Radius of the squares that are compared.
const PATCH_RADIUS: usize = 2;

/// Largest squared difference of two pixels that counts, in variances of the difference: rare paths of much light, whose
/// variance is underestimated, do not decide alone.
const MAX_DIFFERENCE: f32 = 16.0;

/// Mean squared difference beyond that of noise, in the same unit, at which similarity has fallen to 1 / e.
const TOLERANCE: f32 = 2.0;

/// Power of 2 whose power of a number that is nearly 1 replaces the exponential function.
const SQUARINGS: i32 = 3;

/// Number of neighbors that have similarities.
const NEIGHBORS: usize = pixels(RADII[RADII.len() - 1]);

/// Number of pairs of opposite offsets.
const PAIRS: usize = NEIGHBORS / 2;

/// Similarities of the pixels of a tile, and its margins, to their neighbors, from 0 to 1.
#[derive(Debug, Default)]
pub(super) struct Similarities {
    /// For each pixel, that to the neighbor below or on the right; by pairs of opposite offsets.
    pairs: [Vec<f32>; PAIRS],
    boxes: BoxSums,
}

/// Columns of pixels that are compared.
#[derive(Clone, Copy)]
pub(super) struct Pixels<'a> {
    /// Number of pixels in a row.
    pub(super) stride: usize,
    /// Irradiance, averaged over channels.
    pub(super) mean: &'a [f32],
    /// Variance of the irradiance, averaged over channels.
    pub(super) variance: &'a [f32],
    /// 1 inside of the picture, and 0 outside.
    pub(super) inside: &'a [f32],
}

/// For each neighbor of [`OFFSETS`], the index of its pair, and the sign of its offset beside the pair's.
static PAIR_OF: [(usize, bool); NEIGHBORS] = {
    let mut pairs = [(0, false); NEIGHBORS];
    let (mut index, mut count) = (0, 0);
    while index < NEIGHBORS {
        if is_forward(OFFSETS[index]) {
            pairs[index] = (count, true);
            count += 1;
        }
        index += 1;
    }
    // Opposite offsets.
    index = 0;
    while index < NEIGHBORS {
        let mut other = 0;
        while other < NEIGHBORS {
            let opposite =
                OFFSETS[index][0] == -OFFSETS[other][0] && OFFSETS[index][1] == -OFFSETS[other][1];
            if opposite && is_forward(OFFSETS[other]) {
                pairs[index] = (pairs[other].0, false);
            }
            other += 1;
        }
        index += 1;
    }
    pairs
};

/// Returns whether an offset leads to a later pixel.
const fn is_forward([x, y]: [isize; 2]) -> bool {
    y > 0 || y == 0 && x > 0
}

impl Similarities {
    /// Compares all pixels with their neighbors.
    pub(super) fn measure(&mut self, pixels: Pixels) {
        let forward = OFFSETS[..NEIGHBORS].iter().filter(|&&offset| is_forward(offset));
        for (similarity, &[x, y]) in self.pairs.iter_mut().zip(forward) {
            let shift = (y * pixels.stride as isize + x) as usize;
            similarity.resize(pixels.mean.len(), 0.0);
            let compare = |row, excess: &mut [f32]| differences(pixels, row, shift, excess);
            let finish = |sums: &mut [f32]| {
                for sum in sums {
                    *sum = similarity_of(*sum);
                }
            };
            self.boxes.add_rows(compare, pixels.stride, PATCH_RADIUS, similarity, finish);
        }
    }

    /// Returns the similarities of the pixels from `at` on, one in each lane, to neighbor `index` of [`OFFSETS`], which is
    /// at `neighbor`.
    #[inline(always)]
    pub(super) fn load<L: Lanes>(&self, index: usize, at: usize, neighbor: usize) -> L {
        if index == 0 {
            return L::splat(1.0);
        }
        let (pair, forward) = PAIR_OF[index];
        L::load(&self.pairs[pair][if forward { at } else { neighbor }..])
    }
}

/// Computes the squared differences of a row's pixels from those that are `shift` pixels later, beyond that of noise: in
/// variances of the difference, less 1. It is 0 where one of the two is outside of the picture.
fn differences(pixels: Pixels, row: usize, shift: usize, excess: &mut [f32]) {
    let Pixels { stride, mean, variance, inside } = pixels;
    excess.fill(0.0);
    let first = row * stride;
    let columns = [mean, variance, inside];
    let [means, variances, insides] =
        columns.map(|column| column[first..].iter().zip(column.iter().skip(first + shift)));
    let rows = means.zip(variances).zip(insides);
    for (excess, ((mean, variance), inside)) in excess.iter_mut().zip(rows) {
        let difference = mean.0 - mean.1;
        let variance = (variance.0 + variance.1).max(f32::MIN_POSITIVE);
        let squared = (difference * difference / variance).min(MAX_DIFFERENCE);
        *excess = inside.0 * inside.1 * (squared - 1.0);
    }
}

/// Returns the similarity by the sum of the excess over a square.
#[inline(always)]
fn similarity_of(sum: f32) -> f32 {
    const SCALE: f32 = 1.0 / ((1 << SQUARINGS) as f32 * TOLERANCE * pixels(PATCH_RADIUS) as f32);
    let mut power = (1.0 - SCALE * sum.max(0.0)).max(0.0);
    for _ in 0..SQUARINGS {
        power *= power;
    }
    power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_have_pairs() {
        let mut seen = [0; PAIRS];
        for (index, &(pair, forward)) in PAIR_OF.iter().enumerate().skip(1) {
            seen[pair] += 1;
            assert_eq!(forward, is_forward(OFFSETS[index]));
            let same = (1..NEIGHBORS).find(|&other| PAIR_OF[other] == (pair, !forward)).unwrap();
            assert_eq!(OFFSETS[same].map(|x| -x), OFFSETS[index]);
        }
        assert_eq!(seen, [2; PAIRS]);
    }

    #[test]
    fn pixels_on_the_two_sides_of_an_edge_are_not_similar() {
        const SIDE: usize = 32;
        let mean: Vec<f32> =
            (0..SIDE * SIDE).map(|i| if i % SIDE < SIDE / 2 { 1.0 } else { 2.0 }).collect();
        let mut similarities = Similarities::default();
        let mut measure = |variance: f32, [x, y]: [isize; 2]| {
            let (variance, inside) = ([variance; SIDE * SIDE], [1.0; SIDE * SIDE]);
            let pixels = Pixels { stride: SIDE, mean: &mean, variance: &variance, inside: &inside };
            similarities.measure(pixels);
            let index = OFFSETS.iter().position(|&offset| offset == [x, y]).unwrap();
            let at = SIDE * SIDE / 2 + SIDE / 2 - 1;
            let neighbor = at.wrapping_add_signed(y * SIDE as isize + x);
            similarities.load::<f32>(index, at, neighbor)
        };
        for offset in [[1, 0], [2, 0], [1, -1], [2, 2]] {
            assert!(measure(1e-3, offset) < 0.4, "{offset:?}");
            assert_eq!(measure(10.0, offset), 1.0, "{offset:?}");
        }
        for offset in [[0, 1], [0, -2], [0, 0]] {
            assert_eq!(measure(1e-3, offset), 1.0, "{offset:?}");
            assert_eq!(measure(0.0, offset), 1.0, "{offset:?}");
        }
    }

    #[test]
    fn similarity_falls_like_an_exponential_function() {
        for excess in [-1.0, 0.0, 0.5, 2.0, 6.0_f32] {
            let expected = (-excess.max(0.0) / TOLERANCE).exp();
            let found = similarity_of(excess * pixels(PATCH_RADIUS) as f32);
            assert!((found - expected).abs() < 0.06, "{excess}: {found} {expected}");
        }
        assert!(similarity_of(f32::INFINITY) == 0.0);
    }
}
