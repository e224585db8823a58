//! PNG: sRGB codes of 8 or 16 bits, with the metadata in text chunks.

use super::{
    Depth, Image, Metadata, WriteOptions, codes,
    format::{claimed_area, damaged},
};
pub use ::png::Compression;
use ::png::{
    BitDepth, ColorType, Decoder, Encoder, EncodingError, Info, PixelDimensions, Reader,
    SrgbRenderingIntent, Transformations, Unit, chunk,
};
use spherule_codes::png::{Layout, compress};
use std::io::{self, Cursor};
use std::num::NonZeroU16;

/// Maximum compression ratio of Deflate (its longest match is 258 bytes in 2 bits).
const MAXIMUM_DEFLATE_RATIO: usize = 1032;

/// Maximum bytes of a chunk.
const MAXIMUM_CHUNK: usize = i32::MAX as usize;

/// Peak bytes per pixel while it is decoded: its samples twice, and three floats.
const PIXEL_BYTES: u64 = 8 + 8 + 12;

type MemoryReader<'a> = Reader<Cursor<&'a [u8]>>;

/// Decodes any color type and depth; the first image if there are several.
///
/// Codes are interpreted as sRGB, regardless of the chunks `gAMA`, `cHRM` and `iCCP`.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let mut reader = open(bytes)?;
    let info = reader.info();
    let (width, height) = info.size();
    let area = claimed_area(width.into(), height.into(), PIXEL_BYTES)?;
    if info.raw_bytes() / MAXIMUM_DEFLATE_RATIO > bytes.len() {
        return Err("it is far too short for its size; the file is cut off: save it again".into());
    }
    let buffer_size = reader.output_buffer_size().ok_or("it is too large; make it smaller")?;
    let mut samples = vec![0; buffer_size];
    let frame = reader.next_frame(&mut samples).map_err(|error| damaged(&error))?;
    samples.truncate(frame.buffer_size());
    let channels = frame.color_type.samples();
    let pixels = match frame.bit_depth {
        BitDepth::Sixteen => {
            let samples: Vec<_> =
                samples.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect();
            codes::decode(&samples, channels, Depth::Sixteen)
        }
        _ => codes::decode(&samples, channels, Depth::Eight),
    };
    if pixels.len() != area {
        return Err("its first frame does not fill its size; export a single picture".into());
    }
    Ok(Image { width, height, pixels })
}

fn open(bytes: &[u8]) -> Result<MemoryReader<'_>, String> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    // Converts palettes to RGB, and 1, 2 and 4 bits of gray to 8.
    decoder.set_transformations(Transformations::EXPAND);
    decoder.read_info().map_err(|error| damaged(&error))
}

/// Returns the text chunks before the pixels.
pub(super) fn metadata(bytes: &[u8]) -> Result<Metadata, String> {
    let reader = open(bytes)?;
    let info = reader.info();
    let latin = info
        .uncompressed_latin1_text
        .iter()
        .map(|chunk| Ok((chunk.keyword.clone(), chunk.text.clone())));
    // Decompression is bounded by the crate's default limit, which the plain getter does not apply.
    let compressed = info.compressed_latin1_text.iter().cloned().map(|mut chunk| {
        chunk.decompress_text()?;
        chunk.get_text().map(|text| (chunk.keyword, text))
    });
    let unicode = info.utf8_text.iter().cloned().map(|mut chunk| {
        chunk.decompress_text()?;
        chunk.get_text().map(|text| (chunk.keyword, text))
    });
    latin
        .chain(compressed)
        .chain(unicode)
        .collect::<Result<_, _>>()
        .map_err(|error| damaged(&error))
}

/// Encodes an image as RGB, or as RGBA with alpha: then the image's colors are premultiplied, and
/// the file's are not.
pub(super) fn encode(
    image: &Image,
    alpha: Option<&[f32]>,
    options: &WriteOptions,
) -> Result<Vec<u8>, String> {
    let mut info = Info::with_size(image.width, image.height);
    info.pixel_dims = options.resolution.map(pixels_per_meter);
    let samples = options.depth.pack(&codes::encode(image, alpha, options));
    info.color_type = if alpha.is_some() { ColorType::Rgba } else { ColorType::Rgb };
    info.bit_depth = match options.depth {
        Depth::Eight => BitDepth::Eight,
        Depth::Sixteen => BitDepth::Sixteen,
    };
    let pixel = info.bytes_per_pixel();
    let layout = Layout { row: image.width as usize * pixel, pixel };
    let stream = compress(samples, layout).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    write(&mut bytes, info, &options.metadata, &stream).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Inches per meter.
const INCHES: f64 = 1.0 / 0.0254;

/// Returns a number of pixels per inch as PNG has it.
fn pixels_per_meter(resolution: NonZeroU16) -> PixelDimensions {
    let pixels = (f64::from(resolution.get()) * INCHES).round() as u32;
    PixelDimensions { xppu: pixels, yppu: pixels, unit: Unit::Meter }
}

/// Returns the content of a PNG file of sRGB codes, three bytes per pixel, row by row.
///
/// # Errors
/// The number of codes is not that of the size.
pub fn encode_codes(
    codes: &[u8],
    size: (u32, u32),
    compression: Compression,
) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, size.0, size.1);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(compression);
    encoder.write_header()?.write_image_data(codes)?;
    Ok(file)
}

/// Writes the chunks of a file, whose compressed rows are `stream`.
fn write(
    bytes: &mut Vec<u8>,
    info: Info<'_>,
    metadata: &Metadata,
    stream: &[u8],
) -> Result<(), EncodingError> {
    let mut encoder = Encoder::with_info(bytes, info)?;
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    // More programs show tEXt. It supports only Latin-1, and entries keep their order only among chunks
    // of one type, so a single entry beyond Latin-1 makes all of them iTXt.
    let latin = metadata.iter().all(|(_, value)| value.chars().all(|c| u32::from(c) < 256));
    for (key, value) in metadata.iter() {
        if latin {
            encoder.add_text_chunk(key.into(), value.into())?;
        } else {
            encoder.add_itxt_chunk(key.into(), value.into())?;
        }
    }
    let mut writer = encoder.write_header()?;
    for part in stream.chunks(MAXIMUM_CHUNK) {
        writer.write_chunk(chunk::IDAT, part)?;
    }
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{tests::ramp, tone};

    /// Returns a file of `width` x 1 in any color type, written by the crate.
    fn file(width: u32, color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, width, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 255, 188, 0]);
            encoder.set_trns(vec![9]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn every_code_survives_both_depths() {
        for depth in [Depth::Eight, Depth::Sixteen] {
            let options = WriteOptions { depth, ..WriteOptions::default() };
            let table = tone::decode_table(depth.maximum());
            let pixels = table.into_iter().map(|value| [value, 0.0, 1.0]).collect();
            let image = Image::new(256, u32::from(depth.maximum()) / 256 + 1, pixels).unwrap();
            assert_eq!(decode(&encode(&image, None, &options).unwrap()), Ok(image));
        }
    }

    #[test]
    fn files_are_marked_as_srgb() {
        let bytes = encode(&ramp(3, 2), None, &WriteOptions::default()).unwrap();
        let reader = open(&bytes).unwrap();
        assert_eq!(reader.info().srgb, Some(SrgbRenderingIntent::RelativeColorimetric));
        assert_eq!(reader.info().size(), (3, 2));
    }

    #[test]
    fn every_color_type_is_read() {
        let half = srgb(188, 255);
        let amber = [1.0, half, 0.0];
        for (color, depth, data, expected) in [
            (ColorType::Grayscale, BitDepth::One, &b"\x40"[..], [[0.0; 3], [1.0; 3]]),
            (ColorType::Grayscale, BitDepth::Eight, b"\0\xbc", [[0.0; 3], [half; 3]]),
            (ColorType::Grayscale, BitDepth::Sixteen, b"\0\0\xbc\xbc", [[0.0; 3], [half; 3]]),
            (ColorType::GrayscaleAlpha, BitDepth::Eight, b"\0\x07\xff\0", [[0.0; 3], [1.0; 3]]),
            (ColorType::Rgb, BitDepth::Eight, b"\0\0\0\xff\xbc\0", [[0.0; 3], amber]),
            (ColorType::Rgba, BitDepth::Eight, b"\0\0\0\x07\xff\xbc\0\0", [[0.0; 3], amber]),
            (ColorType::Indexed, BitDepth::Two, b"\x10", [[0.0; 3], amber]),
        ] {
            let image = decode(&file(2, color, depth, data)).unwrap();
            assert_eq!(image.pixels, expected, "{color:?} {depth:?}");
        }
    }

    fn srgb(code: u16, maximum: u16) -> f32 {
        tone::decode_table(maximum)[usize::from(code)]
    }

    #[test]
    fn absurd_sizes_are_refused_before_allocation() {
        let bytes = file(1, ColorType::Rgb, BitDepth::Eight, b"\0\0\0");
        for (width, height) in [(u32::MAX >> 1, u32::MAX >> 1), (1 << 14, 1 << 14), (1, 0)] {
            assert!(decode(&with_size(&bytes, width, height)).is_err());
        }
    }

    /// Returns the file with another size in its header, and the matching checksum.
    fn with_size(bytes: &[u8], width: u32, height: u32) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let sum = bytes[12..29].iter().fold(!0_u32, |sum, &byte| {
            (0..8).fold(sum ^ u32::from(byte), |s, _| {
                (s >> 1) ^ (0xEDB8_8320 & (s & 1).wrapping_neg())
            })
        });
        bytes[29..33].copy_from_slice(&(!sum).to_be_bytes());
        bytes
    }
}
