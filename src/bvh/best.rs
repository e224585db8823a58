//! What rays have hit so far, as far as single precision can tell.
//!
//! Each candidate has bounds of the distance at which it is hit, if it is. A ray keeps the candidate
//! with the least lower bound, and the least of all others' lower bounds: nothing is decided before the
//! walk ends. If double precision then finds a hit on the one that is nearer than anything else can be,
//! that is the answer; if not, which is rare, [`Decider`](super::decide::Decider) looks at the ray anew.
//!
//! What is beyond the least upper bound is not looked at. If that is of a candidate that is no hit
//! after all, then a lower bound of another was less than it, and the ray is looked at anew.

use super::decide::DONE;
use super::walk::Query;
use crate::filter::{Chord, FilterRay, Margin};
use crate::lanes::{Lanes, Mask, bits};
use crate::ray::MISS;

/// The best candidates of rays in a row.
#[derive(Clone, Copy)]
pub(super) struct Best<L> {
    /// The bits of the sphere; [`MISS`] where there is none.
    pub(super) sphere: L,
    /// A distance before which it is not hit.
    pub(super) near: L,
    /// A distance before which no other is hit, nor the search ends. Of a query for any hit: before
    /// which the search does not end, but [`DONE`] where there may be a hit that is not certain.
    pub(super) other: L,
    /// A distance beyond which nothing counts; [`DONE`] for a lane without a ray, or done.
    pub(super) t_max: L,
}

/// A sphere that rays in a row may hit.
#[derive(Clone, Copy)]
pub(super) struct Candidate<L: Lanes> {
    /// The bits of its row.
    pub(super) number: L,
    /// The lanes that may count it as hit.
    pub(super) allowed: L::Mask,
    pub(super) radius: L,
    pub(super) chord: Chord<L>,
}

impl<L: Lanes> Best<L> {
    /// Nothing yet, between bounds of the distance at which the search ends.
    #[inline(always)]
    pub(super) fn of_search((t_min, t_max): (L, L)) -> Self {
        Self { sphere: bits(MISS), near: L::splat(f32::INFINITY), other: t_min, t_max }
    }

    /// The lanes that have a candidate; of a query for any hit, one that is certain.
    #[inline(always)]
    pub(super) fn there(&self) -> L::Mask {
        !self.sphere.has_bits_of(bits(MISS))
    }

    /// The best once a sphere is met.
    #[inline(always)]
    pub(super) fn meet<Q: Query>(
        self,
        ray: &FilterRay<L>,
        margin: &Margin<L>,
        met: &Candidate<L>,
    ) -> Self {
        let lanes = met.chord.may_hit(self.t_max) & met.allowed;
        let (near, far) = (met.chord.near(), met.chord.near_at_most(met.radius, margin));
        if !Q::EXACT {
            self.believe::<Q>(lanes, near, met.number)
        } else if Q::ANY {
            let entered = lanes & met.chord.enters(ray, met.radius, margin) & far.lt(self.other);
            let open = lanes & !entered;
            if open.bits() == 0 {
                return self.end(entered, open, met.number);
            }
            let (inside, [near, far]) = met.chord.leaves(ray, met.radius, margin);
            let inside = open & inside;
            let left = inside & far.lt(self.other);
            let open = open & !inside | inside & near.le(self.t_max) & !left;
            self.end(entered | left, open, met.number)
        } else {
            let around = lanes & near.lt(L::splat(0.0));
            if around.bits() == 0 {
                return self.keep(lanes, [near, far], met.number);
            }
            let (inside, [at_least, at_most]) = met.chord.leaves(ray, met.radius, margin);
            let near = L::select(inside, at_least, near);
            // Also where it is not certain on which side rays start.
            let far = L::select(around, at_most, far);
            self.keep(lanes & near.le(self.t_max), [near, far], met.number)
        }
    }

    /// Keeps a candidate for the nearest hit, between bounds.
    #[inline(always)]
    fn keep(self, lanes: L::Mask, [near, far]: [L; 2], number: L) -> Self {
        let near = L::select(lanes, near, L::splat(f32::INFINITY));
        Self {
            sphere: L::select(near.lt(self.near), number, self.sphere),
            near: near.min(self.near),
            other: near.max(self.near).min(self.other),
            t_max: L::select(lanes, far.min(self.t_max), self.t_max),
        }
    }

    /// Ends lanes whose ray hits something for certain, and notes where one may do so.
    #[inline(always)]
    fn end(self, certain: L::Mask, open: L::Mask, number: L) -> Self {
        let done = L::splat(DONE);
        Self {
            sphere: L::select(certain, number, self.sphere),
            near: self.near,
            other: L::select(open, done, self.other),
            t_max: L::select(certain, done, self.t_max),
        }
    }

    /// Takes the filter's word.
    #[inline(always)]
    fn believe<Q: Query>(self, lanes: L::Mask, near: L, number: L) -> Self {
        let t_max = if Q::ANY { L::splat(DONE) } else { near };
        Self {
            sphere: L::select(lanes, number, self.sphere),
            near: L::select(lanes, near, self.near),
            other: self.other,
            t_max: L::select(lanes, t_max, self.t_max),
        }
    }
}
