//! A ray, or rays that go alike, against eight boxes at once.

use crate::lanes::{F32x4, F32x8, Lanes, Mask};
use glam::Vec3;

/// The planes of eight boxes: by axis and side, lower first.
pub type Planes = [[[f32; 8]; 2]; 3];

/// Boxes are wider than what is in them by this, a part of the largest coordinate, which is about 1. So
/// no ray touches a sphere where it enters a box, and a direction that is kept from 0 does no harm: it
/// takes such a ray longer than any scene is wide to cross the margin.
pub const MARGIN: f32 = 1.0 / (1_u64 << 56) as f32;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;

/// How much products of origins are moved, relative to themselves.
const SLACK: f32 = 4.0 * U;

/// How much nearer near planes are taken to be.
const SOONER: f32 = 1.0 - 8.0 * U;

/// Directions are kept this far from 0, so that their reciprocals are finite: what moves a ray by
/// less than boxes are wider than what is in them, over any distance that counts.
const LEAST: f32 = 1.0 / (1_u128 << 100) as f32;

/// The rays between two bounds: one ray, or a packet.
///
/// On each axis all directions have the same sign, that of a zero included: with both signs, boxes that
/// are met would be rejected.
///
/// # The test's bound
///
/// A plane at `b` is met at `(b - o) / d = b i - o i`, where `i = 1 / d` is off by `u` of itself and
/// the two products by `u` of theirs (the first not at all where it is fused with the difference).
/// Their magnitudes differ by the distance, so what cancellation leaves is at most `2 u |o i|`, which
/// `o i` is moved by, and its own rounding, to the safe side; and `3 u` of the distance, on both
/// sides, which `SOONER` on the near one outweighs (after Ize, "Robust BVH Ray Traversal", JCGT
/// 2013). The slack is relative to the ray's own origin: large spheres elsewhere do not widen it.
///
/// Of a packet, a near plane is met first by the steepest ray if it starts farthest ahead, a far one
/// last by the flattest if it starts farthest behind: bounds that no ray goes beyond, though none may
/// reach them. Distances below 0 count as 0, so their bounds need not hold.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Slabs {
    inverse_near: [f32; 4],
    shift_near: [f32; 4],
    inverse_far: [f32; 4],
    shift_far: [f32; 4],
    /// By axis, whether the direction is negative.
    negative: [bool; 3],
    /// Bit `a` is set where the direction is negative on axis `a`.
    pub octant: usize,
}

impl Slabs {
    /// In place of a ray where there is none.
    pub const IDLE: Self = Self {
        inverse_near: [1.0; 4],
        shift_near: [0.0; 4],
        inverse_far: [1.0; 4],
        shift_far: [0.0; 4],
        negative: [false; 3],
        octant: 0,
    };

    /// For one ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let (origin, direction) = (row(origin), row(direction));
        let inverse = inverse(direction);
        Self::assemble(direction, (inverse, origin), (inverse, origin))
    }

    /// For rays whose origins and directions lie between two bounds, lower first, of which those of the
    /// directions have the same signs; in lanes 0 to 2 what is on their axes.
    #[inline(always)]
    pub fn between(origin: [F32x4; 2], direction: [F32x4; 2]) -> Self {
        let [lower, upper] = direction;
        let negative = lower.is_negative();
        let steep = inverse(Lanes::select(negative, lower, upper));
        let flat = inverse(Lanes::select(negative, upper, lower));
        let [low, high] = origin;
        let (ahead, behind) =
            (Lanes::select(negative, low, high), Lanes::select(negative, high, low));
        Self::assemble(lower, (steep, ahead), (flat, behind))
    }

    /// From the reciprocal direction and the origin that bound near and far distances.
    #[inline(always)]
    fn assemble(direction: F32x4, near: (F32x4, F32x4), far: (F32x4, F32x4)) -> Self {
        let sooner = near.0 * F32x4::splat(SOONER);
        let (near, far) = ((sooner, near.1 * sooner), (far.0, far.1 * far.0));
        let slack = |shift: F32x4| Lanes::abs(shift) * F32x4::splat(SLACK);
        let octant = direction.is_negative().bits() as usize & 7;
        Self {
            inverse_near: near.0.to_array(),
            shift_near: (-(near.1 + slack(near.1))).to_array(),
            inverse_far: far.0.to_array(),
            shift_far: (slack(far.1) - far.1).to_array(),
            negative: [octant & 1 != 0, octant & 2 != 0, octant & 4 != 0],
            octant,
        }
    }

    /// Which boxes a ray may meet at a distance in `0..=t_max`, in the lowest bits, and a distance
    /// before which it does not.
    ///
    /// Never without a box with a point on the ray.
    #[inline(always)]
    pub fn enters(&self, planes: &Planes, t_max: f32) -> (u32, F32x8) {
        let mut near = F32x8::splat(0.0);
        let mut far = F32x8::splat(t_max);
        for axis in 0..3 {
            let negative = self.negative[axis];
            let splat = |x: &[f32; 4]| F32x8::splat(x[axis]);
            let first = F32x8::load(&planes[axis][usize::from(negative)]);
            let second = F32x8::load(&planes[axis][usize::from(!negative)]);
            let enter = Lanes::mul_add(first, splat(&self.inverse_near), splat(&self.shift_near));
            let leave = Lanes::mul_add(second, splat(&self.inverse_far), splat(&self.shift_far));
            near = Lanes::max(enter, near);
            far = Lanes::min(leave, far);
        }
        (near.le(far).bits(), near)
    }
}

/// A vector in lanes.
#[inline(always)]
pub(crate) fn row(v: Vec3) -> F32x4 {
    F32x4::new([v.x, v.y, v.z, 1.0])
}

#[inline(always)]
fn inverse(direction: F32x4) -> F32x4 {
    let least = F32x4::splat(LEAST);
    let least = Lanes::select(direction.is_negative(), -least, least);
    let kept = Lanes::select(Lanes::abs(direction).lt(least.abs()), least, direction);
    F32x4::splat(1.0) / kept
}

#[cfg(test)]
mod tests;
