//! Convergence: error over time and samples, for sets of settings.
//!
//! Errors are relative to a reference image, which is rendered once and cached. The reference is the
//! mean of two independent halves. A quarter of the mean square of their difference estimates the
//! reference's own mean squared error, which is subtracted from measured errors.

mod cache;
mod fit;
mod outcome;
mod reference;
mod tables;
mod variants;

pub use fit::reaches;
pub use reference::{Reference, SquaredError};

use self::outcome::{Outcome, Quality};
use self::tables::{levels, plots, references, summary};
use self::variants::{Case, Variant, cases};
use super::rounds::Times;
use super::scenes::NamedScene;
use super::{BenchError, Options, Progress};
use crate::report::Report;
use spherule_render::render::{self, RenderError, render};
use spherule_render::scene::{Scene, Settings};
use spherule_render::trace::Tracer;
use spherule_render::world::World;

const EXPLANATION: &str = "Variants render in turns with increasing numbers of samples, with another \
    seed in each round. Errors are over all channels of all pixels, in linear radiance, relative to a \
    reference image: the mean of two halves with different seeds. A quarter of the mean square of the \
    halves' difference estimates the reference's own mean squared error. It is subtracted, and the \
    rest is shown where it exceeds the reference's own. Relative errors are squared errors divided by \
    the square of the reference plus 0.01. Times are those of rendering, on all threads. Efficiency is \
    1 / (mean squared error x time). The adaptive variant samples tiles where that reduces the error \
    count, and stops when it has the measured error of the first variant with 95 % confidence, after at \
    least 16 samples of each pixel. The suffix -direct means one bounce, and compares integrators by \
    their shadow samples; -sky is the same with diffuse spheres under a white sky; -lights compares \
    light selection, in the field by night with every eighth sphere an emitter.";

/// Measures error over time and samples.
///
/// # Errors
/// A scene is invalid, or a reference image cannot be written.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    let mut outcomes = Vec::new();
    for case in cases(options)? {
        outcomes.push(measure_case(&case, options, progress)?);
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

/// A variant with its settings. It has its own world only if its light selection differs from the scene's.
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

    /// Renders once, with samples, error and seed of `goal`. Returns the time in seconds and the image's
    /// quality.
    fn turn(
        &self,
        goal: &Settings,
        world: &World,
        reference: &Reference,
    ) -> Result<(f64, Quality), RenderError> {
        let Settings { spp, until_error, seed, .. } = *goal;
        let settings = Settings { spp, until_error, seed, ..self.settings.clone() };
        let options = render::Options { tracer: self.tracer, ..render::Options::default() };
        let render = render(self.world.as_ref().unwrap_or(world), &settings, &options)?;
        let pixels = render.image.pixels.len() as f64;
        let quality = Quality {
            squares: reference.squares(&render.image),
            samples: render.samples.total as f64 / pixels,
            rays: render.counters.rays() as f64 / pixels,
        };
        Ok((render.elapsed.as_secs_f64(), quality))
    }
}

fn measure_case(case: &Case, options: &Options, progress: Progress) -> Result<Outcome, BenchError> {
    let Case { scene, variants } = case;
    let world = scene.world()?;
    let samples = options.pick([64, 1024, 1 << 14]);
    progress(&format!("error: {}, reference of 2 x {samples} samples per pixel", scene.name));
    let reference = Reference::new(scene, &world, samples, options.references.as_deref())?;
    let contestants = variants.iter().map(|variant| Contestant::new(scene, variant));
    let contestants: Vec<Contestant> = contestants.collect::<Result<_, _>>()?;
    let count = options.pick([2, 5, 6]);
    let levels: Vec<u32> = (0..count).map(|i| 4_u32.pow(i)).collect();
    let mut qualities: Vec<Vec<Quality>> = vec![Vec::new(); variants.len() * levels.len()];
    let mut round = 0;
    let times = Times::measure(options.rounds, qualities.len(), |i| {
        if i == 0 {
            round += 1;
            progress(&format!("error: {}, round {round}", scene.name));
        }
        let (contestant, level) = (&contestants[i / levels.len()], i % levels.len());
        let own = &scene.scene.settings;
        let seed = own.seed.wrapping_add(round);
        let mut goal = Settings { spp: levels[level], seed, until_error: None, ..own.clone() };
        if let Some(first) = qualities[level].last().filter(|_| contestant.variant.adaptive) {
            goal.until_error = Some(reference.relative_to_mean(first.squares).clamp(1e-6, 1.0));
            goal.spp = options.pick([64, Settings::HARD_SAMPLES, Settings::HARD_SAMPLES]);
        }
        let (seconds, quality) = contestant.turn(&goal, &world, &reference)?;
        qualities[i].push(quality);
        Ok::<_, BenchError>(seconds)
    })?;
    Ok(Outcome { scene: scene.stem(), reference, variants, levels, times, qualities })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn more_samples_have_less_error_and_references_are_cached() {
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
        // Samples per pixel, uniform and adaptive.
        assert_eq!((cell(0, 2), cell(1, 2)), (1.0, 4.0));
        assert!(cell(2, 2) >= 16.0 && rmse(2) < rmse(1));
        let cached = || std::fs::read_dir(folder.path().join("references")).unwrap().count();
        assert_eq!(cached(), 6);
        let again = measure(&options, &|_| ()).unwrap();
        assert_eq!((cached(), &again.tables[2]), (6, &report.tables[2]));
        // All traversals find the same hits, so errors are equal.
        let single = report.tables[0].rows.iter().position(|row| row[1] == "single rays".into());
        assert_eq!(rmse(0), rmse(single.unwrap()));
    }
}
