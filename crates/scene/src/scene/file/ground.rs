//! `[ground]`.

use super::block::Block;
use super::materials::{Materials, row_but};
use crate::scene::keys::{GroundKeys, Schema};
use crate::scene::{FileError, Ground};

/// Reads `[ground]`, if it exists.
pub(super) fn read(root: &Block, materials: &mut Materials) -> Result<Option<Ground>, FileError> {
    let Some(block) = root.block(Schema::of::<GroundKeys>())? else { return Ok(None) };
    let GroundKeys { mut ground, .. } = block.read()?;
    let refused = ["a dielectric", "an emitter", "translucent"];
    ground.material = row_but(&block, materials, &refused, ["the ground", "a sphere"])?;
    Ok(Some(ground))
}
