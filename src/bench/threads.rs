//! What more threads bring: to the renderer that ships, and to the paper's tracer, with random numbers
//! and a list of pixels for each row of the picture or with one of both for all threads, in critical
//! sections. The paper had the latter: 573 s on one thread, 289 s on four.

use super::rounds::{Times, clock};
use super::scenes::NamedScene;
use super::{BenchError, Options, Tell};
use crate::image::{Image, compare};
use crate::paper::{Threading, Tracer};
use crate::render::{self, render};
use crate::report::{Axis, Column, Plot, Point, Report, Series, Spread, Style, Table};
use crate::scene::{Integrator, Roulette, Settings};
use crate::world::World;
use rayon::{ThreadPool, ThreadPoolBuilder};

const EXPLANATION: &str = "Three renderers take turns on each number of threads, all with the same \
    settings: the one that ships, and the paper's tracer, whose random numbers and finished pixels \
    are each row's own or, as in the paper, in critical sections. Pictures of the first two are the \
    same on every number of threads, which is checked; that of the third is another each time, and \
    its mean is checked. The dashed lines are Amdahl's law, T(n) / T(1) = s + (1 - s) / n, with the \
    share s that only one thread can do at a time fitted by least squares (Amdahl, \"Validity of the \
    Single Processor Approach to Achieving Large Scale Computing Capabilities\", AFIPS 1967).";

/// Standard errors by which means may differ: by chance less often than once in 10^8 runs.
const SIGMAS: f64 = 6.0;

/// Renderers, in the order in which they take turns.
const NAMES: [&str; 3] = ["Spherule", "paper, no lock", "paper, critical sections"];

/// What all of them can do: light, shadows and mirrors.
const DEPTH: u32 = 8;
const SHADOW_SAMPLES: u32 = 4;

/// What was measured in a scene.
struct Outcome {
    scene: String,
    /// By threads, then by renderer.
    times: Times,
    threads: usize,
}

/// Measures what threads bring.
///
/// # Errors
/// A scene is wrong, threads cannot be started, or pictures differ that must not.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    let scenes = NamedScene::choose(options, &["paper-field-20"])?;
    let pools = (1..=options.threads.max(1)).map(pool).collect::<Result<Vec<_>, _>>()?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        tell(&format!("threads: {}, 1 to {} threads", scene.name, pools.len()));
        outcomes.push(of_scene(scene.resized(options.pick([48, 160, 320])), &pools, options)?);
    }
    let mut settings = options.settings();
    settings.push(("most threads".to_owned(), pools.len().to_string()));
    Ok(Report {
        name: "threads".to_owned(),
        title: "What more threads bring".to_owned(),
        about: EXPLANATION.to_owned(),
        settings,
        tables: vec![table(&outcomes), fits(&outcomes)],
        plots: outcomes.iter().map(plot).collect(),
    })
}

/// So many threads.
pub(super) fn pool(threads: usize) -> Result<ThreadPool, BenchError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| BenchError::Threads(threads, error))
}

fn of_scene(
    scene: NamedScene,
    pools: &[ThreadPool],
    options: &Options,
) -> Result<Outcome, BenchError> {
    let mut scene = scene;
    let settings = Settings {
        spp: options.pick([1, 4, 16]),
        depth: Some(DEPTH),
        integrator: Integrator::Whitted { shadow_samples: SHADOW_SAMPLES },
        roulette: Roulette::None,
        ..scene.scene.settings
    };
    scene.scene.settings = settings.clone();
    let world = scene.world()?;
    let paper = Tracer::new(&scene.scene, &world, true)?;
    let draw = |renderer: usize| {
        let threading = match renderer {
            0 => {
                let options = render::Options::default();
                return Ok::<_, BenchError>(render(&world, &settings, &options)?.image);
            }
            1 => Threading::Independent,
            _ => Threading::Critical,
        };
        Ok(paper.render(&settings, threading)?.image)
    };
    let expected = [draw(0)?, draw(1)?];
    let times = Times::by_turns(options.rounds, NAMES.len() * pools.len(), |i| {
        let (pool, renderer) = (&pools[i / NAMES.len()], i % NAMES.len());
        let (seconds, image) = pool.install(|| clock(0.0, || draw(renderer)));
        check(&world, renderer, &image?, &expected)
            .map_err(|fault| BenchError::Differ(format!("{}: {fault}", scene.name)))?;
        Ok::<_, BenchError>(seconds)
    })?;
    Ok(Outcome { scene: scene.stem(), times, threads: pools.len() })
}

/// Whether a picture is what it should be.
fn check(
    world: &World,
    renderer: usize,
    image: &Image,
    expected: &[Image; 2],
) -> Result<(), String> {
    let name = NAMES[renderer];
    if renderer < 2 {
        let same = *image == expected[renderer];
        return if same { Ok(()) } else { Err(format!("{name} differs between threads")) };
    }
    let found = compare(image, &expected[1]).map_err(|error| error.to_string())?;
    let few = world.camera.width * world.camera.height < 2;
    if few || found.bias.abs() <= SIGMAS * found.bias_standard_error {
        return Ok(());
    }
    Err(format!("{name} differs by {:.1e} +- {:.1e}", found.bias, found.bias_standard_error))
}

impl Outcome {
    fn contestant(renderer: usize, threads: usize) -> usize {
        (threads - 1) * NAMES.len() + renderer
    }

    fn seconds(&self, renderer: usize, threads: usize) -> Spread {
        self.times.seconds(Self::contestant(renderer, threads))
    }

    fn speedup(&self, renderer: usize, threads: usize) -> Spread {
        self.times.ratio(Self::contestant(renderer, threads), Self::contestant(renderer, 1))
    }

    /// The serial share; `None` on one thread.
    fn serial(&self, renderer: usize) -> Option<f64> {
        let shares = (1..=self.threads).map(|n| (n, 1.0 / self.speedup(renderer, n).median));
        (self.threads > 1).then(|| serial_share(shares))
    }
}

/// The share s of Amdahl's law, 0 to 1 and beyond, by least squares over times in shares of that
/// on one thread: T(n) - 1/n = s (1 - 1/n).
fn serial_share(times: impl Iterator<Item = (usize, f64)>) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for (threads, time) in times {
        let ideal = 1.0 / threads as f64;
        above += (1.0 - ideal) * (time - ideal);
        below += (1.0 - ideal) * (1.0 - ideal);
    }
    above / below
}

fn table(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "What is rendered."),
        Column::new("renderer", "By what."),
        Column::new("threads", "On how many threads."),
        Column::new("time", "For a picture.").unit("ms"),
        Column::new("speedup", "How many times as fast as on one thread, round by round.")
            .style(Style::Fixed(2)),
        Column::new("efficiency", "Speedup by threads, of the medians.").style(Style::Percent),
    ];
    let mut table = Table::new("threads", "Threads", columns);
    for outcome in outcomes {
        for (renderer, name) in NAMES.into_iter().enumerate() {
            for threads in 1..=outcome.threads {
                let speedup = outcome.speedup(renderer, threads);
                table.push([
                    outcome.scene.as_str().into(),
                    name.into(),
                    (threads as u64).into(),
                    outcome.seconds(renderer, threads).times(1e3).into(),
                    speedup.into(),
                    (speedup.median / threads as f64).into(),
                ]);
            }
        }
    }
    table
}

fn fits(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "What is rendered."),
        Column::new("renderer", "By what."),
        Column::new(
            "serial share",
            "What only one thread can do at a time, fitted; more than all of it if threads harm.",
        )
        .style(Style::Percent),
        Column::new("limit", "What any number of threads can bring, by Amdahl's law.")
            .unit("times as fast"),
        Column::new(
            "cost of the lock",
            "Time on the most threads, in times of that without critical sections.",
        ),
    ];
    let mut table = Table::new("threads-limits", "Amdahl's law", columns);
    for outcome in outcomes {
        for (renderer, name) in NAMES.into_iter().enumerate() {
            let serial = outcome.serial(renderer);
            let limit = serial.filter(|&serial| serial > 0.0).map(|serial| 1.0 / serial);
            let most = outcome.threads;
            let [locked, own] = [renderer, 1].map(|of| Outcome::contestant(of, most));
            let cost = (renderer == 2).then(|| outcome.times.ratio(own, locked));
            let names = [outcome.scene.as_str().into(), name.into()];
            table.push(names.into_iter().chain([serial.into(), limit.into(), cost.into()]));
        }
    }
    table
}

fn plot(outcome: &Outcome) -> Plot {
    let most = outcome.threads as f64;
    let fine = (0..=60).map(|i| 1.0 + (most - 1.0).max(1.0) * f64::from(i) / 60.0);
    let mut series = vec![Series::model("ideal", fine.clone().map(|n| Point::new(n, n)), 7)];
    for (renderer, name) in NAMES.into_iter().enumerate() {
        let speedups =
            (1..=outcome.threads).map(|n| Point::spread(n as f64, outcome.speedup(renderer, n)));
        series.push(Series { color: Some(renderer), ..Series::marks(name, speedups) });
        // Threads that harm obey no such law.
        let lawful = outcome.serial(renderer).filter(|serial| (0.0..=1.0).contains(serial));
        let Some(serial) = lawful else { continue };
        let law = fine.clone().map(|n| Point::new(n, 1.0 / (serial + (1.0 - serial) / n)));
        let share = Style::Percent.write(serial);
        series.push(Series::model(format!("Amdahl, {share} serial"), law, renderer));
    }
    Plot {
        name: format!("threads-{}", outcome.scene),
        title: format!("What more threads bring: {}", outcome.scene),
        about: "Medians and ranges over the rounds; dashed: Amdahl's law, fitted".to_owned(),
        note: String::new(),
        place: Axis::whole("threads"),
        value: Axis::linear("times as fast as on one thread", ""),
        series,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn the_law_is_found_in_its_own_numbers() {
        for serial in [0.0, 0.1, 0.7, 1.0] {
            let law = |n: usize| (n, serial + (1.0 - serial) / n as f64);
            assert!((serial_share([1, 2, 4, 7].map(law).into_iter()) - serial).abs() < 1e-12);
        }
    }

    #[test]
    fn every_renderer_has_a_row_for_each_number_of_threads() {
        let options = Options { threads: 3, ..quick(&[]) };
        let report = measure(&options, &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), 9);
        assert_eq!(report.tables[0].rows[2][2], Cell::Count(3));
        assert_eq!(report.tables[1].rows.len(), 3);
        assert!(report.plots[0].series.len() >= 4);
    }
}
