//! Text rendering with glyphs that stay apart at every size.
//!
//! There is no hinting. Instead, the x-height is a whole number of pixels, every glyph starts at the left
//! edge of a pixel, and two glyphs have at least one empty column between them. So stems are sharp, and `cl`
//! does not look like `d`.

use ab_glyph::{Font, FontRef, PxScale, point};
use std::collections::HashMap;

/// Colors of text and of its background.
pub(super) const PAPER: u32 = 0x0018_181C;
pub(super) const LIGHT: u32 = 0x00E6_E6E6;
pub(super) const ACCENT: u32 = 0x00FF_C85A;

/// X-height in pixels at a display scale of 1, and the minimum.
const X_HEIGHT: f64 = 7.0;
const LEAST: f64 = 5.0;

/// Distance between baselines, and from the top of a line to its baseline, in x-heights.
const LINE: f64 = 20.0 / 7.0;
const BASELINE: f64 = 14.0 / 7.0;

/// Replaces characters that are left out.
pub(super) const ELLIPSIS: char = '\u{2026}';

/// The font at a size.
#[derive(Clone)]
pub(super) struct SizedFont {
    font: FontRef<'static>,
    x_height: f64,
    /// Pixels per unit of the font.
    unit: f32,
    glyphs: HashMap<char, Glyph>,
}

/// A rasterized glyph, with pen and baseline at (0, 0).
#[derive(Clone, Debug, Default)]
struct Glyph {
    left: i32,
    top: i32,
    width: i32,
    /// Coverage of each pixel, row by row.
    coverage: Vec<f32>,
    advance: i32,
}

/// Surface that text is drawn on: pixels `0x00RRGGBB`, row by row.
pub(super) struct Surface<'p> {
    pub(super) pixels: &'p mut [u32],
    pub(super) width: u32,
    pub(super) height: u32,
}

impl SizedFont {
    /// Creates the font for a display of this scale; `None` if the font cannot be read.
    pub(super) fn new(scale: f64) -> Option<Self> {
        let font = FontRef::try_from_slice(dejavu::sans::regular()).ok()?;
        let x_height = (X_HEIGHT * scale).round().max(LEAST);
        let x_units = font.outline(font.glyph_id('x'))?.bounds.height().abs();
        let unit = x_height as f32 / x_units.max(1.0);
        Some(Self { font, x_height, unit, glyphs: HashMap::new() })
    }

    /// Line height in pixels.
    pub(super) fn line(&self) -> u32 {
        (self.x_height * LINE).round() as u32
    }

    /// Distance of text from an edge in pixels.
    pub(super) fn margin(&self) -> u32 {
        self.line() / 2
    }

    /// Width of a text in pixels.
    pub(super) fn width(&mut self, text: &str) -> u32 {
        self.place(text, |_, _| ()).max(0) as u32
    }

    /// Draws a text in a line whose top left corner is at (x, y).
    pub(super) fn draw(
        &mut self,
        text: &str,
        (x, y): (u32, u32),
        color: u32,
        surface: &mut Surface,
    ) {
        let (x, baseline) = (x as i32, y as i32 + (self.x_height * BASELINE).round() as i32);
        self.place(text, |glyph, pen| {
            for (i, &cover) in glyph.coverage.iter().enumerate() {
                let row = baseline + glyph.top + i as i32 / glyph.width;
                let column = x + pen + glyph.left + i as i32 % glyph.width;
                surface.blend((column, row), color, cover);
            }
        });
    }

    /// Visits the glyphs of a text with their pen positions; returns the end of the text.
    fn place(&mut self, text: &str, mut each: impl FnMut(&Glyph, i32)) -> i32 {
        let (mut pen, mut end) = (0, None);
        for letter in text.chars() {
            let letter = if letter.is_control() { ' ' } else { letter };
            if !self.glyphs.contains_key(&letter) {
                let glyph = self.glyph(letter);
                self.glyphs.insert(letter, glyph);
            }
            let Some(glyph) = self.glyphs.get(&letter) else { continue };
            if glyph.width > 0 {
                // An empty column between two glyphs; the text starts with its first inked column.
                let free = end.map_or(0, |end| end + 1);
                pen = pen.max(free - glyph.left);
                end = Some(pen + glyph.left + glyph.width);
                each(glyph, pen);
            }
            pen += glyph.advance;
        }
        pen.max(end.unwrap_or(0))
    }

    fn glyph(&self, letter: char) -> Glyph {
        let id = self.font.glyph_id(letter);
        let advance = (self.font.h_advance_unscaled(id) * self.unit).round() as i32;
        let Some(outline) = self.font.outline(id) else {
            return Glyph { advance, ..Glyph::default() };
        };
        let left = outline.bounds.min.x * self.unit;
        // `PxScale` is the height from the lowest to the highest point of the font.
        let scale = PxScale::from(self.font.height_unscaled() * self.unit);
        let shift = point(left.round() - left, 0.0);
        let placed = id.with_scale_and_position(scale, shift);
        let Some(placed) = self.font.outline_glyph(placed) else {
            return Glyph { advance, ..Glyph::default() };
        };
        let bounds = placed.px_bounds();
        let (width, height) = (bounds.width() as i32, bounds.height() as i32);
        let mut coverage = vec![0.0; (width * height) as usize];
        placed.draw(|x, y, cover| {
            if let Some(pixel) = coverage.get_mut(y as usize * width as usize + x as usize) {
                *pixel = cover.clamp(0.0, 1.0);
            }
        });
        Glyph { left: bounds.min.x as i32, top: bounds.min.y as i32, width, coverage, advance }
    }
}

impl Surface<'_> {
    /// Blends a color over a pixel.
    pub(super) fn blend(&mut self, (x, y): (i32, i32), color: u32, cover: f32) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
        if x < self.width && y < self.height {
            let place = y as usize * self.width as usize + x as usize;
            if let Some(pixel) = self.pixels.get_mut(place) {
                *pixel = blended(*pixel, color, cover);
            }
        }
    }

    /// Blends a color over rows, clipped to the surface.
    pub(super) fn fill_rows(&mut self, rows: std::ops::Range<u32>, color: u32, cover: f32) {
        let width = self.width as usize;
        let end = rows.end.min(self.height) as usize * width;
        let start = (rows.start as usize * width).min(end);
        if let Some(rows) = self.pixels.get_mut(start..end) {
            for pixel in rows {
                *pixel = blended(*pixel, color, cover);
            }
        }
    }
}

/// Blends a color over another.
pub(super) fn blended(under: u32, over: u32, cover: f32) -> u32 {
    let channel = |shift: u32| {
        let [under, over] = [under, over].map(|color| ((color >> shift) & 0xFF) as f32);
        ((under + cover * (over - under)).round() as u32) << shift
    };
    channel(16) | channel(8) | channel(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: [f64; 8] = [0.5, 0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.7];

    fn drawn(letters: &mut SizedFont, text: &str) -> (Vec<u32>, u32, u32) {
        let (width, height) = (letters.width(text), letters.line());
        let mut pixels = vec![0; width as usize * height as usize];
        let mut surface = Surface { pixels: &mut pixels, width, height };
        letters.draw(text, (0, 0), 0x00FF_FFFF, &mut surface);
        (pixels, width, height)
    }

    /// Runs of columns with something in them.
    fn runs(letters: &mut SizedFont, text: &str) -> usize {
        let (pixels, width, height) = drawn(letters, text);
        let inked =
            |column: u32| (0..height).any(|row| pixels[(row * width + column) as usize] != 0);
        (0..width).filter(|&x| inked(x) && (x == 0 || !inked(x - 1))).count()
    }

    #[test]
    fn letters_do_not_touch_at_any_size() {
        let all: Vec<char> =
            (' '..='~').filter(|c| c.is_ascii_graphic() && !['"', '%'].contains(c)).collect();
        for scale in SCALES {
            let mut letters = SizedFont::new(scale).expect("a font");
            for first in &all {
                for second in ['c', 'l', 'd', 'i', 'r', 'n', 'f', 'j', '1', '_', 'A', '/'] {
                    let pair = format!("{first}{second}");
                    assert_eq!(runs(&mut letters, &pair), 2, "{pair} at {scale}");
                }
            }
            assert_eq!(runs(&mut letters, "click"), 5, "{scale}");
            assert_ne!(drawn(&mut letters, "click").0, drawn(&mut letters, "dick").0);
        }
    }

    #[test]
    fn letters_grow_with_the_scale_and_fit_their_lines() {
        let height = |scale: f64, text: &str| {
            let mut letters = SizedFont::new(scale).expect("a font");
            let (pixels, width, rows) = drawn(&mut letters, text);
            let mut row = (0..rows)
                .filter(|row| (0..width).any(|x| pixels[(row * width + x) as usize] > 0x0080_8080));
            let first = row.next().expect("a row");
            (first, row.next_back().unwrap_or(first), rows)
        };
        for (scale, expected) in [(1.0, 7), (1.5, 11), (2.0, 14), (3.0, 21)] {
            let (first, last, _) = height(scale, "xz");
            assert_eq!(last - first + 1, expected, "{scale}");
            let (first, last, rows) = height(scale, "[Aj]|g");
            assert!(first > 0 && last + 1 < rows, "{scale}: {first} to {last} of {rows}");
        }
    }

    #[test]
    fn stems_are_sharp() {
        let mut letters = SizedFont::new(1.0).expect("a font");
        let (pixels, width, height) = drawn(&mut letters, "l");
        let column = |x: u32| (0..height).map(|row| pixels[(row * width + x) as usize]).max();
        let columns: Vec<u32> = (0..width).filter_map(column).filter(|ink| *ink > 0).collect();
        assert!(columns[0] > 0x00F0_F0F0, "{columns:x?}");
        assert!(columns[1..].iter().all(|ink| *ink < 0x0060_6060), "{columns:x?}");
    }
}
