//! `[look]`: background and overlays.

use super::block::Block;
use super::value::{LIGHT, Value};
use crate::scene::particles::Cell;
use crate::scene::{Background, FileError, Look};
use crate::{color, suggest};

pub(super) fn read(block: &Block) -> Result<Look, FileError> {
    let flag = |key| block.value(key).map_or(Ok(false), |value: Value| value.flag());
    let background = block.value("background");
    Ok(Look {
        background: background.map_or(Ok(Background::Sky), |value| read_background(&value))?,
        depth_cue: flag("depth_cue")?,
        outline: flag("outline")?,
        cell: block.value("cell").map(|value| cell(&value)).transpose()?,
    })
}

/// Reads a corner and the three edges from it.
fn cell(value: &Value) -> Result<Cell, FileError> {
    let [origin, a, b, c] = value.list()?;
    let vectors = [a.point()?, b.point()?, c.point()?];
    Ok(Cell { origin: origin.point()?, vectors, periodic: [false; 3] })
}

fn read_background(value: &Value) -> Result<Background, FileError> {
    match value.item.as_str() {
        Some("sky") => Ok(Background::Sky),
        Some("transparent") => Ok(Background::Transparent),
        Some(text) if color::parse(text).is_none() => {
            let error = value.must_be("a color, \"sky\" or \"transparent\"");
            let words = ["sky", "transparent"].into_iter().chain(color::names());
            Err(match suggest::nearest(text, words) {
                Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
                None => error,
            })
        }
        _ => value.color(LIGHT).map(Background::Color),
    }
}
