//! The parts of a world that are expensive to build: the spheres in the order of their tree.

use super::appearance::Appearance;
use super::fit::{self, Placement};
use super::spheres::WorldSpheres;
use super::{CameraVisible, Cut, Materials, Transform, WorldError, check, cut};
use crate::bvh::Bvh;
use crate::bvh::builders::{Builder, build};
use crate::scene::{self, Pose, Projection, Scene};
use crate::spheres::Spheres;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Spheres in the order of their tree, with coordinates and camera.
#[derive(Clone, Debug)]
pub struct Parts {
    /// From the scene's coordinates to those of the tree.
    pub transform: Transform,
    /// The camera, in the scene's coordinates.
    pub placement: Placement,
    /// The spheres, in the order of the tree.
    pub spheres: Spheres,
    /// The tree.
    pub bvh: Bvh,
    /// Colors and materials of the spheres.
    pub appearance: Appearance,
    /// The spheres that the camera sees, if slices hide some.
    pub camera_visible: Option<CameraVisible>,
    /// The spheres that are not in the tree.
    pub omitted: OmittedSpheres,
}

/// Numbers of spheres of a scene that are not in its world, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OmittedSpheres {
    /// Slices remove them completely.
    pub(crate) cut_away: u64,
    /// They vanish in single precision relative to the largest coordinate.
    pub(crate) vanished: u64,
    /// They coincide with an earlier one, among many about one center.
    pub(crate) hidden: u64,
}

impl Parts {
    /// Transforms the spheres and builds their tree.
    pub(super) fn build(
        scene: &Scene,
        from: Cow<scene::Spheres>,
        transform: Transform,
        placement: Placement,
        builder: Builder,
    ) -> Result<Self, WorldError> {
        let given = from.len();
        let materials = Materials::build(&scene.materials);
        let WorldSpheres { mut spheres, appearance, shown, hidden } =
            WorldSpheres::build(from, &scene.slices, &transform);
        let placed = spheres.len();
        let bvh = build(&mut spheres, builder);
        let appearance = Appearance::build(appearance, &spheres.id, &materials);
        cut::refuse_glass(&Cut::build(&scene.slices, &transform), &spheres, &appearance)?;
        let camera_visible = CameraVisible::build(&hidden, &spheres, builder);
        let omitted = OmittedSpheres {
            cut_away: (given - shown) as u64,
            vanished: (shown - placed) as u64,
            hidden: (placed - spheres.len()) as u64,
        };
        Ok(Self { transform, placement, spheres, bvh, appearance, camera_visible, omitted })
    }

    /// Checks the scene, and places the camera for its picture if this has another aspect than `from`,
    /// in pixels. Returns false if this needs the spheres in the user's coordinates, which no longer
    /// exist: a fitted camera depends on the picture's aspect, and the coordinate transform on a
    /// parallel camera's picture.
    ///
    /// # Errors
    /// The scene is out of range, or its camera cannot be placed.
    pub fn place(&mut self, scene: &Scene, from: [u32; 2]) -> Result<bool, WorldError> {
        check::check(scene)?;
        check::check_environment_memory(scene)?;
        let aspect = |[width, height]: [u32; 2]| f64::from(width) / f64::from(height);
        if aspect([scene.settings.width, scene.settings.height]) == aspect(from) {
            return Ok(true);
        }
        let free = matches!(scene.camera.pose, Pose::LookAt { .. })
            && matches!(scene.camera.projection, Projection::Perspective { .. });
        if free {
            self.placement = fit::pose(scene)?;
        }
        Ok(free)
    }

    /// Returns whether spheres and camera have finite coordinates.
    pub fn is_finite(&self) -> bool {
        let Placement { eye, axes, half_height, half_width, distance, reach } = self.placement;
        let vectors = [eye, axes.right, axes.up, axes.forward];
        let lengths = [half_height, half_width, distance, reach];
        vectors.iter().all(|vector| vector.is_finite())
            && lengths.iter().all(|length| length.is_finite())
            && self.transform.is_finite()
    }
}
