//! Films in files: what is saved of each tile, and a film made from it.

use super::exact::LEVELS;
use super::{Density, ExactSums, Film, Pilot, Probes, Tile, View};
use serde::{Deserialize, Serialize};

/// Saved state of a tile besides its sums.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptTile {
    pub(crate) samples: u32,
    view: View,
    probed: bool,
    pub(crate) probe_samples: u32,
    pub(crate) probe_rays: u64,
    pilot: Option<Pilot>,
    /// Levels of each of its sums, in the order of [`Tile::columns`].
    levels: [u8; 4],
}

impl KeptTile {
    /// Whether it has as many levels of sums as there can be.
    pub(crate) fn is_sound(&self) -> bool {
        self.levels.iter().all(|&levels| (1..=LEVELS).contains(&usize::from(levels)))
    }

    /// Levels of sums of its pixels, all kinds taken together.
    pub(crate) fn levels(&self) -> u64 {
        self.levels[..2].iter().map(|&levels| u64::from(levels)).sum()
    }
}

impl Film {
    /// Saved state of each tile besides its sums.
    pub(crate) fn kept_tiles(&self) -> Vec<KeptTile> {
        let kept = |tile: &Tile| KeptTile {
            samples: tile.samples,
            view: tile.view,
            probed: tile.probes.streams() > 0,
            probe_samples: tile.probes.samples,
            probe_rays: tile.probes.rays,
            pilot: tile.probes.pilot,
            levels: tile.kept().map(|sums| sums.levels().len() as u8),
        };
        self.tiles.iter().map(kept).collect()
    }

    /// Makes all tiles what was kept, but for their sums. There are as many.
    pub(crate) fn restore_tiles(&mut self, kept: &[KeptTile], seed: u64) {
        let density = Density::of(self.pixels());
        for (tile, kept) in self.tiles.iter_mut().zip(kept) {
            (tile.samples, tile.view) = (kept.samples, kept.view);
            if kept.probed {
                tile.probes = Probes::new(tile, density, seed);
            }
            tile.probes.samples = kept.probe_samples;
            tile.probes.rays = kept.probe_rays;
            tile.probes.pilot = kept.pilot;
            for (sums, levels) in tile.kept_mut().into_iter().zip(kept.levels) {
                sums.restore(levels.into());
            }
        }
    }
}

impl Tile {
    /// All sums of the tile and of its probes, level by level and in an order that is always the same.
    pub(crate) fn columns(&self) -> impl Iterator<Item = &[f64]> {
        self.kept().into_iter().flat_map(ExactSums::levels).map(|level| level.as_flattened())
    }

    /// The film, to be filled.
    pub(crate) fn columns_mut(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let levels = self.kept_mut().into_iter().flat_map(ExactSums::levels_mut);
        levels.map(|level| level.as_flattened_mut())
    }

    fn kept(&self) -> [&ExactSums; 4] {
        let ([a, b], [c, d]) = (self.sums.kept(), self.probes.sums.kept());
        [a, b, c, d]
    }

    fn kept_mut(&mut self) -> [&mut ExactSums; 4] {
        let ([a, b], [c, d]) = (self.sums.kept_mut(), self.probes.sums.kept_mut());
        [a, b, c, d]
    }
}
