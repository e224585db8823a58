//! Queries: the answers that traversals look for.

use crate::spheres::LEAF;
use std::marker::PhantomData;

/// The answer that a traversal looks for.
pub trait Query {
    /// True if any hit ends a ray's traversal.
    const ANY: bool;
    /// True if hits are decided exactly.
    const EXACT: bool = true;
    /// True if distances are rounded to the nearest doubles.
    const ROUNDED: bool = false;
    /// True if visits are counted.
    const COUNTED: bool = false;
}

/// The first hit of a ray: fills `t` and `sphere` of [`Hits`](crate::ray::Hits).
pub struct Closest;

impl Query for Closest {
    const ANY: bool = false;
}

/// As [`Closest`], and each `t` is the double that is nearest to the distance. The largest coordinate of each
/// direction is in `1..2`, origins are exact, and no ray has a hit beforehand.
pub struct ClosestRounded;

impl Query for ClosestRounded {
    const ANY: bool = false;
    const ROUNDED: bool = true;
}

/// Any hit of a ray nearer than `t`: fills `sphere` of [`Hits`](crate::ray::Hits) with some sphere that it hits.
pub struct Any;

impl Query for Any {
    const ANY: bool = true;
}

/// A query that accepts the hits and distances of the conservative test, in single precision. For
/// measurements only: the time that it saves is the price of exactness.
pub struct Unverified<Q>(PhantomData<Q>);

impl<Q: Query> Query for Unverified<Q> {
    const ANY: bool = Q::ANY;
    const EXACT: bool = false;
}

/// A query that counts visits. For measurements only.
pub(super) struct Counted<Q>(PhantomData<Q>);

impl<Q: Query> Query for Counted<Q> {
    const ANY: bool = Q::ANY;
    const EXACT: bool = Q::EXACT;
    const COUNTED: bool = true;
}

/// Visits of rays to the tree. Those of a packet count once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visits {
    /// Nodes, the root included.
    pub nodes: u64,
    /// Leaves.
    pub leaves: u64,
    /// Spheres that the test of a leaf did not rule out.
    pub candidates: u64,
}

impl Visits {
    /// Spheres that were tested, in whole leaves.
    pub fn spheres(&self) -> u64 {
        self.leaves * LEAF as u64
    }
}
