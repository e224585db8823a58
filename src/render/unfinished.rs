//! Renders that can be stopped, kept, and gone on with.

use super::share::Share;
use super::state::State;
use super::target::{self, End, Stage, Target};
use super::watch::{Totals, Watch};
use super::{
    Options, Render, RenderError, Samples, Statistics, Unlike, adapt, error, pass, uniform, unlike,
};
use crate::film::{Film, Region};
use crate::integrator::Job;
use crate::noise;
use crate::sampling::{PixelFilter, Sampler};
use crate::scene::{Integrator, Settings};
use crate::trace::Traversal;
use crate::world::World;
use rayon::prelude::*;

/// A render that may have been stopped: all that it knows, and so all that makes what comes next.
///
/// # What is the same
///
/// However often a render is cancelled, and with however many threads and whatever tracer it goes
/// on, it comes to the same bytes as one that never stopped: samples of a pixel are added up without
/// rounding, and what a target decides is a function of what is kept here. Renders to a
/// time go through one sequence of steps, of which the time decides how many there are.
///
/// # Asking for more
///
/// [`Unfinished::raise`] asks for more samples, a smaller error or more time:
///
/// * More samples without a target: the result is that of a render of so many from the start.
/// * More time: the sequence of steps goes on.
/// * A smaller error, or more samples with a target: what was asked for before is reached first,
///   and the new target from there. So the result is a function of all that was asked for, in
///   order, and not of the moments at which that was; a render to the last target alone may have
///   taken other samples, and is as right.
#[derive(Clone, Debug)]
pub struct Unfinished {
    pub(super) settings: Settings,
    /// What is to be reached with a target, in order.
    pub(super) stages: Vec<Stage>,
    /// How many of them were.
    pub(super) met: usize,
    /// Whether sums of squares are kept.
    pub(super) statistics: bool,
    /// What of the picture it is to render.
    pub(super) share: Share,
    pub(super) state: State,
    pub(super) totals: Totals,
    pub(super) end: End,
}

impl Unfinished {
    /// A render that has no samples yet, of `world` by `settings`, both as [`super::render()`]
    /// takes them. Of the options, region and statistics are those of the whole render.
    ///
    /// # Errors
    /// Those of [`super::render()`].
    pub fn begin(
        world: &World,
        settings: &Settings,
        options: &Options,
    ) -> Result<Self, RenderError> {
        let share = Share::whole(error::check(world, settings, options)?, settings.spp);
        Self::begin_share(world, settings, options, share)
    }

    /// The same of a share of the render, to be merged with others. The settings, which are those of
    /// the whole, have no target: no share knows how much is enough.
    ///
    /// # Errors
    /// Those of [`super::render()`], and a share that is no part of the render.
    pub fn begin_share(
        world: &World,
        settings: &Settings,
        options: &Options,
        share: Share,
    ) -> Result<Self, RenderError> {
        let statistics = options.statistics;
        let region = error::check(world, settings, options)?;
        if share.common(&Share::whole(region, settings.spp)).as_ref() != Some(&share) {
            return Err(RenderError::Share(share));
        }
        let mut film = Film::with_tiles(region, share.tiles.clone(), statistics);
        let state = with_job(world, settings, options, |job| {
            if options.tracer.traversal != Traversal::Brute && options.skips.empty_tiles {
                film.tiles.par_iter_mut().for_each(|tile| tile.view = pass::view(job, tile));
            }
            let measured = settings.has_target() || statistics;
            if measured { State::new(job, film) } else { State::unmeasured(film) }
        });
        let stages = if settings.has_target() { vec![Stage::of(settings)] } else { Vec::new() };
        let (settings, totals, end) = (settings.clone(), Totals::default(), End::Cancelled);
        Ok(Self { settings, stages, met: 0, statistics, share, state, totals, end })
    }

    /// Adds what another share of the same render has. Whether they are of the same kind; if not,
    /// this one is of no use any more.
    pub(crate) fn merge(&mut self, other: Self) -> bool {
        self.totals.add(&other.totals);
        self.statistics == other.statistics && self.state.film.merge(other.state.film)
    }

    /// Makes the merged shares the whole, with black tiles where there are none.
    pub(crate) fn become_whole(&mut self) {
        self.share = Share::whole(self.region(), self.settings.spp);
        self.state.film.fill(self.statistics);
        self.state.round = uniform::rounds_taken(&self.state.film);
        let complete = self.samples().least == self.settings.spp;
        self.end = if complete { End::Samples } else { End::Cancelled };
    }

    /// Goes on until everything that was asked for is there, time is up, or `options.cancel` is
    /// set, with the threads of the current rayon pool. A pass over a tile is not broken off.
    ///
    /// `world` is that of the beginning. Of the options, region and statistics are those of the
    /// beginning too, whatever is said here.
    pub fn run(&mut self, world: &World, options: &Options) -> End {
        let watch = Watch::new(options, &self.totals);
        let settings = self.settings.clone();
        self.end = with_job(world, &settings, options, |job| {
            if settings.has_target() {
                self.meet(job, &watch)
            } else {
                uniform::run(job, self.share.samples.clone(), &mut self.state, &watch)
            }
        });
        self.totals = watch.totals();
        self.end
    }

    /// Meets the stages that are left.
    fn meet(&mut self, job: &Job, watch: &Watch) -> End {
        let mut end = self.end;
        while let Some(&stage) = self.stages.get(self.met) {
            let target = Target::new(stage, self.settings.time);
            end = adapt::run(job, &mut self.state, &target, watch);
            if matches!(end, End::Cancelled | End::Time) {
                return end;
            }
            self.met += 1;
        }
        end
    }

    /// Asks for what `settings` say: more samples, a smaller error, more time, or the same.
    /// Exposure and tone may be any.
    ///
    /// # Errors
    /// A setting is out of its range; anything else is other than at the beginning, or it asks for
    /// less; or samples are stratified in a number of strata that would be another.
    pub fn raise(&mut self, settings: &Settings) -> Result<(), Unlike> {
        settings.check()?;
        unlike::check(&self.settings, settings)?;
        if settings.spp != self.settings.spp && !self.is_whole() {
            return Err(Unlike::Share { then: self.settings.spp, now: settings.spp });
        }
        let stage = Stage::of(settings);
        if settings.has_target() && self.stages.last() != Some(&stage) {
            self.stages.push(stage);
        }
        if settings.spp != self.settings.spp {
            self.share = Share::whole(self.region(), settings.spp);
        }
        self.settings = settings.clone();
        Ok(())
    }

    /// The picture so far, and what is known of it.
    pub fn render(&self) -> Render {
        let (film, settings) = (&self.state.film, &self.settings);
        let statistics = self.statistics.then(|| Statistics {
            variance: film.variance(|tile| noise::gain(film, tile)),
            samples: film.samples(),
        });
        let measured = settings.has_target() || self.statistics;
        let Totals { counters, times, tasks, elapsed } = self.totals;
        Render {
            image: film.resolve(),
            samples: self.samples(),
            noise: measured.then(|| self.state.noise(settings.until_error.is_some())).flatten(),
            statistics,
            counters,
            times,
            tasks,
            elapsed,
            end: self.end,
            stages: self.stages.clone(),
            complete: self.is_complete(),
        }
    }

    /// What of the picture it is to render.
    pub fn share(&self) -> &Share {
        &self.share
    }

    /// Whether that is all of it.
    pub fn is_whole(&self) -> bool {
        self.share == Share::whole(self.region(), self.settings.spp)
    }

    /// Whether everything that was asked for is there, or time was up.
    pub fn is_complete(&self) -> bool {
        self.end != End::Cancelled
    }

    /// Samples that there are.
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

    /// What it was begun with, but for what was raised since.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What was asked for with a target, in order; the last is what the settings say.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// The part of the picture that it is.
    pub fn region(&self) -> Region {
        self.state.film.region
    }

    /// Whether [`Render::statistics`] are wanted.
    pub fn statistics(&self) -> bool {
        self.statistics
    }

    /// Sums and counts.
    pub fn film(&self) -> &Film {
        &self.state.film
    }

    /// The same, to be filled.
    pub(crate) fn film_mut(&mut self) -> &mut Film {
        &mut self.state.film
    }

    /// What was done so far, and how long it took.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }
}

/// Does something with what all tasks of a render share.
fn with_job<T>(
    world: &World,
    settings: &Settings,
    options: &Options,
    work: impl FnOnce(&Job) -> T,
) -> T {
    let sampler = Sampler::new(settings.sampler, settings.seed, target::strata(settings));
    let filter = PixelFilter::new(settings.filter);
    let settings = in_world_units(world, settings);
    work(&Job {
        world,
        settings: &settings,
        sampler: &sampler,
        filter: &filter,
        tracer: options.tracer,
        skips: options.skips,
    })
}

/// Lengths of the settings in the world's units.
fn in_world_units(world: &World, settings: &Settings) -> Settings {
    let integrator = match settings.integrator {
        Integrator::Ao { distance } => Integrator::Ao { distance: world.frame.length(distance) },
        other => other,
    };
    Settings { integrator, ..settings.clone() }
}
