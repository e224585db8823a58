//! `[[slice]]`: half spaces that are cut away.

use super::block::Block;
use super::schema;
use super::value::Limits;
use crate::scene::{FileError, Slice, SliceMode};

pub(super) fn read(root: &Block) -> Result<Vec<Slice>, FileError> {
    root.blocks("slice", &schema::SLICE)?.iter().map(slice).collect()
}

fn slice(block: &Block) -> Result<Slice, FileError> {
    let normal = block.need("normal", "normal = [x, y, z], toward the part that is cut away")?;
    let distance = block.value("distance");
    let name = block.value("mode").map(|value| value.choice(&SliceMode::ALL.map(|mode| mode.0)));
    let name = name.transpose()?.unwrap_or(SliceMode::default().name());
    let mode = SliceMode::ALL.iter().find(|(own, _)| *own == name).map(|(_, mode)| *mode);
    Ok(Slice {
        normal: normal.direction()?,
        distance: distance.map_or(Ok(0.0), |value| value.number(Limits::Any))?,
        mode: mode.unwrap_or_default(),
    })
}
