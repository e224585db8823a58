//! `spherule man`: manual pages, for packages.

use super::failure::Failure;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `spherule man`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Existing folder
    folder: PathBuf,
}

/// Writes a page for the program and one for each command.
pub(super) fn run(args: &Args, program: clap::Command) -> Result<ExitCode, Failure> {
    let program = program.disable_help_subcommand(true);
    clap_mangen::generate_to(program, &args.folder)
        .map_err(|error| Failure::Write(args.folder.clone(), error))?;
    Ok(ExitCode::SUCCESS)
}
