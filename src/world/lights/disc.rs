//! Emissive spheres, as seen from a point: discs that fill a cone.

use super::LightSample;
use crate::intersect;
use crate::lanes::Doubles;
use crate::ray::ExactRay;
use crate::sampling::{Cone, Frame};
use crate::scene::Rgb;
use crate::spheres::Spheres;
use crate::vec3::Vec3;
use glam::DVec3;

/// An emissive sphere as seen from a point: what fills a cone.
pub struct Disc {
    pub(super) row: u32,
    pub(super) frame: Frame,
    pub(super) cone: Cone,
    pub(super) origin: glam::Vec3,
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) weight: Rgb,
    pub(super) close: bool,
}

/// A sphere as seen from a point, or a row of both.
pub(super) struct Toward<D: Doubles> {
    /// Unit vector toward the center.
    pub direction: Vec3<D>,
    /// Squared distance of the center.
    pub distance2: D,
    /// Whether the center is nearer than the reach, in radii.
    pub close: D::Mask,
}

/// How a sphere, by center and radius, is seen from `origin`; close is nearer than `reach` radii.
#[inline(always)]
pub(super) fn toward<D: Doubles>(
    origin: Vec3<D>,
    (center, radius): (Vec3<D>, D),
    reach: f64,
) -> Toward<D> {
    let toward = center - origin;
    let distance2 = toward.dot_unfused(toward);
    let reach = D::splat(reach) * radius;
    Toward {
        direction: toward * (D::splat(1.0) / distance2.sqrt()),
        distance2,
        close: distance2.lt(reach * reach),
    }
}

/// How sphere `row` is seen from `origin`, and the cone that it fills; `None` from inside.
pub(super) fn toward_sphere(
    spheres: &Spheres,
    row: usize,
    (origin, reach): (glam::Vec3, f64),
) -> Option<(Toward<f64>, Cone)> {
    let (center, radius) = (spheres.center(row).as_dvec3(), f64::from(spheres.radius(row)));
    let seen = toward(origin.as_dvec3().into(), (center.into(), radius), reach);
    let cone = Cone::toward_sphere(seen.distance2, radius)?;
    Some((seen, cone))
}

impl Disc {
    /// Sphere `row`, of this radiance, as seen from `origin`; `None` from inside it. It is close within
    /// `reach` radii of its center.
    pub(super) fn new(
        spheres: &Spheres,
        row: usize,
        radiance: Rgb,
        (origin, reach): (glam::Vec3, f64),
    ) -> Option<Self> {
        let (seen, cone) = toward_sphere(spheres, row, (origin, reach))?;
        Some(Self {
            row: row as u32,
            frame: Frame::new(seen.direction.map(|x| x as f32).into()),
            origin,
            center: spheres.center(row).as_dvec3(),
            radius: f64::from(spheres.radius(row)),
            weight: radiance / cone.pdf(),
            cone,
            close: seen.close,
        })
    }

    /// Light from a point of it.
    #[inline]
    pub(super) fn sample(&self, u: [f32; 2]) -> LightSample {
        let direction = self.frame.to_world(self.cone.sample(u));
        LightSample {
            direction,
            t: distance((self.origin, direction), (self.center, self.radius)),
            target: self.row,
            weight: self.weight,
            pdf: Some(self.cone.pdf()),
            close: self.close,
        }
    }
}

/// Distance from a surface to a sphere, by center and radius. At the edge of its disc rounding may
/// take the ray past it: then, to the point where it is nearest.
pub(super) fn distance(
    (origin, direction): (glam::Vec3, glam::Vec3),
    (center, radius): (DVec3, f64),
) -> f64 {
    let ray = ExactRay::new(origin, direction, true);
    match intersect::confirm(&ray, center, radius, || false) {
        Some(root) => root.t,
        None => (center - ray.origin).dot(ray.direction) / ray.direction.length_squared(),
    }
}
