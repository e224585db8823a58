//! Renders that can be stopped, saved and resumed.

use super::end::End;
use super::part::ImagePart;
use super::state::State;
use super::watch::{Totals, Watch};
use super::{
    IncompatibleSettings, Options, Render, RenderError, Samples, Statistics, adapt, error,
    incompatible, pass, uniform,
};
use crate::film::{Film, Region, View};
use crate::integrator::Job;
use crate::integrator::device::device_job;
use crate::noise::{FIRST_SAMPLES, Noise, StopCondition};
use crate::scene::{Integrator, Settings};
use crate::trace::Traversal;
use crate::world::World;
use rayon::prelude::*;
use std::borrow::Cow;

/// The complete state of a render that may have been stopped.
///
/// # Determinism
///
/// A render that is stopped and resumed, any number of times, with any number of threads and any
/// tracer, produces the same bytes as one that was never stopped: the samples of a pixel are summed
/// without rounding, and adaptive decisions are functions of this state. A render with a time limit
/// follows a fixed sequence of steps; time only decides how many of them are made.
///
/// # Extending a render
///
/// [`ResumableRender::extend`] asks for more samples, a smaller error or more time:
///
/// * More samples, without an error target: the result is that of a render with as many from the start.
/// * More time: the sequence of steps continues.
/// * A smaller error, or more samples with an error target: the previous target is reached first, then
///   the new one. So the result depends on the sequence of requests, not on when they were made; a
///   render with the last target alone may take other samples, and is equally valid.
#[derive(Clone, Debug)]
pub struct ResumableRender {
    pub(super) settings: Settings,
    /// Stop conditions with an error or a time, in the order in which they are met.
    pub(super) stop_conditions: Vec<StopCondition>,
    /// Number of targets that were reached.
    pub(super) met: usize,
    /// True if sums of squares are kept.
    pub(super) statistics: bool,
    /// The part of the image to render.
    pub(super) part: ImagePart,
    pub(super) state: State,
    pub(super) totals: Totals,
    pub(super) end: End,
}

impl ResumableRender {
    /// Returns a render without samples; `world` and `settings` are those of [`super::render()`]. Of
    /// the options, region and statistics hold for the whole render.
    ///
    /// # Errors
    /// Those of [`super::render()`].
    pub fn begin(
        world: &World,
        settings: &Settings,
        options: &Options,
    ) -> Result<Self, RenderError> {
        let part = ImagePart::whole(error::check(world, settings, options)?, settings.spp);
        Self::begin_part(world, settings, options, part)
    }

    /// Returns a render of one part of an image, to be merged with others. The settings are those of the
    /// whole image, without an error target: a part alone does not know the error of the image.
    ///
    /// # Errors
    /// Those of [`super::render()`], and a part that exceeds the image.
    pub fn begin_part(
        world: &World,
        settings: &Settings,
        options: &Options,
        part: ImagePart,
    ) -> Result<Self, RenderError> {
        let statistics = options.statistics;
        let region = error::check(world, settings, options)?;
        if part.common(&ImagePart::whole(region, settings.spp)).as_ref() != Some(&part) {
            return Err(RenderError::Part(part));
        }
        let mut film = Film::with_tiles(region, part.tiles.clone(), statistics);
        let state = with_job(world, settings, options, |job| {
            let measured = settings.has_target() || statistics;
            let known =
                options.tracer.traversal != Traversal::Brute && options.elisions.empty_tiles;
            if !measured && !known {
                return State::unmeasured(film);
            }
            let views: Vec<View> =
                film.tiles.par_iter().map(|tile| pass::view(job, tile.region)).collect();
            if known {
                film.tiles.iter_mut().zip(&views).for_each(|(tile, &view)| tile.view = view);
            }
            if measured { State::new(job, film, &views) } else { State::unmeasured(film) }
        });
        let stop_conditions =
            if settings.has_target() { vec![StopCondition::of(settings)] } else { Vec::new() };
        let (settings, totals, end) = (settings.clone(), Totals::default(), End::Cancelled);
        Ok(Self { settings, stop_conditions, met: 0, statistics, part, state, totals, end })
    }

    /// Adds the samples of another part of the same image. Returns false if the two are incompatible;
    /// then this one is unusable.
    pub(crate) fn merge(&mut self, other: Self) -> bool {
        self.totals.add(&other.totals);
        self.statistics == other.statistics && self.state.film.merge(other.state.film)
    }

    /// Completes merged parts to the whole image: missing tiles are black.
    pub(crate) fn fill_missing(&mut self) {
        self.part = ImagePart::whole(self.region(), self.settings.spp);
        self.state.film.fill(self.statistics);
        self.state.round = uniform::rounds_taken(&self.state.film);
        let complete = self.samples().least == self.settings.spp;
        self.end = if complete { End::Samples } else { End::Cancelled };
    }

    /// Renders until all targets are reached, time is up, or `options.cancel` is set, with the threads of
    /// the current rayon pool. A pass over a tile is always finished.
    ///
    /// `world` must be the one that the render began with. Region and statistics of the options are
    /// ignored: those of the beginning hold.
    pub fn run(&mut self, world: &World, options: &Options) -> End {
        if options.features {
            self.state.film.keep_features();
        }
        let watch = Watch::new(options, &self.totals);
        let settings = self.settings.clone();
        self.end = with_job(world, &settings, options, |job| {
            if settings.has_target() {
                self.meet_stop_conditions(job, &watch)
            } else {
                uniform::run(job, self.part.samples.clone(), &mut self.state, &watch)
            }
        });
        self.totals = watch.totals();
        self.end
    }

    /// Renders until the remaining stop conditions are met.
    fn meet_stop_conditions(&mut self, job: &Job, watch: &Watch) -> End {
        let mut end = self.end;
        while let Some(stop) = self.stop_conditions.get(self.met) {
            end = adapt::run(job, &mut self.state, stop, watch);
            if matches!(end, End::Cancelled | End::Time) {
                return end;
            }
            self.met += 1;
        }
        end
    }

    /// Asks for more samples, a smaller error or more time. Exposure and tone may change freely.
    ///
    /// # Errors
    /// A setting is out of range, asks for less than before, or changes although all samples depend on
    /// it; or the samples are stratified, and the number of strata would change.
    pub fn extend(&mut self, settings: &Settings) -> Result<(), IncompatibleSettings> {
        settings.check()?;
        incompatible::check(&self.settings, settings)?;
        if settings.spp != self.settings.spp && !self.is_whole() {
            return Err(IncompatibleSettings::Part { then: self.settings.spp, now: settings.spp });
        }
        // The time limit is that of the whole render.
        self.stop_conditions.iter_mut().for_each(|stop| stop.time = settings.time);
        let stop = StopCondition::of(settings);
        if settings.has_target() && self.stop_conditions.last() != Some(&stop) {
            self.stop_conditions.push(stop);
        }
        if settings.spp != self.settings.spp {
            self.part = ImagePart::whole(self.region(), settings.spp);
        }
        self.settings = settings.clone();
        Ok(())
    }

    /// Returns the image so far with its statistics.
    pub fn render(&self) -> Render {
        let options = Options::default();
        let statistics = self.statistics.then(|| Statistics::of(&self.state.film, &options));
        Render { noise: self.noise(), statistics, ..self.unmeasured(Vec::new()) }
    }

    /// Returns the error of the image so far, if the render has a target or statistics.
    pub fn noise(&self) -> Option<Noise> {
        let measured = self.settings.has_target() || self.statistics;
        measured.then(|| self.state.noise(self.settings.until_error.is_some())).flatten()
    }

    /// Returns the same without statistics and error, which take a while for large images; in the memory of `pixels`, as
    /// [`Film::resolve_in`].
    pub fn unmeasured(&self, pixels: Vec<[f32; 3]>) -> Render {
        let Totals { counters, times, tasks, elapsed } = self.totals;
        Render {
            image: self.state.film.resolve_in(pixels),
            samples: self.samples(),
            noise: None,
            statistics: None,
            counters,
            times,
            tasks,
            elapsed,
            end: self.end,
            stop_conditions: self.stop_conditions.clone(),
            complete: self.is_complete(),
            unsampled: self.unsampled(),
        }
    }

    /// Returns the tiles without a sample.
    fn unsampled(&self) -> Vec<Region> {
        let tiles = self.state.film.tiles.iter();
        tiles.filter(|tile| tile.samples == 0).map(|tile| tile.region).collect()
    }

    /// Returns the part of the image to render.
    pub fn part(&self) -> &ImagePart {
        &self.part
    }

    /// Returns whether the part is the whole image.
    pub fn is_whole(&self) -> bool {
        self.part == ImagePart::whole(self.region(), self.settings.spp)
    }

    /// Returns whether all targets or the time limit were reached.
    pub fn is_complete(&self) -> bool {
        self.end != End::Cancelled
    }

    /// Returns the number of samples so far.
    pub fn samples(&self) -> Samples {
        let tiles = &self.state.film.tiles;
        let counts = || tiles.iter().map(|tile| tile.samples);
        let total = tiles.iter().map(|tile| u64::from(tile.samples) * u64::from(tile.len()));
        Samples {
            total: total.sum(),
            least: counts().min().unwrap_or(0),
            most: counts().max().unwrap_or(0),
            rounds: self.state.round,
        }
    }

    /// Returns the settings of the last extension.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the stop conditions in order; the last is that of the settings.
    pub fn stop_conditions(&self) -> &[StopCondition] {
        &self.stop_conditions
    }

    /// Returns the region of the image, in pixels.
    pub fn region(&self) -> Region {
        self.state.film.region
    }

    /// Returns whether [`Render::statistics`] are computed.
    pub fn statistics(&self) -> bool {
        self.statistics
    }

    /// Returns the film: sums and counts of samples.
    pub fn film(&self) -> &Film {
        &self.state.film
    }

    /// Returns the film for filling its sums.
    pub(crate) fn film_mut(&mut self) -> &mut Film {
        &mut self.state.film
    }

    /// Returns counters and times so far.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }
}

/// Returns why devices do not follow the paths of a render, if so.
pub fn not_followed(world: &World, settings: &Settings) -> Option<Cow<'static, str>> {
    with_processor(world, settings, &Options::default(), |job| device_job(job).err())
}

/// Calls `work` with the job that all tasks of a render use.
fn with_job<T>(
    world: &World,
    settings: &Settings,
    options: &Options,
    work: impl FnOnce(&Job) -> T,
) -> T {
    with_processor(world, settings, options, |job| {
        let integrator = world.device_paths.as_ref();
        let paths = integrator.and_then(|device| device.begin(&device_job(job).ok()?));
        work(&Job { device: paths.as_deref(), ..job.clone() })
    })
}

/// Calls `work` with the job without a device.
fn with_processor<T>(
    world: &World,
    settings: &Settings,
    options: &Options,
    work: impl FnOnce(&Job) -> T,
) -> T {
    let samples = strata(settings);
    let settings = in_world_units(world, settings);
    work(&Job::new(world, &settings, samples, options.tracer, options.elisions))
}

/// Returns the settings with lengths in the world's units.
fn in_world_units(world: &World, settings: &Settings) -> Settings {
    let integrator = match settings.integrator {
        Integrator::Ao { distance } => {
            Integrator::Ao { distance: world.transform.length(distance) }
        }
        other => other,
    };
    Settings { integrator, ..settings.clone() }
}

/// Returns the number of strata of stratified samples, the size of well-distributed sets: only complete
/// sets are better than independent samples.
pub(crate) fn strata(settings: &Settings) -> u32 {
    if settings.has_target() { FIRST_SAMPLES.min(settings.spp) } else { settings.spp }
}

/// Renders `world` with the threads of the current rayon pool.
///
/// The image depends only on the world and the settings: it has the same bytes for any number of
/// threads and any tracer; a time limit decides only the number of samples.
///
/// A task of a parallel iterator that waits for a render may begin the iterator's next one on the same stack, which can overflow:
/// to render many worlds at once, call this from threads of [`std::thread`].
///
/// # Errors
/// Settings out of range, or for another image size than that of the world's camera; a region that is
/// not in the image.
pub fn render(
    world: &World,
    settings: &Settings,
    options: &Options,
) -> Result<Render, RenderError> {
    let mut unfinished = ResumableRender::begin(world, settings, options)?;
    unfinished.run(world, options);
    Ok(unfinished.render())
}
