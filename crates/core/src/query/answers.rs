//! Columns for the answers of queries.

use super::columns::{Hits, Surface};

/// A hit.
pub(super) struct FoundHit {
    /// The sphere's row in the tree.
    pub(super) sphere: usize,
    /// The sphere's row in the user's columns; [`NOTHING`] if nobody asks which.
    pub(super) id: u32,
    /// In units of the user's direction; unspecified if any hit was looked for.
    pub(super) t: f64,
}

/// Columns of the caller's for the answers of a query.
pub(super) trait Answers {
    /// The distances at which searches end.
    fn bounds(&self) -> &[f64];
    /// Writes the answer of ray `i`.
    fn set(&mut self, i: usize, found: &FoundHit);
    /// The column of surfaces, if they are asked for.
    fn surfaces(&mut self) -> Option<&mut [Surface]>;
}

impl Answers for Hits<'_> {
    fn bounds(&self) -> &[f64] {
        self.t
    }

    #[inline(always)]
    fn set(&mut self, i: usize, found: &FoundHit) {
        (self.t[i], self.sphere[i]) = (found.t, found.id);
    }

    #[inline(always)]
    fn surfaces(&mut self) -> Option<&mut [Surface]> {
        self.surface.as_deref_mut()
    }
}

/// Columns of a query for any hit.
pub(super) struct Occlusion<'a> {
    pub(super) t: &'a [f64],
    pub(super) occluded: &'a mut [bool],
}

impl Answers for Occlusion<'_> {
    fn bounds(&self) -> &[f64] {
        self.t
    }

    #[inline(always)]
    fn set(&mut self, i: usize, _: &FoundHit) {
        self.occluded[i] = true;
    }

    #[inline(always)]
    fn surfaces(&mut self) -> Option<&mut [Surface]> {
        None
    }
}
