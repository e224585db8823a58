//! Reading and writing of image files: the dispatch to codecs.

use super::channel::{self, ALPHA};
use super::{
    Channel, Format, Image, ImageError, Metadata, Values, WriteOptions, exr, pfm, png, ppm,
    radiance, raster,
};
use crate::{atomic, memory};
use std::fs::File;
use std::io::{self, Read};
use std::panic::catch_unwind;
use std::path::Path;

/// Maximum length of a file in bytes: more than an image of that many pixels takes in any format.
const MAX_BYTES: u64 = 1 << 33;

/// Message for a file on which a decoder panics.
const DAMAGED: &str = "the file is damaged; save it again";

/// Maximum length of a magic number.
const MAGIC_LENGTH: u64 = 16;

impl Image {
    /// Reads an image in any [`Format`], which is recognized by content, not by name.
    ///
    /// Integer codes are decoded by the sRGB curve; floats are linear already. Gray becomes RGB, and
    /// alpha is dropped without dividing by it. Of an EXR file the first part with channels `R`, `G`,
    /// `B`, or only `Y`, is read in its data window. Radiance values are divided by the header's
    /// `EXPOSURE`.
    ///
    /// # Errors
    /// [`ImageError::Read`] if the file cannot be read, [`ImageError::UnknownContent`] if its format is
    /// unknown, [`ImageError::Malformed`] if it is cut off, damaged, uses an unsupported feature, or
    /// claims more than 2^28 pixels in a compressed format.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ImageError> {
        let path = path.as_ref();
        let (format, bytes) = read_file(path)?;
        format.decode(&bytes).map_err(|reason| ImageError::malformed(path, format, reason))
    }

    /// Writes a file in one of [`Format::WRITTEN`], chosen by the suffix of `path` (in any case).
    ///
    /// EXR and PFM get the linear values unchanged, without exposure and tone, including NaN and
    /// infinity; the others get exposed, tone-mapped, sRGB-encoded codes. PFM has no metadata. The file
    /// is complete or absent: see [`atomic::write_atomically`].
    ///
    /// # Errors
    /// [`ImageError::UnknownSuffix`]; [`ImageError::Shape`] if size and pixels of the image are
    /// inconsistent; [`ImageError::Exposure`] and [`ImageError::Metadata`] for invalid options;
    /// [`ImageError::Encode`] if the format cannot store the picture; [`ImageError::Write`] if the file
    /// cannot be written.
    pub fn write(&self, path: impl AsRef<Path>, options: &WriteOptions) -> Result<(), ImageError> {
        self.write_layers(path, &[], options)
    }

    /// Writes an EXR file with channels in addition to `R`, `G` and `B`, or a file of another format
    /// that [has alpha](Format::has_alpha) with the channel `A`; without additional channels the same
    /// as [`Image::write`].
    ///
    /// With the alpha channel `A`, the image's colors are premultiplied. EXR stores them like this,
    /// the other formats store straight colors.
    ///
    /// # Errors
    /// Those of [`Image::write`]; [`ImageError::Layers`] for another format, and
    /// [`ImageError::Channel`] for a name that is invalid or in use, or a number of values that differs
    /// from the number of pixels.
    pub fn write_layers(
        &self,
        path: impl AsRef<Path>,
        channels: &[Channel],
        options: &WriteOptions,
    ) -> Result<(), ImageError> {
        let path = path.as_ref();
        let bytes = self.encode(Format::of_suffix(path)?, channels, options)?;
        atomic::write_atomically(path, |file| file.write_all(&bytes))
            .map_err(|reason| ImageError::Write { path: path.to_owned(), reason })
    }

    /// Returns the content of the file that [`Image::write_layers`] writes, in any writable format.
    ///
    /// # Errors
    /// Those of [`Image::write_layers`], except for those of the file itself.
    pub fn encode(
        &self,
        format: Format,
        channels: &[Channel],
        options: &WriteOptions,
    ) -> Result<Vec<u8>, ImageError> {
        self.check_shape()?;
        options.check()?;
        channel::check(channels, self.pixels.len())?;
        if !format.supports(channels) {
            return Err(ImageError::Layers { format });
        }
        format
            .encode(self, channels, options)
            .map_err(|reason| ImageError::Encode { format, reason })
    }
}

impl Format {
    /// Returns whether files of this format can store these channels.
    fn supports(self, channels: &[Channel]) -> bool {
        match (self, channels) {
            (Self::Exr, _) | (_, []) => true,
            (_, [Channel { name, values: Values::Floats(_) }]) => self.has_alpha() && name == ALPHA,
            _ => false,
        }
    }

    /// Decodes a whole file; the error says what is wrong with it.
    ///
    /// A decoder of another crate that panics on a damaged file (by integer overflow in a debug build,
    /// say) must not end the caller: the panic becomes an error too.
    pub(super) fn decode(self, bytes: &[u8]) -> Result<Image, String> {
        let decode: fn(&[u8]) -> Result<Image, String> = match self {
            Self::Exr => exr::decode,
            Self::Jpeg => raster::decode_jpeg,
            Self::Pfm => pfm::decode,
            Self::Png => png::decode,
            Self::Ppm => ppm::decode,
            Self::Radiance => radiance::decode,
            Self::Tiff => raster::decode_tiff,
            Self::Webp => raster::decode_webp,
        };
        catch_unwind(|| decode(bytes)).unwrap_or_else(|_| Err(DAMAGED.into()))
    }

    /// Encodes an image whose shape and options have been checked, with its channels if the format
    /// supports them.
    pub(super) fn encode(
        self,
        image: &Image,
        channels: &[Channel],
        options: &WriteOptions,
    ) -> Result<Vec<u8>, String> {
        match self {
            Self::Exr => exr::encode(image, channels, options),
            Self::Jpeg => raster::encode_jpeg(image, options),
            Self::Pfm => Ok(pfm::encode(image)),
            Self::Png => png::encode(image, alpha(channels), options),
            Self::Ppm => Ok(ppm::encode(image, options)),
            Self::Radiance => Err("Radiance HDR is only read".into()),
            Self::Tiff => raster::encode_tiff(image, alpha(channels), options),
            Self::Webp => raster::encode_webp(image, alpha(channels), options),
        }
    }
}

/// Returns the values of the alpha channel, if it exists.
fn alpha(channels: &[Channel]) -> Option<&[f32]> {
    channels.iter().find_map(|channel| match &channel.values {
        Values::Floats(values) if channel.name == ALPHA => Some(values.as_slice()),
        _ => None,
    })
}

/// Returns the format and the content of a file. Content of an unknown format is not read to its end,
/// nor content that is longer than any image or than the available memory.
pub(super) fn read_file(path: &Path) -> Result<(Format, Vec<u8>), ImageError> {
    let unreadable = |reason: io::Error| ImageError::Read { path: path.to_owned(), reason };
    let mut file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.by_ref().take(MAGIC_LENGTH).read_to_end(&mut bytes).map_err(unreadable)?;
    let format = Format::of_content(&bytes)
        .ok_or_else(|| ImageError::UnknownContent { path: path.to_owned() })?;
    // The buffer moves to twice as much memory while it grows.
    let limit = memory::left().map_or(MAX_BYTES, |left| MAX_BYTES.min(left.bytes / 3));
    bytes.append(&mut memory::read_at_most(file, limit).map_err(unreadable)?);
    Ok((format, bytes))
}

/// Checks whether [`Image::write`] could write `path`, without changing an existing file.
///
/// Intended for use before a long render. Writing may still fail later, for example on a full disk.
///
/// # Errors
/// [`ImageError::UnknownSuffix`], or [`ImageError::Write`] if the folder is missing or not writable, if
/// `path` is a folder, or if it is a file that must not be written.
pub fn check_writable(path: impl AsRef<Path>) -> Result<(), ImageError> {
    let path = path.as_ref();
    Format::of_suffix(path)?;
    atomic::check_destination(path)
        .map_err(|reason| ImageError::Write { path: path.to_owned(), reason })
}

/// Reads the metadata of an image file; PFM and Radiance HDR have none.
///
/// Entries are in file order; in a PNG file of another program all Latin-1 texts come first.
///
/// # Errors
/// [`ImageError::Read`], [`ImageError::UnknownContent`] and [`ImageError::Malformed`] as for
/// [`Image::read`], concerning headers.
pub fn read_metadata(path: impl AsRef<Path>) -> Result<Metadata, ImageError> {
    let path = path.as_ref();
    let (format, bytes) = read_file(path)?;
    let read = || match format {
        Format::Exr => exr::metadata(&bytes),
        Format::Jpeg => raster::jpeg_metadata(&bytes),
        Format::Png => png::metadata(&bytes),
        Format::Ppm => Ok(ppm::metadata(&bytes)),
        Format::Tiff => raster::tiff_metadata(&bytes),
        Format::Webp => raster::webp_metadata(&bytes),
        Format::Pfm | Format::Radiance => Ok(Metadata::new()),
    };
    // As for images: a decoder of another crate may panic.
    let read = catch_unwind(read).unwrap_or_else(|_| Err(DAMAGED.to_owned()));
    read.map_err(|reason| ImageError::malformed(path, format, reason))
}
