//! The sums of a square of pixels.

use super::{Probes, Region, Sums};
use crate::scene::Rgb;
use serde::{Deserialize, Serialize};

/// Pixels along a tile's side.
pub const TILE: u32 = 16;

/// The sums of a square of pixels.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Where it is in the picture; smaller than [`TILE`] at the region's right and lower edge.
    pub region: Region,
    /// Sums of radiance, in the order of [`Tile::pixels`].
    pub(super) sums: Sums,
    /// Samples in each of the sums.
    pub samples: u32,
    /// The surfaces that its camera rays may hit: all, or the background only.
    pub view: View,
    /// What tells how far the sums are from their limit; none unless that is measured.
    pub probes: Probes,
}

/// What camera rays of a tile may hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum View {
    /// Anything.
    Anything,
    /// The ground and the environment, but no sphere.
    Background,
}

impl Tile {
    /// A black tile; with sums of squares if `squared`.
    pub(super) fn new(region: Region, squared: bool) -> Self {
        let pixels = region.width as usize * region.height as usize;
        Self {
            region,
            sums: Sums::new(pixels, squared),
            samples: 0,
            view: View::Anything,
            probes: Probes::default(),
        }
    }

    /// The pixels as columns and rows of the picture, along a Morton curve: the first four are a
    /// square, and so are the first sixteen.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        self.region.morton()
    }

    /// Number of pixels.
    pub fn len(&self) -> u32 {
        self.region.width * self.region.height
    }

    /// Whether it has no pixels: never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds `count` samples of the same radiance, finite and not negative, to every pixel.
    pub fn add_even(&mut self, radiance: Rgb, count: u32) {
        self.sums.add_even(radiance, count);
        self.samples += count;
    }

    /// By which tiles of a film are in order.
    pub(super) fn place(&self) -> (u32, u32) {
        (self.region.y, self.region.x)
    }

    /// Adds other samples of the same pixels; whether they are of the same kinds.
    pub(super) fn merge(&mut self, other: &Self) -> bool {
        self.samples += other.samples;
        self.sums.merge(&other.sums) && self.probes.merge(&other.probes)
    }

    /// Adds `count` samples to every pixel: `radiance` holds those of the first pixel, then those
    /// of the next. Returns how many were negative or not finite: these count as black, and are
    /// told of in the statistics.
    pub fn add(&mut self, radiance: &[Rgb], count: u32) -> u64 {
        self.samples += count;
        self.sums.add(radiance, count)
    }
}

impl Region {
    /// The pixels of a region no larger than a tile, as [`Tile::pixels`] gives them.
    pub(crate) fn morton(self) -> impl Iterator<Item = (u32, u32)> {
        MORTON
            .iter()
            .map(|&[x, y]| (u32::from(x), u32::from(y)))
            .filter(move |&(x, y)| x < self.width && y < self.height)
            .map(move |(x, y)| (self.x + x, self.y + y))
    }
}

/// Columns and rows along a Morton curve.
static MORTON: [[u8; 2]; (TILE * TILE) as usize] = {
    let mut places = [[0; 2]; (TILE * TILE) as usize];
    let mut i = 0;
    while i < TILE * TILE {
        places[i as usize] = [even_bits(i) as u8, even_bits(i >> 1) as u8];
        i += 1;
    }
    places
};

/// The bits of `i` at even places, side by side.
const fn even_bits(i: u32) -> u32 {
    const fn close(bits: u32, width: u32, mask: u32) -> u32 {
        (bits | bits >> width) & mask
    }
    let bits = close(i & 0x5555_5555, 1, 0x3333_3333);
    let bits = close(bits, 2, 0x0f0f_0f0f);
    let bits = close(bits, 4, 0x00ff_00ff);
    close(bits, 8, 0x0000_ffff)
}
