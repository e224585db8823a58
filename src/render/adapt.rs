//! Renders that end when they are right, or when time is up: rounds over the tiles that need more.

use super::pass::{self, PASS};
use super::watch::Watch;
use crate::film::{Density, Film, Tile};
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use crate::noise::{self, Estimate, Goal, Noise, Slope};
use crate::scene::Settings;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Samples of a pixel from which on probes are believed.
pub(super) const FIRST: u32 = 16;

/// Samples of the pilot, all pixels taken together, below which it takes more than one of each; and
/// pixels from which on it takes but one of four.
const PILOT: (u64, u64) = (4096, 65_536);

/// Part of the time limit, and the least time in seconds, after which the clock is looked at.
const LOOKS: (f64, f64) = (0.02, 0.1);

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Every pixel has as many samples as it may have.
    Samples,
    /// The error is below the target.
    Error,
    /// Time is up.
    Time,
    /// Someone cancelled it.
    Cancelled,
}

/// All that an unfinished render knows. What comes next is a function of it, so a render that goes on
/// from a kept state makes the same picture as one that never stopped.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Sums, probes and counts.
    pub(super) film: Film,
    /// Rounds that were begun.
    pub(super) round: u32,
    /// Tiles of this round that still wait.
    plan: Vec<u32>,
    /// Tiles of this round whose samples it doubles, and their variance before, by steering probes.
    doubled: (Vec<u32>, f64),
    slope: Slope,
}

/// What ends a render.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub(super) error: Option<f64>,
    pub(super) time: Option<Duration>,
    pub(super) goal: Goal,
}

impl Target {
    pub(super) fn new(settings: &Settings) -> Self {
        let goal = Goal {
            first: FIRST.min(settings.spp),
            most: settings.spp,
            timed: settings.time.is_some(),
        };
        Self { error: settings.until_error, time: settings.time, goal }
    }

    /// The part of the squared error that may stay; 0 if there is no end to it.
    fn wanted(&self, noise: Option<Noise>) -> f64 {
        let part = self.error.zip(noise).map(|(error, noise)| (error / noise.bound).powi(2));
        part.unwrap_or(0.0)
    }
}

impl State {
    /// The state of a render that has not begun.
    pub(super) fn new(job: &Job, mut film: Film) -> Self {
        let world = job.world;
        film.place_probes(Density::of(film.pixels()), job.settings.seed, |tile| {
            pass::even(world, tile).is_none()
        });
        Self::unmeasured(film)
    }

    /// The same of a render that measures nothing.
    pub(super) fn unmeasured(film: Film) -> Self {
        let (plan, doubled) = (Vec::new(), (Vec::new(), 0.0));
        Self { film, round: 0, plan, doubled, slope: Slope::default() }
    }

    /// How far the picture is from its limit, once all pixels have samples. For a decision, `alone`,
    /// the mean radiance is what pilot and probes say.
    pub(super) fn noise(&self, alone: bool) -> Option<Noise> {
        let begun = self.film.tiles.iter().all(|tile| tile.samples > 0);
        let mean = if alone {
            noise::mean_radiance(&self.film)
        } else {
            Estimate { value: self.film.mean(), ..Estimate::default() }
        };
        begun.then(|| Noise::new(noise::squared_error(&self.film), self.film.pixels(), mean))
    }

    /// Ends a round and plans the next; false if all pixels have what they can get.
    fn next_round(&mut self, target: &Target, noise: Option<Noise>) -> bool {
        let tiles = &self.film.tiles;
        let variance = |plan: &[u32]| -> f64 {
            plan.iter().map(|&tile| noise::steering_variance(&tiles[tile as usize])).sum()
        };
        if self.doubled.1 > 0.0 {
            self.slope.learn(self.doubled.1, variance(&self.doubled.0));
        }
        let plan = noise::next_round(&self.film, &target.goal, self.slope, target.wanted(noise));
        let doubled = plan.iter().copied().filter(|&tile| {
            let samples = tiles[tile as usize].samples;
            samples >= target.goal.first
                && target.goal.next(samples, tiles.len()) == samples.saturating_mul(2)
        });
        let doubled: Vec<u32> = doubled.collect();
        self.doubled = (doubled.clone(), variance(&doubled));
        self.plan = plan;
        self.round += 1;
        !self.plan.is_empty()
    }

    /// Rays that the picture has taken.
    fn work(&self) -> f64 {
        self.film.tiles.iter().map(noise::work).sum()
    }

    /// The tiles that wait, in order; the first `count` of them do so no longer.
    fn take(&mut self, count: usize) -> Vec<bool> {
        let mut chosen = vec![false; self.film.tiles.len()];
        self.plan.drain(..count).for_each(|tile| chosen[tile as usize] = true);
        chosen
    }
}

/// Renders until the target is met.
pub(super) fn run(job: &Job, state: &mut State, target: &Target, watch: &Watch) -> End {
    begin(job, state, target, watch);
    loop {
        if state.plan.is_empty() {
            let noise = state.noise(target.error.is_some());
            if target.error.zip(noise).is_some_and(|(error, noise)| noise.bound <= error) {
                return End::Error;
            }
            if !state.next_round(target, noise) {
                return End::Samples;
            }
        }
        let pause = target.time.map(|time| (LOOKS.0 * time.as_secs_f64()).max(LOOKS.1));
        refine(job, state, target, watch, pause);
        if watch.cancelled() {
            return End::Cancelled;
        }
        // Half a pause late is as near as half a pause early.
        let late = pause.unwrap_or(0.0) / 2.0 + watch.elapsed().as_secs_f64();
        if target.time.is_some_and(|time| late >= time.as_secs_f64()) {
            return End::Time;
        }
    }
}

/// Does what is done but once: tiles that need no rays, and the pilot if a target asks for it.
fn begin(job: &Job, state: &mut State, target: &Target, watch: &Watch) {
    if state.round > 0 {
        return;
    }
    let pixels = state.film.pixels();
    let samples = PILOT.0.div_ceil(pixels).clamp(1, u64::from(PASS)) as u32;
    let block = if pixels < PILOT.1 { 1 } else { 4 };
    over(job, &mut state.film.tiles, watch, |tile, work| {
        if pass::even(job.world, tile).is_some() {
            pass::tile_pass(job, tile, 0..target.goal.first, work);
        }
        if target.error.is_some() {
            pass::pilot_pass(job, tile, (block, samples), work);
        }
        watch.report(work, 0.0, None);
    });
}

/// Takes the next step of tiles that wait: of all of them, or of as many as a pause allows.
fn refine(job: &Job, state: &mut State, target: &Target, watch: &Watch, pause: Option<f64>) {
    let noise = state.noise(target.error.is_some());
    let spent = state.work();
    let rate = spent / watch.elapsed().as_secs_f64();
    let tiles = state.film.tiles.len();
    let next = |samples: u32| target.goal.next(samples, tiles);
    let step = |tile: &Tile| {
        let share = f64::from(next(tile.samples)) / f64::from(tile.samples.max(1)) - 1.0;
        share * noise::work(tile)
    };
    let mut budget = pause.filter(|_| spent > 0.0).map_or(f64::INFINITY, |pause| pause * rate);
    let fits = |tile: &&u32| {
        budget -= step(&state.film.tiles[**tile as usize]);
        budget > 0.0
    };
    let count = state.plan.iter().take_while(fits).count().max(rayon::current_num_threads());
    let chosen = state.take(count.min(state.plan.len()));
    let expected = expected_work(target, noise, spent, state.slope);
    let added = AtomicU64::new(0);
    let mut tiles: Vec<&mut Tile> = state.film.tiles.iter_mut().collect();
    let mut flags = chosen.into_iter();
    tiles.retain(|_| flags.next() == Some(true));
    over(job, tiles, watch, |tile, work| {
        let (to, rays) = (next(tile.samples), step(tile));
        advance(job, tile, to, watch, work);
        let added = added.fetch_add(rays as u64, Ordering::Relaxed) as f64 + rays;
        let by_error = expected.map_or(0.0, |expected| (spent + added) / expected);
        let by_time = target.time.map_or(0.0, |time| watch.elapsed().div_duration_f64(time));
        watch.report(work, by_error.max(by_time).min(1.0), noise);
    });
}

/// Rays of a picture that meets the target, judging by what there is.
fn expected_work(target: &Target, noise: Option<Noise>, spent: f64, slope: Slope) -> Option<f64> {
    let more = target.wanted(noise).powf(-1.0 / slope.exponent());
    Some(spent * more.max(1.0)).filter(|rays| rays.is_finite() && *rays > 0.0)
}

/// Brings the pixels of a tile and its probes to `to` samples.
fn advance(job: &Job, tile: &mut Tile, to: u32, watch: &Watch, work: &mut Workspace) {
    while tile.samples < to && !watch.cancelled() {
        let first = tile.samples;
        pass::tile_pass(job, tile, first..to.min(first + PASS), work);
    }
    pass::probe_pass(job, tile, to, work, || !watch.cancelled());
}

/// Does something with each of the tiles, on all threads.
fn over<'t>(
    job: &Job,
    tiles: impl IntoParallelIterator<Item = &'t mut Tile>,
    watch: &Watch,
    each: impl Fn(&mut Tile, &mut Workspace) + Sync,
) {
    tiles.into_par_iter().for_each_init(
        || Workspace::new(job.world, job.sampler),
        |work, tile| {
            if !watch.cancelled() {
                each(tile, work);
            }
        },
    );
}
