//! What is kept of a film outside the program, and a film made of it.

use super::{Density, Film, Pilot, Probes, Tile, View};
use serde::{Deserialize, Serialize};

/// What is kept of a tile besides its sums.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptTile {
    pub(crate) samples: u32,
    view: View,
    probed: bool,
    pub(crate) probe_samples: u32,
    pub(crate) probe_rays: u64,
    pilot: Option<Pilot>,
}

impl Film {
    /// What is kept of each tile besides its sums.
    pub(crate) fn kept_tiles(&self) -> Vec<KeptTile> {
        let kept = |tile: &Tile| KeptTile {
            samples: tile.samples,
            view: tile.view,
            probed: tile.probes.streams() > 0,
            probe_samples: tile.probes.samples,
            probe_rays: tile.probes.rays,
            pilot: tile.probes.pilot,
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
        }
    }
}

impl Tile {
    /// All sums of the tile and of its probes, in an order that is always the same.
    pub(crate) fn columns(&self) -> [&[f64]; 4] {
        let ([a, b], [c, d]) = (self.sums.columns(), self.probes.sums.columns());
        [a, b, c, d]
    }

    /// The same, to be filled.
    pub(crate) fn columns_mut(&mut self) -> [&mut [f64]; 4] {
        let ([a, b], [c, d]) = (self.sums.columns_mut(), self.probes.sums.columns_mut());
        [a, b, c, d]
    }
}
