//! A render: passes over tiles, tiles over threads.
//!
//! A plain render takes the same samples of every pixel. One that is to reach an error, or to end
//! at a time, goes by rounds over the tiles that need more: see [`crate::noise`]. Either can be
//! stopped and go on as if nothing had been: see [`ResumableRender`].

mod adapt;
mod error;
mod incompatible;
mod outline;
mod part;
mod pass;
mod resumable;
mod schedule;
mod state;
mod status;
mod target;
mod tasks;
mod uniform;
mod watch;

pub use crate::integrator::elisions::Elisions;
pub use error::RenderError;
pub(crate) use error::check;
pub use incompatible::IncompatibleSettings;
pub(crate) use incompatible::difference;
pub(crate) use outline::Outline;
pub use part::ImagePart;
pub(crate) use pass::view;
pub use resumable::ResumableRender;
pub use status::Status;
pub use target::{End, Stage};
pub use tasks::Tasks;
pub use watch::Totals;

use self::pass::PASS;
use crate::film::Region;
use crate::image::Image;
use crate::integrator::clock::Times;
use crate::integrator::counters::Counters;
use crate::noise::Noise;
use crate::scene::Settings;
use crate::trace::Tracer;
use crate::world::World;
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Options of a render that do not change the image.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// How rays are traced; the default is the fastest.
    pub tracer: Tracer,
    /// Only this part of the picture; `None` for all of it. Its pixels are the same as in the
    /// whole, unless a target decides on samples: that looks at the part alone.
    pub region: Option<Region>,
    /// Called with the progress after each tile, from any thread.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Set this to end the render early, with the samples that there are.
    pub cancel: Option<&'a AtomicBool>,
    /// Whether [`Render::statistics`] are wanted: they take probes, which take time.
    pub statistics: bool,
    /// Work that may be omitted without changing the image; the default is all.
    pub elisions: Elisions,
}

/// Progress of a render.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Share of the work that is done, 0..=1; estimated where a target decides on samples, and then
    /// it may fall.
    pub done: f64,
    /// Rays traced so far.
    pub rays: u64,
    /// Since the render began, but for pauses.
    pub elapsed: Duration,
    /// Estimated error of the image, if that is measured.
    pub noise: Option<Noise>,
}

/// The result of a render: the finished image, or the image so far.
#[derive(Clone, Debug)]
pub struct Render {
    /// Mean radiance of each pixel.
    pub image: Image,
    /// Samples of the picture.
    pub samples: Samples,
    /// Estimated error of the image, if that was measured.
    pub noise: Option<Noise>,
    /// Variance and samples of each pixel, if they are wanted.
    pub statistics: Option<Statistics>,
    /// Counters of rays and decisions, probes included.
    pub counters: Counters,
    /// Time in each stage, of all threads together.
    pub times: Times,
    /// The tasks that the threads shared.
    pub tasks: Tasks,
    /// Time that it took.
    pub elapsed: Duration,
    /// Why it ended.
    pub end: End,
    /// What was to be reached with a target, in order: more than one if something was asked for
    /// later.
    pub stages: Vec<Stage>,
    /// Whether all samples are in it; if not, it was cancelled.
    pub complete: bool,
}

/// Numbers of samples of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Samples of all pixels together.
    pub total: u64,
    /// Samples of the pixel with the fewest.
    pub least: u32,
    /// Samples of the pixel with the most.
    pub most: u32,
    /// Rounds in which they were taken: with the settings, this says which picture it is.
    pub rounds: u32,
}

/// Statistics of each pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Variance of the pixel's mean, by channel, in the square of the unit of radiance.
    ///
    /// The variance of the pixel's samples over their number, times a factor for how much better
    /// their sequence is than independent samples, from probes of the tile and those around it. It
    /// is an estimate for one pixel at a time, and a noisy one: from a pixel that has seen nothing
    /// it says 0.
    pub variance: Image,
    /// Number of samples.
    pub samples: Vec<u32>,
}

/// Renders `world` with the threads of the current rayon pool.
///
/// The picture is a function of the world and the settings alone: the same bytes for any number of
/// threads and any tracer; a time limit decides only how many samples there are.
///
/// # Errors
/// Settings out of their ranges, or for a picture of another size than the world's camera was built
/// for; a region that is not in the picture.
pub fn render(
    world: &World,
    settings: &Settings,
    options: &Options,
) -> Result<Render, RenderError> {
    let mut unfinished = ResumableRender::begin(world, settings, options)?;
    unfinished.run(world, options);
    Ok(unfinished.render())
}

/// The samples of each pass.
pub(crate) fn passes(spp: u32) -> impl Iterator<Item = Range<u32>> {
    (0..spp).step_by(PASS as usize).map(move |first| first..spp.min(first + PASS))
}
