//! `[[cone]]`: the heads of arrows.

use super::block::Block;
use super::materials::{self, Materials};
use super::schema;
use super::value::Limits;
use crate::scene::{Cones, FileError, Rgb};

pub(super) fn read(
    root: &Block,
    cones: &mut Cones,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("cone", &schema::CONE)? {
        let apex = block.need("apex", "apex = [x, y, z]")?.point()?;
        let base = block.need("base", "base = [x, y, z]")?;
        let radius = block.need("radius", "radius = a number greater than 0")?;
        let (center, wide) = (base.point()?, radius.number(Limits::Positive)?);
        if apex == center {
            return Err(base.error("the base is at the apex").with_help("move one of them"));
        }
        let color = block.value("color");
        let color = color.map_or(Ok(Rgb::ONE), |value| value.color(Limits::Share))?;
        let material = materials::row(&block, materials)?;
        materials::refuse_lights_and_glass(&block, materials, material, "a cone")?;
        cones.push(apex, center, wide, material, color);
        let ratio = cones.ratio(cones.len() - 1);
        if ratio > Cones::MAX_RATIO {
            let message = format!(
                "of the height and the radius one is {ratio} times the other, but at most {} fit",
                Cones::MAX_RATIO
            );
            return Err(radius.error(message));
        }
    }
    Ok(())
}
