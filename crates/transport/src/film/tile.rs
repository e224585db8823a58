//! Tiles: the sums of a square of pixels.

use super::{Probes, Region, Sums, TileFeatures};
use crate::color::Rgb;
use serde::{Deserialize, Serialize};

/// Pixels along a tile's side.
pub const TILE: u32 = 16;

/// The sums of a square of pixels.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Region of the picture; smaller than [`TILE`] at the right and lower edge.
    pub region: Region,
    /// Sums of radiance, in the order of [`Tile::pixels`].
    pub(super) sums: Sums,
    /// Number of samples in each of the sums.
    pub samples: u32,
    /// The surfaces that its camera rays may hit: all, or the background only.
    pub view: View,
    /// Probes for the estimate of the error; none unless it is measured.
    pub probes: Probes,
    /// Features of the samples that the render has recorded, if it does.
    pub(super) features: Option<TileFeatures>,
}

/// The surfaces that camera rays of a tile may hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum View {
    /// Anything.
    Anything,
    /// The ground and the environment, but no spheres.
    Background,
}

impl Tile {
    /// Creates a black tile; with sums of squares if `squared`.
    pub(super) fn new(region: Region, squared: bool) -> Self {
        let pixels = region.width as usize * region.height as usize;
        Self {
            region,
            sums: Sums::new(pixels, squared),
            samples: 0,
            view: View::Anything,
            probes: Probes::default(),
            features: None,
        }
    }

    /// Returns the pixels as columns and rows of the picture, along a Morton curve: the first four are
    /// a square, and so are the first sixteen.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        self.region.morton()
    }

    /// Returns the number of pixels.
    pub fn len(&self) -> u32 {
        self.region.width * self.region.height
    }

    /// Returns whether it has no pixels; no tile is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds `count` samples of the same radiance, finite and not negative, to every pixel.
    pub fn add_even(&mut self, radiance: Rgb, count: u32) {
        self.sums.add_even(radiance, count);
        self.samples += count;
    }

    /// Returns the position, by which tiles of a film are sorted.
    pub(super) fn position(&self) -> (u32, u32) {
        (self.region.y, self.region.x)
    }

    /// Adds other samples of the same pixels. Returns false if the tiles are incompatible.
    pub(super) fn merge(&mut self, other: &Self) -> bool {
        self.samples += other.samples;
        self.features = None;
        self.sums.merge(&other.sums) && self.probes.merge(&other.probes)
    }

    /// Adds `count` samples to every pixel: `radiance` holds those of the first pixel, then those of
    /// the next. Returns the number of samples that were negative or not finite, which count as black
    /// and are reported in the statistics.
    pub fn add(&mut self, radiance: &[Rgb], count: u32) -> u64 {
        self.samples += count;
        self.sums.add(radiance, count)
    }

    /// Adds `count` samples to every pixel, in the order of [`Tile::pixels`]; otherwise as [`Tile::add`].
    pub fn add_pixels<'a>(
        &mut self,
        count: u32,
        pixels: impl Iterator<Item = PixelSamples<'a>>,
    ) -> u64 {
        self.samples += count;
        let add = |(index, samples)| match samples {
            PixelSamples::Each(radiance) => self.sums.add_to(index, radiance),
            PixelSamples::Sums(total, squares) => {
                self.sums.add_exact(index, total, squares);
                0
            }
        };
        pixels.enumerate().map(add).sum()
    }
}

/// Samples of a pixel.
#[derive(Clone, Copy, Debug)]
pub enum PixelSamples<'a> {
    /// One by one.
    Each(&'a [Rgb]),
    /// Their exact sum, and the exact sum of their squares in two levels; they were finite and not negative.
    Sums([f64; 3], [[f64; 3]; 2]),
}

impl Region {
    /// Returns the pixels of a region no larger than a tile, in the order of [`Tile::pixels`].
    pub fn morton(self) -> impl Iterator<Item = (u32, u32)> {
        MORTON
            .iter()
            .map(|&[x, y]| (u32::from(x), u32::from(y)))
            .filter(move |&(x, y)| x < self.width && y < self.height)
            .map(move |(x, y)| (self.x + x, self.y + y))
    }
}

/// Columns and rows along a Morton curve.
static MORTON: [[u8; 2]; (TILE * TILE) as usize] = {
    let mut positions = [[0; 2]; (TILE * TILE) as usize];
    let mut i = 0;
    while i < TILE * TILE {
        positions[i as usize] = [even_bits(i) as u8, even_bits(i >> 1) as u8];
        i += 1;
    }
    positions
};

/// Returns the bits of `i` at even positions, packed.
const fn even_bits(i: u32) -> u32 {
    const fn close(bits: u32, width: u32, mask: u32) -> u32 {
        (bits | bits >> width) & mask
    }
    let bits = close(i & 0x5555_5555, 1, 0x3333_3333);
    let bits = close(bits, 2, 0x0f0f_0f0f);
    let bits = close(bits, 4, 0x00ff_00ff);
    close(bits, 8, 0x0000_ffff)
}
