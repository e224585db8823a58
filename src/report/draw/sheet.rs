//! Shapes on a sheet, in pixels from the upper left corner.

use crate::drawing;
use plotters::style::RGBColor;

pub(super) const FAINT: RGBColor = RGBColor(222, 222, 222);

/// Pixels across.
pub(super) const WIDTH: f64 = 1500.0;
/// Pixels from the left edge to titles.
pub(super) const EDGE: f64 = 40.0;

/// Heights of letters.
pub(super) const TITLE: f64 = 32.0;
pub(super) const LETTERS: f64 = 20.0;

/// Colors that the color-blind can tell apart, and on white (Okabe and Ito, "Color Universal
/// Design", 2008).
const COLORS: [RGBColor; 8] = [
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(140, 140, 140),
];

pub(super) type At = (f64, f64);

/// Where a text stands beside its place; it is always in the middle of its height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Center,
    Right,
}

#[derive(Clone, Debug)]
pub(super) enum Shape {
    Path { points: Vec<At>, color: RGBColor, width: f64, dashed: bool },
    Area { points: Vec<At>, color: RGBColor },
    Disc { center: At, radius: f64, color: RGBColor },
    Text { text: String, at: At, height: f64, side: Side },
}

#[derive(Clone, Debug, Default)]
pub(super) struct Sheet {
    pub(super) height: f64,
    pub(super) shapes: Vec<Shape>,
}

impl Sheet {
    pub(super) fn path(&mut self, points: impl Into<Vec<At>>, color: RGBColor, width: f64) {
        self.shapes.push(Shape::Path { points: points.into(), color, width, dashed: false });
    }

    pub(super) fn dashes(&mut self, points: Vec<At>, color: RGBColor) {
        self.shapes.push(Shape::Path { points, color, width: 3.0, dashed: true });
    }

    pub(super) fn text(&mut self, text: impl Into<String>, at: At, height: f64, side: Side) {
        self.shapes.push(Shape::Text { text: text.into(), at, height, side });
    }

    /// Title and subtitle.
    pub(super) fn heading(&mut self, title: &str, about: &str) {
        self.text(title, (EDGE, 40.0), TITLE, Side::Left);
        self.text(about, (EDGE, 80.0), LETTERS, Side::Left);
    }

    /// The mark of series `number`.
    pub(super) fn mark(&mut self, number: usize, at: At, radius: f64) {
        let color = color(number);
        let corners: &[At] = match number % COLORS.len() {
            0 => {
                self.shapes.push(Shape::Disc { center: at, radius, color });
                return;
            }
            1 => &[(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)],
            2 => &[(-1.15, 0.0), (0.0, -1.15), (1.15, 0.0), (0.0, 1.15)],
            3 => &[(-1.0, 0.8), (1.0, 0.8), (0.0, -1.0)],
            4 => &[(-1.0, -0.8), (1.0, -0.8), (0.0, 1.0)],
            5 => &[(-0.6, -1.1), (0.6, -1.1), (0.6, 1.1), (-0.6, 1.1)],
            6 => &[(-1.1, -0.5), (1.1, -0.5), (1.1, 0.5), (-1.1, 0.5)],
            _ => &[(-0.5, -1.0), (0.5, -1.0), (1.0, 0.0), (0.5, 1.0), (-0.5, 1.0), (-1.0, 0.0)],
        };
        let points = corners.iter().map(|(x, y)| (at.0 + radius * x, at.1 + radius * y)).collect();
        self.shapes.push(Shape::Area { points, color });
    }
}

/// The color of series `number`.
pub(super) fn color(number: usize) -> RGBColor {
    COLORS[number % COLORS.len()]
}

/// How wide a text is.
pub(super) fn width(text: &str, height: f64) -> f64 {
    // Without the font there is no picture either.
    drawing::width(text, height as u32).map_or(0.0, f64::from)
}
