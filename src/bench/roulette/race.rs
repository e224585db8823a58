//! Strategies render by turns, and each picture is held against a reference.

use super::Strategy;
use crate::bench::BenchError;
use crate::bench::paper::{Program, Stage, TURN, held_against, mean, shown_against};
use crate::bench::rounds::{Times, clock};
use crate::image::Image;
use crate::report::Spread;
use crate::scene::{Integrator, Roulette, SamplerKind, Scene, Settings};

/// Standard errors that a mean may be off by chance: many, as samples that meet a lamp are rare.
const SIGMAS: f64 = 6.0;

/// Seeds from here on are the reference's.
const REFERENCE_SEED: u64 = 1 << 32;

/// A scene with its reference.
pub(super) struct Race {
    stage: Stage,
    rounds: u32,
    reference: Image,
    /// Root mean square of what is shown, of the reference.
    error: f64,
}

/// What a strategy came to with a number of samples.
pub(super) struct Outcome {
    pub(super) strategy: Strategy,
    pub(super) spp: u32,
    pub(super) seconds: Spread,
    /// Root mean square of what is shown.
    pub(super) error: Spread,
    /// Root mean square.
    pub(super) rmse: Spread,
    /// Of the mean of all runs, relative to the reference's.
    pub(super) bias: f64,
    pub(super) bias_error: f64,
}

impl Race {
    /// The reference has about so many samples in each pixel.
    pub(super) fn new(scene: &Scene, samples: u32, rounds: u32) -> Result<Self, BenchError> {
        let stage = Stage::new(scene)?;
        // In two halves, whose difference tells the error; many samples need few shadow samples.
        let half = |seed| {
            let settings = Settings {
                spp: samples / 2,
                seed: REFERENCE_SEED + seed,
                integrator: Integrator::Whitted { shadow_samples: 8 },
                sampler: SamplerKind::Sobol,
                roulette: Roulette::None,
                ..stage.settings.clone()
            };
            Ok::<_, BenchError>(stage.render(Program::Spherule, &settings)?.0)
        };
        let halves = [half(0)?, half(1)?];
        // The mean of two has half the deviation that their difference has.
        let error = shown_against(&halves[0], &halves[1])?.rmse / 2.0;
        let reference = average(&halves);
        Ok(Self { stage, rounds, reference, error })
    }

    pub(super) fn reference_error(&self) -> f64 {
        self.error
    }

    /// Lets strategies, each with a number of samples per pixel, render by turns.
    pub(super) fn run(&self, entries: &[(Strategy, u32)]) -> Result<Vec<Outcome>, BenchError> {
        let mut pictures = vec![Vec::new(); entries.len()];
        let times = Times::by_turns(self.rounds, entries.len(), |index| {
            let (Strategy { program, roulette, .. }, spp) = entries[index];
            let seed = pictures[index].len() as u64 + 1;
            let settings = Settings { spp, seed, roulette, ..self.stage.settings.clone() };
            let (seconds, rendered) = clock(TURN, || self.stage.render(program, &settings));
            pictures[index].push(rendered?.0);
            Ok::<_, BenchError>(seconds)
        })?;
        let outcomes =
            entries.iter().zip(&pictures).enumerate().map(|(index, (entry, pictures))| {
                self.outcome(*entry, times.seconds(index), pictures)
            });
        outcomes.collect()
    }

    fn outcome(
        &self,
        (strategy, spp): (Strategy, u32),
        seconds: Spread,
        pictures: &[Image],
    ) -> Result<Outcome, BenchError> {
        let errors = pictures.iter().map(|picture| {
            let shown = shown_against(picture, &self.reference)?.rmse;
            let own = (shown * shown - self.error * self.error).max(0.0).sqrt();
            Ok((own, held_against(picture, &self.reference)?.rmse))
        });
        let (errors, rmse): (Vec<_>, Vec<_>) =
            errors.collect::<Result<Vec<_>, BenchError>>()?.into_iter().unzip();
        let all = held_against(&average(pictures), &self.reference)?;
        let mean = mean(&self.reference);
        let (bias, bias_error) = (all.bias / mean, all.bias_standard_error / mean);
        Ok(Outcome {
            strategy,
            spp,
            seconds,
            error: Spread::of(&errors),
            rmse: Spread::of(&rmse),
            bias,
            bias_error,
        })
    }
}

impl Outcome {
    /// An error if the mean of all runs is wrong.
    pub(super) fn check(&self) -> Result<(), BenchError> {
        let Self { strategy, bias, bias_error, .. } = self;
        if bias.abs() <= SIGMAS * bias_error {
            return Ok(());
        }
        let (bias, error) = (100.0 * bias, 100.0 * bias_error);
        let message = format!("{}: bias {bias:.2} %, standard error {error:.2} %", strategy.name);
        Err(BenchError::Differ(message))
    }

    /// Seconds for one sample in each pixel.
    pub(super) fn seconds_per_sample(&self) -> f64 {
        self.seconds.median / f64::from(self.spp)
    }

    /// How many times as long `other` takes to an equal error, if squared error falls as the
    /// inverse of time.
    pub(super) fn efficiency(&self, other: &Self) -> f64 {
        let cost = |outcome: &Self| outcome.error.median.powi(2) * outcome.seconds.median;
        cost(other) / cost(self)
    }
}

/// The mean of pictures of one size.
fn average(pictures: &[Image]) -> Image {
    let mut sum = pictures[0].clone();
    let share = 1.0 / pictures.len() as f32;
    for (index, pixel) in sum.pixels.iter_mut().enumerate() {
        let mean = |channel: usize| {
            pictures.iter().map(|picture| picture.pixels[index][channel] * share).sum()
        };
        *pixel = [0, 1, 2].map(mean);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::STRATEGIES;
    use super::*;
    use crate::bench::paper::PaperScene;

    #[test]
    fn a_wrong_reference_shows_as_bias() {
        let scene = PaperScene::TWO.scene((24, 4)).unwrap();
        let mut race = Race::new(&scene, 256, 2).unwrap();
        let entry = [(STRATEGIES[3], 4)];
        assert!(race.run(&entry).unwrap()[0].check().is_ok());
        race.reference.pixels.iter_mut().flatten().for_each(|value| *value *= 1.5);
        assert!(matches!(race.run(&entry).unwrap()[0].check(), Err(BenchError::Differ(_))));
    }

    #[test]
    fn four_times_the_samples_have_half_the_error() {
        let scene = PaperScene::GRID.scene((32, 1)).unwrap();
        let mut race = Race::new(&scene, 1024, 2).unwrap();
        race.stage.settings.sampler = SamplerKind::Independent;
        let outcomes = race.run(&[1, 4].map(|spp| (STRATEGIES[3], spp))).unwrap();
        let ratio = outcomes[0].error.median / outcomes[1].error.median;
        assert!((1.3..3.0).contains(&ratio), "{ratio}");
        assert!(outcomes.iter().all(|outcome| outcome.error.median > race.error));
    }

    #[test]
    fn averages_are_by_value() {
        let image = |value| Image::filled(2, 1, [value, 0.0, 1.0]).unwrap();
        assert_eq!(average(&[image(1.0), image(2.0)]), image(1.5));
    }
}
