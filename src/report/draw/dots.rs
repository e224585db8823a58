//! A line for each name, and marks on it where the values are: many values in little room, each of
//! them easy to find.

use super::legend;
use super::ruler::Ruler;
use super::sheet::{EDGE, FAINT, LETTERS, Sheet, Side, WIDTH, color, width};
use crate::report::{Plot, Point, Series};

/// Pixels from line to line, at least.
const LINE: f64 = 36.0;
/// Pixels from series to series where error bars keep apart.
const STEP: f64 = 13.0;
/// Pixels to the left of the lines at most.
const NAMES: f64 = 420.0;
/// Pixels from marks that are zero to a logarithmic axis.
const APART: f64 = 150.0;

/// Where everything is, in pixels.
struct Frame {
    top: f64,
    bottom: f64,
    /// Where lines begin and end.
    sides: [f64; 2],
    /// Where the axis begins and ends.
    axis: [f64; 2],
    /// From line to line.
    line: f64,
    /// From series to series of a line.
    step: f64,
}

pub(super) fn lay_out(plot: &Plot, names: &[String]) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.heading(&plot.title, &plot.about);
    let (places, lines) = legend::rows(&plot.series, EDGE + 16.0, 122.0);
    for (i, (series, at)) in plot.series.iter().zip(places).enumerate() {
        legend::entry(&mut sheet, (i, series), at, size(i, plot));
    }
    let top = 150.0 + 34.0 * lines as f64;
    let longest = names.iter().map(|name| width(name, LETTERS)).fold(0.0, f64::max);
    let left = (EDGE + longest + 30.0).min(NAMES);
    let apart = if plot.value.zero.is_some() { APART } else { 20.0 };
    let step = if has_bars(plot) { STEP } else { 0.0 };
    let line = LINE.max(step * (plot.series.len() + 1) as f64);
    let frame = Frame {
        line,
        step,
        top,
        bottom: top + line * names.len() as f64,
        sides: [left, WIDTH - 60.0],
        axis: [left + apart, WIDTH - 100.0],
    };
    let values = plot.series.iter().flat_map(|series| &series.points).flat_map(ends);
    let ruler = Ruler::new(&plot.value, values);
    axis(&mut sheet, plot, &ruler, &frame);
    for (line, name) in names.iter().enumerate() {
        row(&mut sheet, (line, name), plot, (&ruler, &frame));
    }
    sheet.height = frame.bottom + if plot.note.is_empty() { 90.0 } else { 130.0 };
    if !plot.note.is_empty() {
        sheet.text(plot.note.as_str(), (EDGE, frame.bottom + 100.0), 18.0, Side::Left);
    }
    sheet
}

/// Whether there are error bars, which would hide each other on one line.
fn has_bars(plot: &Plot) -> bool {
    let varies = |point: &Point| point.value.greatest > point.value.least;
    plot.series.iter().any(|series| series.points.iter().any(varies))
}

fn ends(point: &Point) -> [f64; 2] {
    [point.value.least, point.value.greatest]
}

/// Where many values may be zero, marks have different sizes, so that none hides another.
fn size(index: usize, plot: &Plot) -> f64 {
    match plot.series.len() {
        0..=4 if plot.value.zero.is_some() => [16.0, 13.0, 9.0, 7.0][index % 4],
        _ => 9.0,
    }
}

impl Frame {
    fn x(&self, ruler: &Ruler, value: f64) -> f64 {
        let [left, right] = self.axis;
        if ruler.takes(value) { left + ruler.place(value) * (right - left) } else { self.zero() }
    }

    /// Where marks are that the axis has no place for.
    fn zero(&self) -> f64 {
        self.sides[0] + 30.0
    }
}

/// Lines and numbers of the axis, above and below.
fn axis(sheet: &mut Sheet, plot: &Plot, ruler: &Ruler, frame: &Frame) {
    let zero = plot.value.zero.as_ref().map(|name| (frame.zero(), name.clone()));
    let ticks = ruler.ticks().into_iter().map(|(value, label)| (frame.x(ruler, value), label));
    for (x, label) in zero.into_iter().chain(ticks) {
        sheet.path([(x, frame.top), (x, frame.bottom)], FAINT, 2.0);
        sheet.text(label.as_str(), (x, frame.top - 20.0), LETTERS, Side::Center);
        sheet.text(label, (x, frame.bottom + 24.0), LETTERS, Side::Center);
    }
    let middle = f64::midpoint(frame.axis[0], frame.axis[1]);
    sheet.text(plot.value.heading(), (middle, frame.bottom + 58.0), LETTERS, Side::Center);
}

fn row(
    sheet: &mut Sheet,
    (line, name): (usize, &str),
    plot: &Plot,
    (ruler, frame): (&Ruler, &Frame),
) {
    let y = frame.top + frame.line * (line as f64 + 0.5);
    if frame.step > 0.0 && line > 0 {
        let above = y - frame.line / 2.0;
        sheet.path([(frame.sides[0], above), (frame.sides[1], above)], FAINT, 1.0);
    }
    sheet.text(name, (frame.sides[0] - 20.0, y), LETTERS, Side::Right);
    if frame.step == 0.0 {
        sheet.path([(frame.sides[0], y), (frame.sides[1], y)], FAINT, 1.0);
    }
    let middle = (plot.series.len() as f64 - 1.0) / 2.0;
    let y = |index: usize| y + frame.step * (index as f64 - middle);
    let shown = |value: f64| value.is_finite() && (ruler.takes(value) || plot.value.zero.is_some());
    let here = |(index, series): (usize, &Series)| {
        let points = series.points.iter().filter(|point| point.place == line as f64);
        let points = points.map(|point| point.value).filter(|value| shown(value.median));
        points.map(|value| (index, legend::number(series, index), value)).collect::<Vec<_>>()
    };
    let marks: Vec<_> = plot.series.iter().enumerate().flat_map(here).collect();
    for &(index, number, value) in &marks {
        let y = y(index);
        let [low, high] = [value.least, value.greatest].map(|value| frame.x(ruler, value));
        if high - low > 1.0 {
            sheet.path([(low, y), (high, y)], color(number), 3.0);
        }
    }
    for &(index, number, value) in &marks {
        sheet.mark(number, (frame.x(ruler, value.median), y(index)), size(index, plot));
    }
}
