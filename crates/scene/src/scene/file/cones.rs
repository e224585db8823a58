//! `[[cone]]`: the heads of arrows.

use super::block::Block;
use super::materials::{self, Materials};
use crate::scene::keys::{ConeKeys, Schema};
use crate::scene::{Cones, FileError};

pub(super) fn read(
    root: &Block,
    cones: &mut Cones,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("cone", Schema::of::<ConeKeys>())? {
        let ConeKeys { apex, base, radius, color, .. } = block.read()?;
        if apex == base {
            let error = block.error_at("base", "the base is at the apex");
            return Err(error.with_help("move one of them"));
        }
        let material = materials::row(&block, materials)?;
        materials::refuse_lights_and_glass(&block, materials, material, "a cone")?;
        cones.push(apex, base, radius, material, color);
        let ratio = cones.ratio(cones.len() - 1);
        if ratio > Cones::MAX_RATIO {
            let message = format!(
                "of the height and the radius one is {ratio} times the other, but at most {} fit",
                Cones::MAX_RATIO
            );
            return Err(block.error_at("radius", &message));
        }
    }
    Ok(())
}
