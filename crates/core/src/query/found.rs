//! Queries whose traversal is done elsewhere, on another processor.

use super::answers::Occlusion;
use super::batch::CHUNK;
use super::chunk::Rows;
use super::columns::{RayTable, same_length};
use super::{Hits, NOTHING, QueryError, RayColumns, SphereTree, Tally};
use crate::bvh::{Any, ClosestRounded, Tree};

use crate::ray::{self, MISS, Rays};

impl SphereTree {
    /// The tree and its spheres, without [strays](super::strays).
    #[doc(hidden)]
    pub fn parts(&self) -> Tree<'_> {
        self.tree()
    }

    /// Returns rays in the tree's units, with the bounds of their searches. Those that single precision does not hold
    /// have bounds below 0.
    ///
    /// # Errors
    /// Columns of different lengths.
    #[doc(hidden)]
    pub fn scaled_rays(
        &self,
        columns: &RayColumns,
        bounds: &[f64],
    ) -> Result<(Rays, ray::Hits), QueryError> {
        columns.check(&[bounds.len()])?;
        let count = bounds.len();
        let (mut rays, mut hits) = (Rays::with_capacity(count), ray::Hits::with_capacity(count));
        let (mut some, mut bound) =
            (Rays::with_capacity(CHUNK.min(count)), ray::Hits::with_capacity(CHUNK.min(count)));
        for first in (0..count).step_by(CHUNK) {
            let chunk = Rows { table: columns, rows: first..count.min(first + CHUNK) };
            self.load(&chunk, bounds, &mut some, &mut bound);
            for row in 0..chunk.rows.len() {
                rays.push(some.origin.row(row), some.direction.row(row), MISS);
                hits.t[first + row] = bound.t[row];
            }
        }
        Ok((rays, hits))
    }

    /// Does what [`SphereTree::intersect_columns`] does, where `found` names what the rays of
    /// [`SphereTree::scaled_rays`] hit in the tree, as for [`decide_found`](crate::bvh::decide_found).
    ///
    /// # Errors
    /// Columns of different lengths.
    #[doc(hidden)]
    pub fn intersect_found(
        &self,
        rays: &RayColumns,
        mut hits: Hits,
        found: &[u32],
    ) -> Result<Tally, QueryError> {
        let surfaces = hits.surface.as_ref().map_or(hits.t.len(), |column| column.len());
        rays.check(&[hits.t.len(), hits.sphere.len(), surfaces])?;
        same_length(hits.t.len(), &[found.len()])?;
        hits.sphere.fill(NOTHING);
        Ok(self.run::<ClosestRounded>(rays, &mut hits, Some(found)))
    }

    /// Does what [`SphereTree::occluded_columns`] does, as [`SphereTree::intersect_found`].
    ///
    /// # Errors
    /// Columns of different lengths.
    #[doc(hidden)]
    pub fn occluded_found(
        &self,
        rays: &RayColumns,
        t: &[f64],
        occluded: &mut [bool],
        found: &[u32],
    ) -> Result<Tally, QueryError> {
        rays.check(&[t.len(), occluded.len(), found.len()])?;
        occluded.fill(false);
        Ok(self.run::<Any>(rays, &mut Occlusion { t, occluded }, Some(found)))
    }
}
