//! Summary of a render, as text and as JSON.

use super::memory;
use super::noise::{NoiseSummary, missed};
use super::notices::Notices;
use super::pace::Pace;
use super::prepare::Prepared;
use super::setup::RenderSetup;
use crate::cli::contents::{BodyCounts, found, plural};
use crate::cli::devices::DeviceSummary;
use crate::cli::options::image::ReportArgs;
use crate::cli::options::lists::{self, List};
use crate::cli::options::names::TRAVERSALS;
use crate::cli::output;
use crate::cli::progress::rate;
use indicatif::{BinaryBytes, HumanCount};
use serde::Serialize;
use spherule_render::bvh::builders::Builder;
use spherule_render::denoise::Judged;
use spherule_render::image::WriteOptions;
use spherule_render::integrator::clock::{Stage, Times};
use spherule_render::integrator::counters::Counters;
use spherule_render::render::{Render, Tasks};
use spherule_render::scene::Settings;
use spherule_render::trace::PacketWidth;
use std::collections::BTreeMap;
use std::time::Duration;

/// Summary of a render.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    scene: &'a str,
    output: String,
    complete: bool,
    settings: List,
    tracer: TracerSummary,
    statistics: Statistics,
    noise: Option<NoiseSummary>,
    found: Vec<String>,
    skipped: Vec<String>,
    notes: &'a [String],
    warnings: Vec<String>,
    /// Warnings of the render itself.
    #[serde(skip)]
    new_warnings: usize,
    /// Width and height.
    #[serde(skip)]
    size: [u32; 2],
}

/// Traversal and threads.
#[derive(Serialize)]
struct TracerSummary {
    threads: usize,
    traversal: &'static str,
    builder: &'static str,
    lanes: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    device: Option<DeviceSummary>,
}

/// Counts and times.
#[derive(Serialize)]
struct Statistics {
    #[serde(flatten)]
    bodies: BodyCounts,
    dropped_spheres: u64,
    sphere_bytes: usize,
    tree_bytes: usize,
    /// Peak memory of the process; null if unknown.
    peak_bytes: Option<u64>,
    /// Estimated peak memory, computed before the world was built.
    estimated_peak_bytes: u64,
    load_seconds: f64,
    build_seconds: f64,
    render_seconds: f64,
    samples: u64,
    rays: u64,
    skipped_samples: u64,
    camera_rays: u64,
    bounce_rays: u64,
    shadow_rays: u64,
    mrays_per_second: f64,
    cut_paths: u64,
    non_finite_samples: u64,
    nesting_overflows: u64,
    exact_decisions: u64,
    /// Fraction of the time of all threads for each stage, by name.
    stage_shares: BTreeMap<&'static str, f64>,
    tasks: TaskSummary,
}

/// Statistics of tasks.
#[derive(Serialize)]
struct TaskSummary {
    count: u64,
    mean_seconds: f64,
    longest_seconds: f64,
    /// Lower bound of the utilization of this many threads.
    efficiency_on_64_threads: f64,
}

impl<'a> Summary<'a> {
    pub(super) fn new(
        setup: &RenderSetup,
        prepared: &'a Prepared,
        render: &Render,
        judged: Option<&Judged>,
        options: &WriteOptions,
    ) -> Self {
        let mut listed = lists::of_settings(&prepared.scene.settings, prepared.region);
        listed.extend(lists::of_encoding(setup.format, options));
        let mut new_warnings = warnings(&render.counters, &prepared.scene.settings);
        new_warnings.extend(missed(render, judged, &prepared.scene.settings));
        new_warnings.extend(prepared.device.fault());
        let known = prepared.warnings.iter().chain(&prepared.empty);
        Self {
            program: "spherule",
            version: env!("CARGO_PKG_VERSION"),
            scene: &prepared.title,
            output: setup.output.display().to_string(),
            complete: render.complete,
            settings: listed,
            tracer: TracerSummary::new(setup, prepared),
            statistics: Statistics::new(prepared, render),
            noise: NoiseSummary::new(prepared, render, judged),
            found: found(&prepared.world),
            skipped: prepared.world.features.skipped(),
            notes: &prepared.notes,
            new_warnings: new_warnings.len(),
            size: [prepared.region.width, prepared.region.height],
            warnings: known.cloned().chain(new_warnings).collect(),
        }
    }

    /// Prints the summary as JSON or as text, and its warnings.
    /// `pace` is that of the sequence of which the image is one.
    pub(super) fn report(&self, report: ReportArgs, pace: Option<Pace>, notices: &mut Notices) {
        if report.json {
            output::print_json(self);
        } else if report.stats && !report.quiet {
            self.print();
            self.print_stages();
        } else if !report.quiet {
            self.print_line(pace);
        }
        let old = self.warnings.len() - self.new_warnings;
        self.warnings[old..].iter().for_each(|text| notices.warn(text));
    }

    /// Prints the image, the time and the error; of a sequence, also the place of the image and the time left.
    fn print_line(&self, pace: Option<Pace>) {
        let Statistics { load_seconds, build_seconds, render_seconds, .. } = self.statistics;
        let place = pace.map_or_else(String::new, |pace| format!("{}: ", pace.place()));
        let left =
            pace.and_then(|pace| pace.left()).map_or_else(String::new, |left| format!(", {left}"));
        let error = self.noise.as_ref().map_or_else(String::new, NoiseSummary::brief);
        let [width, height] = self.size;
        output::print(format_args!(
            "{place}{}: {width} x {height} pixels in {:.1} s{error}{left}",
            self.output,
            load_seconds + build_seconds + render_seconds
        ));
    }

    fn print_stages(&self) {
        for stage in Stage::ALL {
            let fraction = self.statistics.stage_shares.get(stage.name()).copied().unwrap_or(0.0);
            output::print(format_args!("        {:<8} {:5.1} %", stage.name(), 100.0 * fraction));
        }
        let tasks = &self.statistics.tasks;
        output::print(format_args!(
            "tasks   {} of {:.2} ms, the longest {:.2} ms: 64 threads would have a utilization of {:.0} %",
            HumanCount(tasks.count),
            1e3 * tasks.mean_seconds,
            1e3 * tasks.longest_seconds,
            100.0 * tasks.efficiency_on_64_threads,
        ));
    }

    fn print(&self) {
        let statistics = &self.statistics;
        let render = Duration::from_secs_f64(statistics.render_seconds);
        let columns = statistics.sphere_bytes + statistics.tree_bytes;
        output::print(format_args!(
            "{}: {}\n\
             load    {:.3} s, {}\n\
             build   {:.3} s, tree of {}\n\
             render  {:.3} s on {}, {}\n\
             rays    {} camera, {} bounce, {} shadow\n\
             exact   {} without rounding\n\
             memory  {}",
            self.output,
            plural(statistics.samples, "sample"),
            statistics.load_seconds,
            statistics.bodies,
            statistics.build_seconds,
            BinaryBytes(statistics.tree_bytes as u64),
            statistics.render_seconds,
            plural(self.tracer.threads as u64, "thread"),
            rate(statistics.rays, render),
            HumanCount(statistics.camera_rays),
            HumanCount(statistics.bounce_rays),
            HumanCount(statistics.shadow_rays),
            plural(statistics.exact_decisions, "decision"),
            memory::describe(statistics.bodies.0[0], columns, statistics.peak_bytes),
        ));
        if let Some(device) = &self.tracer.device {
            output::print(format_args!(
                "device  {}: {}, of which the processor decided {}; {}, of which it followed {}",
                device.name,
                plural(device.rays, "ray"),
                HumanCount(device.unknown),
                plural(device.paths, "path"),
                HumanCount(device.unknown_paths),
            ));
        }
        self.noise.iter().for_each(NoiseSummary::print);
    }
}

impl TaskSummary {
    fn new(tasks: &Tasks) -> Self {
        Self {
            count: tasks.count,
            mean_seconds: tasks.total.as_secs_f64() / tasks.count.max(1) as f64,
            longest_seconds: tasks.longest.as_secs_f64(),
            efficiency_on_64_threads: tasks.efficiency(64),
        }
    }
}

impl TracerSummary {
    fn new(setup: &RenderSetup, prepared: &Prepared) -> Self {
        Self {
            device: prepared.device.summary(),
            threads: setup.threads,
            traversal: TRAVERSALS.name(&setup.tracer.traversal),
            builder: match prepared.builder {
                Builder::Median => "median",
                Builder::SurfaceArea => "surface-area",
                Builder::Morton => "morton",
            },
            lanes: lanes(setup.tracer.width),
        }
    }
}

impl Statistics {
    fn new(prepared: &Prepared, render: &Render) -> Self {
        let (world, counters) = (&prepared.world, &render.counters);
        let seconds = render.elapsed.as_secs_f64();
        Self {
            bodies: BodyCounts::of(world.trees().rows()),
            dropped_spheres: world.features.vanished + world.features.hidden,
            sphere_bytes: world.spheres.bytes() + world.appearance.bytes(),
            tree_bytes: world.bvh.bytes(),
            peak_bytes: spherule_render::memory::peak(),
            estimated_peak_bytes: prepared.estimate,
            load_seconds: prepared.load.as_secs_f64(),
            build_seconds: prepared.build.as_secs_f64(),
            render_seconds: seconds,
            samples: render.samples.total,
            rays: counters.rays(),
            skipped_samples: counters.skipped_samples,
            camera_rays: counters.camera_rays,
            bounce_rays: counters.bounce_rays,
            shadow_rays: counters.shadow_rays,
            mrays_per_second: counters.rays() as f64 / seconds.max(1e-9) / 1e6,
            cut_paths: counters.cut_paths,
            non_finite_samples: counters.bad_samples,
            nesting_overflows: counters.nesting_overflows,
            exact_decisions: counters.exact_decisions,
            stage_shares: Stage::ALL
                .map(|stage| (stage.name(), time_fraction(&render.times, stage)))
                .into(),
            tasks: TaskSummary::new(&render.tasks),
        }
    }
}

fn lanes(width: PacketWidth) -> u32 {
    match width {
        PacketWidth::One => 1,
        PacketWidth::Four => 4,
        PacketWidth::Eight => 8,
        PacketWidth::Sixteen => 16,
    }
}

/// Returns warnings about the image.
pub(in crate::cli) fn warnings(counters: &Counters, settings: &Settings) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut warn = |count: u64, text: &dyn Fn(String) -> String| {
        if count > 0 {
            warnings.push(text(HumanCount(count).to_string()));
        }
    };
    let limit = settings.depth.map_or_else(
        || format!("the hard limit of {} bounces", Settings::HARD_DEPTH),
        |depth| format!("--depth {depth}"),
    );
    warn(counters.cut_paths, &|count| {
        let samples = HumanCount(counters.camera_rays);
        format!(
            "{limit} ended {count} of {samples} paths: the image lacks their light and is too dark"
        )
    });
    warn(counters.bad_samples, &|count| {
        format!(
            "{count} samples were negative or not finite and count as black: this is a bug in spherule"
        )
    });
    warn(counters.nesting_overflows, &|count| {
        format!("{count} times a path was inside more nested glass spheres than it can track")
    });
    warnings
}

/// Fraction of the total time that a stage took; 0 if there is none.
fn time_fraction(times: &Times, stage: Stage) -> f64 {
    let total = times.total().as_secs_f64();
    if total > 0.0 { times.of(stage).as_secs_f64() / total } else { 0.0 }
}
