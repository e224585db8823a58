//! The infinite ground plane, tested outside the tree.

use super::Transform;
use crate::scene;
use crate::shade::{MaterialId, Materials};
use glam::DVec3;

/// The points `p` with `normal . p = height`, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Unit normal.
    pub normal: DVec3,
    /// Signed distance from the origin.
    pub height: f64,
    /// Material of the ground.
    pub material: MaterialId,
}

impl Ground {
    pub(super) fn build(
        ground: &scene::Ground,
        transform: &Transform,
        materials: &Materials,
    ) -> Self {
        Self {
            normal: ground.normal,
            height: transform.length(ground.height - ground.normal.dot(transform.shift)),
            material: materials.id(ground.material),
        }
    }
}
