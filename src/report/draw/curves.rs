//! A plane: places to the right, values upward, and what is what at the right edge, beside the data.

use super::legend;
use super::ruler::Ruler;
use super::sheet::{At, EDGE, FAINT, LETTERS, Sheet, Side, WIDTH, color, width};
use crate::drawing::INK;
use crate::report::{Line, Plot, Series, Spread};

/// Pixels of the sheet from top to bottom.
const HEIGHT: f64 = 940.0;
const TOP: f64 = 165.0;
const BOTTOM: f64 = 800.0;
const MARK: f64 = 9.0;
/// Half the length of the ends of error bars.
const CAP: f64 = 7.0;
/// Pixels from entry to entry of the legend.
const ENTRY: f64 = 34.0;

/// The plane, in pixels.
struct Plane {
    place: Ruler,
    value: Ruler,
    left: f64,
    right: f64,
}

impl Plane {
    fn x(&self, place: f64) -> f64 {
        self.left + self.place.place(place) * (self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        BOTTOM + self.value.place(value) * (TOP - BOTTOM)
    }
}

pub(super) fn lay_out(plot: &Plot) -> Sheet {
    let mut sheet = Sheet { height: HEIGHT, shapes: Vec::new() };
    sheet.heading(&plot.title, &plot.about);
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let names = plot.series.iter().map(|series| width(&series.name, LETTERS)).fold(0.0, f64::max);
    let values = points().flat_map(|point| [point.value.least, point.value.greatest]);
    let plane = Plane {
        place: Ruler::new(&plot.place, points().map(|point| point.place)),
        value: Ruler::new(&plot.value, values),
        left: 150.0,
        right: (WIDTH - EDGE - names - 2.0 * legend::SAMPLE - 20.0).max(WIDTH / 2.0),
    };
    axes(&mut sheet, plot, &plane);
    for (index, series) in plot.series.iter().enumerate() {
        draw(&mut sheet, (index, series), &plane);
    }
    explain(&mut sheet, plot, &plane);
    sheet.text(plot.note.as_str(), (EDGE, HEIGHT - 30.0), 18.0, Side::Left);
    sheet
}

fn axes(sheet: &mut Sheet, plot: &Plot, plane: &Plane) {
    for (place, label) in plane.place.ticks() {
        let x = plane.x(place);
        sheet.path([(x, TOP), (x, BOTTOM)], FAINT, 1.0);
        sheet.text(label, (x, BOTTOM + 24.0), LETTERS, Side::Center);
    }
    for (value, label) in plane.value.ticks() {
        let y = plane.y(value);
        sheet.path([(plane.left, y), (plane.right, y)], FAINT, 1.0);
        sheet.text(label, (plane.left - 14.0, y), LETTERS, Side::Right);
    }
    sheet.path([(plane.left, TOP), (plane.left, BOTTOM), (plane.right, BOTTOM)], INK, 2.0);
    let middle = f64::midpoint(plane.left, plane.right);
    sheet.text(plot.place.heading(), (middle, BOTTOM + 60.0), LETTERS, Side::Center);
    sheet.text(plot.value.heading(), (EDGE, TOP - 34.0), LETTERS, Side::Left);
}

fn draw(sheet: &mut Sheet, (index, series): (usize, &Series), plane: &Plane) {
    let number = legend::number(series, index);
    let seen = |point: &&_| is_seen(plane, point);
    let points: Vec<_> = series.points.iter().filter(seen).collect();
    let at: Vec<At> =
        points.iter().map(|point| (plane.x(point.place), plane.y(point.value.median))).collect();
    match series.line {
        Line::Solid if at.len() > 1 => sheet.path(at.clone(), color(number), 3.0),
        Line::Dashed if at.len() > 1 => sheet.dashes(at.clone(), color(number)),
        _ => {}
    }
    for (point, &at) in points.iter().zip(&at) {
        bar(sheet, number, (at.0, point.value), plane);
        if series.marked {
            sheet.mark(number, at, MARK);
        }
    }
}

fn is_seen(plane: &Plane, point: &crate::report::Point) -> bool {
    plane.place.takes(point.place) && plane.value.takes(point.value.median)
}

/// An error bar, where there is an error that can be seen.
fn bar(sheet: &mut Sheet, number: usize, (x, value): (f64, Spread), plane: &Plane) {
    let (low, high) = (plane.y(value.least), plane.y(value.greatest));
    if low - high <= 2.0 {
        return;
    }
    sheet.path([(x, low), (x, high)], color(number), 2.0);
    for y in [low, high] {
        sheet.path([(x - CAP, y), (x + CAP, y)], color(number), 2.0);
    }
}

/// The legend, in the order in which the series end, from top to bottom.
fn explain(sheet: &mut Sheet, plot: &Plot, plane: &Plane) {
    let end = |series: &Series| {
        let last = series.points.iter().rev().find(|point| is_seen(plane, point));
        last.map_or(BOTTOM, |point| plane.y(point.value.median))
    };
    let mut order: Vec<_> = plot.series.iter().enumerate().collect();
    order.sort_by(|a, b| end(a.1).total_cmp(&end(b.1)));
    for (line, entry) in order.into_iter().enumerate() {
        let at = (plane.right + legend::SAMPLE + 10.0, TOP + 10.0 + ENTRY * line as f64);
        legend::entry(sheet, entry, at, MARK);
    }
}
