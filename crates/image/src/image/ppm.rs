//! PPM: the portable pixmap of Netpbm, plain (P3) and binary (P6), with sRGB codes.
//!
//! Implemented here because it is tiny, and because the codec of the `image` crate does not support
//! comments, which hold the metadata, and rounds codes of an unusual maximum to 8 or 16 bits. Netpbm
//! specifies the curve of Rec. 709; in practice programs write and show sRGB, as does this one.

use super::{
    Image, Metadata, PpmEncoding, WriteOptions, format::checked_area, netpbm::Words, tone,
};
use std::fmt::Write as _;

/// Decodes the first image of a file, and ignores further data.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let mut words = Words::after_magic(bytes);
    let width = words.number("the width", u32::MAX)?;
    let height = words.number("the height", u32::MAX)?;
    let maximum = words.number("the largest code", u32::from(u16::MAX))?;
    let maximum = u16::try_from(maximum).ok().filter(|&maximum| maximum > 0);
    let maximum = maximum.ok_or("the largest code is 0; give 1 to 65535")?;
    let plain = bytes.starts_with(b"P3");
    let sample_bytes = if plain || maximum > 255 { 2 } else { 1 };
    // A plain sample takes a digit and a separator, which the last one may omit.
    let available = if plain { words.remaining() } else { words.raster().len() };
    let area = checked_area(width.into(), height.into(), (available / (3 * sample_bytes)) as u64)?;
    let codes = if plain {
        plain_codes(&mut words, area * 3, maximum)?
    } else {
        binary_codes(&words.raster()[..area * 3 * sample_bytes], sample_bytes)
    };
    let pixels = colors(&codes, maximum)?;
    Ok(Image { width, height, pixels })
}

fn plain_codes(words: &mut Words<'_>, count: usize, maximum: u16) -> Result<Vec<u16>, String> {
    let code = |_| words.number("a code", maximum.into()).map(|code| code as u16);
    (0..count).map(code).collect()
}

fn binary_codes(raster: &[u8], sample_bytes: usize) -> Vec<u16> {
    match sample_bytes {
        1 => raster.iter().map(|&byte| byte.into()).collect(),
        _ => raster.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect(),
    }
}

fn colors(codes: &[u16], maximum: u16) -> Result<Vec<[f32; 3]>, String> {
    if let Some(code) = codes.iter().find(|&&code| code > maximum) {
        return Err(format!("code {code} is more than the maximum {maximum}; save it again"));
    }
    let table = tone::decode_table(maximum);
    let triples = codes.as_chunks::<3>().0.iter();
    Ok(triples.map(|triple| triple.map(|code| table[usize::from(code)])).collect())
}

/// Encodes an image; the metadata is in comments after the magic number.
pub(super) fn encode(image: &Image, options: &WriteOptions) -> Vec<u8> {
    let magic = match options.ppm {
        PpmEncoding::Plain => "P3",
        PpmEncoding::Binary => "P6",
    };
    let comments = options.metadata.to_lines("# ");
    let (width, height, maximum) = (image.width, image.height, options.depth.maximum());
    let header = format!("{magic}\n{comments}{width} {height}\n{maximum}\n");
    let codes = options.codes(&image.pixels);
    let raster = match options.ppm {
        PpmEncoding::Plain => plain_raster(&codes),
        PpmEncoding::Binary => options.depth.pack(codes.as_flattened()),
    };
    [header.into_bytes(), raster].concat()
}

/// Writes one pixel per line, which keeps lines shorter than the 70 characters of the specification.
fn plain_raster(codes: &[[u16; 3]]) -> Vec<u8> {
    let mut text = String::new();
    for [red, green, blue] in codes {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{red} {green} {blue}");
    }
    text.into_bytes()
}

/// Returns the comments between the magic number and the width of the form `# key: value`.
pub(super) fn metadata(bytes: &[u8]) -> Metadata {
    let lines = bytes.split(|&byte| byte == b'\n').skip(1);
    let comments = lines.map_while(|line| line.strip_prefix(b"#"));
    let texts: Vec<_> = comments.map(String::from_utf8_lossy).collect();
    Metadata::from_lines(texts.iter().map(|text| text.strip_prefix(' ').unwrap_or(text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Depth, tests::ramp};

    fn options(depth: Depth, ppm: PpmEncoding) -> WriteOptions {
        WriteOptions { depth, ppm, ..WriteOptions::default() }
    }

    #[test]
    fn tiny_files_have_these_bytes() {
        let image =
            Image::new(2, 1, vec![[0.0, 0.5, 1.0], [-1.0, f32::NAN, f32::INFINITY]]).unwrap();
        let mut binary = options(Depth::Eight, PpmEncoding::Binary);
        binary.metadata.push("seed", "7");
        assert_eq!(encode(&image, &binary), b"P6\n# seed: 7\n2 1\n255\n\x00\xbc\xff\x00\x00\xff");
        let plain = options(Depth::Sixteen, PpmEncoding::Plain);
        assert_eq!(encode(&image, &plain), b"P3\n2 1\n65535\n0 48192 65535\n0 0 65535\n");
    }

    #[test]
    fn decoding_and_encoding_again_gives_the_same_file() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            for ppm in [PpmEncoding::Plain, PpmEncoding::Binary] {
                let options = options(depth, ppm);
                let bytes = encode(&ramp(7, 5), &options);
                assert_eq!(encode(&decode(&bytes).unwrap(), &options), bytes);
            }
        }
    }

    #[test]
    fn comments_and_any_maximum_are_read() {
        let white = Image::filled(1, 1, [1.0; 3]).unwrap();
        for bytes in [
            &b"P3 # by hand\n1#\n1\n#\n1000 1000 1000\n1000"[..],
            b"P6\n#a\n1 1 # b\n7\n\x07\x07\x07",
            b"P6 1 1 300\n\x01\x2c\x01\x2c\x01\x2c and another picture",
        ] {
            assert_eq!(decode(bytes), Ok(white.clone()));
        }
    }

    #[test]
    fn bad_files_are_refused() {
        for bytes in [
            &b"P6"[..],
            b"P6\n1 1\n255\n\0\0",
            b"P6\n0 1\n255\n",
            b"P6\n1 1\n0\n\0\0\0",
            b"P6\n1 1\n65536\n\0\0\0\0\0\0",
            b"P6\n1 1\n7\n\x08\0\0",
            b"P6\n4000000000 4000000000\n255\n\0\0\0",
            b"P3\n1 1\n255\n0 0",
            b"P3\n1 1\n255\n0 0 256",
            b"P3\n1 1\n255\n0 0 -1",
            b"P3\n4294967295 4294967295\n255\n0 0 0",
        ] {
            assert!(decode(bytes).is_err(), "{:?}", String::from_utf8_lossy(bytes));
        }
    }
}
