//! `spherule bench`: what the program reaches on the user's own machine.

mod args;
mod files;

pub(super) use self::args::{Args, EXAMPLES};
use self::args::{Common, Measurement};
use self::files::Folder;
use super::{Failure, output, threads as cores};
use spherule::bench::{
    BenchError, Options, Tell, build, convergence, paper, roulette, skips, threads, traversal,
};
use spherule::report::{Machine, Report};
use std::process::ExitCode;

/// A measurement.
type Run = fn(&Options, Tell) -> Result<Report, BenchError>;

/// What `all` runs, in this order.
const ALL: [Run; 7] = [
    traversal::measure,
    build::measure,
    threads::measure,
    skips::measure,
    convergence::measure,
    paper::measure,
    roulette::measure,
];

/// Measures, prints tables, and writes files.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    match &args.measurement {
        Measurement::Traversal(common) => one(common, "traversal", traversal::measure),
        Measurement::Threads(args) => {
            of((&args.common, &args.options()), "threads", &[threads::measure])
        }
        Measurement::Build(common) => one(common, "build", build::measure),
        Measurement::Skips(common) => one(common, "skips", skips::measure),
        Measurement::Error(common) => one(common, "error", convergence::measure),
        Measurement::Paper(args) => of((&args.common, &args.options()), "paper", &[paper::measure]),
        Measurement::Roulette(common) => one(common, "roulette", roulette::measure),
        Measurement::All(common) if common.has_scenes() => {
            let message = "--scenes is for single measurements: each has scenes of its own";
            Err(Failure::usage("bench", message))
        }
        Measurement::All(common) => of((common, &common.options()), "report", &ALL),
    }
}

fn one(common: &Common, name: &str, run: Run) -> Result<ExitCode, Failure> {
    of((common, &common.options()), name, &[run])
}

/// Runs some measurements. The page is called `page`.
fn of(
    (common, options): (&Common, &Options),
    page: &str,
    runs: &[Run],
) -> Result<ExitCode, Failure> {
    common.check_files()?;
    let folder = Folder::new(&common.output)?;
    let count = cores::count(common.threads);
    let pool = cores::pool(count)?;
    let tell = |words: &str| {
        if !common.quiet {
            output::tell_plain(words);
        }
    };
    let mut reports = Vec::new();
    for run in runs {
        let report = pool.install(|| run(options, &tell))?;
        if !common.quiet {
            print(&report);
        }
        reports.push(report);
    }
    folder.write(page, &reports, &Machine::this(count))?;
    if !common.quiet {
        output::note(format_args!("tables, plots and {page}.html are in {folder}"));
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
