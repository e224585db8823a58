//! Images: linear RGB in memory, and reading and writing of files.
//!
//! A render is an [`Image`] of linear radiance. [`Image::write`] writes it to a file: unchanged (EXR,
//! PFM), or exposed, tone-mapped and sRGB-encoded for a display (all others). [`Image::read`] is the
//! inverse, for environment maps and for [`compare()`]. Files are written atomically
//! ([`write_atomically`](crate::atomic::write_atomically)), and [`check_writable`] detects an unwritable destination before
//! hours are spent on the image.

mod channel;
mod codecs;
mod codes;
pub mod compare;
mod error;
mod exr;
mod format;
mod metadata;
mod netpbm;
mod options;
mod pfm;
mod png;
mod ppm;
mod radiance;
mod raster;
mod xmp;

pub use self::channel::{Channel, Values};
pub use self::codecs::{check_writable, read_metadata};
pub use self::compare::{CompareError, Comparison, Difference, compare};
pub use self::error::ImageError;
pub use self::format::Format;
#[cfg(feature = "drawing")]
pub(crate) use self::format::suffix;
pub use self::metadata::Metadata;
pub use self::options::{Depth, PpmEncoding, QUALITY, WriteOptions};
pub use self::png::{Compression, encode_codes};
pub use spherule_codes::tone;

use crate::memory;

/// An image in linear RGB with the primaries of sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels, 1 or more.
    pub width: u32,
    /// Height in pixels, 1 or more.
    pub height: u32,
    /// `width * height` triples (red, green, blue), row by row from the top left. Values of renders are
    /// 0 or more; files may have any, including NaN.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// Creates an image from pixels, row by row from the top left.
    ///
    /// # Errors
    /// [`ImageError::Shape`] if there are not exactly `width * height` pixels, or none at all.
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        let image = Self { width, height, pixels };
        image.check_shape()?;
        Ok(image)
    }

    /// Creates an image of one color.
    ///
    /// # Errors
    /// [`ImageError::Shape`] if `width` or `height` is 0, and [`ImageError::Memory`] if the pixels need
    /// more memory than there is.
    pub fn filled(width: u32, height: u32, color: [f32; 3]) -> Result<Self, ImageError> {
        let area = u64::from(width) * u64::from(height);
        let bytes = area.saturating_mul(size_of::<[f32; 3]>() as u64);
        let too_large = |shortage| ImageError::Memory { width, height, shortage };
        memory::check(bytes).map_err(|shortage| too_large(Some(shortage)))?;
        let count = usize::try_from(area).map_err(|_| too_large(None))?;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|_| too_large(None))?;
        pixels.resize(count, color);
        Self::new(width, height, pixels)
    }

    /// Returns the pixel in column `x` from the left and row `y` from the top; `None` outside of the
    /// image.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        let index = y as usize * self.width as usize + x as usize;
        if x < self.width { self.pixels.get(index).copied() } else { None }
    }

    /// Returns the number of values that are NaN or infinite: 0 for a valid render.
    ///
    /// PNG and PPM cannot store such values ([`tone::DisplayTransform`] maps them to codes), so callers
    /// that write an image can warn of them.
    pub fn count_non_finite(&self) -> u64 {
        self.pixels.iter().flatten().filter(|value| !value.is_finite()).count() as u64
    }

    fn check_shape(&self) -> Result<(), ImageError> {
        let area = u64::from(self.width) * u64::from(self.height);
        if area == 0 || area != self.pixels.len() as u64 {
            let (width, height, count) = (self.width, self.height, self.pixels.len());
            return Err(ImageError::Shape { width, height, count });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::tiff::decoder::ifd::Value;
    use ::tiff::tags::Tag;
    use std::fs;
    use std::num::NonZeroU16;

    /// An image of distinct values in 0..1.
    pub(super) fn ramp(width: u32, height: u32) -> Image {
        let count = width as usize * height as usize;
        let value = |index: usize| index as f32 / (3 * count) as f32;
        let pixels = (0..count).map(|i| [value(3 * i), value(3 * i + 1), value(3 * i + 2)]);
        Image::new(width, height, pixels.collect()).unwrap()
    }

    #[test]
    fn constructors_check_the_length() {
        assert!(Image::new(2, 3, vec![[0.0; 3]; 6]).is_ok());
        assert!(Image::new(2, 3, vec![[0.0; 3]; 5]).is_err());
        assert!(Image::new(0, 3, vec![]).is_err());
        assert!(Image::filled(4, 0, [1.0; 3]).is_err());
        for (width, height) in [(u32::MAX, u32::MAX), (u32::MAX, 1 << 30), (1 << 31, 1 << 31)] {
            let error = Image::filled(width, height, [1.0; 3]).expect_err("too large");
            assert!(matches!(error, ImageError::Memory { .. }), "{error}");
            assert!(error.to_string().contains(&width.to_string()), "{error}");
        }
        assert_eq!(Image::filled(2, 1, [1.0; 3]).unwrap().pixels, vec![[1.0; 3]; 2]);
    }

    #[test]
    fn pixels_are_found_and_non_finite_ones_counted() {
        let mut image = ramp(3, 2);
        assert_eq!(image.pixel(2, 1), Some(image.pixels[5]));
        assert_eq!(image.pixel(3, 0), None);
        assert_eq!(image.pixel(0, 2), None);
        image.pixels[1] = [f32::NAN, 1.0, f32::NEG_INFINITY];
        assert_eq!(image.count_non_finite(), 2);
    }

    #[test]
    fn every_format_survives_odd_sizes() {
        let folder = tempfile::tempdir().unwrap();
        for (width, height) in [(1, 1), (1, 7), (7, 1), (5, 3), (33, 17)] {
            let image = ramp(width, height);
            for (name, tolerance) in [
                ("a.exr", 0.0),
                ("a.PFM", 0.0),
                ("a.png", 0.01),
                ("a.ppm", 0.01),
                ("a.tif", 0.01),
                ("a.webp", 0.01),
                ("a.jpeg", 0.2),
            ] {
                let path = folder.path().join(name);
                image.write(&path, &WriteOptions::default()).unwrap();
                let back = Image::read(&path).unwrap();
                assert_eq!((back.width, back.height), (width, height));
                let error = compare(&back, &image).unwrap().max_difference.value;
                assert!(error <= tolerance, "{name} {width} x {height}: {error}");
            }
        }
    }

    #[test]
    fn resolutions_are_in_the_bytes_of_files() {
        for dpi in [1, 96, 300, 65_535_u16] {
            let resolution = NonZeroU16::new(dpi);
            let options = WriteOptions { resolution, ..WriteOptions::default() };
            let encoded = |format| ramp(3, 2).encode(format, &[], &options).unwrap();
            let after = |bytes: &[u8], word: &[u8]| {
                let at =
                    bytes.windows(word.len()).position(|own| own == word).expect("it is there");
                bytes[at + word.len()..].to_vec()
            };
            let png = after(&encoded(Format::Png), b"pHYs");
            let pixels = (f64::from(dpi) / 0.0254).round() as u32;
            assert_eq!(png[..9], [&pixels.to_be_bytes()[..], &pixels.to_be_bytes(), &[1]].concat());
            let jpeg = after(&encoded(Format::Jpeg), b"JFIF\0");
            // After the version, 1 stands for pixels per inch.
            assert_eq!(jpeg[2..7], [&[1][..], &dpi.to_be_bytes(), &dpi.to_be_bytes()].concat());
            let exr = after(&encoded(Format::Exr), b"xDensity\0float\0\x04\0\0\0");
            assert_eq!(exr[..4], f32::from(dpi).to_le_bytes());
            let tiff = std::io::Cursor::new(encoded(Format::Tiff));
            let mut tiff = ::tiff::decoder::Decoder::new(tiff).unwrap();
            assert_eq!(tiff.get_tag_u32(Tag::ResolutionUnit).unwrap(), 2);
            for tag in [Tag::XResolution, Tag::YResolution] {
                let number = tiff.get_tag(tag).unwrap();
                assert_eq!(number, Value::Rational(dpi.into(), 1));
            }
        }
        let plain = ramp(3, 2).encode(Format::Png, &[], &WriteOptions::default()).unwrap();
        assert!(!plain.windows(4).any(|word| word == b"pHYs"));
    }

    #[test]
    fn content_decides_the_format_and_not_the_suffix() {
        let folder = tempfile::tempdir().unwrap();
        let (true_name, other_name) = (folder.path().join("a.pfm"), folder.path().join("a.png"));
        ramp(3, 2).write(&true_name, &WriteOptions::default()).unwrap();
        fs::rename(true_name, &other_name).unwrap();
        assert_eq!(Image::read(&other_name).unwrap(), ramp(3, 2));
    }

    #[test]
    fn unwritable_destinations_are_detected_and_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let good = folder.path().join("good.png");
        assert!(check_writable(&good).is_ok());
        assert!(!good.exists());
        fs::write(&good, b"old").unwrap();
        assert!(check_writable(&good).is_ok());
        assert_eq!(fs::read(&good).unwrap(), b"old");
        for name in ["missing/a.png", "a.gif", "a", "good.png/a.exr"] {
            assert!(check_writable(folder.path().join(name)).is_err(), "{name}");
        }
        fs::create_dir(folder.path().join("folder.png")).unwrap();
        let message = check_writable(folder.path().join("folder.png")).unwrap_err().to_string();
        assert!(message.contains("folder.png") && message.contains("is a folder"), "{message}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn damaged_pictures_and_options_are_refused_before_the_file_is_touched() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let torn = Image { width: 2, height: 2, pixels: vec![[0.0; 3]; 3] };
        assert!(matches!(
            torn.write(&path, &WriteOptions::default()),
            Err(ImageError::Shape { .. })
        ));
        let dark = WriteOptions { exposure: f64::NAN, ..WriteOptions::default() };
        assert!(matches!(ramp(1, 1).write(&path, &dark), Err(ImageError::Exposure(_))));
        assert!(!path.exists());
    }
}
