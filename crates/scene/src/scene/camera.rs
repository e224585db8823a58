//! Cameras: projection, pose and lens.

use super::Axis;
use crate::elementary::{atan, tan};
use glam::DVec3;
use std::ops::RangeInclusive;

/// A camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Map from directions to pixels.
    pub projection: Projection,
    /// Position and view direction.
    pub pose: Pose,
    /// Approximate up direction in the picture; need not be perpendicular to the view. If it is
    /// parallel to the view, a coordinate axis that is not parallel replaces it.
    pub up: DVec3,
    /// Thin lens; `None` is a pinhole.
    pub lens: Option<Lens>,
    /// Rays start where they cross the plane at this distance along the view axis: 0 or more.
    pub near: f64,
    /// Parts of the picture that a fitted camera leaves free, besides its margin.
    pub insets: Insets,
    /// Magnification about the middle of the picture, or of what a fitted camera frames; 1 is none.
    pub zoom: f64,
    /// The sphere that a fitted camera frames, instead of all bodies.
    pub framed: Option<FramedSphere>,
}

/// A sphere that a camera frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramedSphere {
    /// Its center.
    pub center: DVec3,
    /// Its radius, more than 0.
    pub radius: f64,
}

/// Fractions of a picture at its edges: of the width at the left and the right, of the height at the
/// bottom and the top; 0 or more, with less than 1 in each direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Insets {
    /// At the left edge.
    pub left: f64,
    /// At the right edge.
    pub right: f64,
    /// At the bottom edge.
    pub bottom: f64,
    /// At the top edge.
    pub top: f64,
}

/// Map from directions to pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Central projection.
    Perspective {
        /// Vertical field of view, degrees, more than 0 and less than 180.
        fov: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of the picture in the scene's unit, more than 0; `None` frames all spheres.
        height: Option<f64>,
    },
}

/// Position and view direction of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pose {
    /// At `eye`, toward `target`; the two differ.
    LookAt {
        /// Origin of rays.
        eye: DVec3,
        /// The point in the middle of the picture.
        target: DVec3,
    },
    /// As near as possible with all spheres in the picture.
    Fit {
        /// View direction, from the camera into the scene; not zero.
        direction: DVec3,
        /// Fraction of the picture left free at its edges, 0..1.
        margin: f64,
    },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Diameter, 0 or more; 0 is a pinhole.
    pub aperture: f64,
    /// Distance of the plane in focus along the view axis, more than 0; `None` is the distance of the
    /// target (under [`Pose::Fit`], of the middle of the spheres' bounds).
    pub focus: Option<f64>,
}

impl FramedSphere {
    /// Returns the sphere about the middle of the bounds of spheres, each a center and a radius, that contains all of them;
    /// `None` without any.
    pub fn around<I: Iterator<Item = (DVec3, f64)>>(spheres: impl Fn() -> I) -> Option<Self> {
        let low = spheres().fold(DVec3::INFINITY, |low, (center, radius)| low.min(center - radius));
        let high =
            spheres().fold(DVec3::NEG_INFINITY, |high, (center, radius)| high.max(center + radius));
        let center = (low + high) / 2.0;
        let reach = spheres().map(|(own, radius)| own.distance(center) + radius);
        let radius = reach.fold(0.0, f64::max);
        (radius > 0.0).then_some(Self { center, radius })
    }
}

impl Insets {
    /// Returns the left, the right, the bottom and the top inset.
    pub fn to_array(self) -> [f64; 4] {
        [self.left, self.right, self.bottom, self.top]
    }
}

impl Camera {
    /// Default view direction of a camera that frames all spheres: from the right, above and in front.
    pub const FIT_DIRECTION: DVec3 = DVec3::new(-0.6, -0.4, -1.0);
    /// Default margin of such a camera.
    pub const FIT_MARGIN: f64 = 0.05;
    /// Vertical field of view of [`Camera::LONG_LENS`], degrees.
    pub const LONG_FOV: f64 = 20.0;
    /// Default projection for particle files: distant objects are hardly smaller than near ones.
    pub const LONG_LENS: Projection = Projection::Perspective { fov: Self::LONG_FOV };

    /// Range of [`Camera::zoom`].
    pub const ZOOMS: RangeInclusive<f64> = 0.01..=1000.0;

    /// Replaces the zoom by a narrower field of view, or a lower height of a parallel projection that has one.
    pub fn fold_zoom(&mut self) {
        if self.zoom == 1.0 {
            return;
        }
        match &mut self.projection {
            Projection::Perspective { fov } => {
                *fov = 2.0 * atan(tan(fov.to_radians() / 2.0) / self.zoom).to_degrees();
            }
            Projection::Orthographic { height: Some(height) } => *height /= self.zoom,
            Projection::Orthographic { height: None } => return,
        }
        self.zoom = 1.0;
    }

    /// Returns the default view direction with this direction up: [`Camera::FIT_DIRECTION`] if it is y.
    pub fn fit_direction(up: Axis) -> DVec3 {
        let ([right, toward], DVec3 { x, y, z }) = (up.front(), Self::FIT_DIRECTION);
        right * x + up.vector() * y + toward * z
    }
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            projection: Projection::Perspective { fov: 40.0 },
            pose: Pose::Fit { direction: Self::FIT_DIRECTION, margin: Self::FIT_MARGIN },
            up: DVec3::Y,
            lens: None,
            near: 0.0,
            insets: Insets::default(),
            zoom: 1.0,
            framed: None,
        }
    }
}
