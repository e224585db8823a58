//! `[color_bar]`: a color bar in the picture.

use super::block::Block;
use super::value::{Limits, Value};
use crate::color::{Map, Range, Scale, Spacing};
use crate::scene::{ColorBar, Corner, FileError};

pub(super) fn read(block: &Block) -> Result<ColorBar, FileError> {
    let flag = |key| block.value(key).map_or(Ok(false), |value: Value| value.flag());
    let map = block.value("map").map(|value| value.choice(&Map::ALL.map(Map::name)));
    let map = map.transpose()?.and_then(Map::named).unwrap_or_default();
    let ends = block.need("range", "range = [low, high]: the numbers at the ends of the map")?;
    let spacing = if flag("log")? { Spacing::Logarithmic } else { Spacing::Linear };
    let [low, high] = ends.numbers(Limits::Any)?;
    let range = Range::new(low, high, spacing).map_err(|error| ends.error(error.to_string()))?;
    let corner = block.value("corner").map(|value| value.choice(&Corner::ALL.map(|row| row.0)));
    let corner = corner.transpose()?.and_then(Corner::named).unwrap_or_default();
    let label = block.value("label").map_or(Ok(""), |value| value.text())?;
    let scale = Scale { reversed: flag("reversed")?, ..Scale::new(map, range) };
    Ok(ColorBar { scale, label: label.to_owned(), corner })
}
