//! The command line: arguments, commands, messages and exit codes.

mod annotations;
mod appearance;
mod args;
mod bench;
mod checkpoint;
mod command_line;
mod compare;
mod completions;
mod contents;
mod devices;
mod examples;
mod failure;
mod field;
mod files;
mod frames;
mod info;
mod man;
mod memory;
mod merge;
mod names;
mod options;
mod output;
mod part;
mod particles;
mod picture_file;
mod processor;
mod progress;
mod render;
mod rows;
mod sequences;
mod settings;
mod signals;
mod slices;
mod source;
mod status;
mod stress;
mod threads;
mod values;
mod version;
mod view;
mod views;
mod with_text;
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
        Command::View(args) => view::run(args),
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
