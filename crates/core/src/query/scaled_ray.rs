//! Rays one by one: those of which there is only one, and those whose coordinates or distances single precision
//! cannot hold.

use super::batch::FoundHit;
use super::{SphereTree, Tally};
use crate::bvh::{Query, trace_one};
use crate::elementary;
use crate::exact::{self, Distance};
use crate::intersect;
use crate::ray::ExactRay;
use crate::vec3::Vec3 as Coordinates;
use glam::Vec3;
use std::cmp::Ordering;

/// Origins farther than this many times the largest coordinate are beyond what single precision can
/// filter: such rays are tested against every sphere.
pub(super) const REACH: f64 = (1 << 20) as f64;

/// A ray in a tree's units.
#[derive(Clone, Copy)]
pub(super) struct ScaledRay {
    pub(super) ray: ExactRay,
    /// One unit of the scaled ray's distance, in units of the user's direction.
    pub(super) unit: f64,
}

impl ScaledRay {
    fn is_far(&self) -> bool {
        self.ray.origin.abs().max_element() > REACH
    }
}

impl SphereTree {
    /// Traces one ray, plain or not.
    pub(super) fn trace_one<Q: Query>(
        &self,
        (origin, direction): ([f32; 3], [f32; 3]),
        bound: f64,
        tally: &mut Tally,
    ) -> Option<FoundHit> {
        let scaled = self.scaled(origin, direction).filter(|_| !bound.is_nan());
        let Some(scaled) = scaled else {
            tally.invalid += 1;
            return None;
        };
        let bound = bound / scaled.unit;
        if scaled.is_far() {
            tally.exact += 1;
            let hit = self.test_all(&scaled, bound)?;
            return Some(FoundHit { t: self.distance::<Q>(&scaled, hit.sphere, hit.t), ..hit });
        }
        let hit = trace_one::<Q>(self.tree(), &scaled.ray, bound);
        tally.exact += hit.exact;
        let sphere = hit.sphere as usize;
        let id = *self.spheres.id.get(sphere)?;
        Some(FoundHit { sphere, id, t: self.distance::<Q>(&scaled, sphere, hit.t) })
    }

    /// Returns a hit's distance in the user's units, rounded if that is asked for; `t` is in the tree's units.
    fn distance<Q: Query>(
        &self,
        ScaledRay { ray, unit }: &ScaledRay,
        sphere: usize,
        t: f64,
    ) -> f64 {
        if !Q::ROUNDED {
            return t * unit;
        }
        let origin = ray.origin.as_vec3();
        let coarse = self.spheres.coarse
            && origin.as_dvec3() == ray.origin
            && Coordinates::from(origin).is_coarse();
        intersect::nearest(ray, self.spheres.exact(sphere), t, coarse) * unit
    }

    /// A ray in the tree's units; `None` if it is no ray.
    pub(super) fn scaled(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<ScaledRay> {
        let (origin, direction) = (Vec3::from(origin).as_dvec3(), Vec3::from(direction).as_dvec3());
        let longest = direction.abs().max_element();
        if !(origin.is_finite() && direction.is_finite() && longest > 0.0) {
            return None;
        }
        let shrink = elementary::power_of_two(-elementary::floor_log2(longest));
        let (origin, direction) = (origin * self.scale, direction * shrink);
        let ray = ExactRay { origin, direction, origin_error: 0.0 };
        Some(ScaledRay { ray, unit: shrink / self.scale })
    }

    /// Tests every sphere, for rays from so far away that the filter cannot tell anything. The hit is in the
    /// tree's units.
    fn test_all(&self, scaled: &ScaledRay, bound: f64) -> Option<FoundHit> {
        let mut best: Option<FoundHit> = None;
        let mut nearest = Distance::Number(bound);
        for row in 0..self.spheres.len() {
            let (center, radius) = self.spheres.exact(row);
            let root = intersect::confirm_closely(&scaled.ray, center, radius, || true);
            let Some(root) = root else { continue };
            let distance = Distance::Hit(center, radius);
            let order = match nearest {
                Distance::Number(f64::INFINITY) => Ordering::Less,
                _ => exact::compare(&scaled.ray, &distance, &nearest),
            };
            let id = self.spheres.id[row];
            let first = best.as_ref().is_some_and(|best| id < best.id);
            if order.is_lt() || (order.is_eq() && first) {
                nearest = distance;
                best = Some(FoundHit { sphere: row, id, t: root.t });
            }
        }
        best
    }
}
