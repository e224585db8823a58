//! Drawing of lines, areas and letters, for charts. Annotations of pictures are drawn by
//! [`graphics`](crate::graphics).
//!
//! A [`Picture`] is drawn by the same code for pixels and vectors. The font is included in the program,
//! since the system may have none.

use crate::image::suffix;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, TextStyle, register_font};
use std::fmt::Display;
use std::path::Path;

/// The area of a drawing, from (0, 0) at the top left to its size.
pub type Area<B> = DrawingArea<B, Shift>;

/// The result of drawing with a backend.
pub type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// The background: white.
const PAPER: RGBColor = RGBColor(255, 255, 255);

/// The color of letters and lines: nearly black.
pub const INK: RGBColor = RGBColor(40, 40, 40);

const FONT: &str = "sans-serif";

/// A file format of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    Png,
    /// Vectors.
    Svg,
}

/// The reason why drawing failed: an error of the program, or an excessive size.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw the picture: {0}")]
pub struct DrawingError(String);

/// A picture that can be drawn.
pub trait Picture {
    /// Returns width and height in pixels.
    fn size(&self) -> (u32, u32);

    /// Draws the picture onto a background.
    ///
    /// # Errors
    /// Those of the backend.
    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B>;
}

impl Format {
    /// Returns the format of a file by its name; `None` unless it ends in `.png` or `.svg`.
    pub fn of_suffix(path: &Path) -> Option<Self> {
        match suffix(path).as_str() {
            "png" => Some(Self::Png),
            "svg" => Some(Self::Svg),
            _ => None,
        }
    }
}

/// Returns the content of a picture's file, on a white background.
///
/// # Errors
/// [`DrawingError`].
pub fn file(picture: &impl Picture, format: Format) -> Result<Vec<u8>, DrawingError> {
    match format {
        Format::Png => encode(&codes(picture)?, picture.size()),
        Format::Svg => {
            register_included_font()?;
            let mut text = String::new();
            let area = SVGBackend::with_string(&mut text, picture.size()).into_drawing_area();
            on_paper(picture, &area).map_err(drawing_error)?;
            drop(area);
            Ok(text.into_bytes())
        }
    }
}

/// Returns the pixels of a picture on a white background: sRGB codes, three bytes each, row by row.
///
/// # Errors
/// [`DrawingError`].
pub fn codes(picture: &impl Picture) -> Result<Vec<u8>, DrawingError> {
    register_included_font()?;
    let (width, height) = picture.size();
    let mut codes = vec![0; width as usize * height as usize * 3];
    let area = BitMapBackend::with_buffer(&mut codes, (width, height)).into_drawing_area();
    on_paper(picture, &area).map_err(drawing_error)?;
    drop(area);
    Ok(codes)
}

fn on_paper<B: DrawingBackend>(picture: &impl Picture, area: &Area<B>) -> Drawn<B> {
    area.fill(&PAPER)?;
    picture.draw(area)?;
    area.present()
}

/// Registers the font; may be repeated.
fn register_included_font() -> Result<(), DrawingError> {
    register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
        .map_err(|_| DrawingError("its font cannot be read".to_owned()))
}

fn drawing_error(error: impl Display) -> DrawingError {
    DrawingError(error.to_string())
}

/// Returns the content of a PNG file of pixels: sRGB codes, three bytes each, row by row.
///
/// # Errors
/// [`DrawingError`] if their number differs from the size.
pub fn encode(codes: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, DrawingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(codes));
    written.map(|()| file).map_err(drawing_error)
}

/// Returns a style for letters of a size in pixels, vertically centered; horizontally they start
/// (`HPos::Left`) or end at the position, or are centered.
pub fn letters(size: u32, color: RGBColor, side: HPos) -> TextStyle<'static> {
    let style = TextStyle::from((FONT, size)).pos(Pos::new(side, VPos::Center));
    TextStyle { color: color.to_backend_color(), ..style }
}

/// Returns the width of a text in letters of a size, in pixels.
///
/// # Errors
/// [`DrawingError`].
pub fn width(text: &str, size: u32) -> Result<u32, DrawingError> {
    register_included_font()?;
    let (width, _) = (FONT, size).into_font().box_size(text).map_err(drawing_error)?;
    Ok(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_follow_from_the_name() {
        let of = |name: &str| Format::of_suffix(Path::new(name));
        assert_eq!((of("a.png"), of("b/A.SVG")), (Some(Format::Png), Some(Format::Svg)));
        assert_eq!((of("a.pdf"), of("png")), (None, None));
    }

    #[test]
    fn texts_are_as_wide_as_their_letters() {
        let [one, two, large] =
            [("m", 20), ("mm", 20), ("m", 40)].map(|(text, size)| width(text, size).unwrap());
        assert!(one > 10 && two.abs_diff(2 * one) <= 1 && large.abs_diff(2 * one) <= 1);
        assert_eq!(width("", 20).unwrap(), 0);
    }
}
