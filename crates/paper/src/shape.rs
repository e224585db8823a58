//! Spheres, the ground, and their intersection with rays.

use super::{Ground, Surface};
use glam::DVec3;

/// Minimum distance of a hit, in the scene's unit. As in all tracers of this kind, scenes must be of
/// about unit size.
pub(super) const EPSILON: f64 = 1e-6;

/// A ray.
pub(super) struct Ray {
    pub(super) origin: DVec3,
    /// Unit vector.
    pub(super) direction: DVec3,
}

/// A hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The primitive.
    pub primitive: Primitive,
    /// Distance from the ray's origin, in the scene's unit.
    pub t: f64,
}

/// A primitive of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Primitive {
    /// Row of the scene's spheres.
    Sphere(usize),
    /// The ground plane.
    Ground,
}

/// A sphere with its surface.
pub(super) struct Sphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) surface: Surface,
}

impl Sphere {
    /// Returns the distance of the nearest hit between the epsilon and `t_max`.
    pub(super) fn hit(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        let toward = self.center - ray.origin;
        let middle = toward.dot(ray.direction);
        let discriminant = middle * middle - toward.length_squared() + self.radius * self.radius;
        if discriminant < 0.0 {
            return None;
        }
        let half = discriminant.sqrt();
        [middle - half, middle + half].into_iter().find(|t| *t > EPSILON && *t < t_max)
    }

    /// Updates the nearest hit if this sphere's is nearer.
    pub(super) fn closest(&self, row: usize, ray: &Ray, nearest: &mut Hit) {
        if let Some(t) = self.hit(ray, nearest.t) {
            *nearest = Hit { primitive: Primitive::Sphere(row), t };
        }
    }
}

impl Ground {
    /// Returns the distance of the hit, if it is between the epsilon and `t_max`.
    pub(super) fn hit(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        let t = (self.height - self.normal.dot(ray.origin)) / self.normal.dot(ray.direction);
        (t > EPSILON && t < t_max).then_some(t)
    }
}
