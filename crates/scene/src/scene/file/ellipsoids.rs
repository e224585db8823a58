//! `[[ellipsoid]]`.

use super::block::Block;
use super::materials::{self, Materials};
use crate::scene::keys::{EllipsoidKeys, Schema};
use crate::scene::{Ellipsoids, FileError};
use glam::DVec3;

pub(super) fn read(
    root: &Block,
    ellipsoids: &mut Ellipsoids,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("ellipsoid", Schema::of::<EllipsoidKeys>())? {
        let EllipsoidKeys { center, semi_axes, orientation, color, .. } = block.read()?;
        let semi_axes = DVec3::from(semi_axes);
        let ratio = semi_axes.max_element() / semi_axes.min_element();
        if ratio > Ellipsoids::MAX_RATIO {
            let message = format!(
                "the longest semi-axis is {ratio} times the shortest, but at most {} fit",
                Ellipsoids::MAX_RATIO
            );
            return Err(block.error_at("semi_axes", &message));
        }
        let material = materials::row(&block, materials)?;
        materials::refuse_lights_and_glass(&block, materials, material, "an ellipsoid")?;
        ellipsoids.push(center, semi_axes, orientation, material, color);
    }
    Ok(())
}
