//! `spherule completions`: shell completion scripts.

use super::args::{Args, CompletionsArgs};
use super::output;
use clap::CommandFactory;
use std::process::ExitCode;

/// Prints the script.
pub(super) fn run(args: &CompletionsArgs) -> ExitCode {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "spherule", &mut script);
    output::print(String::from_utf8_lossy(&script).trim_end());
    ExitCode::SUCCESS
}
