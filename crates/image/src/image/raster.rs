//! JPEG, TIFF and WebP, by the crates of the `image` family: sRGB codes, with the metadata as XMP.
//!
//! JPEG has 8 bits and is lossy, depending on its quality; TIFF has 8 or 16 bits with lossless
//! compression; WebP has 8 bits and is lossless. TIFF and WebP support alpha. TIFF files of floats are
//! read as linear radiance.

use super::{
    Depth, Image, Metadata, WriteOptions, codes,
    format::{claimed_area, damaged},
    xmp,
};
use ::tiff::encoder::compression::DeflateLevel;
use ::tiff::encoder::{Compression, Predictor, TiffEncoder, TiffKind, TiffValue, colortype};
use ::tiff::tags::{ExtraSamples, Tag};
use ::tiff::{TiffError, TiffResult};
use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::codecs::tiff::TiffDecoder;
use image::codecs::webp::WebPDecoder;
use image::{ColorType, ExtendedColorType, ImageDecoder, ImageResult, Limits};
use image_webp::WebPEncoder;
use std::io::{Cursor, Write};

/// Peak bytes per pixel while it is decoded: its samples twice, and three floats.
const PIXEL_BYTES: u64 = 16 + 16 + 12;

/// Bytes that a decoder may use in addition to those of its pixels.
const OTHER_BYTES: u64 = 1 << 24;

/// Minimum bytes of codes for which a TIFF file has offsets of 64 bits (`BigTIFF`).
const LARGE: usize = 1 << 31;

/// The tag of TIFF's XMP packet.
const XMP_TAG: Tag = Tag::Unknown(700);

/// The beginning of JPEG's segment with an XMP packet, and the maximum content of any segment.
const XMP_SEGMENT: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";
const MAX_SEGMENT: usize = 65_533;

/// The maximum width and height of a WebP file.
pub(super) const WEBP_SIDE: u32 = 16_384;

pub(super) fn decode_jpeg(bytes: &[u8]) -> Result<Image, String> {
    // The decoder replaces missing data by gray. Within a scan, 0xFF does not start an end marker.
    let last = |marker: [u8; 2]| bytes.windows(2).rposition(|pair| pair == marker);
    if last([0xFF, 0xD9]) < last([0xFF, 0xDA]) {
        return Err("its end is missing; the file is cut off: save it again".into());
    }
    decode(JpegDecoder::new(Cursor::new(bytes)))
}

pub(super) fn decode_tiff(bytes: &[u8]) -> Result<Image, String> {
    decode(TiffDecoder::new(Cursor::new(bytes)))
}

pub(super) fn decode_webp(bytes: &[u8]) -> Result<Image, String> {
    decode(WebPDecoder::new(Cursor::new(bytes)))
}

pub(super) fn jpeg_metadata(bytes: &[u8]) -> Result<Metadata, String> {
    metadata(JpegDecoder::new(Cursor::new(bytes)))
}

pub(super) fn tiff_metadata(bytes: &[u8]) -> Result<Metadata, String> {
    metadata(TiffDecoder::new(Cursor::new(bytes)))
}

pub(super) fn webp_metadata(bytes: &[u8]) -> Result<Metadata, String> {
    let packet = image_webp::WebPDecoder::new(Cursor::new(bytes)).and_then(|mut decoder| {
        // A length that the file only claims takes no memory.
        decoder.set_memory_limit(bytes.len());
        decoder.xmp_metadata()
    });
    Ok(xmp::metadata(&packet.map_err(|error| damaged(&error))?.unwrap_or_default()))
}

fn metadata(decoder: ImageResult<impl ImageDecoder>) -> Result<Metadata, String> {
    let packet = decoder.and_then(|mut decoder| decoder.xmp_metadata());
    Ok(xmp::metadata(&packet.map_err(|error| damaged(&error))?.unwrap_or_default()))
}

/// Decodes the first picture: codes by the sRGB curve, floats unchanged. Alpha is dropped.
fn decode(decoder: ImageResult<impl ImageDecoder>) -> Result<Image, String> {
    let mut decoder = decoder.map_err(|error| damaged(&error))?;
    let (width, height) = decoder.dimensions();
    let area = claimed_area(width.into(), height.into(), PIXEL_BYTES)?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(area as u64 * PIXEL_BYTES + OTHER_BYTES);
    decoder.set_limits(limits).map_err(|error| damaged(&error))?;
    let color = decoder.color_type();
    let channels = usize::from(color.channel_count());
    let pixels = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            let mut samples = vec![0_u8; area * channels];
            decoder.read_image(&mut samples).map_err(|error| damaged(&error))?;
            codes::decode(&samples, channels, Depth::Eight)
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let mut samples = vec![0_u16; area * channels];
            let bytes = bytemuck::cast_slice_mut(&mut samples);
            decoder.read_image(bytes).map_err(|error| damaged(&error))?;
            codes::decode(&samples, channels, Depth::Sixteen)
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            let mut samples = vec![0.0_f32; area * channels];
            let bytes = bytemuck::cast_slice_mut(&mut samples);
            decoder.read_image(bytes).map_err(|error| damaged(&error))?;
            samples.chunks_exact(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
        }
        other => return Err(format!("its samples are {other:?}; convert it to 8 or 16 bits")),
    };
    Ok(Image { width, height, pixels })
}

/// Encodes a picture as JPEG.
pub(super) fn encode_jpeg(image: &Image, options: &WriteOptions) -> Result<Vec<u8>, String> {
    let codes = eight_bits(image, None, options);
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, options.quality)
        .encode(&codes, image.width, image.height, ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())?;
    insert_xmp(&mut bytes, &options.metadata);
    Ok(bytes)
}

/// Inserts the metadata after the first segment of a JPEG file, which must stay the first; as many of
/// its first entries as fit into a segment.
fn insert_xmp(bytes: &mut Vec<u8>, metadata: &Metadata) {
    let mut packet = xmp::packet(metadata);
    let mut entries: Vec<_> = metadata.iter().collect();
    while XMP_SEGMENT.len() + packet.len() > MAX_SEGMENT {
        entries.pop();
        let fewer = entries.iter().map(|&(key, value)| (key.to_owned(), value.to_owned()));
        packet = xmp::packet(&fewer.collect());
    }
    let [_, _, 0xFF, 0xE0, high, low, ..] = bytes[..] else { return };
    if packet.is_empty() {
        return;
    }
    let at = 4 + usize::from(u16::from_be_bytes([high, low]));
    let length = (2 + XMP_SEGMENT.len() + packet.len()) as u16;
    let segment = [&[0xFF, 0xE1][..], &length.to_be_bytes(), XMP_SEGMENT, &packet].concat();
    bytes.splice(at..at, segment);
}

/// Encodes a picture as TIFF, compressed by Deflate.
pub(super) fn encode_tiff(
    image: &Image,
    alpha: Option<&[f32]>,
    options: &WriteOptions,
) -> Result<Vec<u8>, String> {
    let codes = codes::encode(image, alpha, options);
    let mut bytes = Cursor::new(Vec::new());
    let written = if codes.len() * 2 > LARGE {
        TiffEncoder::new_big(&mut bytes)
            .and_then(|file| fill_tiff(file, (image, alpha.is_some()), &codes, options))
    } else {
        TiffEncoder::new(&mut bytes)
            .and_then(|file| fill_tiff(file, (image, alpha.is_some()), &codes, options))
    };
    written.map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

fn fill_tiff<K: TiffKind>(
    file: TiffEncoder<&mut Cursor<Vec<u8>>, K>,
    (image, alpha): (&Image, bool),
    codes: &[u16],
    options: &WriteOptions,
) -> TiffResult<()> {
    let mut file = file
        .with_compression(Compression::Deflate(DeflateLevel::Balanced))
        .with_predictor(Predictor::None);
    match options.depth {
        Depth::Eight => {
            let codes: Vec<u8> = codes.iter().map(|&code| code as u8).collect();
            fill_directory::<colortype::RGB8, K>(&mut file, (image, alpha), &codes, options)
        }
        Depth::Sixteen => {
            fill_directory::<colortype::RGB16, K>(&mut file, (image, alpha), codes, options)
        }
    }
}

fn fill_directory<C: colortype::ColorType, K: TiffKind>(
    file: &mut TiffEncoder<&mut Cursor<Vec<u8>>, K>,
    (image, alpha): (&Image, bool),
    codes: &[C::Inner],
    options: &WriteOptions,
) -> Result<(), TiffError>
where
    [C::Inner]: TiffValue,
{
    let mut directory = file.new_image::<C>(image.width, image.height)?;
    if alpha {
        directory.extra_samples(&[ExtraSamples::UnassociatedAlpha])?;
    }
    let packet = xmp::packet(&options.metadata);
    if !packet.is_empty() {
        directory.encoder().write_tag(XMP_TAG, &packet[..])?;
    }
    directory.write_data(codes)
}

/// Encodes a picture as WebP without loss.
pub(super) fn encode_webp(
    image: &Image,
    alpha: Option<&[f32]>,
    options: &WriteOptions,
) -> Result<Vec<u8>, String> {
    let (width, height) = (image.width, image.height);
    if width.max(height) > WEBP_SIDE {
        return Err(format!("{width} x {height} is more than {WEBP_SIDE} pixels on a side"));
    }
    let codes = eight_bits(image, alpha, options);
    let color =
        if alpha.is_some() { image_webp::ColorType::Rgba8 } else { image_webp::ColorType::Rgb8 };
    let mut bytes = Vec::new();
    let mut encoder = WebPEncoder::new(&mut bytes as &mut dyn Write);
    encoder.set_xmp_metadata(xmp::packet(&options.metadata));
    encoder.encode(&codes, width, height, color).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Returns codes of 8 bits, regardless of the options.
fn eight_bits(image: &Image, alpha: Option<&[f32]>, options: &WriteOptions) -> Vec<u8> {
    let options = WriteOptions { depth: Depth::Eight, ..options.clone() };
    codes::encode(image, alpha, &options).into_iter().map(|code| code as u8).collect()
}
