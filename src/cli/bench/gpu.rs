//! Benchmark of the GPU: rays per second by class, times of stages, and time to an error, beside the processor.

use super::super::devices;
use crate::cli::options::names::Device as Choice;
use spherule_gpu::{AdapterSummary, Device, DeviceTree, QueryStage, QueryTimes};
use spherule_measure::bench::convergence::{Reference, reaches};
use spherule_measure::bench::rounds::{Times, clock};
use spherule_measure::bench::scenes::{FIELD, NamedScene};
use spherule_measure::bench::{BenchError, Options, Progress};
use spherule_measure::report::{Axis, Column, Plot, Point, Report, Series, Spread, Style, Table};
use spherule_measure::workload::{Class, SphereScene, Views};
use spherule_render::bvh::builders::{Builder, build};
use spherule_render::bvh::{Tracer, Tree};
use spherule_render::ray::{Hits, MISS, Rays};
use spherule_render::render::{self, render};
use spherule_render::scene::{Camera, Integrator, Material, Rgb, Settings, Spheres};
use spherule_render::world::World;
use std::sync::Arc;
use std::time::Instant;

const EXPLANATION: &str = "Rays are generated beforehand. A query arranges them for the device, copies them there, \
    runs the kernel, copies the answers back, and decides unknown rays and computes all distances on one thread of the \
    processor; the rate of the processor is that of one thread, too. Queries run in turns, and medians over the rounds \
    are given. Stages are measured in queries of their own, in which each stage is waited for. Hits and images are \
    compared with the processor's, bit for bit. Images are rendered on all threads.";

/// What is added to the explanation if the adapter is no GPU.
const SOFTWARE: &str = "The adapter is software, which is no GPU: its rates show that the benchmark works, and \
    nothing else. ";

/// Minimum duration of a turn in seconds; short ones are repeated.
const TURN: f64 = 0.02;

/// The error that times are interpolated to: the root mean square, in linear radiance.
const RMSE: f64 = 0.01;

/// Results for one class of rays.
struct Outcome {
    scene: SphereScene,
    class: Class,
    rays: usize,
    /// Fraction of rays that hit.
    hits: f64,
    /// Fraction of rays that the processor decided.
    unknown: f64,
    /// Of the device, and of the processor.
    times: Times,
    /// One for each round.
    stages: Vec<QueryTimes>,
}

/// Seconds until a scene is on the device.
struct Preparation {
    scene: SphereScene,
    /// To build the tree, on all threads of the processor.
    build: f64,
    copy: f64,
    /// To the answers of the first camera rays; for the first scene, the kernel is compiled in that time.
    first: f64,
    bytes: u64,
}

/// Times of images with so many samples, and their error.
struct ImageOutcome {
    scene: String,
    samples: u32,
    rmse: f64,
    /// Fraction of the paths that the processor followed; `None` if the device followed none.
    unknown: Option<f64>,
    /// Of the device, and of the processor.
    times: Times,
}

/// Measures the best device.
///
/// # Errors
/// There is no device or it fails, a scene is unknown or does not fit in memory, or hits or images differ from the
/// processor's.
pub(super) fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    use SphereScene as S;
    let device = devices::open().map_err(BenchError::Device)?;
    let usual = [
        S::PAPER400,
        S::PAPER2500,
        S::VOLUME10K,
        S::LAYER250K,
        S::VOLUME1M,
        S::FCC1M,
        S::LOGNORMAL1M,
        S::VOLUME10M,
    ];
    let usual = &usual[..options.pick([1, 7, 8])];
    let scenes = options.choose(&S::ALL, usual, |scene| scene.name)?;
    let (mut outcomes, mut preparations) = (Vec::new(), Vec::new());
    for scene in scenes {
        preparations.push(measure_scene(scene, &device, options, progress, &mut outcomes)?);
    }
    let mut images = Vec::new();
    for scene in pictures(options)? {
        images.extend(measure_images(&scene, options, progress)?);
    }
    let AdapterSummary { name, backend, kind, driver, .. } = device.summary();
    let adapter = format!("{name} ({backend}, {kind}, {driver})");
    let note = if device.summary().is_software() { SOFTWARE } else { "" };
    let mut settings = options.settings();
    settings.push(("adapter".to_owned(), adapter.clone()));
    let mut tables =
        vec![rates(&outcomes), prepared(&preparations), errors(&images), times_to_error(&images)];
    // Most sets of spheres have no images.
    tables.retain(|table| !table.rows.is_empty());
    for table in &mut tables {
        table.notes.push(format!("{note}Adapter: {adapter}."));
    }
    Ok(Report {
        name: "gpu".to_owned(),
        title: "The GPU".to_owned(),
        about: format!("{note}{EXPLANATION}"),
        settings,
        tables,
        plots: vec![plot(&outcomes, &format!("{name}, {kind}"))],
    })
}

/// Turns a failure of the device into an error of the measurement.
fn check(device: &Device) -> Result<(), BenchError> {
    device.fault().map_or(Ok(()), |error| Err(BenchError::Device(error.to_string())))
}

fn measure_scene(
    scene: SphereScene,
    device: &Arc<Device>,
    options: &Options,
    progress: Progress,
    outcomes: &mut Vec<Outcome>,
) -> Result<Preparation, BenchError> {
    progress(&format!("gpu: {}", scene.name));
    let mut spheres = scene.spheres()?;
    let (seconds, bvh) = once(|| build(&mut spheres, Builder::default()));
    let tree = Tree { bvh: &bvh, spheres: &spheres };
    let (copy, on_device) = once(|| DeviceTree::new(device, tree));
    let on_device = on_device.map_err(|error| BenchError::Device(error.to_string()))?;
    let views = Views::new(scene, tree, options.pick([64, 256, 1024]));
    let rays = views.rays(Class::Camera);
    let (first, _) = once(|| trace(&on_device, tree, rays, Class::Camera));
    check(device)?;
    for class in Class::ALL {
        progress(&format!("gpu: {}, {} rays", scene.name, class.name()));
        let rays = views.rays(class);
        outcomes.push(measure_class(scene, class, &on_device, tree, rays, options.rounds)?);
    }
    Ok(Preparation { scene, build: seconds, copy, first, bytes: on_device.bytes() })
}

/// Runs something once, and returns the seconds that it took.
fn once<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = run();
    (start.elapsed().as_secs_f64(), result)
}

/// Traces rays on the device; returns the hits and the share of unknown rays.
fn trace(on_device: &DeviceTree, tree: Tree, rays: &Rays, class: Class) -> (Hits, f64) {
    let mut hits = Hits::with_capacity(rays.len());
    let answered = if class.is_any() {
        on_device.occluded(tree, rays, &mut hits)
    } else {
        on_device.closest(tree, rays, &mut hits)
    };
    (hits, answered.unknown as f64 / answered.rays.max(1) as f64)
}

/// Traces rays on one thread of the processor.
fn trace_here(tree: Tree, rays: &Rays, class: Class) -> Hits {
    let mut hits = Hits::with_capacity(rays.len());
    if class.is_any() {
        Tracer::default().occluded(tree, rays, &mut hits);
    } else {
        Tracer::default().closest(tree, rays, &mut hits);
    }
    hits
}

fn measure_class(
    scene: SphereScene,
    class: Class,
    on_device: &DeviceTree,
    tree: Tree,
    rays: &Rays,
    rounds: u32,
) -> Result<Outcome, BenchError> {
    let expected = trace_here(tree, rays, class);
    let (mut unknown, mut stages) = (0.0, Vec::new());
    let times = Times::measure(rounds, 2, |contestant| {
        if contestant == 1 {
            return Ok(clock(TURN, || trace_here(tree, rays, class)).0);
        }
        let (seconds, (hits, share)) = clock(TURN, || trace(on_device, tree, rays, class));
        check(on_device.device())?;
        compare(scene, class, &hits, &expected, rays.len())?;
        unknown = share;
        let mut hits = Hits::with_capacity(rays.len());
        let timed = on_device.timed(tree, rays, &mut hits, class.is_any());
        let (_, times) = timed.map_err(|error| BenchError::Device(error.to_string()))?;
        compare(scene, class, &hits, &expected, rays.len())?;
        stages.push(times);
        Ok::<_, BenchError>(seconds)
    })?;
    let count = (0..rays.len()).filter(|&row| expected.sphere[row] != MISS).count();
    let hits = count as f64 / rays.len().max(1) as f64;
    Ok(Outcome { scene, class, rays: rays.len(), hits, unknown, times, stages })
}

/// Checks that hits are the processor's.
fn compare(
    scene: SphereScene,
    class: Class,
    found: &Hits,
    expected: &Hits,
    rays: usize,
) -> Result<(), BenchError> {
    let differs = |row: &usize| {
        let missed = |hits: &Hits| hits.sphere[*row] == MISS;
        let of = |hits: &Hits| (hits.sphere[*row], hits.t[*row].to_bits());
        missed(found) != missed(expected) || (!class.is_any() && of(found) != of(expected))
    };
    match (0..rays).filter(differs).count() {
        0 => Ok(()),
        wrong => Err(BenchError::Differ(format!(
            "{}: {wrong} of {rays} {} rays differ between the GPU and the processor",
            scene.name,
            class.name()
        ))),
    }
}

/// The scenes of images, of the sets of spheres that were chosen.
fn pictures(options: &Options) -> Result<Vec<NamedScene>, BenchError> {
    let width = options.pick([24, 96, 512]);
    let mut occlusion = NamedScene::named(FIELD)?.resized(width);
    occlusion.name = format!("{FIELD}, ambient occlusion");
    occlusion.scene.settings.integrator = Integrator::Ao { distance: f64::INFINITY };
    let mut volume = occlusion.clone();
    let set = SphereScene::VOLUME10K;
    volume.name = format!("{}, ambient occlusion", set.name);
    volume.scene.ground = None;
    volume.scene.camera = Camera::default();
    volume.scene.spheres = Spheres::default();
    let spheres = set.spheres()?;
    for row in 0..spheres.len() {
        let (center, radius) = (spheres.center(row).as_dvec3(), f64::from(spheres.radius(row)));
        volume.scene.spheres.push(center, radius, 0, Rgb::splat(0.8));
    }
    let mut chalk = volume.clone();
    chalk.name = format!("{}, chalk under sun and sky", set.name);
    chalk.scene.settings.integrator = Integrator::Path;
    for row in &mut chalk.scene.materials {
        row.material = Material::Lambertian { color: Rgb::ONE };
    }
    let mut all = vec![occlusion, volume, chalk];
    all.retain(|scene| {
        let is_of = |set: &String| scene.name.starts_with(&format!("{set}, "));
        options.scenes.is_empty() || options.scenes.iter().any(is_of)
    });
    Ok(all)
}

fn measure_images(
    scene: &NamedScene,
    options: &Options,
    progress: Progress,
) -> Result<Vec<ImageOutcome>, BenchError> {
    let own = scene.world()?;
    let samples = options.pick([32, 256, 1024]);
    progress(&format!("gpu: {}, reference of 2 x {samples} samples per pixel", scene.name));
    let reference = Reference::new(scene, &own, samples, options.references.as_deref())?;
    let mut other = scene.world()?;
    let device = devices::Attached::to(&mut other, &scene.scene.settings, Choice::Gpu);
    if let Some(why) = device.refusal() {
        return Err(BenchError::Device(why));
    }
    let levels = (0..options.pick([2, 3, 5])).map(|i| 4_u32.pow(i));
    let mut outcomes = Vec::new();
    for samples in levels {
        progress(&format!("gpu: {}, {samples} samples per pixel", scene.name));
        let settings = Settings { spp: samples, ..scene.scene.settings.clone() };
        let image = |world: &World| {
            let (seconds, image) = once(|| render(world, &settings, &render::Options::default()));
            Ok::<_, BenchError>((seconds, image?.image))
        };
        let (_, expected) = image(&own)?;
        let times = Times::measure(options.rounds, 2, |contestant| {
            let (seconds, found) = image([&other, &own][contestant])?;
            if let Some(fault) = device.fault() {
                return Err(BenchError::Device(fault));
            }
            if found.pixels != expected.pixels {
                let what = "images of the GPU and of the processor differ";
                return Err(BenchError::Differ(format!("{}: {what}", scene.name)));
            }
            Ok(seconds)
        })?;
        let summary = device.summary().filter(|summary| summary.paths > 0);
        let rmse = (reference.squares(&expected).absolute - reference.error.absolute).max(0.0);
        outcomes.push(ImageOutcome {
            scene: scene.name.clone(),
            samples,
            rmse: rmse.sqrt(),
            unknown: summary.map(|all| all.unknown_paths as f64 / all.paths as f64),
            times,
        });
    }
    Ok(outcomes)
}

fn rate(outcome: &Outcome, contestant: usize) -> Spread {
    outcome.times.seconds(contestant).rate(1e-6 * outcome.rays as f64)
}

/// A stage's seconds, over the rounds.
fn seconds(outcome: &Outcome, of: impl Fn(&QueryTimes) -> f64) -> Spread {
    Spread::from_values(&outcome.stages.iter().map(of).collect::<Vec<_>>())
}

fn rates(outcomes: &[Outcome]) -> Table {
    let mut columns = vec![
        Column::new("scene", "Set of spheres."),
        Column::new("rays", "Class of rays."),
        Column::new("count", "Number of rays of a query."),
        Column::new("hit", "Fraction of rays that hit a sphere.").style(Style::Percent),
        Column::new("unknown", "Fraction of rays that the processor decides.")
            .style(Style::Percent),
        Column::new("query", "Rays per second, with all stages.").unit("Mrays/s"),
        Column::new(
            "kernel",
            "Rays per second of the kernel alone, by the device's clock if it has one.",
        )
        .unit("Mrays/s"),
        Column::new("processor", "Rays per second on one thread of the processor.").unit("Mrays/s"),
        Column::new("ratio", "Speedup of the query over one thread.").unit("processor"),
    ];
    let about = "Share of the time of a query in which each stage is waited for.";
    columns.extend(QueryStage::ALL.map(|stage| {
        let column = Column::new(stage.name(), about).style(Style::Percent);
        if stage == QueryStage::ALL[0] { column.group("share of") } else { column }
    }));
    let mut table = Table::new("gpu", "Rays", columns);
    for outcome in outcomes {
        let kernel = seconds(outcome, QueryTimes::kernel_seconds);
        let cells = [
            outcome.scene.name.into(),
            outcome.class.name().into(),
            (outcome.rays as u64).into(),
            outcome.hits.into(),
            outcome.unknown.into(),
            rate(outcome, 0).into(),
            kernel.rate(1e-6 * outcome.rays as f64).into(),
            rate(outcome, 1).into(),
            outcome.times.ratio(0, 1).into(),
        ];
        let share =
            |stage| seconds(outcome, |times| times.seconds(stage) / times.total()).median.into();
        table.push(cells.into_iter().chain(QueryStage::ALL.map(share)));
    }
    table
}

fn prepared(preparations: &[Preparation]) -> Table {
    let columns = vec![
        Column::new("scene", "Set of spheres."),
        Column::new("build", "Time to build the tree, on the processor.").unit("ms"),
        Column::new("copy", "Time to copy spheres and tree to the device.").unit("ms"),
        Column::new("first", "Time of the first query of camera rays, kernels compiled included.")
            .unit("ms"),
        Column::new("size", "Size of spheres and tree on the device.").unit("MB"),
    ];
    let mut table = Table::new("gpu-build", "Time to the first hits", columns);
    for Preparation { scene, build, copy, first, bytes } in preparations {
        let times = [build, copy, first].map(|seconds| (seconds * 1e3).into());
        let size = [(*bytes as f64 * 1e-6).into()];
        table.push([scene.name.into()].into_iter().chain(times).chain(size));
    }
    table
}

fn errors(images: &[ImageOutcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Scene that is rendered."),
        Column::new("samples", "Samples per pixel."),
        Column::new("RMSE", "Root mean squared error, minus the reference's own: of both images.")
            .style(Style::Power(2)),
        Column::new("unknown", "Fraction of the paths that the processor follows; none if the device only traces rays.")
            .style(Style::Percent),
        Column::new("GPU", "Time to this error with the GPU.").group("time to it").unit("ms"),
        Column::new("processor", "Time to this error without it.").unit("ms"),
        Column::new("ratio", "Speedup with the GPU.").unit("processor"),
    ];
    let mut table = Table::new("gpu-error", "Time to error", columns);
    for ImageOutcome { scene, samples, rmse, unknown, times } in images {
        table.push([
            scene.as_str().into(),
            u64::from(*samples).into(),
            (*rmse).into(),
            (*unknown).into(),
            times.seconds(0).times(1e3).into(),
            times.seconds(1).times(1e3).into(),
            times.ratio(0, 1).into(),
        ]);
    }
    table
}

/// Returns a table of the times to an error, one row for each scene; without numbers if none of its images reaches it.
fn times_to_error(images: &[ImageOutcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Scene that is rendered."),
        Column::new("samples", "Samples per pixel for the error, interpolated."),
        Column::new("GPU", "Time to the error with the GPU.").group("time to it").unit("ms"),
        Column::new("processor", "Time to the error without it.").unit("ms"),
        Column::new("ratio", "Speedup with the GPU.").unit("processor"),
    ];
    let mut table = Table::new("gpu-rmse", format!("Time to an RMSE of {RMSE}"), columns);
    for images in images.chunk_by(|image, next| image.scene == next.scene) {
        let interpolate = |of: &dyn Fn(&ImageOutcome) -> f64| {
            let known = images.iter().filter(|image| image.rmse > 0.0);
            reaches(&known.map(|image| (of(image), image.rmse)).collect::<Vec<_>>(), RMSE)
        };
        let samples = interpolate(&|image| f64::from(image.samples));
        let [gpu, processor] = [0, 1]
            .map(|contestant| interpolate(&|image| 1e3 * image.times.seconds(contestant).median));
        let ratio = gpu.zip(processor).map(|(gpu, processor)| processor / gpu);
        table.push([
            images[0].scene.as_str().into(),
            samples.into(),
            gpu.into(),
            processor.into(),
            ratio.into(),
        ]);
    }
    table
}

fn plot(outcomes: &[Outcome], adapter: &str) -> Plot {
    let of = |class: Class| outcomes.iter().filter(move |outcome| outcome.class == class);
    let series = |class: Class| {
        let rates = of(class).enumerate();
        let point =
            |(line, outcome): (usize, &Outcome)| Point::spread(line as f64, rate(outcome, 0));
        Series::marks(class.name(), rates.map(point))
    };
    Plot {
        name: "gpu".to_owned(),
        title: format!("Rays per second: {adapter}"),
        about: "Median and range over the rounds; farther right is faster".to_owned(),
        note: String::new(),
        place: Axis::names(of(Class::Camera).map(|outcome| outcome.scene.name)),
        value: Axis::log("rate of queries", "million rays per second"),
        series: Class::ALL.map(series).to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_measure::report::Cell;

    #[test]
    fn times_to_an_error_are_interpolated() {
        let image = |(scene, samples, rmse): (&str, u32, f64)| {
            let turn = |contestant| Ok::<_, ()>(f64::from(samples) * [1.0, 8.0][contestant]);
            let times = Times::measure(1, 2, turn).expect("times");
            ImageOutcome { scene: scene.to_owned(), samples, rmse, unknown: None, times }
        };
        let images = [("a", 16, 0.02), ("a", 256, 0.005), ("b", 1, 0.5), ("b", 4, 0.25)].map(image);
        let table = times_to_error(&images);
        let expected = [64.0, 64e3, 512e3, 8.0];
        for (cell, expected) in table.rows[0][1..].iter().zip(expected) {
            let Cell::Number(number) = cell else { panic!("{cell:?}") };
            assert!((number / expected - 1.0).abs() < 1e-9, "{number} {expected}");
        }
        assert_eq!(table.rows[1][0], Cell::from("b"));
        assert!(table.rows[1][1..].iter().all(|cell| *cell == Cell::None));
    }
}
