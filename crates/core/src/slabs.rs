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

/// Factor by which near distances are decreased.
const SOONER: f32 = 1.0 - 8.0 * U;

/// Directions are kept this far from 0, so that their reciprocals are finite: what moves a ray by
/// less than boxes are wider than what is in them, over any distance that counts.
const LEAST: f32 = 1.0 / (1_u128 << 100) as f32;

/// The rays between two bounds: one ray ([`RaySlabs`]), or a packet ([`PacketSlabs`]).
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
pub trait Slabs: Copy {
    /// In place of a ray where there is none.
    const IDLE: Self;

    /// The octant of the directions: bit `a` is set where they are negative on axis `a`.
    fn octant(&self) -> usize;

    /// Whether directions are negative on an axis: 1 if they are.
    fn is_negative(&self, axis: usize) -> usize;

    /// The factors and terms that turn coordinates of planes on an axis into distances: before which none of the rays
    /// enters, but for `SOONER`, and beyond which all have left.
    fn distances(&self, axis: usize) -> [[f32; 2]; 2];

    /// Returns the boxes that a ray may enter at a distance in `0..=t_max`, in the lowest bits, and
    /// distances before which it does not.
    ///
    /// Never omits a box that contains a point of the ray.
    #[inline(always)]
    fn enters(&self, planes: &Planes, t_max: f32) -> (u32, F32x8) {
        let (entered, near) = self.entered(planes, t_max);
        (entered.bits(), near)
    }

    /// Does what [`Slabs::enters`] does, with a mask of the boxes. Distances are not below 0.
    #[inline(always)]
    fn entered(&self, planes: &Planes, t_max: f32) -> (<F32x8 as Lanes>::Mask, F32x8) {
        let mut near = F32x8::splat(0.0);
        let mut far = F32x8::splat(t_max);
        for (axis, sides) in planes.iter().enumerate() {
            let negative = self.is_negative(axis);
            let distance = |side: usize, [factor, term]: [f32; 2]| {
                let plane = F32x8::load(&sides[side]);
                Lanes::relaxed_mul_add(plane, F32x8::splat(factor), F32x8::splat(term))
            };
            let [enter, leave] = self.distances(axis);
            near = Lanes::max(distance(negative, enter), near);
            far = Lanes::min(distance(1 - negative, leave), far);
        }
        let near = near * F32x8::splat(SOONER);
        (near.le(far), near)
    }
}

/// The slabs of one ray, in one line of cache.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub struct RaySlabs {
    /// By axis, the factor of all distances.
    inverse: [f32; 4],
    /// By axis, terms of near distances.
    near: [f32; 4],
    /// By axis, terms of far distances.
    far: [f32; 4],
    /// By axis, 1 if the direction is negative.
    negative: [u8; 4],
    octant: u32,
    unused: [u32; 2],
}

impl Slabs for RaySlabs {
    const IDLE: Self = Self {
        inverse: [1.0; 4],
        near: [0.0; 4],
        far: [0.0; 4],
        negative: [0; 4],
        octant: 0,
        unused: [0; 2],
    };

    #[inline(always)]
    fn octant(&self) -> usize {
        self.octant as usize
    }

    #[inline(always)]
    fn is_negative(&self, axis: usize) -> usize {
        usize::from(self.negative[axis] & 1)
    }

    #[inline(always)]
    fn distances(&self, axis: usize) -> [[f32; 2]; 2] {
        let inverse = self.inverse[axis];
        [[inverse, self.near[axis]], [inverse, self.far[axis]]]
    }
}

impl RaySlabs {
    /// For one ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::of_row(row(origin), row(direction))
    }

    /// For one ray, whose coordinates are in the first three lanes.
    #[inline(always)]
    pub fn of_row(origin: F32x4, direction: F32x4) -> Self {
        let inverse = inverse(direction);
        let negative = direction.is_negative().bits();
        let sign = |axis: u32| (negative >> axis & 1) as u8;
        Self {
            inverse: inverse.to_array(),
            near: near(inverse, origin).to_array(),
            far: far(inverse, origin).to_array(),
            negative: [sign(0), sign(1), sign(2), 0],
            octant: negative & 7,
            unused: [0; 2],
        }
    }

    /// For sixteen rays, each on its own: as [`RaySlabs::new`], by axis.
    #[inline(always)]
    pub fn of_rays(origin: [F32x16; 3], direction: [F32x16; 3], slabs: &mut [Self; 16]) {
        let mut columns = [[F32x16::splat(0.0); 8]; 2];
        let (mut octant, mut negative) = (U32x16::splat(0), U32x16::splat(0));
        for axis in 0..3 {
            let inverse = inverse(direction[axis]);
            columns[0][axis] = inverse;
            columns[0][4 + axis] = near(inverse, origin[axis]);
            columns[1][axis] = far(inverse, origin[axis]);
            let sign = bytemuck::cast::<_, U32x16>(direction[axis]) >> 31;
            octant |= sign << axis as u32;
            negative |= sign << (u8::BITS * axis as u32);
        }
        (columns[1][4], columns[1][5]) = (bytemuck::cast(negative), bytemuck::cast(octant));
        for first in [0, 8] {
            let (low, high) = (transpose(columns[0], first), transpose(columns[1], first));
            for i in 0..8 {
                slabs[first + i] = bytemuck::cast([low[i], high[i]]);
            }
        }
    }

    /// The same ray, for boxes that are larger by more than half of `slack` on each side.
    #[inline(always)]
    pub fn widened(mut self, slack: f32) -> Self {
        for axis in 0..3 {
            self.near[axis] -= self.inverse[axis].abs() * slack;
            self.far[axis] += self.inverse[axis].abs() * slack;
        }
        self
    }
}

/// The slabs of a packet.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PacketSlabs {
    /// By axis, factors and terms of near distances.
    near: [[f32; 4]; 2],
    /// By axis, factors and terms of far distances.
    far: [[f32; 4]; 2],
    /// A bit for each axis on which directions are negative.
    octant: usize,
}

impl Slabs for PacketSlabs {
    const IDLE: Self = Self { near: [[1.0; 4], [0.0; 4]], far: [[1.0; 4], [0.0; 4]], octant: 0 };

    #[inline(always)]
    fn octant(&self) -> usize {
        self.octant
    }

    #[inline(always)]
    fn is_negative(&self, axis: usize) -> usize {
        self.octant >> axis & 1
    }

    #[inline(always)]
    fn distances(&self, axis: usize) -> [[f32; 2]; 2] {
        [self.near, self.far].map(|rows| rows.map(|row| row[axis]))
    }
}

impl PacketSlabs {
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
        let rows = |factor: F32x4, term: F32x4| [factor.to_array(), term.to_array()];
        Self {
            near: rows(steep, near(steep, ahead)),
            far: rows(flat, far(flat, behind)),
            octant: negative.bits() as usize & 7,
        }
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

/// Returns the term of near distances of planes.
#[inline(always)]
fn near<L: Lanes>(inverse: L, origin: L) -> L {
    let shift = origin * inverse;
    -(shift + shift.abs() * L::splat(SLACK))
}

/// Returns the term of far distances of planes.
#[inline(always)]
fn far<L: Lanes>(inverse: L, origin: L) -> L {
    let shift = origin * inverse;
    shift.abs() * L::splat(SLACK) - shift
}

#[cfg(test)]
mod tests;
