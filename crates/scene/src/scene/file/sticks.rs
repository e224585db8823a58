//! `[[stick]]`: cylinders with round ends.

use super::block::Block;
use super::materials::{self, Materials};
use crate::scene::keys::{Schema, StickKeys};
use crate::scene::{FileError, Rgb, Sticks};

pub(super) fn read(
    root: &Block,
    sticks: &mut Sticks,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("stick", Schema::of::<StickKeys>())? {
        let StickKeys { ends, radius, color, colors, .. } = block.read()?;
        if colors.is_some() {
            block.forbid("color", "colors", || "it gives the colors of both halves".to_owned())?;
        }
        let material = materials::row(&block, materials)?;
        materials::refuse_lights_and_glass(&block, materials, material, "a stick")?;
        sticks.push(ends, radius, material, colors.unwrap_or([color.unwrap_or(Rgb::ONE); 2]));
    }
    Ok(())
}
