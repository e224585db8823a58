//! Rays in columns and in rows, and hits in columns.

use super::QueryError;
use crate::lanes::{F32x16, Lanes, MAX_LANES, columns_of_points};
use crate::ray::MISS;
use std::ops::Range;

/// The sphere of a ray that hits nothing.
pub const NOTHING: u32 = MISS;

/// Rays in columns: coordinate by coordinate, all of one length.
#[derive(Clone, Copy, Debug)]
pub struct RayColumns<'a> {
    /// Origins: x, y, z.
    pub origin: [&'a [f32]; 3],
    /// Directions: x, y, z, of any length but 0.
    pub direction: [&'a [f32]; 3],
}

/// Rays in rows: one slice of origins and one of directions, of one length.
#[derive(Clone, Copy, Debug)]
pub struct RayRows<'a> {
    /// Origins.
    pub origin: &'a [[f32; 3]],
    /// Directions of any length but 0.
    pub direction: &'a [[f32; 3]],
}

/// Columns for the hits of rays, as long as those of the rays.
#[derive(Debug)]
pub struct Hits<'a> {
    /// On entry, hits not nearer than this do not count; infinity for no bound. On return the
    /// distance of the hit, in units of the direction's length, or unchanged. It is the double that is nearest to
    /// the true distance: off by half a unit of its last place at most. It is never more than the bound, and
    /// equals it if the true distance is less by no more than that.
    pub t: &'a mut [f64],
    /// On return the sphere's row in the columns that the tree was built from, or [`NOTHING`].
    pub sphere: &'a mut [u32],
    /// On return point and normal; unchanged where nothing is hit. `None` to
    /// leave them out.
    pub surface: Option<&'a mut [Surface]>,
}

/// The first hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Row of the sphere in the columns that the tree was built from.
    pub sphere: u32,
    /// Distance in units of the direction's length, more than 0: the double that is nearest to the true distance.
    pub t: f64,
    /// The point of the sphere, in the user's coordinates.
    pub point: [f64; 3],
    /// The outward unit normal.
    pub normal: [f64; 3],
}

/// Point and normal of a hit, computed in double precision from the sphere, so that the point is on it up
/// to the last bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// The point, in the user's coordinates.
    pub point: [f64; 3],
    /// The outward unit normal.
    pub normal: [f64; 3],
}

/// Counts of a batch of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Invalid rays, which hit nothing: a coordinate is not finite, the direction is zero, or the bound is
    /// NaN.
    pub invalid: u64,
    /// Decisions that were made on integers.
    pub exact: u64,
}

/// Rays in memory of the caller's.
pub(super) trait RayTable {
    /// Number of rays.
    fn len(&self) -> usize;

    /// Checks that all columns agree in length, the others included.
    fn check(&self, others: &[usize]) -> Result<(), QueryError>;

    /// Origin and direction of ray `i`.
    fn row(&self, i: usize) -> ([f32; 3], [f32; 3]);

    /// Origins and directions of up to sixteen rays; those after the last one have origin 0 and a direction of ones.
    fn packet(&self, rows: Range<usize>) -> [[F32x16; 3]; 2];
}

impl RayTable for RayColumns<'_> {
    fn len(&self) -> usize {
        self.origin[0].len()
    }

    fn check(&self, others: &[usize]) -> Result<(), QueryError> {
        let count = self.len();
        same_length(count, &self.origin.map(<[f32]>::len))?;
        same_length(count, &self.direction.map(<[f32]>::len))?;
        same_length(count, others)
    }

    #[inline(always)]
    fn row(&self, i: usize) -> ([f32; 3], [f32; 3]) {
        (self.origin.map(|column| column[i]), self.direction.map(|column| column[i]))
    }

    #[inline(always)]
    fn packet(&self, rows: Range<usize>) -> [[F32x16; 3]; 2] {
        let column = |x: &[f32], rest: f32| {
            if rows.len() == MAX_LANES {
                return F32x16::load(&x[rows.clone()]);
            }
            let mut row = [rest; MAX_LANES];
            row[..rows.len()].copy_from_slice(&x[rows.clone()]);
            F32x16::new(row)
        };
        [self.origin.map(|x| column(x, 0.0)), self.direction.map(|x| column(x, 1.0))]
    }
}

impl RayTable for RayRows<'_> {
    fn len(&self) -> usize {
        self.origin.len()
    }

    fn check(&self, others: &[usize]) -> Result<(), QueryError> {
        same_length(self.len(), &[self.direction.len()])?;
        same_length(self.len(), others)
    }

    #[inline(always)]
    fn row(&self, i: usize) -> ([f32; 3], [f32; 3]) {
        (self.origin[i], self.direction[i])
    }

    #[inline(always)]
    fn packet(&self, rows: Range<usize>) -> [[F32x16; 3]; 2] {
        let columns = |points: &[[f32; 3]], rest: f32| {
            let points = &points[rows.clone()];
            if let Some(points) = points.first_chunk() {
                return columns_of_points(points);
            }
            let mut some = [[rest; 3]; MAX_LANES];
            some[..points.len()].copy_from_slice(points);
            columns_of_points(&some)
        };
        [columns(self.origin, 0.0), columns(self.direction, 1.0)]
    }
}

pub(super) fn same_length(expected: usize, lengths: &[usize]) -> Result<(), QueryError> {
    match lengths.iter().find(|&&found| found != expected) {
        Some(&found) => Err(QueryError::Lengths { expected, found }),
        None => Ok(()),
    }
}
