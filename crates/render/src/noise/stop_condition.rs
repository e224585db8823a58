//! The stop condition of a render with an error target or a time limit.

use super::Noise;
use crate::settings::Settings;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Minimum number of samples of all pixels before some tiles get more than others: with fewer, their probes would
/// tell little about what they need.
pub(crate) const FIRST_SAMPLES: u32 = 16;

/// Number of samples at the first look at the error.
const FIRST_LOOK: u32 = 4;

/// Maximum ratio of bound and error at which noise is even. Then a render may end with less than [`FIRST_SAMPLES`].
const EVEN: f64 = 1.2;

/// Fraction of the squared error below which light that probes have not found does not matter: with more, a
/// render does not end at the first look.
const SEEN: f64 = 0.05;

/// Number of tiles below which steps are small under a time limit, and the divisor of such a step.
const FEW_TILES: usize = 64;
const SMALL_STEP: u32 = 16;

/// The stop condition of a render: an error, a time or a number of samples, whichever is met first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopCondition {
    /// Error of the image, if that stops the render.
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

    /// Returns the next number of samples, of [`StopCondition::first_samples`] at most, for all tiles, which have
    /// `samples`. `wanted` is the factor by which the squared error must fall.
    ///
    /// Under a time limit, a render starts with single samples. With an error target only, it looks at the error
    /// early, and again where it is expected to meet the target.
    pub fn next_even(&self, samples: u32, wanted: f64) -> u32 {
        let (first, timed) = (self.first_samples(), self.time.is_some());
        let next = match samples {
            _ if timed => 2 * samples,
            0 if self.until_error.is_some() => FIRST_LOOK,
            0 => first,
            // Noise falls at least like that of independent samples. Even numbers of samples are distributed
            // better.
            _ => {
                let expected = (f64::from(samples) / wanted).min(f64::from(first)) as u32 + 1;
                expected - expected % 2
            }
        };
        next.max(samples + 1).min(first)
    }

    /// Returns the number of samples of a tile after its next step, in a film of `tiles` tiles: the next power of
    /// two, or halfway to it if noise is even. Otherwise there are fewer looks at the error, since each may find it
    /// too low by chance.
    pub fn next_samples(&self, samples: u32, tiles: usize, noise: Option<Noise>) -> u32 {
        let first = self.first_samples();
        let next = match samples {
            _ if samples < first => first,
            _ if self.time.is_some() && tiles < FEW_TILES => {
                samples + (samples / SMALL_STEP).next_multiple_of(first.max(SMALL_STEP))
            }
            _ if samples.is_power_of_two() && noise.is_some_and(is_even) => {
                samples.saturating_add(samples / 2)
            }
            _ => samples.saturating_add(1).checked_next_power_of_two().unwrap_or(u32::MAX),
        };
        next.min(self.spp)
    }

    /// Returns whether the error of an image meets the target, with at least `samples` samples per pixel after
    /// `round` rounds.
    pub fn is_met(&self, noise: Noise, samples: u32, round: u32) -> bool {
        let early = samples < self.first_samples();
        let seen = noise.expected < SEEN;
        let reliable = if early { seen && is_even(noise) } else { seen || round > 1 };
        reliable && self.until_error.is_some_and(|error| noise.bound <= error)
    }

    /// Returns the factor by which the squared error must fall; 0 if there is no error target.
    pub fn wanted(&self, noise: Option<Noise>) -> f64 {
        let part = self.until_error.zip(noise).map(|(error, noise)| (error / noise.bound).powi(2));
        part.unwrap_or(0.0)
    }
}

/// Returns whether many probes show about the same noise.
fn is_even(noise: Noise) -> bool {
    noise.bound <= EVEN * noise.error
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(stop: StopCondition, tiles: usize) -> Vec<u32> {
        let noise = Some(Noise { error: 0.1, bound: 0.11, expected: 0.0 });
        let step = |&samples: &u32| {
            let even = samples < stop.first_samples();
            let next = if even {
                stop.next_even(samples, 0.5)
            } else {
                stop.next_samples(samples, tiles, noise)
            };
            Some(next).filter(|next| samples < stop.spp && *next > samples)
        };
        std::iter::successors(Some(0), step).collect()
    }

    #[test]
    fn samples_increase_up_to_the_limit() {
        let stop = StopCondition { until_error: None, time: None, spp: 100 };
        assert_eq!(steps(stop, 1000), [0, 16, 24, 32, 48, 64, 96, 100]);
        let error = StopCondition { until_error: Some(0.01), ..stop };
        assert_eq!(steps(error, 1000), [0, 4, 8, 16, 24, 32, 48, 64, 96, 100]);
        assert_eq!(
            [0.9, 0.7, 0.35, 0.1, 0.0].map(|wanted| error.next_even(4, wanted)),
            [5, 6, 12, 16, 16]
        );
        let timed = StopCondition { time: Some(Duration::from_secs(1)), ..stop };
        assert_eq!(steps(timed, 1000), [0, 1, 2, 4, 8, 16, 24, 32, 48, 64, 96, 100]);
        assert_eq!(steps(timed, 3), [0, 1, 2, 4, 8, 16, 32, 48, 64, 80, 96, 100]);
        assert_eq!(steps(StopCondition { spp: 3, ..timed }, 9), [0, 1, 2, 3]);
        assert_eq!(steps(StopCondition { spp: 12, ..timed }, 1000), [0, 1, 2, 4, 8, 12]);
    }

    #[test]
    fn early_ends_need_even_noise_that_probes_have_seen() {
        let stop = StopCondition { until_error: Some(0.1), time: None, spp: 100 };
        let noise = |bound, expected| Noise { error: 0.08, bound, expected };
        assert!(stop.is_met(noise(0.09, 0.04), 4, 1));
        assert!(!stop.is_met(noise(0.09, 0.06), 4, 1));
        assert!(!stop.is_met(noise(0.098, 0.0), 4, 1) && stop.is_met(noise(0.098, 0.0), 16, 1));
        assert!(!stop.is_met(noise(0.09, 0.06), 16, 1) && stop.is_met(noise(0.09, 0.06), 24, 2));
        assert!(!stop.is_met(noise(0.11, 0.0), 64, 9));
    }
}
