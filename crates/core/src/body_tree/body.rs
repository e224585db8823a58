//! A body of any kind, as the decision which of two is hit first sees it.

use super::{BodyHit, Part, Shape};
use crate::exact::{Distance, Quotient};
use crate::intersect::confirm_closely;
use crate::ray::ExactRay;
use glam::DVec3;

/// All points within a radius of a center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The center.
    pub center: DVec3,
    /// The radius.
    pub radius: f64,
}

/// A body that a ray may hit.
pub(crate) trait Body {
    /// Decides whether and where a ray hits it, with a close bound of the distance's error.
    fn hit(&self, ray: &ExactRay) -> Option<BodyHit>;

    /// The distance of the hit without rounding. There must be one, not by definition at the origin.
    fn distance(&self, ray: &ExactRay) -> Quotient;

    /// The sphere whose surface a part of this body's surface is; `None` if there is none.
    fn sphere_of(&self, part: Part) -> Option<Sphere>;
}

impl Body for Sphere {
    fn hit(&self, ray: &ExactRay) -> Option<BodyHit> {
        let root = confirm_closely(ray, self.center, self.radius, || false)?;
        Some(BodyHit { root, part: Part::Body })
    }

    fn distance(&self, ray: &ExactRay) -> Quotient {
        Distance::Hit(self.center, self.radius).value(ray)
    }

    fn sphere_of(&self, _: Part) -> Option<Sphere> {
        Some(*self)
    }
}

impl<S: Shape> Body for S {
    fn hit(&self, ray: &ExactRay) -> Option<BodyHit> {
        self.intersect(ray)
    }

    fn distance(&self, ray: &ExactRay) -> Quotient {
        self.exact_hit(ray).map_or_else(|| Distance::Number(0.0).value(ray), |(t, _)| t)
    }

    fn sphere_of(&self, part: Part) -> Option<Sphere> {
        self.end_sphere(part)
    }
}
