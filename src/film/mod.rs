//! Where samples become pixels: tiles of exact sums.
//!
//! Each pixel's samples are added up without rounding, so the sum does not depend on threads, on tile
//! order, or on how the samples are divided into passes and over machines. A filter that is sampled
//! gives every sample weight 1: a pixel is the mean of its own.

mod exact;
mod kept;
mod probes;
mod sums;
mod tile;

pub use exact::ExactSums;
pub(crate) use kept::KeptTile;
pub use probes::{Density, Pilot, Probes, Reading, Role};
pub use sums::Sums;
pub use tile::{TILE, Tile, View};

use crate::image::Image;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A rectangle of pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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

impl Film {
    /// Bytes that a film of so many pixels takes, at most, and the picture that it becomes; with sums
    /// of squares, and the variance that they become, if `squared`.
    pub fn bytes(region: Region, squared: bool) -> u64 {
        // More than two levels are rare.
        let (sums, picture) = (2 * size_of::<[f64; 3]>() as u64, size_of::<[f32; 3]>() as u64);
        let pixel = (sums + picture) * (1 + u64::from(squared));
        u64::from(region.width) * u64::from(region.height) * pixel
    }

    /// A black film; with sums of squares, which tell how samples spread, if `squared`.
    pub fn new(region: Region, squared: bool) -> Self {
        Self::with_tiles(region, 0..u32::MAX, squared)
    }

    /// The same of some of the region's tiles alone, by their numbers, row by row from 0.
    pub fn with_tiles(region: Region, tiles: Range<u32>, squared: bool) -> Self {
        let regions = Self::tile_regions(region).skip(tiles.start as usize).take(tiles.len());
        let tiles = regions.map(|region| Tile::new(region, squared)).collect();
        Self { region, tiles }
    }

    /// Where the tiles of a region are, row by row.
    pub(crate) fn tile_regions(region: Region) -> impl Iterator<Item = Region> {
        let steps = |first: u32, count: u32| {
            (first..first + count)
                .step_by(TILE as usize)
                .map(move |from| (from, TILE.min(first + count - from)))
        };
        steps(region.y, region.height).flat_map(move |(y, height)| {
            steps(region.x, region.width).map(move |(x, width)| Region { x, y, width, height })
        })
    }

    /// How many tiles a region of a picture has.
    pub fn tile_count(region: Region) -> u32 {
        region.width.div_ceil(TILE) * region.height.div_ceil(TILE)
    }

    /// Adds what a film of the same region has: other samples, other tiles, or both. Whether all that
    /// they have in common is of the same kind; if not, this film is of no use any more.
    pub fn merge(&mut self, other: Self) -> bool {
        let mut alike = self.region == other.region;
        let mut new = Vec::new();
        for tile in other.tiles {
            match self.tiles.binary_search_by_key(&tile.place(), Tile::place) {
                Ok(at) => alike &= self.tiles[at].merge(&tile),
                Err(_) => new.push(tile),
            }
        }
        self.tiles.append(&mut new);
        self.tiles.sort_by_key(Tile::place);
        alike
    }

    /// Puts black tiles without samples where there are none.
    pub fn fill(&mut self, squared: bool) {
        if self.tiles.len() < Self::tile_count(self.region) as usize {
            let mut missing = Self::new(self.region, squared).tiles;
            let there =
                |tile: &Tile| self.tiles.binary_search_by_key(&tile.place(), Tile::place).is_ok();
            missing.retain(|tile| !there(tile));
            self.tiles.append(&mut missing);
            self.tiles.sort_by_key(Tile::place);
        }
    }

    /// Tiles in a row of them.
    pub fn columns(&self) -> usize {
        self.region.width.div_ceil(TILE) as usize
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> u64 {
        u64::from(self.region.width) * u64::from(self.region.height)
    }

    /// Gives probes to the tiles that need them.
    pub fn place_probes(&mut self, density: Density, seed: u64, needed: impl Fn(&Tile) -> bool) {
        for tile in self.tiles.iter_mut().filter(|tile| needed(tile)) {
            tile.probes = Probes::new(tile, density, seed);
        }
    }

    /// The mean radiance over pixels and channels.
    pub fn mean(&self) -> f64 {
        let means = self.tiles.iter().flat_map(|tile| tile.sums.means(tile.samples));
        means.flatten().sum::<f64>() / (3.0 * self.pixels() as f64)
    }

    /// The mean radiance of each pixel; black where there is no sample.
    pub fn resolve(&self) -> Image {
        let radiance = |tile: &Tile| tile.sums.means(tile.samples).map(single).collect::<Vec<_>>();
        Image {
            width: self.region.width,
            height: self.region.height,
            pixels: self.gather([0.0; 3], radiance),
        }
    }

    /// Samples of each pixel, row by row.
    pub fn samples(&self) -> Vec<u32> {
        self.gather(0, |tile| vec![tile.samples; tile.len() as usize])
    }

    /// Variance of each pixel's mean, row by row and by channel: the variance of its samples over
    /// their number, times what `gain` says of its tile. All 0 without sums of squares.
    pub fn variance(&self, gain: impl Fn(usize) -> f64) -> Image {
        let gains: Vec<f64> = (0..self.tiles.len()).map(gain).collect();
        let mut tiles = gains.iter();
        let pixels = self.gather([0.0; 3], |tile| {
            let factor = tiles.next().copied().unwrap_or(1.0) / f64::from(tile.samples.max(1));
            let of_mean = |variance: [f64; 3]| single(variance.map(|channel| channel * factor));
            tile.sums.variances(tile.samples).map(of_mean).collect()
        });
        Image { width: self.region.width, height: self.region.height, pixels }
    }

    /// Puts what tiles say of their pixels into rows of the region.
    fn gather<T: Copy>(&self, empty: T, mut of_tile: impl FnMut(&Tile) -> Vec<T>) -> Vec<T> {
        let width = self.region.width as usize;
        let mut pixels = vec![empty; width * self.region.height as usize];
        for tile in &self.tiles {
            for ((x, y), value) in tile.pixels().zip(of_tile(tile)) {
                let (column, row) = (x - self.region.x, y - self.region.y);
                pixels[row as usize * width + column as usize] = value;
            }
        }
        pixels
    }
}

fn single(channels: [f64; 3]) -> [f32; 3] {
    channels.map(|channel| channel as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;

    #[test]
    fn tiles_hold_every_pixel_once_whatever_the_size() {
        for (width, height) in [(1, 1), (16, 16), (17, 1), (1, 40), (33, 50)] {
            let region = Region { x: 5, y: 7, width, height };
            let film = Film::new(region, false);
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
        assert!(Film::bytes(region, false) > 150_000_000_000);
        let region = Region { width: u32::MAX, height: u32::MAX >> 8, ..region };
        assert!(Film::bytes(region, true) > 1 << 62);
    }

    #[test]
    fn packets_of_pixels_are_square() {
        let film = Film::new(Region { x: 0, y: 0, width: 16, height: 16 }, false);
        let first: Vec<_> = film.tiles[0].pixels().take(16).collect();
        assert!(first.iter().all(|&(x, y)| x < 4 && y < 4));
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 2, height: 1 }, false);
        let sample = |x: f32| Rgb::new(x, 2.0 * x, 0.0);
        film.tiles[0].add(&[sample(1.0), sample(2.0), sample(3.0), sample(5.0)], 2);
        film.tiles[0].add(&[sample(6.0), sample(1.0)], 1);
        assert_eq!(film.resolve().pixels, [[3.0, 6.0, 0.0], [3.0, 6.0, 0.0]]);
    }

    #[test]
    fn a_million_samples_do_not_stall() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 1, height: 1 }, false);
        let block = vec![Rgb::splat(0.1); 1 << 12];
        for _ in 0..1 << 13 {
            film.tiles[0].add(&block, 1 << 12);
        }
        assert_eq!(film.resolve().pixels[0], [0.1; 3]);
    }
}
