//! The decision about a ray and a sphere that the filter let pass: whether it is a hit, and whether
//! a nearer one than the ray has.
//!
//! What is hit is decided by [`intersect::confirm`] alone, and equal distances go to the sphere
//! that comes first in the user's scene. Walks only decide how soon the answer is found, never which
//! it is.

use super::walk::Query;
use crate::exact::{self, Distance};
use crate::filter::{Chord, FilterRay};
use crate::intersect::{self, CLEAR, Pairs, Root};
use crate::lanes::{F64x8, Lanes, MAX_LANES, set_bits};
use crate::ray::{Columns3, ExactRay, Hits, MISS, Rays};
use crate::spheres::{LEAF, Spheres};
use crate::vec3::Vec3;
use glam::DVec3;
use std::cmp::Ordering;
use std::marker::PhantomData;

/// The bound of a ray that needs no more answers.
pub(super) const DONE: f32 = f32::NEG_INFINITY;

/// Rays, what they may hit, and what they have hit so far.
pub(super) struct Decider<'a, Q> {
    pub(super) spheres: &'a Spheres,
    pub(super) rays: &'a Rays,
    pub(super) hits: &'a mut Hits,
    /// How often arithmetic without rounding was needed.
    pub(super) exact: u64,
    query: PhantomData<Q>,
}

impl<'a, Q: Query> Decider<'a, Q> {
    pub(super) fn new(spheres: &'a Spheres, rays: &'a Rays, hits: &'a mut Hits) -> Self {
        Self { spheres, rays, hits, exact: 0, query: PhantomData }
    }

    /// Bounds of the distances that still count for the rays from `row` on whose bits are set in
    /// `lanes`; [`DONE`] where none does.
    #[inline(always)]
    pub(super) fn bounds<L: Lanes>(&self, row: usize, lanes: u32) -> (L, L) {
        let rows = row..row + L::WIDTH;
        let (t, error) = (&self.hits.t[rows.clone()], &self.hits.error[rows.clone()]);
        let sphere = &self.hits.sphere[rows];
        let (mut low, mut high) = ([DONE; MAX_LANES], [DONE; MAX_LANES]);
        for lane in 0..L::WIDTH {
            let done = lanes >> lane & 1 == 0 || (Q::ANY && sphere[lane] != MISS);
            low[lane] = if done { DONE } else { (t[lane] - error[lane]) as f32 };
            high[lane] = if done { DONE } else { (t[lane] + error[lane]) as f32 };
        }
        // Beyond the rounding of the conversion, at any magnitude.
        let scaled = |bound: &[f32], factor: f32, least: f32| {
            L::load(bound).mul_add(L::splat(factor), L::splat(least))
        };
        let low = scaled(&low, 1.0 - f32::EPSILON, -f32::MIN_POSITIVE);
        (low, scaled(&high, 1.0 + f32::EPSILON, f32::MIN_POSITIVE))
    }

    /// Keeps hits of rays `first..` that are certain and nearer than what the rays have: sphere
    /// `candidates[i]`, or [`MISS`], for ray `first + i`.
    #[inline(always)]
    pub(super) fn settle(&mut self, first: usize, candidates: &[u32]) {
        if Q::ANY {
            for (i, &candidate) in candidates.iter().enumerate() {
                if candidate != MISS {
                    self.hits.sphere[first + i] = candidate;
                }
            }
            return;
        }
        for (row, candidates) in (first..).step_by(8).zip(candidates.chunks(8)) {
            let there = |i: usize| candidates.get(i).is_some_and(|&candidate| candidate != MISS);
            let mut open = (0..8).fold(0, |mask, i| mask | u32::from(there(i)) << i);
            let single = self.rays.precise.is_empty() && self.spheres.precise.is_empty();
            if candidates.len() == 8 && open != 0 && single {
                open &= !self.settle_plain(row, candidates, open);
            }
            for i in set_bits(open) {
                self.consider(row + i, candidates[i] as usize);
            }
        }
    }

    /// [`Decider::settle`] for eight rays; returns those that it could.
    #[inline(always)]
    fn settle_plain(&mut self, first: usize, candidates: &[u32], there: u32) -> u32 {
        let (rays, blocks) = (self.rays, self.spheres.blocks());
        let places: [_; 8] = std::array::from_fn(|i| {
            let sphere = if there >> i & 1 == 1 { candidates[i] as usize } else { 0 };
            (sphere / LEAF, sphere % LEAF)
        });
        let wide = |row: [f32; 8]| F64x8::new(row.map(f64::from));
        let column = |x: &[f32]| wide(std::array::from_fn(|i| x[first..first + 8][i]));
        let columns = |v: &Columns3| Vec3::new(column(&v.x), column(&v.y), column(&v.z));
        let origin = columns(&rays.origin);
        let span = origin.x.abs() + origin.y.abs() + origin.z.abs();
        let pairs = Pairs {
            origin,
            direction: columns(&rays.direction),
            // As if all were on surfaces: no less.
            origin_error: span * F64x8::splat(f64::from(f32::EPSILON)),
            center: Vec3::new(
                wide(places.map(|(block, lane)| blocks[block].x[lane])),
                wide(places.map(|(block, lane)| blocks[block].y[lane])),
                wide(places.map(|(block, lane)| blocks[block].z[lane])),
            ),
            radius: wide(places.map(|(block, lane)| blocks[block].radius[lane])),
        };
        let (plain, t) = intersect::confirm_plain(&pairs);
        let t = t.to_array();
        for i in set_bits(plain & there) {
            let row = first + i;
            (self.hits.t[row], self.hits.sphere[row]) = (t[i], candidates[i]);
            self.hits.error[row] = t[i] * CLEAR;
        }
        plain & there
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
        if plain == 0 {
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
                (self.hits.t[row], self.hits.error[row]) = (t, error);
            }
        }
        nearer
    }

    /// [`Decider::settle`] with distances of single precision.
    pub(super) fn believe_all(&mut self, first: usize, candidates: &[u32], nears: &[f32]) {
        for (i, (&candidate, &near)) in candidates.iter().zip(nears).enumerate() {
            if candidate != MISS {
                self.hits.set(first + i, f64::from(near), candidate);
            }
        }
    }

    /// Takes a sphere that passed the filter for a hit.
    #[inline(always)]
    fn believe(&mut self, row: usize, sphere: usize) -> bool {
        let ray = FilterRay::new(self.rays.origin.load(row), self.rays.direction.load(row));
        let center = self.spheres.center(sphere);
        let near = Chord::<f32>::new(&ray, center.into(), self.spheres.radius(sphere)).near();
        let nearer = near >= 0.0 && near < self.bounds::<f32>(row, 1).1;
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
        let (best, best_error) = (self.hits.t[row], self.hits.error[row]);
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
        let best_error = self.hits.error[row];
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
