//! Spheres, the ground, and rays that meet them.

use super::{Ground, Surface};
use glam::DVec3;

/// Nothing nearer than this is hit: in the scene's unit, so that scenes must be of about unit size,
/// as with all tracers of this kind.
pub(super) const EPSILON: f64 = 1e-6;

/// A ray.
pub(super) struct Ray {
    pub(super) origin: DVec3,
    /// Of length 1.
    pub(super) direction: DVec3,
}

/// What a ray hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The thing.
    pub what: What,
    /// Distance from the ray's origin, in the scene's unit.
    pub t: f64,
}

/// A thing that can be hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// A row of the scene's spheres.
    Sphere(usize),
    /// The ground plane.
    Ground,
}

/// A sphere and what it is made of.
pub(super) struct Sphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) surface: Surface,
}

impl Sphere {
    /// Distance of the nearest hit between the epsilon and `most`.
    pub(super) fn hit(&self, ray: &Ray, most: f64) -> Option<f64> {
        let toward = self.center - ray.origin;
        let middle = toward.dot(ray.direction);
        let discriminant = middle * middle - toward.length_squared() + self.radius * self.radius;
        if discriminant < 0.0 {
            return None;
        }
        let half = discriminant.sqrt();
        [middle - half, middle + half].into_iter().find(|t| *t > EPSILON && *t < most)
    }

    /// Makes this sphere the nearest hit if it is.
    pub(super) fn closest(&self, row: usize, ray: &Ray, nearest: &mut Hit) {
        if let Some(t) = self.hit(ray, nearest.t) {
            *nearest = Hit { what: What::Sphere(row), t };
        }
    }
}

impl Ground {
    /// Distance of the hit, if it is between the epsilon and `most`.
    pub(super) fn hit(&self, ray: &Ray, most: f64) -> Option<f64> {
        let t = (self.height - self.normal.dot(ray.origin)) / self.normal.dot(ray.direction);
        (t > EPSILON && t < most).then_some(t)
    }
}
