//! Triangles in columns, and a tree over them: meshes. Hits are as exact as those of spheres: see [`Shape::intersect`].
//!
//! A triangle is a surface without inside, which rays hit from both sides. It is closed, and decided without rounding: a ray through an edge
//! hits both triangles that share it, at the same distance, and none passes between them. A ray that starts on triangles, within the rounding of its
//! origin, hits none of these: not at its origin, nor, as they are flat, anywhere else.

mod exact;
mod filter;
mod intersect;
mod triangle;

pub use triangle::Triangle;

use crate::body_rows::BodyKind;
use crate::body_tree::{BodyTree, Doubt, FilterRay, Part, Shape};
use crate::bounded::Bounded;
use crate::exact::Quotient;
use crate::lanes::F32x8;
use crate::ray::ExactRay;
use crate::spheres::LEAF;
use glam::{DVec3, Vec3};

/// The columns of [`LEAF`] triangles side by side.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub struct TriangleBlock {
    /// Corners, by axis; NaN where there is no triangle, which no ray hits.
    corners: [[[f32; LEAF]; 3]; 3],
}

/// A triangle from which a tree is built. Its stored numbers define the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleItem {
    corners: [Vec3; 3],
    id: u32,
}

/// The reason why there is no triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadTriangle {
    /// A corner is not finite.
    Corner,
    /// The corners are on one line, or two of them are equal.
    Line,
}

impl TriangleItem {
    /// Returns the triangle with three corners, which run counterclockwise on its outer side. Coordinates are about 1 at most, and
    /// `id` is the place in the user's order.
    ///
    /// # Errors
    ///
    /// Refuses corners that are not finite, and those that are on one line without any rounding. There is no other limit.
    pub fn new(corners: [Vec3; 3], id: u32) -> Result<Self, BadTriangle> {
        if !corners.into_iter().all(Vec3::is_finite) {
            return Err(BadTriangle::Corner);
        }
        let stored = Triangle { corners: corners.map(Vec3::as_dvec3) };
        if stored.area_normal() == DVec3::ZERO {
            return Err(BadTriangle::Line);
        }
        Ok(Self { corners, id })
    }

    /// The corners.
    pub fn corners(&self) -> [Vec3; 3] {
        self.corners
    }

    /// The place in the user's order.
    pub fn id(&self) -> u32 {
        self.id
    }
}

/// Triangles, and the tree over them.
pub type Triangles = BodyTree<Triangle>;

impl Shape for Triangle {
    const KIND: BodyKind = BodyKind::Triangle;

    type Item = TriangleItem;
    type Block = TriangleBlock;
    type Line = [Bounded; 2];

    const HAS_INSIDE: bool = false;

    const EMPTY: TriangleBlock = TriangleBlock { corners: [[[f32::NAN; LEAF]; 3]; 3] };

    fn around(item: &TriangleItem) -> (Vec3, f32, u32) {
        let [a, b, c] = item.corners;
        let center = a.min(b).min(c).midpoint(a.max(b).max(c));
        let reach = item.corners.map(|corner| corner.distance(center));
        (center, reach.into_iter().fold(0.0, f32::max), item.id)
    }

    fn store(item: &TriangleItem, block: &mut TriangleBlock, lane: usize) {
        for (columns, corner) in block.corners.iter_mut().zip(item.corners) {
            for (axis, column) in columns.iter_mut().enumerate() {
                column[lane] = corner[axis];
            }
        }
    }

    fn load(block: &TriangleBlock, lane: usize) -> Self {
        let corner =
            |columns: [[f32; LEAF]; 3]| DVec3::from(columns.map(|column| f64::from(column[lane])));
        Self { corners: block.corners.map(corner) }
    }

    fn extent(&self) -> [DVec3; 2] {
        let [a, b, c] = self.corners;
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// There is no inside.
    fn contains(&self, _: DVec3) -> bool {
        false
    }

    fn is_finite(&self) -> bool {
        self.corners.into_iter().all(DVec3::is_finite)
    }

    #[inline(always)]
    fn may_hit(ray: &FilterRay, block: &TriangleBlock, t_max: f32) -> (u32, F32x8) {
        filter::may_hit(ray, block, t_max)
    }

    #[inline(always)]
    fn enters_at_origin(&self, ray: &ExactRay) -> Option<(bool, Part)> {
        intersect::enters_at_origin(ray, self)
    }

    #[inline(always)]
    fn line(&self, ray: &ExactRay) -> Result<Option<[Bounded; 2]>, Doubt> {
        intersect::crossings(ray, self)
    }

    fn exact_hit(&self, ray: &ExactRay) -> Option<(Quotient, Part)> {
        exact::hit(ray, self).map(|t| (t, Part::Body))
    }

    /// Whatever starts on a surface has left it.
    fn exact_exit(&self, _: &ExactRay) -> Option<Quotient> {
        None
    }

    fn exit_distance(&self, _: &ExactRay) -> f64 {
        0.0
    }

    /// That of the side on which the corners run counterclockwise.
    fn normal_at(&self, _: DVec3) -> DVec3 {
        self.normal()
    }

    /// The normal is that of the side from which the ray comes.
    fn surface_at(&self, ray: &ExactRay, t: f64) -> (DVec3, DVec3) {
        let (corner, normal) = (self.corners[0], self.normal());
        let from = ray.at_from(corner, t);
        let point = corner + (from - normal * from.dot(normal));
        let is_behind = ray.direction.dot(normal) > 0.0;
        (point, if is_behind { -normal } else { normal })
    }
}

#[cfg(test)]
mod tests;
