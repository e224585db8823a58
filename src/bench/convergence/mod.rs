//! How soon a picture is good: error against time and samples, for sets of settings.
//!
//! The error is that against a reference, which is rendered once and kept. It is the mean of two
//! independent halves: a quarter of the mean square of their difference is the reference's own mean
//! squared error, which is taken off what is measured against it.

mod cache;
mod fit;
mod outcome;
mod reference;
mod tables;
mod variants;

pub use reference::{Reference, Squares};

use self::outcome::{Outcome, Picture};
use self::tables::{levels, plots, references, summary};
use self::variants::{Case, Variant, cases};
use super::rounds::Times;
use super::scenes::NamedScene;
use super::{BenchError, Options, Tell};
use crate::render::{self, RenderError, render};
use crate::report::Report;
use crate::scene::{Scene, Settings};
use crate::trace::Tracer;
use crate::world::World;

const EXPLANATION: &str = "Each variant renders with more and more samples, by turns, with another \
    seed in each round. Errors are over all channels of all pixels, in linear radiance, against a \
    reference: the mean of two halves with seeds of their own. A quarter of the mean square of the \
    halves' difference is the reference's own mean squared error; it is taken off, and what is left \
    is shown where it is more than the reference's own. Relative errors are divided by the square of \
    the reference and 0.01. Times are of rendering alone, on all threads. Efficiency is \
    1 / (mean squared error x time). What is adaptive gives samples to the tiles where they help most, \
    and ends when it is 95 % sure to have the error that the first variant was measured to have: it \
    takes 16 samples of each pixel at least. With the suffix -direct paths scatter once, and integrators \
    are compared, by their shadow samples; -sky is that with diffuse spheres under a white sky alone; \
    -lights compares ways to choose among lights, in the field at night with every eighth sphere a lamp.";

/// Measures errors.
///
/// # Errors
/// A scene is wrong, or a reference cannot be kept.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    let mut outcomes = Vec::new();
    for case in cases(options)? {
        outcomes.push(of_case(&case, options, tell)?);
    }
    Ok(Report {
        name: "error".to_owned(),
        title: "Error against time and samples".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        plots: outcomes.iter().flat_map(plots).collect(),
        tables: vec![levels(&outcomes), summary(&outcomes), references(&outcomes)],
    })
}

/// A variant with the world that it needs, which is the scene's own but for the choice of lights.
struct Contestant<'a> {
    variant: &'a Variant,
    settings: Settings,
    tracer: Tracer,
    world: Option<World>,
}

impl<'a> Contestant<'a> {
    fn new(scene: &NamedScene, variant: &'a Variant) -> Result<Self, BenchError> {
        let (mut settings, mut tracer) = (scene.scene.settings.clone(), Tracer::default());
        (variant.change)(&mut settings, &mut tracer);
        let own = || {
            let scene = Scene { settings: settings.clone(), ..scene.scene.clone() };
            NamedScene { name: String::new(), scene }.world()
        };
        let other = settings.light_choice != scene.scene.settings.light_choice;
        let world = other.then(own).transpose()?;
        Ok(Self { variant, settings, tracer, world })
    }

    /// Renders once, as told: returns the time in seconds and how good the picture is.
    fn turn(
        &self,
        told: &Settings,
        world: &World,
        reference: &Reference,
    ) -> Result<(f64, Picture), RenderError> {
        let Settings { spp, until_error, seed, .. } = *told;
        let settings = Settings { spp, until_error, seed, ..self.settings.clone() };
        let options = render::Options { tracer: self.tracer, ..render::Options::default() };
        let render = render(self.world.as_ref().unwrap_or(world), &settings, &options)?;
        let pixels = render.image.pixels.len() as f64;
        let picture = Picture {
            squares: reference.squares(&render.image),
            samples: render.samples.total as f64 / pixels,
            rays: render.counters.rays() as f64 / pixels,
        };
        Ok((render.elapsed.as_secs_f64(), picture))
    }
}

fn of_case(case: &Case, options: &Options, tell: Tell) -> Result<Outcome, BenchError> {
    let Case { scene, variants } = case;
    let world = scene.world()?;
    let samples = options.pick([64, 1024, 1 << 14]);
    tell(&format!("error: {}, reference of 2 x {samples} samples per pixel", scene.name));
    let reference = Reference::of(scene, &world, samples, options.references.as_deref())?;
    let contestants = variants.iter().map(|variant| Contestant::new(scene, variant));
    let contestants: Vec<Contestant> = contestants.collect::<Result<_, _>>()?;
    let most = options.pick([2, 5, 6]);
    let levels: Vec<u32> = (0..most).map(|i| 4_u32.pow(i)).collect();
    let mut pictures: Vec<Vec<Picture>> = vec![Vec::new(); variants.len() * levels.len()];
    let mut round = 0;
    let times = Times::by_turns(options.rounds, pictures.len(), |i| {
        if i == 0 {
            round += 1;
            tell(&format!("error: {}, round {round}", scene.name));
        }
        let (contestant, level) = (&contestants[i / levels.len()], i % levels.len());
        let own = &scene.scene.settings;
        let seed = own.seed.wrapping_add(round);
        let mut told = Settings { spp: levels[level], seed, until_error: None, ..own.clone() };
        if let Some(first) = pictures[level].last().filter(|_| contestant.variant.adaptive) {
            told.until_error = Some(reference.relative_to_mean(first.squares).clamp(1e-6, 1.0));
            told.spp = options.pick([64, Settings::HARD_SAMPLES, Settings::HARD_SAMPLES]);
        }
        let (seconds, picture) = contestant.turn(&told, &world, &reference)?;
        pictures[i].push(picture);
        Ok::<_, BenchError>(seconds)
    })?;
    Ok(Outcome { scene: scene.stem(), reference, variants, levels, times, pictures })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn more_samples_have_less_error_and_references_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let references = Some(folder.path().join("references"));
        let options = Options { references, ..quick(&["field"]) };
        let report = measure(&options, &|_| ()).unwrap();
        let variants =
            cases(&options).unwrap().iter().map(|case| case.variants.len()).sum::<usize>();
        assert_eq!(report.tables[0].rows.len(), 2 * variants);
        let cell = |row: usize, column: usize| match report.tables[0].rows[row][column] {
            Cell::Spread(cell) => cell.median,
            _ => f64::NAN,
        };
        let rmse = |row: usize| cell(row, 5);
        assert!(rmse(0) > rmse(1) && rmse(1) > 0.0);
        // Samples: of every pixel, and where they help.
        assert_eq!((cell(0, 2), cell(1, 2)), (1.0, 4.0));
        assert!(cell(2, 2) >= 16.0 && rmse(2) < rmse(1));
        let kept = || std::fs::read_dir(folder.path().join("references")).unwrap().count();
        assert_eq!(kept(), 4);
        let again = measure(&options, &|_| ()).unwrap();
        assert_eq!((kept(), &again.tables[2]), (4, &report.tables[2]));
        // What walks find is the same, so the errors are.
        let single = report.tables[0].rows.iter().position(|row| row[1] == "single rays".into());
        assert_eq!(rmse(0), rmse(single.unwrap()));
    }
}
