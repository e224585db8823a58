//! What rays have hit so far, as far as single precision can tell.
//!
//! Each candidate has a distance before which it is not hit. A ray keeps the candidate of which that is
//! least, and the least of all others' ([`Rival`]): nothing is decided before the walk ends. If double
//! precision then finds a hit on the one that is nearer than anything else can be, that is the answer;
//! if not, which is rare, [`Decider`](super::decide::Decider) looks at the ray anew.
//!
//! Nor is anything looked at that is farther than where the best is likely to be hit. If it is hit beyond
//! that, or not at all, the ray is looked at anew as well; so that is no bound, and takes two operations.

use super::decide::DONE;
use super::walk::Query;
use crate::filter::{Chord, FilterRay, Margin};
use crate::lanes::{Lanes, Mask, bits};
use crate::ray::MISS;
use crate::vec3::Vec3;

/// After the distance before which it is not, a sphere is hit by no more of its radius than this, and
/// [`RELATIVE`] of the distance, where half the chord is more than a hundredth of the radius: for that is
/// what the bounds of its square differ by, over twice the half.
const PART: f32 = 1.0 / (1 << 10) as f32;

/// See [`PART`].
const RELATIVE: f32 = 1.0 / (1 << 11) as f32;

/// The best candidates of rays in a row.
#[derive(Clone, Copy)]
pub(super) struct Best<L> {
    /// The bits of the sphere; [`MISS`] where there is none.
    pub(super) sphere: L,
    /// A distance before which it is not hit. Of a query for any hit: before which the search does not
    /// end, but [`DONE`] where there may be a hit that is not certain.
    pub(super) near: L,
    /// A distance beyond which nothing is looked at; [`DONE`] for a lane without a ray, or done.
    pub(super) t_max: L,
}

/// What a query for the first hit keeps besides, for what is to be decided in the end.
#[derive(Clone, Copy)]
pub(super) struct Rival<L> {
    /// The best candidate; anything where there is none.
    pub(super) ball: Ball<L>,
    /// A distance before which no other is hit, nor the search ends.
    pub(super) near: L,
}

/// Spheres in a row.
#[derive(Clone, Copy)]
pub(super) struct Ball<L> {
    pub(super) center: Vec3<L>,
    pub(super) radius: L,
}

/// A sphere that rays in a row may hit.
#[derive(Clone, Copy)]
pub(super) struct Candidate<L: Lanes> {
    /// The bits of its row.
    pub(super) number: L,
    /// The lanes that may count it as hit.
    pub(super) allowed: L::Mask,
    pub(super) ball: Ball<L>,
    pub(super) chord: Chord<L>,
}

/// A distance beyond which spheres are hardly hit, of which this is one before which they are not.
#[inline(always)]
pub(super) fn likely<L: Lanes>(near: L, radius: L) -> L {
    near.mul_add(L::splat(1.0 + RELATIVE), radius * L::splat(PART))
}

impl<L: Lanes> Ball<L> {
    /// The same in every lane.
    #[inline(always)]
    pub(super) fn splat([x, y, z, radius]: [f32; 4]) -> Self {
        Self { center: Vec3::splat(x, y, z), radius: L::splat(radius) }
    }

    /// One or the other, lane by lane.
    #[inline(always)]
    fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Self {
            center: Vec3::select_lanes(mask, yes.center, no.center),
            radius: L::select(mask, yes.radius, no.radius),
        }
    }
}

impl<L: Lanes> Best<L> {
    /// Nothing yet, between bounds of the distance at which the search ends.
    #[inline(always)]
    pub(super) fn of_search<Q: Query>((t_min, t_max): (L, L)) -> Self {
        let near = if Q::ANY { t_min } else { L::splat(f32::INFINITY) };
        Self { sphere: bits(MISS), near, t_max }
    }

    /// The lanes that have a candidate; of a query for any hit, one that is certain.
    #[inline(always)]
    pub(super) fn there(&self) -> L::Mask {
        !self.sphere.has_bits_of(bits(MISS))
    }

    /// Meets a sphere.
    #[inline(always)]
    pub(super) fn meet<Q: Query>(
        &mut self,
        rival: &mut Rival<L>,
        (ray, margin): (&FilterRay<L>, &Margin<L>),
        met: &Candidate<L>,
    ) {
        let near = met.chord.near();
        let lanes = met.chord.may_hit(self.t_max) & met.allowed;
        if !Q::EXACT {
            self.believe::<Q>(lanes, near, met.number);
        } else if Q::ANY {
            self.end(lanes, (ray, margin), met);
        } else {
            let around = lanes & near.lt(L::splat(0.0));
            let far = likely(near, met.ball.radius);
            let (lanes, bounds) = if around.bits() == 0 {
                (lanes, [near, far])
            } else {
                let (inside, [at_least, at_most]) = met.chord.leaves(ray, met.ball.radius, margin);
                let near = L::select(inside, at_least, near);
                let lanes = lanes & near.le(self.t_max);
                // Also where it is not certain on which side rays start.
                (lanes, [near, L::select(around, likely(at_most, L::splat(0.0)), far)])
            };
            let nearer = self.keep(&mut rival.near, lanes, bounds, met.number);
            rival.ball = Ball::select(nearer, met.ball, rival.ball);
        }
    }

    /// Keeps a candidate for the nearest hit, which is not before `near`, and hardly beyond `far`, and the
    /// bound of what is hit of all others. The lanes in which it is the best.
    #[inline(always)]
    pub(super) fn keep(
        &mut self,
        others: &mut L,
        lanes: L::Mask,
        [near, far]: [L; 2],
        number: L,
    ) -> L::Mask {
        let nearer = lanes & near.lt(self.near);
        self.sphere = L::select(nearer, number, self.sphere);
        *others = L::select(lanes, near.max(self.near).min(*others), *others);
        self.near = L::select(nearer, near, self.near);
        self.t_max = L::select(lanes, far.min(self.t_max), self.t_max);
        nearer
    }

    /// Ends lanes whose ray hits something for certain, and notes where one may do so.
    #[inline(always)]
    fn end(
        &mut self,
        lanes: L::Mask,
        (ray, margin): (&FilterRay<L>, &Margin<L>),
        met: &Candidate<L>,
    ) {
        let radius = met.ball.radius;
        let far = met.chord.near_at_most(radius, margin);
        let entered = lanes & met.chord.enters(ray, radius, margin) & far.lt(self.near);
        let open = lanes & !entered;
        let (mut certain, mut uncertain) = (entered, open);
        if open.bits() != 0 {
            let (inside, [near, far]) = met.chord.leaves(ray, radius, margin);
            let inside = open & inside;
            let left = inside & far.lt(self.near);
            certain = entered | left;
            uncertain = open & !inside | inside & near.le(self.t_max) & !left;
        }
        let done = L::splat(DONE);
        self.sphere = L::select(certain, met.number, self.sphere);
        self.near = L::select(uncertain, done, self.near);
        self.t_max = L::select(certain, done, self.t_max);
    }

    /// Takes the filter's word.
    #[inline(always)]
    pub(super) fn believe<Q: Query>(&mut self, lanes: L::Mask, near: L, number: L) {
        let t_max = if Q::ANY { L::splat(DONE) } else { near };
        self.sphere = L::select(lanes, number, self.sphere);
        self.near = L::select(lanes, near, self.near);
        self.t_max = L::select(lanes, t_max, self.t_max);
    }
}
