//! Columns of pixels, and the observations among them that regressions are fitted to.

use crate::rows::{Row, STRIDE};
use spherule_transport::lanes::{Lanes, MAX_LANES};

/// Number of features, which are the first columns: the normal and the coverage.
pub(crate) const FEATURES: usize = 4;

/// Index of the coverage, after the axes of the normal.
pub(crate) const COVERAGE: usize = 3;

/// Index of the irradiance, which is mean radiance over albedo, by channel.
pub(crate) const IRRADIANCE: usize = FEATURES;

/// Index of the weight: 0 outside of the image, 1 without noise.
pub(crate) const WEIGHT: usize = IRRADIANCE + 3;

/// Index of the sphere at the pixel's center, which is compared by its bits only.
pub(crate) const ID: usize = WEIGHT + 1;

/// Number of the columns above: those of an observation, which squares of pixels have, too.
pub(crate) const OBSERVED: usize = ID + 1;

/// Index of the mean albedo, by channel; 1 for the background, whose radiance is its color.
pub(crate) const ALBEDO: usize = OBSERVED;

/// Index of the variance of the irradiance, by channel.
pub(crate) const VARIANCE: usize = ALBEDO + 3;

/// Indices of the means over channels of irradiance and of its variance.
pub(crate) const MEAN: usize = VARIANCE + 3;
pub(crate) const MEAN_VARIANCE: usize = MEAN + 1;

/// Index of the standard deviation over channels.
pub(crate) const DEVIATION: usize = MEAN_VARIANCE + 1;

/// Index of the number of pixels: 1 inside of the image, and 0 outside.
pub(crate) const INSIDE: usize = DEVIATION + 1;

/// Index of the sum of deviations around the pixel.
pub(crate) const DEVIATIONS: usize = INSIDE + 1;

/// Number of columns of pixels.
pub(crate) const COLUMNS: usize = DEVIATIONS + 1;

/// Number of values from the first of a row of lanes to the last of them.
const SPAN: usize = ID * STRIDE + MAX_LANES;

/// Observations of some pixels of a row, one in each lane, or of the squares around them. All columns are found by one index,
/// which is checked once.
#[derive(Clone, Copy)]
pub(crate) struct Observed<'a>(&'a [f32; SPAN]);

impl<'a> Observed<'a> {
    /// Returns those of the pixels from `x` on.
    ///
    /// # Panics
    /// The row ends before.
    #[inline(always)]
    pub(crate) fn at<const COLUMNS: usize>(row: &'a Row<COLUMNS>, x: usize) -> Self {
        Self(row.as_flattened()[x..].first_chunk().expect("rows hold all columns"))
    }

    /// Returns the values in columns from `first` on.
    #[inline(always)]
    pub(crate) fn columns<const N: usize, L: Lanes>(self, first: usize) -> [L; N] {
        // A closure over the array would be called for each.
        let mut rows = [L::splat(0.0); N];
        for (column, row) in (first..).zip(&mut rows) {
            *row = self.column(column);
        }
        rows
    }

    /// Returns the values in a column.
    #[inline(always)]
    pub(crate) fn column<L: Lanes>(self, column: usize) -> L {
        L::load(&self.0[column * STRIDE..])
    }
}

/// Returns the values of some columns, from `first` on, of the pixels from `x` on.
#[inline(always)]
pub(crate) fn load<const N: usize, L: Lanes>(
    row: &[[f32; STRIDE]],
    first: usize,
    x: usize,
) -> [L; N] {
    let mut rows = [L::splat(0.0); N];
    for (row, column) in rows.iter_mut().zip(&row[first..]) {
        *row = L::load(&column[x..]);
    }
    rows
}
