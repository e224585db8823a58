//! Stop conditions of a render: samples, error, time.

use crate::noise::{Goal, Noise};
use crate::scene::Settings;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Minimum number of samples of a pixel for its probes to be reliable.
pub(super) const FIRST: u32 = 16;

/// The reason why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum End {
    /// Every pixel has the maximum number of samples.
    Samples,
    /// The error is below the target.
    Error,
    /// The time limit is reached.
    Time,
    /// It was cancelled, or never started.
    Cancelled,
}

/// A target: an error or a number of samples. Targets of later extensions follow it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Error of the picture, if it is a target.
    pub until_error: Option<f64>,
    /// Maximum number of samples of a pixel.
    pub spp: u32,
}

/// The stop condition of a stage of a render.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub(super) error: Option<f64>,
    pub(super) time: Option<Duration>,
    pub(super) goal: Goal,
}

impl Stage {
    /// Returns the target of these settings.
    pub(super) fn of(settings: &Settings) -> Self {
        Self { until_error: settings.until_error, spp: settings.spp }
    }
}

impl Target {
    pub(super) fn new(stage: Stage, time: Option<Duration>) -> Self {
        let first = FIRST.min(stage.spp);
        let goal = Goal { first, most: stage.spp, timed: time.is_some() };
        Self { error: stage.until_error, time, goal }
    }

    /// Returns the factor by which the squared error must fall; 0 if there is no error target.
    pub(super) fn wanted(&self, noise: Option<Noise>) -> f64 {
        let part = self.error.zip(noise).map(|(error, noise)| (error / noise.bound).powi(2));
        part.unwrap_or(0.0)
    }
}

/// Returns the number of strata of stratified samples, the size of well-distributed sets: only complete
/// sets are better than independent samples.
pub(super) fn strata(settings: &Settings) -> u32 {
    if settings.has_target() { FIRST.min(settings.spp) } else { settings.spp }
}
