//! A render: passes over tiles, tiles over threads.
//!
//! A plain render takes the same samples of every pixel. One that is to reach an error, or to end at
//! a time, goes by rounds over the tiles that need more: see [`crate::noise`].

mod adapt;
mod pass;
mod watch;

pub use crate::integrator::skips::Skips;
pub use adapt::End;
pub(crate) use pass::view;
pub use watch::Tasks;

use self::adapt::{State, Target};
use self::pass::PASS;
use self::watch::Watch;
use crate::bvh::walk::Method;
use crate::film::{Film, Region, Tile};
use crate::image::Image;
use crate::integrator::Job;
use crate::integrator::clock::Times;
use crate::integrator::workspace::{Counters, Workspace};
use crate::noise::{self, Noise};
use crate::sampling::{PixelFilter, Sampler};
use crate::scene::{Integrator, Settings};
use crate::trace::{Tracer, Width};
use crate::world::World;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
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

impl Default for Tracer {
    fn default() -> Self {
        Self { method: Method::Auto, width: Width::Sixteen }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Share of the work that is done, 0..=1; estimated where a target decides on samples, and then
    /// it may fall.
    pub done: f64,
    /// Rays traced so far.
    pub rays: u64,
    /// Since the render began.
    pub elapsed: Duration,
    /// How far the picture is from its limit, if that is measured.
    pub noise: Option<Noise>,
}

/// A finished render.
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
/// threads and any tracer; a time limit decides only how many samples there are. `settings` have
/// the picture's size that the world's camera was built for, and values in the ranges that their
/// documentation states.
pub fn render(world: &World, settings: &Settings, options: &Options) -> Render {
    let watch = Watch::new(options);
    let target = Target::new(settings);
    let targeted = target.error.is_some() || target.time.is_some();
    // Of strata, only sets that are complete are better than independent samples.
    let strata = if targeted { target.goal.first } else { settings.spp };
    let sampler = Sampler::new(settings.sampler, settings.seed, strata);
    let filter = PixelFilter::new(settings.filter);
    let settings = in_world_units(world, settings);
    let job = Job {
        world,
        settings: &settings,
        sampler: &sampler,
        filter: &filter,
        tracer: options.tracer,
        skips: options.skips,
    };
    let camera = &world.camera;
    let whole = Region { x: 0, y: 0, width: camera.width, height: camera.height };
    let mut film = Film::new(options.region.unwrap_or(whole), options.statistics);
    if options.tracer.method != Method::Brute && options.skips.empty_tiles {
        film.tiles.par_iter_mut().for_each(|tile| tile.view = view(&job, tile));
    }
    let measured = targeted || options.statistics;
    let mut state = if measured { State::new(&job, film) } else { State::unmeasured(film) };
    let end = if targeted {
        adapt::run(&job, &mut state, &target, &watch)
    } else {
        uniform(&job, &mut state, &watch)
    };
    let noise = measured.then(|| state.noise(target.error.is_some())).flatten();
    finish(&state, noise, end, options.statistics, watch)
}

/// Gives every pixel the samples that the settings say.
///
/// A task is a pass over a tile, and threads take them off one counter: none ever waits for a whole pass
/// over the picture to end. Whoever comes to a tile takes the samples that are next there, so their
/// order does not depend on that of the tasks.
fn uniform(job: &Job, state: &mut State, watch: &Watch) -> End {
    let spp = job.settings.spp;
    let tiles: Vec<Mutex<&mut Tile>> = state.film.tiles.iter_mut().map(Mutex::new).collect();
    let tasks = tiles.len() * spp.div_ceil(PASS) as usize;
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    rayon::broadcast(|_| {
        let mut work = Workspace::new(job.world, job.sampler);
        while !watch.cancelled() {
            let task = next.fetch_add(1, Ordering::Relaxed);
            let Some(Ok(mut tile)) = (task < tasks).then(|| tiles[task % tiles.len()].lock())
            else {
                return;
            };
            let samples = tile.samples..spp.min(tile.samples + PASS);
            pass::tile_pass(job, &mut tile, samples.clone(), &mut work);
            pass::probe_pass(job, &mut tile, samples.end, &mut work, || true);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            watch.report(&mut work, done as f64 / tasks as f64, None);
        }
    });
    state.round = film_rounds(&state.film);
    if done.into_inner() == tasks { End::Samples } else { End::Cancelled }
}

/// Passes of the tile that has had most.
fn film_rounds(film: &Film) -> u32 {
    film.tiles.iter().map(|tile| tile.samples.div_ceil(PASS)).max().unwrap_or(0)
}

fn finish(state: &State, noise: Option<Noise>, end: End, statistics: bool, watch: Watch) -> Render {
    let film = &state.film;
    let statistics = statistics.then(|| Statistics {
        variance: film.variance(|tile| noise::gain(film, tile)),
        samples: film.samples(),
    });
    let elapsed = watch.elapsed();
    let (counters, times, tasks) = watch.totals();
    let counts = || film.tiles.iter().map(|tile| tile.samples);
    let total = film.tiles.iter().map(|tile| u64::from(tile.samples) * u64::from(tile.len()));
    Render {
        image: film.resolve(),
        samples: Samples {
            total: total.sum(),
            least: counts().min().unwrap_or(0),
            most: counts().max().unwrap_or(0),
            rounds: state.round,
        },
        noise,
        statistics,
        counters,
        times,
        tasks,
        elapsed,
        end,
        complete: end != End::Cancelled,
    }
}

/// Lengths of the settings in the world's units.
fn in_world_units(world: &World, settings: &Settings) -> Settings {
    let integrator = match settings.integrator {
        Integrator::Ao { distance } => Integrator::Ao { distance: world.frame.length(distance) },
        other => other,
    };
    Settings { integrator, ..settings.clone() }
}

/// The samples of each pass.
pub(crate) fn passes(spp: u32) -> impl Iterator<Item = Range<u32>> {
    (0..spp).step_by(PASS as usize).map(move |first| first..spp.min(first + PASS))
}
