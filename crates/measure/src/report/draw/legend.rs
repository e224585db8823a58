//! Entries of the legend.

use super::canvas::{Align, Canvas, FONT_SIZE, Position, WIDTH, color, width};
use crate::report::{Line, Series};

/// Distance in pixels from the sample of a line or marker to its name.
pub(super) const SAMPLE: f64 = 30.0;

/// Returns the index of a series' color and marker.
pub(super) fn number(series: &Series, index: usize) -> usize {
    series.color.unwrap_or(index)
}

/// Draws an entry: a sample centered at `at`, and the name to its right.
pub(super) fn entry(canvas: &mut Canvas, index: usize, series: &Series, at: Position, radius: f64) {
    let number = number(series, index);
    let ends = [(at.0 - 16.0, at.1), (at.0 + 16.0, at.1)];
    match series.line {
        Line::None => {}
        Line::Solid => canvas.path(&ends, color(number), 3.0),
        Line::Dashed => canvas.dashes(&ends, color(number)),
    }
    if series.marked {
        canvas.mark(number, at, radius);
    }
    canvas.text(series.name.as_str(), (at.0 + SAMPLE, at.1), FONT_SIZE, Align::Start);
}

/// Arranges entries in lines between `left` and the right edge, from `top` down. Returns their
/// positions and the number of lines.
pub(super) fn rows(series: &[Series], left: f64, top: f64) -> (Vec<Position>, usize) {
    const LINE: f64 = 34.0;
    let (mut x, mut line) = (left, 0);
    let mut places = Vec::new();
    for series in series {
        let room = SAMPLE + width(&series.name) + 50.0;
        if x > left && x + room > WIDTH {
            (x, line) = (left, line + 1);
        }
        places.push((x, top + LINE * line as f64));
        x += room;
    }
    (places, line + 1)
}
