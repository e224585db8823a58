//! A render: passes over tiles, tiles over threads.

use crate::bvh::walk::Method;
use crate::film::{Film, Region, Tile, View};
use crate::image::Image;
use crate::integrator::clock::{Stage, Times};
use crate::integrator::workspace::{Counters, Workspace};
use crate::integrator::{Job, stages};
use crate::sampling::{PixelFilter, Sampler};
use crate::scene::{Integrator, Rgb, Settings};
use crate::trace::{Tracer, Width};
use crate::world::World;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Samples per pixel and pass: a tile of them is one batch of paths.
const PASS: u32 = 16;

/// What decides how a picture is made, but not what is in it.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// How rays find spheres; the default is the fastest.
    pub tracer: Tracer,
    /// Only this part of the picture; `None` for all of it. Its pixels are the same as in the
    /// whole.
    pub region: Option<Region>,
    /// Where it is told how far the render is, from any thread, after each tile.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Set this to end the render early, with the samples that there are.
    pub cancel: Option<&'a AtomicBool>,
}

impl Default for Tracer {
    fn default() -> Self {
        Self { method: Method::Auto, width: Width::Sixteen }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Share of the work that is done, 0..=1.
    pub done: f64,
    /// Rays traced so far.
    pub rays: u64,
    /// Since the render began.
    pub elapsed: Duration,
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Render {
    /// Mean radiance of each pixel.
    pub image: Image,
    /// What was done.
    pub counters: Counters,
    /// Time in each stage, of all threads together.
    pub times: Times,
    /// Time that it took.
    pub elapsed: Duration,
    /// Whether all samples are in it; if not, it was cancelled.
    pub complete: bool,
}

/// Renders `world` with the threads of the current rayon pool.
///
/// The picture is a function of the world and the settings alone: the same bytes for any number of
/// threads and any tracer. `settings` have the picture's size that the world's camera was built
/// for, and values in the ranges that their documentation states.
pub fn render(world: &World, settings: &Settings, options: &Options) -> Render {
    let start = Instant::now();
    let sampler = Sampler::new(settings.sampler, settings.seed, settings.spp);
    let filter = PixelFilter::new(settings.filter);
    let settings = in_world_units(world, settings);
    let job = Job {
        world,
        settings: &settings,
        sampler: &sampler,
        filter: &filter,
        tracer: options.tracer,
    };
    let camera = &world.camera;
    let whole = Region { x: 0, y: 0, width: camera.width, height: camera.height };
    let mut film = Film::new(options.region.unwrap_or(whole));
    let total = film.tiles.len() as u64 * u64::from(settings.spp);
    let (done, rays) = (AtomicU64::new(0), AtomicU64::new(0));
    let totals = Mutex::new((Counters::default(), Times::default()));
    let cancelled = || options.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
    let finish = |work: &mut Workspace, samples: u32| {
        let counted = std::mem::take(&mut work.counters);
        let rays = rays.fetch_add(counted.rays(), Ordering::Relaxed) + counted.rays();
        let samples = u64::from(samples);
        let done = done.fetch_add(samples, Ordering::Relaxed) + samples;
        if let Ok(mut totals) = totals.lock() {
            totals.0.add(&counted);
            totals.1.add(&work.clock.take());
        }
        if let Some(progress) = options.progress {
            let done = done as f64 / total as f64;
            progress(Progress { done, rays, elapsed: start.elapsed() });
        }
    };
    if options.tracer.method != Method::Brute {
        film.tiles.par_iter_mut().for_each(|tile| tile.view = view(&job, tile));
    }
    for samples in passes(settings.spp).take_while(|_| !cancelled()) {
        film.tiles.par_iter_mut().for_each_init(
            || Workspace::new(world, &sampler),
            |work, tile| {
                if !cancelled() {
                    tile_pass(&job, tile, samples.clone(), work);
                    finish(work, samples.end - samples.start);
                }
            },
        );
    }
    let (counters, times) = totals.into_inner().unwrap_or_default();
    Render {
        image: film.resolve(),
        counters,
        times,
        elapsed: start.elapsed(),
        complete: done.into_inner() == total,
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

/// What camera rays of a tile may hit.
pub(crate) fn view(job: &Job, tile: &Tile) -> View {
    let world = job.world;
    let reach = f64::from(job.filter.radius()) - 0.5;
    let Region { x, y, width, height } = tile.region;
    let low = DVec2::new(f64::from(x), f64::from(y)) - reach;
    let high = DVec2::new(f64::from(x + width), f64::from(y + height)) + reach;
    let [origin, direction] = world.camera.bounds(low, high);
    let single = |v: [DVec3; 2]| v.map(DVec3::as_vec3);
    let hit = world.bvh.may_be_hit(&world.spheres, single(origin), single(direction));
    if hit { View::Anything } else { View::Background }
}

/// What all rays see that hit no sphere, if it is the same.
fn even_background(world: &World) -> Option<Rgb> {
    let only = world.ground.is_none() && world.lights.suns.is_empty();
    world.environment.constant().filter(|_| only)
}

/// Adds samples to the pixels of a tile.
fn tile_pass(job: &Job, tile: &mut Tile, samples: Range<u32>, work: &mut Workspace) {
    let count = samples.end - samples.start;
    work.clock.restart();
    if let Some(radiance) = even_background(job.world).filter(|_| tile.view == View::Background) {
        tile.add_even(radiance, count);
        work.counters.skipped_samples += u64::from(count) * tile.pixels().count() as u64;
        return work.clock.end(Stage::Film);
    }
    work.view = tile.view;
    stages::generate(job, tile, samples, work);
    let paths = work.len();
    job.integrate(work);
    work.clock.end(Stage::Shade);
    work.counters.bad_samples += tile.add(&work.paths.radiance[..paths], count);
    work.clock.end(Stage::Film);
}
