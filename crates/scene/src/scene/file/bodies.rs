//! `[[stick]]`, `[[ellipsoid]]` and `[[cone]]`: bodies beside the spheres, in this order.

use super::block::Block;
use super::materials::{self, Materials};
use crate::scene::keys::{ConeKeys, EllipsoidKeys, Schema, StickKeys};
use crate::scene::{FileError, Rgb, Scene};

pub(super) fn read(
    root: &Block,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks(Schema::of::<StickKeys>())? {
        let StickKeys { ends, radius, color, colors, .. } = block.read()?;
        let material = materials::solid_row(&block, materials, "a stick")?;
        let colors = colors.unwrap_or([color.unwrap_or(Rgb::ONE); 2]);
        scene.sticks.push(ends, radius, material, colors);
    }
    for block in root.blocks(Schema::of::<EllipsoidKeys>())? {
        let EllipsoidKeys { center, semi_axes, orientation, color, .. } = block.read()?;
        let material = materials::solid_row(&block, materials, "an ellipsoid")?;
        scene.ellipsoids.push(center, semi_axes.into(), orientation, material, color);
    }
    for block in root.blocks(Schema::of::<ConeKeys>())? {
        let ConeKeys { apex, base, radius, color, .. } = block.read()?;
        let material = materials::solid_row(&block, materials, "a cone")?;
        scene.cones.push(apex, base, radius, material, color);
    }
    Ok(())
}
