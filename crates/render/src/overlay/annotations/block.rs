//! Blocks: drawings of single annotations.

use super::Viewpoint;
use crate::color::{Range, Rgb, Spacing, ticks};
use crate::elementary::{log10, power_of_ten};
use crate::graphics::{Align, CAP_HEIGHT, Drawing, Text, marked_width, text_width};
use crate::scene::{Anchor, ColorLegend, Label, ScaleBar};
use glam::DVec2;

/// Maximum length of a scale bar of automatic length, as a fraction of the image's width.
const BAR_SHARE: f64 = 0.25;

/// Distance of the baselines of two lines, in ems.
const LINE: f64 = 1.45;

/// A drawing with its size in pixels: nothing extends beyond it.
#[derive(Clone, Debug)]
pub struct Block {
    /// The drawing, from the top left corner of the block.
    pub drawing: Drawing,
    /// Width and height.
    pub size: DVec2,
}

/// Returns the block of a label.
pub(super) fn label(label: &Label, size: f64, color: Rgb) -> Block {
    let lines: Vec<&str> = label.text.lines().collect();
    let widths = lines.iter().map(|line| text_width(line, size));
    let width = widths.fold(0.0, f64::max);
    let (align, x) = alignment(label.position, width);
    let mut drawing = Drawing::default();
    let mut baseline = CAP_HEIGHT * size;
    let count = lines.len().max(1) as f64;
    for line in lines {
        let position = DVec2::new(x, baseline);
        drawing.text(Text { text: line.to_owned(), position, align, size, color });
        baseline += LINE * size;
    }
    Block { drawing, size: DVec2::new(width, ((count - 1.0) * LINE + CAP_HEIGHT) * size) }
}

/// Returns the alignment of text at an anchor, and its position in a block of this width.
fn alignment(anchor: Anchor, width: f64) -> (Align, f64) {
    match anchor.across() {
        0.0 => (Align::Start, 0.0),
        1.0 => (Align::End, width),
        _ => (Align::Middle, width / 2.0),
    }
}

/// Returns the block of a legend, whose label may have subscripts and superscripts.
pub(super) fn legend(legend: &ColorLegend, size: f64, ink: Rgb) -> Block {
    let (radius, indent) = (0.42 * size, 1.35 * size);
    let mut drawing = Drawing::default();
    let mut baseline = CAP_HEIGHT * size;
    let mut width: f64 = 0.0;
    let mut add = |text: &str, color: Option<Rgb>| {
        let x = if color.is_some() { indent } else { 0.0 };
        if let Some(color) = color {
            let center = DVec2::new(radius, baseline - CAP_HEIGHT * size / 2.0);
            drawing.disc(center, radius + (size / 20.0).max(0.5), ink);
            drawing.disc(center, radius, color);
        }
        let (position, align) = (DVec2::new(x, baseline), Align::Start);
        let line = Text { text: text.to_owned(), position, align, size, color: ink };
        // Names are those of the file, in which `_` is itself.
        if color.is_some() {
            width = width.max(x + text_width(text, size));
            drawing.text(line);
        } else {
            width = width.max(x + marked_width(text, size));
            drawing.marked_text(&line);
        }
        baseline += LINE * size;
    };
    if !legend.label.is_empty() {
        add(&legend.label, None);
    }
    for (color, name) in &legend.entries {
        add(name, Some(*color));
    }
    if legend.omitted > 0 {
        add(&format!("+ {} more", legend.omitted), None);
    }
    Block { drawing, size: DVec2::new(width, baseline - LINE * size) }
}

/// Returns the block of a scale bar in an image of this width.
pub(super) fn scale_bar(
    bar: &ScaleBar,
    view: &Viewpoint,
    width: f64,
    size: f64,
    color: Rgb,
) -> Block {
    let most = BAR_SHARE * width;
    let (long, text) = match view.pixel.filter(|pixel| *pixel > 0.0 && pixel.is_finite()) {
        Some(pixel) => {
            let length = bar.length.unwrap_or_else(|| round_length(most * pixel));
            (length / pixel, with_unit(length, &bar.unit))
        }
        // As long as it may become.
        None => (most, with_unit(bar.length.unwrap_or(5000.0), &bar.unit)),
    };
    let (letters, thick) = (text_width(&text, size), (0.2 * size).round().max(1.0));
    let width = long.max(letters);
    let (top, left) = (((CAP_HEIGHT + 0.45) * size).ceil(), (width - long) / 2.0);
    let mut drawing = Drawing::default();
    let position = DVec2::new(width / 2.0, CAP_HEIGHT * size);
    drawing.text(Text { text, position, align: Align::Middle, size, color });
    drawing.rectangle(DVec2::new(left, top), DVec2::new(left + long, top + thick), color);
    Block { drawing, size: DVec2::new(width, top + thick) }
}

/// Returns the largest 1, 2 or 5 times a power of ten that is at most this length.
fn round_length(most: f64) -> f64 {
    let exponent = log10(most).floor() as i32;
    let power = |exponent: i32| {
        let power = power_of_ten(exponent.unsigned_abs());
        if exponent < 0 { power.recip() } else { power }
    };
    let powers = [exponent - 1, exponent, exponent + 1].map(power);
    let lengths = powers.into_iter().flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * power));
    // The logarithm and the power may be rounded.
    lengths.filter(|length| *length <= most * (1.0 + 1e-9)).fold(0.0, f64::max)
}

fn with_unit(length: f64, unit: &str) -> String {
    let range = Range::new(length, length, Spacing::Linear);
    let number = range.ok().and_then(|range| ticks(&range, 1).pop());
    let number = number.map_or_else(|| length.to_string(), |tick| tick.label);
    if unit.is_empty() { number } else { format!("{number}\u{a0}{unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_as_long_as_possible() {
        for (most, expected) in [
            (1.0, 1.0),
            (1.99, 1.0),
            (2.0, 2.0),
            (49.0, 20.0),
            (50.0, 50.0),
            (0.099, 0.05),
            (1e-7, 1e-7),
            (999.0, 500.0),
        ] {
            let found = round_length(most);
            assert!((found / expected - 1.0).abs() < 1e-12, "{most}: {found}");
        }
    }

    #[test]
    fn lengths_have_their_unit() {
        assert_eq!(with_unit(50.0, "\u{c5}"), "50\u{a0}\u{c5}");
        assert_eq!(with_unit(0.2, ""), "0.2");
    }
}
