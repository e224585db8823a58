//! Rays one by one: those of which there is only one, and those whose coordinates or distances single precision
//! cannot hold.

use super::answers::FoundHit;
use super::{SphereTree, Tally};
use crate::bvh::{Query, trace_far, trace_one};
use crate::elementary;
use crate::exact::{self, Distance};
use crate::intersect::{self, CLEAR};
use crate::ray::ExactRay;
use crate::vec3::Vec3 as Coordinates;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// Origins with a larger coordinate than this are too far for the conservative tests as they are, in the tree's units.
pub(super) const REACH: f32 = (1 << 20) as f32;

/// How many extents of a leaf away an origin may be at most: from farther, bounds of the conservative tests let so much
/// pass that a ray alone, moved nearer, takes less time than one of a packet (measured with 100 000 spheres).
pub(super) const REACH_IN_LEAVES: f32 = (1 << 13) as f32;

/// Origins with a larger coordinate than this are too far for the conservative tests even if they are moved.
const FAR_REACH: f64 = (1_u64 << 40) as f64;

/// A ray in a tree's units.
#[derive(Clone, Copy)]
pub(super) struct ScaledRay {
    pub(super) ray: ExactRay,
    /// One unit of the scaled ray's distance, in units of the user's direction.
    pub(super) unit: f64,
}

impl ScaledRay {
    /// A ray with its origin multiplied by `scale`, and its direction by a power of two that makes its largest
    /// coordinate at least 1 and less than 2; `None` if it is no ray. `unscale` is the reciprocal of `scale`.
    #[inline(always)]
    pub(super) fn new(
        (origin, direction): ([f32; 3], [f32; 3]),
        [scale, unscale]: [f64; 2],
    ) -> Option<Self> {
        let (origin, direction) = (Vec3::from(origin), Vec3::from(direction));
        let longest = direction.abs().max_element();
        if !(origin.is_finite() && direction.is_finite() && longest > 0.0) {
            return None;
        }
        let shrink = elementary::power_of_two(-elementary::floor_log2(f64::from(longest)));
        let (origin, direction) = (origin.as_dvec3() * scale, direction.as_dvec3() * shrink);
        let ray = ExactRay { origin, direction, origin_error: 0.0 };
        Some(Self { ray, unit: shrink * unscale })
    }
}

impl SphereTree {
    /// Traces one ray, plain or not.
    #[inline(always)]
    pub(super) fn trace_one<Q: Query>(
        &self,
        ray: ([f32; 3], [f32; 3]),
        bound: f64,
        tally: &mut Tally,
    ) -> Option<FoundHit> {
        let scaled = ScaledRay::new(ray, self.scale).filter(|_| !bound.is_nan());
        let Some(scaled) = scaled else {
            tally.invalid += 1;
            return None;
        };
        self.trace_scaled::<Q>(ray, &scaled, bound, tally)
    }

    /// Traces one ray, which is given in the tree's units as well.
    #[inline(always)]
    pub(super) fn trace_scaled<Q: Query>(
        &self,
        ray: ([f32; 3], [f32; 3]),
        scaled: &ScaledRay,
        bound: f64,
        tally: &mut Tally,
    ) -> Option<FoundHit> {
        let hit = self.trace_tree::<Q>(scaled, bound, tally);
        if self.strays.is_empty() { hit } else { self.with_strays::<Q>(ray, bound, hit, tally) }
    }

    /// Finds the hit of a ray among the spheres of the tree.
    #[inline(always)]
    fn trace_tree<Q: Query>(
        &self,
        scaled: &ScaledRay,
        bound: f64,
        tally: &mut Tally,
    ) -> Option<FoundHit> {
        let bound = bound / scaled.unit;
        let farthest = scaled.ray.origin.abs().max_element();
        let hit = if farthest <= f64::from(self.reach.to_array()[0]) {
            trace_one::<Q>(self.tree(), &scaled.ray, bound)
        } else if farthest <= FAR_REACH {
            trace_far::<Q>(self.tree(), &scaled.ray, bound)
        } else {
            return self.test_all::<Q>(scaled, bound, tally);
        };
        tally.exact += hit.exact;
        let sphere = hit.sphere as usize;
        let id = *self.spheres.id.get(sphere)?;
        Some(FoundHit { sphere, id, t: self.distance::<Q>(scaled, sphere, hit.t) })
    }

    /// Returns the distance of a hit in the user's units, rounded if that is asked for; `t` is in the tree's units.
    #[inline(always)]
    fn distance<Q: Query>(&self, scaled: &ScaledRay, sphere: usize, t: f64) -> f64 {
        let ScaledRay { ray, unit } = scaled;
        if !Q::ROUNDED {
            return t * unit;
        }
        let origin = ray.origin.as_vec3();
        let coarse = self.spheres.coarse
            && origin.as_dvec3() == ray.origin
            && Coordinates::from(origin).is_coarse();
        let (center, radius) = self.spheres.exact(sphere);
        intersect::nearest(ray, center, radius, t, coarse) * unit
    }

    /// Tests every sphere: for rays from so far away that nothing else can tell, but for those that pass all.
    #[inline(never)]
    fn test_all<Q: Query>(
        &self,
        scaled: &ScaledRay,
        bound: f64,
        tally: &mut Tally,
    ) -> Option<FoundHit> {
        let ExactRay { origin, direction, .. } = scaled.ray;
        // All spheres are in the cube from -1 to 1. The line's distance from its middle is off by less than 2^-48 of
        // the origin's.
        let passes = origin - direction * (origin.dot(direction) / direction.length_squared());
        let doubt = origin.abs().max_element() / (1_u64 << 48) as f64;
        if passes.length() - doubt > 2.0 {
            return None;
        }
        let mut nearest = NearestOfAll::new(&scaled.ray, bound);
        for row in 0..self.spheres.len() {
            let (center, radius) = self.spheres.exact(row);
            nearest.test(row, self.spheres.id[row], (center, radius), tally);
        }
        let (sphere, id) = nearest.found?;
        Some(FoundHit { sphere, id, t: self.distance::<Q>(scaled, sphere, nearest.t) })
    }

    /// Returns the nearest of a hit of the tree and of hits of strays, or any.
    #[inline(never)]
    pub(super) fn with_strays<Q: Query>(
        &self,
        ray: ([f32; 3], [f32; 3]),
        bound: f64,
        hit: Option<FoundHit>,
        tally: &mut Tally,
    ) -> Option<FoundHit> {
        if Q::ANY && hit.is_some() {
            return hit;
        }
        // In units that make the strays' largest coordinate about 1: there nothing overflows.
        let Some(scaled) = ScaledRay::new(ray, self.stray_scale) else { return hit };
        let mut nearest = NearestOfAll::new(&scaled.ray, bound / scaled.unit);
        if let Some(hit) = &hit {
            let (center, radius) = self.spheres.exact(hit.sphere);
            let factor = self.stray_scale[0] * self.scale[1];
            nearest.distance = Distance::Hit(center * factor, radius * factor);
            nearest.t = hit.t / scaled.unit;
            nearest.error = nearest.t * CLEAR;
            nearest.found = Some((hit.sphere, hit.id));
        }
        for (i, &(center, radius, id)) in self.strays.iter().enumerate() {
            nearest.test(self.spheres.len() + i, id, (center, radius), tally);
        }
        let (sphere, id) = nearest.found?;
        let Some(stray) = sphere.checked_sub(self.spheres.len()) else { return hit };
        let (center, radius, _) = self.strays[stray];
        let t = if Q::ROUNDED {
            intersect::nearest(&scaled.ray, center, radius, nearest.t, false)
        } else {
            nearest.t
        };
        Some(FoundHit { sphere, id, t: t * scaled.unit })
    }
}

/// The nearest of some spheres that a ray hits, one after the other.
struct NearestOfAll<'a> {
    ray: &'a ExactRay,
    distance: Distance,
    t: f64,
    /// `distance` is no farther from `t` than this.
    error: f64,
    /// Row and id of the sphere.
    found: Option<(usize, u32)>,
}

impl<'a> NearestOfAll<'a> {
    /// No hit yet; those at `bound` or beyond do not count.
    fn new(ray: &'a ExactRay, bound: f64) -> Self {
        Self { ray, distance: Distance::Number(bound), t: bound, error: 0.0, found: None }
    }

    /// Tests a sphere.
    fn test(&mut self, row: usize, id: u32, sphere: (DVec3, f64), tally: &mut Tally) {
        let Some(root) = intersect::confirm(self.ray, sphere.0, sphere.1, || true) else { return };
        tally.exact += u64::from(root.exact);
        let distance = Distance::Hit(sphere.0, sphere.1);
        let order = if root.t + root.error < self.t - self.error {
            Ordering::Less
        } else if root.t - root.error > self.t + self.error {
            Ordering::Greater
        } else {
            tally.exact += 1;
            exact::compare(self.ray, &distance, &self.distance)
        };
        if order.is_lt() || order.is_eq() && self.found.is_some_and(|(_, first)| id < first) {
            let error = root.error;
            *self = Self { distance, t: root.t, error, found: Some((row, id)), ..*self };
        }
    }
}
