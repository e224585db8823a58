//! Parts of images as they are sent: JPEG files of rectangles.

use jpeg_encoder::{ColorType, Encoder};
use rayon::prelude::*;

/// Side of a tile in pixels: a multiple of the blocks of JPEG with subsampled color.
const SIDE: u32 = 128;

/// Maximum number of strips of an image, and minimum number of pixels of each: smaller ones take longer to pass to other
/// threads than to decode.
const STRIPS: u32 = 4;
const STRIP: u32 = 1 << 17;

/// Rows of a strip are a multiple of this.
const BLOCK: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

/// Divides an image into a few strips of all columns, as many as are encoded and decoded at a time.
pub(super) fn strips(width: u32, height: u32) -> Vec<Tile> {
    let count = (width * height / STRIP).clamp(1, STRIPS);
    let rows = height.div_ceil(count).next_multiple_of(BLOCK);
    let strip = |y: u32| Tile { x: 0, y, width, height: rows.min(height - y) };
    (0..height).step_by(rows as usize).map(strip).collect()
}

/// Returns the tiles in which two images of one size differ.
pub(super) fn changed(before: &[u32], now: &[u32], width: u32) -> Vec<Tile> {
    let height = now.len() as u32 / width.max(1);
    let columns = || (0..width).step_by(SIDE as usize);
    let all = (0..height)
        .step_by(SIDE as usize)
        .flat_map(|y| columns().map(move |x| (x, y)))
        .map(|(x, y)| Tile { x, y, width: SIDE.min(width - x), height: SIDE.min(height - y) });
    all.filter(|tile| tile.rows(width).any(|row| before[row.clone()] != now[row])).collect()
}

impl Tile {
    /// Ranges of its rows in an image of this width.
    fn rows(self, width: u32) -> impl Iterator<Item = std::ops::Range<usize>> {
        (self.y..self.y + self.height).map(move |y| {
            let first = y as usize * width as usize + self.x as usize;
            first..first + self.width as usize
        })
    }
}

/// Encodes tiles of an image whose pixels are `0x00RRGGBB`, with a quality from 1 to 100.
pub(super) fn encode(pixels: &[u32], width: u32, tiles: &[Tile], quality: u8) -> Vec<Vec<u8>> {
    let encode = |tile: &Tile| encode_tile(pixels, width, *tile, quality);
    match tiles {
        // Another thread would have to be woken.
        [tile] => vec![encode(tile)],
        _ => tiles.par_iter().map(encode).collect(),
    }
}

fn encode_tile(pixels: &[u32], width: u32, tile: Tile, quality: u8) -> Vec<u8> {
    let mut codes = Vec::with_capacity(4 * tile.width as usize * tile.height as usize);
    for row in tile.rows(width) {
        pixels[row].iter().for_each(|pixel| codes.extend_from_slice(&pixel.to_le_bytes()));
    }
    let mut file = Vec::new();
    // Sides of images are at most 16,384, and writing to memory does not fail.
    let size = (tile.width as u16, tile.height as u16);
    let encoded = Encoder::new(&mut file, quality).encode(&codes, size.0, size.1, ColorType::Bgra);
    debug_assert!(encoded.is_ok(), "{encoded:?}");
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_the_image_once() {
        let sizes =
            [((1280, 720), 4), ((640, 480), 2), ((400, 300), 1), ((1, 1), 1), ((16384, 16), 1)];
        for (size, count) in sizes {
            let strips = strips(size.0, size.1);
            let mut y = 0;
            for strip in &strips {
                assert_eq!((strip.x, strip.y, strip.width), (0, y, size.0));
                y += strip.height;
            }
            assert!(y == size.1 && strips.len() == count, "{size:?} {strips:?}");
        }
    }

    #[test]
    fn tiles_with_a_changed_pixel_are_sent() {
        let (width, height) = (300, 200);
        let before = vec![0; width * height];
        let mut now = before.clone();
        assert_eq!(changed(&before, &now, 300), []);
        (now[299], now[130 * width + 5]) = (1, 1);
        let tiles = changed(&before, &now, 300);
        let tile = |x, y, width, height| Tile { x, y, width, height };
        assert_eq!(tiles, [tile(256, 0, 44, 128), tile(0, 128, 128, 72)]);
    }

    #[test]
    fn tiles_are_files_of_their_pixels() {
        let pixels: Vec<u32> =
            (0..64 * 48).map(|i| if i % 64 < 32 { 0x00C0_4020 } else { 0x0010_80F0 }).collect();
        let tile = Tile { x: 32, y: 16, width: 32, height: 32 };
        let files = encode(&pixels, 64, &[tile], 90);
        let image = image::load_from_memory(&files[0]).expect("a JPEG file").to_rgb8();
        assert_eq!(image.dimensions(), (32, 32));
        let near = |pixel: &image::Rgb<u8>| {
            pixel.0.iter().zip([0x10, 0x80, 0xF0]).all(|(a, b)| a.abs_diff(b) < 6)
        };
        assert!(image.pixels().all(near), "{:?}", image.get_pixel(5, 5));
    }
}
