//! `spherule bench`: what the program reaches on the user's own machine.

mod args;
mod files;

pub(super) use self::args::{Args, EXAMPLES};
use self::args::{Common, Measurement};
use self::files::Folder;
use super::{Failure, output, threads};
use spherule::bench::{BenchError, Options, Tell, build};
use spherule::report::{Machine, Report};
use std::process::ExitCode;

/// A measurement.
type Run = fn(&Options, Tell) -> Result<Report, BenchError>;

/// What `all` runs, in this order.
const ALL: [Run; 1] = [build::run];

/// Measures, prints tables, and writes files.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    match &args.measurement {
        Measurement::Build(common) => of(common, "build", &[build::run]),
        Measurement::All(common) => of(common, "report", &ALL),
    }
}

/// Runs some measurements. The page is called `page`.
fn of(common: &Common, page: &str, runs: &[Run]) -> Result<ExitCode, Failure> {
    let folder = Folder::new(&common.output)?;
    let count = threads::count(common.threads);
    let pool = threads::pool(count)?;
    let options = common.options();
    let tell = |words: &str| {
        if !common.quiet {
            output::tell_plain(words);
        }
    };
    let mut reports = Vec::new();
    for run in runs {
        let report = pool.install(|| run(&options, &tell))?;
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
