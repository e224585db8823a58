//! JPEG, TIFF and WebP, by the crates of the `image` family: sRGB codes, with the metadata as XMP.
//!
//! JPEG has 8 bits and is lossy, depending on its quality; TIFF has 8 or 16 bits with lossless
//! compression; WebP has 8 bits and is lossless. TIFF and WebP support alpha. TIFF files of floats are
//! read as linear radiance.

use super::format::WEBP_SIDE;
use super::{
    Depth, Image, Metadata, WriteOptions, codes,
    format::{claimed_area, damaged},
    xmp,
};
use ::tiff::encoder::compression::DeflateLevel;
use ::tiff::encoder::{
    Compression, Predictor, Rational, TiffEncoder, TiffKind, TiffValue, colortype,
};
use ::tiff::tags::{ExtraSamples, ResolutionUnit, Tag};
use ::tiff::{TiffError, TiffResult};
use image::codecs::tiff::TiffDecoder;
use image::{ColorType, ImageDecoder, Limits};
use image_webp::{WebPDecoder, WebPEncoder};
use jpeg_encoder::{ColorType::Rgb, Encoder as JpegEncoder, PixelDensity, SamplingFactor};
use std::io::{Cursor, Write};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::options::DecoderOptions;

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

pub(super) fn decode_jpeg(bytes: &[u8]) -> Result<Image, String> {
    // The decoder replaces missing data by gray. Within a scan, 0xFF does not start an end marker.
    let last = |marker: [u8; 2]| bytes.windows(2).rposition(|pair| pair == marker);
    if last([0xFF, 0xD9]) < last([0xFF, 0xDA]) {
        return Err("its end is missing; the file is cut off: save it again".into());
    }
    let mut decoder = open_jpeg(bytes)?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    let area = claimed_area(width as u64, height as u64, PIXEL_BYTES)?;
    let mut samples = vec![0_u8; area * 3];
    decoder.decode_into(&mut samples).map_err(|error| damaged(&error))?;
    let pixels = codes::decode(&samples, 3, Depth::Eight);
    Ok(Image { width: width as u32, height: height as u32, pixels })
}

pub(super) fn decode_webp(bytes: &[u8]) -> Result<Image, String> {
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let (width, height) = decoder.dimensions();
    let area = claimed_area(width.into(), height.into(), PIXEL_BYTES)?;
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut samples = vec![0_u8; area * channels];
    decoder.read_image(&mut samples).map_err(|error| damaged(&error))?;
    Ok(Image { width, height, pixels: codes::decode(&samples, channels, Depth::Eight) })
}

pub(super) fn jpeg_metadata(bytes: &[u8]) -> Result<Metadata, String> {
    let decoder = open_jpeg(bytes)?;
    Ok(xmp::metadata(decoder.xmp().map_or(&[], Vec::as_slice)))
}

/// Reads the headers of a JPEG file. Its samples are red, green and blue, whatever they are in the file.
fn open_jpeg(bytes: &[u8]) -> Result<JpegDecoder<ZCursor<&[u8]>>, String> {
    let options = DecoderOptions::default().set_strict_mode(false);
    let options = options.set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| damaged(&error))?;
    Ok(decoder)
}

pub(super) fn tiff_metadata(bytes: &[u8]) -> Result<Metadata, String> {
    let packet = TiffDecoder::new(Cursor::new(bytes)).and_then(|mut file| file.xmp_metadata());
    Ok(xmp::metadata(&packet.map_err(|error| damaged(&error))?.unwrap_or_default()))
}

pub(super) fn webp_metadata(bytes: &[u8]) -> Result<Metadata, String> {
    let packet = WebPDecoder::new(Cursor::new(bytes)).and_then(|mut decoder| {
        // A length that the file only claims takes no memory.
        decoder.set_memory_limit(bytes.len());
        decoder.xmp_metadata()
    });
    Ok(xmp::metadata(&packet.map_err(|error| damaged(&error))?.unwrap_or_default()))
}

/// Decodes the first image: codes by the sRGB curve, floats unchanged. Alpha is dropped.
pub(super) fn decode_tiff(bytes: &[u8]) -> Result<Image, String> {
    let mut decoder = TiffDecoder::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
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

/// Encodes an image as JPEG, with a color for each pixel.
pub(super) fn encode_jpeg(image: &Image, options: &WriteOptions) -> Result<Vec<u8>, String> {
    let side = |side: u32| {
        let most = u16::MAX;
        side.try_into().map_err(|_| format!("{side} is more than {most} pixels on a side"))
    };
    let (width, height) = (side(image.width)?, side(image.height)?);
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new(&mut bytes, options.quality);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    if let Some(resolution) = options.resolution {
        encoder.set_density(PixelDensity::dpi(resolution.get()));
    }
    if let Some(segment) = xmp_segment(&options.metadata) {
        encoder.add_app_segment(1, segment).map_err(|error| error.to_string())?;
    }
    let codes = eight_bits(image, None, options);
    encoder.encode(&codes, width, height, Rgb).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Returns the segment of the metadata: as many of its first entries as fit into one.
fn xmp_segment(metadata: &Metadata) -> Option<Vec<u8>> {
    let mut entries: Vec<_> = metadata.iter().collect();
    loop {
        let fewer = entries.iter().map(|&(key, value)| (key.to_owned(), value.to_owned()));
        let packet = xmp::packet(&fewer.collect());
        if XMP_SEGMENT.len() + packet.len() <= MAX_SEGMENT {
            return (!packet.is_empty()).then(|| [XMP_SEGMENT, &packet].concat());
        }
        entries.pop();
    }
}

/// Encodes an image as TIFF, compressed by Deflate.
pub(super) fn encode_tiff(
    image: &Image,
    alpha: Option<&[f32]>,
    options: &WriteOptions,
) -> Result<Vec<u8>, String> {
    let codes = codes::encode(image, alpha, options);
    let mut bytes = Cursor::new(Vec::new());
    let written = if codes.len() * 2 > LARGE {
        TiffEncoder::new_big(&mut bytes)
            .and_then(|file| fill_tiff(file, image, alpha.is_some(), &codes, options))
    } else {
        TiffEncoder::new(&mut bytes)
            .and_then(|file| fill_tiff(file, image, alpha.is_some(), &codes, options))
    };
    written.map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

fn fill_tiff<K: TiffKind>(
    file: TiffEncoder<&mut Cursor<Vec<u8>>, K>,
    image: &Image,
    alpha: bool,
    codes: &[u16],
    options: &WriteOptions,
) -> TiffResult<()> {
    let mut file = file
        .with_compression(Compression::Deflate(DeflateLevel::Balanced))
        .with_predictor(Predictor::None);
    match options.depth {
        Depth::Eight => {
            let codes: Vec<u8> = codes.iter().map(|&code| code as u8).collect();
            fill_directory::<colortype::RGB8, K>(&mut file, image, alpha, &codes, options)
        }
        Depth::Sixteen => {
            fill_directory::<colortype::RGB16, K>(&mut file, image, alpha, codes, options)
        }
    }
}

fn fill_directory<C: colortype::ColorType, K: TiffKind>(
    file: &mut TiffEncoder<&mut Cursor<Vec<u8>>, K>,
    image: &Image,
    alpha: bool,
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
    if let Some(resolution) = options.resolution {
        directory.resolution(ResolutionUnit::Inch, Rational { n: resolution.get().into(), d: 1 });
    }
    let packet = xmp::packet(&options.metadata);
    if !packet.is_empty() {
        directory.encoder().write_tag(XMP_TAG, &packet[..])?;
    }
    directory.write_data(codes)
}

/// Encodes an image as WebP without loss.
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
