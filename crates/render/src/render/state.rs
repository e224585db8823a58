//! State of a render: film, plan of steps, and noise.

use super::pass;
use crate::film::{Density, Film, Tile, View};
use crate::integrator::Job;
use crate::noise::{self, Estimate, Noise, Slope, StopCondition};
use serde::{Deserialize, Serialize};

/// The state that decides all further work: a render that resumes from a saved state makes the same
/// image as one without interruptions.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Sums, probes and counts.
    pub(super) film: Film,
    /// Number of rounds that were started.
    pub(super) round: u32,
    /// Remaining steps of this round, in order.
    pub(super) plan: Vec<Step>,
    /// Steps at the head of the plan that were in progress when the render was cancelled: all of them
    /// are continued first, so that the steps of any later end are a prefix of the one sequence.
    pub(super) begun: usize,
    /// Tiles that this round refines, with enough samples before it to learn from their steps.
    pub(super) refined: Vec<u32>,
    /// Variances and samples of these steps before the round, by steering probes.
    pub(super) steps: Slope,
    /// The rate learned so far.
    pub(super) slope: Slope,
}

/// A step of a plan: samples of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Step {
    /// Index in the film.
    pub(super) tile: u32,
    /// Samples per pixel after the step.
    pub(super) samples: u32,
}

impl State {
    /// Returns the state of a render that has not started. Tiles of this view need no probes if all their samples are
    /// equal, whether the render knows that or not.
    pub(super) fn new(job: &Job, mut film: Film, views: &[View]) -> Self {
        let world = job.world;
        let mut views = views.iter();
        film.place_probes(Density::of(film.pixels()), job.settings.seed, |_| {
            views.next().is_none_or(|&view| pass::uniform_radiance(world, view).is_none())
        });
        Self::unmeasured(film)
    }

    /// Returns the state of a render that measures nothing.
    pub(super) fn unmeasured(film: Film) -> Self {
        Self {
            film,
            round: 0,
            plan: Vec::new(),
            begun: 0,
            refined: Vec::new(),
            steps: Slope::before(std::iter::empty()),
            slope: Slope::default(),
        }
    }

    /// Estimates the error of the image, once all pixels have samples. For a decision, `by_probes`,
    /// the mean radiance is that of pilot and probes alone.
    pub(super) fn noise(&self, by_probes: bool) -> Option<Noise> {
        let begun = self.film.tiles.iter().all(|tile| tile.samples > 0);
        let mean = if by_probes {
            noise::mean_radiance(&self.film)
        } else {
            Estimate { value: self.film.mean(), ..Estimate::default() }
        };
        begun.then(|| Noise::new(noise::squared_error(&self.film), self.film.pixels(), mean))
    }

    /// Returns the minimum number of samples per pixel.
    pub(super) fn least_samples(&self) -> u32 {
        self.film.tiles.iter().map(|tile| tile.samples).min().unwrap_or(0)
    }

    /// Ends a round and plans the next; returns false if no pixel can get more samples.
    pub(super) fn next_round(&mut self, stop: &StopCondition, noise: Option<Noise>) -> bool {
        if !self.refined.is_empty() {
            let variance = |&tile: &u32| noise::steering_variance(&self.film.tiles[tile as usize]);
            let after = self.refined.iter().map(variance).sum();
            self.slope.learn(self.steps.after(after));
        }
        let wanted = stop.wanted(noise);
        let plan = noise::next_round(&self.film, stop, self.slope, noise);
        let tiles = &self.film.tiles;
        let step = |tile: u32| {
            let samples = tiles[tile as usize].samples;
            let even = samples < stop.first_samples();
            let next = if even {
                stop.next_even(samples, wanted)
            } else {
                stop.next_samples(samples, tiles.len(), noise)
            };
            Step { tile, samples: next }
        };
        self.plan = plan.into_iter().map(step).collect();
        let refines = |step: &&Step| tiles[step.tile as usize].samples >= stop.first_samples();
        let refined = self.plan.iter().filter(refines);
        self.steps = Slope::before(refined.clone().map(|step| {
            let tile = &tiles[step.tile as usize];
            (noise::steering_variance(tile), tile.samples, step.samples)
        }));
        self.refined = refined.map(|step| step.tile).collect();
        self.round += 1;
        !self.plan.is_empty()
    }

    /// Returns the rays that the image has taken.
    pub(super) fn work(&self) -> f64 {
        self.film.tiles.iter().map(noise::work).sum()
    }

    /// Returns the tiles of the first `count` steps, with their samples after the step.
    pub(super) fn take(&mut self, count: usize) -> Vec<(&mut Tile, u32)> {
        let mut samples = vec![None; self.film.tiles.len()];
        self.plan[..count].iter().for_each(|step| samples[step.tile as usize] = Some(step.samples));
        let tiles = self.film.tiles.iter_mut().zip(samples);
        tiles.filter_map(|(tile, samples)| Some((tile, samples?))).collect()
    }

    /// Removes those of the first `count` steps that are done.
    pub(super) fn remove_done(&mut self, count: usize) {
        let mut at = 0;
        let tiles = &self.film.tiles;
        let before = self.plan.len();
        self.plan.retain(|step| {
            at += 1;
            at > count || !step.is_done(&tiles[step.tile as usize])
        });
        self.begun = count - (before - self.plan.len());
    }
}

impl Step {
    /// Returns whether the tile and its probes have the samples of this step.
    fn is_done(self, tile: &Tile) -> bool {
        let probed = tile.probes.streams() == 0 || tile.probes.samples >= self.samples;
        probed && tile.samples >= self.samples
    }
}
