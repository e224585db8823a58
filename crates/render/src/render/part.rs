//! Parts of an image, for rendering on several machines.

use crate::film::{Film, Region};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// A range of samples in a range of tiles: the work of one of several machines.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImagePart {
    /// Samples of each pixel, from 0.
    pub samples: Range<u32>,
    /// Tiles of the region, row by row, from 0.
    pub tiles: Range<u32>,
}

impl ImagePart {
    /// Returns the part that has all samples of all tiles.
    pub fn whole(region: Region, spp: u32) -> Self {
        Self { samples: 0..spp, tiles: 0..Film::tile_count(region) }
    }

    /// Returns the intersection of two parts, if it is not empty.
    pub fn common(&self, other: &Self) -> Option<Self> {
        let common = |a: &Range<u32>, b: &Range<u32>| a.start.max(b.start)..a.end.min(b.end);
        let samples = common(&self.samples, &other.samples);
        let tiles = common(&self.tiles, &other.tiles);
        (!samples.is_empty() && !tiles.is_empty()).then_some(Self { samples, tiles })
    }

    /// Returns the samples of one pixel of each tile, summed over tiles.
    pub fn size(&self) -> u64 {
        self.samples.len() as u64 * self.tiles.len() as u64
    }
}

/// Counts from 1, including the last.
impl fmt::Display for ImagePart {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { samples, tiles } = self;
        let describe = |range: &Range<u32>| match range.len() {
            1 => format!(" {}", range.end),
            _ => format!("s {} to {}", u64::from(range.start) + 1, range.end),
        };
        write!(formatter, "sample{} of tile{}", describe(samples), describe(tiles))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_counted_from_one() {
        let part = ImagePart { samples: 16..32, tiles: 3..4 };
        assert_eq!(part.to_string(), "samples 17 to 32 of tile 4");
        let whole = ImagePart::whole(Region { x: 0, y: 0, width: 33, height: 16 }, 1);
        assert_eq!(whole.to_string(), "sample 1 of tiles 1 to 3");
        assert_eq!(whole.size(), 3);
    }

    #[test]
    fn intersections_are_parts() {
        let a = ImagePart { samples: 0..8, tiles: 0..4 };
        let b = ImagePart { samples: 6..9, tiles: 2..9 };
        assert_eq!(a.common(&b), Some(ImagePart { samples: 6..8, tiles: 2..4 }));
        assert_eq!(a.common(&ImagePart { samples: 8..9, tiles: 0..4 }), None);
        assert_eq!(a.common(&ImagePart { samples: 0..8, tiles: 4..5 }), None);
    }
}
