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
//!
//! # The decision's bounds
//!
//! With `E` = 2^-53, `F` from the center to the origin, of length `f`, `a = d.d`, `b = -F.d`, and
//! `p` the length of the perpendicular `P = F + d b/a`:
//!
//! - `F` is off by `E f`, and each product and sum adds `E` of itself. So `b` is off by at most
//!   `4 E sum |F_i d_i|`, and `F.F - r^2` by at most `8 E (f^2 + r^2)`.
//! - `b/a` is off by at most `8 E f / |d|`, which moves `P` by `8 E f` along the ray; rounding `F`,
//!   the products and the sums moves it by at most `E (2 f + p)` in any direction. What is along the
//!   ray is at a right angle to `P` and counts in second order only, so `P.P` is off by at most
//!   `2 p E (2 f + p) + (E (2 f + p) + 8 E f)^2`.
//! - With the sum of three squares, `r^2` and the last difference, `r^2 - P.P` is off by at most
//!   `E (4 f p + 6 p^2 + 2 r^2) + (11 E f)^2`. The code's bound,
//!   `8 E (f p + p^2 + r^2) + (16 E f)^2`, leaves room for third order and for its own rounding.
//! - The root of `x (1 + e)` is off by less than `e` of itself, and errors of products and quotients
//!   add up, in first order; 1 % on top covers the second.
//!
//! A sign is taken from double precision only where the value is beyond its bound. Underflow does
//! not matter: the least product of four single-precision numbers is 1e-180.

use crate::exact;
use crate::lanes::Lanes;
use crate::ray::ExactRay;
use crate::vec3::Vec3;
use glam::DVec3;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;

/// Unit roundoff of `f64`.
const E: f64 = f64::EPSILON / 2.0;

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

/// The lanes whose ray may hit the sphere at a distance in `0..=t_max`, and a bound below which it does
/// not.
///
/// Never false where [`confirm`] finds a hit not beyond `t_max`; comparisons are arranged so that
/// NaN passes. The form is Embree's: the chord's middle, relative to the center, so that the
/// discriminant does not cancel for spheres that are small or far (Haines, Günther, Akenine-Möller,
/// "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems 2019).
#[inline(always)]
pub fn filter<L: Lanes>(ray: &FilterRay<L>, center: Vec3<L>, radius: L, t_max: L) -> (L::Mask, L) {
    let to_center = center - ray.origin;
    let t = to_center.dot(ray.direction) * ray.inverse_length2;
    let perpendicular = to_center.along(ray.direction, -t);
    let distance2 = perpendicular.dot_add(perpendicular, L::splat(-UNDERFLOW));
    let reach = t.abs().mul_add(ray.band, radius * L::splat(1.0 + K));
    // Not fused: where both squares overflow, inf - inf is NaN, which passes.
    let chord2 = reach * reach - distance2;
    let slack = t.abs() * L::splat(K);
    let half = (chord2 * ray.inverse_length2).sqrt().mul_add(L::splat(1.0 + 2.0 * K), slack);
    let (zero, near) = (L::splat(0.0), t - half);
    (!(chord2.lt(zero)) & !(t_max.lt(near)) & !((t + half).lt(zero)), near)
}

/// Where a ray hits a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Distance in units of the direction's length, more than 0.
    pub t: f64,
    /// The true distance is no farther from `t` than this; 0 where `t` is so by definition.
    pub error: f64,
    /// Whether it took arithmetic without rounding to decide that there is a hit.
    pub exact: bool,
}

/// Whether and where a ray hits a sphere; the answer is that of arithmetic without rounding.
///
/// Outside, that is the near root; inside, the far one; a tangent hits. Where the origin is on the
/// surface the direction decides: a ray that leaves misses, a ray that enters hits the far side. On
/// the surface is exactly so, or for an origin that was rounded itself ([`ExactRay::origin_error`])
/// within that rounding; then `inside` says whether the ray is inside nevertheless, as on a sphere that
/// touches this one from within, and if it is not, a ray that enters hits at once. Zero directions, and anything infinite or NaN, miss.
///
/// The form is that of Haines et al. 2019 in double precision, with the bounds of the [module's
/// documentation](self); where they cannot decide, [`exact::hit`] does.
#[inline(always)]
pub fn confirm(
    ray: &ExactRay,
    center: DVec3,
    radius: f64,
    inside: impl FnOnce() -> bool,
) -> Option<Root> {
    let terms = Terms::new(ray, center, radius);
    // NaN compares false, here and below.
    let clear = terms.are_clear() && terms.a > 0.0 && terms.a < f64::INFINITY;
    let band = ray.origin_error * (2.0 * radius + ray.origin_error);
    if clear && terms.outside.abs() > band {
        let t = terms.distance(terms.chord2)?;
        return Some(Root { t, error: t * CLEAR, exact: false });
    }
    confirm_closely(ray, center, radius, inside)
}

/// Relative errors of distances above this are not put up with.
const COARSE: f64 = 1.0 / (1 << 30) as f64;

/// Bound of a [`Terms::distance`]'s relative error if the terms are clear.
const CLEAR: f64 = 1.0 / (1 << 18) as f64;

/// What the decision about a ray and a sphere is made of, rounded.
struct Terms {
    /// Squared length of the direction.
    a: f64,
    /// Way to the middle of the chord, times `a`.
    b: f64,
    /// Sum of the magnitudes of the products in `b`.
    b_magnitude: f64,
    /// Squared distance of the origin from the center.
    distance2: f64,
    /// Squared distance of the line from the center.
    p2: f64,
    r2: f64,
    /// Squared half of the chord; negative where the line misses.
    chord2: f64,
    /// Negative inside, 0 on the surface, positive outside.
    outside: f64,
}

impl Terms {
    #[inline(always)]
    fn new(ray: &ExactRay, center: DVec3, radius: f64) -> Self {
        let from_center = ray.origin - center;
        let distance2 = from_center.length_squared();
        let a = ray.direction.length_squared();
        let products = from_center * ray.direction;
        let b = -products.element_sum();
        let p2 = (from_center + ray.direction * (b / a)).length_squared();
        let r2 = radius * radius;
        let b_magnitude = products.abs().element_sum();
        Self { a, b, b_magnitude, distance2, p2, r2, chord2: r2 - p2, outside: distance2 - r2 }
    }

    /// Whether chord and side are at least 2^20 times their bounds, without a root: so the relative
    /// error of the distance is below 2 x 2^-20 and a little, for that of `b` is at most 2^-36
    /// then. A line that certainly misses is clear as well.
    #[inline(always)]
    fn are_clear(&self) -> bool {
        // 2 x 2^20 x 8 E, and its square for the mixed product.
        const PART: f64 = 1.0 / (1_u64 << 28) as f64;
        let chord2 = self.chord2.abs();
        chord2 > PART * (self.p2 + self.r2)
            && chord2 * chord2 > PART * PART * self.distance2 * self.p2
            && chord2 > PART * PART * self.distance2
            && self.outside.abs() > PART * (self.distance2 + self.r2)
    }

    /// The distance for signs that are certain; `None` for a miss.
    #[inline(always)]
    fn distance(&self, chord2: f64) -> Option<f64> {
        let outside = self.outside > 0.0;
        if chord2 < 0.0 || (outside && self.b <= 0.0) {
            return None;
        }
        let root = (self.a * chord2).sqrt();
        // The form of the two in which nothing cancels.
        let sum = self.b.abs() + root;
        let far = !outside && self.b >= 0.0;
        Some(if far { sum / self.a } else { self.outside.abs() / sum })
    }

    fn chord2_error(&self) -> f64 {
        let mixed = (self.distance2 * self.p2).sqrt();
        8.0 * E * (mixed + self.p2 + self.r2) + (16.0 * E).powi(2) * self.distance2
    }

    fn outside_error(&self) -> f64 {
        8.0 * E * (self.distance2 + self.r2)
    }

    /// Bound of the error of [`Terms::distance`], relative.
    fn distance_error(&self) -> f64 {
        let root = (self.a * self.chord2).sqrt();
        let root_error = root * (self.chord2_error() / self.chord2 + 4.0 * E);
        let sum = self.b.abs() + root;
        let side = self.outside_error() / self.outside.abs();
        1.01 * (side + (4.0 * E * self.b_magnitude + root_error) / sum) + 8.0 * E
    }
}

/// [`confirm`] where something is close: bounds in full, and arithmetic without rounding if they
/// are not enough.
#[inline(never)]
pub fn confirm_closely(
    ray: &ExactRay,
    center: DVec3,
    radius: f64,
    inside: impl FnOnce() -> bool,
) -> Option<Root> {
    let terms = Terms::new(ray, center, radius);
    let chord2_error = terms.chord2_error();
    if !(terms.chord2 >= -chord2_error && terms.a > 0.0 && terms.a < f64::INFINITY) {
        return None;
    }
    let band = ray.origin_error * (2.0 * radius + ray.origin_error);
    if ray.origin_error > 0.0 && terms.outside.abs() <= band && terms.chord2 >= 0.0 {
        let through = || 2.0 * terms.b / terms.a;
        let at_once = || terms.outside / (terms.b + (terms.a * terms.chord2).sqrt());
        return (terms.b > 0.0).then(|| {
            let t = if inside() { through() } else { at_once().max(0.0) };
            Root { t, error: 0.0, exact: false }
        });
    }
    if terms.chord2 <= chord2_error || terms.outside.abs() <= terms.outside_error() {
        let away = terms.outside > terms.outside_error() && terms.b < -4.0 * E * terms.b_magnitude;
        return decide(ray, center, radius, away);
    }
    let t = terms.distance(terms.chord2)?;
    let error = terms.distance_error();
    if error > COARSE {
        // That there is a hit is certain, but so close to the surface little is left of the distance.
        return decide(ray, center, radius, false);
    }
    Some(Root { t, error: t * error, exact: false })
}

/// What double precision cannot, but for rays that start outside and head away, which need not be
/// looked at twice.
fn decide(ray: &ExactRay, center: DVec3, radius: f64, away: bool) -> Option<Root> {
    let finite = ray.origin.is_finite() && center.is_finite() && radius.is_finite();
    if away || !finite {
        return None;
    }
    let t = exact::hit(ray, center, radius)?;
    Some(Root { t, error: 16.0 * E * t, exact: true })
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
