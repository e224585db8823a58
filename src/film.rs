//! Where samples become pixels: tiles of sums in double precision.
//!
//! Each pixel's samples are added up in the order of their index, by the one task that owns its
//! tile, so the sum does not depend on threads, on tile order, or on how the samples are divided
//! into passes. A filter that is sampled gives every sample weight 1: a pixel is the mean of its
//! own.

use crate::image::Image;
use crate::scene::Rgb;

/// Pixels along a tile's side.
pub const TILE: u32 = 16;

/// A rectangle of pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column, from the left.
    pub x: u32,
    /// First row, from the top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// The sums of all pixels of a region.
#[derive(Clone, Debug)]
pub struct Film {
    /// What part of the picture it is.
    pub region: Region,
    /// Its tiles, row by row.
    pub tiles: Vec<Tile>,
}

/// The sums of a square of pixels.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Where it is in the picture; smaller than [`TILE`] at the region's right and lower edge.
    pub region: Region,
    /// Sums of radiance, in the order of [`Tile::pixels`].
    sums: Vec<[f64; 3]>,
    /// Samples in each of the sums.
    pub samples: u32,
    /// What its camera rays may hit.
    pub view: View,
}

/// What camera rays of a tile may hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Anything.
    Anything,
    /// The ground and the environment, but no sphere.
    Background,
}

impl Film {
    /// Bytes that a film of so many pixels takes, and the picture that it becomes.
    pub fn bytes(region: Region) -> u64 {
        let pixel = size_of::<([f64; 3], [f32; 3])>() as u64;
        u64::from(region.width) * u64::from(region.height) * pixel
    }

    /// A black film.
    pub fn new(region: Region) -> Self {
        let steps = |first: u32, count: u32| {
            (first..first + count)
                .step_by(TILE as usize)
                .map(move |from| (from, TILE.min(first + count - from)))
        };
        let tiles = steps(region.y, region.height)
            .flat_map(|(y, height)| {
                steps(region.x, region.width).map(move |(x, width)| Region { x, y, width, height })
            })
            .map(Tile::new)
            .collect();
        Self { region, tiles }
    }

    /// The mean radiance of each pixel; black where there is no sample.
    pub fn resolve(&self) -> Image {
        let (width, height) = (self.region.width, self.region.height);
        let mut pixels = vec![[0.0; 3]; width as usize * height as usize];
        for tile in &self.tiles {
            let samples = f64::from(tile.samples.max(1));
            for ((x, y), sum) in tile.pixels().zip(&tile.sums) {
                let (column, row) = (x - self.region.x, y - self.region.y);
                let pixel = &mut pixels[row as usize * width as usize + column as usize];
                *pixel = sum.map(|channel| (channel / samples) as f32);
            }
        }
        Image { width, height, pixels }
    }
}

impl Tile {
    fn new(region: Region) -> Self {
        let pixels = region.width as usize * region.height as usize;
        Self { region, sums: vec![[0.0; 3]; pixels], samples: 0, view: View::Anything }
    }

    /// The pixels as columns and rows of the picture, along a Morton curve: the first four are a
    /// square, and so are the first sixteen.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let inside = |&(x, y): &(u32, u32)| x < self.region.width && y < self.region.height;
        (0..TILE * TILE)
            .map(|i| (even_bits(i), even_bits(i >> 1)))
            .filter(inside)
            .map(|(x, y)| (self.region.x + x, self.region.y + y))
    }

    /// Adds `count` samples of the same radiance, finite and not negative, to every pixel.
    pub fn add_even(&mut self, radiance: Rgb, count: u32) {
        for sum in &mut self.sums {
            for (sum, channel) in sum.iter_mut().zip(radiance.to_array()) {
                // Sums of so few equal numbers of single precision do not round.
                *sum += f64::from(channel) * f64::from(count);
            }
        }
        self.samples += count;
    }

    /// Adds `count` samples to every pixel: `radiance` holds those of the first pixel, then those
    /// of the next. Returns how many were negative or not finite: these count as black, and are
    /// told of in the statistics.
    pub fn add(&mut self, radiance: &[Rgb], count: u32) -> u64 {
        let mut bad = 0;
        for (sum, samples) in self.sums.iter_mut().zip(radiance.chunks_exact(count as usize)) {
            for sample in samples {
                let sound = sample.is_finite() && sample.min_element() >= 0.0;
                debug_assert!(sound, "{sample}");
                if sound {
                    for (sum, channel) in sum.iter_mut().zip(sample.to_array()) {
                        *sum += f64::from(channel);
                    }
                } else {
                    bad += 1;
                }
            }
        }
        self.samples += count;
        bad
    }
}

/// The bits of `i` at even places, side by side.
fn even_bits(i: u32) -> u32 {
    (0..16).fold(0, |bits, place| bits | (i >> (2 * place) & 1) << place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_hold_every_pixel_once_whatever_the_size() {
        for (width, height) in [(1, 1), (16, 16), (17, 1), (1, 40), (33, 50)] {
            let region = Region { x: 5, y: 7, width, height };
            let film = Film::new(region);
            let mut seen = vec![0; (width * height) as usize];
            for (x, y) in film.tiles.iter().flat_map(Tile::pixels) {
                seen[((y - 7) * width + x - 5) as usize] += 1;
            }
            assert!(seen.iter().all(|&count| count == 1), "{width} x {height}");
        }
    }

    #[test]
    fn films_of_any_size_are_measured() {
        let side = u32::from(u16::MAX);
        let region = Region { x: 0, y: 0, width: side, height: side };
        assert!(Film::bytes(region) > 150_000_000_000);
        let region = Region { width: u32::MAX, height: u32::MAX >> 6, ..region };
        assert!(Film::bytes(region) > 1 << 62);
    }

    #[test]
    fn packets_of_pixels_are_square() {
        let film = Film::new(Region { x: 0, y: 0, width: 16, height: 16 });
        let first: Vec<_> = film.tiles[0].pixels().take(16).collect();
        assert!(first.iter().all(|&(x, y)| x < 4 && y < 4));
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 2, height: 1 });
        let sample = |x: f32| Rgb::new(x, 2.0 * x, 0.0);
        film.tiles[0].add(&[sample(1.0), sample(2.0), sample(3.0), sample(5.0)], 2);
        film.tiles[0].add(&[sample(6.0), sample(1.0)], 1);
        assert_eq!(film.resolve().pixels, [[3.0, 6.0, 0.0], [3.0, 6.0, 0.0]]);
    }

    #[test]
    fn a_million_samples_do_not_stall() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 1, height: 1 });
        let block = vec![Rgb::splat(0.1); 1 << 12];
        for _ in 0..1 << 13 {
            film.tiles[0].add(&block, 1 << 12);
        }
        assert_eq!(film.resolve().pixels[0], [0.1; 3]);
    }
}
