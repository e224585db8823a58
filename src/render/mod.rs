//! A render: passes over tiles, tiles over threads.
//!
//! A plain render takes the same samples of every pixel. One that is to reach an error, or to end
//! at a time, goes by rounds over the tiles that need more: see [`crate::noise`]. Either can be
//! stopped and go on as if nothing had been: see [`Unfinished`].

mod adapt;
mod error;
mod outline;
mod pass;
mod schedule;
mod share;
mod state;
mod status;
mod target;
mod tasks;
mod unfinished;
mod uniform;
mod unlike;
mod watch;

pub use crate::integrator::skips::Skips;
pub use error::RenderError;
pub(crate) use error::check;
pub(crate) use outline::Outline;
pub(crate) use pass::view;
pub use share::Share;
pub use status::Status;
pub use target::{End, Stage};
pub use tasks::Tasks;
pub use unfinished::Unfinished;
pub use unlike::Unlike;
pub(crate) use unlike::difference;
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

/// What decides how a picture is made, but not what is in it.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// How rays find spheres; the default is the fastest.
    pub tracer: Tracer,
    /// Only this part of the picture; `None` for all of it. Its pixels are the same as in the
    /// whole, unless a target decides on samples: that looks at the part alone.
    pub region: Option<Region>,
    /// Where it is told how far the render is, from any thread, after each tile.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Set this to end the render early, with the samples that there are.
    pub cancel: Option<&'a AtomicBool>,
    /// Whether [`Render::statistics`] are wanted: they take probes, which take time.
    pub statistics: bool,
    /// What is left out where it changes nothing; the default is all.
    pub skips: Skips,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Share of the work that is done, 0..=1; estimated where a target decides on samples, and then
    /// it may fall.
    pub done: f64,
    /// Rays traced so far.
    pub rays: u64,
    /// Since the render began, but for pauses.
    pub elapsed: Duration,
    /// How far the picture is from its limit, if that is measured.
    pub noise: Option<Noise>,
}

/// What a render has come to: all that was asked for, or what there is so far.
#[derive(Clone, Debug)]
pub struct Render {
    /// Mean radiance of each pixel.
    pub image: Image,
    /// Samples of the picture.
    pub samples: Samples,
    /// How far the picture is from its limit, if that was measured.
    pub noise: Option<Noise>,
    /// Variance and samples of each pixel, if they are wanted.
    pub statistics: Option<Statistics>,
    /// What was done, for probes too.
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

/// How many samples a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Of all pixels together.
    pub total: u64,
    /// Of the pixel that has fewest.
    pub least: u32,
    /// Of the pixel that has most.
    pub most: u32,
    /// Rounds in which they were taken: with the settings, this says which picture it is.
    pub rounds: u32,
}

/// What is known of each pixel besides its radiance, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Variance of the pixel's mean, by channel, in the square of the unit of radiance.
    ///
    /// The variance of the pixel's samples over their number, times a factor for how much better
    /// their sequence is than independent samples, from probes of the tile and those around it. It
    /// is an estimate for one pixel at a time, and a noisy one: from a pixel that has seen nothing
    /// it says 0.
    pub variance: Image,
    /// How many samples it has.
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
    let mut unfinished = Unfinished::begin(world, settings, options)?;
    unfinished.run(world, options);
    Ok(unfinished.render())
}

/// The samples of each pass.
pub(crate) fn passes(spp: u32) -> impl Iterator<Item = Range<u32>> {
    (0..spp).step_by(PASS as usize).map(move |first| first..spp.min(first + PASS))
}
