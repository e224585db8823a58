//! Checkerboard behind transparent images.

use rayon::prelude::*;
use spherule_render::image::Image;

/// Side of a square in pixels.
const SQUARE: u32 = 12;

/// Gray values of the squares.
const GRAYS: [f32; 2] = [0x66 as f32, 0x99 as f32];

/// Blends an image of premultiplied colors over a checkerboard, in display values as browsers do. Returns
/// `0x00RRGGBB`, row by row.
pub(super) fn over_checkerboard(
    image: &Image,
    alpha: &[f32],
    code: impl Fn(f32) -> u8 + Sync,
) -> Vec<u32> {
    let square = |place: u32| place / SQUARE;
    let packed = |(row, (pixel, &alpha)): (usize, (&[f32; 3], &f32))| {
        let (x, y) = (row as u32 % image.width, row as u32 / image.width);
        let paper = GRAYS[((square(x) + square(y)) % 2) as usize];
        pixel.iter().fold(0, |packed, value| {
            let color = if alpha > 0.0 { f32::from(code(value / alpha)) } else { 0.0 };
            packed << 8 | (paper + alpha * (color - paper)).round() as u32
        })
    };
    image.pixels.par_iter().zip(alpha).enumerate().with_min_len(1 << 14).map(packed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opaque_pixels_keep_their_color_and_transparent_ones_are_squares() {
        let mut image = Image::filled(48, 2, [1.0, 0.0, 0.5]).unwrap();
        image.pixels[0] = [0.0; 3];
        let mut alpha = vec![1.0; 96];
        (alpha[0], alpha[12]) = (0.0, 0.0);
        let codes = over_checkerboard(&image, &alpha, |value| (value * 200.0) as u8);
        assert_eq!((codes[0], codes[12], codes[1]), (0x0066_6666, 0x0099_9999, 0x00C8_0064));
    }
}
