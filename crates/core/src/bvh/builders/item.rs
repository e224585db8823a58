//! A sphere while the tree is built.

use crate::bvh::Bounds;
use crate::slabs::MARGIN;
use crate::spheres::Spheres;
use glam::Vec4;
use std::cmp::Ordering;

/// The axes on which spheres may be parted: where they are, and as the last one how large they are.
pub(super) const AXES: usize = 4;

/// A sphere while the tree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Item {
    /// Center and radius.
    pub(super) sphere: [f32; AXES],
    /// The sphere's place in the user's scene.
    pub(super) id: u32,
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

/// A box that grows; what is in its last lane means nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) low: Vec4,
    pub(super) high: Vec4,
}

impl Extent {
    pub(super) const EMPTY: Self =
        Self { low: Vec4::splat(f32::INFINITY), high: Vec4::splat(f32::NEG_INFINITY) };

    /// About a sphere, but for rounding.
    #[inline(always)]
    pub(super) fn of(item: &Item) -> Self {
        let (center, radius) = (item.vector(), Vec4::splat(item.sphere[3]));
        Self { low: center - radius, high: center + radius }
    }

    #[inline(always)]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half of the surface, with lengths multiplied by `scale`.
    #[inline(always)]
    pub(super) fn half_area(&self, scale: f32) -> f32 {
        let size = (self.high - self.low).truncate() * scale;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// One over the longest side, so that areas neither vanish nor overflow.
    pub(super) fn unit(&self) -> f32 {
        (1.0 / (self.high - self.low).truncate().max_element()).min(f32::MAX)
    }
}

/// The bounds of centers and radii.
pub(super) fn spread(items: &[Item]) -> Extent {
    let around = |all: Extent, item: &Item| {
        let place = item.vector();
        all.union(&Extent { low: place, high: place })
    };
    items.iter().fold(Extent::EMPTY, around)
}

/// A box that holds the spheres for certain: rounding the difference may fall on the inner side of
/// the true bound, the next number cannot.
pub(super) fn bounds(items: impl Iterator<Item = Item>) -> Bounds {
    let margin = Vec4::splat(MARGIN);
    let all = items.fold(Extent::EMPTY, |all, item| {
        let Extent { low, high } = Extent::of(&item);
        all.union(&Extent { low: low - margin, high: high + margin })
    });
    let (low, high) = (all.low.truncate().to_array(), all.high.truncate().to_array());
    Bounds { low: low.map(f32::next_down).into(), high: high.map(f32::next_up).into() }
}
