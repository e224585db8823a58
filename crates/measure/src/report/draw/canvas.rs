//! Shapes on a canvas, in pixels from the upper left corner.

use glam::DVec2;
use spherule_render::color::{Rgb, srgb};
pub(super) use spherule_render::graphics::Align;
use spherule_render::graphics::{CAP_HEIGHT, Drawing, Text, text_width};

/// Width of the canvas.
pub(super) const WIDTH: f64 = 1500.0;
/// Left margin of titles.
pub(super) const MARGIN: f64 = 40.0;

/// Font sizes.
pub(super) const TITLE: f64 = 27.0;
pub(super) const FONT_SIZE: f64 = 17.0;
pub(super) const NOTE_SIZE: f64 = 15.0;

/// Length of a dash, and the distance of two from start to start.
const DASH: f64 = 10.0;
const PERIOD: f64 = 17.0;

/// Colors that color-blind people can distinguish, also on white (Okabe and Ito, "Color Universal
/// Design", 2008).
const COLORS: [u32; 8] =
    [0xD5_5E00, 0x00_72B2, 0x00_9E73, 0xCC_79A7, 0xE6_9F00, 0x56_B4E9, 0x00_0000, 0x8C_8C8C];

pub(super) type Position = (f64, f64);

/// A drawing with its height.
#[derive(Clone, Debug, Default)]
pub(super) struct Canvas {
    pub(super) height: f64,
    pub(super) drawing: Drawing,
}

impl Canvas {
    pub(super) fn path(&mut self, points: &[Position], color: Rgb, width: f64) {
        let points: Vec<DVec2> = points.iter().map(|point| DVec2::from(*point)).collect();
        self.drawing.path(&points, width, color);
    }

    pub(super) fn dashes(&mut self, points: &[Position], color: Rgb) {
        let mut before = 0.0;
        for ends in points.windows(2) {
            let [from, to] = [ends[0], ends[1]].map(DVec2::from);
            let length = from.distance(to);
            let periods =
                (before / PERIOD).floor() as u32..((before + length) / PERIOD).ceil() as u32;
            for start in periods.map(|period| f64::from(period) * PERIOD - before) {
                let dash = [start, start + DASH].map(|at| from.move_towards(to, at.max(0.0)));
                self.drawing.line(dash, 3.0, color);
            }
            before += length;
        }
    }

    /// Draws a line of text whose capital letters are centered vertically.
    pub(super) fn text(&mut self, text: impl Into<String>, at: Position, size: f64, align: Align) {
        let position = DVec2::from(at) + DVec2::Y * (CAP_HEIGHT * size / 2.0);
        self.drawing.text(Text { text: text.into(), position, align, size, color: ink() });
    }

    /// Draws title and subtitle.
    pub(super) fn heading(&mut self, title: &str, about: &str) {
        self.text(title, (MARGIN, 40.0), TITLE, Align::Start);
        self.text(about, (MARGIN, 80.0), FONT_SIZE, Align::Start);
    }

    /// Draws the marker of series `number`.
    pub(super) fn mark(&mut self, number: usize, at: Position, radius: f64) {
        let color = color(number);
        let corners: &[Position] = match number % COLORS.len() {
            0 => return self.drawing.disc(at.into(), radius, color),
            1 => &[(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)],
            2 => &[(-1.15, 0.0), (0.0, -1.15), (1.15, 0.0), (0.0, 1.15)],
            3 => &[(-1.0, 0.8), (1.0, 0.8), (0.0, -1.0)],
            4 => &[(-1.0, -0.8), (1.0, -0.8), (0.0, 1.0)],
            5 => &[(-0.6, -1.1), (0.6, -1.1), (0.6, 1.1), (-0.6, 1.1)],
            6 => &[(-1.1, -0.5), (1.1, -0.5), (1.1, 0.5), (-1.1, 0.5)],
            _ => &[(-0.5, -1.0), (0.5, -1.0), (1.0, 0.0), (0.5, 1.0), (-0.5, 1.0), (-1.0, 0.0)],
        };
        let corner = |corner: &Position| DVec2::from(at) + radius * DVec2::from(*corner);
        self.drawing.polygon(&corners.iter().map(corner).collect::<Vec<_>>(), color);
    }
}

/// Returns the color of letters and axes: nearly black.
pub(super) fn ink() -> Rgb {
    srgb(0x28_2828)
}

/// Returns the color of grids.
pub(super) fn faint() -> Rgb {
    srgb(0xDE_DEDE)
}

/// Returns the color of series `number`.
pub(super) fn color(number: usize) -> Rgb {
    srgb(COLORS[number % COLORS.len()])
}

/// Returns the width of a text of [`FONT_SIZE`].
pub(super) fn width(text: &str) -> f64 {
    text_width(text, FONT_SIZE)
}
