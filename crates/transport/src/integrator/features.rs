//! Features of camera rays, recorded while the picture's paths are followed.

use crate::film::FeatureSums;
use crate::ray::{Columns3, MISS};
use crate::world::World;
use std::ops::Range;

/// Sums of the features of a batch's camera rays, by pixel.
#[derive(Clone, Debug, Default)]
pub struct FeatureBatch {
    /// Number of samples of each pixel while camera rays are to be recorded; 0 afterwards.
    samples: usize,
    sums: Vec<FeatureSums>,
}

impl FeatureBatch {
    /// Has the next camera rays recorded, of which each pixel has `samples`, one after the other.
    pub fn begin(&mut self, samples: usize) {
        self.samples = samples;
        self.sums.clear();
    }

    /// Records the hits of rays and their surfaces' normals, if they are wanted; `coverage` is empty where bodies are opaque.
    pub(super) fn record(
        &mut self,
        world: &World,
        hits: &[u32],
        facing: &Columns3,
        coverage: &[f32],
    ) {
        let samples = std::mem::take(&mut self.samples);
        if samples == 0 {
            return;
        }
        let rows = (0..hits.len()).step_by(samples).map(|first| first..first + samples);
        self.sums.extend(rows.map(|rows| of_pixel(world, hits, facing, coverage, rows)));
    }

    /// Returns the sums of a range of the recorded pixels.
    pub fn sums(&self, pixels: Range<usize>) -> &[FeatureSums] {
        self.sums.get(pixels).unwrap_or_default()
    }
}

/// Returns the sums of the features of a pixel's rays.
fn of_pixel(
    world: &World,
    hits: &[u32],
    facing: &Columns3,
    coverage: &[f32],
    rows: Range<usize>,
) -> FeatureSums {
    let mut sums = FeatureSums::default();
    let mut first = rows.start;
    // Most pixels show one surface.
    for same in hits[rows].chunk_by(|a, b| a == b) {
        let rows = first..first + same.len();
        first = rows.end;
        if same[0] == MISS {
            continue;
        }
        let albedo = world.albedo(same[0]).to_array();
        let normal = [&facing.x, &facing.y, &facing.z].map(|column| &column[rows.clone()]);
        match coverage.get(rows) {
            None => sums.add_covered(albedo, normal),
            Some(coverages) => sums.add(albedo, normal, coverages),
        }
    }
    sums
}
