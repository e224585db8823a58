//! Ellipsoids in columns, and a tree over them. Hits are as exact as those of spheres: see [`Shape::intersect`].

mod ellipsoid;
mod exact;
mod filter;
mod intersect;
mod inverse;

pub use ellipsoid::Ellipsoid;

use crate::body_rows::BodyKind;
use crate::body_tree::{BodyTree, Doubt, FilterRay, Part, Shape, normal_or_against};
use crate::bounded::Bounded;
use crate::exact::Quotient;
use crate::lanes::F32x8;
use crate::ray::ExactRay;
use crate::spheres::LEAF;
use glam::{DQuat, DVec3, Vec3};

/// The columns of [`LEAF`] ellipsoids side by side.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct EllipsoidBlock {
    /// Centers, by axis.
    center: [[f32; LEAF]; 3],
    /// The matrices, by row and column.
    to_unit: [[[f32; LEAF]; 3]; 3],
    /// Radii of spheres around the ellipsoids; NaN where there is no ellipsoid, which no ray hits.
    reach: [f32; LEAF],
}

/// An ellipsoid from which a tree is built. Its stored numbers define the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipsoidItem {
    center: Vec3,
    to_unit: [Vec3; 3],
    reach: f32,
    id: u32,
}

/// The reason why there is no ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadEllipsoid {
    /// A semi-axis is not a number above 0, or less than [`EllipsoidItem::LEAST_AXIS`].
    Axis,
    /// The longest semi-axis is more than [`EllipsoidItem::MAX_RATIO`] times the shortest.
    Ratio,
}

impl EllipsoidItem {
    /// The largest ratio of two semi-axes. Rounding a matrix to single precision turns axes by up to 2^-23, which moves the end of
    /// the longest one by 0.2 % of the shortest at this ratio.
    pub const MAX_RATIO: f64 = 16_384.0;

    /// The least semi-axis.
    pub const LEAST_AXIS: f64 = 1.0 / (1_u64 << 50) as f64;

    /// Returns the ellipsoid with a center and semi-axes along x, y and z, which are then rotated. Coordinates and semi-axes are
    /// about 1 at most, `orientation` is a unit quaternion, and `id` the place in the user's order.
    ///
    /// # Errors
    ///
    /// Refuses semi-axes that are no positive numbers, too small, or too different.
    pub fn new(
        center: Vec3,
        semi_axes: DVec3,
        orientation: DQuat,
        id: u32,
    ) -> Result<Self, BadEllipsoid> {
        let (least, most) = (semi_axes.min_element(), semi_axes.max_element());
        if semi_axes.is_nan() || !most.is_finite() || least < Self::LEAST_AXIS {
            return Err(BadEllipsoid::Axis);
        }
        if most > least * Self::MAX_RATIO {
            return Err(BadEllipsoid::Ratio);
        }
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let row = |i: usize| (orientation * axes[i] / semi_axes[i]).as_vec3();
        let to_unit = std::array::from_fn(row);
        let stored = Ellipsoid { center: center.as_dvec3(), to_unit: to_unit.map(Vec3::as_dvec3) };
        // No point is farther from the center than the corners of the box.
        let reach = (inverse::half_extent(&stored).length() as f32).next_up().next_up();
        Ok(Self { center, to_unit, reach, id })
    }

    /// The place in the user's order.
    pub fn id(&self) -> u32 {
        self.id
    }
}

/// Ellipsoids, and the tree over them.
pub type Ellipsoids = BodyTree<Ellipsoid>;

impl Shape for Ellipsoid {
    const KIND: BodyKind = BodyKind::Ellipsoid;

    type Item = EllipsoidItem;
    type Block = EllipsoidBlock;
    type Line = [Bounded; 2];

    const EMPTY: EllipsoidBlock = EllipsoidBlock {
        center: [[0.0; LEAF]; 3],
        to_unit: [[[0.0; LEAF]; 3]; 3],
        reach: [f32::NAN; LEAF],
    };

    fn around(item: &EllipsoidItem) -> (Vec3, f32, u32) {
        (item.center, item.reach, item.id)
    }

    fn store(item: &EllipsoidItem, block: &mut EllipsoidBlock, lane: usize) {
        for axis in 0..3 {
            block.center[axis][lane] = item.center[axis];
            for (columns, row) in block.to_unit.iter_mut().zip(item.to_unit) {
                columns[axis][lane] = row[axis];
            }
        }
        block.reach[lane] = item.reach;
    }

    fn load(block: &EllipsoidBlock, lane: usize) -> Self {
        let vector =
            |columns: [[f32; LEAF]; 3]| DVec3::from(columns.map(|column| f64::from(column[lane])));
        Self { center: vector(block.center), to_unit: block.to_unit.map(vector) }
    }

    fn extent(&self) -> [DVec3; 2] {
        let half = inverse::half_extent(self);
        [self.center - half, self.center + half]
    }

    fn contains(&self, point: DVec3) -> bool {
        self.to_unit(point - self.center).length_squared() < 1.0
    }

    fn is_finite(&self) -> bool {
        self.center.is_finite() && self.to_unit.iter().all(|row| row.is_finite())
    }

    #[inline(always)]
    fn may_hit(ray: &FilterRay, block: &EllipsoidBlock, t_max: f32) -> (u32, F32x8) {
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

    fn normal_at(&self, point: DVec3) -> DVec3 {
        self.normal(point - self.center)
    }

    fn surface_at(&self, ray: &ExactRay, t: f64) -> (DVec3, DVec3) {
        let from = self.onto_surface(ray.at_from(self.center, t));
        (self.center + from, normal_or_against(ray, self.normal(from)))
    }

    fn exact_exit(&self, ray: &ExactRay) -> Option<Quotient> {
        // From inside, and otherwise as close to the surface as can be.
        exact::hit(ray, self)
    }
}

#[cfg(test)]
mod tests;
