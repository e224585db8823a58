//! Ray against triangles in single precision, in lanes: triangles that cannot be hit are left out.
//!
//! # Bounds
//!
//! The terms are those of the [decision](super::intersect), and so are their bounds, with `u` = 2^-24 in place of `E`: volumes and the slope `d.N` are off by
//! less than `10 u` times the products of the magnitudes of their factors, and the height `F.N` as well. Where products are fused with sums, there are fewer
//! roundings. [`SLACK`] is `16 u`. A ray that hits has volumes, slope and height of one sign, or 0: so none of their numbers is farther on the other
//! side of 0 than its bound.
//!
//! The hit is at `|height| / |slope|`, or if both are 0, anywhere. So it is not before `(|height| - a) / (|slope| + b)`, where `a` and `b` are the
//! bounds. The difference, the sum and the quotient add `3 u` of no more than the product of magnitudes in `a`.
//!
//! A product loses less than 2^-149 by underflow, and that is multiplied by coordinates of `F`, `d` and the edges, or by none: less than
//! [`FilterRay::UNDERFLOW`].

use super::TriangleBlock;
use crate::body_tree::{FilterRay, cross, magnitude};
use crate::lanes::{F32x8, Lanes, Mask};
use crate::vec3::Vec3;

/// Errors of volumes and heights, in parts of the product of the magnitudes of their factors.
const SLACK: f32 = 16.0 * (f32::EPSILON / 2.0);

/// Returns a bit for each triangle of a block that a ray may hit no farther than `t_max`, and distances before which it does
/// not.
#[inline(always)]
pub(super) fn may_hit(ray: &FilterRay, block: &TriangleBlock, t_max: f32) -> (u32, F32x8) {
    let [corner, second, third] =
        block.corners.map(|[x, y, z]| Vec3::new(F32x8::new(x), F32x8::new(y), F32x8::new(z)));
    let (d, from, first, second) =
        (ray.direction, corner - ray.origin, second - corner, third - corner);
    let (moment, normal) = (cross(from, d), cross(first, second));
    let (slack, underflow) = (F32x8::splat(SLACK), F32x8::splat(FilterRay::UNDERFLOW));
    let bound = |size: F32x8| size.relaxed_mul_add(slack, underflow);
    let (d_size, from_size) = (magnitude(d), magnitude(from));
    let (first_size, second_size) = (magnitude(first), magnitude(second));
    let (moment_size, normal_size) = (from_size * d_size, first_size * second_size);
    let slope = (d.relaxed_dot(normal), bound(d_size * normal_size));
    let height = (from.relaxed_dot(normal), bound(from_size * normal_size));
    let volume2 = (second.relaxed_dot(moment), bound(moment_size * second_size));
    let volume3 = (-first.relaxed_dot(moment), bound(moment_size * first_size));
    let volume1 = (slope.0 - volume2.0 - volume3.0, slope.1 + volume2.1 + volume3.1);
    // Neither is true of NaN.
    let up = |(value, bound): (F32x8, F32x8)| (-bound).le(value);
    let down = |(value, bound): (F32x8, F32x8)| value.le(bound);
    let all_up = up(volume1) & up(volume2) & up(volume3) & up(slope) & up(height);
    let all_down = down(volume1) & down(volume2) & down(volume3) & down(slope) & down(height);
    let near = (height.0.abs() - height.1) / (slope.0.abs() + slope.1);
    let meets = (all_up | all_down) & near.le(F32x8::splat(t_max));
    (meets.bits(), near)
}
