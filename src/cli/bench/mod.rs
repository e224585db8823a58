//! `spherule bench`: benchmarks on the user's machine.

mod args;
mod files;
#[cfg(feature = "gpu")]
mod gpu;

pub(super) use self::args::{Args, EXAMPLES};
use self::args::{Common, Measurement};
use self::files::Folder;
use super::failure::Failure;
use super::{output, threads as cores};
use spherule_measure::bench::{
    BenchError, Options, Progress, build, convergence, paper, roulette, skips, threads, traversal,
};
use spherule_measure::report::{Machine, Report};
use std::process::ExitCode;

/// A benchmark: the name of its report, and its function.
type Benchmark = (&'static str, fn(&Options, Progress) -> Result<Report, BenchError>);

const TRAVERSAL: Benchmark = ("traversal", traversal::measure);
const BUILD: Benchmark = ("build", build::measure);
const THREADS: Benchmark = ("threads", threads::measure);
const SKIPS: Benchmark = ("skips", skips::measure);
const ERROR: Benchmark = ("error", convergence::measure);
const PAPER: Benchmark = ("paper", paper::measure);
const ROULETTE: Benchmark = ("roulette", roulette::measure);

/// Not one of `all`: most machines have no GPU.
#[cfg(feature = "gpu")]
const GPU: Benchmark = ("gpu", gpu::measure);
#[cfg(not(feature = "gpu"))]
const GPU: Benchmark = ("gpu", |_, _| {
    Err(BenchError::Device(format!("no GPU can be measured: {}", super::devices::ADVICE)))
});

/// The benchmarks of `all`, in order.
const ALL: [Benchmark; 7] = [TRAVERSAL, BUILD, THREADS, SKIPS, ERROR, PAPER, ROULETTE];

/// Runs benchmarks, prints tables and writes files.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    match &args.measurement {
        Measurement::Traversal(common) => run_one(common, &common.options(), TRAVERSAL),
        Measurement::Threads(args) => run_one(&args.common, &args.options(), THREADS),
        Measurement::Build(common) => run_one(common, &common.options(), BUILD),
        Measurement::Skips(common) => run_one(common, &common.options(), SKIPS),
        Measurement::Error(common) => run_one(common, &common.options(), ERROR),
        Measurement::Paper(args) => run_one(&args.common, &args.options(), PAPER),
        Measurement::Roulette(common) => run_one(common, &common.options(), ROULETTE),
        Measurement::Gpu(common) => run_one(common, &common.options(), GPU),
        Measurement::All(common) if common.has_scenes() => {
            let message = "--scenes does not apply to `all`; run the benchmarks one by one";
            Err(Failure::usage("bench", message))
        }
        Measurement::All(common) => run_all(common, &common.options(), "report", &ALL),
    }
}

fn run_one(common: &Common, options: &Options, benchmark: Benchmark) -> Result<ExitCode, Failure> {
    run_all(common, options, benchmark.0, &[benchmark])
}

/// Runs benchmarks, and writes their reports and a page of this name.
fn run_all(
    common: &Common,
    options: &Options,
    page: &str,
    benchmarks: &[Benchmark],
) -> Result<ExitCode, Failure> {
    let folder = Folder::new(&common.output)?;
    let names: Vec<&str> = benchmarks.iter().map(|(name, _)| *name).collect();
    folder.check_free(&common.inputs(), page, &names)?;
    let count = cores::count(common.threads);
    let pool = cores::pool(count)?;
    let progress = |words: &str| {
        if !common.quiet {
            output::print_error_line(words);
        }
    };
    let mut reports = Vec::new();
    for (_, measure) in benchmarks {
        let report = pool.install(|| measure(options, &progress))?;
        if !common.quiet {
            print(&report);
        }
        reports.push(report);
    }
    folder.write(page, &reports, &Machine::this(count))?;
    if !common.quiet {
        output::note(format_args!("wrote tables, plots and {page}.html to {folder}"));
    }
    Ok(ExitCode::SUCCESS)
}

fn print(report: &Report) {
    for table in &report.tables {
        output::print(format_args!("{}\n\n{}", table.title, table.text()));
        for note in &table.notes {
            output::print(note);
        }
    }
}
