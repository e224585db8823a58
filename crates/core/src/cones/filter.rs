//! Ray against cones in single precision, in lanes: cones that cannot be hit are left out.
//!
//! # Bounds
//!
//! With `u` = 2^-24, `F` from the apex to the origin, `d` the direction, `v` the axis, `h` its length, `r` the radius and `N = d x F`: a
//! line that meets the infinite cone has `h |v.N| <= r |v x N|`. Sums of magnitudes are written `|F|_1`. `F` and `v` are off by `u` of themselves, as
//! each coordinate is a single difference, so `v/|v|_1` by `4 u` in sum and `N` by `4 u |d|_1 |F|_1`. Both products with `N` are then off by at
//! most `12 u |d|_1 |F|_1`, and lengths, quotients and the products with `h` and `r` add less than `16 u` of what is no more than these magnitudes. So
//! with `n = N / (|d|_1 (1 + |F|_1))`, and axis and radius divided by `|v|_1`, neither side is off by more than `32 u` times `h` or `r`, where
//! `h` is less than 1. [`FilterRay::SLACK`] is twice that. What underflows in squares is less than 2^-60, and far less than the slack.
//!
//! The cone is in a sphere about the middle of its axis, which goes through the rim.

use super::ConeBlock;
use crate::body_tree::{FilterRay, cross, magnitude};
use crate::lanes::{F32x8, Lanes, Mask};
use crate::vec3::Vec3;

/// Returns a bit for each cone of a block that a ray may hit no farther than `t_max`, and distances before which it does
/// not.
#[inline(always)]
pub(super) fn may_hit(ray: &FilterRay, block: &ConeBlock, t_max: f32) -> (u32, F32x8) {
    let load =
        |[x, y, z]: &[[f32; 8]; 3]| Vec3::new(F32x8::new(*x), F32x8::new(*y), F32x8::new(*z));
    let (apex, base, radius) = (load(&block.apex), load(&block.base), F32x8::new(block.radius));
    let (one, slack) = (F32x8::splat(1.0), F32x8::splat(FilterRay::SLACK));
    let (from, axis) = (ray.origin - apex, base - apex);
    let length = |v: Vec3<F32x8>| v.relaxed_dot(v).sqrt();
    let (from_size, axis_size) = (magnitude(from), magnitude(axis));
    let scale = one / axis_size;
    let (unit, slope) = (axis * scale, radius * scale);
    let moment =
        cross(ray.direction, from) * (one / (magnitude(ray.direction) * (one + from_size)));
    let apart = length(unit) * unit.relaxed_dot(moment).abs();
    let meets = apart.le(slope * length(cross(unit, moment)) + slack * (slope + one));
    // The sphere about the middle.
    let half = axis * F32x8::splat(0.5);
    let reach = (half.relaxed_dot(half) + radius * radius).sqrt();
    let doubt = slack * (from_size + axis_size + radius);
    let (passes, near) = ray.passes(half - from, reach, doubt, t_max);
    ((meets & passes).bits(), near)
}
