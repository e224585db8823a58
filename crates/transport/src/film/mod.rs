//! The film: tiles of exact sums, which accumulate samples into pixels.
//!
//! Each pixel's samples are added up without rounding, so that the sum does not depend on threads, on
//! tile order, or on the division of samples into passes and machines. By filter importance sampling
//! every sample has weight 1: a pixel is the mean of its own samples.

mod chance;
mod exact;
mod features;
mod pixel_features;
mod probes;
mod saved;
mod sums;
mod tile;

pub use chance::{ChanceLight, ChanceVariance, Term};
pub use exact::ExactSums;
pub use features::SAMPLES;
pub use features::{FeatureSums, MeanFeatures, SampleSet, TileFeatures};
pub use pixel_features::{Features, GROUND_PLANE, NOTHING};
pub use probes::{Density, Pilot, ProbePair, Probes, Reading, Role};
pub use saved::TileHeader;
pub use sums::Sums;
pub use tile::{PixelSamples, TILE, Tile, View};

use crate::image::Image;
use crate::settings::Settings;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::iter::repeat_n;
use std::ops::Range;

/// A rectangle of pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Region {
    /// First column, from the left.
    pub x: u32,
    /// First row, from the top.
    pub y: u32,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
}

/// An error of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RegionError {
    /// The region has no pixels, or more than a picture can have along an axis.
    #[error(
        "invalid region of {} x {} pixels at {}, {}: it must have pixels, and none beyond {most} along an axis",
        .0.width, .0.height, .0.x, .0.y, most = Settings::PIXELS.end()
    )]
    Size(Region),
    /// The region extends beyond its picture.
    #[error(
        "a region of {} x {} pixels at {}, {} is not in a picture of {width} x {height}",
        .region.width, .region.height, .region.x, .region.y
    )]
    Outside {
        /// The region.
        region: Region,
        /// Width of the picture in pixels.
        width: u32,
        /// Height of the picture in pixels.
        height: u32,
    },
}

impl Region {
    /// Checks that the region has pixels, and no more than a picture can have.
    ///
    /// # Errors
    /// [`RegionError::Size`].
    pub fn check(self) -> Result<Self, RegionError> {
        let most = *Settings::PIXELS.end();
        self.is_in(most, most).then_some(self).ok_or(RegionError::Size(self))
    }

    /// Checks that the region is inside of a picture of this size.
    ///
    /// # Errors
    /// The region is outside of the picture, or has no pixels.
    pub fn check_in(self, width: u32, height: u32) -> Result<Self, RegionError> {
        let region = self.check()?;
        let outside = RegionError::Outside { region, width, height };
        region.is_in(width, height).then_some(region).ok_or(outside)
    }

    /// Returns the number of pixels.
    pub fn area(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    fn is_in(self, width: u32, height: u32) -> bool {
        let fits = |first: u32, count: u32, most: u32| {
            count > 0 && u64::from(first) + u64::from(count) <= u64::from(most)
        };
        fits(self.x, self.width, width) && fits(self.y, self.height, height)
    }
}

/// The sums of all pixels of a region.
#[derive(Clone, Debug)]
pub struct Film {
    /// The region of the picture, in pixels.
    pub region: Region,
    /// Tiles, row by row.
    pub tiles: Vec<Tile>,
}

impl Film {
    /// Estimates the bytes of a film and of its resulting picture; if `squared`, with sums of squares,
    /// the resulting variance, and counts of samples.
    pub fn bytes(region: Region, squared: bool) -> u64 {
        // A second level of sums is rare, but squares nearly always have one.
        let (sums, picture) = (size_of::<[f64; 3]>() as u64, size_of::<[f32; 3]>() as u64);
        let pixel = sums + sums / 4 + picture;
        let squares = 2 * sums + picture + size_of::<u32>() as u64;
        let pixel = if squared { pixel + squares } else { pixel };
        (u64::from(region.width) * u64::from(region.height)).saturating_mul(pixel)
    }

    /// Creates a black film; with sums of squares, for the variance of samples, if `squared`.
    ///
    /// # Errors
    /// The region is invalid.
    pub fn new(region: Region, squared: bool) -> Result<Self, RegionError> {
        Ok(Self::with_tiles(region.check()?, 0..u32::MAX, squared))
    }

    /// Creates a black film with some of the tiles, by their numbers, row by row from 0, for a valid
    /// region.
    pub fn with_tiles(region: Region, tiles: Range<u32>, squared: bool) -> Self {
        let regions = Self::tile_regions(region).skip(tiles.start as usize).take(tiles.len());
        let regions: Vec<Region> = regions.collect();
        // New memory is slow, and less so if several threads get it.
        let tiles = regions.into_par_iter().map(|region| Tile::new(region, squared)).collect();
        Self { region, tiles }
    }

    /// Returns the regions of the tiles, row by row.
    pub fn tile_regions(region: Region) -> impl Iterator<Item = Region> {
        let steps = |first: u32, count: u32| {
            (first..first + count)
                .step_by(TILE as usize)
                .map(move |from| (from, TILE.min(first + count - from)))
        };
        steps(region.y, region.height).flat_map(move |(y, height)| {
            steps(region.x, region.width).map(move |(x, width)| Region { x, y, width, height })
        })
    }

    /// Returns the number of tiles of a region.
    pub fn tile_count(region: Region) -> u32 {
        region.width.div_ceil(TILE).saturating_mul(region.height.div_ceil(TILE))
    }

    /// Splits the pixels of a region, row by row, into the rows of its tiles.
    pub fn tile_rows<T>(region: Region, pixels: &mut [T]) -> impl Iterator<Item = Vec<&mut [T]>> {
        let width = region.width as usize;
        pixels.chunks_mut(width * TILE as usize).flat_map(move |band| {
            let mut tiles: Vec<Vec<&mut [T]>> = Vec::new();
            tiles.resize_with(width.div_ceil(TILE as usize), Vec::new);
            for row in band.chunks_mut(width) {
                let pieces = row.chunks_mut(TILE as usize);
                tiles.iter_mut().zip(pieces).for_each(|(tile, piece)| tile.push(piece));
            }
            tiles
        })
    }

    /// Adds the samples and tiles of a film of the same region. Returns false if the two are
    /// incompatible; then this film is unusable.
    pub fn merge(&mut self, other: Self) -> bool {
        let mut compatible = self.region == other.region;
        let mut new = Vec::new();
        for tile in other.tiles {
            match self.tiles.binary_search_by_key(&tile.position(), Tile::position) {
                Ok(at) => compatible &= self.tiles[at].merge(&tile),
                Err(_) => new.push(tile),
            }
        }
        self.tiles.append(&mut new);
        self.tiles.sort_by_key(Tile::position);
        compatible
    }

    /// Adds black tiles without samples where tiles are missing.
    pub fn fill(&mut self, squared: bool) {
        if self.tiles.len() < Self::tile_count(self.region) as usize {
            let mut missing = Self::with_tiles(self.region, 0..u32::MAX, squared).tiles;
            let exists = |tile: &Tile| {
                self.tiles.binary_search_by_key(&tile.position(), Tile::position).is_ok()
            };
            missing.retain(|tile| !exists(tile));
            self.tiles.append(&mut missing);
            self.tiles.sort_by_key(Tile::position);
        }
    }

    /// Returns the number of tiles in a row.
    pub fn columns(&self) -> usize {
        self.region.width.div_ceil(TILE) as usize
    }

    /// Returns the number of pixels.
    pub fn pixels(&self) -> u64 {
        self.region.area()
    }

    /// Gives probes to the tiles that need them.
    pub fn place_probes(
        &mut self,
        density: Density,
        seed: u64,
        mut needed: impl FnMut(&Tile) -> bool,
    ) {
        for tile in self.tiles.iter_mut().filter(|tile| needed(tile)) {
            tile.probes = Probes::new(tile, density, seed);
        }
    }

    /// Returns the mean radiance over pixels and channels.
    pub fn mean(&self) -> f64 {
        let of_tile = |tile: &Tile| tile.sums.means(tile.samples).flatten().sum::<f64>();
        // In the order of the tiles, so that the sum has the same bits for any number of threads.
        let sums: Vec<f64> = self.tiles.par_iter().map(of_tile).collect();
        sums.iter().sum::<f64>() / (3.0 * self.pixels() as f64)
    }

    /// Returns the mean radiance of each pixel; black without samples.
    pub fn resolve(&self) -> Image {
        self.resolve_in(Vec::new())
    }

    /// Does what [`Film::resolve`] does, in the memory of `pixels` if it has the right size: what the system has given
    /// already is faster.
    pub fn resolve_in(&self, mut pixels: Vec<[f32; 3]>) -> Image {
        let Region { width, height, .. } = self.region;
        let is_whole = self.tiles.len() == Self::tile_count(self.region) as usize;
        if pixels.len() as u64 != self.region.area() || !is_whole {
            pixels = vec![[0.0; 3]; self.region.area() as usize];
        }
        self.gather_in(&mut pixels, |_, tile| tile.sums.means(tile.samples).map(single));
        Image { width, height, pixels }
    }

    /// Returns the number of samples of each pixel, row by row.
    pub fn samples(&self) -> Vec<u32> {
        self.gather(0, |_, tile| repeat_n(tile.samples, tile.len() as usize))
    }

    /// Returns the variance of each pixel's mean, row by row and by channel: the variance of its
    /// samples over their number, times a gain. `gain` returns that of a tile as a function of the former, averaged over
    /// channels, or `None` to leave the tile out. All 0 without sums of squares.
    pub fn variance<G: Fn(f64) -> f64>(&self, gain: impl Fn(usize) -> Option<G> + Sync) -> Image {
        let pixels = self.gather([0.0; 3], |index, tile| {
            let count = f64::from(tile.samples.max(1));
            let of_mean = move |gain: &G, variance: [f64; 3]| {
                let independent = variance.map(|channel| channel / count);
                let factor = gain(independent.iter().sum::<f64>() / 3.0);
                single(independent.map(|channel| channel * factor))
            };
            let gain = gain(index);
            let variances = tile.sums.variances(tile.samples);
            variances.map_while(move |variance| gain.as_ref().map(|gain| of_mean(gain, variance)))
        });
        Image { width: self.region.width, height: self.region.height, pixels }
    }

    /// Gathers values of the tiles' pixels into rows of the region; `of_tile` gets a tile and its index.
    fn gather<'a, T, V>(&'a self, empty: T, of_tile: impl Fn(usize, &'a Tile) -> V + Sync) -> Vec<T>
    where
        T: Copy + Send + Sync,
        V: Iterator<Item = T>,
    {
        let mut pixels = vec![empty; self.region.area() as usize];
        self.gather_in(&mut pixels, of_tile);
        pixels
    }

    /// Does what [`Film::gather`] does; pixels without a tile keep their values.
    fn gather_in<'a, T, V>(
        &'a self,
        pixels: &mut [T],
        of_tile: impl Fn(usize, &'a Tile) -> V + Sync,
    ) where
        T: Send,
        V: Iterator<Item = T>,
    {
        let width = self.region.width as usize;
        // A band is the rows of a row of tiles.
        let bands = pixels.par_chunks_mut(width * TILE as usize).enumerate();
        bands.for_each(|(band, pixels)| {
            let top = self.region.y + band as u32 * TILE;
            let first = self.tiles.partition_point(|tile| tile.region.y < top);
            let tiles = self.tiles.iter().enumerate().skip(first);
            for (index, tile) in tiles.take_while(|(_, tile)| tile.region.y == top) {
                for ((x, y), value) in tile.pixels().zip(of_tile(index, tile)) {
                    let (column, row) = (x - self.region.x, y - top);
                    pixels[row as usize * width + column as usize] = value;
                }
            }
        });
    }
}

fn single(channels: [f64; 3]) -> [f32; 3] {
    channels.map(|channel| channel as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn tiles_hold_every_pixel_once_whatever_the_size() {
        for (width, height) in [(1, 1), (16, 16), (17, 1), (1, 40), (33, 50)] {
            let region = Region { x: 5, y: 7, width, height };
            let film = Film::new(region, false).unwrap();
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
        let endless = Region { x: u32::MAX, y: u32::MAX, width: u32::MAX, height: u32::MAX };
        assert_eq!(Film::bytes(endless, true), u64::MAX);
        assert_eq!(Film::tile_count(endless), u32::MAX);
    }

    #[test]
    fn invalid_regions_are_refused() {
        let region = |x, y, width, height| Region { x, y, width, height };
        for bad in [
            region(0, 0, 0, 5),
            region(0, 0, 5, 0),
            region(u32::MAX, 0, 2, 2),
            region(0, 65_535, 1, 1),
            region(0, 0, u32::MAX, u32::MAX),
        ] {
            assert_eq!(Film::new(bad, false).err(), Some(RegionError::Size(bad)));
            assert_eq!(bad.check_in(65_535, 65_535), Err(RegionError::Size(bad)));
        }
        assert!(region(65_534, 0, 1, 1).check().is_ok());
        let outside = region(6, 0, 3, 1);
        let error = RegionError::Outside { region: outside, width: 8, height: 8 };
        assert_eq!(outside.check_in(8, 8), Err(error));
        assert_eq!(outside.check_in(9, 1), Ok(outside));
    }

    #[test]
    fn packets_of_pixels_are_square() {
        let film = Film::new(Region { x: 0, y: 0, width: 16, height: 16 }, false).unwrap();
        let first: Vec<_> = film.tiles[0].pixels().take(16).collect();
        assert!(first.iter().all(|&(x, y)| x < 4 && y < 4));
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 2, height: 1 }, false).unwrap();
        let sample = |x: f32| Rgb::new(x, 2.0 * x, 0.0);
        film.tiles[0].add(&[sample(1.0), sample(2.0), sample(3.0), sample(5.0)], 2);
        film.tiles[0].add(&[sample(6.0), sample(1.0)], 1);
        assert_eq!(film.resolve().pixels, [[3.0, 6.0, 0.0], [3.0, 6.0, 0.0]]);
    }

    #[test]
    fn a_million_samples_do_not_stall() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 1, height: 1 }, false).unwrap();
        let block = vec![Rgb::splat(0.1); 1 << 12];
        for _ in 0..1 << 13 {
            film.tiles[0].add(&block, 1 << 12);
        }
        assert_eq!(film.resolve().pixels[0], [0.1; 3]);
    }
}
