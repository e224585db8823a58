//! Renders with an error target or a time limit: rounds over the tiles that need more samples.

use super::device;
use super::end::End;
use super::pass::{self, PASS};
use super::schedule::TURNS;
use super::state::{State, Step};
use super::watch::Watch;
use crate::elementary::pow;
use crate::film::{TILE, Tile, View};
use crate::integrator::Job;
use crate::integrator::columns::BATCH_PATHS;
use crate::integrator::workspace::Workspace;
use crate::noise::{self, Noise, Slope, StopCondition};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of pilot samples in an image, below which the pilot takes more than one per pixel; and
/// number of pixels from which on it samples only one pixel of four.
const PILOT: (u64, u64) = (4096, 65_536);

/// Interval of looking at the clock: fraction of the time limit, and minimum in seconds.
const CLOCK_CHECKS: (f64, f64) = (0.02, 0.1);

/// Ratio of the image's error to the target from which on the judge is not asked, since that takes time: denoising
/// divides the error by 1.2 to 2.5 in most images.
const HOPELESS: f64 = 2.5;

/// Renders until the target is met.
pub(super) fn run(job: &Job, state: &mut State, stop: &StopCondition, watch: &Watch) -> End {
    start(job, state, stop, watch);
    let judge = watch.judge().filter(|_| stop.until_error.is_some());
    let mut judged = None;
    let pause = stop.time.map(|time| (CLOCK_CHECKS.0 * time.as_secs_f64()).max(CLOCK_CHECKS.1));
    loop {
        if watch.cancelled() {
            return End::Cancelled;
        }
        // Ends half an interval early at most, since the next end would be half an interval late.
        let late = pause.unwrap_or(0.0) / 2.0 + watch.elapsed().as_secs_f64();
        let time_up = stop.time.is_some_and(|time| late >= time.as_secs_f64());
        if time_up && state.round > 0 && state.begun == 0 {
            return End::Time;
        }
        if state.plan.is_empty() {
            let own = state.noise(stop.until_error.is_some());
            let hopeless = |(noise, target): (Noise, f64)| noise.error > HOPELESS * target;
            let noise = match judge {
                Some(judge) if !own.zip(stop.until_error).is_some_and(hopeless) => {
                    judge(&state.film)
                }
                _ => own,
            };
            judged = noise;
            if watch.cancelled() {
                return End::Cancelled;
            }
            if noise.is_some_and(|noise| stop.is_met(noise, state.least_samples(), state.round)) {
                return End::Error;
            }
            if !state.next_round(stop, noise) {
                return End::Samples;
            }
        }
        let noise = if judge.is_some() { judged } else { state.noise(stop.until_error.is_some()) };
        refine(job, state, stop, noise, watch, pause);
    }
}

/// Does the work that is done only once: tiles that need no rays, and the pilot if there is an error
/// target. Work that was done before an interruption stays.
fn start(job: &Job, state: &mut State, stop: &StopCondition, watch: &Watch) {
    if state.round > 0 {
        return;
    }
    let pixels = state.film.pixels();
    let samples = PILOT.0.div_ceil(pixels).clamp(1, u64::from(PASS)) as u32;
    let block = if pixels < PILOT.1 { 1 } else { 4 };
    let tiles = state.film.tiles.iter_mut();
    let even = tiles.filter(|tile| tile.samples == 0 && tile.probes.streams() == 0);
    let even = even.map(|tile| (tile, stop.first_samples())).collect();
    let paths = |tile: &Tile, samples| (tile.len() * samples) as usize;
    for_each_batch(job, batches(even, paths), watch, |(tiles, to), work| {
        pass::tile_pass(job, tiles, 0..to, work);
    });
    if stop.until_error.is_none() {
        return;
    }
    let unpiloted = state.film.tiles.iter_mut().filter(|tile| tile.probes.pilot.is_none());
    let unpiloted = unpiloted.map(|tile| (tile, samples)).collect();
    let paths = |tile: &Tile, samples| pass::pilot_paths(tile, block, samples);
    for_each_batch(job, batches(unpiloted, paths), watch, |(tiles, samples), work| {
        pass::pilot_pass(job, tiles, block, samples, work);
        watch.report(work, None, 0.0, None);
    });
}

/// Makes the next steps of the plan: all of them, or as many as fit into an interval.
fn refine(
    job: &Job,
    state: &mut State,
    stop: &StopCondition,
    noise: Option<Noise>,
    watch: &Watch,
    pause: Option<f64>,
) {
    let spent = state.work();
    let rate = spent / watch.elapsed().as_secs_f64();
    let mut budget = pause.filter(|_| spent > 0.0).map_or(f64::INFINITY, |pause| pause * rate);
    let fits = |step: &&Step| {
        budget -= rays(&state.film.tiles[step.tile as usize], step.samples);
        budget > 0.0
    };
    let count = state.plan.iter().take_while(fits).count();
    let count = count.max(rayon::current_num_threads()).max(state.begun).min(state.plan.len());
    let expected = expected_work(stop, noise, spent, state.slope);
    let steps = state.take(count).into_iter().map(|(tile, to)| {
        let samples = tile.samples.min(to)..to;
        (tile, samples)
    });
    device::run(job, steps, None, watch, |work, _| {
        let done = expected.map_or(0.0, |expected| (spent / expected).min(1.0));
        watch.report(work, None, done, noise);
    });
    let added = AtomicU64::new(0);
    let paths = |tile: &Tile, to| pass::probe_paths(tile, to - tile.probes.samples.min(to));
    for_each_batch(job, batches(state.take(count), paths), watch, |(tiles, to), work| {
        let rays: f64 = tiles.iter().map(|tile| rays(tile, to)).sum();
        advance(job, tiles, to, watch, work);
        let added = added.fetch_add(rays as u64, Ordering::Relaxed) as f64 + rays;
        let by_error = expected.map_or(0.0, |expected| (spent + added) / expected);
        let by_time = stop.time.map_or(0.0, |time| watch.elapsed().div_duration_f64(time));
        watch.report(work, None, by_error.max(by_time).min(1.0), noise);
    });
    state.remove_done(count);
}

/// Estimates the rays that bring a tile to `to` samples from those of its samples so far.
fn rays(tile: &Tile, to: u32) -> f64 {
    (f64::from(to) / f64::from(tile.samples.max(1)) - 1.0) * noise::work(tile)
}

/// Estimates the rays of an image that meets the target from those so far.
fn expected_work(
    stop: &StopCondition,
    noise: Option<Noise>,
    spent: f64,
    slope: Slope,
) -> Option<f64> {
    let more = pow(stop.wanted(noise), -1.0 / slope.exponent());
    Some(spent * more.max(1.0)).filter(|rays| rays.is_finite() && *rays > 0.0)
}

/// Brings the pixels of the tiles of a batch and their probes to `to` samples.
fn advance(job: &Job, tiles: &mut [&mut Tile], to: u32, watch: &Watch, work: &mut Workspace) {
    let Some(mut first) = tiles.first().map(|tile| tile.samples) else { return };
    while first < to {
        let end = to.min(first.saturating_add(PASS));
        let paths = (TILE * TILE * (end - first)) as usize;
        for tiles in tiles.chunks_mut((BATCH_PATHS / paths).max(1)) {
            if watch.cancelled() {
                return;
            }
            pass::tile_pass(job, tiles, first..end, work);
        }
        first = end;
    }
    pass::probe_pass(job, tiles, 0..to, work, || !watch.cancelled());
}

/// Tiles of the same view and with equally many samples, which are to get as many as the number says.
type Batch<'a> = (Vec<&'a mut Tile>, u32);

/// Divides steps of tiles into batches. Few paths at once take longer, so the probes of a batch, or other samples
/// of which each tile has `paths`, are traced together; but there are enough batches for all threads.
fn batches(
    mut steps: Vec<(&mut Tile, u32)>,
    paths: impl Fn(&Tile, u32) -> usize,
) -> Vec<Batch<'_>> {
    let kind =
        |tile: &Tile, to: u32| (tile.view == View::Anything, tile.samples, tile.probes.samples, to);
    steps.sort_by_key(|(tile, to)| kind(tile, *to));
    let most = steps.len().div_ceil(TURNS * rayon::current_num_threads());
    let mut batches: Vec<Batch> = Vec::new();
    let mut left = 0_usize;
    for (tile, to) in steps {
        let paths = paths(tile, to);
        let last = batches.last_mut().filter(|(tiles, end)| {
            paths <= left && tiles.len() < most && kind(tiles[0], *end) == kind(tile, to)
        });
        if let Some((tiles, _)) = last {
            left -= paths;
            tiles.push(tile);
        } else {
            left = BATCH_PATHS.saturating_sub(paths);
            batches.push((vec![tile], to));
        }
    }
    batches
}

/// Processes all batches, on all threads.
fn for_each_batch(
    job: &Job,
    batches: Vec<Batch>,
    watch: &Watch,
    each: impl Fn((&mut [&mut Tile], u32), &mut Workspace) + Sync,
) {
    batches.into_par_iter().for_each_init(
        || Workspace::new(job.world, job.elisions),
        |work, (mut tiles, to)| {
            if !watch.cancelled() {
                each((&mut tiles, to), work);
            }
        },
    );
}
