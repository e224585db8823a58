//! Capsules, all points within a radius of a line segment: cylinders with round ends, in columns, and a tree over them.
//!
//! They are traced after the spheres, in a tree of their own, so that scenes of spheres do not pay for them. Hits are as
//! exact as those of spheres: see [`intersect`].

mod bounded;
mod filter;
mod intersect;
mod intersections;
mod search;

pub use crate::capsule::{Capsule, Part};
pub use intersect::{CapsuleHit, exit_distance, intersect};
pub(crate) use intersections::for_each_intersection;
pub use search::{BodyTrees, closest, enclosing_capsule, enclosing_capsules, occluded};

use crate::bvh::builders::{Builder, Item, build_around};
use crate::bvh::{Beam, Bounds, Bvh};
use crate::ray::{ExactRay, GROUND};
use crate::slabs::MARGIN;
use crate::spheres::LEAF;
use glam::{DVec3, Vec3};

/// A hit on a capsule as a number beside the rows of spheres: each capsule has two rows after theirs, for the halves of its
/// axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapsuleRow {
    /// Row of the capsule.
    pub capsule: usize,
    /// The half of the axis: 0 about the first end, 1 about the second.
    pub half: usize,
}

impl CapsuleRow {
    /// The capsule of a hit, in a scene of so many spheres; `None` if it is another hit, or none.
    #[inline(always)]
    pub fn of_hit(hit: u32, spheres: usize) -> Option<Self> {
        let row = (hit as usize).checked_sub(spheres).filter(|_| hit < GROUND)?;
        Some(Self { capsule: row / 2, half: row % 2 })
    }

    /// The number of a hit, in a scene of so many spheres.
    #[inline(always)]
    pub fn hit(self, spheres: usize) -> u32 {
        (spheres + 2 * self.capsule + self.half) as u32
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
#[derive(Clone, Debug, Default)]
pub struct Capsules {
    blocks: Vec<CapsuleBlock>,
    /// Place in the user's order. Of two capsules at the same distance the one with the lower id is hit.
    id: Vec<u32>,
    bvh: Bvh,
}

impl Capsules {
    /// The most capsules there can be.
    pub const MAX: usize = 1 << 30;

    /// Builds the tree over capsules.
    pub fn build(items: &[CapsuleItem], builder: Builder) -> Self {
        let around = |(row, &CapsuleItem { ends, radius, .. }): (usize, &CapsuleItem)| {
            let center = (ends[0] + ends[1]) * 0.5;
            let reach = ends[0].distance(ends[1]) * 0.5 + radius;
            Item { sphere: [center.x, center.y, center.z, reach], id: row as u32 }
        };
        let (order, bvh) = build_around(items.iter().enumerate().map(around).collect(), builder);
        let block = |rows: &[u32]| {
            let mut block = CapsuleBlock { ends: [[[0.0; LEAF]; 3]; 2], radius: [f32::NAN; LEAF] };
            for (lane, &row) in rows.iter().enumerate() {
                let CapsuleItem { ends, radius, .. } = items[row as usize];
                for (columns, end) in block.ends.iter_mut().zip(ends) {
                    (0..3).for_each(|axis| columns[axis][lane] = end[axis]);
                }
                block.radius[lane] = radius;
            }
            block
        };
        let blocks: Vec<CapsuleBlock> = order.chunks(LEAF).map(block).collect();
        let id = order.iter().map(|&row| items[row as usize].id).collect();
        let mut capsules = Self { blocks, id, bvh: Bvh::default() };
        capsules.bvh = bvh.refitted(|block| capsules.bounds_of(block));
        capsules
    }

    /// Number of capsules.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Places in the user's order, by row.
    pub fn ids(&self) -> &[u32] {
        &self.id
    }

    /// Bytes of capsules and tree.
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice()) + size_of_val(self.id.as_slice()) + self.bvh.bytes()
    }

    /// Returns whether any ray in a beam may hit a capsule: never false if one does.
    pub fn may_be_hit(&self, beam: &Beam) -> bool {
        self.bvh.may_meet(beam, |_| true)
    }

    /// The box of all capsules; `None` if there is none.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bvh.bounds()
    }

    /// Row `i`.
    pub fn capsule(&self, i: usize) -> Capsule {
        let (block, lane) = (&self.blocks[i / LEAF], i % LEAF);
        let end = |end: usize| DVec3::from(block.ends[end].map(|column| f64::from(column[lane])));
        Capsule { ends: [end(0), end(1)], radius: f64::from(block.radius[lane]) }
    }

    /// The row of a hit on a capsule at a distance of a ray.
    pub(crate) fn row_at(&self, capsule: usize, ray: &ExactRay, t: f64) -> CapsuleRow {
        let body = self.capsule(capsule);
        let along = body.normal(ray.at_from(body.ends[0], t)).1;
        CapsuleRow { capsule, half: usize::from(along > 0.5) }
    }

    /// A box that holds the capsules of a block, and more than rounding about them.
    fn bounds_of(&self, block: usize) -> Bounds {
        let rows = block * LEAF..self.len().min((block + 1) * LEAF);
        rows.fold(Bounds::EMPTY, |all, row| {
            let Capsule { ends: [start, end], radius } = self.capsule(row);
            let reach = radius + f64::from(MARGIN);
            let (low, high) = (start.min(end) - reach, start.max(end) + reach);
            // Rounding to single precision may fall on the inner side; the next number cannot.
            let low = low.as_vec3().to_array().map(f32::next_down);
            let high = high.as_vec3().to_array().map(f32::next_up);
            all.union(&Bounds { low: low.into(), high: high.into() })
        })
    }
}

#[cfg(test)]
mod tests;
