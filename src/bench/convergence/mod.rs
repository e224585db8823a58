//! How soon a picture is good: error against time and samples, for sets of settings.
//!
//! The error is that against a reference, which is rendered once and kept. It is the mean of two
//! independent halves: a quarter of the mean square of their difference is the reference's own mean
//! squared error, which is taken off what is measured against it.

mod cache;
mod fit;
mod reference;
mod tables;

pub use reference::{Reference, Squares};

use self::tables::{levels, over_samples, over_time, references, summary};
use super::rounds::Times;
use super::scenes::{FIELD, NamedScene};
use super::{BenchError, Options, Tell};
use crate::bvh::walk::Method;
use crate::render::{self, render};
use crate::report::{Point, Report, Spread};
use crate::scene::{Roulette, SamplerKind, Settings};
use crate::trace::{Tracer, Width};
use crate::world::World;

const EXPLANATION: &str = "Each variant renders with more and more samples, by turns, with another \
    seed in each round. Errors are over all channels of all pixels, in linear radiance, against a \
    reference: the mean of two halves with seeds of their own. A quarter of the mean square of the \
    halves' difference is the reference's own mean squared error; it is taken off, and what is left \
    is shown where it is more than the reference's own. Relative errors are divided by the square of \
    the reference and 0.01. Times are of rendering alone, on all threads. Efficiency is \
    1 / (mean squared error x time).";

/// A set of settings: what differs from the scene's own. All of them lead to the same picture.
#[derive(Clone, Copy)]
pub struct Variant {
    /// What differs, in a few words.
    pub name: &'static str,
    /// Changes the settings.
    pub change: fn(&mut Settings, &mut Tracer),
}

/// What is compared: one line adds one. The first is what the others are held against.
pub const VARIANTS: [Variant; 7] = [
    Variant { name: "as shipped", change: |_, _| () },
    Variant {
        name: "stratified",
        change: |settings, _| settings.sampler = SamplerKind::Stratified,
    },
    Variant {
        name: "independent",
        change: |settings, _| settings.sampler = SamplerKind::Independent,
    },
    Variant { name: "no roulette", change: |settings, _| settings.roulette = Roulette::None },
    Variant {
        name: "roulette 0.5",
        change: |settings, _| settings.roulette = Roulette::Fixed(0.5),
    },
    Variant { name: "stream", change: |_, tracer| tracer.method = Method::Stream },
    Variant {
        name: "single rays",
        change: |_, tracer| *tracer = Tracer { method: Method::Single, width: Width::One },
    },
];

/// What was measured in a scene: by variant, then by level of samples.
struct Outcome {
    scene: String,
    reference: Reference,
    levels: Vec<u32>,
    times: Times,
    /// By contestant and round.
    squares: Vec<Vec<Squares>>,
}

/// Measures errors.
///
/// # Errors
/// A scene is wrong, or a reference cannot be kept.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    let usual = [FIELD, "smallpt", "veach", "paper-field-20"];
    let scenes = NamedScene::choose(options, &usual[..options.pick([1, 2, 4])])?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        let scene = scene.resized(options.pick([24, 64, 160]));
        outcomes.push(of_scene(&scene, options, tell)?);
    }
    let plots = outcomes.iter().flat_map(|outcome| [over_time(outcome), over_samples(outcome)]);
    Ok(Report {
        name: "error".to_owned(),
        title: "Error against time and samples".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        plots: plots.collect(),
        tables: vec![levels(&outcomes), summary(&outcomes), references(&outcomes)],
    })
}

fn of_scene(scene: &NamedScene, options: &Options, tell: Tell) -> Result<Outcome, BenchError> {
    let world = scene.world()?;
    let samples = options.pick([64, 1024, 1 << 14]);
    tell(&format!("error: {}, reference of 2 x {samples} samples per pixel", scene.name));
    let reference = Reference::of(scene, &world, samples, options.references.as_deref())?;
    let most = options.pick([2, 5, 6]);
    let levels: Vec<u32> = (0..most).map(|i| 4_u32.pow(i)).collect();
    let mut squares = vec![Vec::new(); VARIANTS.len() * levels.len()];
    let mut round = 0;
    let times = Times::by_turns(options.rounds, squares.len(), |i| {
        if i == 0 {
            tell(&format!("error: {}, round {}", scene.name, round + 1));
            round += 1;
        }
        let (variant, spp) = (&VARIANTS[i / levels.len()], levels[i % levels.len()]);
        let (seconds, found) =
            turn(&world, &scene.scene.settings, (variant, spp, round), &reference);
        squares[i].push(found);
        Ok::<_, BenchError>(seconds)
    })?;
    Ok(Outcome { scene: scene.stem(), reference, levels, times, squares })
}

/// Renders once; returns the time in seconds and the errors.
fn turn(
    world: &World,
    settings: &Settings,
    (variant, spp, round): (&Variant, u32, u64),
    reference: &Reference,
) -> (f64, Squares) {
    let (mut settings, mut tracer) = (settings.clone(), Tracer::default());
    (variant.change)(&mut settings, &mut tracer);
    (settings.spp, settings.seed) = (spp, settings.seed.wrapping_add(round));
    let options = render::Options { tracer, ..render::Options::default() };
    let render = render(world, &settings, &options);
    (render.elapsed.as_secs_f64(), reference.squares(&render.image))
}

impl Outcome {
    fn contestant(&self, variant: usize, level: usize) -> usize {
        variant * self.levels.len() + level
    }

    fn seconds(&self, variant: usize, level: usize) -> Spread {
        self.times.seconds(self.contestant(variant, level))
    }

    /// Errors without the reference's own; `None` if that is more.
    fn error(&self, variant: usize, level: usize, of: fn(&Squares) -> f64) -> Option<Spread> {
        let own = of(&self.reference.error);
        let squares = self.squares[self.contestant(variant, level)].iter();
        let left = Spread::of(&squares.map(|squares| of(squares) - own).collect::<Vec<_>>());
        (left.median > own).then_some(Spread { least: left.least.max(0.0), ..left })
    }

    fn rmse(&self, variant: usize, level: usize) -> Option<Spread> {
        self.error(variant, level, |squares| squares.absolute).map(root)
    }

    /// Places and root mean squared errors of all levels that count.
    fn curve(&self, variant: usize, place: impl Fn(usize) -> f64) -> Vec<Point> {
        let point = |level| Some(Point::spread(place(level), self.rmse(variant, level)?));
        (0..self.levels.len()).filter_map(point).collect()
    }

    fn over_time(&self, variant: usize) -> Vec<Point> {
        self.curve(variant, |level| self.seconds(variant, level).median)
    }

    fn over_samples(&self, variant: usize) -> Vec<Point> {
        self.curve(variant, |level| f64::from(self.levels[level]))
    }

    /// 1 / (mean squared error x time), by medians.
    fn efficiency(&self, variant: usize, level: usize) -> Option<f64> {
        let square = self.error(variant, level, |squares| squares.absolute)?.median;
        Some(1.0 / (square * self.seconds(variant, level).median))
    }
}

fn root(squares: Spread) -> Spread {
    let Spread { median, least, greatest } = squares;
    Spread { median: median.sqrt(), least: least.sqrt(), greatest: greatest.sqrt() }
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
        assert_eq!(report.tables[0].rows.len(), 2 * VARIANTS.len());
        let rmse = |row: usize| match report.tables[0].rows[row][4] {
            Cell::Spread(rmse) => rmse.median,
            _ => f64::NAN,
        };
        assert!(rmse(0) > rmse(1) && rmse(1) > 0.0);
        let kept = || std::fs::read_dir(folder.path().join("references")).unwrap().count();
        assert_eq!(kept(), 2);
        let again = measure(&options, &|_| ()).unwrap();
        assert_eq!((kept(), &again.tables[2]), (2, &report.tables[2]));
        // What walks find is the same, so the errors are.
        assert_eq!(rmse(0), rmse(2 * 5));
    }
}
