//! The cut of a part of the tree in two: what builders differ in.

use super::branch::{self, Branch, Top};
use super::median::Median;
use super::segment::Segment;
use crate::spheres::LEAF;

/// Number of spheres about one center from which on those that coincide are searched for.
pub(super) const CROWD: usize = 64;

/// Cuts a part of the tree in two.
pub(super) trait Cut: Sync {
    /// Puts the spheres of the first part before those of the second; returns how many they are: a
    /// multiple of [`LEAF`], neither 0 nor all. There is more than a leaf of spheres, and `first` come
    /// before them.
    fn cut(&self, segment: &mut Segment, first: usize) -> usize;

    /// The cut that is used where the tree would become too deep.
    fn median(&self) -> &Median;

    /// Returns whether [`Cut::finish`] builds the subtree over this number of items.
    fn finishes(&self, _items: usize) -> bool {
        false
    }

    /// Makes all branches over `items`.
    fn finish(&self, segment: Segment, branches: &mut [Branch]) -> Top {
        branch::grow(self.median(), segment, branches, 0, 0)
    }
}

/// The multiple of a leaf that is next to `place`, with something on both sides.
pub(super) fn snapped(place: usize, items: usize) -> usize {
    let last = (items - 1) / LEAF;
    ((place + LEAF / 2) / LEAF).clamp(1, last) * LEAF
}
