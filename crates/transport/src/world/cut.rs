//! Flat cuts: the planes at which all spheres end, and the clipping of rays by them.
//!
//! The half spaces that are kept have a convex intersection, so that the kept part of a ray is one
//! interval, and that of a sphere a convex body. A ray that starts in the part that is cut away enters
//! at a point of a plane: if this point is inside a sphere, the ray has hit the sphere's cap there; if
//! not, it continues from there. Like all points on surfaces, the point is stored in single precision,
//! and hits from there on are exact ([`crate::intersect`]).

use super::appearance::Appearance;
use super::{Transform, WorldError};
use crate::ray::{ExactRay, GROUND};
use crate::scene::{Slice, SliceMode};
use crate::shade::MaterialKind;
use crate::spheres::Spheres;
use glam::DVec3;

/// The planes of the slices that cut spheres, in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cut {
    planes: Vec<Plane>,
}

/// A half space that is cut away: the points `p` with `normal . p > height`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    /// Unit normal.
    normal: DVec3,
    height: f64,
}

/// The kept part of a ray: distances in units of the direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Distance at which the ray enters; 0 if it starts in the kept part.
    pub from: f64,
    /// Distance at which the ray leaves; not more than `from` if nothing is kept.
    pub to: f64,
    entry: Option<DVec3>,
    exit: Option<DVec3>,
}

impl Span {
    const WHOLE: Self = Self { from: 0.0, to: f64::INFINITY, entry: None, exit: None };

    /// Returns whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.from >= self.to
    }

    /// Returns the outward normal of the plane that a ray crosses at distance `t`, compared bit by bit.
    fn normal(&self, t: f64) -> Option<DVec3> {
        let entry = self.entry.filter(|_| t == self.from);
        entry.or(self.exit.filter(|_| t == self.to))
    }
}

/// Returns an error if a plane cuts a glass sphere.
pub(super) fn refuse_glass(
    cut: &Cut,
    spheres: &Spheres,
    appearance: &Appearance,
) -> Result<(), WorldError> {
    if cut.is_empty() {
        return Ok(());
    }
    let glass = |&row: &usize| appearance.material.row(row).kind() == MaterialKind::Dielectric;
    let divided = |row: &usize| {
        let (center, radius) = spheres.exact(*row);
        cut.divides(center, radius)
    };
    let first = (0..spheres.len()).filter(glass).filter(divided).map(|row| spheres.id[row]).min();
    first.map_or(Ok(()), |id| Err(WorldError::Glass(id)))
}

impl Cut {
    pub(super) fn build(slices: &[Slice], transform: &Transform) -> Self {
        let cuts = slices.iter().filter(|slice| slice.mode == SliceMode::Caps);
        let plane = |slice: &Slice| Plane {
            normal: slice.normal,
            height: transform.length(slice.distance - slice.normal.dot(transform.shift)),
        };
        Self { planes: cuts.map(plane).collect() }
    }

    /// Returns the number of planes.
    pub fn len(&self) -> usize {
        self.planes.len()
    }

    /// Returns whether no sphere is cut.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// Returns whether a plane cuts a sphere.
    pub fn divides(&self, center: DVec3, radius: f64) -> bool {
        self.planes.iter().any(|plane| (plane.normal.dot(center) - plane.height).abs() < radius)
    }

    /// Returns the kept part of a ray that starts on `own`: see [`Rays::own`](crate::ray::Rays::own).
    ///
    /// A ray that starts on a sphere starts in the kept part. If the origin is on a plane, within its
    /// own rounding, a ray along the normal leaves at once and any other does not cross the plane.
    pub fn clip(&self, ray: &ExactRay, own: u32) -> Span {
        let mut span = Span::WHOLE;
        for plane in &self.planes {
            let above = plane.normal.dot(ray.origin) - plane.height;
            let rise = plane.normal.dot(ray.direction);
            let t = -above / rise;
            if above.abs() <= ray.origin_error || (above > 0.0 && own < GROUND) {
                if rise > 0.0 {
                    (span.to, span.exit) = (0.0, Some(plane.normal));
                }
            } else if above > 0.0 {
                if rise >= 0.0 {
                    span.to = 0.0;
                } else if t > span.from {
                    (span.from, span.entry) = (t, Some(plane.normal));
                }
            } else if rise > 0.0 && t < span.to {
                (span.to, span.exit) = (t, Some(plane.normal));
            }
        }
        span
    }

    /// Returns the outward normal of the cap that a ray, which starts on `own`, has hit at distance
    /// `t`; `None` if it has hit a sphere's own surface there.
    pub fn cap(&self, ray: &ExactRay, own: u32, t: f64) -> Option<DVec3> {
        self.clip(ray, own).normal(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::MISS;

    fn cut(planes: &[(DVec3, f64)]) -> Cut {
        Cut { planes: planes.iter().map(|&(normal, height)| Plane { normal, height }).collect() }
    }

    fn ray(origin: DVec3, direction: DVec3) -> ExactRay {
        ExactRay { origin, direction, origin_error: 0.0 }
    }

    #[test]
    fn rays_are_kept_between_the_planes_that_they_cross() {
        let wedge = cut(&[(DVec3::Z, 1.0), (DVec3::X, 2.0)]);
        let clip = |origin, direction| {
            let span = wedge.clip(&ray(origin, direction), MISS);
            (!span.is_empty()).then_some([span.from, span.to])
        };
        let all = f64::INFINITY;
        for (origin, direction, kept) in [
            (DVec3::ZERO, DVec3::NEG_Z, Some([0.0, all])),
            (DVec3::ZERO, DVec3::Z, Some([0.0, 1.0])),
            (DVec3::Z * 4.0, DVec3::NEG_Z, Some([3.0, all])),
            (DVec3::Z * 4.0, DVec3::Z, None),
            (DVec3::Z * 4.0, DVec3::X, None),
            (DVec3::Z * 4.0, DVec3::new(0.25, 0.0, -1.0), Some([3.0, 8.0])),
            (DVec3::Z * 4.0, DVec3::new(1.0, 0.0, -1.0), None),
            (DVec3::new(6.0, 0.0, 4.0), DVec3::new(-2.0, 0.0, -1.0), Some([3.0, all])),
            (DVec3::Z, DVec3::Z, None),
            (DVec3::Z, DVec3::Y, Some([0.0, all])),
            (DVec3::Z, DVec3::NEG_Z, Some([0.0, all])),
        ] {
            assert_eq!(clip(origin, direction), kept, "{origin} {direction}");
        }
    }

    #[test]
    fn rays_from_spheres_start_in_the_kept_part() {
        let plane = cut(&[(DVec3::Z, 1.0)]);
        let origin = DVec3::Z * (1.0 + 1e-9);
        let clip = |direction, own| plane.clip(&ray(origin, direction), own);
        assert!(clip(DVec3::NEG_Z, MISS).from > 0.0);
        assert!(clip(DVec3::NEG_Z, GROUND).from > 0.0);
        assert_eq!(clip(DVec3::NEG_Z, 7), Span::WHOLE);
        assert!(clip(DVec3::Z, 7).is_empty());
    }

    #[test]
    fn caps_are_where_rays_cross_planes() {
        let plane = cut(&[(DVec3::Z, 1.0)]);
        let down = ray(DVec3::Z * 4.0, DVec3::NEG_Z);
        assert_eq!(plane.cap(&down, MISS, 3.0), Some(DVec3::Z));
        assert_eq!(plane.cap(&down, MISS, 3.0_f64.next_up()), None);
        assert_eq!(plane.cap(&ray(DVec3::ZERO, DVec3::Z), MISS, 1.0), Some(DVec3::Z));
        assert_eq!(Cut::default().cap(&down, MISS, 3.0), None);
        // From inside, at the rim.
        assert_eq!(plane.cap(&ray(DVec3::Z, DVec3::new(1.0, 0.0, 1.0)), 7, 0.0), Some(DVec3::Z));
        assert!(plane.divides(DVec3::ZERO, 1.5) && !plane.divides(DVec3::ZERO, 1.0));
    }
}
