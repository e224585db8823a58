//! The three tests everything rests on: ray against sphere in single precision as a filter, ray
//! against sphere in double precision as the decision, ray against box.
//!
//! # Exact visibility without an epsilon
//!
//! [`filter`] runs in lanes. It may let a miss pass; it never rejects what [`confirm`] accepts.
//! `confirm` alone decides whether and where a sphere is hit, and depends on nothing but that ray
//! and that sphere: so every walk, width and tree gives the answer of brute force, to the bit.
//! [`SlabRay::enters`] errs on the same safe side for boxes.
//!
//! # The filter's bound
//!
//! With `u` = 2^-24, `f` the center as seen from the origin and `p` the perpendicular from the
//! center to the ray, rounding moves `|p|` by at most `2u (|f| + 3|p|)` in first order: the error
//! of `t` displaces `p` along the ray, which counts in second order only, and the fused
//! multiply-add rounds `p` itself once. `|f| <= |t||d| + |p|`, and near a tangent `|p|` is about
//! `r`; the band `r (1 + K) + K |t||d|` with `K = 4u` covers it with a factor of about 3 to spare
//! over the widest wrong decision that was measured (1.25 u).

use crate::lanes::Lanes;
use crate::ray::ExactRay;
use crate::vec3::Vec3;
use glam::DVec3;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;

/// Relative width of the filter's band.
const K: f32 = 4.0 * U;

/// Above every absolute error that underflow can cause in the filter, and far below the square of
/// any radius that counts: worlds are scaled so that their largest coordinate is about 1.
const UNDERFLOW: f32 = 1.0 / (1_u128 << 120) as f32;

/// Rays as [`filter`] wants them.
#[derive(Clone, Copy, Debug)]
pub struct FilterRay<L> {
    origin: Vec3<L>,
    direction: Vec3<L>,
    /// `1 / |direction|^2`.
    inverse_length2: L,
    /// `K |direction|`.
    band: L,
}

impl<L: Lanes> FilterRay<L> {
    /// `direction` is neither zero nor so long or short that its square overflows or underflows.
    #[inline(always)]
    pub fn new(origin: Vec3<L>, direction: Vec3<L>) -> Self {
        let length2 = direction.dot(direction);
        Self {
            origin,
            direction,
            inverse_length2: L::splat(1.0) / length2,
            band: length2.sqrt() * L::splat(K),
        }
    }
}

/// The lanes whose ray may hit the sphere at a distance in `0..=t_max`.
///
/// Never false where [`confirm`] finds a hit not beyond `t_max`; comparisons are arranged so that
/// NaN passes. The form is Embree's: the chord's middle, relative to the center, so that the
/// discriminant does not cancel for spheres that are small or far (Haines, Günther, Akenine-Möller,
/// "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems 2019).
#[inline(always)]
pub fn filter<L: Lanes>(ray: &FilterRay<L>, center: Vec3<L>, radius: L, t_max: L) -> L::Mask {
    let to_center = center - ray.origin;
    let t = to_center.dot(ray.direction) * ray.inverse_length2;
    let perpendicular = to_center.along(ray.direction, -t);
    let distance2 = perpendicular.dot_add(perpendicular, L::splat(-UNDERFLOW));
    let reach = t.abs().mul_add(ray.band, radius * L::splat(1.0 + K));
    // Not fused: where both squares overflow, inf - inf is NaN, which passes.
    let chord2 = reach * reach - distance2;
    let slack = t.abs() * L::splat(K);
    let half = (chord2 * ray.inverse_length2).sqrt().mul_add(L::splat(1.0 + 2.0 * K), slack);
    let zero = L::splat(0.0);
    !(chord2.lt(zero)) & !(t_max.lt(t - half)) & !((t + half).lt(zero))
}

/// Distance, in units of the direction's length, at which a ray hits a sphere; `None` if it does
/// not.
///
/// Outside, that is the near root; inside, the far one. Where the origin is on the surface, within
/// its own rounding, the direction decides: a ray that leaves misses, a ray that enters hits the
/// far side. The arithmetic is that of Haines et al. 2019 in double precision, which decides
/// rightly unless the ray's distance from being tangent is below about 2^-50 of its distance from
/// the center. Zero directions, and anything infinite or NaN, miss.
#[inline(always)]
pub fn confirm(ray: &ExactRay, center: DVec3, radius: f64) -> Option<f64> {
    let from_center = ray.origin - center;
    let a = ray.direction.length_squared();
    let b = -from_center.dot(ray.direction);
    let perpendicular = from_center + ray.direction * (b / a);
    let chord2 = radius * radius - perpendicular.length_squared();
    // NaN compares false.
    let line_hits = chord2 >= 0.0 && a > 0.0 && a < f64::INFINITY;
    if !line_hits {
        return None;
    }
    let outside = from_center.length_squared() - radius * radius;
    let band = ray.origin_error * (2.0 * radius + ray.origin_error);
    let root = (a * chord2).sqrt();
    if outside > band {
        (b > 0.0).then(|| outside / (b + root))
    } else if outside < -band {
        Some(if b >= 0.0 { (b + root) / a } else { outside / (b - root) })
    } else {
        (b > 0.0).then(|| 2.0 * b / a)
    }
}

/// Rays as the box test wants them.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay<L: Lanes> {
    origin: Vec3<L>,
    inverse: Vec3<L>,
    negative: Vec3<L::Mask>,
}

impl<L: Lanes> SlabRay<L> {
    /// A zero in the direction is welcome, of either sign.
    #[inline(always)]
    pub fn new(origin: Vec3<L>, direction: Vec3<L>) -> Self {
        let inverse = direction.map(|d| L::splat(1.0) / d);
        Self { origin, inverse, negative: inverse.map(L::is_negative) }
    }

    /// The lanes whose ray may meet the box at a distance in `0..=t_max`.
    ///
    /// Never false where a point of the box lies on the ray: each distance is off by at most 3 u of
    /// itself (one subtraction, one reciprocal, one product), which the factor on the far side
    /// outweighs (Ize, "Robust BVH Ray Traversal", JCGT 2013). A ray that lies in a face's plane
    /// makes 0 x inf = NaN, which the operand order of `min` and `max` drops, so that slab does not
    /// bound it.
    #[inline(always)]
    pub fn enters(&self, low: [f32; 3], high: [f32; 3], t_max: L) -> L::Mask {
        let (near_x, far_x) = slab(low[0], high[0], self.origin.x, self.inverse.x, self.negative.x);
        let (near_y, far_y) = slab(low[1], high[1], self.origin.y, self.inverse.y, self.negative.y);
        let (near_z, far_z) = slab(low[2], high[2], self.origin.z, self.inverse.z, self.negative.z);
        let near = near_x.max(near_y.max(near_z.max(L::splat(0.0))));
        let far = far_x.min(far_y.min(far_z.min(t_max)));
        near.le(far * L::splat(1.0 + 6.0 * U))
    }
}

/// Where rays cross the two planes of one axis, in their own order.
#[inline(always)]
fn slab<L: Lanes>(low: f32, high: f32, origin: L, inverse: L, negative: L::Mask) -> (L, L) {
    let (low, high) = (L::splat(low), L::splat(high));
    let near = L::select(negative, high, low);
    let far = L::select(negative, low, high);
    ((near - origin) * inverse, (far - origin) * inverse)
}

/// Distance at which a ray crosses the plane `normal . p = height`; `None` if it does not.
///
/// Where the origin is on the plane, within its own rounding, a ray against the normal hits it at
/// once and any other misses.
#[inline(always)]
pub fn plane(ray: &ExactRay, normal: DVec3, height: f64) -> Option<f64> {
    let above = normal.dot(ray.origin) - height;
    let descent = -normal.dot(ray.direction);
    let t = above / descent;
    if above.abs() <= ray.origin_error {
        return (descent > 0.0).then_some(t.max(0.0));
    }
    (t > 0.0 && t < f64::INFINITY).then_some(t)
}
