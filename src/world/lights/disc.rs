//! Emissive spheres, as seen from a point: discs that fill a cone.

use super::LightSample;
use crate::intersect;
use crate::ray::ExactRay;
use crate::sampling::{Cone, Frame};
use crate::scene::Rgb;
use crate::spheres::Spheres;
use glam::{DVec3, Vec3};

/// An emissive sphere as seen from a point: what fills a cone.
pub struct Disc {
    pub(super) row: u32,
    pub(super) frame: Frame,
    pub(super) cone: Cone,
    pub(super) origin: Vec3,
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) weight: Rgb,
    close: bool,
}

/// Direction to the center of sphere `row`, the cone that it fills as seen from `origin`, and
/// whether it is close; `None` from inside.
///
/// Close is nearer than `reach` radii from the center.
pub(super) fn toward_sphere(
    spheres: &Spheres,
    row: usize,
    (origin, reach): (Vec3, f64),
) -> Option<(DVec3, Cone, bool)> {
    let toward = spheres.center(row).as_dvec3() - origin.as_dvec3();
    let radius = f64::from(spheres.radius(row));
    let distance2 = toward.length_squared();
    let cone = Cone::toward_sphere(distance2, radius)?;
    Some((toward, cone, distance2 < (reach * radius).powi(2)))
}

impl Disc {
    /// Sphere `row`, of this radiance, as seen from `origin`; `None` from inside it. It is close within
    /// `reach` radii of its center.
    pub(super) fn new(
        spheres: &Spheres,
        row: usize,
        radiance: Rgb,
        (origin, reach): (Vec3, f64),
    ) -> Option<Self> {
        let (toward, cone, close) = toward_sphere(spheres, row, (origin, reach))?;
        Some(Self {
            row: row as u32,
            frame: Frame::new(toward.normalize().as_vec3()),
            origin,
            center: spheres.center(row).as_dvec3(),
            radius: f64::from(spheres.radius(row)),
            weight: radiance / cone.pdf(),
            cone,
            close,
        })
    }

    /// Light from a point of it.
    #[inline]
    pub(super) fn sample(&self, u: [f32; 2]) -> LightSample {
        let direction = self.frame.to_world(self.cone.sample(u));
        LightSample {
            direction,
            t: self.distance(direction),
            target: self.row,
            weight: self.weight,
            pdf: Some(self.cone.pdf()),
            close: self.close,
        }
    }

    /// Distance to the sphere. At the edge of its disc rounding may take the ray past it: then, to
    /// the point where it is nearest.
    pub(super) fn distance(&self, direction: Vec3) -> f64 {
        let ray = ExactRay::new(self.origin, direction, true);
        match intersect::confirm(&ray, self.center, self.radius, || false) {
            Some(root) => root.t,
            None => (self.center - ray.origin).dot(ray.direction) / ray.direction.length_squared(),
        }
    }
}
