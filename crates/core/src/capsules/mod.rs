//! Capsules, all points within a radius of a line segment: cylinders with round ends, in columns, and a tree over them.
//!
//! Hits are as exact as those of spheres.

mod capsule;
mod exact;
mod filter;
mod intersect;

pub use capsule::Capsule;
pub use intersect::CapsuleLine;

use crate::body_rows::BodyKind;
use crate::body_tree::{BodyTree, Doubt, FilterRay, Part, Shape, Sphere, normal_or_against};
use crate::exact::Quotient;
use crate::lanes::F32x8;
use crate::ray::ExactRay;
use crate::spheres::LEAF;
use glam::{DVec3, Vec3};

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
    const KIND: BodyKind = BodyKind::Capsule;

    type Item = CapsuleItem;
    type Block = CapsuleBlock;
    type Line = CapsuleLine;

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

    fn is_finite(&self) -> bool {
        self.ends.into_iter().all(DVec3::is_finite) && self.radius.is_finite()
    }

    #[inline(always)]
    fn may_hit(ray: &FilterRay, block: &CapsuleBlock, t_max: f32) -> (u32, F32x8) {
        filter::may_hit(ray, block, t_max)
    }

    #[inline(always)]
    fn enters_at_origin(&self, ray: &ExactRay) -> Option<(bool, Part)> {
        intersect::enters_at_origin(ray, self)
    }

    #[inline(always)]
    fn line(&self, ray: &ExactRay) -> Result<Option<CapsuleLine>, Doubt> {
        CapsuleLine::new(ray, self)
    }

    fn exact_hit(&self, ray: &ExactRay) -> Option<(Quotient, Part)> {
        exact::hit(ray, self)
    }

    fn normal_at(&self, point: DVec3) -> DVec3 {
        self.normal(point - self.ends[0]).0
    }

    fn surface_at(&self, ray: &ExactRay, t: f64) -> (DVec3, DVec3) {
        let (normal, along) = self.normal(ray.at_from(self.ends[0], t));
        let normal = normal_or_against(ray, normal);
        (self.ends[0].lerp(self.ends[1], along) + normal * self.radius, normal)
    }

    fn like_sphere(&self, half: usize) -> Sphere {
        Sphere { center: self.ends[half], radius: self.radius }
    }

    fn exact_exit(&self, ray: &ExactRay) -> Option<Quotient> {
        exact::exit(ray, self)
    }

    fn end_sphere(&self, part: Part) -> Option<Sphere> {
        match part {
            Part::End(end) => Some(Sphere { center: self.ends[end], radius: self.radius }),
            Part::Body => None,
        }
    }

    fn half_at(&self, ray: &ExactRay, t: f64) -> usize {
        usize::from(self.normal(ray.at_from(self.ends[0], t)).1 > 0.5)
    }
}

#[cfg(test)]
mod tests;
