//! The stop condition of a render with an error target or a time limit.

use super::Noise;
use crate::settings::Settings;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Minimum number of samples of a pixel for its probes to be reliable.
pub(crate) const FIRST_SAMPLES: u32 = 16;

/// Number of tiles below which steps are small under a time limit, and the divisor of such a step.
const FEW_TILES: usize = 64;
const SMALL_STEP: u32 = 16;

/// The stop condition of a render: an error, a time or a number of samples, whichever is met first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopCondition {
    /// Error of the picture, if that stops the render.
    pub until_error: Option<f64>,
    /// Time of the whole render, if that stops it.
    pub time: Option<Duration>,
    /// Maximum number of samples of a pixel.
    pub spp: u32,
}

impl StopCondition {
    /// Returns the stop condition of these settings.
    pub fn of(settings: &Settings) -> Self {
        let Settings { until_error, time, spp, .. } = *settings;
        Self { until_error, time, spp }
    }

    /// Returns the number of samples before tiles are compared: as many as probes need.
    pub fn first_samples(&self) -> u32 {
        FIRST_SAMPLES.min(self.spp)
    }

    /// Returns the number of samples of a tile after its next step, in a film of `tiles` tiles. Under a
    /// time limit, a render starts with single samples.
    pub fn next_samples(&self, samples: u32, tiles: usize) -> u32 {
        let (first, timed) = (self.first_samples(), self.time.is_some());
        let next = match samples {
            _ if samples < first && timed => (2 * samples).clamp(1, first),
            _ if samples < first => first,
            _ if timed && tiles < FEW_TILES => {
                samples + (samples / SMALL_STEP).next_multiple_of(first.max(SMALL_STEP))
            }
            _ => samples.saturating_mul(2),
        };
        next.min(self.spp)
    }

    /// Returns the factor by which the squared error must fall; 0 if there is no error target.
    pub fn wanted(&self, noise: Option<Noise>) -> f64 {
        let part = self.until_error.zip(noise).map(|(error, noise)| (error / noise.bound).powi(2));
        part.unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(stop: StopCondition, tiles: usize) -> Vec<u32> {
        let step = |&samples: &u32| {
            Some(stop.next_samples(samples, tiles))
                .filter(|next| samples < stop.spp && *next > samples)
        };
        std::iter::successors(Some(0), step).collect()
    }

    #[test]
    fn samples_double_up_to_the_limit() {
        let stop = StopCondition { until_error: None, time: None, spp: 100 };
        assert_eq!(steps(stop, 1000), [0, 16, 32, 64, 100]);
        let timed = StopCondition { time: Some(Duration::from_secs(1)), ..stop };
        assert_eq!(steps(timed, 1000), [0, 1, 2, 4, 8, 16, 32, 64, 100]);
        assert_eq!(steps(timed, 3), [0, 1, 2, 4, 8, 16, 32, 48, 64, 80, 96, 100]);
        assert_eq!(steps(StopCondition { spp: 3, ..timed }, 9), [0, 1, 2, 3]);
        assert_eq!(steps(StopCondition { spp: 12, ..timed }, 1000), [0, 1, 2, 4, 8, 12]);
    }
}
