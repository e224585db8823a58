//! A ray against spheres around bodies, in single precision, in lanes.

use crate::lanes::{F32x8, Lanes};
use crate::vec3::Vec3;

/// A ray in single precision.
#[derive(Clone, Copy, Debug)]
pub struct FilterRay {
    /// The origin.
    pub(crate) origin: Vec3<F32x8>,
    /// The direction.
    pub(crate) direction: Vec3<F32x8>,
    inverse_length2: f32,
    inverse_length: f32,
}

impl FilterRay {
    /// Relative width of what single precision cannot tell.
    pub(crate) const SLACK: f32 = 64.0 * (f32::EPSILON / 2.0);

    /// More than what underflows in squares and products, of coordinates of about 1.
    pub(crate) const UNDERFLOW: f32 = 1.0 / (1_u128 << 110) as f32;

    /// The root of [`FilterRay::UNDERFLOW`], which is added to lengths.
    const UNDERFLOW_ROOT: f32 = 1.0 / (1_u64 << 55) as f32;

    pub(crate) fn new(origin: glam::Vec3, direction: glam::Vec3) -> Self {
        let inverse_length2 = direction.length_squared().recip();
        let inverse_length = inverse_length2.sqrt();
        let splat = |v: glam::Vec3| Vec3::<f32>::from(v).map(F32x8::splat);
        let (origin, direction) = (splat(origin), splat(direction));
        Self { origin, direction, inverse_length2, inverse_length }
    }

    /// Returns whether the line passes spheres with a radius of `half` no farther than `t_max` and not behind the origin, and
    /// distances before which it does not. `doubt` is a bound of the errors of `half` and of the way from the origin to the
    /// middle, with those of this test: [`FilterRay::SLACK`] of a length that is no less than both.
    #[inline(always)]
    pub(crate) fn passes(
        &self,
        to_middle: Vec3<F32x8>,
        half: F32x8,
        doubt: F32x8,
        t_max: f32,
    ) -> (<F32x8 as Lanes>::Mask, F32x8) {
        let t = to_middle.relaxed_dot(self.direction) * F32x8::splat(self.inverse_length2);
        let off = to_middle.relaxed_along(-self.direction, t);
        let half = half + doubt + F32x8::splat(Self::UNDERFLOW_ROOT);
        let inside = off.relaxed_dot(off).le(half * half);
        let way = half * F32x8::splat(self.inverse_length) * F32x8::splat(1.0 + Self::SLACK);
        let (near, far) = (t - way, t + way);
        let ahead = F32x8::splat(0.0).le(far) & near.le(F32x8::splat(t_max));
        (inside & ahead, near)
    }
}

/// The sum of the magnitudes: no less than the length.
#[inline(always)]
pub(crate) fn magnitude(v: Vec3<F32x8>) -> F32x8 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// Vector product.
#[inline(always)]
pub(crate) fn cross(a: Vec3<F32x8>, b: Vec3<F32x8>) -> Vec3<F32x8> {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}
