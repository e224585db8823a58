//! Times of several programs that render a scene, and comparison of their images.

use crate::bench::BenchError;
use crate::bench::rounds::{Times, clock};
use crate::bench::threads::pool;
use crate::report::{Cell, Column, Style};
use spherule_paper::{PaperTracer, Threading};
use spherule_render::image::{Comparison, Image, compare};
use spherule_render::render::{self, render};
use spherule_render::scene::{Scene, Settings};
use spherule_render::world::World;

/// Minimum duration of a turn in seconds; short renders are repeated.
pub(crate) const TURN: f64 = 0.02;

/// Tolerated difference of means, in standard errors.
const SIGMAS: f64 = 5.0;
/// Tolerated difference of two images, as a multiple of their noise.
const NOISE: f64 = 1.5;

/// A renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Program {
    /// The paper's tracer without its tree.
    Brute(Threading),
    /// The paper's tracer with its tree.
    Paper(Threading),
    /// Spherule.
    Spherule,
}

/// A scene, set up for every program.
pub(crate) struct SceneSetup {
    pub(crate) settings: Settings,
    world: World,
    brute: PaperTracer,
    paper: PaperTracer,
}

/// A program with its scene, settings and number of threads.
#[derive(Clone)]
pub(crate) struct Entry<'a> {
    pub(crate) setup: &'a SceneSetup,
    pub(crate) program: Program,
    pub(crate) settings: Settings,
    pub(crate) threads: usize,
}

/// The difference of two programs' images, as displayed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreement {
    /// Difference of means, relative to the mean.
    difference: f64,
    /// Standard error of `difference`.
    error: f64,
    /// Root mean square of the difference of pixels, relative to that of two renders by Spherule with
    /// different seeds.
    noises: f64,
}

impl SceneSetup {
    pub(crate) fn new(scene: &Scene) -> Result<Self, BenchError> {
        let named = |error| BenchError::World(scene.title.clone(), error);
        let world = World::build(scene).map_err(named)?;
        let [brute, paper] = [false, true].map(|tree| PaperTracer::new(scene, &world, tree));
        Ok(Self { settings: scene.settings.clone(), world, brute: brute?, paper: paper? })
    }

    /// Renders once; returns the image and the number of rays.
    pub(crate) fn render(
        &self,
        program: Program,
        settings: &Settings,
    ) -> Result<(Image, u64), BenchError> {
        let by_paper = |tracer: &PaperTracer, threading| {
            let render = tracer.render(settings, threading)?;
            Ok((render.image, render.rays))
        };
        match program {
            Program::Brute(threading) => by_paper(&self.brute, threading),
            Program::Paper(threading) => by_paper(&self.paper, threading),
            Program::Spherule => {
                let render = render(&self.world, settings, &render::Options::default())?;
                Ok((render.image, render.counters.rays()))
            }
        }
    }

    /// Compares a program's image with Spherule's at the same settings.
    ///
    /// # Errors
    /// They differ by more than noise.
    pub(crate) fn agreement(
        &self,
        program: Program,
        settings: &Settings,
    ) -> Result<Agreement, BenchError> {
        let again = Settings { seed: settings.seed + 1, ..settings.clone() };
        let theirs = self.render(program, settings)?.0;
        let ours = self.render(Program::Spherule, settings)?.0;
        let other = self.render(Program::Spherule, &again)?.0;
        let (found, noise) =
            (compare_displayed(&theirs, &ours)?, compare_displayed(&other, &ours)?);
        let mean = mean(&displayed(&ours));
        let agreement = Agreement {
            difference: found.bias / mean,
            error: found.bias_standard_error / mean,
            noises: found.rmse / noise.rmse,
        };
        if agreement.is_within_noise() {
            Ok(agreement)
        } else {
            Err(BenchError::Differ(format!(
                "the images of {program:?} and Spherule differ: {agreement:?}"
            )))
        }
    }
}

/// Renders entries in turns.
pub(crate) fn time_entries(rounds: u32, entries: &[Entry]) -> Result<Times, BenchError> {
    let pools: Vec<_> =
        entries.iter().map(|entry| pool(entry.threads)).collect::<Result<_, _>>()?;
    Times::measure(rounds, entries.len(), |index| {
        let Entry { setup, program, settings, .. } = &entries[index];
        pools[index].install(|| {
            let (seconds, rendered) = clock(TURN, || setup.render(*program, settings));
            rendered.map(|_| seconds)
        })
    })
}

impl Agreement {
    fn is_within_noise(&self) -> bool {
        self.difference.abs() <= SIGMAS * self.error && self.noises <= NOISE
    }

    /// Returns the columns of [`Agreement::cells`].
    pub(crate) fn columns() -> [Column; 3] {
        [
            Column::new(
                "means differ by",
                "Mean of the paper's image minus that of Spherule's, relative to the latter; of \
                 radiance clamped to 1, as on a display.",
            )
            .group("pictures")
            .style(Style::Percent),
            Column::new("standard error", "Standard error of the difference of means.")
                .style(Style::Percent),
            Column::new(
                "noises",
                "Root mean square of the two images' difference, relative to that of two images by \
                 Spherule with different seeds: 1 if they differ only by noise.",
            )
            .style(Style::Fixed(2)),
        ]
    }

    /// Returns the cells of a row.
    pub(crate) fn cells(&self) -> [Cell; 3] {
        [self.difference, self.error, self.noises].map(Cell::Number)
    }
}

/// Compares two images.
pub(crate) fn compare_images(image: &Image, other: &Image) -> Result<Comparison, BenchError> {
    compare(image, other).map_err(|error| BenchError::Differ(error.to_string()))
}

/// Compares two images as displayed.
pub(crate) fn compare_displayed(image: &Image, other: &Image) -> Result<Comparison, BenchError> {
    compare_images(&displayed(image), &displayed(other))
}

/// Clamps radiance to 1. Otherwise the few pixels in which a mirror shows an emitter would dominate.
fn displayed(image: &Image) -> Image {
    let pixels = image.pixels.iter().map(|pixel| pixel.map(|value| value.min(1.0)));
    Image { pixels: pixels.collect(), ..*image }
}

/// Returns the mean of all values.
pub(crate) fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flatten().copied().map(f64::from).sum();
    sum / (3 * image.pixels.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::super::scenes::PaperScene;
    use super::*;

    #[test]
    fn images_of_different_scenes_do_not_agree() {
        let setup = |scene: PaperScene| SceneSetup::new(&scene.scene(48, 16).unwrap()).unwrap();
        let (mut grid, field) = (setup(PaperScene::GRID), setup(PaperScene::FIELD));
        let agreement = |setup: &SceneSetup| {
            setup.agreement(Program::Paper(Threading::Independent), &setup.settings)
        };
        assert!(agreement(&grid).is_ok());
        grid.paper = field.paper;
        assert!(matches!(agreement(&grid), Err(BenchError::Differ(_))));
    }

    #[test]
    fn noise_is_tolerated() {
        let noisy = Agreement { difference: -0.04, error: 0.01, noises: 1.1 };
        assert!(noisy.is_within_noise());
        assert!(!Agreement { difference: 0.06, ..noisy }.is_within_noise());
        assert!(!Agreement { noises: 2.0, ..noisy }.is_within_noise());
        assert!(!Agreement { noises: f64::NAN, ..noisy }.is_within_noise());
    }
}
