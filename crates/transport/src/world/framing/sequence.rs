//! A common camera for many scenes, the frames of a trajectory, which are not kept.

use super::{WorldError, bounding_sphere, fit, include_points, orbit};
use crate::scene::{Camera, Rgb, Scene, Spheres};
use fit::{LIMITS, Limits};
use glam::DVec3;

/// The few spheres that determine the camera that frames all of many scenes.
///
/// Scenes are added one after another, and only these spheres are kept: memory does not grow with the
/// number or size of scenes.
#[derive(Clone, Debug)]
pub struct SequenceBounds {
    /// Camera and picture size, without spheres.
    view: Scene,
    limits: Limits,
    /// The sphere with the minimum of each limit: the limit, its center and its radius.
    deciding: [Option<(f64, DVec3, f64)>; LIMITS],
    /// Center and radius of a sphere that contains everything.
    bounding_sphere: Option<(DVec3, f64)>,
}

impl SequenceBounds {
    /// Creates the bounds of no scenes, for the camera of `view`, which may be placed already; `vertical` is the direction
    /// that is up in the scenes. `None` if this camera has no direction or no room.
    pub fn new(view: &Scene, vertical: DVec3) -> Option<Self> {
        let limits = Limits::new(view, vertical)?;
        // What it frames is added with the scenes.
        let view = Scene {
            camera: Camera { framed: None, ..view.camera.clone() },
            settings: view.settings.clone(),
            ..Scene::default()
        };
        Some(Self { view, limits, deciding: [None; LIMITS], bounding_sphere: None })
    }

    /// Adds the visible spheres of a scene, and points that must be in the picture too, or the sphere that its camera frames.
    pub fn add(&mut self, scene: &Scene, points: &[DVec3]) {
        let mut any = false;
        let points = if scene.camera.framed.is_some() { &[] } else { points };
        for (center, radius) in fit::targets(scene).chain(points.iter().map(|&point| (point, 0.0)))
        {
            any = true;
            for (deciding, limit) in self.deciding.iter_mut().zip(self.limits.of(center, radius)) {
                if deciding.is_none_or(|(least, ..)| limit < least) {
                    *deciding = Some((limit, center, radius));
                }
            }
        }
        if any {
            let own = bounding_sphere(scene, points);
            self.bounding_sphere =
                Some(self.bounding_sphere.map_or(own, |earlier| enclosing(earlier, own)));
        }
    }

    /// Returns a scene of few spheres with a camera that frames all that was added. If `angle` is
    /// given, the camera is turned by it, in radians and to the right, from the same distance at every
    /// angle.
    ///
    /// # Errors
    /// [`WorldError::NothingToFit`] if nothing was added, and [`WorldError::Camera`] for a camera that
    /// sees nothing.
    pub fn view(&self, angle: Option<f64>) -> Result<Scene, WorldError> {
        let mut view = self.view.clone();
        view.spheres = Spheres::default();
        match (angle, self.bounding_sphere) {
            (Some(_), Some((center, radius))) => view.spheres.push(center, radius, 0, Rgb::ONE),
            _ => {
                for (_, center, radius) in self.deciding.iter().flatten() {
                    view.spheres.push(*center, *radius, 0, Rgb::ONE);
                }
            }
        }
        if view.spheres.is_empty() {
            return Err(WorldError::NothingToFit);
        }
        if let Some(angle) = angle {
            orbit(&mut view, &[], angle);
        }
        include_points(&mut view, &[])?;
        Ok(view)
    }
}

/// Returns the smallest sphere that contains two.
fn enclosing(first: (DVec3, f64), second: (DVec3, f64)) -> (DVec3, f64) {
    let (large, small) = if first.1 >= second.1 { (first, second) } else { (second, first) };
    let distance = large.0.distance(small.0);
    if distance + small.1 <= large.1 {
        return large;
    }
    let radius = (distance + large.1 + small.1) / 2.0;
    (large.0 + (small.0 - large.0) * ((radius - large.1) / distance), radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{FramedSphere, Pose, Projection};

    /// A cluster that moves and grows from frame to frame.
    fn frame(number: i32) -> Scene {
        let mut scene = Scene::default();
        for i in 0..30 {
            let angle = f64::from(i) * 2.4;
            let at = DVec3::new(angle.cos(), angle.sin() * 2.0, f64::from(i) * 0.1);
            let drift = DVec3::new(7.0, -3.0, 11.0) * f64::from(number);
            scene.spheres.push(at * f64::from(number + 1) + drift, 0.2, 0, Rgb::ONE);
        }
        scene
    }

    fn all(count: i32, camera: &Camera) -> (SequenceBounds, Scene) {
        let mut whole = Scene { camera: camera.clone(), ..Scene::default() };
        let mut bounds = SequenceBounds::new(&whole, camera.up).unwrap();
        for scene in (0..count).map(frame) {
            for row in 0..scene.spheres.len() {
                whole.spheres.push(scene.spheres.center(row), 0.2, 0, Rgb::ONE);
            }
            bounds.add(&scene, &[]);
        }
        (bounds, whole)
    }

    #[test]
    fn the_camera_is_that_of_all_frames_in_one_scene() {
        for projection in
            [Projection::Perspective { fov: 50.0 }, Projection::Orthographic { height: None }]
        {
            let camera = Camera { projection, ..Camera::default() };
            let (bounds, mut whole) = all(5, &camera);
            include_points(&mut whole, &[]).unwrap();
            assert_eq!(bounds.view(None).unwrap().camera, whole.camera);
        }
    }

    #[test]
    fn a_turn_keeps_all_frames_in_a_sphere() {
        let (bounds, whole) = all(4, &Camera::default());
        let (center, radius) = bounds.bounding_sphere.unwrap();
        for row in 0..whole.spheres.len() {
            let reach = whole.spheres.center(row).distance(center) + whole.spheres.radius[row];
            assert!(reach <= radius * (1.0 + 1e-12), "{reach} {radius}");
        }
        assert!(radius < 2.0 * bounding_sphere(&whole, &[]).1);
        let distance = |angle: f64| match bounds.view(Some(angle)).unwrap().camera.pose {
            Pose::LookAt { eye, target } => eye.distance(target),
            Pose::Fit { .. } => panic!("a fixed camera"),
        };
        assert!((distance(0.0) / distance(2.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn enclosing_spheres_are_no_larger_than_needed() {
        let (far, near) = ((DVec3::X * 10.0, 2.0), (DVec3::ZERO, 1.0));
        assert_eq!(enclosing(near, far), (DVec3::X * 5.5, 6.5));
        assert_eq!(enclosing(far, (DVec3::X * 11.0, 1.0)), far);
    }

    #[test]
    fn nothing_has_no_bounds_and_fixed_cameras_stay() {
        let empty = SequenceBounds::new(&Scene::default(), DVec3::Y).unwrap();
        assert!(matches!(empty.view(None), Err(WorldError::NothingToFit)));
        let mut placed = frame(0);
        include_points(&mut placed, &[]).unwrap();
        let mut bounds = SequenceBounds::new(&placed, DVec3::Y).unwrap();
        (0..3).for_each(|number| bounds.add(&frame(number), &[]));
        assert_eq!(bounds.view(None).unwrap().camera, placed.camera);
    }

    #[test]
    fn what_the_cameras_frame_is_followed_over_all_frames() {
        let framed = |x: f64| FramedSphere { center: DVec3::X * x, radius: 1.0 };
        let mut bounds = SequenceBounds::new(&frame(0), DVec3::Y).unwrap();
        let mut few = Scene::default();
        for x in [0.0, 7.0, 3.0] {
            let mut scene = frame(1);
            scene.camera.framed = Some(framed(x));
            bounds.add(&scene, &[DVec3::splat(1e3)]);
            few.spheres.push(framed(x).center, framed(x).radius, 0, Rgb::ONE);
        }
        include_points(&mut few, &[]).unwrap();
        assert_eq!(bounds.view(None).unwrap().camera, few.camera);
        assert_eq!(bounds.bounding_sphere, Some((DVec3::X * 3.5, 4.5)));
    }
}
