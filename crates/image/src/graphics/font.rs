//! The font of drawings: widths and outlines of glyphs.

use ab_glyph::{Font, FontRef, GlyphId, OutlineCurve};
use std::sync::LazyLock;

/// Name of the font, and of similar ones for programs that lack it.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Height of capital letters and digits as a fraction of the em square.
pub const CAP_HEIGHT: f64 = 0.729;

/// Height of lowercase letters without ascender as a fraction of the em square.
pub const X_HEIGHT: f64 = 0.547;

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(data()).expect("the font that is part of the program is valid")
});

/// The font file.
pub(super) fn data() -> &'static [u8] {
    dejavu::sans::regular()
}

/// A glyph of a line of text.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedGlyph {
    pub(super) id: GlyphId,
    pub(super) letter: char,
    /// Distance from the start of the text, in ems.
    pub(super) start: f64,
    /// Distance to the next glyph without kerning, in ems.
    pub(super) advance: f64,
}

/// Returns the width of a text in pixels, for an em square of `size` pixels.
pub fn text_width(text: &str, size: f64) -> f64 {
    glyphs(text).last().map_or(0.0, |glyph| (glyph.start + glyph.advance) * size)
}

/// Returns the glyphs of a line of text, with kerning.
pub(super) fn glyphs(text: &str) -> Vec<PlacedGlyph> {
    let mut glyphs: Vec<PlacedGlyph> = Vec::new();
    for letter in text.chars() {
        let id = FONT.glyph_id(letter);
        let start = glyphs.last().map_or(0.0, |last| {
            last.start + last.advance + per_em(FONT.kern_unscaled(last.id, id))
        });
        let advance = per_em(FONT.h_advance_unscaled(id));
        glyphs.push(PlacedGlyph { id, letter, start, advance });
    }
    glyphs
}

/// Returns the curves of a glyph, in ems from the start of its baseline, upward.
pub(super) fn outline(id: GlyphId) -> Vec<OutlineCurve> {
    let scale =
        |point: ab_glyph::Point| ab_glyph::point(per_em(point.x) as f32, per_em(point.y) as f32);
    let curves = FONT.outline(id).map_or_else(Vec::new, |outline| outline.curves);
    let curve = |curve| match curve {
        OutlineCurve::Line(a, b) => OutlineCurve::Line(scale(a), scale(b)),
        OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(scale(a), scale(b), scale(c)),
        OutlineCurve::Cubic(a, b, c, d) => {
            OutlineCurve::Cubic(scale(a), scale(b), scale(c), scale(d))
        }
    };
    curves.into_iter().map(curve).collect()
}

/// Converts a length from the font's units to ems.
fn per_em(length: f32) -> f64 {
    f64::from(length) / f64::from(FONT.units_per_em().unwrap_or(2048.0))
}
