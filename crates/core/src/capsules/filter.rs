//! Ray against capsules in single precision, in lanes: capsules that cannot be hit are left out.
//!
//! # Bounds
//!
//! With `u` = 2^-24, `F` from the first end to the origin, `d` the direction, `v` the axis and `n = d x v`: a line that meets
//! the infinite cylinder has `|F.n| <= r |n|`. `F` and `v` are off by `u` of their lengths, so `n` by at most `8 u |d||v|`, and
//! `F.n` by at most `16 u |F||d||v|`. The capsule is in a sphere about the middle of its axis, with the radius `r + |v|/2`; the
//! way to the middle and the line's distance from it are off by less than `32 u (|F| + |v|)`. Lengths are replaced by
//! sums of magnitudes, which are no less, and `K` is twice what these bounds need. What underflows is less than `UNDERFLOW`, as
//! coordinates are about 1.

use super::CapsuleBlock;
use crate::lanes::{F32x8, Lanes, Mask};
use crate::vec3::Vec3;

/// Relative width of what single precision cannot tell.
const K: f32 = 64.0 * (f32::EPSILON / 2.0);

/// More than what underflows in squares and products; its root is added to lengths.
const UNDERFLOW: f32 = 1.0 / (1_u128 << 110) as f32;
const UNDERFLOW_ROOT: f32 = 1.0 / (1_u64 << 55) as f32;

/// A ray in single precision.
#[derive(Clone, Copy)]
pub(super) struct FilterRay {
    origin: Vec3<f32>,
    direction: Vec3<f32>,
    inverse_length2: f32,
    inverse_length: f32,
}

impl FilterRay {
    pub(super) fn new(origin: glam::Vec3, direction: glam::Vec3) -> Self {
        let inverse_length2 = direction.length_squared().recip();
        let inverse_length = inverse_length2.sqrt();
        let (origin, direction) = (origin.into(), direction.into());
        Self { origin, direction, inverse_length2, inverse_length }
    }

    /// Returns a bit for each capsule of a block that the ray may hit no farther than `t_max`, and distances before which it
    /// does not.
    #[inline(always)]
    pub(super) fn may_hit(&self, block: &CapsuleBlock, t_max: f32) -> (u32, F32x8) {
        let splat = |v: Vec3<f32>| v.map(F32x8::splat);
        let load =
            |[x, y, z]: &[[f32; 8]; 3]| Vec3::new(F32x8::new(*x), F32x8::new(*y), F32x8::new(*z));
        let (origin, direction) = (splat(self.origin), splat(self.direction));
        let (start, end, radius) =
            (load(&block.ends[0]), load(&block.ends[1]), F32x8::new(block.radius));
        let (from, axis) = (origin - start, end - start);
        let slack = F32x8::splat(K);
        let normal = cross(direction, axis);
        let apart = from.relaxed_dot(normal).abs();
        let length = (normal.relaxed_dot(normal) + F32x8::splat(UNDERFLOW)).sqrt();
        let product = magnitude(direction) * magnitude(axis);
        let reach = radius * (length + length * slack)
            + slack * product * (radius + magnitude(from))
            + F32x8::splat(UNDERFLOW);
        let meets = apart.le(reach);
        // The sphere about the middle.
        let to_middle = axis * F32x8::splat(0.5) - from;
        let t = to_middle.relaxed_dot(direction) * F32x8::splat(self.inverse_length2);
        let off = to_middle.relaxed_along(-direction, t);
        let half =
            (axis.relaxed_dot(axis) + F32x8::splat(UNDERFLOW)).sqrt() * F32x8::splat(0.5) + radius;
        let doubt = slack * (magnitude(from) + magnitude(axis) + radius);
        let half = half + doubt + F32x8::splat(UNDERFLOW_ROOT);
        let inside = off.relaxed_dot(off).le(half * half);
        let way = half * F32x8::splat(self.inverse_length) * F32x8::splat(1.0 + K);
        let (near, far) = (t - way, t + way);
        let ahead = F32x8::splat(0.0).le(far) & near.le(F32x8::splat(t_max));
        ((meets & inside & ahead).bits(), near)
    }
}

/// The sum of the magnitudes: no less than the length.
#[inline(always)]
fn magnitude(v: Vec3<F32x8>) -> F32x8 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

#[inline(always)]
fn cross(a: Vec3<F32x8>, b: Vec3<F32x8>) -> Vec3<F32x8> {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
