//! Ray against triangle in double precision: the decision.
//!
//! The terms are those of the exact test. The moment of the line about a corner is formed of the difference of two points, so that the offset of a
//! far origin does not cancel.
//!
//! # Bounds
//!
//! With `E` = 2^-53, and sums of magnitudes written `|F|_1`: `F`, `e1` and `e2` are off by `E` of themselves, as each coordinate is a single
//! difference. A coordinate of `M` is off by `E` for `F`, `E` for its products and `E` for their difference, of the sum of magnitudes of both
//! products, which is no more than `|F|_1 |d|_1`; one of `N` by `4 E` of `|e1|_1 |e2|_1`. Scalar products add `E` for the other factor if it is
//! rounded, `E` for the products and `2 E` for the sums. So `e.M` and `d.N` are off by no more than `7 E` times the product of the magnitudes of
//! all three factors, and `F.N` by `8 E`. The differences that make up the third volume add `2 E` of each of its terms. [`SLACK`] is `10 E`, and leaves
//! room for second order and for the rounding of the bounds.
//!
//! The edges are differences of numbers of single precision: multiples of 2^-149 that are less than 2^130. So no product of two of them
//! underflows. What others lose, less than 2^-1074 each, is multiplied by coordinates of edges at most: [`UNDERFLOW`] is far more. Where anything
//! overflows, its bound is infinite or NaN, and nothing is decided.

use super::Triangle;
use crate::body_tree::{Doubt, Part};
use crate::bounded::Bounded;
use crate::ray::ExactRay;
use glam::DVec3;

/// Errors of volumes and distances, in parts of the product of the magnitudes of their factors.
const SLACK: f64 = 10.0 * (f64::EPSILON / 2.0);

/// More than what underflows in a volume.
const UNDERFLOW: f64 = f64::from_bits((1023 - 900) << 52);

/// As [`enters_at_origin`](crate::body_tree::Shape::enters_at_origin): never. Rounding decides on which side of the triangle such an origin is,
/// and a surface is not hit from itself.
#[inline(always)]
pub(super) fn enters_at_origin(ray: &ExactRay, triangle: &Triangle) -> Option<(bool, Part)> {
    triangle.is_near(ray.origin, ray.origin_error).then_some((false, Part::Body))
}

/// The distance at which a line meets a triangle, twice; `None` if it misses it.
#[inline(always)]
pub(super) fn crossings(
    ray: &ExactRay,
    triangle: &Triangle,
) -> Result<Option<[Bounded; 2]>, Doubt> {
    let (d, from) = (ray.direction, triangle.corners[0] - ray.origin);
    let [first, second] = triangle.edges();
    let moment = from.cross(d);
    let normal = first.cross(second);
    let magnitude = |v: DVec3| v.abs().element_sum();
    let [d_size, from_size, first_size, second_size] = [d, from, first, second].map(magnitude);
    let (moment_size, normal_size) = (from_size * d_size, first_size * second_size);
    let bounded = |value, size| Bounded { value, error: size * SLACK + UNDERFLOW };
    let slope = bounded(d.dot(normal), d_size * normal_size);
    let height = bounded(from.dot(normal), from_size * normal_size);
    let volume2 = bounded(second.dot(moment), moment_size * second_size);
    let volume3 = bounded(-first.dot(moment), moment_size * first_size);
    let volume1 = Bounded {
        value: slope.value - volume2.value - volume3.value,
        error: slope.error + volume2.error + volume3.error,
    };
    let signs = [volume1, volume2, volume3].map(Bounded::sign);
    if signs.contains(&Some(1)) && signs.contains(&Some(-1)) {
        return Ok(None);
    }
    if signs.contains(&None) {
        return Err(Doubt);
    }
    let t = height / slope;
    Ok(Some([t; 2]))
}
