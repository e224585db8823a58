//! Thread scaling of Spherule and of the paper's tracer. The latter has a random number generator and
//! a list of finished pixels either for each image row, or shared by all threads in critical sections.
//! The paper had the latter: 573 s on one thread, 289 s on four.

use super::rounds::{Times, clock};
use super::scenes::NamedScene;
use super::{BenchError, Options, Progress};
use crate::report::{Axis, Column, Plot, Point, Report, Series, Spread, Style, Table};
use rayon::{ThreadPool, ThreadPoolBuilder};
use spherule_paper::{PaperTracer, Threading};
use spherule_render::image::{Image, compare};
use spherule_render::render::{self, render};
use spherule_render::scene::{Integrator, Roulette, Settings};
use spherule_render::world::World;

const EXPLANATION: &str = "Three renderers run in turns on each number of threads, all with the same \
    settings: Spherule, and the paper's tracer, in which each image row has its own random numbers \
    and finished pixels or, as in the paper, all threads fraction both in critical sections. Images of \
    the first two must be equal on every number of threads; the image of the third varies, and its \
    mean is checked. The dashed lines are Amdahl's law, T(n) / T(1) = s + (1 - s) / n, with the \
    serial fraction s fitted by least squares (Amdahl, \"Validity of the Single Processor Approach \
    to Achieving Large Scale Computing Capabilities\", AFIPS 1967).";

/// Tolerated difference of means in standard errors: exceeded by chance less than once in 10^8 runs.
const SIGMAS: f64 = 6.0;

/// Renderers, in the order of their turns.
const NAMES: [&str; 3] = ["Spherule", "paper, no lock", "paper, critical sections"];

// Settings that all renderers support: direct light, shadows and mirrors.
const DEPTH: u32 = 8;
const SHADOW_SAMPLES: u32 = 4;

/// Results for a scene.
struct Outcome {
    scene: String,
    /// Indexed by threads, then by renderer.
    times: Times,
    threads: usize,
}

/// Measures the speedup by threads.
///
/// # Errors
/// A scene is invalid, threads cannot be started, or images differ that must be equal.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    let scenes = NamedScene::choose(options, &["paper-field-20"])?;
    let pools = (1..=options.threads.max(1)).map(pool).collect::<Result<Vec<_>, _>>()?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        progress(&format!("threads: {}, 1 to {} threads", scene.name, pools.len()));
        outcomes.push(measure_scene(scene.resized(options.pick([24, 160, 320])), &pools, options)?);
    }
    let mut settings = options.settings();
    settings.push(("most threads".to_owned(), pools.len().to_string()));
    Ok(Report {
        name: "threads".to_owned(),
        title: "Thread scaling".to_owned(),
        about: EXPLANATION.to_owned(),
        settings,
        tables: vec![table(&outcomes), fits(&outcomes)],
        plots: outcomes.iter().map(plot).collect(),
    })
}

/// Starts a pool of threads.
pub(super) fn pool(threads: usize) -> Result<ThreadPool, BenchError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| BenchError::Threads(threads, error))
}

fn measure_scene(
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
    let paper = PaperTracer::new(&scene.scene, &world, true)?;
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
    let times = Times::measure(options.rounds, NAMES.len() * pools.len(), |i| {
        let (pool, renderer) = (&pools[i / NAMES.len()], i % NAMES.len());
        let (seconds, image) = pool.install(|| clock(0.0, || draw(renderer)));
        check(&world, renderer, &image?, &expected)
            .map_err(|fault| BenchError::Differ(format!("{}: {fault}", scene.name)))?;
        Ok::<_, BenchError>(seconds)
    })?;
    Ok(Outcome { scene: scene.stem(), times, threads: pools.len() })
}

/// Compares an image with the expected one.
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

    /// Returns the serial fraction; `None` on one thread.
    fn serial(&self, renderer: usize) -> Option<f64> {
        let relative = (1..=self.threads).map(|n| (n, 1.0 / self.speedup(renderer, n).median));
        (self.threads > 1).then(|| fit_serial_fraction(relative))
    }
}

/// Fits the serial fraction s of Amdahl's law to times relative to that on one thread, by least
/// squares: T(n) - 1/n = s (1 - 1/n). It may exceed 1.
fn fit_serial_fraction(times: impl Iterator<Item = (usize, f64)>) -> f64 {
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for (threads, time) in times {
        let ideal = 1.0 / threads as f64;
        numerator += (1.0 - ideal) * (time - ideal);
        denominator += (1.0 - ideal) * (1.0 - ideal);
    }
    numerator / denominator
}

fn table(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Scene that is rendered."),
        Column::new("renderer", "Program that renders."),
        Column::new("threads", "Number of threads."),
        Column::new("time", "Time of a render.").unit("ms"),
        Column::new("speedup", "Speedup over one thread, computed for each round.")
            .style(Style::Fixed(2)),
        Column::new("efficiency", "Median speedup divided by the number of threads.")
            .style(Style::Percent),
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
        Column::new("scene", "Scene that is rendered."),
        Column::new("renderer", "Program that renders."),
        Column::new(
            "serial share",
            "Fitted fraction of serial work; more than 100 % if threads slow the renderer down.",
        )
        .style(Style::Percent),
        Column::new("limit", "Maximum speedup with any number of threads, by Amdahl's law.")
            .unit("times as fast"),
        Column::new(
            "cost of the lock",
            "Time on the maximum number of threads, relative to that without critical sections.",
        ),
    ];
    let mut table = Table::new("threads-limits", "Amdahl's law", columns);
    for outcome in outcomes {
        for (renderer, name) in NAMES.into_iter().enumerate() {
            let serial = outcome.serial(renderer);
            let limit = serial.filter(|&serial| serial > 0.0).map(|serial| 1.0 / serial);
            let max = outcome.threads;
            let [locked, own] = [renderer, 1].map(|of| Outcome::contestant(of, max));
            let cost = (renderer == 2).then(|| outcome.times.ratio(own, locked));
            let names = [outcome.scene.as_str().into(), name.into()];
            table.push(names.into_iter().chain([serial.into(), limit.into(), cost.into()]));
        }
    }
    table
}

fn plot(outcome: &Outcome) -> Plot {
    let max = outcome.threads as f64;
    let fine = (0..=60).map(|i| 1.0 + (max - 1.0).max(1.0) * f64::from(i) / 60.0);
    let mut series = vec![Series::model("ideal", fine.clone().map(|n| Point::new(n, n)), 7)];
    for (renderer, name) in NAMES.into_iter().enumerate() {
        let speedups =
            (1..=outcome.threads).map(|n| Point::spread(n as f64, outcome.speedup(renderer, n)));
        series.push(Series { color: Some(renderer), ..Series::marks(name, speedups) });
        // Amdahl's law has no fit if threads slow the renderer down.
        let fitted = outcome.serial(renderer).filter(|serial| (0.0..=1.0).contains(serial));
        let Some(serial) = fitted else { continue };
        let law = fine.clone().map(|n| Point::new(n, 1.0 / (serial + (1.0 - serial) / n)));
        let fraction = Style::Percent.write(serial);
        series.push(Series::model(format!("Amdahl, {fraction} serial"), law, renderer));
    }
    Plot {
        name: format!("threads-{}", outcome.scene),
        title: format!("Thread scaling: {}", outcome.scene),
        about: "Median and range over the rounds; dashed: fit of Amdahl's law".to_owned(),
        note: String::new(),
        place: Axis::whole("threads"),
        value: Axis::linear("speedup over one thread", ""),
        series,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn the_fit_recovers_the_serial_fraction() {
        for serial in [0.0, 0.1, 0.7, 1.0] {
            let law = |n: usize| (n, serial + (1.0 - serial) / n as f64);
            assert!(
                (fit_serial_fraction([1, 2, 4, 7].map(law).into_iter()) - serial).abs() < 1e-12
            );
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
