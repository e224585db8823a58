//! Observations that regressions are fitted to: of pixels, or of squares of pixels.

use super::columns::STRIDE;
use crate::lanes::{Lanes, MAX_LANES};

/// Number of features: the normal and the coverage.
pub(super) const FEATURES: usize = 4;

/// Index of the coverage, after the axes of the normal.
pub(super) const COVERAGE: usize = 3;

/// Index of the irradiance, which is mean radiance over albedo, by channel.
pub(super) const IRRADIANCE: usize = FEATURES;

/// Index of the weight: 0 outside of the picture, 1 without noise.
pub(super) const WEIGHT: usize = IRRADIANCE + 3;

/// Number of columns.
const COLUMNS: usize = WEIGHT + 1;

/// Number of values in a row of pixels.
pub(super) const PITCH: usize = COLUMNS * STRIDE;

/// Number of values from the first of a row of lanes to the last of them.
const SPAN: usize = WEIGHT * STRIDE + MAX_LANES;

/// Observations of the pixels of a tile and its margins, or of the squares of pixels around them.
///
/// A row of pixels has its columns one after another, so that all of a pixel are found by one index, which is checked
/// once.
#[derive(Debug, Default)]
pub(super) struct Observations {
    pub(super) values: Vec<f32>,
}

/// Observations of some pixels of a row, one in each lane.
#[derive(Clone, Copy)]
pub(super) struct Observed<'a>(&'a [f32; SPAN]);

/// Returns the index of the first of the values of pixel `at`.
#[inline(always)]
pub(super) fn index(at: usize) -> usize {
    at / STRIDE * PITCH + at % STRIDE
}

impl Observations {
    /// Returns those of the pixels whose values begin at `index`, one in each lane.
    ///
    /// # Panics
    /// They are not in the columns.
    #[inline(always)]
    pub(super) fn at(&self, index: usize) -> Observed<'_> {
        Observed(self.values[index..].first_chunk().expect("rows hold all columns"))
    }

    /// Returns the columns of a row of pixels.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = &[f32]> {
        self.values[row * PITCH..][..PITCH].chunks_exact(STRIDE)
    }

    /// Returns the same, to write to.
    pub(super) fn row_mut(&mut self, row: usize) -> impl Iterator<Item = &mut [f32]> {
        self.values[row * PITCH..][..PITCH].chunks_exact_mut(STRIDE)
    }

    /// Returns the value of pixel `at` in a column.
    #[cfg(test)]
    pub(super) fn value(&self, column: usize, at: usize) -> f32 {
        self.values[index(at) + column * STRIDE]
    }
}

impl Observed<'_> {
    /// Returns the values in columns from `first` on.
    #[inline(always)]
    pub(super) fn columns<const N: usize, L: Lanes>(self, first: usize) -> [L; N] {
        // A closure over the array would be called for each.
        let mut rows = [L::splat(0.0); N];
        for (column, row) in (first..).zip(&mut rows) {
            *row = L::load(&self.0[column * STRIDE..]);
        }
        rows
    }

    /// Returns the values in a column.
    #[inline(always)]
    pub(super) fn column<L: Lanes>(self, column: usize) -> L {
        L::load(&self.0[column * STRIDE..])
    }
}
