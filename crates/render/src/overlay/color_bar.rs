//! Color bars, which show the numbers that the colors of an image stand for.

use super::annotations::Block;
use crate::color::{Rgb, Scale, Tick, ticks};
use crate::graphics::{
    Align, CAP_HEIGHT, Drawing, Format, PageError, Text, marked_width, text_width,
};
use glam::DVec2;
use std::num::NonZeroU16;

/// Lengths of color bars in files, in pixels.
pub const LENGTHS: std::ops::RangeInclusive<u32> = 64..=8192;

/// Maximum number of characters of a label.
const MAX_LABEL: usize = 60;

/// Number of stripes of one color.
const STRIPES: u32 = 256;

/// Color of letters and lines on white: nearly black.
const INK: Rgb = Rgb::splat(0.02);

/// Length of a bar in a file relative to the size of its letters.
const LENGTH_PER_EM: f64 = 20.0;

/// Direction of increasing numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Upward, with numbers at the right.
    #[default]
    Up,
    /// To the right, with numbers below.
    Right,
}

/// A color bar with its layout: colors, round numbers beside them, and a label above, in which `_` and `^` mark subscripts and
/// superscripts, as in `v_x` and `m^2`.
///
/// If a scale has separate colors outside of its range, the bar ends in arrows of these colors.
#[derive(Clone, Debug)]
pub struct Bar {
    scale: Scale,
    label: String,
    ticks: Vec<Tick>,
    /// Width of the widest number.
    widest: f64,
    direction: Direction,
    /// Length of the colors in pixels.
    length: f64,
    /// Size of the em square in pixels.
    letter: f64,
}

impl Bar {
    /// Creates a bar whose colors are `length` pixels long, with letters of the size `letter`. Of longer
    /// labels only the first 60 characters are shown.
    pub fn new(scale: &Scale, label: &str, length: f64, letter: f64, direction: Direction) -> Self {
        // Whole pixels, so that edges are sharp.
        let length = length.round().max(1.0);
        let label = label.chars().take(MAX_LABEL).collect();
        let (ticks, widest) = choose_ticks(scale, length, letter, direction);
        Self { scale: *scale, label, ticks, widest, direction, length, letter }
    }

    /// Returns the content of a file with a bar on white. Its colors are `length` pixels long, clamped to
    /// 64 to 8192, and everything else is in proportion to letters of `letter` pixels: by default a twentieth of the
    /// length. The file may have a `resolution` in pixels per inch.
    ///
    /// # Errors
    /// [`PageError`], an error of the program or a lack of memory.
    pub fn file(
        scale: &Scale,
        label: &str,
        length: u32,
        letter: Option<f64>,
        format: Format,
        resolution: Option<NonZeroU16>,
    ) -> Result<Vec<u8>, PageError> {
        let length = f64::from(length.clamp(*LENGTHS.start(), *LENGTHS.end()));
        let letter = letter.unwrap_or_else(|| (length / LENGTH_PER_EM).max(10.0));
        let Block { drawing, size } =
            Self::new(scale, label, length, letter, Direction::Up).block(INK);
        let mut page = Drawing::default();
        page.append(drawing, DVec2::splat(letter));
        let size = (size + 2.0 * letter).ceil();
        page.file(format, (size.x as u32, size.y as u32), resolution)
    }

    /// Returns the drawing of the bar, with letters of the linear color `ink`.
    pub fn block(&self, ink: Rgb) -> Block {
        let mut drawing = Drawing::default();
        self.draw_colors(&mut drawing);
        self.draw_ticks(&mut drawing, ink);
        let position = DVec2::new(0.0, CAP_HEIGHT * self.letter);
        let text = self.label.clone();
        let (align, size) = (Align::Start, self.letter);
        drawing.marked_text(&Text { text, position, align, size, color: ink });
        Block { drawing, size: self.size() }
    }

    fn size(&self) -> DVec2 {
        let title = marked_width(&self.label, self.letter);
        let corner = self.corner();
        let below = self.arrow(self.scale.below);
        let half_number = CAP_HEIGHT * self.letter / 2.0;
        let beyond = self.thickness() + self.gap();
        match self.direction {
            Direction::Up => DVec2::new(
                (beyond + self.widest).max(title),
                corner.y + self.length + below.max(half_number),
            ),
            Direction::Right => {
                let right = self.arrow(self.scale.above).max(self.widest / 2.0);
                let width = (corner.x + self.length + right).max(title);
                DVec2::new(width, corner.y + beyond + 2.0 * half_number)
            }
        }
    }

    /// Returns the top left corner of the colors.
    fn corner(&self) -> DVec2 {
        let heading = if self.label.is_empty() { 0.0 } else { (CAP_HEIGHT + 0.8) * self.letter };
        let [below, above] = [self.scale.below, self.scale.above].map(|end| self.arrow(end));
        let corner = match self.direction {
            Direction::Up => {
                let number = CAP_HEIGHT * self.letter / 2.0;
                let overhang = if self.label.is_empty() { number } else { 0.0 };
                DVec2::new(0.0, heading + above.max(overhang))
            }
            Direction::Right => DVec2::new(below.max(self.widest / 2.0), heading),
        };
        corner.ceil()
    }

    fn thickness(&self) -> f64 {
        (self.letter * 1.1).round()
    }

    /// Returns the distance from the colors to the numbers.
    fn gap(&self) -> f64 {
        self.letter * 0.6
    }

    /// Returns the length of an arrow.
    fn arrow(&self, color: Option<Rgb>) -> f64 {
        color.map_or(0.0, |_| self.letter)
    }

    /// Returns the position `along` pixels from the low end and `across` pixels from the bar's near
    /// side.
    fn position(&self, along: f64, across: f64) -> DVec2 {
        let corner = self.corner();
        match self.direction {
            Direction::Up => corner + DVec2::new(across, self.length - along),
            Direction::Right => corner + DVec2::new(along, across),
        }
    }

    fn draw_colors(&self, drawing: &mut Drawing) {
        let stripe = self.length / f64::from(STRIPES);
        for index in 0..STRIPES {
            let color = self.scale.at((f64::from(index) + 0.5) / f64::from(STRIPES));
            // Stripes reach the high end, and later ones are drawn over earlier ones: there are no seams.
            let from = f64::from(index) * stripe;
            let [a, b] = [self.position(from, 0.0), self.position(self.length, self.thickness())];
            drawing.rectangle(a.min(b), a.max(b), color);
        }
        for (end, from, to) in [(self.scale.below, 0.0, -1.0), (self.scale.above, self.length, 1.0)]
        {
            if let Some(color) = end {
                let (tip, wide) = (from + to * self.arrow(end), self.thickness());
                let corners = [(from, 0.0), (tip, wide / 2.0), (from, wide)];
                drawing
                    .polygon(&corners.map(|(along, across)| self.position(along, across)), color);
            }
        }
    }

    fn draw_ticks(&self, drawing: &mut Drawing, ink: Rgb) {
        let (wide, size) = (self.thickness(), self.letter);
        for Tick { value, label } in &self.ticks {
            let along = self.scale.range.position(*value) * self.length;
            let ends = [wide, wide + 0.3 * size].map(|across| self.position(along, across));
            drawing.line(ends, (size / 12.0).max(1.0), ink);
            let beside = self.position(along, wide + self.gap());
            let (position, align) = match self.direction {
                Direction::Up => (beside + DVec2::Y * (CAP_HEIGHT * size / 2.0), Align::Start),
                Direction::Right => (beside + DVec2::Y * (CAP_HEIGHT * size), Align::Middle),
            };
            drawing.text(Text { text: label.clone(), position, align, size, color: ink });
        }
    }
}

/// Chooses as many numbers as fit. Returns them and the width of the widest.
fn choose_ticks(scale: &Scale, length: f64, letter: f64, direction: Direction) -> (Vec<Tick>, f64) {
    let mut chosen = (Vec::new(), 0.0);
    for most in (2..=8).rev() {
        let ticks = ticks(&scale.range, most);
        let widths = ticks.iter().map(|tick| text_width(&tick.label, letter));
        let widest = widths.fold(0.0, f64::max);
        let room = match direction {
            Direction::Up => 1.5 * letter,
            Direction::Right => widest + letter,
        };
        let fits = room * ticks.len() as f64 <= length;
        chosen = (ticks, widest);
        if fits {
            break;
        }
    }
    chosen
}

#[cfg(test)]
mod tests;
