//! Decides for one ray which candidates of the conservative test are hits, and which hit is the nearest.
//!
//! Hits are decided by [`intersect::confirm`] alone, and of spheres at equal distances the one that
//! comes first in the user's scene is hit. So traversals differ in time, never in their answers.

use super::enclosing::power;
use super::query::Query;
use super::resolver::{DONE, rounded_out};
use crate::exact::{self, Distance};
use crate::intersect::{self, CLEAR, Pairs, Root};
use crate::ray::{ExactRay, MISS};
use crate::spheres::Spheres;
use glam::DVec3;
use std::cmp::Ordering;
use std::marker::PhantomData;

/// A ray and its nearest hit so far.
pub(super) struct Decision<'a, Q> {
    pub(super) spheres: &'a Spheres,
    pub(super) ray: ExactRay,
    /// The sphere that the ray starts on, and the one that it is aimed at, which it never hits; or [`MISS`].
    pub(super) own: u32,
    pub(super) target: u32,
    pub(super) nearest: Nearest,
    /// Number of decisions that were made on integers.
    pub(super) exact: u64,
    pub(super) query: PhantomData<Q>,
}

/// A hit, or the distance at which the search ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Distance in units of the direction's length.
    pub(super) t: f64,
    /// The true distance of the hit is no farther from `t` than this; 0 if `t` is a given number.
    pub(super) error: f64,
    /// Row of the sphere, or [`MISS`].
    pub(super) sphere: u32,
}

impl Nearest {
    /// Returns bounds of the distance.
    #[inline(always)]
    pub(super) fn bounds(self) -> (f32, f32) {
        let Self { t, error, .. } = self;
        (rounded_out((t - error) as f32).0, rounded_out((t + error) as f32).1)
    }
}

impl<'a, Q: Query> Decision<'a, Q> {
    /// No hit yet, for a ray that starts in empty space; hits at `bound` or beyond do not count.
    #[inline(always)]
    pub(super) fn of_ray(spheres: &'a Spheres, ray: &ExactRay, bound: f64) -> Self {
        Self {
            spheres,
            ray: *ray,
            own: MISS,
            target: MISS,
            nearest: Nearest { t: bound, error: 0.0, sphere: MISS },
            exact: 0,
            query: PhantomData,
        }
    }

    /// Returns bounds of the distance at which the search ends; [`DONE`] if it has ended.
    #[inline(always)]
    pub(super) fn bounds(&self) -> (f32, f32) {
        if Q::ANY && self.nearest.sphere != MISS { (DONE, DONE) } else { self.nearest.bounds() }
    }

    /// Tests the ray against a sphere, and keeps the hit if there is one that is nearer than the hit so far.
    /// Returns whether it is.
    #[inline(always)]
    pub(super) fn test_sphere(&mut self, sphere: usize) -> bool {
        if self.is_same(sphere, self.own) || self.is_same(sphere, self.target) {
            return false;
        }
        let (center, radius) = self.spheres.exact(sphere);
        let (plain, t) = intersect::confirm_plain(&Pairs::one(&self.ray, center, radius));
        if !plain {
            return self.test_sphere_closely(sphere);
        }
        self.update_if_nearer(Nearest { t, error: t * CLEAR, sphere: sphere as u32 })
    }

    /// Does what [`Decision::test_sphere`] does where the short test in double precision can't tell.
    #[inline(never)]
    fn test_sphere_closely(&mut self, sphere: usize) -> bool {
        let root = self.confirm(sphere);
        self.update_if_root(sphere, root)
    }

    /// Decides whether and where the ray hits a sphere, which is neither its own nor its target.
    fn confirm(&self, sphere: usize) -> Option<Root> {
        let (center, radius) = self.spheres.exact(sphere);
        let inside = || self.starts_within(center, radius);
        intersect::confirm(&self.ray, center, radius, inside)
    }

    /// Returns the distance of a sphere along the ray, whether or not others are nearer, and whether the ray starts inside.
    pub(super) fn intersects(&self, sphere: usize) -> Option<(Root, bool)> {
        if self.is_same(sphere, self.own) || self.is_same(sphere, self.target) {
            return None;
        }
        let (center, radius) = self.spheres.exact(sphere);
        let (plain, t) = intersect::confirm_plain(&Pairs::one(&self.ray, center, radius));
        if plain {
            return Some((Root { t, error: t * CLEAR, exact: false }, false));
        }
        let root = self.confirm(sphere)?;
        let (outside, error) = (power(self.ray.origin, center, radius), self.ray.origin_error);
        let on_surface = error > 0.0 && outside.abs() <= error * (2.0 * radius + error);
        let inside = if on_surface { self.starts_within(center, radius) } else { outside < 0.0 };
        Some((root, inside))
    }

    /// Does what [`Decision::test_sphere`] does for a ray that starts far from all spheres: the distance gets its
    /// closest bound, for others would be wider than the scene.
    pub(super) fn test_sphere_from_afar(&mut self, sphere: usize) -> bool {
        let (center, radius) = self.spheres.exact(sphere);
        let root = intersect::confirm_closely(&self.ray, center, radius, || false);
        self.update_if_root(sphere, root)
    }

    /// [`Decision::update_if_nearer`], if there is a hit.
    fn update_if_root(&mut self, sphere: usize, root: Option<Root>) -> bool {
        root.is_some_and(|Root { t, error, exact }| {
            self.exact += u64::from(exact);
            self.update_if_nearer(Nearest { t, error, sphere: sphere as u32 })
        })
    }

    /// Keeps a hit if it is nearer than the hit so far. Returns whether it is.
    #[inline(always)]
    fn update_if_nearer(&mut self, hit: Nearest) -> bool {
        let nearer = self.is_nearer(hit);
        if nearer {
            self.nearest = hit;
        }
        nearer
    }

    /// Returns whether `sphere` is sphere `known` of the ray, or coincides with it. A sphere that
    /// coincides with `known` comes later in the scene, or it would be known instead.
    #[inline(always)]
    fn is_same(&self, sphere: usize, known: u32) -> bool {
        known == sphere as u32
            || ((known as usize) < self.spheres.len()
                && self.spheres.exact(known as usize) == self.spheres.exact(sphere))
    }

    /// Returns whether the ray, whose origin is on the surface of a sphere, within rounding, starts on
    /// another sphere that touches it from within.
    fn starts_within(&self, center: DVec3, radius: f64) -> bool {
        let own = self.own as usize;
        if own >= self.spheres.len() {
            return false;
        }
        let (own_center, own_radius) = self.spheres.exact(own);
        let origin = self.ray.origin;
        own_radius < radius && (origin - own_center).dot(origin - center) > 0.0
    }

    /// Returns whether a hit replaces the hit so far.
    #[inline(always)]
    fn is_nearer(&mut self, hit: Nearest) -> bool {
        let (Nearest { t, error, sphere }, nearest) = (hit, self.nearest);
        if t + error < nearest.t - nearest.error {
            return true;
        }
        if t - error > nearest.t + nearest.error {
            return false;
        }
        match self.compare(hit) {
            Ordering::Less => true,
            Ordering::Equal => !Q::ANY && self.precedes(sphere as usize, nearest.sphere),
            Ordering::Greater => false,
        }
    }

    /// Compares a hit with the hit so far where their distances are closer than their errors: by
    /// closer bounds, then on integers.
    #[cold]
    fn compare(&mut self, hit: Nearest) -> Ordering {
        let nearest = self.nearest;
        let exact = |hit: Nearest| self.spheres.exact(hit.sphere as usize);
        if nearest.error != 0.0 && exact(hit) == exact(nearest) {
            return Ordering::Equal;
        }
        let first = self.root(hit);
        let second = self.root(nearest);
        let gap = first.0.t - second.0.t;
        if gap.abs() > first.0.error + second.0.error {
            return gap.total_cmp(&0.0);
        }
        self.exact += 1;
        exact::compare(&self.ray, &first.1, &second.1)
    }

    /// Returns the distance of a hit with its closest bound, and its definition. An error of 0 says
    /// that the distance is a given number.
    fn root(&self, hit: Nearest) -> (Root, Distance) {
        let Nearest { t, error, sphere } = hit;
        let number = Root { t, error: 0.0, exact: false };
        if error == 0.0 {
            return (number, Distance::Number(t));
        }
        let (center, radius) = self.spheres.exact(sphere as usize);
        let root = intersect::confirm_closely(&self.ray, center, radius, || false);
        (root.unwrap_or(number), Distance::Hit(center, radius))
    }

    /// Returns whether `sphere` comes before `other` in the user's scene; the ground comes last,
    /// and a bound is no hit.
    fn precedes(&self, sphere: usize, other: u32) -> bool {
        other != MISS
            && self.spheres.id.get(other as usize).is_none_or(|&id| self.spheres.id[sphere] < id)
    }
}
