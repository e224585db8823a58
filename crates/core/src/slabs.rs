//! The slab test: a ray, or a packet of coherent rays, against eight boxes at once.

use crate::lanes::{F32x4, F32x8, F32x16, Lanes, Mask, U32x16, transpose};
use glam::Vec3;

/// The planes of eight boxes: by axis and side, lower first.
pub type Planes = [[[f32; 8]; 2]; 3];

/// Boxes are wider than what is in them by this, a part of the largest coordinate, which is about 1. So
/// no ray touches a sphere where it enters a box, and a direction that is kept from 0 does no harm: it
/// takes such a ray longer than any scene is wide to cross the margin.
pub const MARGIN: f32 = 1.0 / (1_u64 << 56) as f32;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;

/// Relative amount by which products of origins are moved to the safe side.
const SLACK: f32 = 4.0 * U;

/// Factor by which near planes are moved toward the origin.
const SOONER: f32 = 1.0 - 8.0 * U;

/// Directions are kept this far from 0, so that their reciprocals are finite: what moves a ray by
/// less than boxes are wider than what is in them, over any distance that counts.
const LEAST: f32 = 1.0 / (1_u128 << 100) as f32;

/// By octant and axis, whether directions are negative.
const NEGATIVE: [[bool; 4]; 8] = {
    let (mut table, mut i) = ([[false; 4]; 8], 0);
    while i < 8 * 3 {
        table[i / 3][i % 3] = ((i / 3) >> (i % 3)) & 1 == 1;
        i += 1;
    }
    table
};

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
/// For a packet, a near plane is met first by the steepest ray if it starts farthest ahead, a far one
/// last by the flattest if it starts farthest behind: bounds that no ray exceeds, though none may
/// reach them. Distances below 0 count as 0, so their bounds need not hold.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Slabs {
    /// By axis, factors and terms of near distances.
    near: [[f32; 4]; 2],
    /// By axis, factors and terms of far distances.
    far: [[f32; 4]; 2],
    /// By axis, whether the direction is negative.
    negative: [bool; 4],
    /// Bit `a` is set where the direction is negative on axis `a`.
    pub octant: usize,
}

impl Slabs {
    /// In place of a ray where there is none.
    pub const IDLE: Self = Self {
        near: [[1.0; 4], [0.0; 4]],
        far: [[1.0; 4], [0.0; 4]],
        negative: [false; 4],
        octant: 0,
    };

    /// For one ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let (origin, direction) = (row(origin), row(direction));
        let inverse = inverse(direction);
        Self::from_bounds(direction, (inverse, origin), (inverse, origin))
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
        Self::from_bounds(lower, (steep, ahead), (flat, behind))
    }

    /// For sixteen rays, each on its own: as [`Slabs::new`], by axis.
    #[inline(always)]
    pub fn of_rays(origin: [F32x16; 3], direction: [F32x16; 3], slabs: &mut [Self; 16]) {
        let mut columns = [[F32x16::splat(0.0); 8]; 2];
        let mut octants = U32x16::splat(0);
        for axis in 0..3 {
            let inverse = inverse(direction[axis]);
            let bounds = [near(inverse, origin[axis]), far(inverse, origin[axis])];
            for (columns, [factor, term]) in columns.iter_mut().zip(bounds) {
                (columns[axis], columns[4 + axis]) = (factor, term);
            }
            let sign: U32x16 = bytemuck::cast(direction[axis]);
            octants |= (sign >> 31) << axis as u32;
        }
        let octants = octants.to_array();
        for first in [0, 8] {
            let (near, far) = (transpose(columns[0], first), transpose(columns[1], first));
            for i in 0..8 {
                let octant = octants[first + i] as usize & 7;
                let (near, far) = (bytemuck::cast(near[i]), bytemuck::cast(far[i]));
                slabs[first + i] = Self { near, far, negative: NEGATIVE[octant], octant };
            }
        }
    }

    /// From directions, and the reciprocal direction and the origin that bound near and far distances.
    #[inline(always)]
    fn from_bounds(direction: F32x4, first: (F32x4, F32x4), last: (F32x4, F32x4)) -> Self {
        let ([a, b], [c, d]) = (near(first.0, first.1), far(last.0, last.1));
        let octant = direction.is_negative().bits() as usize & 7;
        let (near, far) = ([a.to_array(), b.to_array()], [c.to_array(), d.to_array()]);
        Self { near, far, negative: NEGATIVE[octant], octant }
    }

    /// The same rays, for boxes that are larger by more than half of `slack` on each side.
    #[inline(always)]
    pub fn widened(mut self, slack: f32) -> Self {
        for axis in 0..3 {
            self.near[1][axis] -= self.near[0][axis].abs() * slack;
            self.far[1][axis] += self.far[0][axis].abs() * slack;
        }
        self
    }

    /// Returns the boxes that a ray may enter at a distance in `0..=t_max`, in the lowest bits, and
    /// distances before which it does not.
    ///
    /// Never omits a box that contains a point of the ray.
    #[inline(always)]
    pub fn enters(&self, planes: &Planes, t_max: f32) -> (u32, F32x8) {
        let mut near = F32x8::splat(0.0);
        let mut far = F32x8::splat(t_max);
        for axis in 0..3 {
            let negative = self.negative[axis];
            let splat = |x: &[f32; 4]| F32x8::splat(x[axis]);
            let first = F32x8::load(&planes[axis][usize::from(negative)]);
            let second = F32x8::load(&planes[axis][usize::from(!negative)]);
            let enter = Lanes::relaxed_mul_add(first, splat(&self.near[0]), splat(&self.near[1]));
            let leave = Lanes::relaxed_mul_add(second, splat(&self.far[0]), splat(&self.far[1]));
            near = Lanes::max(enter, near);
            far = Lanes::min(leave, far);
        }
        (near.le(far).bits(), near)
    }
}

/// A vector in lanes.
#[inline(always)]
pub fn row(v: Vec3) -> F32x4 {
    F32x4::new([v.x, v.y, v.z, 1.0])
}

#[inline(always)]
fn inverse<L: Lanes>(direction: L) -> L {
    let least = L::splat(LEAST);
    let least = L::select(direction.is_negative(), -least, least);
    let kept = L::select(direction.abs().lt(least.abs()), least, direction);
    L::splat(1.0) / kept
}

/// Returns the factor and the term that turn a plane's coordinate into a near distance.
#[inline(always)]
fn near<L: Lanes>(inverse: L, origin: L) -> [L; 2] {
    let sooner = inverse * L::splat(SOONER);
    let shift = origin * sooner;
    [sooner, -(shift + shift.abs() * L::splat(SLACK))]
}

/// Returns the factor and the term that turn a plane's coordinate into a far distance.
#[inline(always)]
fn far<L: Lanes>(inverse: L, origin: L) -> [L; 2] {
    let shift = origin * inverse;
    [inverse, shift.abs() * L::splat(SLACK) - shift]
}

#[cfg(test)]
mod tests;
