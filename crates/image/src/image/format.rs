//! File formats: their names, their detection, and the size that files claim.

use super::ImageError;
use crate::memory;
use std::{fmt, path::Path};

/// Maximum number of pixels in a header if the file's length does not bound it: 3 GiB of floats.
const MAX_PIXELS: u64 = 1 << 28;

/// The maximum width and height of a WebP file.
pub(super) const WEBP_SIDE: u32 = 16_384;

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// `OpenEXR`: linear floats.
    Exr,
    /// JPEG: sRGB codes of 8 bits, with loss.
    Jpeg,
    /// Portable float map: linear floats, uncompressed.
    Pfm,
    /// Portable network graphics: sRGB codes of 8 or 16 bits.
    Png,
    /// Portable pixmap: sRGB codes, uncompressed.
    Ppm,
    /// Radiance HDR (RGBE): linear, read only.
    Radiance,
    /// TIFF: sRGB codes of 8 or 16 bits; floats, which are linear, are only read.
    Tiff,
    /// WebP: sRGB codes of 8 bits, written without loss.
    Webp,
}

/// Returns the suffix of a file's name in lower case, without its dot; empty if it has none.
pub(crate) fn suffix(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

impl Format {
    /// Formats that can be written, in the order of lists.
    pub const WRITTEN: [Self; 7] =
        [Self::Png, Self::Exr, Self::Jpeg, Self::Tiff, Self::Webp, Self::Pfm, Self::Ppm];

    /// Returns the suffixes of its files, in lower case and without the point; the preferred one first.
    pub fn suffixes(self) -> &'static [&'static str] {
        match self {
            Self::Exr => &["exr"],
            Self::Jpeg => &["jpg", "jpeg"],
            Self::Pfm => &["pfm"],
            Self::Png => &["png"],
            Self::Ppm => &["ppm"],
            Self::Radiance => &["hdr"],
            Self::Tiff => &["tif", "tiff"],
            Self::Webp => &["webp"],
        }
    }

    /// Returns the format's name in options, in lower case.
    pub fn option_name(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Jpeg => "jpeg",
            Self::Pfm => "pfm",
            Self::Png => "png",
            Self::Ppm => "ppm",
            Self::Radiance => "radiance",
            Self::Tiff => "tiff",
            Self::Webp => "webp",
        }
    }

    /// Returns the preferred suffixes of all writable formats, and others, as a list in a sentence: `.png, .exr or
    /// .jpg`.
    pub fn written_suffixes(others: &[&str]) -> String {
        let own = Self::WRITTEN.into_iter().map(|format| format.suffixes()[0]);
        list(own.chain(others.iter().copied()).map(|suffix| format!(".{suffix}")))
    }

    /// Returns the preferred suffixes of the writable formats with a property.
    pub fn list_suffixes(has: impl Fn(Self) -> bool) -> String {
        let formats = Self::WRITTEN.into_iter().filter(|format| has(*format));
        list(formats.map(|format| format!(".{}", format.suffixes()[0])))
    }

    /// Returns the names of all readable formats as a list in a sentence.
    pub fn read_names() -> String {
        list(Self::WRITTEN.into_iter().chain([Self::Radiance]).map(|format| format.to_string()))
    }

    /// Returns whether files store radiance itself, not codes for a display.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Exr | Self::Pfm | Self::Radiance)
    }

    /// Returns whether files may have codes of 16 bits.
    pub fn has_sixteen_bits(self) -> bool {
        matches!(self, Self::Png | Self::Ppm | Self::Tiff)
    }

    /// Returns whether files may have alpha.
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::Exr | Self::Png | Self::Tiff | Self::Webp)
    }

    /// Returns whether files may have the number of pixels per inch.
    pub fn has_resolution(self) -> bool {
        matches!(self, Self::Exr | Self::Jpeg | Self::Png | Self::Tiff)
    }

    /// Returns the maximum width and height of a file.
    pub fn largest_side(self) -> u32 {
        match self {
            Self::Webp => WEBP_SIDE,
            _ => u32::from(u16::MAX),
        }
    }

    /// Returns the format of a file by its first bytes, if it can be read.
    pub fn of_content(bytes: &[u8]) -> Option<Self> {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        let netpbm = bytes.get(2).is_some_and(|&byte| byte.is_ascii_whitespace() || byte == b'#');
        if starts(b"\x89PNG\r\n\x1a\n") {
            Some(Self::Png)
        } else if starts(b"\x76\x2f\x31\x01") {
            Some(Self::Exr)
        } else if starts(b"#?RADIANCE") || starts(b"#?RGBE") {
            Some(Self::Radiance)
        } else if starts(b"\xFF\xD8\xFF") {
            Some(Self::Jpeg)
        } else if [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].into_iter().any(|magic| starts(magic)) {
            Some(Self::Tiff)
        } else if starts(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
            Some(Self::Webp)
        } else if netpbm && (starts(b"PF") || starts(b"Pf")) {
            Some(Self::Pfm)
        } else if netpbm && (starts(b"P3") || starts(b"P6")) {
            Some(Self::Ppm)
        } else {
            None
        }
    }

    /// Returns the format of a file by the suffix of its name, in any case.
    ///
    /// # Errors
    /// [`ImageError::UnknownSuffix`] if the suffix belongs to no format in [`Format::WRITTEN`].
    pub fn of_suffix(path: &Path) -> Result<Self, ImageError> {
        let suffix = suffix(path);
        let mut formats = Self::WRITTEN.into_iter();
        formats
            .find(|format| format.suffixes().contains(&suffix.as_str()))
            .ok_or_else(|| ImageError::UnknownSuffix { path: path.to_owned(), others: &[] })
    }
}

/// Joins words: `a, b or c`.
fn list(items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    match items.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

impl fmt::Display for Format {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Exr => "EXR",
            Self::Jpeg => "JPEG",
            Self::Pfm => "PFM",
            Self::Png => "PNG",
            Self::Ppm => "PPM",
            Self::Radiance => "Radiance HDR",
            Self::Tiff => "TIFF",
            Self::Webp => "WebP",
        })
    }
}

/// Returns the number of pixels in a header, after checking that it is more than 0 and at most `limit`.
pub(super) fn checked_area(width: u64, height: u64, limit: u64) -> Result<usize, String> {
    match width.checked_mul(height) {
        Some(0) => Err(format!("its size of {width} x {height} has no pixels")),
        Some(area) if area <= limit => usize::try_from(area).map_err(|error| error.to_string()),
        _ => Err(format!(
            "its header claims {width} x {height} pixels, but at most {limit} are possible; the file is \
             cut off or damaged, or the picture too large: save it again, or smaller"
        )),
    }
}

/// Returns the number of pixels in a header if the file's length does not bound it, after checking that
/// there is memory for them: `bytes` per pixel while they are decoded.
pub(super) fn claimed_area(width: u64, height: u64, bytes: u64) -> Result<usize, String> {
    let area = checked_area(width, height, MAX_PIXELS)?;
    memory::check(bytes.saturating_mul(area as u64)).map_err(|shortage| {
        format!(
            "its header claims {width} x {height} pixels, which need {shortage}; the file is \
             damaged, or the picture too large: save it again, or smaller"
        )
    })?;
    Ok(area)
}

/// Formats the error of another crate's decoder, with a way to fix it.
pub(super) fn damaged(error: &dyn fmt::Display) -> String {
    format!("{error}; save the file again")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::codecs::read_file;
    use crate::image::{WriteOptions, tests::ramp};
    use proptest::prelude::*;

    const ALL: [Format; 7] = Format::WRITTEN;

    /// A file of 4 x 1 red pixels, in the old encoding without runs.
    pub(in crate::image) const RADIANCE: &[u8] =
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 4\n\
        \x80\0\0\x81\x80\0\0\x81\x80\0\0\x81\x80\0\0\x81";

    fn sample(format: Format) -> Vec<u8> {
        match format {
            Format::Radiance => RADIANCE.to_vec(),
            written => written.encode(&ramp(9, 5), &[], &WriteOptions::default()).unwrap(),
        }
    }

    #[test]
    fn suffixes_are_known_in_any_case_and_listed_when_unknown() {
        assert_eq!(Format::of_suffix(Path::new("a/b.ExR")).unwrap(), Format::Exr);
        for name in ["a.hdr", "a", ".png", "a.png~"] {
            let message = Format::of_suffix(Path::new(name)).unwrap_err().to_string();
            let suffixes = ALL.map(|format| format!(".{}", format.suffixes()[0]));
            for suffix in suffixes.iter().map(String::as_str).chain([name]) {
                assert!(message.contains(suffix), "{message}");
            }
        }
    }

    #[test]
    fn contents_are_recognized_by_their_magic() {
        for format in ALL.into_iter().chain([Format::Radiance]) {
            assert_eq!(Format::of_content(&sample(format)), Some(format));
        }
        for other in [&b"P5\n1 1\n255\n\0"[..], b"P33", b"Pf", b"GIF89a", b""] {
            assert_eq!(Format::of_content(other), None);
        }
    }

    #[test]
    fn unknown_content_and_missing_files_name_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text.png");
        std::fs::write(&path, "no picture").unwrap();
        for (path, word) in [(path, "known format"), (folder.path().join("gone.exr"), "gone.exr")] {
            let message = read_file(&path).unwrap_err().to_string();
            assert!(
                message.contains(word) && message.contains("convert") | message.contains("exists")
            );
        }
    }

    #[test]
    fn every_proper_prefix_of_a_file_is_an_error() {
        for format in ALL.into_iter().chain([Format::Radiance]) {
            let bytes = sample(format);
            assert!(format.decode(&bytes).is_ok(), "{format}");
            // The last chunk of a PNG only marks the end, which a decoder need not reach.
            let needed = if format == Format::Png { bytes.len() - 12 } else { bytes.len() };
            for length in 0..needed {
                assert!(format.decode(&bytes[..length]).is_err(), "{format} {length}");
            }
        }
    }

    #[test]
    fn a_decoder_that_panics_gives_an_error() {
        // Endless run-length markers overflow the run's length, which panics in debug builds.
        let head = &RADIANCE[..RADIANCE.len() - 12];
        let bytes = [head, &b"\x01\x01\x01\0".repeat(40)].concat();
        assert!(Format::Radiance.decode(&bytes).is_err());
    }

    #[test]
    fn areas_are_bounded() {
        assert_eq!(checked_area(3, 5, 15), Ok(15));
        assert!(checked_area(0, 5, 15).is_err());
        assert!(checked_area(4, 4, 15).is_err());
        assert!(checked_area(u64::MAX, 2, u64::MAX).is_err());
        assert_eq!(claimed_area(3, 5, 12), Ok(15));
        let message = claimed_area(1 << 14, 1 << 14, 1 << 40).unwrap_err();
        assert!(message.contains("16384 x 16384 pixels, which need"), "{message}");
    }

    proptest! {
        #[test]
        fn damage_gives_a_picture_of_the_claimed_size_or_an_error(
            format in prop::sample::select(vec![
                Format::Exr, Format::Pfm, Format::Png, Format::Ppm, Format::Radiance,
                Format::Jpeg, Format::Tiff, Format::Webp,
            ]),
            damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        ) {
            let mut bytes = sample(format);
            for (at, value) in damage {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            if let Ok(image) = format.decode(&bytes) {
                let area = u64::from(image.width) * u64::from(image.height);
                prop_assert_eq!(image.pixels.len() as u64, area);
            }
        }
    }
}
