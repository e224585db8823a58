//! Pages: an image with a drawing over it, as a file.

use super::{Drawing, pdf, svg};
use crate::image::tone::DisplayTransform;
use crate::image::{self, Image, ImageError, Metadata, WriteOptions, suffix};
use std::num::NonZeroU16;
use std::path::Path;

/// A file format of drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    Png,
    /// Vectors, with text as text.
    Svg,
    /// Vectors, with text in an embedded font.
    Pdf,
}

/// A reason why a page cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// The image cannot be encoded or decoded.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The image on the page, or the font, is damaged: an error of the program.
    #[error("cannot write the page: {0}")]
    Content(String),
}

/// An image with a drawing over it.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The image under the drawing, as a PNG file of this size.
    pub picture: Option<&'a [u8]>,
    /// The drawing.
    pub drawing: &'a Drawing,
    /// Transform from linear colors to those of the file.
    pub display: DisplayTransform,
    /// Pixels per inch on paper; `None` for 300 in PDF, and for pixels of the display in SVG.
    pub resolution: Option<NonZeroU16>,
    /// Keys and values; `Title` is the title.
    pub metadata: &'a Metadata,
}

impl Format {
    /// Returns the format of a file by its name; `None` unless it ends in `.png`, `.svg` or `.pdf`.
    pub fn of_suffix(path: &Path) -> Option<Self> {
        match suffix(path).as_str() {
            "png" => Some(Self::Png),
            "svg" => Some(Self::Svg),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }
}

impl Drawing {
    /// Returns the content of a file with the drawing on white, of so many pixels, and pixels per inch.
    ///
    /// # Errors
    /// [`PageError`], an error of the program or a lack of memory.
    pub fn file(
        &self,
        format: Format,
        (width, height): (u32, u32),
        resolution: Option<NonZeroU16>,
    ) -> Result<Vec<u8>, PageError> {
        let options = WriteOptions { resolution, ..WriteOptions::default() };
        let page = Page {
            size: (width, height),
            picture: None,
            drawing: self,
            display: DisplayTransform::nearest(0.0, options.tone),
            resolution,
            metadata: &Metadata::new(),
        };
        match format {
            Format::Png => {
                let mut image = Image::filled(width, height, [1.0; 3])?;
                self.draw_over(&mut image);
                Ok(image.encode(image::Format::Png, &[], &options)?)
            }
            Format::Svg | Format::Pdf => page.file(format),
        }
    }
}

impl Page<'_> {
    /// Returns the content of a file in a format of vectors; a page in PNG is its image.
    ///
    /// # Errors
    /// [`PageError`], an error of the program.
    pub fn file(&self, format: Format) -> Result<Vec<u8>, PageError> {
        match format {
            Format::Png => Ok(self.picture.unwrap_or_default().to_vec()),
            Format::Svg => Ok(svg::file(self).into_bytes()),
            Format::Pdf => pdf::file(self),
        }
    }

    /// Returns the sRGB codes of a linear color.
    pub(super) fn codes(&self, color: crate::color::Rgb) -> [u8; 3] {
        color.to_array().map(|value| self.display.code(value, 255) as u8)
    }
}
