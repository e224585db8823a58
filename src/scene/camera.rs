//! Who looks at the scene.

use glam::DVec3;

/// Who looks at the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// How directions become pixels.
    pub projection: Projection,
    /// Where it stands.
    pub pose: Pose,
    /// Roughly up in the picture; need not be perpendicular to the view. Where it is parallel to
    /// the view, an axis that is not takes its place.
    pub up: DVec3,
    /// Thin lens; `None` is a pinhole.
    pub lens: Option<Lens>,
    /// Rays start where they cross the plane at this distance along the view axis: 0 or more.
    pub near: f64,
}

/// How directions become pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Central projection.
    Perspective {
        /// Vertical field of view, degrees, more than 0 and less than 180.
        fov: f64,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of the picture in the scene's unit, more than 0; `None`: what frames all spheres.
        height: Option<f64>,
    },
}

/// Where the camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pose {
    /// At `eye`, looking at `target`; the two differ.
    LookAt {
        /// Where rays start.
        eye: DVec3,
        /// What is in the middle of the picture.
        target: DVec3,
    },
    /// As near as all spheres are in the picture.
    Fit {
        /// View direction, from the camera into the scene; not zero.
        direction: DVec3,
        /// Share of the picture left free at its edges, 0..1.
        margin: f64,
    },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Diameter, 0 or more; 0 is a pinhole.
    pub aperture: f64,
    /// Distance of the plane in focus along the view axis, more than 0; `None`: the target's (the
    /// middle of the spheres' bounds under [`Pose::Fit`]).
    pub focus: Option<f64>,
}

impl Camera {
    /// Where a camera looks that frames all spheres, unless something else is said: from the right,
    /// above and in front.
    pub const FIT_DIRECTION: DVec3 = DVec3::new(-0.6, -0.4, -1.0);
    /// What such a camera leaves free at the edges of the picture.
    pub const FIT_MARGIN: f64 = 0.05;
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            projection: Projection::Perspective { fov: 40.0 },
            pose: Pose::Fit { direction: Self::FIT_DIRECTION, margin: Self::FIT_MARGIN },
            up: DVec3::Y,
            lens: None,
            near: 0.0,
        }
    }
}
