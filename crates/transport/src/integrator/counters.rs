//! Counters of a task's work.

use serde::{Deserialize, Serialize};

/// Counts of work, for statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Samples that need no ray, because the pixel can only see a constant background.
    pub skipped_samples: u64,
    /// Camera rays.
    pub camera_rays: u64,
    /// Next rays of paths.
    pub bounce_rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Hit decisions that needed exact arithmetic.
    pub exact_decisions: u64,
    /// Paths that the depth limit ended.
    pub cut_paths: u64,
    /// Samples that were negative or not finite, and count as black.
    pub bad_samples: u64,
    /// Overflows of the interior list: a path was in more glass spheres than the list can hold.
    pub nesting_overflows: u64,
}

impl Counters {
    /// Returns the number of all rays.
    pub fn rays(&self) -> u64 {
        self.camera_rays.saturating_add(self.bounce_rays).saturating_add(self.shadow_rays)
    }

    /// Adds the counts of another task. Files of parts may claim any counts, so sums saturate.
    pub fn add(&mut self, other: &Self) {
        self.skipped_samples = self.skipped_samples.saturating_add(other.skipped_samples);
        self.camera_rays = self.camera_rays.saturating_add(other.camera_rays);
        self.bounce_rays = self.bounce_rays.saturating_add(other.bounce_rays);
        self.shadow_rays = self.shadow_rays.saturating_add(other.shadow_rays);
        self.exact_decisions = self.exact_decisions.saturating_add(other.exact_decisions);
        self.cut_paths = self.cut_paths.saturating_add(other.cut_paths);
        self.bad_samples = self.bad_samples.saturating_add(other.bad_samples);
        self.nesting_overflows = self.nesting_overflows.saturating_add(other.nesting_overflows);
    }

    /// Returns all counts.
    pub fn all(&self) -> [u64; 8] {
        [
            self.skipped_samples,
            self.camera_rays,
            self.bounce_rays,
            self.shadow_rays,
            self.exact_decisions,
            self.cut_paths,
            self.bad_samples,
            self.nesting_overflows,
        ]
    }
}
