//! Stop conditions of a render: samples, error, time.

use crate::noise::{Goal, Noise};
use crate::scene::Settings;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Samples of a pixel from which on probes are believed.
pub(super) const FIRST: u32 = 16;

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum End {
    /// Every pixel has as many samples as it may have.
    Samples,
    /// The error is below the target.
    Error,
    /// Time is up.
    Time,
    /// Someone cancelled it, or it was never begun.
    Cancelled,
}

/// What is to be reached before what was asked for later.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Error of the picture, if that is a target.
    pub until_error: Option<f64>,
    /// Most samples of a pixel.
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
    /// The last stage of a render with such settings.
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

    /// The part of the squared error that may stay; 0 if there is no end to it.
    pub(super) fn wanted(&self, noise: Option<Noise>) -> f64 {
        let part = self.error.zip(noise).map(|(error, noise)| (error / noise.bound).powi(2));
        part.unwrap_or(0.0)
    }
}

/// Samples of which sets are well distributed: of strata, only sets that are complete are better
/// than independent samples.
pub(super) fn strata(settings: &Settings) -> u32 {
    if settings.has_target() { FIRST.min(settings.spp) } else { settings.spp }
}
