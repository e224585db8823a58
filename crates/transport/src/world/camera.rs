//! Generation of camera rays from points of the picture and of the lens.

use super::Transform;
use super::fit::Placement;
use crate::bvh::Beam;
use crate::elementary::hypot;
use crate::lanes::Doubles;
use crate::scene::{Projection, Scene};
use crate::vec3::Vec3;
use glam::{DVec2, DVec3};

/// A camera in world space.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Origin of rays, without `near` and the lens.
    pub eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Half the picture's size: tangents in perspective, lengths in parallel projection.
    half_width: f64,
    half_height: f64,
    orthographic: bool,
    lens_radius: f64,
    focus: f64,
    near: f64,
    /// Distance of the target along the view axis.
    target: f64,
}

/// The numbers of a camera's rays, for devices: see [`Camera`].
#[derive(Clone, Copy, Debug)]
pub struct CameraTerms {
    /// Origin of rays, and the axes to the right, upward and into the scene.
    pub frame: [DVec3; 4],
    /// Width and height in pixels, and half of each as tangents or lengths.
    pub size: [[f64; 2]; 2],
    /// True in parallel projection.
    pub orthographic: bool,
    /// Radius of the lens, 0 without one.
    pub lens_radius: f64,
    /// Distance of the plane in focus.
    pub focus: f64,
    /// Distance of the plane on which rays start.
    pub near: f64,
}

impl Camera {
    /// Returns the numbers of the rays.
    pub fn terms(&self) -> CameraTerms {
        CameraTerms {
            frame: [self.eye, self.right, self.up, self.forward],
            size: [[self.width.into(), self.height.into()], [self.half_width, self.half_height]],
            orthographic: self.orthographic,
            lens_radius: self.lens_radius,
            focus: self.focus,
            near: self.near,
        }
    }

    pub(super) fn build(scene: &Scene, at: &Placement, transform: &Transform) -> Self {
        let orthographic = matches!(scene.camera.projection, Projection::Orthographic { .. });
        let size = if orthographic { transform.scale } else { 1.0 };
        let focus = scene.camera.lens.and_then(|lens| lens.focus).unwrap_or(at.distance);
        Self {
            width: scene.settings.width,
            height: scene.settings.height,
            eye: transform.point(at.eye),
            right: at.axes.right,
            up: at.axes.up,
            forward: at.axes.forward,
            half_width: at.half_width * size,
            half_height: at.half_height * size,
            orthographic,
            lens_radius: scene
                .camera
                .lens
                .map_or(0.0, |lens| transform.length(lens.aperture / 2.0)),
            focus: transform.length(focus),
            near: transform.length(scene.camera.near),
            target: transform.length(at.distance),
        }
    }

    /// Returns whether rays start on a lens: otherwise the lens's two dimensions are not sampled.
    pub fn has_lens(&self) -> bool {
        self.lens_radius > 0.0
    }

    /// Returns whether rays are parallel, except for the lens.
    pub fn is_orthographic(&self) -> bool {
        self.orthographic
    }

    /// Returns the unit axes of the picture: to the right, upward, and into the scene.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.right, self.up, self.forward]
    }

    /// Returns the length of a pixel's edge at the distance of the target, in the world's unit. The target
    /// of a fitted camera is the middle of the spheres' bounds along the view axis.
    pub fn pixel_at_target(&self) -> f64 {
        let depth = if self.orthographic { 1.0 } else { self.target };
        2.0 * self.half_height * depth / f64::from(self.height)
    }

    /// Returns the distance of a point from the camera, in the world's unit: from the eye in
    /// perspective, from the plane through the eye perpendicular to the view in parallel projection.
    /// The lens and `near` do not matter.
    pub fn distance(&self, point: DVec3) -> f64 {
        let offset = point - self.eye;
        if self.orthographic { offset.dot(self.forward) } else { offset.length() }
    }

    /// Returns a point's coordinates in the camera's axes, in the world's unit: to the right of the
    /// view axis, above it, and along it.
    pub fn view(&self, point: DVec3) -> DVec3 {
        let offset = point - self.eye;
        DVec3::new(offset.dot(self.right), offset.dot(self.up), offset.dot(self.forward))
    }

    /// Projects a point through the middle of the lens to pixels from the top left corner, perhaps
    /// outside of the picture. `seen` is the result of [`Camera::view`]; in perspective it is in front
    /// of the eye (`seen.z > 0`).
    pub fn pixel(&self, seen: DVec3) -> DVec2 {
        let depth = if self.orthographic { 1.0 } else { seen.z };
        let across = seen.x / (depth * self.half_width);
        let upward = seen.y / (depth * self.half_height);
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        DVec2::new(1.0 + across, 1.0 - upward) / 2.0 * size
    }

    /// Returns the place in the picture, in pixels from the top left corner, of a ray in perspective from a
    /// point of the lens, in a direction before it, and the area of the picture per steradian there.
    pub fn place(&self, origin: DVec3, direction: DVec3) -> (DVec2, f64) {
        let along = direction.dot(self.forward);
        let offset = direction / along;
        let shift = if self.has_lens() { (origin - self.eye) / self.focus } else { DVec3::ZERO };
        let seen = self.view(self.eye + offset + shift);
        let area = f64::from(self.width) * f64::from(self.height)
            / (4.0 * self.half_width * self.half_height);
        (self.pixel(DVec3::new(seen.x, seen.y, 1.0)), area / along.powi(3))
    }

    /// Returns how far a point at this depth along the view axis deviates in the picture, in pixels, as seen
    /// from the edge of the lens instead of its middle.
    pub fn blur(&self, depth: f64) -> f64 {
        let slope = self.lens_radius * (1.0 / self.focus - 1.0 / depth).abs();
        let tangent = if self.orthographic { slope * depth } else { slope };
        tangent / self.half_height * f64::from(self.height) / 2.0
    }

    /// Estimates how many pixels of a rectangle of the picture, from `low` to `high` in pixels from its
    /// top left corner, a sphere of the world covers if nothing hides it: 0 if no ray through the
    /// rectangle hits the sphere, infinity if the camera is inside of it or very near.
    pub fn coverage(&self, (center, radius): (DVec3, f64), low: DVec2, high: DVec2) -> f64 {
        let across = |x: f64| (2.0 * x / f64::from(self.width) - 1.0) * self.half_width;
        let upward = |y: f64| (1.0 - 2.0 * y / f64::from(self.height)) * self.half_height;
        let seen = self.view(center);
        let blur = if self.has_lens() {
            self.lens_radius * (1.0 + seen.z.max(0.0) / self.focus)
        } else {
            0.0
        };
        let reach = radius + blur;
        let inside = |inward: f64, edge: f64| {
            if self.orthographic {
                inward - edge >= -reach
            } else {
                inward - edge * seen.z >= -reach * hypot(edge, 1.0)
            }
        };
        let in_view = seen.z + reach > self.near
            && inside(seen.x, across(low.x))
            && inside(-seen.x, -across(high.x))
            && inside(-seen.y, -upward(low.y))
            && inside(seen.y, upward(high.y));
        if !in_view {
            return 0.0;
        }
        let depth = if self.orthographic { 1.0 } else { seen.z };
        if !self.orthographic && depth <= radius {
            return f64::INFINITY;
        }
        let pixels = radius / (depth * self.half_height) * f64::from(self.height) / 2.0;
        std::f64::consts::PI * pixels * pixels
    }

    /// Returns the distance along the view axis of the plane on which rays start.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// Returns the center and radius of a sphere that contains every ray's origin.
    pub fn origins(&self) -> (DVec3, f64) {
        let (across, along) = if self.orthographic {
            (hypot(self.half_width, self.half_height), self.near)
        } else {
            let slant = (1.0 + self.half_width.powi(2) + self.half_height.powi(2)).sqrt();
            (0.0, self.near * slant)
        };
        (self.eye, across + along + self.lens_radius)
    }

    /// Returns a region that contains all rays through a rectangle of the picture, from `low` to `high`
    /// in pixels from its top left corner.
    ///
    /// The region lies between planes through the rectangle's edges and beyond the rays' origins. At a
    /// distance `d` along the view axis from the plane in focus, a ray of a lens deviates from the ray
    /// through the lens's middle by at most the lens's radius times `d`, in units of the focal
    /// distance: each plane is turned and moved accordingly.
    pub fn beam(&self, low: DVec2, high: DVec2) -> Beam {
        let across = |x: f64| (2.0 * x / f64::from(self.width) - 1.0) * self.half_width;
        let upward = |y: f64| (1.0 - 2.0 * y / f64::from(self.height)) * self.half_height;
        let (right, up, forward) = (self.right, self.up, self.forward);
        let turn = if self.has_lens() { self.lens_radius / self.focus } else { 0.0 };
        let side = |inward: DVec3, edge: f64| {
            let (normal, start) = if self.orthographic {
                (inward, edge)
            } else {
                let normal = inward - forward * edge;
                (normal / normal.length(), 0.0)
            };
            let normal = normal + forward * turn;
            (normal, normal.dot(self.eye) + start - self.lens_radius)
        };
        let planes = [
            side(right, across(low.x)),
            side(-right, -across(high.x)),
            side(up, upward(high.y)),
            side(-up, -upward(low.y)),
            (forward, forward.dot(self.eye) + self.near),
        ];
        let (center, radius) = self.origins();
        Beam::new(planes, center.length() + radius)
    }

    /// Returns origins and unit directions of the rays through points of the picture, in pixels from
    /// its top left corner, and points of the unit disk, which are mapped to the lens.
    ///
    /// A lens refracts the rays of a picture point so that they meet where the ray through its middle
    /// crosses the plane in focus, in parallel projection too.
    #[inline(always)]
    pub fn rays<D: Doubles>(&self, [x, y]: [D; 2], lens: Option<[D; 2]>) -> (Vec3<D>, Vec3<D>) {
        let (all, every) = (D::splat, |v: DVec3| Vec3::from(v).map(D::splat));
        let (one, two) = (all(1.0), all(2.0));
        let across = (two * x / all(self.width.into()) - one) * all(self.half_width);
        let upward = (one - two * y / all(self.height.into())) * all(self.half_height);
        let (right, up) = (every(self.right), every(self.up));
        let offset = right * across + up * upward;
        // The direction has length 1 along the view axis.
        let (mut origin, mut direction) = if self.orthographic {
            (every(self.eye) + offset, every(self.forward))
        } else {
            (every(self.eye), every(self.forward) + offset)
        };
        if let Some([u, v]) = lens {
            let radius = all(self.lens_radius);
            let shift = right * (u * radius) + up * (v * radius);
            origin = origin + shift;
            direction = direction - shift.map(|coordinate| coordinate / all(self.focus));
        }
        origin = origin + direction * all(self.near);
        (origin, direction * (one / direction.dot_unfused(direction).sqrt()))
    }
}

#[cfg(test)]
mod tests;
