//! Shapes on a canvas, in pixels from the upper left corner.

use plotters::style::RGBColor;
use spherule_render::drawing;

pub(super) const FAINT: RGBColor = RGBColor(222, 222, 222);

/// Width of the canvas.
pub(super) const WIDTH: f64 = 1500.0;
/// Left margin of titles.
pub(super) const MARGIN: f64 = 40.0;

/// Font sizes.
pub(super) const TITLE: f64 = 32.0;
pub(super) const FONT_SIZE: f64 = 20.0;

/// Colors that color-blind people can distinguish, also on white (Okabe and Ito, "Color Universal
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

pub(super) type Position = (f64, f64);

/// Horizontal alignment of text; vertically it is centered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Center,
    Right,
}

#[derive(Clone, Debug)]
pub(super) enum Shape {
    Path { points: Vec<Position>, color: RGBColor, width: f64, dashed: bool },
    Area { points: Vec<Position>, color: RGBColor },
    Disc { center: Position, radius: f64, color: RGBColor },
    Text { text: String, at: Position, height: f64, side: Align },
}

#[derive(Clone, Debug, Default)]
pub(super) struct Canvas {
    pub(super) height: f64,
    pub(super) shapes: Vec<Shape>,
}

impl Canvas {
    pub(super) fn path(&mut self, points: impl Into<Vec<Position>>, color: RGBColor, width: f64) {
        self.shapes.push(Shape::Path { points: points.into(), color, width, dashed: false });
    }

    pub(super) fn dashes(&mut self, points: Vec<Position>, color: RGBColor) {
        self.shapes.push(Shape::Path { points, color, width: 3.0, dashed: true });
    }

    pub(super) fn text(&mut self, text: impl Into<String>, at: Position, height: f64, side: Align) {
        self.shapes.push(Shape::Text { text: text.into(), at, height, side });
    }

    /// Draws title and subtitle.
    pub(super) fn heading(&mut self, title: &str, about: &str) {
        self.text(title, (MARGIN, 40.0), TITLE, Align::Left);
        self.text(about, (MARGIN, 80.0), FONT_SIZE, Align::Left);
    }

    /// Draws the marker of series `number`.
    pub(super) fn mark(&mut self, number: usize, at: Position, radius: f64) {
        let color = color(number);
        let corners: &[Position] = match number % COLORS.len() {
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

/// Returns the color of series `number`.
pub(super) fn color(number: usize) -> RGBColor {
    COLORS[number % COLORS.len()]
}

/// Returns the width of a text.
pub(super) fn width(text: &str, height: f64) -> f64 {
    // Without a font, drawing fails as well.
    drawing::width(text, height as u32).map_or(0.0, f64::from)
}
