//! Columns that belong together.

use super::workspace::ROWS;
use crate::lanes::{F32x16, MAX_LANES, Packing, U32x16};
use crate::vec3::Vec3;

/// Columns of numbers of 32 bits that belong together, of as many rows as a batch has. They are of
/// one piece, so that where one has a row, all have it, which is checked but once.
#[derive(Clone, Debug)]
pub struct Block<const N: usize>(Box<[[u32; ROWS]; N]>);

impl<const N: usize> Default for Block<N> {
    /// All 0.
    fn default() -> Self {
        #[expect(clippy::large_stack_arrays, reason = "it is on the heap from the beginning")]
        let columns = vec![[0; ROWS]; N].into_boxed_slice();
        Self(columns.try_into().expect("as many columns"))
    }
}

impl<const N: usize> Block<N> {
    /// Number `row` of a column.
    #[inline(always)]
    pub fn number(&self, column: usize, row: usize) -> u32 {
        self.0[column][row]
    }

    /// The same of a float.
    #[inline(always)]
    pub fn float(&self, column: usize, row: usize) -> f32 {
        f32::from_bits(self.number(column, row))
    }

    /// The same of three columns from `column` on.
    #[inline(always)]
    pub fn vector(&self, column: usize, row: usize) -> glam::Vec3 {
        let at = |axis| self.float(column + axis, row);
        glam::Vec3::new(at(0), at(1), at(2))
    }

    /// Writes a number.
    #[inline(always)]
    pub fn set(&mut self, column: usize, row: usize, number: u32) {
        self.0[column][row] = number;
    }

    /// Rows `first..first + 16` of a column.
    #[inline(always)]
    pub fn numbers(&self, column: usize, first: usize) -> U32x16 {
        U32x16::new(*row(&self.0[column], first))
    }

    /// The same of floats.
    #[inline(always)]
    pub fn floats(&self, column: usize, first: usize) -> F32x16 {
        bytemuck::cast(self.numbers(column, first))
    }

    /// The same of three columns from `column` on.
    #[inline(always)]
    pub fn vectors(&self, column: usize, first: usize) -> Vec3<F32x16> {
        Vec3::new(
            self.floats(column, first),
            self.floats(column + 1, first),
            self.floats(column + 2, first),
        )
    }

    /// Writes rows of some columns, of which each is told with its rows.
    #[inline(always)]
    pub fn store<const M: usize>(&mut self, first: usize, rows: [(usize, U32x16); M]) {
        let columns = &mut *self.0;
        for (column, row) in rows {
            columns[column][first..first + MAX_LANES].copy_from_slice(&row.to_array());
        }
    }

    /// Writes some lanes of rows to columns from `column` on, and anything up to sixteen.
    #[inline(always)]
    pub fn pack<const M: usize>(
        &mut self,
        (column, first): (usize, usize),
        packing: &Packing,
        rows: [U32x16; M],
    ) {
        let columns = &mut *self.0;
        for (i, row) in rows.into_iter().enumerate() {
            packing.store_numbers(row, &mut columns[column + i][first..]);
        }
    }
}

/// The numbers that floats are.
#[inline(always)]
pub fn floats(row: F32x16) -> U32x16 {
    bytemuck::cast(row)
}

/// Rows `first..first + 16` of a column.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn row<T>(column: &[T], first: usize) -> &[T; MAX_LANES] {
    column[first..].first_chunk().expect("columns hold whole rows")
}
