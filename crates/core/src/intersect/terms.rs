//! Terms of the decision in double precision, and the bounds of their errors: see the [module's
//! documentation](super).

use super::E;
use crate::lanes::Doubles;
use crate::ray::ExactRay;
use crate::vec3::Vec3;
use glam::DVec3;

/// 2 x 2^20 x 8 E: how many times their bounds chord and side are, for terms that are clear. Its square
/// is for the mixed product.
const PART: f64 = 1.0 / (1_u64 << 28) as f64;

/// Rounded terms of the decision about a ray and a sphere; or about a row of each, in lanes.
pub(super) struct Terms<D> {
    /// Squared length of the direction.
    pub(super) a: D,
    /// Way to the middle of the chord, times `a`.
    pub(super) b: D,
    /// Squared distance of the origin from the center.
    pub(super) distance2: D,
    /// Squared distance of the line from the center.
    pub(super) p2: D,
    pub(super) r2: D,
    /// Squared half of the chord; negative where the line misses.
    pub(super) chord2: D,
    /// Negative inside, 0 on the surface, positive outside.
    pub(super) outside: D,
}

impl<D: Doubles> Terms<D> {
    #[inline(always)]
    pub(super) fn new(origin: Vec3<D>, direction: Vec3<D>, center: Vec3<D>, radius: D) -> Self {
        let from_center = origin - center;
        let distance2 = from_center.dot_unfused(from_center);
        let a = direction.dot_unfused(direction);
        let b = -from_center.dot_unfused(direction);
        let perpendicular = from_center + direction * (b / a);
        let p2 = perpendicular.dot_unfused(perpendicular);
        let r2 = radius * radius;
        Self { a, b, distance2, p2, r2, chord2: r2 - p2, outside: distance2 - r2 }
    }

    /// Lanes in which chord and side are at least 2^20 times their bounds, without a root: so the relative
    /// error of the distance is below 2 x 2^-20 and a little, for that of `b` is at most 2^-36
    /// then. A line that certainly misses is clear as well.
    #[inline(always)]
    pub(super) fn are_clear(&self) -> D::Mask {
        let (part, part2) = (D::splat(PART), D::splat(PART * PART));
        let chord2 = self.chord2.abs();
        (part * (self.p2 + self.r2)).lt(chord2)
            & (part2 * self.distance2 * self.p2).lt(chord2 * chord2)
            & (part2 * self.distance2).lt(chord2)
            & (part * (self.distance2 + self.r2)).lt(self.outside.abs())
            & D::splat(0.0).lt(self.a)
            & self.a.lt(D::splat(f64::INFINITY))
    }

    /// [`Terms::are_clear`] and the line meets the sphere, by fewer operations: for rays and spheres of
    /// single precision, whose squares neither overflow nor underflow. A zero direction, and anything
    /// infinite or NaN, is not.
    #[inline(always)]
    pub(super) fn meet_clearly(&self) -> D::Mask {
        // Where the chord is real, `p2` is at most `r2`; and where it is at least its part of the mixed
        // product, that of the squared distance alone is no more, for it is no more than `r2` itself.
        let (part, part2) = (D::splat(PART), D::splat(PART * PART));
        (D::splat(2.0 * PART) * self.r2).lt(self.chord2)
            & (part2 * self.distance2 * self.r2).lt(self.chord2 * self.chord2)
            & (part * (self.distance2 + self.r2)).lt(self.outside.abs())
    }

    /// Lanes in which the origin is outside, and the sphere ahead.
    #[inline(always)]
    pub(super) fn enters(&self) -> D::Mask {
        D::splat(0.0).lt(self.outside) & D::splat(0.0).lt(self.b)
    }

    /// Distance to the hit of a ray that enters the sphere from outside.
    #[inline(always)]
    pub(super) fn near(&self) -> D {
        self.outside.abs() / (self.b.abs() + (self.a * self.chord2).sqrt())
    }

    /// [`Terms::near`], or distance to the hit of a ray that starts inside: the form of
    /// the two in which nothing cancels.
    #[inline(always)]
    pub(super) fn distance(&self) -> D {
        let far = self.outside.lt(D::splat(0.0)) & !self.b.lt(D::splat(0.0));
        let sum = self.b.abs() + (self.a * self.chord2).sqrt();
        D::select(far, sum, self.outside.abs()) / D::select(far, self.a, sum)
    }
}

impl Terms<f64> {
    pub(super) fn of(ray: &ExactRay, center: DVec3, radius: f64) -> Self {
        Self::new(ray.origin.into(), ray.direction.into(), center.into(), radius)
    }

    /// The distance for signs that are certain; `None` for a miss.
    #[inline(always)]
    pub(super) fn hit(&self) -> Option<f64> {
        let misses = self.chord2 < 0.0 || (self.outside > 0.0 && self.b <= 0.0);
        (!misses).then(|| self.distance())
    }

    pub(super) fn chord2_error(&self) -> f64 {
        let mixed = self.distance2.sqrt() * self.p2.sqrt();
        8.0 * E * (mixed + self.p2 + self.r2) + (16.0 * E).powi(2) * self.distance2
    }

    pub(super) fn outside_error(&self) -> f64 {
        8.0 * E * (self.distance2 + self.r2)
    }

    /// Bound of the error of [`Terms::distance`], relative.
    pub(super) fn distance_error(&self, b_magnitude: f64) -> f64 {
        let root = (self.a * self.chord2).sqrt();
        let root_error = root * (self.chord2_error() / self.chord2 + 4.0 * E);
        let sum = self.b.abs() + root;
        let side = self.outside_error() / self.outside.abs();
        1.01 * (side + (4.0 * E * b_magnitude + root_error) / sum) + 8.0 * E
    }
}
