//! Ray against capsules in single precision, in lanes: capsules that cannot be hit are left out.
//!
//! # Bounds
//!
//! With `u` = 2^-24, `F` from the first end to the origin, `d` the direction, `v` the axis and `n = d x v`: a line that meets
//! the infinite cylinder has `|F.n| <= r |n|`. `F` and `v` are off by `u` of their lengths, so `n` by at most `8 u |d||v|`, and
//! `F.n` by at most `16 u |F||d||v|`. The capsule is in a sphere about the middle of its axis, with the radius `r + |v|/2`; the
//! way to the middle and the line's distance from it are off by less than `32 u (|F| + |v|)`. Lengths are replaced by
//! sums of magnitudes, which are no less, and [`FilterRay::SLACK`] is twice what these bounds need. What
//! underflows is less than [`FilterRay::UNDERFLOW`], as coordinates are about 1.

use super::CapsuleBlock;
use crate::body_tree::{FilterRay, cross, magnitude};
use crate::lanes::{F32x8, Lanes, Mask};
use crate::vec3::Vec3;

/// Returns a bit for each capsule of a block that a ray may hit no farther than `t_max`, and distances before which it does
/// not.
#[inline(always)]
pub(super) fn may_hit(ray: &FilterRay, block: &CapsuleBlock, t_max: f32) -> (u32, F32x8) {
    let load =
        |[x, y, z]: &[[f32; 8]; 3]| Vec3::new(F32x8::new(*x), F32x8::new(*y), F32x8::new(*z));
    let (start, end, radius) =
        (load(&block.ends[0]), load(&block.ends[1]), F32x8::new(block.radius));
    let (from, axis) = (ray.origin - start, end - start);
    let slack = F32x8::splat(FilterRay::SLACK);
    let underflow = F32x8::splat(FilterRay::UNDERFLOW);
    let normal = cross(ray.direction, axis);
    let apart = from.relaxed_dot(normal).abs();
    let length = (normal.relaxed_dot(normal) + underflow).sqrt();
    let product = magnitude(ray.direction) * magnitude(axis);
    let reach = radius * (length + length * slack)
        + slack * product * (radius + magnitude(from))
        + underflow;
    let meets = apart.le(reach);
    // The sphere about the middle.
    let to_middle = axis * F32x8::splat(0.5) - from;
    let half = (axis.relaxed_dot(axis) + underflow).sqrt() * F32x8::splat(0.5) + radius;
    let doubt = slack * (magnitude(from) + magnitude(axis) + radius);
    let (passes, near) = ray.passes(to_middle, half, doubt, t_max);
    ((meets & passes).bits(), near)
}
