//! Renders with an error target or a time limit: rounds over the tiles that need more samples.

use super::end::End;
use super::pass::{self, PASS};
use super::state::{State, Step};
use super::watch::Watch;
use crate::elementary::pow;
use crate::film::Tile;
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use crate::noise::{self, Noise, Slope, StopCondition};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of pilot samples in a picture, below which the pilot takes more than one per pixel; and
/// number of pixels from which on it samples only one pixel of four.
const PILOT: (u64, u64) = (4096, 65_536);

/// Interval of looking at the clock: fraction of the time limit, and minimum in seconds.
const CLOCK_CHECKS: (f64, f64) = (0.02, 0.1);

/// Fraction of the squared error below which light that probes have not found does not matter: with more, a
/// render does not end at the first look.
const SEEN: f64 = 0.05;

/// Renders until the target is met.
pub(super) fn run(job: &Job, state: &mut State, stop: &StopCondition, watch: &Watch) -> End {
    start(job, state, stop, watch);
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
            let noise = state.noise(stop.until_error.is_some());
            if stop.until_error.zip(noise).is_some_and(|(error, noise)| {
                noise.bound <= error && (noise.expected < SEEN || state.round > 1)
            }) {
                return End::Error;
            }
            if !state.next_round(stop, noise) {
                return End::Samples;
            }
        }
        refine(job, state, stop, watch, pause);
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
    let even = |tile: &Tile| tile.samples == 0 && pass::uniform_radiance(job.world, tile).is_some();
    let unpiloted = |tile: &Tile| stop.until_error.is_some() && tile.probes.pilot.is_none();
    let tiles = state.film.tiles.iter_mut().filter(|tile| even(tile) || unpiloted(tile));
    for_each_tile(job, tiles.collect::<Vec<_>>(), watch, |tile, work| {
        if even(tile) {
            pass::tile_pass(job, tile, 0..stop.first_samples(), work);
        }
        if unpiloted(tile) {
            pass::pilot_pass(job, tile, (block, samples), work);
        }
        watch.report(work, None, 0.0, None);
    });
}

/// Makes the next steps of the plan: all of them, or as many as fit into an interval.
fn refine(job: &Job, state: &mut State, stop: &StopCondition, watch: &Watch, pause: Option<f64>) {
    let noise = state.noise(stop.until_error.is_some());
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
    let added = AtomicU64::new(0);
    for_each_tile(job, state.take(count), watch, |(tile, to), work| {
        let rays = rays(tile, to);
        advance(job, tile, to, watch, work);
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

/// Estimates the rays of a picture that meets the target from those so far.
fn expected_work(
    stop: &StopCondition,
    noise: Option<Noise>,
    spent: f64,
    slope: Slope,
) -> Option<f64> {
    let more = pow(stop.wanted(noise), -1.0 / slope.exponent());
    Some(spent * more.max(1.0)).filter(|rays| rays.is_finite() && *rays > 0.0)
}

/// Brings the pixels of a tile and its probes to `to` samples.
fn advance(job: &Job, tile: &mut Tile, to: u32, watch: &Watch, work: &mut Workspace) {
    while tile.samples < to && !watch.cancelled() {
        let first = tile.samples;
        pass::tile_pass(job, tile, first..to.min(first.saturating_add(PASS)), work);
    }
    pass::probe_pass(job, tile, 0..to, work, || !watch.cancelled());
}

/// Processes each of the tiles, on all threads.
fn for_each_tile<T: Send>(
    job: &Job,
    tiles: impl IntoParallelIterator<Item = T>,
    watch: &Watch,
    each: impl Fn(T, &mut Workspace) + Sync,
) {
    tiles.into_par_iter().for_each_init(
        || Workspace::new(job.world, job.elisions),
        |work, tile| {
            if !watch.cancelled() {
                each(tile, work);
            }
        },
    );
}
