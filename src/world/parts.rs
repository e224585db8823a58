//! The parts of a world that take time to find: the spheres in the order of their tree.

use super::appearance::Appearance;
use super::fit::{self, Placement};
use super::spheres::WorldSpheres;
use super::{CameraVisible, Cut, Frame, Materials, World, WorldError, check, cut};
use crate::bvh::Bvh;
use crate::bvh::builders::{Builder, build};
use crate::scene::{self, Pose, Projection, Scene};
use crate::spheres::Spheres;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Spheres in the order of their tree, and where they and the camera are.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) frame: Frame,
    pub(crate) placement: Placement,
    pub(crate) spheres: Spheres,
    pub(crate) bvh: Bvh,
    pub(crate) appearance: Appearance,
    pub(crate) camera_visible: Option<CameraVisible>,
    pub(crate) left_out: LeftOut,
}

/// Number of spheres of a scene that are not in its world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct LeftOut {
    /// Slices leave nothing of them.
    pub(crate) cut_away: u64,
    /// They vanish in single precision beside the largest coordinate.
    pub(crate) vanished: u64,
    /// They coincide with an earlier one, in a crowd about one center.
    pub(crate) hidden: u64,
}

impl Parts {
    /// Places the spheres, and sorts them into a tree.
    pub(super) fn build(
        scene: &Scene,
        from: Cow<scene::Spheres>,
        (frame, placement): &(Frame, Placement),
        builder: Builder,
    ) -> Result<Self, WorldError> {
        let given = from.len();
        let materials = Materials::build(&scene.materials);
        let WorldSpheres { mut spheres, looks, shown, hidden } =
            WorldSpheres::build(from, &scene.slices, frame);
        let placed = spheres.len();
        let bvh = build(&mut spheres, builder);
        let appearance = Appearance::build(looks, &spheres.id, &materials);
        cut::refuse_glass(&Cut::build(&scene.slices, frame), &spheres, &appearance)?;
        let camera_visible = CameraVisible::build(&hidden, &spheres, builder);
        let left_out = LeftOut {
            cut_away: (given - shown) as u64,
            vanished: (shown - placed) as u64,
            hidden: (placed - spheres.len()) as u64,
        };
        let (frame, placement) = (*frame, *placement);
        Ok(Self { frame, placement, spheres, bvh, appearance, camera_visible, left_out })
    }

    /// Checks the scene, and places the camera for its picture, if that has another size than `from`, in
    /// pixels. False where that takes the spheres in the user's coordinates, which are gone: a camera that
    /// frames them depends on the picture's aspect, and the frame of coordinates on a parallel camera's
    /// picture.
    pub(crate) fn place(&mut self, scene: &Scene, from: [u32; 2]) -> Result<bool, WorldError> {
        check::check(scene)?;
        check::memory_of_sky(scene)?;
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

    /// Whether spheres and camera are somewhere.
    pub(crate) fn is_finite(&self) -> bool {
        let Placement { eye, axes, half_height, half_width, distance, reach } = self.placement;
        let vectors = [eye, axes.right, axes.up, axes.forward];
        let lengths = [half_height, half_width, distance, reach];
        vectors.iter().all(|vector| vector.is_finite())
            && lengths.iter().all(|length| length.is_finite())
            && self.frame.is_finite()
    }
}

impl World {
    /// Spheres of its scene that are not in it.
    pub(crate) fn left_out(&self) -> LeftOut {
        let features = &self.features;
        LeftOut {
            cut_away: features.cut_away,
            vanished: features.vanished,
            hidden: features.hidden,
        }
    }
}
