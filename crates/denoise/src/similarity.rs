//! Similarity of neighbors by their radiance, for edges that features don't have: of caustics, highlights, and whatever is
//! seen in glass and mirrors.
//!
//! Two pixels are similar if squares of pixels around them differ by no more than their noise explains (Buades, Coll and
//! Morel, "A Non-Local Algorithm for Image Denoising", CVPR 2005; with the variance of each pixel as in Rousselle, Knaus
//! and Zwicker, "Adaptive Rendering with Non-Local Means Filtering", TOG 2012).

use crate::box_sums::BoxSums;
use crate::columns::KEPT;
use crate::observations::{COLUMNS, INSIDE, MEAN, MEAN_VARIANCE};
use crate::regression::{OFFSETS, RADII, pixels};
use crate::rows::{Row, Rows, STRIDE};
use spherule_transport::lanes::Lanes;

/// Edge of the squares that are compared.
const PATCH: usize = 5;

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

/// Distance within which rows have neighbors.
const RADIUS: usize = RADII[RADII.len() - 1];

/// Similarities of the pixels of a tile, and its margins, to their neighbors, from 0 to 1.
#[derive(Debug, Default)]
pub(crate) struct Similarities {
    /// For each pixel, that to the neighbor below or on the right; by pairs of opposite offsets.
    pairs: Rows<PAIRS, { RADIUS + 1 }>,
    boxes: BoxSums<PAIRS, PATCH>,
    /// The row after the last that is known.
    next: usize,
}

/// Similarities of the pixels of a row to their neighbors.
#[derive(Clone, Copy)]
pub(crate) struct Similar<'a>([&'a Row<PAIRS>; RADIUS + 1]);

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

/// Offsets of pairs.
fn forward_offsets() -> impl Iterator<Item = [isize; 2]> {
    OFFSETS[..NEIGHBORS].iter().copied().filter(|&offset| is_forward(offset))
}

impl Similarities {
    /// Forgets all rows, for another tile.
    pub(crate) fn begin(&mut self) {
        self.next = 0;
        self.boxes.begin();
    }

    /// Compares the pixels of row `y` with their neighbors. Rows up to that of the last neighbor's square must be known.
    pub(crate) fn measure(&mut self, y: usize, pixels: &Rows<COLUMNS, KEPT>) {
        for row in self.next.max(y - RADIUS)..=y {
            let compare = |row: usize, excess: &mut Row<PAIRS>| {
                for (excess, [dx, dy]) in excess.iter_mut().zip(forward_offsets()) {
                    let other = pixels.row(row.wrapping_add_signed(dy));
                    differences(pixels.row(row), other, dx, excess);
                }
            };
            let sums = self.pairs.row_mut(row);
            self.boxes.add(row, compare, sums);
            for sum in sums.as_flattened_mut() {
                *sum = similarity_of(*sum);
            }
        }
        self.next = y + 1;
    }

    /// Returns those of row `y`, which must be the last that was measured.
    #[inline(always)]
    pub(crate) fn around(&self, y: usize) -> Similar<'_> {
        Similar(std::array::from_fn(|row| self.pairs.row(y + row - RADIUS)))
    }
}

impl Similar<'_> {
    /// Returns the similarities of the pixels from `x` on, one in each lane, to the neighbor at an offset, whose index in
    /// [`OFFSETS`] this is.
    #[inline(always)]
    pub(crate) fn load<L: Lanes>(self, index: usize, x: usize, [dx, dy]: [isize; 2]) -> L {
        if index == 0 {
            return L::splat(1.0);
        }
        let (pair, forward) = PAIR_OF[index];
        let (row, x) = if forward {
            (RADIUS, x)
        } else {
            (RADIUS.wrapping_add_signed(dy), x.wrapping_add_signed(dx))
        };
        L::load(&self.0[row][pair][x..])
    }
}

/// Computes the squared differences of a row's pixels from those of another row `dx` pixels later, beyond that of noise: in
/// variances of the difference, less 1. It is 0 where one of the two is outside of the image.
fn differences(row: &Row<COLUMNS>, other: &Row<COLUMNS>, dx: isize, excess: &mut [f32; STRIDE]) {
    excess.fill(0.0);
    // The first pixel of the row that has a partner, and the first that is one.
    let [first, partner] = [-dx, dx].map(|first| first.max(0) as usize);
    let columns = [MEAN, MEAN_VARIANCE, INSIDE];
    let [means, variances, insides] =
        columns.map(|column| row[column][first..].iter().zip(&other[column][partner..]));
    let rows = means.zip(variances).zip(insides);
    for (excess, ((mean, variance), inside)) in excess[first..].iter_mut().zip(rows) {
        let difference = mean.0 - mean.1;
        let variance = (variance.0 + variance.1).max(f32::MIN_POSITIVE);
        let squared = (difference * difference / variance).min(MAX_DIFFERENCE);
        *excess = inside.0 * inside.1 * (squared - 1.0);
    }
}

/// Returns the similarity by the sum of the excess over a square.
#[inline(always)]
fn similarity_of(sum: f32) -> f32 {
    const SCALE: f32 = 1.0 / ((1 << SQUARINGS) as f32 * TOLERANCE * (PATCH * PATCH) as f32);
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
        const Y: usize = 10;
        let measure = |variance: f32, offset: [isize; 2]| {
            let mut pixels = Rows::<COLUMNS, KEPT>::default();
            for row in 0..KEPT {
                let row = pixels.row_mut(row);
                row[MEAN][..STRIDE / 2].fill(1.0);
                row[MEAN][STRIDE / 2..].fill(2.0);
                row[MEAN_VARIANCE].fill(variance);
                row[INSIDE].fill(1.0);
            }
            let mut similarities = Similarities::default();
            similarities.measure(Y, &pixels);
            let index = OFFSETS.iter().position(|&other| offset == other).unwrap();
            similarities.around(Y).load::<f32>(index, STRIDE / 2 - 1, offset)
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
            let found = similarity_of(excess * (PATCH * PATCH) as f32);
            assert!((found - expected).abs() < 0.06, "{excess}: {found} {expected}");
        }
        assert!(similarity_of(f32::INFINITY) == 0.0);
    }
}
