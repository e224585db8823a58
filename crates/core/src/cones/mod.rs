//! Cones in columns, and a tree over them. Hits are as exact as those of spheres: see [`Shape::intersect`].

mod cone;
mod exact;
mod filter;
mod intersect;

pub use cone::{Cone, Face};

use crate::body_rows::BodyKind;
use crate::body_tree::{BodyTree, Doubt, FilterRay, Part, Shape, first_ahead, normal_or_against};
use crate::bounded::Bounded;
use crate::exact::Quotient;
use crate::lanes::F32x8;
use crate::ray::ExactRay;
use crate::spheres::LEAF;
use glam::{DVec3, Vec3};

/// The faces, in the order of [`Cone::distances`].
const FACES: [Face; 2] = [Face::Side, Face::Base];

/// The columns of [`LEAF`] cones side by side.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct ConeBlock {
    /// Apexes, by axis.
    apex: [[f32; LEAF]; 3],
    /// Centers of the bases, by axis.
    base: [[f32; LEAF]; 3],
    /// Radii; NaN where there is no cone, which no ray hits.
    radius: [f32; LEAF],
}

/// A cone from which a tree is built. Its stored numbers define the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeItem {
    apex: Vec3,
    base: Vec3,
    radius: f32,
    id: u32,
}

/// The reason why there is no cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadCone {
    /// The radius is not a number above 0, or less than [`ConeItem::LEAST`].
    Radius,
    /// The apex is less than [`ConeItem::LEAST`] from the base, or one of both is not finite.
    Height,
    /// Of the height and the radius one is more than [`ConeItem::MAX_RATIO`] times the other.
    Ratio,
}

impl ConeItem {
    /// The largest ratio of height and radius in both directions.
    pub const MAX_RATIO: f64 = 16_384.0;

    /// The least height and radius.
    pub const LEAST: f64 = 1.0 / (1_u64 << 50) as f64;

    /// Returns the cone with an apex, the center of the base, and the base's radius. Coordinates and the radius are about 1 at
    /// most, and `id` is the place in the user's order.
    ///
    /// # Errors
    ///
    /// Refuses radii that are no positive numbers, and cones that are too small, too long or too flat.
    pub fn new(apex: Vec3, base: Vec3, radius: f32, id: u32) -> Result<Self, BadCone> {
        let height = (base.as_dvec3() - apex.as_dvec3()).length();
        let wide = f64::from(radius);
        if wide.is_nan() || wide < Self::LEAST || !wide.is_finite() {
            return Err(BadCone::Radius);
        }
        if !height.is_finite() || height < Self::LEAST {
            return Err(BadCone::Height);
        }
        if height > wide * Self::MAX_RATIO || wide > height * Self::MAX_RATIO {
            return Err(BadCone::Ratio);
        }
        Ok(Self { apex, base, radius, id })
    }

    /// The place in the user's order.
    pub fn id(&self) -> u32 {
        self.id
    }
}

/// Cones, and the tree over them.
pub type Cones = BodyTree<Cone>;

impl Shape for Cone {
    const KIND: BodyKind = BodyKind::Cone;

    type Item = ConeItem;
    type Block = ConeBlock;
    type Line = [Bounded; 2];

    const EMPTY: ConeBlock =
        ConeBlock { apex: [[0.0; LEAF]; 3], base: [[0.0; LEAF]; 3], radius: [f32::NAN; LEAF] };

    fn around(item: &ConeItem) -> (Vec3, f32, u32) {
        let half = (item.base - item.apex) * 0.5;
        let reach = (half.length_squared() + item.radius * item.radius).sqrt();
        (item.apex + half, reach, item.id)
    }

    fn store(item: &ConeItem, block: &mut ConeBlock, lane: usize) {
        for axis in 0..3 {
            block.apex[axis][lane] = item.apex[axis];
            block.base[axis][lane] = item.base[axis];
        }
        block.radius[lane] = item.radius;
    }

    fn load(block: &ConeBlock, lane: usize) -> Self {
        let vector =
            |columns: [[f32; LEAF]; 3]| DVec3::from(columns.map(|column| f64::from(column[lane])));
        Self {
            apex: vector(block.apex),
            base: vector(block.base),
            radius: f64::from(block.radius[lane]),
        }
    }

    fn extent(&self) -> [DVec3; 2] {
        let axis = (self.base - self.apex).normalize_or_zero();
        let half = (DVec3::ONE - axis * axis).max(DVec3::ZERO).map(f64::sqrt) * self.radius;
        [self.apex.min(self.base - half), self.apex.max(self.base + half)]
    }

    fn contains(&self, point: DVec3) -> bool {
        let [side, base] = self.distances(point - self.apex);
        side < 0.0 && base < 0.0
    }

    fn is_finite(&self) -> bool {
        [self.apex, self.base].into_iter().all(DVec3::is_finite) && self.radius.is_finite()
    }

    #[inline(always)]
    fn may_hit(ray: &FilterRay, block: &ConeBlock, t_max: f32) -> (u32, F32x8) {
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
        exact::crossings(ray, self).and_then(first_ahead).map(|t| (t, Part::Body))
    }

    fn normal_at(&self, point: DVec3) -> DVec3 {
        self.normal(point - self.apex)
    }

    fn surface_at(&self, ray: &ExactRay, t: f64) -> (DVec3, DVec3) {
        let from = self.onto_surface(ray.at_from(self.apex, t));
        (self.apex + from, normal_or_against(ray, self.normal(from)))
    }

    fn exact_exit(&self, ray: &ExactRay) -> Option<Quotient> {
        let [_, leave] = exact::crossings(ray, self)?;
        (leave.sign() > 0).then_some(leave)
    }
}

#[cfg(test)]
mod tests;
