//! Dot plots: a row for each name, with markers at the values.

use super::canvas::{Align, Canvas, FONT_SIZE, MARGIN, NOTE_SIZE, WIDTH, color, faint, width};
use super::legend;
use super::scale::AxisScale;
use crate::report::{Plot, Point, Series};

/// Minimum distance of rows in pixels.
const LINE: f64 = 36.0;
/// Distance of series within a row in pixels, if there are error bars.
const STEP: f64 = 13.0;
/// Maximum width of the names in pixels.
const NAMES: f64 = 420.0;
/// Distance in pixels of the markers of zero from a logarithmic axis.
const ZERO_GAP: f64 = 150.0;

/// The layout, in pixels.
struct Layout {
    top: f64,
    bottom: f64,
    /// Left and right end of the rows.
    sides: [f64; 2],
    /// Left and right end of the axis.
    axis: [f64; 2],
    /// Distance of rows.
    line: f64,
    /// Distance of series within a row.
    step: f64,
}

pub(super) fn layout(plot: &Plot, names: &[String]) -> Canvas {
    let mut canvas = Canvas::default();
    canvas.heading(&plot.title, &plot.about);
    let (places, lines) = legend::rows(&plot.series, MARGIN + 16.0, 122.0);
    for (i, (series, at)) in plot.series.iter().zip(places).enumerate() {
        legend::entry(&mut canvas, i, series, at, size(i, plot));
    }
    let top = 150.0 + 34.0 * lines as f64;
    let longest = names.iter().map(|name| width(name)).fold(0.0, f64::max);
    let left = (MARGIN + longest + 30.0).min(NAMES);
    let gap = if plot.value.zero.is_some() { ZERO_GAP } else { 20.0 };
    let step = if has_bars(plot) { STEP } else { 0.0 };
    let line = LINE.max(step * (plot.series.len() + 1) as f64);
    let layout = Layout {
        line,
        step,
        top,
        bottom: top + line * names.len() as f64,
        sides: [left, WIDTH - 60.0],
        axis: [left + gap, WIDTH - 100.0],
    };
    let values = plot.series.iter().flat_map(|series| &series.points).flat_map(ends);
    let scale = AxisScale::new(&plot.value, values);
    axis(&mut canvas, plot, &scale, &layout);
    for (line, name) in names.iter().enumerate() {
        row(&mut canvas, line, name, plot, &scale, &layout);
    }
    canvas.height = layout.bottom + if plot.note.is_empty() { 90.0 } else { 130.0 };
    if !plot.note.is_empty() {
        canvas.text(plot.note.as_str(), (MARGIN, layout.bottom + 100.0), NOTE_SIZE, Align::Start);
    }
    canvas
}

/// Returns whether there are error bars, which would hide each other on one line.
fn has_bars(plot: &Plot) -> bool {
    let varies = |point: &Point| point.value.greatest > point.value.least;
    plot.series.iter().any(|series| series.points.iter().any(varies))
}

fn ends(point: &Point) -> [f64; 2] {
    [point.value.least, point.value.greatest]
}

/// Returns the size of a marker. Where many values may be zero, sizes differ so that none hides another.
fn size(index: usize, plot: &Plot) -> f64 {
    match plot.series.len() {
        0..=4 if plot.value.zero.is_some() => [16.0, 13.0, 9.0, 7.0][index % 4],
        _ => 9.0,
    }
}

impl Layout {
    fn x(&self, scale: &AxisScale, value: f64) -> f64 {
        let [left, right] = self.axis;
        if scale.contains(value) {
            left + scale.fraction(value) * (right - left)
        } else {
            self.zero()
        }
    }

    /// Returns the position of values that are not on the axis.
    fn zero(&self) -> f64 {
        self.sides[0] + 30.0
    }
}

/// Draws the grid lines and labels of the axis, above and below.
fn axis(canvas: &mut Canvas, plot: &Plot, scale: &AxisScale, layout: &Layout) {
    let zero = plot.value.zero.as_ref().map(|name| (layout.zero(), name.clone()));
    let ticks = scale.ticks().into_iter().map(|(value, label)| (layout.x(scale, value), label));
    for (x, label) in zero.into_iter().chain(ticks) {
        canvas.path(&[(x, layout.top), (x, layout.bottom)], faint(), 2.0);
        canvas.text(label.as_str(), (x, layout.top - 20.0), FONT_SIZE, Align::Middle);
        canvas.text(label, (x, layout.bottom + 24.0), FONT_SIZE, Align::Middle);
    }
    let middle = f64::midpoint(layout.axis[0], layout.axis[1]);
    canvas.text(plot.value.heading(), (middle, layout.bottom + 58.0), FONT_SIZE, Align::Middle);
}

fn row(
    canvas: &mut Canvas,
    line: usize,
    name: &str,
    plot: &Plot,
    scale: &AxisScale,
    layout: &Layout,
) {
    let y = layout.top + layout.line * (line as f64 + 0.5);
    if layout.step > 0.0 && line > 0 {
        let above = y - layout.line / 2.0;
        canvas.path(&[(layout.sides[0], above), (layout.sides[1], above)], faint(), 1.0);
    }
    canvas.text(name, (layout.sides[0] - 20.0, y), FONT_SIZE, Align::End);
    if layout.step == 0.0 {
        canvas.path(&[(layout.sides[0], y), (layout.sides[1], y)], faint(), 1.0);
    }
    let middle = (plot.series.len() as f64 - 1.0) / 2.0;
    let y = |index: usize| y + layout.step * (index as f64 - middle);
    let shown =
        |value: f64| value.is_finite() && (scale.contains(value) || plot.value.zero.is_some());
    let here = |(index, series): (usize, &Series)| {
        let points = series.points.iter().filter(|point| point.place == line as f64);
        let points = points.map(|point| point.value).filter(|value| shown(value.median));
        points.map(|value| (index, legend::number(series, index), value)).collect::<Vec<_>>()
    };
    let marks: Vec<_> = plot.series.iter().enumerate().flat_map(here).collect();
    for &(index, number, value) in &marks {
        let y = y(index);
        let [low, high] = [value.least, value.greatest].map(|value| layout.x(scale, value));
        if high - low > 1.0 {
            canvas.path(&[(low, y), (high, y)], color(number), 3.0);
        }
    }
    for &(index, number, value) in &marks {
        canvas.mark(number, (layout.x(scale, value.median), y(index)), size(index, plot));
    }
}
