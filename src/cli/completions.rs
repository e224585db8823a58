//! `spherule completions`: shell completion scripts.

use super::output;
use std::process::ExitCode;

/// Examples at the end of `--help`.
pub(super) const EXAMPLES: &str = "\
Examples:
  spherule completions bash > ~/.local/share/bash-completion/completions/spherule
  spherule completions zsh > ~/.zfunc/_spherule";

/// Arguments of `spherule completions`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Shell to print the script for
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

/// Prints the script.
pub(super) fn run(args: &Args, mut program: clap::Command) -> ExitCode {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "spherule", &mut script);
    output::print(String::from_utf8_lossy(&script).trim_end());
    ExitCode::SUCCESS
}
