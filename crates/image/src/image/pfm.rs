//! PFM: the portable float map (Debevec, 2001), 32-bit floats without compression.
//!
//! Implemented here because it is a header of three lines before raw floats, which no dependency reads.
//! `PF` is RGB and `Pf` gray, rows go from bottom to top, and the sign of the scale gives the byte
//! order: negative for little-endian. The scale's magnitude has no agreed meaning and is ignored.

use super::{Image, format::checked_area, netpbm::Words};

/// Decodes a file of either type and byte order.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let mut words = Words::after_magic(bytes);
    let width = words.number("the width", u32::MAX)?;
    let height = words.number("the height", u32::MAX)?;
    let little_endian = scale(&mut words)? < 0.0;
    let float = if little_endian { f32::from_le_bytes } else { f32::from_be_bytes };
    let gray = bytes.starts_with(b"Pf");
    let pixel_bytes = if gray { 4 } else { 12 };
    let raster = words.raster();
    let area = checked_area(width.into(), height.into(), (raster.len() / pixel_bytes) as u64)?;
    let rows = raster[..area * pixel_bytes].chunks_exact(width as usize * pixel_bytes).rev();
    let pixels = if gray {
        rows.flat_map(|row| row.as_chunks().0).map(|&sample| [float(sample); 3]).collect()
    } else {
        let color = |sample: &[u8; 12]| {
            let channels = sample.as_chunks().0;
            std::array::from_fn(|channel| float(channels[channel]))
        };
        rows.flat_map(|row| row.as_chunks().0).map(color).collect()
    };
    Ok(Image { width, height, pixels })
}

fn scale(words: &mut Words<'_>) -> Result<f32, String> {
    let word = words.word().and_then(|word| str::from_utf8(word).ok());
    word.and_then(|word| word.parse().ok())
        .filter(|scale: &f32| scale.is_finite() && *scale != 0.0)
        .ok_or_else(|| "its scale is not a nonzero number; write -1.0 for little-endian".into())
}

/// Encodes an image as little-endian RGB.
pub(super) fn encode(image: &Image) -> Vec<u8> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", image.width, image.height).into_bytes();
    bytes.reserve_exact(image.pixels.len() * 12);
    for row in image.pixels.chunks_exact(image.width as usize).rev() {
        bytes.extend(row.iter().flatten().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::tests::ramp;

    #[test]
    fn tiny_files_have_these_bytes() {
        let image = Image::new(1, 2, vec![[1.0, 2.0, 0.0], [-1.0, 0.5, 4.0]]).unwrap();
        let golden = b"PF\n1 2\n-1.0\n\
            \0\0\x80\xbf\0\0\0\x3f\0\0\x80\x40\0\0\x80\x3f\0\0\0\x40\0\0\0\0";
        assert_eq!(encode(&image), golden);
    }

    #[test]
    fn every_value_survives_bit_by_bit() {
        let mut image = ramp(5, 3);
        image.pixels[3] = [f32::NAN, f32::NEG_INFINITY, -0.0];
        image.pixels[4] = [f32::MIN_POSITIVE / 2.0, f32::MAX, 1e-30];
        let back = decode(&encode(&image)).unwrap();
        let bits =
            |image: &Image| image.pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&image));
    }

    #[test]
    fn big_endian_and_gray_are_read_from_the_bottom_up() {
        let gray = decode(b"Pf\n1 2\n1.0\n\x3f\x80\0\0\x40\0\0\0").unwrap();
        assert_eq!(gray.pixels, vec![[2.0; 3], [1.0; 3]]);
        let little = decode(b"Pf 1 2 -0.5\n\0\0\x80\x3f\0\0\0\x40").unwrap();
        assert_eq!(little, gray);
        let color = decode(b"PF\n1 1\n1\n\x3f\x80\0\0\x40\0\0\0\0\0\0\0").unwrap();
        assert_eq!(color.pixels, vec![[1.0, 2.0, 0.0]]);
    }

    #[test]
    fn bad_files_are_refused() {
        for bytes in [
            &b"PF"[..],
            b"PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0",
            b"Pf\n1 1\n0\n\0\0\0\0",
            b"Pf\n1 1\nnan\n\0\0\0\0",
            b"Pf\n1 1\n\xff\n\0\0\0\0",
            b"Pf\n1 0\n1\n\0\0\0\0",
            b"PF\n4000000000 4000000000\n-1.0\n\0\0\0\0",
        ] {
            assert!(decode(bytes).is_err(), "{:?}", String::from_utf8_lossy(bytes));
        }
    }
}
