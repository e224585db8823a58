//! `[[stick]]`: cylinders with round ends.

use super::block::Block;
use super::materials::{self, Materials};
use super::schema;
use super::value::Limits;
use crate::scene::{FileError, Rgb, Sticks};

pub(super) fn read(
    root: &Block,
    sticks: &mut Sticks,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("stick", &schema::STICK)? {
        let from = block.need("from", "from = [x, y, z]")?.point()?;
        let to = block.need("to", "to = [x, y, z]")?.point()?;
        let radius = block.need("radius", "radius = a number greater than 0")?;
        let radius = radius.number(Limits::Positive)?;
        let colors = colors(&block)?;
        let material = materials::row(&block, materials)?;
        materials::refuse_lights_and_glass(&block, materials, material, "a stick")?;
        sticks.push([from, to], radius, material, colors);
    }
    Ok(())
}

/// Reads the colors of both halves.
fn colors(block: &Block) -> Result<[Rgb; 2], FileError> {
    let Some(value) = block.value("colors") else {
        let color = block.value("color");
        return Ok([color.map_or(Ok(Rgb::ONE), |value| value.color(Limits::Share))?; 2]);
    };
    block.forbid("color", "colors", || "it gives the colors of both halves".to_owned())?;
    value.two_colors(Limits::Share)
}
