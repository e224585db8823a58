//! Ray against sphere in double precision: the decision.
//!
//! # Exact visibility without an epsilon
//!
//! The [filter](crate::conservative) runs in lanes of single precision. It may let a miss pass; it never
//! rejects what [`confirm`] accepts, and calls certain only what `confirm` says too. `confirm` alone
//! decides whether and where a sphere is hit, and depends on nothing but that ray and that sphere: so
//! every walk, width and tree gives the answer of brute force, to the bit.
//! [`Slabs::enters`](crate::slabs::Slabs::enters) errs on the same safe side for boxes.
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
//! A sign is taken from double precision only where the value is beyond its bound.
//!
//! # Range
//!
//! Numbers of single precision are multiples of 2^-149, below 2^128. A [tree](crate::SphereTree) multiplies by
//! a power of two from 2^-129 to 2^149, so that its largest coordinate, radii included, is between 1/2 and 1,
//! and each direction by one that brings its largest coordinate into `1..2`. So coordinates and radii are
//! multiples of 2^-278, origins are below 2^277, and coordinates of directions are multiples of 2^-276. Double
//! precision, whose least normal number is 2^-1022 and whose largest is below 2^1024, has room for products of two
//! such numbers, but not for all products of four. Term by term:
//!
//! - `F`, `a`, `b`, `F.F` and `r^2` are 0 or between 2^-610 and 2^560: a sum that cancels leaves no less than
//!   the last place of a product, and no product is less than 2^-556.
//! - `b/a` is at least 2^-614, and times a coordinate of `d` at least 2^-890. A square in `P.P` underflows where
//!   that coordinate of `P` is below 2^-511. What is lost is less than 2^-1019 in `P.P` and 2^-509 in `p`,
//!   which `8 E f p` takes times `2^-50 f`. As `f` is at least 2^-278, or all are 0, both are less than `E^2
//!   f^2`, and the bound has `(16 E f)^2` where `(11 E f)^2` is enough.
//! - `f p` in the bound is the product of two roots. The root of the product of squares would be 0 where `f p` is
//!   below 2^-537, as it is among spheres of 2^-270; though `E f p` may be far above `E r^2` there.
//! - `Terms::are_clear` and `Terms::meet_clearly` compare products of four. Rounding keeps order, also where
//!   it underflows: if one product is rounded to less than another, it is no more than the other. Where the left
//!   one overflows nothing is clear. Where the right one does, `p` is above 2^255, `f` is below 2^279, and the
//!   left one, `2^-56 f^2 p^2`, is in truth less than `p^4`.
//! - A distance is computed where `r^2 - P.P` and `F.F - r^2` are beyond their bounds, so above 2^-606. It is
//!   between 2^-560 and 2^279: `F.F - r^2` and `b` are multiples of 2^-556.

mod rounding;
mod terms;

pub use self::rounding::{nearest, nearest_closely, nearest_or_exact, nearest_quickly};
use self::terms::Terms;
use crate::exact;
use crate::lanes::{Doubles, F64x8, load_doubles};
use crate::ray::{ExactRay, Rays, rounding};
use crate::spheres::{LEAF, Spheres};
use crate::vec3::Vec3;
use glam::DVec3;

/// Unit roundoff of `f64`.
const E: f64 = f64::EPSILON / 2.0;

/// The distance at which a ray hits a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Distance in units of the direction's length, more than 0.
    pub t: f64,
    /// The true distance is no farther from `t` than this; 0 where `t` is so by definition.
    pub error: f64,
    /// True if it took arithmetic without rounding to decide that there is a hit.
    pub exact: bool,
}

/// Decides whether and where a ray hits a sphere; the answer is that of arithmetic without
/// rounding.
///
/// Outside, that is the near root; inside, the far one; a tangent hits. Where the origin is on the
/// surface the direction decides: a ray that leaves misses, a ray that enters hits the far side. On
/// the surface is exactly so, or for an origin that was rounded itself ([`ExactRay::origin_error`])
/// within that rounding; then `inside` says whether the ray is inside nevertheless, as on a sphere that
/// touches this one from within, and if it is not, a ray that enters hits at once. Zero directions, and anything infinite or NaN, miss.
///
/// The form is that of Haines et al. 2019 in double precision, with the bounds of the module's
/// documentation; where they cannot decide, [`exact::hit`] does.
#[inline(always)]
pub fn confirm(
    ray: &ExactRay,
    center: DVec3,
    radius: f64,
    inside: impl FnOnce() -> bool,
) -> Option<Root> {
    let terms = Terms::of(ray, center, radius);
    let band = ray.origin_error * (2.0 * radius + ray.origin_error);
    if terms.are_clear() && terms.outside.abs() > band {
        let t = terms.hit()?;
        return Some(Root { t, error: t * CLEAR, exact: false });
    }
    confirm_closely(ray, center, radius, inside)
}

/// Rays and spheres in a row: ray `i` and sphere `i` belong together.
#[derive(Clone, Copy, Debug)]
pub struct Pairs<D> {
    /// Origins of the rays.
    pub origin: Vec3<D>,
    /// Directions of the rays.
    pub direction: Vec3<D>,
    /// As [`ExactRay::origin_error`].
    pub origin_error: D,
    /// Centers of the spheres.
    pub center: Vec3<D>,
    /// Radii of the spheres.
    pub radius: D,
}

impl Pairs<f64> {
    /// One of each.
    #[inline(always)]
    pub fn one(ray: &ExactRay, center: DVec3, radius: f64) -> Self {
        Self {
            origin: ray.origin.into(),
            direction: ray.direction.into(),
            origin_error: ray.origin_error,
            center: center.into(),
            radius,
        }
    }
}

/// Rows of a ray and of a sphere that belong together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pair {
    /// The ray's row.
    pub row: u32,
    /// The sphere's row.
    pub sphere: u32,
}

impl Pairs<F64x8> {
    /// Gathers rays and spheres, which single precision holds.
    #[inline(always)]
    pub fn gather(rays: &Rays, spheres: &Spheres, pairs: &[Pair; 8]) -> Self {
        let mut columns = [[0.0; 8]; 10];
        for (lane, pair) in pairs.iter().enumerate() {
            let (row, sphere) = (pair.row as usize, pair.sphere as usize);
            let (origin, direction) = (rays.origin.row(row), rays.direction.row(row));
            let (block, place) = (&spheres.blocks()[sphere / LEAF], sphere % LEAF);
            let sphere = [block.x[place], block.y[place], block.z[place], block.radius[place]];
            let ray = origin.to_array().into_iter().chain(direction.to_array());
            for (column, x) in columns.iter_mut().zip(ray.chain(sphere)) {
                column[lane] = x;
            }
        }
        let row = |i: usize| load_doubles(&columns[i]);
        let vector = |i: usize| Vec3::new(row(i), row(i + 1), row(i + 2));
        let (origin, direction, center, radius) = (vector(0), vector(3), vector(6), row(9));
        // As if all origins were on surfaces, which is no less.
        Self { origin, direction, origin_error: rounding(origin), center, radius }
    }

    /// The ray and the sphere of a lane; the origin is taken as exact.
    pub fn lane(&self, lane: usize) -> (ExactRay, DVec3, f64) {
        let number = |row: F64x8| row.to_array()[lane];
        let vector = |v: Vec3<F64x8>| DVec3::new(number(v.x), number(v.y), number(v.z));
        let (origin, direction) = (vector(self.origin), vector(self.direction));
        let ray = ExactRay { origin, direction, origin_error: 0.0 };
        (ray, vector(self.center), number(self.radius))
    }
}

impl<D: Doubles> Pairs<D> {
    /// Returns the terms of the decision, and the error of origins in the measure of `outside`.
    #[inline(always)]
    fn terms(&self) -> (Terms<D>, D) {
        let terms = Terms::new(self.origin, self.direction, self.center, self.radius);
        let band = self.origin_error * (D::splat(2.0) * self.radius + self.origin_error);
        (terms, band)
    }
}

/// [`confirm`] for pairs that are plain: the lanes whose ray enters the sphere from outside and that are
/// far from any doubt, and the distances; the error of each is at most [`CLEAR`] of it.
#[inline(always)]
pub fn confirm_plain<D: Doubles>(pairs: &Pairs<D>) -> (D::Mask, D) {
    let (terms, band) = pairs.terms();
    let meets = D::splat(0.0).lt(terms.chord2) & band.lt(terms.outside.abs());
    (terms.are_clear() & meets & terms.enters(), terms.near())
}

/// [`confirm_plain`], and lanes whose ray starts inside, for rays and spheres of single precision.
#[inline(always)]
pub fn confirm_either<D: Doubles>(pairs: &Pairs<D>) -> (D::Mask, D) {
    let (terms, band) = pairs.terms();
    let (zero, outside) = (D::splat(0.0), terms.outside);
    let ahead = outside.lt(zero) | zero.lt(terms.b);
    (terms.meet_clearly() & band.lt(outside.abs()) & ahead, terms.distance())
}

/// Relative errors of distances above this are not put up with.
const COARSE: f64 = 1.0 / (1 << 30) as f64;

/// Bound of the relative error of a distance that is far from any doubt.
pub const CLEAR: f64 = 1.0 / (1 << 18) as f64;

/// [`confirm`] where something is close: bounds in full, and arithmetic without rounding if they
/// are not enough.
#[inline(never)]
pub fn confirm_closely(
    ray: &ExactRay,
    center: DVec3,
    radius: f64,
    inside: impl FnOnce() -> bool,
) -> Option<Root> {
    let terms = Terms::of(ray, center, radius);
    let b_magnitude = ((ray.origin - center) * ray.direction).abs().element_sum();
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
        let away = terms.outside > terms.outside_error() && terms.b < -4.0 * E * b_magnitude;
        return decide(ray, center, radius, away);
    }
    let t = terms.hit()?;
    let error = terms.distance_error(b_magnitude);
    if error > COARSE {
        // That there is a hit is certain, but so close to the surface little is left of the distance.
        return decide(ray, center, radius, false);
    }
    Some(Root { t, error: t * error, exact: false })
}

/// Decides exactly where double precision cannot; rays that start outside and head away miss without
/// a further test.
fn decide(ray: &ExactRay, center: DVec3, radius: f64, away: bool) -> Option<Root> {
    let finite = ray.origin.is_finite() && center.is_finite() && radius.is_finite();
    if away || !finite {
        return None;
    }
    let t = exact::hit(ray, center, radius)?;
    Some(Root { t, error: 16.0 * E * t, exact: true })
}

/// A plane, `normal . p = height`.
#[derive(Clone, Copy, Debug)]
pub struct Plane<D> {
    /// A unit vector, up to rounding.
    pub normal: Vec3<D>,
    /// Distance from the coordinates' origin.
    pub height: D,
}

impl<D: Doubles> Plane<D> {
    /// The rays that cross it, of origins, directions and [`ExactRay::origin_error`]; and the distances.
    ///
    /// If the origin is on the plane, within its own rounding, a ray against the normal hits it at once
    /// and any other misses.
    #[inline(always)]
    pub fn crossed(
        &self,
        (origin, direction): (Vec3<D>, Vec3<D>),
        origin_error: D,
    ) -> (D::Mask, D) {
        let zero = D::splat(0.0);
        let above = self.normal.dot_unfused(origin) - self.height;
        let descent = -self.normal.dot_unfused(direction);
        let t = above / descent;
        let ahead = zero.lt(t);
        let apart = origin_error.lt(above.abs());
        let crossed = apart & ahead & t.lt(D::splat(f64::INFINITY)) | !apart & zero.lt(descent);
        (crossed, D::select(ahead, t, zero))
    }
}
