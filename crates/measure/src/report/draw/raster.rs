//! Drawing of shapes as SVG and PNG.

use super::canvas::{Align, Canvas, Position, Shape, WIDTH};
use plotters::backend::DrawingBackend;
use plotters::element::{Circle, DashedPathElement, PathElement, Polygon, Text};
use plotters::style::Color;
use plotters::style::text_anchor::HPos;
use spherule_render::drawing::{self, Area, DrawingError, Drawn, INK, Picture, letters};

/// Supersampling factor of PNG images along each axis.
const SUPERSAMPLING: usize = 2;

/// Offset that centers text in PNG images vertically, relative to its height: the backend centers the
/// box of a text, not its letters.
const DROP: f64 = 0.16;

/// A canvas to draw.
pub(super) struct Drawing<'a> {
    canvas: &'a Canvas,
    /// Pixels of the image for each pixel of the canvas.
    scale: f64,
    /// Vertical offset of text, relative to its height.
    drop: f64,
}

impl<'a> Drawing<'a> {
    /// Returns a drawing of the canvas's size.
    pub(super) fn new(canvas: &'a Canvas) -> Self {
        Self { canvas, scale: 1.0, drop: 0.0 }
    }
}

impl Picture for Drawing<'_> {
    fn size(&self) -> (u32, u32) {
        ((WIDTH * self.scale) as u32, (self.canvas.height.floor() * self.scale) as u32)
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        self.canvas.shapes.iter().try_for_each(|shape| self.shape(area, shape))
    }
}

pub(super) fn png(canvas: &Canvas) -> Result<Vec<u8>, DrawingError> {
    let (width, height) = Drawing::new(canvas).size();
    let supersampled = Drawing { canvas, scale: SUPERSAMPLING as f64, drop: DROP };
    let pixels = drawing::codes(&supersampled)?;
    drawing::encode(&downsample(&pixels, width as usize, height as usize), (width, height))
}

impl Drawing<'_> {
    fn shape<B: DrawingBackend>(&self, area: &Area<B>, shape: &Shape) -> Drawn<B> {
        let at =
            |(x, y): Position| ((x * self.scale).round() as i32, (y * self.scale).round() as i32);
        let all = |points: &[Position]| points.iter().copied().map(at).collect::<Vec<_>>();
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
                    Align::Left => HPos::Left,
                    Align::Center => HPos::Center,
                    Align::Right => HPos::Right,
                };
                let place = at((*x, y + self.drop * height));
                area.draw(&Text::new(text.as_str(), place, letters(pixels(*height), INK, side)))
            }
        }
    }
}

/// Returns the mean of each square of pixels.
fn downsample(pixels: &[u8], width: usize, height: usize) -> Vec<u8> {
    let fine = |x: usize, y: usize, channel: usize| {
        u32::from(pixels[(y * width * SUPERSAMPLING + x) * 3 + channel])
    };
    let mut mean = Vec::with_capacity(width * height * 3);
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        for channel in 0..3 {
            let square = (0..SUPERSAMPLING * SUPERSAMPLING).map(|i| {
                (x * SUPERSAMPLING + i % SUPERSAMPLING, y * SUPERSAMPLING + i / SUPERSAMPLING)
            });
            let sum: u32 = square.map(|(x, y)| fine(x, y, channel)).sum();
            mean.push((sum as usize / (SUPERSAMPLING * SUPERSAMPLING)) as u8);
        }
    }
    mean
}
