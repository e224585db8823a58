//! A sphere while the tree is built.

use crate::bvh::Bounds;
use crate::lanes::{F32x8, Lanes};
use crate::slabs::MARGIN;
use crate::spheres::Spheres;
use glam::{Vec3, Vec3A, Vec3Swizzles, Vec4};
use std::cmp::Ordering;

/// The axes on which spheres may be parted: where they are, and as the last one how large they are.
pub(super) const AXES: usize = 4;

/// A sphere while the tree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Item {
    /// Center and radius.
    pub(crate) sphere: [f32; AXES],
    /// The sphere's place in the user's scene.
    pub(crate) id: u32,
}

impl Item {
    /// A row of the columns.
    #[inline(always)]
    pub(super) fn of(spheres: &Spheres, row: usize) -> Self {
        let [x, y, z] = spheres.center(row).to_array();
        Self { sphere: [x, y, z, spheres.radius(row)], id: spheres.id[row] }
    }

    /// Center and radius.
    #[inline(always)]
    pub(super) fn vector(&self) -> Vec4 {
        Vec4::from_array(self.sphere)
    }
}

/// The order on an axis. Ties are broken by the other coordinates, then by the user's order, which so
/// matters only for spheres that coincide.
#[inline(always)]
pub(super) fn along(axis: usize, a: &Item, b: &Item) -> Ordering {
    let on = |axis: usize| a.sphere[axis].total_cmp(&b.sphere[axis]);
    let next = |step: usize| on((axis + step) % AXES);
    let by_place = || next(1).then_with(|| next(2)).then_with(|| next(3));
    on(axis).then_with(by_place).then_with(|| a.id.cmp(&b.id))
}

/// A box that grows. Its lower corner is negated, so that one operation on eight lanes extends both
/// corners: the box is -`x`, -`y`, -`z` of the lower one, a lane that is not used, and `x`, `y`, `z` of the upper one. In
/// the extent of centers the fourth lanes are those of the radii.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent(F32x8);

impl Extent {
    pub(super) const EMPTY: Self = Self(F32x8::new([f32::NEG_INFINITY; 8]));

    /// About a sphere, but for rounding.
    #[inline(always)]
    pub(super) fn of(item: &Item) -> Self {
        let [x, y, z, radius] = item.sphere;
        Self(F32x8::new([-x, -y, -z, -radius, x, y, z, radius]) + F32x8::splat(radius))
    }

    /// About some spheres.
    pub(super) fn around(items: impl Iterator<Item = Item>) -> Self {
        items.fold(Self::EMPTY, |all, item| all.union(&Self::of(&item)))
    }

    #[inline(always)]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self(Lanes::max(self.0, other.0))
    }

    /// The lower corner.
    pub(super) fn low(&self) -> Vec4 {
        let [low, _]: [Vec4; 2] = bytemuck::cast(self.0);
        -low
    }

    /// The length on each axis.
    #[inline(always)]
    pub(super) fn size(&self) -> Vec4 {
        let [low, high]: [Vec4; 2] = bytemuck::cast(self.0);
        high + low
    }

    /// Half of the surface, with lengths multiplied by `scale`.
    #[inline(always)]
    pub(super) fn half_area(&self, scale: f32) -> f32 {
        let size = Vec3A::from_vec4(self.size()) * scale;
        size.dot(size.yzx())
    }

    /// One over the longest side, so that areas neither vanish nor overflow.
    pub(super) fn unit(&self) -> f32 {
        (1.0 / self.size().truncate().max_element()).min(f32::MAX)
    }

    /// A box that holds the spheres for certain: rounding the difference may fall on the inner side of
    /// the true bound, the next number cannot.
    #[inline(always)]
    pub(super) fn bounds(&self) -> Bounds {
        let mut sides: [f32; 8] = (self.0 + F32x8::splat(MARGIN)).to_array();
        for side in &mut sides {
            *side = next_up(*side);
        }
        let [x0, y0, z0, _, x1, y1, z1, _] = sides;
        Bounds { low: Vec3::new(-x0, -y0, -z0), high: Vec3::new(x1, y1, z1) }
    }
}

/// The next number, as [`f32::next_up`] but for NaN, without branches.
#[inline(always)]
fn next_up(x: f32) -> f32 {
    // Adding 0 makes -0 the same as 0.
    let bits = (x.min(f32::MAX) + 0.0).to_bits();
    f32::from_bits(bits.wrapping_add_signed(bits as i32 >> 31 | 1))
}

/// The extent of centers and radii.
pub(super) fn spread(items: &[Item]) -> Extent {
    let (mut low, mut high) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
    for item in items {
        let place = item.vector();
        (low, high) = (low.min(place), high.max(place));
    }
    Extent(bytemuck::cast([-low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_number_is_that_of_the_standard_library() {
        let positive = [0.0, 1e-45, 1.1e-38, 0.75, 1.0, 3e38, f32::MAX, f32::INFINITY];
        for x in positive.into_iter().flat_map(|x| [x, -x]) {
            assert_eq!(next_up(x).to_bits(), x.next_up().to_bits(), "{x}");
        }
    }
}
