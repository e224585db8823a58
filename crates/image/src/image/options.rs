//! Options for writing images.

use super::tone::{self, DisplayTransform, Tone};
use super::{ImageError, Metadata};
use std::num::NonZeroU16;

/// Options of [`Image::write`](super::Image::write).
///
/// The default is a preview: 8 bits, binary, no exposure, no tone curve, no resolution, no metadata.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteOptions {
    /// Bits per channel of PNG, PPM and TIFF; JPEG and WebP have 8, EXR and PFM have 32-bit floats.
    pub depth: Depth,
    /// Quality of JPEG, 1 to 100; higher quality makes larger files.
    pub quality: u8,
    /// Variant of PPM.
    pub ppm: PpmEncoding,
    /// Exposure in stops, in [`EXPOSURES`](super::tone::EXPOSURES): formats of
    /// codes store the image times 2 to this power.
    pub exposure: f64,
    /// Tone curve from exposed radiance to display-linear values, for formats of codes.
    pub tone: Tone,
    /// Pixels per inch on paper, for formats that [have it](super::Format::has_resolution); `None` if it is
    /// not known.
    pub resolution: Option<NonZeroU16>,
    /// Metadata of the file: PNG text chunks, PPM comments, the EXR attribute `comments`, XMP in
    /// JPEG, TIFF and WebP.
    pub metadata: Metadata,
}

/// Default quality of JPEG files.
pub const QUALITY: u8 = 90;

/// Bits per channel of a file with integer codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 8 bits, codes 0..=255.
    #[default]
    Eight,
    /// 16 bits, codes 0..=65535.
    Sixteen,
}

/// A variant of PPM.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PpmEncoding {
    /// P3: decimal numbers, one pixel per line.
    Plain,
    /// P6: binary, the high byte first.
    #[default]
    Binary,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            depth: Depth::default(),
            quality: QUALITY,
            ppm: PpmEncoding::default(),
            exposure: 0.0,
            tone: Tone::Linear,
            resolution: None,
            metadata: Metadata::default(),
        }
    }
}

impl WriteOptions {
    /// Returns an error for values that no file can store, regardless of the format.
    pub(super) fn check(&self) -> Result<(), ImageError> {
        DisplayTransform::new(self.exposure, self.tone)
            .ok_or(ImageError::Exposure(self.exposure))?;
        self.metadata.check()
    }

    /// Returns the codes of pixels.
    pub(super) fn codes(&self, pixels: &[[f32; 3]]) -> Vec<[u16; 3]> {
        let transform = DisplayTransform::nearest(self.exposure, self.tone);
        tone::codes(pixels, transform, self.depth.maximum())
    }
}

impl Depth {
    /// Returns the largest code: 255 or 65535.
    pub fn maximum(self) -> u16 {
        match self {
            Self::Eight => u16::from(u8::MAX),
            Self::Sixteen => u16::MAX,
        }
    }

    /// Returns the bytes of samples in file order, the high byte first (in PNG and PPM).
    pub(super) fn pack(self, codes: &[u16]) -> Vec<u8> {
        let codes = codes.iter();
        match self {
            Self::Eight => codes.map(|&code| code as u8).collect(),
            Self::Sixteen => codes.flat_map(|code| code.to_be_bytes()).collect(),
        }
    }
}
