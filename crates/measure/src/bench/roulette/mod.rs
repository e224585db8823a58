//! Russian roulette: the time that it saves, the noise that it adds, and the efficiency of both.
//!
//! The paper's Table 1 has only times. Here each time comes with the error of the image, and
//! strategies are also compared at equal time.

mod experiment;
mod report;

use super::paper::{PaperScene, Program};
use super::{BenchError, Effort, Options, Progress};
use crate::report::Report;
use experiment::{Experiment, Outcome};
use spherule_paper::Threading;
use spherule_render::scene::Roulette;

const EXPLANATION: &str = "The paper's roulette continues a path at each bounce with a fixed \
    probability p, and divides its weight by p. Spherule's roulette depends on throughput: from the \
    fourth bounce on, a path with a throughput t below 1/4 continues with probability 4 t. The error \
    of an image is the root mean square of the difference of its pixels from a reference of many \
    samples, minus the reference's own error. Radiance is clamped to 1, as on a display; otherwise \
    the few pixels in which a mirror shows an emitter would dominate. Each run has another seed; \
    the report gives median, minimum and maximum. Threads of the paper's tracer have their own \
    random number generators here. At equal time, the mean of all runs must agree with the \
    reference: bias is an error.";

/// A program with a kind of roulette.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strategy {
    name: &'static str,
    program: Program,
    roulette: Roulette,
}

const PAPER: Program = Program::Paper(Threading::Independent);

const fn strategy(name: &'static str, program: Program, roulette: Roulette) -> Strategy {
    Strategy { name, program, roulette }
}

/// The strategies. The first one's time is the equal time of all.
const STRATEGIES: [Strategy; 7] = [
    strategy("paper, p = 1", PAPER, Roulette::Fixed(1.0)),
    strategy("paper, p = 0.9", PAPER, Roulette::Fixed(0.9)),
    strategy("paper, p = 0.5", PAPER, Roulette::Fixed(0.5)),
    strategy("Spherule, none", Program::Spherule, Roulette::None),
    strategy("Spherule, p = 0.9", Program::Spherule, Roulette::Fixed(0.9)),
    strategy("Spherule, p = 0.5", Program::Spherule, Roulette::Fixed(0.5)),
    strategy("Spherule, throughput", Program::Spherule, Roulette::Throughput),
];

impl Strategy {
    /// Returns the factor of samples from level to level; larger for the faster program.
    fn samples_factor(self) -> u32 {
        if self.program == Program::Spherule { 4 } else { 2 }
    }

    /// Returns the index of the same program's strategy without roulette.
    fn plain(self) -> usize {
        if self.program == Program::Spherule { 3 } else { 0 }
    }
}

/// Results for a scene, indexed by strategy.
struct SceneResult {
    scene: PaperScene,
    /// Levels of samples per pixel, from 1 on.
    levels: Vec<Vec<Outcome>>,
    /// Results at the time of the first strategy.
    equal: Vec<Outcome>,
    /// Root mean squared error of the reference.
    error: f64,
}

/// Measures time and error of each strategy.
///
/// # Errors
/// A scene is unknown, or images are biased.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    let usual = [PaperScene::TWO, PaperScene::FIELD];
    let usual = &usual[..options.pick([1, 2, 2])];
    let scenes = options.choose(&PaperScene::ALL, usual, |scene| scene.name)?;
    let mut found = Vec::new();
    for scene in scenes {
        progress(&format!("roulette: {}", scene.name));
        found.push(measure_scene(scene, options)?);
    }
    let size = size(options);
    let mut settings = options.settings();
    settings.push(("picture".to_owned(), format!("{size} x {size} pixels")));
    Ok(Report {
        name: "roulette".to_owned(),
        title: "Russian roulette: error against time".to_owned(),
        about: EXPLANATION.to_owned(),
        settings,
        tables: report::tables(&found),
        plots: found.iter().map(report::plot).collect(),
    })
}

/// Returns the image's width and height in pixels.
fn size(options: &Options) -> u32 {
    options.pick([16, 64, 256])
}

fn measure_scene(scene: PaperScene, options: &Options) -> Result<SceneResult, BenchError> {
    let reference_samples = options.pick([32, 1024, 4096]);
    let experiment =
        Experiment::new(&scene.scene(size(options), 1)?, reference_samples, options.rounds)?;
    let exponents = 0..options.pick([2, 3, 3]);
    let levels = exponents.map(|exponent| {
        experiment
            .run(&STRATEGIES.map(|strategy| (strategy, strategy.samples_factor().pow(exponent))))
    });
    let levels = levels.collect::<Result<Vec<_>, _>>()?;
    let samples = options.pick([2, 8, 16]);
    let per_sample = |index: usize| {
        levels.last().map_or(1.0, |outcomes: &Vec<Outcome>| outcomes[index].seconds_per_sample())
    };
    let time = per_sample(0) * f64::from(samples);
    let mut entries = STRATEGIES.map(|strategy| (strategy, samples));
    for (index, entry) in entries.iter_mut().enumerate() {
        entry.1 = (time / per_sample(index)).round().max(1.0) as u32;
    }
    let equal = experiment.run(&entries)?;
    if options.effort > Effort::Quick {
        equal.iter().try_for_each(Outcome::check)?;
    }
    Ok(SceneResult { scene, levels, equal, error: experiment.reference_error() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn every_strategy_has_time_and_error() {
        let report = measure(&quick(&["two-spheres"]), &|_| ()).unwrap();
        assert_eq!((report.tables.len(), report.plots.len()), (2, 1));
        for table in &report.tables {
            assert_eq!(table.rows.len(), STRATEGIES.len());
            let spreads = table.rows.iter().flatten();
            let spreads = spreads.filter(|cell| matches!(cell, Cell::Spread(s) if s.least > 0.0));
            assert!(spreads.count() >= 2 * STRATEGIES.len(), "{table:?}");
        }
        assert!(measure(&quick(&["nowhere"]), &|_| ()).is_err());
    }

    #[test]
    fn gains_are_relative_to_the_same_program() {
        for strategy in STRATEGIES {
            let plain = STRATEGIES[strategy.plain()];
            assert_eq!(plain.program, strategy.program);
            assert!(matches!(plain.roulette, Roulette::None | Roulette::Fixed(1.0)));
        }
    }
}
