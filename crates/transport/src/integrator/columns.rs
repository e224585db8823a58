//! Structures of arrays: columns of 32-bit words.

use crate::lanes::{F32x16, MAX_LANES, Packing, U32x16};
use crate::vec3::Vec3;

/// Paths of a batch: 16 samples of each pixel of a tile. With fewer, more rows of lanes are half empty
/// when most paths have ended: with 1024, scenes of a few spheres take 5 % longer, with 512 12 %.
pub const BATCH_PATHS: usize = 4096;

/// Rows of a column: room for a partial row of lanes, and such that columns do not all start in the
/// same sets of the first-level cache.
pub(super) const ROWS: usize = BATCH_PATHS + MAX_LANES;

/// Sixteen rows of columns, one in each lane, and the lanes that count.
#[derive(Clone, Copy, Debug)]
pub struct LaneRows {
    /// Row of the first lane; those of the others follow.
    pub first: usize,
    /// Lanes that count.
    pub lanes: u32,
}

/// `N` columns of 32-bit words, with a row for each path of a batch. The columns have the same length
/// by type, so that one bounds check serves all.
#[derive(Clone, Debug)]
pub struct WordColumns<const N: usize>(Box<[[u32; ROWS]; N]>);

impl<const N: usize> Default for WordColumns<N> {
    /// Returns columns of zeros.
    fn default() -> Self {
        #[expect(clippy::large_stack_arrays, reason = "it is on the heap from the beginning")]
        let columns = vec![[0; ROWS]; N].into_boxed_slice();
        Self(columns.try_into().expect("as many columns"))
    }
}

impl<const N: usize> WordColumns<N> {
    /// Returns row `row` of a column.
    #[inline(always)]
    pub fn word(&self, column: usize, row: usize) -> u32 {
        self.0[column][row]
    }

    /// Returns a row of a column of floats.
    #[inline(always)]
    pub fn float(&self, column: usize, row: usize) -> f32 {
        f32::from_bits(self.word(column, row))
    }

    /// Returns a row of three columns of floats from `column` on.
    #[inline(always)]
    pub fn vector(&self, column: usize, row: usize) -> glam::Vec3 {
        let at = |axis| self.float(column + axis, row);
        glam::Vec3::new(at(0), at(1), at(2))
    }

    /// Writes a row of a column.
    #[inline(always)]
    pub fn set(&mut self, column: usize, row: usize, word: u32) {
        self.0[column][row] = word;
    }

    /// Returns rows `first..first + 16` of a column.
    #[inline(always)]
    pub fn words(&self, column: usize, first: usize) -> U32x16 {
        U32x16::new(*row(&self.0[column], first))
    }

    /// Returns sixteen rows of a column of floats.
    #[inline(always)]
    pub fn floats(&self, column: usize, first: usize) -> F32x16 {
        bytemuck::cast(self.words(column, first))
    }

    /// Returns sixteen rows of three columns of floats from `column` on.
    #[inline(always)]
    pub fn vectors(&self, column: usize, first: usize) -> Vec3<F32x16> {
        Vec3::new(
            self.floats(column, first),
            self.floats(column + 1, first),
            self.floats(column + 2, first),
        )
    }

    /// Writes sixteen rows of some columns, given as pairs of column and rows.
    #[inline(always)]
    pub fn store<const M: usize>(&mut self, first: usize, rows: [(usize, U32x16); M]) {
        let columns = &mut *self.0;
        for (column, row) in rows {
            columns[column][first..first + MAX_LANES].copy_from_slice(&row.to_array());
        }
    }

    /// Writes the lanes that `packing` selects to columns from `column` on; the rest of sixteen rows
    /// gets arbitrary values.
    #[inline(always)]
    pub fn pack<const M: usize>(
        &mut self,
        column: usize,
        first: usize,
        packing: &Packing,
        rows: [U32x16; M],
    ) {
        let columns = &mut *self.0;
        for (i, row) in rows.into_iter().enumerate() {
            packing.store_numbers(row, &mut columns[column + i][first..]);
        }
    }
}

/// Reinterprets floats as words.
#[inline(always)]
pub fn float_bits(row: F32x16) -> U32x16 {
    bytemuck::cast(row)
}

/// Returns rows `first..first + 16` of a column.
///
/// # Panics
///
/// If the column has fewer rows.
#[inline(always)]
pub fn row<T>(column: &[T], first: usize) -> &[T; MAX_LANES] {
    column[first..].first_chunk().expect("columns hold whole rows")
}
