//! The infinite ground plane, tested outside the tree.

use super::Frame;
use super::materials::{MaterialId, Materials};
use crate::scene;
use glam::DVec3;

/// The points `p` with `normal . p = height`, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Unit normal.
    pub normal: DVec3,
    /// Signed distance from the origin.
    pub height: f64,
    /// What it is made of.
    pub material: MaterialId,
}

impl Ground {
    pub(super) fn build(ground: &scene::Ground, frame: &Frame, materials: &Materials) -> Self {
        Self {
            normal: ground.normal,
            height: frame.length(ground.height - ground.normal.dot(frame.shift)),
            material: materials.id(ground.material),
        }
    }
}
