//! Conversion of pixels to the sRGB codes of a file, with and without alpha, and back.

use super::{Depth, Image, WriteOptions, tone};

/// Decodes codes of 1 (gray) or 3 channels, or one more with alpha, which is dropped.
pub(super) fn decode<T: Copy + Into<usize>>(
    codes: &[T],
    channels: usize,
    depth: Depth,
) -> Vec<[f32; 3]> {
    let table = tone::decode_table(depth.maximum());
    let value = |code: T| table[code.into()];
    let color = |pixel: &[T]| match *pixel {
        [red, green, blue, ..] => [value(red), value(green), value(blue)],
        [gray, ..] => [value(gray); 3],
        [] => [0.0; 3],
    };
    codes.chunks_exact(channels).map(color).collect()
}

/// Returns the codes of an image, row by row: RGB, or RGBA with alpha. With alpha the image's colors
/// are premultiplied; the codes are not.
pub(super) fn encode(image: &Image, alpha: Option<&[f32]>, options: &WriteOptions) -> Vec<u16> {
    match alpha {
        None => options.codes(&image.pixels).into_flattened(),
        Some(alpha) => with_alpha(image, alpha, options).into_flattened(),
    }
}

/// Returns the codes of straight colors and of linear alpha.
fn with_alpha(image: &Image, alpha: &[f32], options: &WriteOptions) -> Vec<[u16; 4]> {
    let straight = |(pixel, &alpha): (&[f32; 3], &f32)| {
        if alpha > 0.0 { pixel.map(|value| value / alpha) } else { [0.0; 3] }
    };
    let colors: Vec<[f32; 3]> = image.pixels.iter().zip(alpha).map(straight).collect();
    let maximum = f32::from(options.depth.maximum());
    let alpha_code = |alpha: f32| (alpha.clamp(0.0, 1.0) * maximum).round() as u16;
    let codes = options.codes(&colors).into_iter().zip(alpha);
    codes.map(|([red, green, blue], &alpha)| [red, green, blue, alpha_code(alpha)]).collect()
}
