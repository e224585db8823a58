//! Rows of a tile, which is passed through from top to bottom.

/// Size of a tile. Predictions are also needed for [`BORDER`] pixels around it, whose rows fill rows of lanes.
pub(crate) const TILE: [u32; 2] = [120, 256];

/// Columns and rows of pixels around a tile that its result depends on, and some more, so that rows of lanes fit and no row
/// before the first is asked for.
pub(crate) const MARGIN: [usize; 2] = [20, 20];

/// Number of pixels in a row, margins included.
pub(crate) const STRIDE: usize = TILE[0] as usize + 2 * MARGIN[0];

/// A row of pixels, by columns.
pub(crate) type Row<const COLUMNS: usize> = [[f32; STRIDE]; COLUMNS];

/// The last `KEPT` rows. They stay in the second-level cache, as the columns of a whole tile would not.
#[derive(Debug)]
pub(crate) struct Rows<const COLUMNS: usize, const KEPT: usize>(Vec<Row<COLUMNS>>);

impl<const COLUMNS: usize, const KEPT: usize> Rows<COLUMNS, KEPT> {
    /// Returns row `y` of the tile, from the top of its margin, if it is among those that were written last.
    #[inline(always)]
    pub(crate) fn row(&self, y: usize) -> &Row<COLUMNS> {
        &self.0[y % KEPT]
    }

    /// Returns the same to write to, in place of row `y - KEPT`.
    #[inline(always)]
    pub(crate) fn row_mut(&mut self, y: usize) -> &mut Row<COLUMNS> {
        &mut self.0[y % KEPT]
    }
}

impl<const COLUMNS: usize, const KEPT: usize> Default for Rows<COLUMNS, KEPT> {
    fn default() -> Self {
        Self(vec![[[0.0; STRIDE]; COLUMNS]; KEPT])
    }
}
