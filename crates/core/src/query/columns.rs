//! Rays and hits in columns.

use super::QueryError;
use crate::ray::MISS;

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

impl RayColumns<'_> {
    /// Checks that all columns agree in length.
    pub(super) fn check(&self, others: &[usize]) -> Result<(), QueryError> {
        let [count, ..] = self.origin.map(<[f32]>::len);
        same_length(count, &self.origin.map(<[f32]>::len))?;
        same_length(count, &self.direction.map(<[f32]>::len))?;
        same_length(count, others)
    }

    pub(super) fn row(&self, i: usize) -> ([f32; 3], [f32; 3]) {
        (self.origin.map(|column| column[i]), self.direction.map(|column| column[i]))
    }
}

pub(super) fn same_length(expected: usize, lengths: &[usize]) -> Result<(), QueryError> {
    match lengths.iter().find(|&&found| found != expected) {
        Some(&found) => Err(QueryError::Lengths { expected, found }),
        None => Ok(()),
    }
}
