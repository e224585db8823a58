//! Color bars, which show the numbers that the colors of a picture stand for.

use crate::color::{Rgb, Scale, Tick, ticks};
use crate::drawing::{self, Area, DrawingError, Drawn, Format, Picture, letters};
use crate::image::Image;
use crate::image::tone::{srgb_decode, srgb_encode};
use plotters::backend::DrawingBackend;
use plotters::element::{PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

/// Lengths of color bars in pixels.
pub const LENGTHS: std::ops::RangeInclusive<u32> = 64..=8192;

/// Maximum number of characters of a label.
const MAX_LABEL: usize = 60;

/// Direction of increasing numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Upward, with numbers at the right.
    #[default]
    Up,
    /// To the right, with numbers below.
    Right,
}

/// A color bar with its layout: colors, round numbers beside them, and a label above.
///
/// If a scale has separate colors outside of its range, the bar ends in arrows of these colors.
#[derive(Clone, Debug)]
pub struct Bar {
    scale: Scale,
    label: String,
    ticks: Vec<Tick>,
    direction: Direction,
    length: i32,
    /// Height of letters in pixels.
    letter: i32,
    /// Top left corner of the colors.
    corner: (i32, i32),
    size: (u32, u32),
}

impl Bar {
    /// Creates a bar whose colors are `length` pixels long, clamped to 64 to 8192. Everything else is
    /// in proportion. Of longer labels only the first 60 characters are shown.
    ///
    /// # Errors
    /// [`DrawingError`], an error of the program.
    pub fn new(
        scale: &Scale,
        label: &str,
        length: u32,
        direction: Direction,
    ) -> Result<Self, DrawingError> {
        let length = length.clamp(*LENGTHS.start(), *LENGTHS.end()) as i32;
        let letter = (length / 18).max(11);
        let mut bar = Self {
            scale: *scale,
            label: label.chars().take(MAX_LABEL).collect(),
            ticks: Vec::new(),
            direction,
            length,
            letter,
            corner: (0, 0),
            size: (0, 0),
        };
        bar.lay_out()?;
        Ok(bar)
    }

    /// Chooses the numbers, and computes the size.
    fn lay_out(&mut self) -> Result<(), DrawingError> {
        let widest = self.choose_ticks()?;
        let heading = if self.label.is_empty() { 0 } else { self.letter * 7 / 4 };
        let [below, above] = [self.scale.below, self.scale.above].map(|end| self.arrow(end));
        let beyond = self.thickness() + self.gap();
        let (left, right, top, bottom) = match self.direction {
            Direction::Up => (0, beyond + widest, heading + above, self.length + below),
            Direction::Right => {
                let half = widest / 2;
                let (left, right) = (below.max(half), self.length + above.max(half));
                (left, right, heading, beyond + self.letter)
            }
        };
        let margin = self.letter;
        self.corner = (margin + left, margin + top);
        let title = drawing::width(&self.label, self.letter as u32)? as i32;
        let width = (left + right).max(title) + 2 * margin;
        self.size = (width as u32, (top + bottom + 2 * margin) as u32);
        Ok(())
    }

    /// Chooses as many numbers as fit. Returns the width of the widest.
    fn choose_ticks(&mut self) -> Result<i32, DrawingError> {
        let mut widest = 0;
        for most in (2..=8).rev() {
            self.ticks = ticks(&self.scale.range, most);
            widest = 0;
            for tick in &self.ticks {
                widest = widest.max(drawing::width(&tick.label, self.letter as u32)? as i32);
            }
            let room = widest + self.letter;
            if self.direction == Direction::Up || room * self.ticks.len() as i32 <= self.length {
                break;
            }
        }
        Ok(widest)
    }

    fn thickness(&self) -> i32 {
        self.letter * 5 / 4
    }

    /// Returns the distance from the colors to the numbers.
    fn gap(&self) -> i32 {
        self.letter * 2 / 3
    }

    /// Returns the length of an arrow.
    fn arrow(&self, color: Option<Rgb>) -> i32 {
        color.map_or(0, |_| self.letter)
    }

    /// Returns the position `along` pixels from the low end and `across` pixels from the bar's near
    /// side.
    fn position(&self, along: i32, across: i32) -> (i32, i32) {
        let (x, y) = self.corner;
        match self.direction {
            Direction::Up => (x + across, y + self.length - 1 - along),
            Direction::Right => (x + along, y + across),
        }
    }

    fn draw_colors<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        let last = self.length - 1;
        for along in 0..=last {
            let color = code(self.scale.at(f64::from(along) / f64::from(last)));
            // Two pixels, so that vector images have no seams. The last row and column are exclusive.
            let (a, b) = (self.position(along, 0), self.position((along + 1).min(last), 0));
            let end = match self.direction {
                Direction::Up => (a.0 + self.thickness(), a.1 + 1),
                Direction::Right => (b.0 + 1, a.1 + self.thickness()),
            };
            area.draw(&Rectangle::new([(a.0, a.1.min(b.1)), end], color.filled()))?;
        }
        for (end, from, to) in [(self.scale.below, 0, -1), (self.scale.above, last, 1)] {
            if let Some(color) = end {
                let tip = from + to * self.arrow(end);
                let corners = [(from, 0), (tip, self.thickness() / 2), (from, self.thickness())];
                let corners = corners.map(|(along, across)| self.position(along, across));
                area.draw(&Polygon::new(corners, code(color).filled()))?;
            }
        }
        Ok(())
    }

    fn draw_ticks<B: DrawingBackend>(&self, area: &Area<B>, ink: RGBColor) -> Drawn<B> {
        let stroke = ink.stroke_width((self.letter as u32 / 12).max(1));
        for Tick { value, label } in &self.ticks {
            let along = self.scale.range.position(*value) * f64::from(self.length - 1);
            let at = |across| self.position(along.round() as i32, across);
            let ends = [at(self.thickness()), at(self.thickness() + self.letter / 3)];
            area.draw(&PathElement::new(ends, stroke))?;
            let (mut position, side) = match self.direction {
                Direction::Up => (at(self.thickness() + self.gap()), HPos::Left),
                Direction::Right => (at(self.thickness() + self.gap()), HPos::Center),
            };
            if self.direction == Direction::Right {
                position.1 += self.letter / 2;
            }
            area.draw(&Text::new(label.clone(), position, letters(self.letter as u32, ink, side)))?;
        }
        Ok(())
    }

    fn draw_in<B: DrawingBackend>(&self, area: &Area<B>, ink: RGBColor) -> Drawn<B> {
        self.draw_colors(area)?;
        self.draw_ticks(area, ink)?;
        let style = letters(self.letter as u32, ink, HPos::Left);
        let position = (self.letter, self.letter * 3 / 2);
        area.draw(&Text::new(self.label.clone(), position, style))
    }

    /// Returns the content of a file with the bar on white.
    ///
    /// # Errors
    /// [`DrawingError`], an error of the program.
    pub fn file(&self, format: Format) -> Result<Vec<u8>, DrawingError> {
        drawing::file(self, format)
    }

    /// Draws the bar over a picture, with its top left corner in column `x` and row `y`; parts outside
    /// are cut off. Letters have the linear color `ink`.
    ///
    /// The colors are linear like the picture's: exposure and tone affect both.
    ///
    /// # Errors
    /// [`DrawingError`], an error of the program.
    pub fn draw_over(
        &self,
        image: &mut Image,
        (x, y): (u32, u32),
        ink: Rgb,
    ) -> Result<(), DrawingError> {
        let inked = Inked { bar: self, ink: code(ink) };
        // The difference of the drawings on black and on white gives the coverage.
        let [black, white] = [0, 255].map(|code| RGBColor(code, code, code));
        let (dark, light) = (drawing::codes(&inked, black)?, drawing::codes(&inked, white)?);
        let width = self.size.0;
        for (i, (dark, light)) in dark.chunks_exact(3).zip(light.chunks_exact(3)).enumerate() {
            let (column, row) = (x.checked_add(i as u32 % width), y.checked_add(i as u32 / width));
            let (Some(column), Some(row)) = (column, row) else { continue };
            if column >= image.width || row >= image.height {
                continue;
            }
            let position = row as usize * image.width as usize + column as usize;
            if let Some(pixel) = image.pixels.get_mut(position) {
                for (channel, value) in pixel.iter_mut().enumerate() {
                    *value = over(*value, dark[channel], light[channel]);
                }
            }
        }
        Ok(())
    }
}

/// Returns a linear value under a drawing that has these codes on black and on white.
fn over(under: f32, dark: u8, light: u8) -> f32 {
    let cover = 1.0 - f64::from(light.saturating_sub(dark)) / 255.0;
    if cover == 0.0 {
        return under;
    }
    let color = srgb_decode((f64::from(dark) / 255.0 / cover).min(1.0));
    (cover * color + (1.0 - cover) * f64::from(under)) as f32
}

/// Returns the codes of a linear color.
fn code(color: Rgb) -> RGBColor {
    let [r, g, b] = color
        .to_array()
        .map(|value| (srgb_encode(f64::from(value.clamp(0.0, 1.0))) * 255.0).round() as u8);
    RGBColor(r, g, b)
}

impl Picture for Bar {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        self.draw_in(area, drawing::INK)
    }
}

/// A bar with letters of another color.
struct Inked<'a> {
    bar: &'a Bar,
    ink: RGBColor,
}

impl Picture for Inked<'_> {
    fn size(&self) -> (u32, u32) {
        self.bar.size
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        self.bar.draw_in(area, self.ink)
    }
}

#[cfg(test)]
mod tests;
