//! Images of 8-bit display values, as large as a terminal shows them.

use spherule_render::image::Image;
use spherule_render::image::tone::Codes8;

/// An image of 8-bit display values.
pub(super) struct Codes {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Red, green and blue, row by row.
    pub(super) pixels: Vec<[u8; 3]>,
}

impl Codes {
    /// Converts an image to display values by a table, reduced to at most this many pixels.
    pub(super) fn of(image: &Image, table: &Codes8, [columns, rows]: [u32; 2]) -> Self {
        let (width, height) = (columns.min(image.width), rows.min(image.height));
        let code = |pixel: [f32; 3]| pixel.map(|value| table.code(value));
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels = pixels.map(|(x, y)| code(mean(image, x, y, width, height))).collect();
        Self { width, height, pixels }
    }
}

/// Mean radiance of the image over pixel (x, y) of a smaller one with `width` x `height` pixels.
fn mean(image: &Image, x: u32, y: u32, width: u32, height: u32) -> [f32; 3] {
    let range = |at: u32, small: u32, large: u32| {
        let edge = |at: u32| (u64::from(at) * u64::from(large) / u64::from(small)) as u32;
        edge(at)..edge(at + 1).max(edge(at) + 1)
    };
    let (columns, rows) = (range(x, width, image.width), range(y, height, image.height));
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for row in rows {
        for pixel in columns.clone().filter_map(|column| image.pixel(column, row)) {
            (0..3).for_each(|channel| sum[channel] += pixel[channel]);
            count += 1.0;
        }
    }
    sum.map(|value| value / f32::max(count, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_pictures_are_means() {
        let mut image = Image::filled(4, 2, [0.0; 3]).expect("a picture");
        (image.pixels[0], image.pixels[5]) = ([1.0; 3], [1.0, 0.0, 0.0]);
        assert_eq!(mean(&image, 0, 0, 2, 1), [0.5, 0.25, 0.25]);
        assert_eq!(mean(&image, 1, 0, 2, 1), [0.0; 3]);
        assert_eq!(mean(&image, 1, 1, 4, 2), [1.0, 0.0, 0.0]);
    }
}
