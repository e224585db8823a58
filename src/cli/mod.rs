//! The command line: arguments, commands, messages and exit codes.

mod args;
mod bench;
mod command_line;
mod compare;
mod completions;
mod contents;
mod devices;
mod failure;
mod field;
mod files;
mod help;
mod info;
mod man;
mod merge;
mod options;
mod output;
mod picture_file;
mod processor;
mod progress;
mod ranges;
mod render;
mod signals;
mod source;
mod status;
mod stress;
mod threads;
mod version;
mod view;
mod write_file;

use self::args::{Args, Command};
use self::failure::Failure;
pub(crate) use self::output::finish;
use clap::CommandFactory;
use std::process::ExitCode;

/// Runs the command of this process, and prints its error if it fails. Returns the exit code.
pub(crate) fn run() -> ExitCode {
    execute().unwrap_or_else(|failure| failure.report(Args::command()))
}

fn execute() -> Result<ExitCode, Failure> {
    processor::check()?;
    signals::survive_large_files();
    let program = Args::command();
    match Args::of_process(&program)? {
        Command::Render(args) => render::run(*args, &program),
        Command::Merge(args) => merge::run(&args),
        Command::Status(args) => Ok(status::run(&args)),
        Command::View(args) => view::run(&args, &program),
        Command::Field(args) => field::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Stress(args) => stress::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Completions(args) => Ok(completions::run(&args, program)),
        Command::Man(args) => man::run(&args, program),
        Command::Version => Ok(version::print_in_detail()),
    }
}
