//! X-y plots, with the legend at the right edge.

use super::canvas::{
    Align, Canvas, FONT_SIZE, MARGIN, NOTE_SIZE, Position, WIDTH, color, faint, ink, width,
};
use super::legend;
use super::scale::AxisScale;
use crate::report::{Line, Plot, Series, Spread};

// Positions and lengths in pixels.
/// Height of the canvas.
const HEIGHT: f64 = 940.0;
const TOP: f64 = 165.0;
const BOTTOM: f64 = 800.0;
const MARK: f64 = 9.0;
/// Half the length of the ends of error bars.
const CAP: f64 = 7.0;
/// Distance of entries in the legend.
const ENTRY: f64 = 34.0;

/// The axes, and the horizontal extent of the plane in pixels.
struct Plane {
    place: AxisScale,
    value: AxisScale,
    left: f64,
    right: f64,
}

impl Plane {
    fn x(&self, place: f64) -> f64 {
        self.left + self.place.fraction(place) * (self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        BOTTOM + self.value.fraction(value) * (TOP - BOTTOM)
    }
}

pub(super) fn layout(plot: &Plot) -> Canvas {
    let mut canvas = Canvas { height: HEIGHT, ..Canvas::default() };
    canvas.heading(&plot.title, &plot.about);
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let names = plot.series.iter().map(|series| width(&series.name)).fold(0.0, f64::max);
    let values = points().flat_map(|point| [point.value.least, point.value.greatest]);
    let plane = Plane {
        place: AxisScale::new(&plot.place, points().map(|point| point.place)),
        value: AxisScale::new(&plot.value, values),
        left: 150.0,
        right: (WIDTH - MARGIN - names - 2.0 * legend::SAMPLE - 20.0).max(WIDTH / 2.0),
    };
    axes(&mut canvas, plot, &plane);
    for (index, series) in plot.series.iter().enumerate() {
        draw(&mut canvas, index, series, &plane);
    }
    legend_entries(&mut canvas, plot, &plane);
    canvas.text(plot.note.as_str(), (MARGIN, HEIGHT - 30.0), NOTE_SIZE, Align::Start);
    canvas
}

fn axes(canvas: &mut Canvas, plot: &Plot, plane: &Plane) {
    for (place, label) in plane.place.ticks() {
        let x = plane.x(place);
        canvas.path(&[(x, TOP), (x, BOTTOM)], faint(), 1.0);
        canvas.text(label, (x, BOTTOM + 24.0), FONT_SIZE, Align::Middle);
    }
    for (value, label) in plane.value.ticks() {
        let y = plane.y(value);
        canvas.path(&[(plane.left, y), (plane.right, y)], faint(), 1.0);
        canvas.text(label, (plane.left - 14.0, y), FONT_SIZE, Align::End);
    }
    canvas.path(&[(plane.left, TOP), (plane.left, BOTTOM), (plane.right, BOTTOM)], ink(), 2.0);
    let middle = f64::midpoint(plane.left, plane.right);
    canvas.text(plot.place.heading(), (middle, BOTTOM + 60.0), FONT_SIZE, Align::Middle);
    canvas.text(plot.value.heading(), (MARGIN, TOP - 34.0), FONT_SIZE, Align::Start);
}

fn draw(canvas: &mut Canvas, index: usize, series: &Series, plane: &Plane) {
    let number = legend::number(series, index);
    let visible = |point: &&_| is_visible(plane, point);
    let points: Vec<_> = series.points.iter().filter(visible).collect();
    let at: Vec<Position> =
        points.iter().map(|point| (plane.x(point.place), plane.y(point.value.median))).collect();
    match series.line {
        Line::Solid if at.len() > 1 => canvas.path(&at, color(number), 3.0),
        Line::Dashed if at.len() > 1 => canvas.dashes(&at, color(number)),
        _ => {}
    }
    for (point, &at) in points.iter().zip(&at) {
        bar(canvas, number, at.0, point.value, plane);
        if series.marked {
            canvas.mark(number, at, MARK);
        }
    }
}

fn is_visible(plane: &Plane, point: &crate::report::Point) -> bool {
    plane.place.contains(point.place) && plane.value.contains(point.value.median)
}

/// Draws an error bar if it is long enough to be visible.
fn bar(canvas: &mut Canvas, number: usize, x: f64, value: Spread, plane: &Plane) {
    let (low, high) = (plane.y(value.least), plane.y(value.greatest));
    if low - high <= 2.0 {
        return;
    }
    canvas.path(&[(x, low), (x, high)], color(number), 2.0);
    for y in [low, high] {
        canvas.path(&[(x - CAP, y), (x + CAP, y)], color(number), 2.0);
    }
}

/// Draws the legend, sorted by the last values of the series from top to bottom.
fn legend_entries(canvas: &mut Canvas, plot: &Plot, plane: &Plane) {
    let end = |series: &Series| {
        let last = series.points.iter().rev().find(|point| is_visible(plane, point));
        last.map_or(BOTTOM, |point| plane.y(point.value.median))
    };
    let mut order: Vec<_> = plot.series.iter().enumerate().collect();
    order.sort_by(|a, b| end(a.1).total_cmp(&end(b.1)));
    for (line, (index, series)) in order.into_iter().enumerate() {
        let at = (plane.right + legend::SAMPLE + 10.0, TOP + 10.0 + ENTRY * line as f64);
        legend::entry(canvas, index, series, at, MARK);
    }
}
