//! The rays of a chunk: rows of the caller's table, or rays that were sorted.

use super::columns::RayTable;
use crate::lanes::{F32x16, MAX_LANES};
use std::ops::Range;

/// Sixteen rays as the caller gave them.
pub(super) struct RayPacket {
    pub(super) origin: [F32x16; 3],
    pub(super) direction: [F32x16; 3],
    /// The distances at which their searches end.
    pub(super) bound: [f64; MAX_LANES],
}

/// The rays of a chunk.
pub(super) trait ChunkRays {
    /// Number of rays.
    fn len(&self) -> usize;

    /// The caller's row of ray `k`.
    fn row(&self, k: usize) -> usize;

    /// Rays from the `first` on; `bounds` are by the caller's rows. What is after the last is a ray with NaN for its
    /// bound.
    fn packet(&self, first: usize, bounds: &[f64]) -> RayPacket;
}

/// Rays in the caller's order.
pub(super) struct Rows<'a, T> {
    pub(super) table: &'a T,
    pub(super) rows: Range<usize>,
}

impl<T> Rows<'_, T> {
    /// Some of the rays.
    pub(super) fn chunk(&self, places: Range<usize>) -> Self {
        let first = self.rows.start;
        Self { table: self.table, rows: first + places.start..first + places.end }
    }
}

impl<T: RayTable> ChunkRays for Rows<'_, T> {
    fn len(&self) -> usize {
        self.rows.len()
    }

    #[inline(always)]
    fn row(&self, k: usize) -> usize {
        self.rows.start + k
    }

    #[inline(always)]
    fn packet(&self, first: usize, bounds: &[f64]) -> RayPacket {
        let rows = self.row(first)..self.rows.end.min(self.row(first) + MAX_LANES);
        let mut bound = [f64::NAN; MAX_LANES];
        bound[..rows.len()].copy_from_slice(&bounds[rows.clone()]);
        let [origin, direction] = self.table.packet(rows);
        RayPacket { origin, direction, bound }
    }
}
