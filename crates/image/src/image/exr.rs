//! EXR: linear 32-bit floats, compressed without loss.
//!
//! The metadata is written to the standard attribute `comments`, one line per entry: the encoder writes
//! several custom attributes in an order that changes from run to run, but equal images should be
//! equal files.

use super::{
    Channel, Image, Metadata, Values, WriteOptions,
    format::{claimed_area, damaged},
};
use ::exr::{
    meta::{
        MetaData,
        attribute::Text,
        header::{Header, LayerAttributes},
    },
    prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer, ReadChannels,
        ReadLayers, ReadSpecificChannel, SpecificChannels, Vec2, WritableImage, read,
    },
};
use std::io::Cursor;

/// Pixels of a file that is being read, with the row length.
struct Canvas {
    width: usize,
    pixels: Vec<[f32; 3]>,
}

impl Canvas {
    fn new(size: Vec2<usize>) -> Self {
        Self { width: size.width(), pixels: vec![[0.0; 3]; size.area()] }
    }

    fn set(&mut self, Vec2(x, y): Vec2<usize>, color: [f32; 3]) {
        self.pixels[y * self.width + x] = color;
    }

    fn into_image(self, size: Vec2<usize>) -> Result<Image, String> {
        let [width, height] = [size.width(), size.height()].map(u32::try_from);
        let (width, height) =
            width.and_then(|width| Ok((width, height?))).map_err(|e| e.to_string())?;
        Ok(Image { width, height, pixels: self.pixels })
    }
}

/// Decodes the first part that has the channels `R`, `G` and `B`, or else the first that has `Y`,
/// at its largest resolution. Half floats and integers are converted.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let meta = open(bytes)?;
    for header in &meta.headers {
        // A block of rows, compressed and decompressed, can be the whole image.
        let bytes = size_of::<[f32; 3]>() + 2 * header.channels.bytes_per_pixel;
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        claimed_area(width as u64, height as u64, bytes as u64)?;
    }
    let any_has = |names: &[&str]| meta.headers.iter().any(|header| has_channels(header, names));
    if any_has(&["R", "G", "B"]) {
        decode_rgb(bytes)
    } else if any_has(&["Y"]) && !any_has(&["RY"]) {
        decode_gray(bytes)
    } else {
        Err("it has neither the channels R, G and B nor only Y; export one of these".into())
    }
}

fn has_channels(header: &Header, names: &[&str]) -> bool {
    names.iter().all(|name| header.channels.list.iter().any(|channel| channel.name.eq(name)))
}

fn decode_rgb(bytes: &[u8]) -> Result<Image, String> {
    let channels = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |size, _| Canvas::new(size),
            |canvas: &mut Canvas, position, (r, g, b): (f32, f32, f32)| {
                canvas.set(position, [r, g, b]);
            },
        );
    decode_layer(bytes, channels.first_valid_layer())
}

fn decode_gray(bytes: &[u8]) -> Result<Image, String> {
    let channels = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("Y")
        .collect_pixels(
            |size, _| Canvas::new(size),
            |canvas: &mut Canvas, position, (y,): (f32,)| canvas.set(position, [y; 3]),
        );
    decode_layer(bytes, channels.first_valid_layer())
}

fn decode_layer<L, Names>(bytes: &[u8], layers: L) -> Result<Image, String>
where
    for<'s> L: ReadLayers<'s, Layers = Layer<SpecificChannels<Canvas, Names>>>,
{
    // A panic on damaged data can only be caught on this thread.
    let reader = layers.all_attributes().non_parallel();
    let file = reader.from_buffered(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let layer = file.layer_data;
    layer.channel_data.pixels.into_image(layer.size)
}

fn open(bytes: &[u8]) -> Result<MetaData, String> {
    MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| damaged(&error))
}

/// Returns the lines of the attribute `comments` of the form `key: value`.
pub(super) fn metadata(bytes: &[u8]) -> Result<Metadata, String> {
    let headers = open(bytes)?.headers;
    let comments = headers.first().and_then(|header| header.own_attributes.comments.as_ref());
    let text = String::from_utf8_lossy(comments.map_or(&[], |comments| comments.as_slice()));
    Ok(Metadata::from_lines(text.lines()))
}

/// Encodes an image as channels `R`, `G`, `B` of 32-bit floats, and additional channels.
pub(super) fn encode(
    image: &Image,
    channels: &[Channel],
    options: &WriteOptions,
) -> Result<Vec<u8>, String> {
    let WriteOptions { metadata, resolution, .. } = options;
    let color = |(i, name)| {
        let values = image.pixels.iter().map(|pixel| pixel[i]).collect();
        AnyChannel::new(name, FlatSamples::F32(values))
    };
    let colors = ["R", "G", "B"].into_iter().enumerate().map(color);
    let all = colors.map(Ok).chain(channels.iter().map(flat)).collect::<Result<_, String>>()?;
    let comments = metadata.to_lines("");
    let attributes = LayerAttributes {
        comments: (!metadata.is_empty()).then(|| Text::from_slice_unchecked(comments.as_bytes())),
        horizontal_density: resolution.map(|resolution| f32::from(resolution.get())),
        ..LayerAttributes::default()
    };
    let size = Vec2(image.width as usize, image.height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(all));
    let mut bytes = Cursor::new(Vec::new());
    ExrImage::from_layer(layer).write().to_buffered(&mut bytes).map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}

/// Converts a channel to the encoder's type.
fn flat(channel: &Channel) -> Result<AnyChannel<FlatSamples>, String> {
    let name = Text::new_or_none(&channel.name)
        .ok_or_else(|| format!("the channel {:?} has no valid name", channel.name))?;
    let samples = match &channel.values {
        Values::Floats(values) => FlatSamples::F32(values.clone()),
        Values::Integers(values) => FlatSamples::U32(values.clone()),
    };
    Ok(AnyChannel::new(name, samples))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::tests::ramp;
    use ::exr::prelude::{SmallVec, f16};

    /// Returns a file with channels of any name and type, written by the crate.
    fn file(size: (usize, usize), channels: Vec<(&str, FlatSamples)>) -> Vec<u8> {
        let channels = channels.into_iter().map(|(name, data)| AnyChannel::new(name, data));
        let channels = AnyChannels::sort(channels.collect::<SmallVec<_>>());
        let mut bytes = Cursor::new(Vec::new());
        ExrImage::from_channels(size, channels).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_value_survives_bit_by_bit_and_files_are_reproducible() {
        let mut image = ramp(19, 40);
        image.pixels[7] = [f32::NAN, f32::NEG_INFINITY, -0.0];
        image.pixels[8] = [f32::MIN_POSITIVE / 2.0, f32::MAX, 1e-30];
        let metadata: Metadata = (0..20).map(|i| (format!("key {i}"), "value".into())).collect();
        let options = WriteOptions { metadata, ..WriteOptions::default() };
        let bytes = encode(&image, &[], &options).unwrap();
        assert_eq!(encode(&image, &[], &options).unwrap(), bytes);
        let back = decode(&bytes).unwrap();
        let bits =
            |image: &Image| image.pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!((back.width, back.height), (19, 40));
        assert_eq!(bits(&back), bits(&image));
    }

    #[test]
    fn half_floats_alpha_and_gray_are_read() {
        let half = |values: [f32; 2]| FlatSamples::F16(values.map(f16::from_f32).to_vec());
        let full = |values: [f32; 2]| FlatSamples::F32(values.to_vec());
        let rgba = file(
            (2, 1),
            vec![
                ("A", half([0.5, 0.0])),
                ("R", half([1.0, 4.0])),
                ("G", full([2.0, 5.0])),
                ("B", FlatSamples::U32(vec![3, 6])),
            ],
        );
        assert_eq!(decode(&rgba).unwrap().pixels, vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        let gray = decode(&file((1, 2), vec![("Y", half([0.25, 7.0]))])).unwrap();
        assert_eq!(gray, Image { width: 1, height: 2, pixels: vec![[0.25; 3], [7.0; 3]] });
    }

    #[test]
    fn other_channels_are_refused_by_name() {
        let message = decode(&file((1, 1), vec![("Z", FlatSamples::F32(vec![1.0]))])).unwrap_err();
        assert!(message.contains("R, G and B"), "{message}");
    }

    #[test]
    fn absurd_sizes_are_refused_before_allocation() {
        let mut bytes = encode(&ramp(2, 2), &[], &WriteOptions::default()).unwrap();
        let name = b"dataWindow\0box2i\0\x10\0\0\0";
        let start =
            bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
        bytes[start + 8..start + 12].copy_from_slice(&0x3fff_fff0_i32.to_le_bytes());
        bytes[start + 12..start + 16].copy_from_slice(&0x3fff_fff0_i32.to_le_bytes());
        assert!(decode(&bytes).is_err());
    }
}
