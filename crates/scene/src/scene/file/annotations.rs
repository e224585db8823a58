//! `[color_bar]`, `[legend]`, `[axes]`, `[scale_bar]`, `[[label]]` and `[lettering]`: annotations of the
//! picture.

use super::block::Block;
use super::schema;
use super::value::{LIGHT, Limits, Value};
use crate::color::{Map, Range, Rgb, Scale, Spacing};
use crate::scene::{
    Anchor, Annotations, AxisTripod, ColorBar, ColorLegend, FileError, Label, Lettering, ScaleBar,
};
use toml::de::DeValue;

/// Limits of the color of a legend's entry.
const COLOR: Limits = Limits::Within(0.0, 1.0);

/// Reads the annotations of a scene.
pub(super) fn read(root: &Block) -> Result<Annotations, FileError> {
    let color_bar = root.block("color_bar", &schema::COLOR_BAR)?;
    let legend = root.block("legend", &schema::LEGEND)?;
    let axes = root.block("axes", &schema::AXES)?;
    let scale_bar = root.block("scale_bar", &schema::SCALE_BAR)?;
    let labels = root.blocks("label", &schema::LABEL)?;
    let lettering = root.block("lettering", &schema::LETTERING)?;
    Ok(Annotations {
        color_bar: color_bar.map(|block| read_color_bar(&block)).transpose()?,
        legend: legend.map(|block| read_legend(&block)).transpose()?,
        axes: axes.map(|block| read_axes(&block)).transpose()?,
        scale_bar: scale_bar.map(|block| read_scale_bar(&block)).transpose()?,
        labels: labels.iter().map(read_label).collect::<Result<_, _>>()?,
        lettering: lettering.map_or(Ok(Lettering::default()), |block| read_lettering(&block))?,
    })
}

fn read_color_bar(block: &Block) -> Result<ColorBar, FileError> {
    let flag = |key| block.value(key).map_or(Ok(false), |value: Value| value.flag());
    let map = block.value("map").map(|value| value.choice(&Map::ALL.map(Map::name)));
    let map = map.transpose()?.and_then(Map::named).unwrap_or_default();
    let ends = block.need("range", "range = [low, high]: the numbers at the ends of the map")?;
    let spacing = if flag("log")? { Spacing::Logarithmic } else { Spacing::Linear };
    let [low, high] = ends.numbers(Limits::Any)?;
    let range = Range::new(low, high, spacing).map_err(|error| ends.error(error.to_string()))?;
    let scale = Scale { reversed: flag("reversed")?, ..Scale::new(map, range) };
    let position = position(block, Anchor::BottomRight)?;
    Ok(ColorBar { scale, label: text(block, "label")?, position })
}

fn read_legend(block: &Block) -> Result<ColorLegend, FileError> {
    let help = "entries = [[\"name\", color], ...]: a name and a color for each line";
    let value = block.need("entries", help)?;
    let DeValue::Array(items) = value.item else {
        return Err(value.must_be("a list of names and colors, as in [[\"C\", \"gray\"]]"));
    };
    let entry = |item: &toml::Spanned<DeValue>| {
        let entry = Value { span: item.span(), item: item.get_ref(), ..value.clone() };
        read_entry(&entry)
    };
    let omitted = block.value("omitted").map_or(Ok(0), |value| value.whole(0, u64::from(u32::MAX)));
    Ok(ColorLegend {
        label: text(block, "label")?,
        entries: items.iter().map(entry).collect::<Result<_, _>>()?,
        omitted: omitted?,
        position: position(block, Anchor::TopRight)?,
    })
}

/// Reads a name and a color.
fn read_entry(entry: &Value) -> Result<(Rgb, String), FileError> {
    if entry.item.as_array().is_none_or(|parts| parts.len() != 2) {
        return Err(entry.must_be("a name and a color, as in [\"C\", \"gray\"]"));
    }
    let [name, color] = entry.list()?;
    Ok((color.color(COLOR)?, name.text()?.to_owned()))
}

fn read_axes(block: &Block) -> Result<AxisTripod, FileError> {
    let AxisTripod { mut directions, mut names, position: corner } = AxisTripod::default();
    if let Some(value) = block.value("directions") {
        let vectors: [Value; 3] = value.list()?;
        for (direction, vector) in directions.iter_mut().zip(&vectors) {
            *direction = vector.vector()?;
        }
    }
    if let Some(value) = block.value("names") {
        let texts: [Value; 3] = value.list()?;
        for (name, text) in names.iter_mut().zip(&texts) {
            text.text()?.clone_into(name);
        }
    }
    Ok(AxisTripod { directions, names, position: position(block, corner)? })
}

fn read_scale_bar(block: &Block) -> Result<ScaleBar, FileError> {
    let length = block.value("length").map(|value| value.number(Limits::Positive));
    let position = position(block, Anchor::BottomRight)?;
    Ok(ScaleBar { length: length.transpose()?, unit: text(block, "unit")?, position })
}

fn read_label(block: &Block) -> Result<Label, FileError> {
    let value = block.need("text", "text = \"the label\"")?;
    Ok(Label { text: value.text()?.to_owned(), position: position(block, Anchor::TopLeft)? })
}

fn read_lettering(block: &Block) -> Result<Lettering, FileError> {
    let (low, high) = (*Lettering::SIZES.start(), *Lettering::SIZES.end());
    let size = block.value("size").map(|value| value.number(Limits::Within(low, high)));
    let color = block.value("color").map(|value| value.color(LIGHT));
    let size = size.transpose()?.unwrap_or(Lettering::default().size);
    Ok(Lettering { size, color: color.transpose()? })
}

fn text(block: &Block, key: &'static str) -> Result<String, FileError> {
    Ok(block.value(key).map_or(Ok(""), |value| value.text())?.to_owned())
}

fn position(block: &Block, default: Anchor) -> Result<Anchor, FileError> {
    let name = block.value("position").map(|value| value.choice(&Anchor::ALL.map(|row| row.0)));
    Ok(name.transpose()?.and_then(Anchor::named).unwrap_or(default))
}
