//! The decision about a ray and a sphere that the filter let pass: whether it is a hit, and whether
//! a nearer one than the ray has.
//!
//! What is hit is decided by [`intersect::confirm`] alone, and equal distances go to the sphere
//! that comes first in the user's scene. Walks only decide how soon the answer is found, never which
//! it is.

use super::ready::Ready;
use super::waiting::Waiting;
use super::walk::{Query, Visits};
use crate::exact::{self, Distance};
use crate::filter::{Chord, FilterRay};
use crate::intersect::{self, CLEAR, Pairs, Root};
use crate::lanes::{Lanes, bits, bits_of};
use crate::ray::{CHUNK, ExactRay, Hits, MISS, Rays};
use crate::spheres::Spheres;
use glam::DVec3;
use std::cmp::Ordering;
use std::marker::PhantomData;

/// The bound of a ray that needs no more answers.
pub(super) const DONE: f32 = f32::NEG_INFINITY;

/// Bounds of what was rounded to this, at any magnitude.
#[inline(always)]
fn rounded_out<L: Lanes>(t: L) -> (L, L) {
    let scaled = |factor, least| t.mul_add(L::splat(factor), L::splat(least));
    (scaled(1.0 - f32::EPSILON, -f32::MIN_POSITIVE), scaled(1.0 + f32::EPSILON, f32::MIN_POSITIVE))
}

/// Rays, what they may hit, and what they have hit so far.
pub(super) struct Decider<'a, Q> {
    pub(super) spheres: &'a Spheres,
    pub(super) rays: &'a Rays,
    pub(super) hits: &'a mut Hits,
    /// How often arithmetic without rounding was needed.
    pub(super) exact: u64,
    /// Rays to look at anew: what they have found may be wrong.
    pub(super) doubtful: Vec<u32>,
    /// Rays that wait to be decided in lanes.
    pub(super) waiting: Waiting,
    /// Rays that are to begin.
    pub(super) ready: Ready,
    /// What was visited, if it is counted.
    pub(super) visits: Visits,
    query: PhantomData<Q>,
}

impl<'a, Q: Query> Decider<'a, Q> {
    pub(super) fn new(spheres: &'a Spheres, rays: &'a Rays, hits: &'a mut Hits) -> Self {
        Self {
            spheres,
            rays,
            hits,
            exact: 0,
            doubtful: Vec::new(),
            waiting: Waiting::default(),
            ready: Ready::NONE,
            visits: Visits::default(),
            query: PhantomData,
        }
    }

    /// Bounds of the distance that still counts for a ray; [`DONE`] if none does.
    #[inline(always)]
    pub(super) fn bounds(&self, row: usize) -> (f32, f32) {
        if Q::ANY && self.hits.sphere[row] != MISS {
            return (DONE, DONE);
        }
        let (t, error) = (self.hits.t[row], self.hits.error[row % CHUNK]);
        (rounded_out((t - error) as f32).0, rounded_out((t + error) as f32).1)
    }

    /// [`Decider::bounds`] for the rays from `row` on of which nothing is known yet but the bounds of
    /// the search; [`DONE`] for lanes that are not in `members`.
    #[inline(always)]
    pub(super) fn start<L: Lanes>(&self, row: usize, members: L::Mask) -> (L, L) {
        let (low, high) = rounded_out(L::load_rounded(&self.hits.t[row..]));
        let searched = if Q::ANY {
            members & bits_of::<L>(&self.hits.sphere[row..]).has_bits_of(bits(MISS))
        } else {
            members
        };
        let done = L::splat(DONE);
        (L::select(searched, low, done), L::select(searched, high, done))
    }

    /// Decides about a ray and a sphere, and keeps the hit if it is nearer: then it is true.
    #[inline(always)]
    pub(super) fn consider(&mut self, row: usize, sphere: usize) -> bool {
        if !Q::EXACT {
            return self.believe(row, sphere);
        }
        if self.is(sphere, self.rays.own[row]) || self.is(sphere, self.rays.target[row]) {
            return false;
        }
        let (center, radius) = self.spheres.exact(sphere);
        let ray = self.rays.exact(row);
        let (plain, t) = intersect::confirm_plain(&Pairs::one(&ray, center, radius));
        if !plain {
            return self.consider_closely(row, sphere, &ray);
        }
        self.keep_nearer(row, sphere, &ray, (t, t * CLEAR))
    }

    /// [`Decider::consider`] for hits that are not plain.
    #[inline(never)]
    fn consider_closely(&mut self, row: usize, sphere: usize, ray: &ExactRay) -> bool {
        let (center, radius) = self.spheres.exact(sphere);
        let inside = || self.starts_within(ray, row, center, radius);
        let Some(root) = intersect::confirm(ray, center, radius, inside) else { return false };
        self.exact += u64::from(root.exact);
        self.keep_nearer(row, sphere, ray, (root.t, root.error))
    }

    /// Keeps a hit at distance `t`, give or take `error`, if it is nearer: then it is true.
    #[inline(always)]
    fn keep_nearer(
        &mut self,
        row: usize,
        sphere: usize,
        ray: &ExactRay,
        (t, error): (f64, f64),
    ) -> bool {
        let nearer = self.is_nearer(row, sphere, ray, (t, error));
        if nearer {
            self.hits.sphere[row] = sphere as u32;
            if !Q::ANY {
                (self.hits.t[row], self.hits.error[row % CHUNK]) = (t, error);
            }
        }
        nearer
    }

    /// Takes a sphere that passed the filter for a hit.
    #[inline(always)]
    fn believe(&mut self, row: usize, sphere: usize) -> bool {
        let ray = FilterRay::new(self.rays.origin.load(row), self.rays.direction.load(row));
        let center = self.spheres.center(sphere);
        let near = Chord::<f32>::new(&ray, center.into(), self.spheres.radius(sphere)).near();
        let nearer = near >= 0.0 && near < self.bounds(row).1;
        if nearer {
            self.hits.set(row, f64::from(near), sphere as u32);
        }
        nearer
    }

    /// Whether `sphere` is sphere `known` of the ray, or coincides with it. What coincides comes later
    /// in the scene, or it would be known in its stead.
    #[inline(always)]
    fn is(&self, sphere: usize, known: u32) -> bool {
        known == sphere as u32
            || ((known as usize) < self.spheres.len()
                && self.spheres.exact(known as usize) == self.spheres.exact(sphere))
    }

    /// Whether a ray that starts on the surface of this sphere, as far as rounding tells, starts on one
    /// that touches it from within.
    fn starts_within(&self, ray: &ExactRay, row: usize, center: DVec3, radius: f64) -> bool {
        let own = self.rays.own[row] as usize;
        if own >= self.spheres.len() {
            return false;
        }
        let (own_center, own_radius) = self.spheres.exact(own);
        own_radius < radius && (ray.origin - own_center).dot(ray.origin - center) > 0.0
    }

    /// Whether a hit replaces what its ray has so far.
    #[inline(always)]
    fn is_nearer(
        &mut self,
        row: usize,
        sphere: usize,
        ray: &ExactRay,
        (t, error): (f64, f64),
    ) -> bool {
        let (best, best_error) = (self.hits.t[row], self.hits.error[row % CHUNK]);
        if t + error < best - best_error {
            return true;
        }
        if t - error > best + best_error {
            return false;
        }
        match self.compare(row, sphere, ray, (t, error)) {
            Ordering::Less => true,
            Ordering::Equal => !Q::ANY && self.precedes(sphere, self.hits.sphere[row]),
            Ordering::Greater => false,
        }
    }

    /// Compares distances that are closer than their errors: by closer bounds, then without
    /// rounding.
    #[cold]
    fn compare(
        &mut self,
        row: usize,
        sphere: usize,
        ray: &ExactRay,
        (t, error): (f64, f64),
    ) -> Ordering {
        let (best, other) = (self.hits.t[row], self.hits.sphere[row] as usize);
        let best_error = self.hits.error[row % CHUNK];
        let twins = || self.spheres.exact(sphere) == self.spheres.exact(other);
        if best_error != 0.0 && twins() {
            return Ordering::Equal;
        }
        let first = self.candidate(ray, sphere, t, error);
        let second = self.candidate(ray, other, best, best_error);
        let gap = first.0.t - second.0.t;
        if gap.abs() > first.0.error + second.0.error {
            return gap.total_cmp(&0.0);
        }
        self.exact += 1;
        exact::compare(ray, &first.1, &second.1)
    }

    /// A distance with its closest bound, and what it is. An error of 0 says that it is no hit, or
    /// by definition so.
    fn candidate(&self, ray: &ExactRay, sphere: usize, t: f64, error: f64) -> (Root, Distance) {
        let number = Root { t, error: 0.0, exact: false };
        if error == 0.0 {
            return (number, Distance::Number(t));
        }
        let (center, radius) = self.spheres.exact(sphere);
        let root = intersect::confirm_closely(ray, center, radius, || false);
        (root.unwrap_or(number), Distance::Hit(center, radius))
    }

    /// Whether `sphere` comes before `other` in the user's scene; the ground comes last, and a bound is
    /// no hit.
    fn precedes(&self, sphere: usize, other: u32) -> bool {
        other != MISS
            && self.spheres.id.get(other as usize).is_none_or(|&id| self.spheres.id[sphere] < id)
    }
}
