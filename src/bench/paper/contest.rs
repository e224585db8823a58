//! A scene that several programs render, and whether they come to the same picture.

use crate::bench::BenchError;
use crate::bench::rounds::{Times, clock};
use crate::bench::threads::pool;
use crate::image::{Comparison, Image, compare};
use crate::paper::{Threading, Tracer};
use crate::render::{self, render};
use crate::report::{Cell, Column, Style};
use crate::scene::{Scene, Settings};
use crate::world::World;

/// Seconds that a turn takes at least: short renders are repeated.
pub(crate) const TURN: f64 = 0.02;

/// Standard errors that means may differ by chance, and how many times the noise the difference of
/// two pictures may be: both are met by any two sound renders.
const SIGMAS: f64 = 5.0;
const NOISE: f64 = 1.5;

/// What renders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Program {
    /// The paper's tracer, without its tree.
    Brute(Threading),
    /// The paper's tracer.
    Paper(Threading),
    /// This program.
    Spherule,
}

/// A scene, ready for every program.
pub(crate) struct Stage {
    pub(crate) settings: Settings,
    world: World,
    brute: Tracer,
    paper: Tracer,
}

/// A program, what it is asked for, and on how many threads.
#[derive(Clone)]
pub(crate) struct Entry<'a> {
    pub(crate) stage: &'a Stage,
    pub(crate) program: Program,
    pub(crate) settings: Settings,
    pub(crate) threads: usize,
}

/// How two programs' pictures differ, as a display shows them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreement {
    /// Of means, relative to the mean.
    difference: f64,
    /// Standard error of `difference`.
    error: f64,
    /// Root mean square of the difference of pixels, in units of what two renders of Spherule with
    /// other random numbers differ by.
    noises: f64,
}

impl Stage {
    pub(crate) fn new(scene: &Scene) -> Result<Self, BenchError> {
        let named = |error| BenchError::World(scene.title.clone(), error);
        let world = World::build(scene).map_err(named)?;
        let [brute, paper] = [false, true].map(|tree| Tracer::new(scene, &world, tree));
        Ok(Self { settings: scene.settings.clone(), world, brute: brute?, paper: paper? })
    }

    /// One render; the picture and the number of rays.
    pub(crate) fn render(
        &self,
        program: Program,
        settings: &Settings,
    ) -> Result<(Image, u64), BenchError> {
        let of_paper = |tracer: &Tracer, threading| {
            let render = tracer.render(settings, threading)?;
            Ok((render.image, render.rays))
        };
        match program {
            Program::Brute(threading) => of_paper(&self.brute, threading),
            Program::Paper(threading) => of_paper(&self.paper, threading),
            Program::Spherule => {
                let render = render(&self.world, settings, &render::Options::default())?;
                Ok((render.image, render.counters.rays()))
            }
        }
    }

    /// Compares a program's picture with Spherule's at the same settings.
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
        let (found, noise) = (shown_against(&theirs, &ours)?, shown_against(&other, &ours)?);
        let mean = mean(&shown(&ours));
        let agreement = Agreement {
            difference: found.bias / mean,
            error: found.bias_standard_error / mean,
            noises: found.rmse / noise.rmse,
        };
        if agreement.is_sound() {
            Ok(agreement)
        } else {
            Err(BenchError::Differ(format!("the pictures of {program:?} differ: {agreement:?}")))
        }
    }
}

/// Lets entries render by turns.
pub(crate) fn contest(rounds: u32, entries: &[Entry]) -> Result<Times, BenchError> {
    let pools: Vec<_> =
        entries.iter().map(|entry| pool(entry.threads)).collect::<Result<_, _>>()?;
    Times::by_turns(rounds, entries.len(), |index| {
        let Entry { stage, program, settings, .. } = &entries[index];
        pools[index].install(|| {
            let (seconds, rendered) = clock(TURN, || stage.render(*program, settings));
            rendered.map(|_| seconds)
        })
    })
}

impl Agreement {
    fn is_sound(&self) -> bool {
        self.difference.abs() <= SIGMAS * self.error && self.noises <= NOISE
    }

    /// The columns that tell it.
    pub(crate) fn columns() -> [Column; 3] {
        [
            Column::new(
                "means differ by",
                "Mean of the paper's picture less that of Spherule's, over the mean; of radiance up \
                 to 1, which is what displays show.",
            )
            .group("pictures")
            .style(Style::Percent),
            Column::new("standard error", "What the means may differ by, by chance.")
                .style(Style::Percent),
            Column::new(
                "noises",
                "Root mean square of the two pictures' difference, over that of two pictures of \
                 Spherule with other random numbers: 1 if they differ by noise alone.",
            )
            .style(Style::Fixed(2)),
        ]
    }

    /// The cells for them.
    pub(crate) fn cells(&self) -> [Cell; 3] {
        [self.difference, self.error, self.noises].map(Cell::Number)
    }
}

/// How a picture differs from another one.
pub(crate) fn held_against(picture: &Image, other: &Image) -> Result<Comparison, BenchError> {
    compare(picture, other).map_err(|error| BenchError::Differ(error.to_string()))
}

/// How what a display shows of a picture differs from what it shows of another one.
pub(crate) fn shown_against(picture: &Image, other: &Image) -> Result<Comparison, BenchError> {
    held_against(&shown(picture), &shown(other))
}

/// Radiance up to 1: the few pixels in which a mirror shows a lamp would outweigh all others.
fn shown(image: &Image) -> Image {
    let pixels = image.pixels.iter().map(|pixel| pixel.map(|value| value.min(1.0)));
    Image { pixels: pixels.collect(), ..*image }
}

/// The mean of all values.
pub(crate) fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flatten().copied().map(f64::from).sum();
    sum / (3 * image.pixels.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::super::scenes::PaperScene;
    use super::*;

    #[test]
    fn pictures_of_other_scenes_do_not_agree() {
        let stage = |scene: PaperScene| Stage::new(&scene.scene((48, 16)).unwrap()).unwrap();
        let (mut grid, field) = (stage(PaperScene::GRID), stage(PaperScene::FIELD));
        let agreement = |stage: &Stage| {
            stage.agreement(Program::Paper(Threading::Independent), &stage.settings)
        };
        assert!(agreement(&grid).is_ok());
        grid.paper = field.paper;
        assert!(matches!(agreement(&grid), Err(BenchError::Differ(_))));
    }

    #[test]
    fn noise_is_no_difference() {
        let sound = Agreement { difference: -0.04, error: 0.01, noises: 1.1 };
        assert!(sound.is_sound());
        assert!(!Agreement { difference: 0.06, ..sound }.is_sound());
        assert!(!Agreement { noises: 2.0, ..sound }.is_sound());
        assert!(!Agreement { noises: f64::NAN, ..sound }.is_sound());
    }
}
