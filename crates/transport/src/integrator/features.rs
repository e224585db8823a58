//! Features of camera rays, recorded while the picture's paths are followed.

use super::workspace::Workspace;
use crate::film::FeatureSums;
use crate::ray::MISS;
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

    /// Returns the sums of a range of the recorded pixels.
    pub fn sums(&self, pixels: Range<usize>) -> &[FeatureSums] {
        self.sums.get(pixels).unwrap_or_default()
    }
}

/// Records the current rays' hits and surfaces, if they are wanted.
pub(super) fn record(world: &World, work: &mut Workspace) {
    let samples = std::mem::take(&mut work.features.samples);
    if samples == 0 {
        return;
    }
    let mut sums = std::mem::take(&mut work.features.sums);
    let rows = (0..work.len()).step_by(samples);
    sums.extend(rows.map(|first| of_pixel(world, work, first..first + samples)));
    work.features.sums = sums;
}

/// Returns the sums of the features of a pixel's rays.
fn of_pixel(world: &World, work: &Workspace, rows: Range<usize>) -> FeatureSums {
    let mut sums = FeatureSums::default();
    let mut first = rows.start;
    // Most pixels show one surface.
    for same in work.hits.sphere[rows].chunk_by(|a, b| a == b) {
        let rows = first..first + same.len();
        first = rows.end;
        if same[0] == MISS {
            continue;
        }
        let albedo = world.albedo(same[0]).to_array();
        let facing = &work.surface.facing;
        let normal = [&facing.x, &facing.y, &facing.z].map(|column| &column[rows.clone()]);
        match work.coverages(rows) {
            None => sums.add_covered(albedo, normal),
            Some(coverages) => sums.add(albedo, normal, coverages),
        }
    }
    sums
}
