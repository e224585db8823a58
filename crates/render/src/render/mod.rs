//! Rendering: passes over tiles, which are distributed over threads.
//!
//! A plain render takes the same number of samples for every pixel. With an error target or a time
//! limit, it goes in rounds over the tiles that need more samples: see [`crate::noise`]. Both can be
//! stopped and resumed without changing the image: see [`ResumableRender`].

mod adapt;
mod device;
mod end;
mod error;
mod header;
mod incompatible;
mod part;
mod pass;
mod preview;
mod resumable;
mod schedule;
mod state;
mod status;
mod tasks;
mod uniform;
mod watch;

pub use crate::integrator::elisions::Elisions;
pub use end::End;
pub use error::RenderError;
pub(crate) use error::check;
pub(crate) use header::RenderHeader;
pub use incompatible::IncompatibleSettings;
pub(crate) use incompatible::difference;
pub use part::ImagePart;
pub(crate) use pass::{PASS, view};
pub use preview::preview;
pub(crate) use resumable::strata;
pub use resumable::{ResumableRender, not_followed, render};
pub use status::Status;
pub use tasks::Tasks;
pub use watch::Totals;

use crate::film::{Film, Region};
use crate::image::Image;
use crate::integrator::clock::Times;
use crate::integrator::counters::Counters;
use crate::noise::{self, Noise, StopCondition};
use crate::trace::Tracer;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Options of a render that do not change the image.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// Traversal of rays; the default is the fastest.
    pub tracer: Tracer,
    /// Renders only this part of the image; `None` for all of it. Its pixels are the same as in the
    /// whole image, unless a target decides on the number of samples, which considers only the
    /// region.
    pub region: Option<Region>,
    /// Called with the progress after each tile, on any thread.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Set this to end the render early, with the samples so far.
    pub cancel: Option<&'a AtomicBool>,
    /// True if [`Render::statistics`] are computed, which needs probes and so takes time.
    pub statistics: bool,
    /// True if the features of the first samples are recorded for a [`Denoiser`](crate::denoise::Denoiser), which traces
    /// them otherwise.
    pub features: bool,
    /// Estimates the error that is compared with the target, in place of that of the image itself:
    /// that of the denoised image, say. It is asked where the image's own error is at most 2.5 times the target.
    /// `None` from it stands for an estimate that was cancelled.
    ///
    /// It must be a function of the film and the scene alone.
    pub judge: Option<&'a Judge<'a>>,
    /// Work that may be omitted without changing the image; the default is all.
    pub elisions: Elisions,
}

impl Options<'_> {
    /// Returns whether the flag is set.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

/// An estimate of an error from a film: see [`Options::judge`].
pub type Judge<'a> = dyn Fn(&Film) -> Option<Noise> + Sync + 'a;

/// Progress of a render.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Fraction of the work that is done, 0..=1; estimated with a target, so that it may decrease.
    pub done: f64,
    /// Rays traced so far.
    pub rays: u64,
    /// Rendering time, without interruptions.
    pub elapsed: Duration,
    /// Estimated error of the image, if it is measured.
    pub noise: Option<Noise>,
}

/// The result of a render: the finished image, or the image so far.
#[derive(Clone, Debug)]
pub struct Render {
    /// Mean radiance of each pixel.
    pub image: Image,
    /// Number of samples.
    pub samples: Samples,
    /// Estimated error of the image, if it was measured.
    pub noise: Option<Noise>,
    /// Variance and samples of each pixel, if requested.
    pub statistics: Option<Statistics>,
    /// Counters of rays and decisions, probes included.
    pub counters: Counters,
    /// Time in each stage, summed over threads.
    pub times: Times,
    /// Division of the work into tasks.
    pub tasks: Tasks,
    /// Rendering time.
    pub elapsed: Duration,
    /// Reason why it ended.
    pub end: End,
    /// Stop conditions in the order in which they are met: several if the render was extended.
    pub stop_conditions: Vec<StopCondition>,
    /// True if all samples were taken: otherwise the render was cancelled.
    pub complete: bool,
    /// Tiles without a sample, which are black, as regions of the picture: those of a render that ended in its first pass.
    pub unsampled: Vec<Region>,
}

impl Render {
    /// Returns the fraction of pixels that have samples.
    pub fn sampled_share(&self) -> f64 {
        let without: u64 = self.unsampled.iter().map(|region| region.area()).sum();
        1.0 - without as f64 / self.image.pixels.len() as f64
    }
}

/// Numbers of samples of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Total of all pixels.
    pub total: u64,
    /// Minimum over pixels.
    pub least: u32,
    /// Maximum over pixels.
    pub most: u32,
    /// Number of rounds: together with the settings, it identifies the image.
    pub rounds: u32,
}

/// Statistics of each pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Variance of the pixel's mean, by channel, in squared units of radiance.
    ///
    /// The variance of the pixel's samples over their number, times a factor for the gain of the
    /// sequence over independent samples, from probes of the tile and its neighbors. The estimate for a
    /// single pixel is noisy: it is 0 for a pixel whose samples found no light.
    pub variance: Image,
    /// Number of samples.
    pub samples: Vec<u32>,
}

impl Statistics {
    /// Returns the statistics of a film with sums of squares. Once the flag of the options is set, tiles have a variance
    /// of 0.
    pub fn of(film: &Film, options: &Options) -> Self {
        let variance = film.variance(|tile| {
            let gain = (!options.is_cancelled()).then(|| noise::Gain::of(film, tile))?;
            Some(move |variance| gain.at(variance))
        });
        Self { variance, samples: film.samples() }
    }
}

/// Returns the samples of each pass.
pub(crate) fn passes(spp: u32) -> impl Iterator<Item = Range<u32>> {
    (0..spp).step_by(PASS as usize).map(move |first| first..spp.min(first + PASS))
}
