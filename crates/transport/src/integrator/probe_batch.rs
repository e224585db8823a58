//! Batches of probes: which of the paths belong to which probe of which tile.

use std::ops::Range;

/// Samples of the probes of some tiles, as paths in this order: tile by tile, stream by stream, sample by
/// sample. Empty while other paths are traced.
///
/// Its records do not depend on the tiles that share a batch.
#[derive(Clone, Debug, Default)]
pub struct ProbeBatch {
    /// Samples of each stream.
    samples: Range<u32>,
    tiles: Vec<Streams>,
}

/// The streams of a tile's probes.
#[derive(Clone, Copy, Debug)]
struct Streams {
    /// Number of streams of the tiles before it.
    first: u32,
    /// Rays traced.
    rays: u64,
}

/// A sample of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ProbeSample {
    /// Number of the tile in the batch.
    pub tile: u32,
    /// Number of the stream in the tile.
    pub stream: u32,
    /// Index of the sample in the stream.
    pub sample: u32,
}

impl ProbeBatch {
    /// Returns a batch of these samples of each stream, with the number of streams of each tile.
    pub fn new(samples: Range<u32>, streams: impl Iterator<Item = usize>) -> Self {
        let mut first = 0;
        let tile = |streams: usize| {
            let tile = Streams { first, rays: 0 };
            first += streams as u32;
            tile
        };
        Self { samples, tiles: streams.map(tile).collect() }
    }

    /// Returns whether the paths are not those of probes.
    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }

    /// Returns the sample of a path.
    pub fn sample(&self, path: u32) -> ProbeSample {
        let count = self.samples.len() as u32;
        let stream = path / count;
        let tile = self.tile(stream);
        let first = self.tiles[tile].first;
        let sample = self.samples.start + path % count;
        ProbeSample { tile: tile as u32, stream: stream - first, sample }
    }

    /// Counts a ray of each of these paths, if they are those of probes.
    pub fn count_rays(&mut self, paths: impl Iterator<Item = u32>) {
        if self.is_empty() {
            return;
        }
        let count = self.samples.len() as u32;
        for path in paths {
            let tile = self.tile(path / count);
            self.tiles[tile].rays += 1;
        }
    }

    /// Returns the number of counted rays of each tile.
    pub fn rays(&self) -> impl Iterator<Item = u64> + '_ {
        self.tiles.iter().map(|tile| tile.rays)
    }

    /// Returns the number of the tile that has a stream.
    fn tile(&self, stream: u32) -> usize {
        self.tiles.partition_point(|tile| tile.first <= stream) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_samples_of_streams_of_tiles() {
        let mut batch = ProbeBatch::new(8..11, [2, 0, 4].into_iter());
        let sample = |path| {
            let ProbeSample { tile, stream, sample } = batch.sample(path);
            (tile, stream, sample)
        };
        assert_eq!(
            [0, 2, 3, 6, 17].map(sample),
            [(0, 0, 8), (0, 0, 10), (0, 1, 8), (2, 0, 8), (2, 3, 10)]
        );
        batch.count_rays([0, 5, 6, 7, 17].into_iter());
        assert_eq!(batch.rays().collect::<Vec<_>>(), [2, 0, 3]);
        assert!(ProbeBatch::default().is_empty() && !batch.is_empty());
    }
}
