//! Strategies render in turns, and each image is compared with a reference.

use super::Strategy;
use crate::bench::BenchError;
use crate::bench::paper::{Program, SceneSetup, TURN, compare_displayed, compare_images, mean};
use crate::bench::rounds::{Times, clock};
use crate::report::Spread;
use spherule_render::image::Image;
use spherule_render::scene::{Integrator, Roulette, SamplerKind, Scene, Settings};

/// Tolerated bias of a mean in standard errors; high, since samples that hit an emitter are rare.
const SIGMAS: f64 = 6.0;

/// First seed of the reference.
const REFERENCE_SEED: u64 = 1 << 32;

/// A scene with its reference.
pub(super) struct Experiment {
    setup: SceneSetup,
    rounds: u32,
    reference: Image,
    /// Root mean squared error of the reference as displayed.
    error: f64,
}

/// Time and error of a strategy with a number of samples.
pub(super) struct Outcome {
    pub(super) strategy: Strategy,
    pub(super) spp: u32,
    pub(super) seconds: Spread,
    /// Root mean squared error of the image as displayed.
    pub(super) error: Spread,
    /// Root mean squared error of radiance.
    pub(super) rmse: Spread,
    /// Bias of the mean of all runs, relative to the reference's mean.
    pub(super) bias: f64,
    /// Standard error of `bias`.
    pub(super) bias_error: f64,
}

impl Experiment {
    /// Renders the reference with about `samples` per pixel.
    pub(super) fn new(scene: &Scene, samples: u32, rounds: u32) -> Result<Self, BenchError> {
        let setup = SceneSetup::new(scene)?;
        // Two halves, whose difference estimates the error. Many samples need few shadow samples.
        let half = |seed| {
            let settings = Settings {
                spp: samples / 2,
                seed: REFERENCE_SEED + seed,
                integrator: Integrator::Whitted { shadow_samples: 8 },
                sampler: SamplerKind::Sobol,
                roulette: Roulette::None,
                ..setup.settings.clone()
            };
            Ok::<_, BenchError>(setup.render(Program::Spherule, &settings)?.0)
        };
        let halves = [half(0)?, half(1)?];
        // The deviation of a mean of two is half that of their difference.
        let error = compare_displayed(&halves[0], &halves[1])?.rmse / 2.0;
        let reference = average(&halves);
        Ok(Self { setup, rounds, reference, error })
    }

    pub(super) fn reference_error(&self) -> f64 {
        self.error
    }

    /// Renders in turns with strategies, each with a number of samples per pixel.
    pub(super) fn run(&self, entries: &[(Strategy, u32)]) -> Result<Vec<Outcome>, BenchError> {
        let mut images = vec![Vec::new(); entries.len()];
        let times = Times::measure(self.rounds, entries.len(), |index| {
            let (Strategy { program, roulette, .. }, spp) = entries[index];
            let seed = images[index].len() as u64 + 1;
            let settings = Settings { spp, seed, roulette, ..self.setup.settings.clone() };
            let (seconds, rendered) = clock(TURN, || self.setup.render(program, &settings));
            images[index].push(rendered?.0);
            Ok::<_, BenchError>(seconds)
        })?;
        let outcomes =
            entries.iter().zip(&images).enumerate().map(|(index, (&(strategy, spp), images))| {
                self.outcome(strategy, spp, times.seconds(index), images)
            });
        outcomes.collect()
    }

    fn outcome(
        &self,
        strategy: Strategy,
        spp: u32,
        seconds: Spread,
        images: &[Image],
    ) -> Result<Outcome, BenchError> {
        let errors = images.iter().map(|image| {
            let shown = compare_displayed(image, &self.reference)?.rmse;
            let own = (shown * shown - self.error * self.error).max(0.0).sqrt();
            Ok((own, compare_images(image, &self.reference)?.rmse))
        });
        let (errors, rmse): (Vec<_>, Vec<_>) =
            errors.collect::<Result<Vec<_>, BenchError>>()?.into_iter().unzip();
        let all = compare_images(&average(images), &self.reference)?;
        let mean = mean(&self.reference);
        let (bias, bias_error) = (all.bias / mean, all.bias_standard_error / mean);
        Ok(Outcome {
            strategy,
            spp,
            seconds,
            error: Spread::from_values(&errors),
            rmse: Spread::from_values(&rmse),
            bias,
            bias_error,
        })
    }
}

impl Outcome {
    /// Returns an error if the mean of all runs is biased.
    pub(super) fn check(&self) -> Result<(), BenchError> {
        let Self { strategy, bias, bias_error, .. } = self;
        if bias.abs() <= SIGMAS * bias_error {
            return Ok(());
        }
        let (bias, error) = (100.0 * bias, 100.0 * bias_error);
        let message = format!("{}: bias {bias:.2} %, standard error {error:.2} %", strategy.name);
        Err(BenchError::Differ(message))
    }

    /// Returns the seconds for one sample per pixel.
    pub(super) fn seconds_per_sample(&self) -> f64 {
        self.seconds.median / f64::from(self.spp)
    }

    /// Returns the speedup over `other` to equal error, if squared error is inversely proportional to
    /// time.
    pub(super) fn efficiency(&self, other: &Self) -> f64 {
        let cost = |outcome: &Self| outcome.error.median.powi(2) * outcome.seconds.median;
        cost(other) / cost(self)
    }
}

/// Returns the mean of images of equal size.
fn average(images: &[Image]) -> Image {
    let mut sum = images[0].clone();
    let weight = 1.0 / images.len() as f32;
    for (index, pixel) in sum.pixels.iter_mut().enumerate() {
        let mean =
            |channel: usize| images.iter().map(|image| image.pixels[index][channel] * weight).sum();
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
    fn a_wrong_reference_is_reported_as_bias() {
        let scene = PaperScene::TWO.scene(24, 4).unwrap();
        let mut experiment = Experiment::new(&scene, 256, 2).unwrap();
        let entry = [(STRATEGIES[3], 4)];
        assert!(experiment.run(&entry).unwrap()[0].check().is_ok());
        experiment.reference.pixels.iter_mut().flatten().for_each(|value| *value *= 1.5);
        assert!(matches!(experiment.run(&entry).unwrap()[0].check(), Err(BenchError::Differ(_))));
    }

    #[test]
    fn four_times_the_samples_have_half_the_error() {
        let scene = PaperScene::GRID.scene(32, 1).unwrap();
        let mut experiment = Experiment::new(&scene, 256, 2).unwrap();
        experiment.setup.settings.sampler = SamplerKind::Independent;
        let outcomes = experiment.run(&[1, 4].map(|spp| (STRATEGIES[3], spp))).unwrap();
        let ratio = outcomes[0].error.median / outcomes[1].error.median;
        assert!((1.3..3.0).contains(&ratio), "{ratio}");
        assert!(outcomes.iter().all(|outcome| outcome.error.median > experiment.error));
    }

    #[test]
    fn images_are_averaged_by_value() {
        let image = |value| Image::filled(2, 1, [value, 0.0, 1.0]).unwrap();
        assert_eq!(average(&[image(1.0), image(2.0)]), image(1.5));
    }
}
