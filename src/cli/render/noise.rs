//! Error estimates in reports.

use super::prepare::Prepared;
use crate::cli::output;
use serde::Serialize;
use spherule_render::denoise::Judged;
use spherule_render::film::Region;
use spherule_render::noise::CONFIDENCE;
use spherule_render::render::{End, Render, Samples};
use spherule_render::scene::Settings;

/// Estimated error of the image relative to its mean radiance.
#[derive(Serialize)]
pub(super) struct NoiseSummary {
    error: f64,
    bound: f64,
    confidence: f64,
    /// Fraction of the squared error that no probe has found.
    expected_share: f64,
    /// True if the image was denoised; then the error is that of the denoised image.
    denoised: bool,
    /// Estimated error without denoising.
    error_before_denoising: Option<f64>,
    ended_by: &'static str,
    rounds: u32,
    least_samples: u32,
    most_samples: u32,
    mean_samples: f64,
}

impl NoiseSummary {
    pub(super) fn new(
        prepared: &Prepared,
        render: &Render,
        judged: Option<&Judged>,
    ) -> Option<Self> {
        let Region { width, height, .. } = prepared.region;
        let Samples { total, least, most, rounds } = render.samples;
        let denoised = judged.filter(|judged| judged.denoised.is_some());
        judged.map(|judged| judged.noise).or(render.noise).map(|noise| Self {
            error: noise.error,
            bound: noise.bound,
            confidence: CONFIDENCE,
            expected_share: noise.expected,
            denoised: denoised.is_some(),
            error_before_denoising: denoised.map(|judged| judged.before.error),
            ended_by: match render.end {
                End::Samples => "samples",
                End::Error => "error",
                End::Time => "time",
                End::Cancelled => "interrupt",
            },
            rounds,
            least_samples: least,
            most_samples: most,
            mean_samples: total as f64 / (f64::from(width) * f64::from(height)),
        })
    }

    /// Returns the estimate for the end of a line, in words that need no manual.
    pub(super) fn brief(&self) -> String {
        let percent = |fraction: f64| two_digits(100.0 * fraction);
        let rare = if self.expected_share >= 0.5 {
            ", mostly from light through glass or mirrors that few samples find"
        } else {
            ""
        };
        format!(", error {} % (at most {} %{rare})", percent(self.error), percent(self.bound))
    }

    /// Formats the estimate as a line.
    pub(super) fn print(&self) {
        let percent = |fraction: f64| two_digits(100.0 * fraction);
        let before = self
            .error_before_denoising
            .map_or_else(String::new, |before| format!(", denoised from {} %", percent(before)));
        output::print(format_args!(
            "error   {} % (below {} % with {:.0} % confidence){before}, {} samples per pixel ({} to {})",
            percent(self.error),
            percent(self.bound),
            100.0 * self.confidence,
            two_digits(self.mean_samples),
            self.least_samples,
            self.most_samples,
        ));
        if self.expected_share >= 0.01 {
            output::print(format_args!(
                "        {:.0} % of the squared error is expected of lights that few samples find, by rays that narrowly miss them",
                100.0 * self.expected_share,
            ));
        }
    }
}

/// Returns a warning if the render ended without reaching the target.
pub(super) fn missed(
    render: &Render,
    judged: Option<&Judged>,
    settings: &Settings,
) -> Option<String> {
    let target = settings.until_error.filter(|_| render.end == End::Samples)?;
    let noise = judged.map(|judged| judged.noise).or(render.noise);
    let bound = noise.map(|noise| noise.bound).filter(|bound| *bound > target)?;
    if !settings.stop_given {
        // The limit is the program's own.
        return None;
    }
    Some(format!(
        "the error is at most {} % instead of {} %: {} samples per pixel are too few; increase --spp",
        two_digits(100.0 * bound),
        two_digits(100.0 * target),
        settings.spp
    ))
}

/// Formats a number with at least three digits and at most two decimals.
fn two_digits(number: f64) -> String {
    let places = if number < 0.1 {
        4
    } else if number < 10.0 {
        2
    } else {
        1
    };
    format!("{number:.places$}")
}
