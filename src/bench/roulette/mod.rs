//! Russian roulette: what it saves in time, what it costs in noise, and whether that pays.
//!
//! The paper's Table 1 has times alone. Here every time has the error of the picture beside it, and
//! strategies are compared at equal time too: what counts is the error that a second buys.

mod race;
mod report;

use super::paper::{PaperScene, Program};
use super::{BenchError, Effort, Options, Tell};
use crate::paper::Threading;
use crate::report::Report;
use crate::scene::Roulette;
use race::{Outcome, Race};

const EXPLANATION: &str = "With a fixed probability p every bounce goes on with probability p, \
    and weighs 1 / p as much: the paper's roulette. By throughput, from the fourth bounce on, \
    what can carry less than a quarter of the light goes on with a probability of four times that \
    share: Spherule's. The error of a picture is the root mean square of what its pixels differ \
    by from a reference of many samples, less the reference's own error; radiance counts up to 1, \
    which is what displays show, lest the few pixels in which a mirror shows a lamp outweigh all \
    others. Each run has other random numbers; medians are reported, with the least and the \
    greatest. Threads of the paper's tracer have their own numbers here. At equal time the mean \
    of all runs must agree with the reference: a bias is an error.";

/// A program and its roulette.
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

/// The first is what times are equal to.
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
    /// How many times as many samples each step of the ladder has: more for who is faster.
    fn samples_per_step(self) -> u32 {
        if self.program == Program::Spherule { 4 } else { 2 }
    }

    /// Number of the strategy of the same program without roulette.
    fn plain(self) -> usize {
        if self.program == Program::Spherule { 3 } else { 0 }
    }
}

/// What a scene's race came to, by strategy.
struct Found {
    scene: PaperScene,
    /// One sample in each pixel, then more and more.
    ladder: Vec<Vec<Outcome>>,
    /// As many samples as take the time of the first strategy.
    equal: Vec<Outcome>,
    /// Of the reference.
    error: f64,
}

/// Measures time and error.
///
/// # Errors
/// A scene is unknown, or pictures are biased.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    let usual = [PaperScene::TWO, PaperScene::FIELD];
    let usual = &usual[..options.pick([1, 2, 2])];
    let scenes = options.choose(&PaperScene::ALL, usual, |scene| scene.name)?;
    let mut found = Vec::new();
    for scene in scenes {
        tell(&format!("roulette: {}", scene.name));
        found.push(race(scene, options)?);
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

/// Pixels along each side.
fn size(options: &Options) -> u32 {
    options.pick([16, 64, 256])
}

fn race(scene: PaperScene, options: &Options) -> Result<Found, BenchError> {
    let reference_samples = options.pick([64, 1024, 4096]);
    let race = Race::new(&scene.scene((size(options), 1))?, reference_samples, options.rounds)?;
    let steps = 0..options.pick([2, 3, 3]);
    let ladder = steps.map(|step| {
        race.run(&STRATEGIES.map(|strategy| (strategy, strategy.samples_per_step().pow(step))))
    });
    let ladder = ladder.collect::<Result<Vec<_>, _>>()?;
    let most = options.pick([2, 8, 16]);
    let per_sample = |index: usize| {
        ladder.last().map_or(1.0, |outcomes: &Vec<Outcome>| outcomes[index].seconds_per_sample())
    };
    let time = per_sample(0) * f64::from(most);
    let mut entries = STRATEGIES.map(|strategy| (strategy, most));
    for (index, entry) in entries.iter_mut().enumerate() {
        entry.1 = (time / per_sample(index)).round().max(1.0) as u32;
    }
    let equal = race.run(&entries)?;
    if options.effort > Effort::Quick {
        equal.iter().try_for_each(Outcome::check)?;
    }
    Ok(Found { scene, ladder, equal, error: race.reference_error() })
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
    fn gains_are_over_the_same_program() {
        for strategy in STRATEGIES {
            let plain = STRATEGIES[strategy.plain()];
            assert_eq!(plain.program, strategy.program);
            assert!(matches!(plain.roulette, Roulette::None | Roulette::Fixed(1.0)));
        }
    }
}
