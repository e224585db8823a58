//! Saving and restoring of films in files.

use super::exact::LEVELS;
use super::{ChanceLight, Density, ExactSums, Film, Pilot, Probes, Tile, View};
use serde::{Deserialize, Serialize};

/// The saved state of a tile, without its sums.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileHeader {
    /// Samples of each pixel.
    pub samples: u32,
    view: View,
    probed: bool,
    /// Samples of each probe.
    pub probe_samples: u32,
    /// Rays of the probes.
    pub probe_rays: u64,
    pilot: Option<Pilot>,
    chance: ChanceLight,
    /// Number of levels of each of its sums, in the order of [`Tile::columns`].
    levels: [u8; 4],
}

impl TileHeader {
    /// Returns whether the numbers are in range.
    pub fn is_valid(&self) -> bool {
        self.chance.is_valid()
            && self.levels.iter().all(|&levels| (1..=LEVELS).contains(&usize::from(levels)))
    }

    /// Returns the number of levels of its pixels' sums.
    pub fn levels(&self) -> u64 {
        self.levels[..2].iter().map(|&levels| u64::from(levels)).sum()
    }
}

impl Film {
    /// Returns the headers of all tiles.
    pub fn tile_headers(&self) -> Vec<TileHeader> {
        let header = |tile: &Tile| TileHeader {
            samples: tile.samples,
            view: tile.view,
            probed: tile.probes.streams() > 0,
            probe_samples: tile.probes.samples,
            probe_rays: tile.probes.rays,
            pilot: tile.probes.pilot,
            chance: tile.probes.chance.clone(),
            levels: tile.exact_sums().map(|sums| sums.levels().len() as u8),
        };
        self.tiles.iter().map(header).collect()
    }

    /// Restores all tiles, except for their sums. `headers` has one entry per tile.
    pub fn restore_tiles(&mut self, headers: &[TileHeader], seed: u64) {
        let density = Density::of(self.pixels());
        for (tile, header) in self.tiles.iter_mut().zip(headers) {
            (tile.samples, tile.view) = (header.samples, header.view);
            if header.probed {
                tile.probes = Probes::new(tile, density, seed);
            }
            tile.probes.samples = header.probe_samples;
            tile.probes.rays = header.probe_rays;
            tile.probes.pilot = header.pilot;
            tile.probes.chance = header.chance.clone();
            for (sums, levels) in tile.exact_sums_mut().into_iter().zip(header.levels) {
                sums.restore(levels.into());
            }
        }
    }
}

impl Tile {
    /// Returns all sums of the tile and of its probes, level by level and always in the same order.
    pub fn columns(&self) -> impl Iterator<Item = &[f64]> {
        self.exact_sums().into_iter().flat_map(ExactSums::levels).map(|level| level.as_flattened())
    }

    /// Returns the sums for filling, in the same order.
    pub fn columns_mut(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let levels = self.exact_sums_mut().into_iter().flat_map(ExactSums::levels_mut);
        levels.map(|level| level.as_flattened_mut())
    }

    fn exact_sums(&self) -> [&ExactSums; 4] {
        let ([a, b], [c, d]) = (self.sums.exact_sums(), self.probes.sums.exact_sums());
        [a, b, c, d]
    }

    fn exact_sums_mut(&mut self) -> [&mut ExactSums; 4] {
        let ([a, b], [c, d]) = (self.sums.exact_sums_mut(), self.probes.sums.exact_sums_mut());
        [a, b, c, d]
    }
}
