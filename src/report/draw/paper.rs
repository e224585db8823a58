//! From shapes to SVG, and to pixels.

use super::sheet::{At, Shape, Sheet, Side, WIDTH};
use crate::drawing::{self, Area, DrawingError, Drawn, INK, PAPER, Picture, letters};
use plotters::backend::DrawingBackend;
use plotters::element::{Circle, DashedPathElement, PathElement, Polygon, Text};
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

/// Pictures of pixels are drawn so many times larger, and then averaged: edges are smooth.
const FINER: usize = 2;

/// Texts of pixels stand so much too high, in heights of their letters: their boxes are in the
/// middle, not the letters.
const DROP: f64 = 0.16;

/// A sheet to be drawn.
pub(super) struct Paper<'a> {
    sheet: &'a Sheet,
    /// Pixels by those of the sheet.
    scale: f64,
    /// How far letters are lowered, in their heights.
    drop: f64,
}

impl<'a> Paper<'a> {
    /// As large as the sheet.
    pub(super) fn new(sheet: &'a Sheet) -> Self {
        Self { sheet, scale: 1.0, drop: 0.0 }
    }
}

impl Picture for Paper<'_> {
    fn size(&self) -> (u32, u32) {
        ((WIDTH * self.scale) as u32, (self.sheet.height.floor() * self.scale) as u32)
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        self.sheet.shapes.iter().try_for_each(|shape| self.shape(area, shape))
    }
}

pub(super) fn png(sheet: &Sheet) -> Result<Vec<u8>, DrawingError> {
    let (width, height) = Paper::new(sheet).size();
    let finer = Paper { sheet, scale: FINER as f64, drop: DROP };
    let pixels = drawing::codes(&finer, PAPER)?;
    drawing::encode(&averaged(&pixels, width as usize, height as usize), (width, height))
}

impl Paper<'_> {
    fn shape<B: DrawingBackend>(&self, area: &Area<B>, shape: &Shape) -> Drawn<B> {
        let at = |(x, y): At| ((x * self.scale).round() as i32, (y * self.scale).round() as i32);
        let all = |points: &[At]| points.iter().copied().map(at).collect::<Vec<_>>();
        let pixels = |length: f64| (length * self.scale).round() as u32;
        match shape {
            Shape::Path { points, color, width, dashed: false } => {
                area.draw(&PathElement::new(all(points), color.stroke_width(pixels(*width))))
            }
            Shape::Path { points, color, width, .. } => {
                let style = color.stroke_width(pixels(*width));
                let (dash, gap) = (pixels(10.0), pixels(7.0));
                area.draw(&DashedPathElement::new(all(points), dash, gap, style))
            }
            Shape::Area { points, color } => area.draw(&Polygon::new(all(points), color.filled())),
            Shape::Disc { center, radius, color } => {
                area.draw(&Circle::new(at(*center), pixels(*radius), color.filled()))
            }
            Shape::Text { text, at: (x, y), height, side } => {
                let side = match side {
                    Side::Left => HPos::Left,
                    Side::Center => HPos::Center,
                    Side::Right => HPos::Right,
                };
                let place = at((*x, y + self.drop * height));
                area.draw(&Text::new(text.as_str(), place, letters(pixels(*height), INK, side)))
            }
        }
    }
}

/// The mean of each square of pixels.
fn averaged(pixels: &[u8], width: usize, height: usize) -> Vec<u8> {
    let fine = |x: usize, y: usize, channel: usize| {
        u32::from(pixels[(y * width * FINER + x) * 3 + channel])
    };
    let mut mean = Vec::with_capacity(width * height * 3);
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        for channel in 0..3 {
            let square = (0..FINER * FINER).map(|i| (x * FINER + i % FINER, y * FINER + i / FINER));
            let sum: u32 = square.map(|(x, y)| fine(x, y, channel)).sum();
            mean.push((sum as usize / (FINER * FINER)) as u8);
        }
    }
    mean
}
