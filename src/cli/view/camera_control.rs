//! Camera control: orbit about a pivot, pan, and zoom toward the pointer.

use glam::{DQuat, DVec2, DVec3};
use spherule_render::elementary::{acos, rotation, tan};
use spherule_render::scene::{Camera, Lens, Pose, Projection};

/// Minimum angle between the view direction and the vertical axis, in radians.
const POLE: f64 = 0.01;

/// Range of fields of view, in degrees.
const FIELDS: (f64, f64) = (1.0, 150.0);

/// Minimum and maximum distance from the pivot, relative to the scene's size.
const DISTANCES: (f64, f64) = (1e-5, 1e4);

/// Initial aperture, relative to the distance of the pivot.
const APERTURE: f64 = 0.02;

/// A camera with interactive controls.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CameraControl {
    /// The camera, placed by its eye.
    pub(super) camera: Camera,
    /// Center of orbits and zooms.
    pub(super) pivot: DVec3,
    /// Unit vector of the vertical axis of orbits.
    vertical: DVec3,
    /// Radius of the bounding sphere of the scene, greater than 0.
    size: f64,
    /// Field of view of the last perspective projection, in degrees.
    fov: f64,
}

/// Unit axes of the image.
#[derive(Clone, Copy, Debug)]
struct Axes {
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

/// An ellipse in the image, in units of the image's height from its center, to the right and upward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outline {
    pub(super) center: DVec2,
    pub(super) radii: DVec2,
    /// Unit direction of the first radius.
    pub(super) axis: DVec2,
}

impl CameraControl {
    /// Creates the control of a camera that is placed by its eye, in a scene of this size.
    pub(super) fn new(camera: Camera, size: f64) -> Self {
        let vertical = camera.up.normalize_or(DVec3::Y);
        let pivot = match camera.pose {
            Pose::LookAt { target, .. } => target,
            Pose::Fit { .. } => DVec3::ZERO,
        };
        let fov = match camera.projection {
            Projection::Perspective { fov } => fov,
            Projection::Orthographic { .. } => Camera::LONG_FOV,
        };
        Self { camera, pivot, vertical, size: size.max(f64::MIN_POSITIVE), fov }
    }

    /// Sets the size of the scene.
    pub(super) fn resize(&mut self, size: f64) {
        self.size = size.max(f64::MIN_POSITIVE);
    }

    /// Radius of the bounding sphere of the scene.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Sets the vertical axis of orbits, a unit vector.
    pub(super) fn set_vertical(&mut self, vertical: DVec3) {
        self.vertical = vertical;
    }

    /// Vertical axis of orbits.
    pub(super) fn vertical(&self) -> DVec3 {
        self.vertical
    }

    fn eye(&self) -> DVec3 {
        self.eye_and_target().0
    }

    fn eye_and_target(&self) -> (DVec3, DVec3) {
        match self.camera.pose {
            Pose::LookAt { eye, target } => (eye, target),
            Pose::Fit { direction, .. } => (self.pivot - direction, self.pivot),
        }
    }

    fn axes(&self) -> Axes {
        let (eye, target) = self.eye_and_target();
        let forward = (target - eye).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(self.camera.up).try_normalize();
        let right = right.unwrap_or_else(|| forward.any_orthonormal_vector());
        Axes { right, up: right.cross(forward), forward }
    }

    /// Depth of the pivot, or of the target if the pivot is not in front of the camera.
    fn distance(&self) -> f64 {
        let (eye, target) = self.eye_and_target();
        let ahead = (self.pivot - eye).dot(self.axes().forward);
        if ahead > 0.0 { ahead } else { eye.distance(target) }
    }

    /// Height of the view at the pivot, in the scene's unit.
    fn height(&self) -> f64 {
        match self.camera.projection {
            Projection::Perspective { fov } => 2.0 * self.distance() * tan(fov.to_radians() / 2.0),
            Projection::Orthographic { height } => height.unwrap_or(2.0 * self.size),
        }
    }

    fn place(&mut self, eye: DVec3, forward: DVec3, distance: f64) {
        let least = self.size * DISTANCES.0;
        self.camera.pose = Pose::LookAt { eye, target: eye + forward * distance.max(least) };
    }

    /// Orbits about the pivot by angles in radians: the scene turns to the right, and downward.
    pub(super) fn orbit(&mut self, turn: DVec2) {
        let Axes { right, forward, .. } = self.axes();
        let height = acos(forward.dot(self.vertical).clamp(-1.0, 1.0));
        let tilt = (height + turn.y).clamp(POLE, std::f64::consts::PI - POLE) - height;
        // The limit does not apply if the view already is vertical.
        let tilt = if turn.y == 0.0 { 0.0 } else { tilt };
        let turn = rotation(self.vertical, -turn.x) * rotation(right, -tilt);
        self.turn(turn);
    }

    /// Rolls the camera by an angle in radians: the scene turns counterclockwise.
    pub(super) fn roll(&mut self, angle: f64) {
        let Axes { up, forward, .. } = self.axes();
        self.camera.up = rotation(forward, angle) * up;
    }

    fn turn(&mut self, turn: DQuat) {
        let ((eye, target), Axes { up, forward, .. }) = (self.eye_and_target(), self.axes());
        let level = self.camera.up.normalize_or(up).dot(self.vertical) > 1.0 - 1e-9;
        if !level {
            self.camera.up = turn * up;
        }
        let eye_now = self.pivot + turn * (eye - self.pivot);
        self.place(eye_now, turn * forward, eye.distance(target));
    }

    /// Pans the camera, in units of the image's height: the scene at the depth of the pivot moves to the
    /// right and upward.
    pub(super) fn pan(&mut self, shift: DVec2) {
        let (axes, (eye, target)) = (self.axes(), self.eye_and_target());
        let shift = (axes.right * shift.x + axes.up * shift.y) * self.height();
        self.pivot -= shift;
        self.camera.pose = Pose::LookAt { eye: eye - shift, target: target - shift };
    }

    /// Multiplies the distance to the pivot by a factor. The point at the pointer, at the depth of the pivot,
    /// stays in place; the pointer is in units of the image's height from its center, to the right and
    /// upward.
    pub(super) fn zoom(&mut self, factor: f64, pointer: DVec2) {
        let (axes, distance) = (self.axes(), self.distance());
        let across = (axes.right * pointer.x + axes.up * pointer.y) * self.height();
        let eye = self.eye();
        if let Projection::Orthographic { height } = &mut self.camera.projection {
            let now = height.unwrap_or(2.0 * self.size);
            let range = (self.size * DISTANCES.0, self.size * DISTANCES.1);
            let new = (now * factor).clamp(range.0, range.1);
            *height = Some(new);
            let shift = across * (1.0 - new / now);
            self.pivot += shift;
            return self.place(eye + shift, axes.forward, distance);
        }
        let new = (distance * factor).clamp(self.size * DISTANCES.0, self.size * DISTANCES.1);
        let shift = (axes.forward * distance + across) * (1.0 - new / distance);
        let eye = eye + shift;
        self.pivot = eye + axes.forward * new;
        self.place(eye, axes.forward, new);
    }

    /// Multiplies the field of view by a factor, or the view's height in orthographic projection.
    pub(super) fn scale_field_of_view(&mut self, factor: f64) {
        match &mut self.camera.projection {
            Projection::Perspective { fov } => *fov = (*fov * factor).clamp(FIELDS.0, FIELDS.1),
            Projection::Orthographic { .. } => self.zoom(factor, DVec2::ZERO),
        }
    }

    /// Toggles between perspective and orthographic projection; objects at the pivot keep their size.
    pub(super) fn toggle_projection(&mut self) {
        let (height, Axes { forward, .. }) = (self.height(), self.axes());
        if let Projection::Perspective { fov } = self.camera.projection {
            self.fov = fov;
            self.camera.projection = Projection::Orthographic { height: Some(height) };
            return;
        }
        self.camera.projection = Projection::Perspective { fov: self.fov };
        let distance = height / 2.0 / tan(self.fov.to_radians() / 2.0);
        let target = self.eye() + forward * self.distance();
        self.pivot = target;
        self.place(target - forward * distance, forward, distance);
    }

    /// Sets the pivot.
    pub(super) fn set_pivot(&mut self, point: DVec3) {
        let (eye, Axes { forward, .. }) = (self.eye(), self.axes());
        self.pivot = point;
        let distance = self.distance();
        self.place(eye, forward, distance);
    }

    /// Focuses the lens at the distance of a point; adds a lens if there is none.
    pub(super) fn focus(&mut self, point: DVec3) {
        let depth = (point - self.eye()).dot(self.axes().forward);
        if depth > 0.0 {
            let aperture = self.camera.lens.map_or(0.0, |lens| lens.aperture);
            let aperture = if aperture > 0.0 { aperture } else { APERTURE * depth };
            self.camera.lens = Some(Lens { aperture, focus: Some(depth) });
        }
    }

    /// Multiplies the aperture by a factor.
    pub(super) fn scale_aperture(&mut self, factor: f64) {
        let default = Lens { aperture: APERTURE * self.distance() / factor, focus: None };
        let lens = self.camera.lens.filter(|lens| lens.aperture > 0.0).unwrap_or(default);
        self.camera.lens = Some(Lens { aperture: lens.aperture * factor, ..lens });
    }

    /// Returns the place of a point in the image, in units of its height from its center; `None` if it is not before the eye.
    pub(super) fn place_of(&self, point: DVec3) -> Option<DVec2> {
        let (axes, offset) = (self.axes(), point - self.eye());
        let scale = match self.camera.projection {
            Projection::Perspective { .. } => {
                let ahead = offset.dot(axes.forward);
                if ahead <= 0.0 {
                    return None;
                }
                self.height() / self.distance() * ahead
            }
            Projection::Orthographic { .. } => self.height(),
        };
        Some(DVec2::new(offset.dot(axes.right), offset.dot(axes.up)) / scale)
    }

    /// Returns the outline of a sphere in the image; `None` if the eye is in it, or if it reaches behind the eye.
    pub(super) fn outline(&self, middle: DVec3, radius: f64) -> Option<Outline> {
        let (axes, offset) = (self.axes(), middle - self.eye());
        let across = DVec2::new(offset.dot(axes.right), offset.dot(axes.up));
        let (center, radii) = match self.camera.projection {
            Projection::Perspective { .. } => {
                // A cone about the sphere meets the plane of the image in an ellipse, which is longer away from the center.
                let ahead = offset.dot(axes.forward);
                let square = (ahead - radius) * (ahead + radius);
                if ahead <= radius || square <= 0.0 {
                    return None;
                }
                let scale = self.distance() / self.height();
                let long = radius * (square + across.length_squared()).sqrt() / square;
                (
                    across * (ahead / square) * scale,
                    DVec2::new(long, radius / square.sqrt()) * scale,
                )
            }
            Projection::Orthographic { .. } => {
                let scale = self.height().recip();
                (across * scale, DVec2::splat(radius * scale))
            }
        };
        Some(Outline { center, radii, axis: across.normalize_or(DVec2::X) })
    }

    /// Returns origin and unit direction of the ray through a point of the image, in units of its height from
    /// its center.
    pub(super) fn ray(&self, pointer: DVec2) -> (DVec3, DVec3) {
        let (axes, eye) = (self.axes(), self.eye());
        let across = (axes.right * pointer.x + axes.up * pointer.y) * self.height();
        match self.camera.projection {
            Projection::Perspective { .. } => {
                (eye, (axes.forward * self.distance() + across).normalize())
            }
            Projection::Orthographic { .. } => (eye + across, axes.forward),
        }
    }
}

#[cfg(test)]
mod tests;
