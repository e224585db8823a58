//! How a picture is written.

use super::tone::DisplayTransform;
use super::{ImageError, Metadata};
use crate::scene::Tone;

/// How [`Image::write`](super::Image::write) turns a picture into a file.
///
/// The default is what suits a preview: 8 bits, binary, no exposure, no tone curve, no metadata.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteOptions {
    /// Bits of each channel of PNG, PPM and TIFF; JPEG and WebP have 8, EXR and PFM are 32-bit floats.
    pub depth: Depth,
    /// Quality of JPEG, 1 to 100; the best has the largest files.
    pub quality: u8,
    /// The dialect of PPM.
    pub ppm: PpmEncoding,
    /// Stops, [`Settings::EXPOSURES`](crate::scene::Settings::EXPOSURES): formats of codes show the
    /// picture multiplied by 2 to this power.
    pub exposure: f64,
    /// From exposed radiance to display-linear values, for formats of codes.
    pub tone: Tone,
    /// Metadata of the file: PNG text chunks, PPM comments, the EXR attribute `comments`, XMP in
    /// JPEG, TIFF and WebP.
    pub metadata: Metadata,
}

/// Quality of JPEG files where nobody says another.
pub const QUALITY: u8 = 90;

/// Bits of each channel of a file with integer codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 8 bits, codes 0..=255.
    #[default]
    Eight,
    /// 16 bits, codes 0..=65535.
    Sixteen,
}

/// The two dialects of PPM.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PpmEncoding {
    /// P3: decimal numbers, a pixel per line.
    Plain,
    /// P6: bytes, the high one first where there are two.
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
            metadata: Metadata::default(),
        }
    }
}

impl WriteOptions {
    /// Refuses what no file can hold, whatever the format, so that options do not fail by suffix.
    pub(super) fn check(&self) -> Result<(), ImageError> {
        DisplayTransform::new(self.exposure, self.tone)?;
        self.metadata.check()
    }
}

impl Depth {
    /// The largest code: 255 or 65535.
    pub fn maximum(self) -> u16 {
        match self {
            Self::Eight => u16::from(u8::MAX),
            Self::Sixteen => u16::MAX,
        }
    }

    /// The bytes of samples in file order, the high byte first where there are two (PNG and PPM
    /// agree).
    pub(super) fn pack(self, codes: &[u16]) -> Vec<u8> {
        let codes = codes.iter();
        match self {
            Self::Eight => codes.map(|&code| code as u8).collect(),
            Self::Sixteen => codes.flat_map(|code| code.to_be_bytes()).collect(),
        }
    }
}
