//! The rays of a chunk: rows of the caller's columns, or rays that were sorted.

use super::RayColumns;
use crate::lanes::{F32x16, Lanes, MAX_LANES};
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
pub(super) struct Rows<'a> {
    pub(super) columns: &'a RayColumns<'a>,
    pub(super) rows: Range<usize>,
}

impl Rows<'_> {
    /// Some of the rays.
    pub(super) fn chunk(&self, places: Range<usize>) -> Self {
        let first = self.rows.start;
        Self { columns: self.columns, rows: first + places.start..first + places.end }
    }
}

impl ChunkRays for Rows<'_> {
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
        let column = |x: &[f32], rest: f32| {
            if rows.len() == MAX_LANES {
                return F32x16::load(&x[rows.clone()]);
            }
            let mut row = [rest; MAX_LANES];
            row[..rows.len()].copy_from_slice(&x[rows.clone()]);
            F32x16::new(row)
        };
        let RayColumns { origin, direction } = self.columns;
        RayPacket {
            origin: origin.map(|x| column(x, 0.0)),
            direction: direction.map(|x| column(x, 1.0)),
            bound,
        }
    }
}
