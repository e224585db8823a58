//! The transform from the user's coordinates to the world's: a shift and a power of two.

use crate::elementary::{ceil_log2, power_of_two};
use crate::scene::{BodyColumns, Rgb, Scene, Spheres};
use crate::world::fit::Placement;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Maximum number of spheres that are sampled to find the scene's middle.
const SAMPLES: usize = 1 << 16;

/// Minimum extent of the spheres, relative to the distance of the camera, for a world that suits other
/// cameras. Rays may start 2^20 times as far away as the largest coordinate (see
/// [`crate::conservative`]).
const MIN_EXTENT: f64 = 1.0 / (1 << 16) as f64;

/// A transform from the user's coordinates to the world's: `world = (user - shift) * scale`.
///
/// Single precision is finest near the origin, so the scene's middle is moved there. The middle is a
/// median, so that a ground-like sphere of radius 1e7 does not move it away from the small spheres. The
/// shift is a multiple of a power of two of about the scene's extent: subtracting it from
/// single-precision coordinates is exact, and a scene near its origin is not shifted at all. The scale
/// is a power of two too, so that a scene scaled by one renders to the same bytes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Shift in the user's coordinates.
    pub shift: DVec3,
    /// A power of two that scales the largest coordinate to 0.5..=1.
    pub scale: f64,
    /// The largest coordinate of spheres after the shift, in the user's unit; 0 if there is none.
    reach: f64,
}

impl Transform {
    /// Of a scene, with all its spheres.
    pub(super) fn of(scene: &Scene, camera: &Placement) -> Self {
        let (spheres, others) = (&scene.spheres, scene.other_bodies());
        let shift = if spheres.is_empty() {
            let first = others.into_iter().find(|bodies| !bodies.is_empty());
            first.map_or(DVec3::ZERO, |bodies| middle(&anchors(bodies)))
        } else {
            middle(spheres)
        };
        let reach_of =
            |(center, radius): (DVec3, f64)| (center - shift).abs().max_element() + radius;
        let reach = (0..spheres.len())
            .map(|row| reach_of((spheres.center(row), spheres.radius[row])))
            .fold(0.0, f64::max);
        let reach = scene.other_hulls().map(reach_of).fold(reach, f64::max);
        Self { shift, scale: 1.0, reach }.with_camera(camera)
    }

    /// Returns the transform of the same spheres with another camera.
    fn with_camera(self, camera: &Placement) -> Self {
        let eye = (camera.eye - self.shift).abs().max_element() + camera.reach;
        let scale = power_of_two_above(self.reach.max(eye)).recip();
        Self { scale: if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }, ..self }
    }

    /// Returns whether a world with this transform is valid for another camera: the camera's own
    /// transform differs only by a power of two; in both, the spheres are large enough for equal
    /// rounding to single precision, and the camera is near enough for the conservative test.
    pub(super) fn suits(&self, camera: &Placement) -> bool {
        let own = self.with_camera(camera);
        let near = |transform: &Self| transform.reach > 0.0 && transform.extent() >= MIN_EXTENT;
        own.scale == self.scale || near(&own) && near(self)
    }

    /// Returns the spheres' largest coordinate in the world, rounded up to a power of two; 1 if there
    /// are no spheres. Decisions in this unit do not depend on the camera.
    pub(super) fn extent(&self) -> f64 {
        let extent = power_of_two_above(self.reach) * self.scale;
        if self.reach > 0.0 && extent > 0.0 { extent } else { 1.0 }
    }

    /// Returns whether finite points are mapped to finite points.
    pub(super) fn is_finite(&self) -> bool {
        let scale = self.scale > 0.0 && self.scale < f64::INFINITY;
        scale && self.shift.is_finite() && self.reach.is_finite()
    }

    /// Transforms a point.
    pub fn point(&self, user: DVec3) -> DVec3 {
        (user - self.shift) * self.scale
    }

    /// Transforms a length.
    pub fn length(&self, user: f64) -> f64 {
        user * self.scale
    }

    /// Returns a point of the world in the user's coordinates.
    pub fn user_point(&self, point: DVec3) -> DVec3 {
        point / self.scale + self.shift
    }
}

/// Returns spheres that stand for bodies.
fn anchors(bodies: &dyn BodyColumns) -> Spheres {
    let mut spheres = Spheres::default();
    for (center, radius) in (0..bodies.len()).map(|row| bodies.anchor(row)) {
        spheres.push(center, radius, 0, Rgb::ONE);
    }
    spheres
}

/// Returns the median center, rounded to a multiple of a power of two not below the median distance
/// from it.
fn middle(spheres: &Spheres) -> DVec3 {
    let rows = || (0..spheres.len()).step_by(spheres.len().div_ceil(SAMPLES));
    let median_of = |f: &dyn Fn(usize) -> f64| median(rows().map(f).collect());
    let columns = [&spheres.x, &spheres.y, &spheres.z];
    let middle = columns.map(|column| median_of(&|i| column[i]));
    let spread = |axis: usize| median_of(&|i| (columns[axis][i] - middle[axis]).abs());
    let extent = spread(0).max(spread(1)).max(spread(2)) + median_of(&|i| spheres.radius[i]);
    // Not a few extents: a scene on a giant sphere about the origin would lose digits of that sphere's
    // center for one or two of its own.
    let quantum = power_of_two_above(8.0 * extent);
    DVec3::from(middle.map(|m| (m / quantum).round() * quantum))
}

fn median(mut values: Vec<f64>) -> f64 {
    let half = values.len() / 2;
    *values.select_nth_unstable_by(half, f64::total_cmp).1
}

/// Returns the least power of two that is not below `x`; 1 for 0.
fn power_of_two_above(x: f64) -> f64 {
    if x > 0.0 { power_of_two(ceil_log2(x).clamp(-1020, 1020)) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform(centers: &[[f64; 3]], radius: &[f64]) -> Transform {
        let spheres = Spheres {
            x: centers.iter().map(|c| c[0]).collect(),
            y: centers.iter().map(|c| c[1]).collect(),
            z: centers.iter().map(|c| c[2]).collect(),
            radius: radius.to_vec(),
            ..Spheres::default()
        };
        Transform::of(
            &Scene { spheres, ..Scene::default() },
            &Placement { eye: DVec3::from(centers[0]), reach: 0.0, ..Placement::default() },
        )
    }

    #[test]
    fn a_scene_near_its_origin_is_not_moved() {
        let transform =
            transform(&[[0.2, 0.1, 0.0], [-3.0, 1.0, 2.0], [1.0, -1.0, 0.5]], &[1.0, 1.0, 0.5]);
        assert_eq!(transform.shift, DVec3::ZERO);
        assert_eq!(transform.scale, 0.25);
    }

    #[test]
    fn a_far_scene_is_moved_exactly() {
        let near = [[0.25, 0.5, 0.0], [-0.75, 0.5, 2.0], [1.0, -1.0, 0.5]];
        let far = near.map(|c| c.map(|x| x + 1e6));
        let (a, b) = (transform(&near, &[0.5; 3]), transform(&far, &[0.5; 3]));
        assert_ne!(b.shift, DVec3::ZERO);
        for (p, q) in near.iter().zip(&far) {
            let (p, q) = (a.point(DVec3::from(*p)), b.point(DVec3::from(*q)));
            assert_eq!((p - q) / a.scale % 1.0, DVec3::ZERO, "moved by whole units only");
        }
    }

    #[test]
    fn cameras_that_are_not_too_far_away_share_a_transform() {
        let transform =
            transform(&[[0.2, 0.1, 0.0], [-3.0, 1.0, 2.0], [1.0, -1.0, 0.5]], &[1.0, 1.0, 0.5]);
        let suits = |x: f64| {
            transform.suits(&Placement { eye: DVec3::new(x, 0.0, 0.0), ..Placement::default() })
        };
        assert!(suits(0.0) && suits(1e3) && suits(-2e5));
        assert!(!suits(3e5) && !suits(1e300));
    }

    #[test]
    fn a_giant_sphere_does_not_move_the_origin() {
        let transform = transform(
            &[[0.0, -1e7, 0.0], [0.0, 0.1, 0.0], [0.3, 0.1, 0.1], [0.6, 0.1, 0.0]],
            &[1e7, 0.1, 0.1, 0.1],
        );
        assert!(transform.shift.abs().max_element() <= 0.5, "{}", transform.shift);
    }

    #[test]
    fn scaling_the_scene_by_a_power_of_two_changes_nothing_but_the_scale() {
        let centers = [[3.1, 0.1, -2.0], [5.2, 1.0, 0.4], [4.4, 0.9, 1.7]];
        for exponent in [-60, 60] {
            let factor = f64::from(exponent).exp2();
            let scaled = centers.map(|c| c.map(|x| x * factor));
            let (a, b) = (transform(&centers, &[0.3; 3]), transform(&scaled, &[0.3 * factor; 3]));
            for (p, q) in centers.iter().zip(&scaled) {
                assert_eq!(a.point(DVec3::from(*p)), b.point(DVec3::from(*q)));
            }
        }
    }
}
