//! Capsules, all points within a radius of a line segment: cylinders with round ends, in columns, and a tree over them.
//!
//! Hits are as exact as those of spheres: see [`intersect`].

mod filter;
mod intersect;

pub use crate::capsule::{Capsule, Part};
pub use intersect::{CapsuleHit, exit_distance, intersect};

use crate::body_tree::{BodyTree, FilterRay, Shape};
use crate::intersect::Root;
use crate::lanes::F32x8;
use crate::ray::ExactRay;
use crate::spheres::LEAF;
use glam::{DVec3, Vec3};

/// A half of a capsule: each has a number as a hit ([`BodyRows`](crate::body_rows::BodyRows)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapsuleRow {
    /// Row of the capsule.
    pub capsule: usize,
    /// The half of the axis: 0 about the first end, 1 about the second.
    pub half: usize,
}

impl CapsuleRow {
    /// The row of a hit on a capsule at a distance of a ray.
    pub(crate) fn at(capsules: &Capsules, capsule: usize, ray: &ExactRay, t: f64) -> Self {
        let body = capsules.body(capsule);
        let along = body.normal(ray.at_from(body.ends[0], t)).1;
        Self { capsule, half: usize::from(along > 0.5) }
    }
}

/// The columns of [`LEAF`] capsules side by side.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct CapsuleBlock {
    /// By end and axis.
    ends: [[[f32; LEAF]; 3]; 2],
    /// Radii; NaN where there is no capsule, which no ray hits.
    radius: [f32; LEAF],
}

/// A capsule from which a tree is built.
#[derive(Clone, Copy, Debug)]
pub struct CapsuleItem {
    /// The ends, with coordinates of about 1 at most.
    pub ends: [Vec3; 2],
    /// The radius, more than 0.
    pub radius: f32,
    /// Place in the user's order.
    pub id: u32,
}

/// Capsules, and the tree over them.
pub type Capsules = BodyTree<Capsule>;

impl Shape for Capsule {
    type Item = CapsuleItem;
    type Block = CapsuleBlock;

    const EMPTY: CapsuleBlock =
        CapsuleBlock { ends: [[[0.0; LEAF]; 3]; 2], radius: [f32::NAN; LEAF] };

    fn around(&CapsuleItem { ends, radius, id }: &CapsuleItem) -> (Vec3, f32, u32) {
        ((ends[0] + ends[1]) * 0.5, ends[0].distance(ends[1]) * 0.5 + radius, id)
    }

    fn store(item: &CapsuleItem, block: &mut CapsuleBlock, lane: usize) {
        for (columns, end) in block.ends.iter_mut().zip(item.ends) {
            (0..3).for_each(|axis| columns[axis][lane] = end[axis]);
        }
        block.radius[lane] = item.radius;
    }

    fn load(block: &CapsuleBlock, lane: usize) -> Self {
        let end = |end: usize| DVec3::from(block.ends[end].map(|column| f64::from(column[lane])));
        Self { ends: [end(0), end(1)], radius: f64::from(block.radius[lane]) }
    }

    fn extent(&self) -> [DVec3; 2] {
        let Self { ends: [start, end], radius } = *self;
        [start.min(end) - radius, start.max(end) + radius]
    }

    fn contains(&self, point: DVec3) -> bool {
        let (from, axis) = (point - self.ends[0], self.ends[1] - self.ends[0]);
        let along = self.normal(from).1;
        (from - axis * along).length_squared() < self.radius * self.radius
    }

    fn intersect(&self, ray: &ExactRay) -> Option<Root> {
        intersect(ray, self).map(|hit| hit.root)
    }

    #[inline(always)]
    fn may_hit(ray: &FilterRay, block: &CapsuleBlock, t_max: f32) -> (u32, F32x8) {
        filter::may_hit(ray, block, t_max)
    }
}

#[cfg(test)]
mod tests;
