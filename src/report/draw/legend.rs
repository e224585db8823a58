//! What the marks and lines mean.

use super::sheet::{At, LETTERS, Sheet, Side, WIDTH, color, width};
use crate::report::{Line, Series};

/// Pixels from the sample of a line or mark to its name.
pub(super) const SAMPLE: f64 = 30.0;

/// The number of a series' color and mark.
pub(super) fn number(series: &Series, index: usize) -> usize {
    series.color.unwrap_or(index)
}

/// One entry: a sample whose middle is at `at`, and the name to its right.
pub(super) fn entry(sheet: &mut Sheet, (index, series): (usize, &Series), at: At, radius: f64) {
    let number = number(series, index);
    let ends = vec![(at.0 - 16.0, at.1), (at.0 + 16.0, at.1)];
    match series.line {
        Line::None => {}
        Line::Solid => sheet.path(ends, color(number), 3.0),
        Line::Dashed => sheet.dashes(ends, color(number)),
    }
    if series.marked {
        sheet.mark(number, at, radius);
    }
    sheet.text(series.name.as_str(), (at.0 + SAMPLE, at.1), LETTERS, Side::Left);
}

/// Where the entries of rows stand, one after another between `left` and the right edge, from the
/// line `top` on; and how many lines they take.
pub(super) fn rows(series: &[Series], left: f64, top: f64) -> (Vec<At>, usize) {
    const LINE: f64 = 34.0;
    let (mut x, mut line) = (left, 0);
    let mut places = Vec::new();
    for series in series {
        let room = SAMPLE + width(&series.name, LETTERS) + 50.0;
        if x > left && x + room > WIDTH {
            (x, line) = (left, line + 1);
        }
        places.push((x, top + LINE * line as f64));
        x += room;
    }
    (places, line + 1)
}
