//! The nearest hits of rays so far, as far as single precision can tell.
//!
//! The conservative test gives each candidate a distance before which it is not hit. A ray keeps the
//! candidate of which that distance is least, and the least distance of all others ([`RunnerUp`]):
//! nothing is decided before the traversal ends. If double precision then finds the candidate hit before
//! any other can be, that is the answer; if not, which is rare, the ray is traced again and each
//! candidate is decided at once (see [`HitResolver`](super::resolver::HitResolver)).
//!
//! Nor are spheres tested that are farther than where the candidate is likely to be hit. If it is hit
//! beyond that, or not at all, the ray is traced again as well: so that distance is no bound, and takes
//! two operations.

use super::query::Query;
use super::resolver::DONE;
use crate::conservative::{Chord, ConservativeRay, Margin};
use crate::lanes::{Lanes, Mask, bits};
use crate::ray::MISS;
use crate::vec3::Vec3;

/// A sphere whose half chord is more than a hundredth of its radius is hit at most this part of the radius,
/// and [`LIKELY_DISTANCE`] of the distance, after the distance before which it is not: the bounds of the
/// half chord's square differ by that, over twice the half chord.
const LIKELY_RADIUS: f32 = 1.0 / (1 << 10) as f32;

/// See [`LIKELY_RADIUS`].
const LIKELY_DISTANCE: f32 = 1.0 / (1 << 11) as f32;

/// The nearest candidates of rays in lanes.
#[derive(Clone, Copy)]
pub(super) struct NearestHit<L> {
    /// The bits of the sphere's row; [`MISS`] where there is none.
    pub(super) sphere: L,
    /// A distance before which it is not hit. For any hit: a distance before which the search does not
    /// end, or [`DONE`] where there may be a hit that is not certain.
    pub(super) near: L,
    /// A distance beyond which nothing is tested; [`DONE`] for a lane without a ray, or one that needs
    /// no more answers.
    pub(super) t_max: L,
}

/// The candidate's sphere and the bound of all others, which decide a first hit at the end.
#[derive(Clone, Copy)]
pub(super) struct RunnerUp<L> {
    /// The nearest candidate; anything where there is none.
    pub(super) sphere: SphereLanes<L>,
    /// A distance before which no other sphere is hit, and the search does not end.
    pub(super) near: L,
}

/// Spheres in lanes.
#[derive(Clone, Copy)]
pub(super) struct SphereLanes<L> {
    pub(super) center: Vec3<L>,
    pub(super) radius: L,
}

/// A sphere that rays in lanes may hit.
#[derive(Clone, Copy)]
pub(super) struct Candidate<L: Lanes> {
    /// The bits of its row.
    pub(super) number: L,
    /// The lanes that may count it as hit.
    pub(super) allowed: L::Mask,
    pub(super) sphere: SphereLanes<L>,
    pub(super) chord: Chord<L>,
}

/// Returns a distance beyond which spheres are hardly hit that are not hit before `near`.
#[inline(always)]
pub(super) fn likely_distance<L: Lanes>(near: L, radius: L) -> L {
    near.relaxed_mul_add(L::splat(1.0 + LIKELY_DISTANCE), radius * L::splat(LIKELY_RADIUS))
}

impl<L: Lanes> SphereLanes<L> {
    /// The same sphere in every lane.
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

impl<L: Lanes> NearestHit<L> {
    /// No candidate yet, between bounds of the distance at which the search ends.
    #[inline(always)]
    pub(super) fn new<Q: Query>(t_min: L, t_max: L) -> Self {
        let near = if Q::ANY { t_min } else { L::splat(f32::INFINITY) };
        Self { sphere: bits(MISS), near, t_max }
    }

    /// Returns the lanes that have a candidate; for any hit, those that certainly have a hit.
    #[inline(always)]
    pub(super) fn found(&self) -> L::Mask {
        !self.sphere.has_bits_of(bits(MISS))
    }

    /// Tests a sphere that the rays may hit.
    #[inline(always)]
    pub(super) fn update<Q: Query>(
        &mut self,
        runner_up: &mut RunnerUp<L>,
        ray: &ConservativeRay<L>,
        margin: &Margin<L>,
        candidate: &Candidate<L>,
    ) {
        let near = candidate.chord.near();
        let radius = candidate.sphere.radius;
        let lanes = candidate.chord.may_hit(self.t_max) & candidate.allowed;
        if !Q::EXACT {
            self.accept_unverified::<Q>(lanes, near, candidate.number);
        } else if Q::ANY {
            self.update_any(lanes, ray, margin, candidate);
        } else {
            let around = lanes & near.lt(L::splat(0.0));
            let far = likely_distance(near, radius);
            let (lanes, bounds) = if around.bits() == 0 {
                (lanes, [near, far])
            } else {
                let (inside, [at_least, at_most]) = candidate.chord.leaves(ray, radius, margin);
                let near = L::select(inside, at_least, near);
                let lanes = lanes & near.le(self.t_max);
                // Also where it is not certain on which side rays start.
                let exit = likely_distance(at_most, L::splat(0.0));
                (lanes, [near, L::select(around, exit, far)])
            };
            let nearer = self.update_nearest(&mut runner_up.near, lanes, bounds, candidate.number);
            runner_up.sphere = SphereLanes::select(nearer, candidate.sphere, runner_up.sphere);
        }
    }

    /// Keeps a candidate for the first hit, which is not hit before `near` and hardly beyond `far`, if it
    /// is nearer, and the bound of all other spheres. Returns the lanes in which it is nearer.
    #[inline(always)]
    pub(super) fn update_nearest(
        &mut self,
        runner_up: &mut L,
        lanes: L::Mask,
        [near, far]: [L; 2],
        number: L,
    ) -> L::Mask {
        let nearer = lanes & near.lt(self.near);
        self.sphere = L::select(nearer, number, self.sphere);
        *runner_up = L::select(lanes, near.max(self.near).min(*runner_up), *runner_up);
        self.near = L::select(nearer, near, self.near);
        self.t_max = L::select(lanes, far.min(self.t_max), self.t_max);
        nearer
    }

    /// Ends lanes whose rays certainly hit the sphere, and marks those that may hit it.
    #[inline(always)]
    fn update_any(
        &mut self,
        lanes: L::Mask,
        ray: &ConservativeRay<L>,
        margin: &Margin<L>,
        candidate: &Candidate<L>,
    ) {
        let radius = candidate.sphere.radius;
        let far = candidate.chord.near_at_most(radius, margin);
        let entered = lanes & candidate.chord.enters(ray, radius, margin) & far.lt(self.near);
        let open = lanes & !entered;
        let (mut certain, mut uncertain) = (entered, open);
        if open.bits() != 0 {
            let (inside, [near, far]) = candidate.chord.leaves(ray, radius, margin);
            let inside = open & inside;
            let left = inside & far.lt(self.near);
            certain = entered | left;
            uncertain = open & !inside | inside & near.le(self.t_max) & !left;
        }
        let done = L::splat(DONE);
        self.sphere = L::select(certain, candidate.number, self.sphere);
        self.near = L::select(uncertain, done, self.near);
        self.t_max = L::select(certain, done, self.t_max);
    }

    /// Accepts a candidate of the conservative test as a hit.
    #[inline(always)]
    pub(super) fn accept_unverified<Q: Query>(&mut self, lanes: L::Mask, near: L, number: L) {
        let t_max = if Q::ANY { L::splat(DONE) } else { near };
        self.sphere = L::select(lanes, number, self.sphere);
        self.near = L::select(lanes, near, self.near);
        self.t_max = L::select(lanes, t_max, self.t_max);
    }
}
