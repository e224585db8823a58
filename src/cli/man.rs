//! `spherule man`: manual pages, for packages.

use super::args::{Args, ManArgs};
use super::failure::Failure;
use clap::CommandFactory;
use std::process::ExitCode;

/// Writes a page for the program and one for each command.
pub(super) fn run(args: &ManArgs) -> Result<ExitCode, Failure> {
    let program = Args::command().disable_help_subcommand(true);
    clap_mangen::generate_to(program, &args.folder)
        .map_err(|error| Failure::Write(args.folder.clone(), error))?;
    Ok(ExitCode::SUCCESS)
}
