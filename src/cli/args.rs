//! Arguments of all commands.

use super::command_line::command_line;
use super::failure::Failure;
use super::{
    bench, compare, completions, field, help, info, man, merge, render, status, stress, version,
    view,
};
use clap::{FromArgMatches, Parser};

/// Examples and exit codes at the end of `--help`.
const EXAMPLES: &str = "\
Examples:
  spherule                                   a random field of spheres, to spherule.png
  spherule particles.xyz -o figure.png       same as spherule render particles.xyz ...
  spherule ./info                            a file with the name of a command
  spherule render scenes/weekend.toml -o weekend.png
  spherule info scenes/weekend.toml

Exit codes: 0 success, 1 failure, 2 invalid command line, 130 interrupted, 143 terminated";

/// Renders scenes of spheres with exact visibility; the image never depends on the performance settings
#[derive(Debug, Parser)]
#[command(
    name = "spherule",
    version,
    override_usage = "spherule [FILE] [OPTIONS]\n       spherule <COMMAND>",
    after_help = EXAMPLES
)]
pub(super) struct Args {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, clap::Subcommand)]
pub(super) enum Command {
    /// Render a scene or a particle file to an image (the default command)
    #[command(allow_negative_numbers = true, after_help = render::EXAMPLES)]
    Render(Box<render::RenderArgs>),
    /// Open an interactive viewer for a scene or a particle file
    #[command(
        allow_negative_numbers = true,
        after_help = view::examples(),
        mut_args(view::hide_refused)
    )]
    View(Box<view::ViewerArgs>),
    /// Merge the parts of a render made on several machines
    #[command(allow_negative_numbers = true, after_help = merge::EXAMPLES)]
    Merge(merge::Args),
    /// Show the progress of parts and checkpoints: what is done, what is missing, and the time left
    #[command(after_help = status::EXAMPLES)]
    Status(status::Args),
    /// Generate a scene: a TOML file, with its spheres in a CSV file next to it
    #[command(allow_negative_numbers = true, after_help = field::EXAMPLES)]
    Field(field::Args),
    /// Show the contents of a scene, and the work that a render of it skips
    #[command(after_help = info::EXAMPLES)]
    Info(Box<info::Args>),
    /// Measure the difference between an image and a reference
    #[command(after_help = compare::EXAMPLES)]
    Compare(compare::Args),
    /// Compare intersection tests with exact arithmetic in numerically hard cases
    #[command(after_help = stress::EXAMPLES)]
    Stress(stress::Args),
    /// Run benchmarks on this machine, and write tables, plots and a report
    #[command(after_help = bench::EXAMPLES)]
    Bench(bench::Args),
    /// Print a completion script for a shell
    #[command(after_help = completions::EXAMPLES)]
    Completions(completions::Args),
    /// Write the manual pages of all commands to a folder
    #[command(hide = true)]
    Man(man::Args),
    /// Print the version with details: `--version --verbose`
    #[command(skip)]
    Version,
}

impl Args {
    /// Parses the command line of this process; `program` is the definition of the program. The error holds the text
    /// to print instead: help, the version, or a usage error.
    pub(super) fn of_process(program: &clap::Command) -> Result<Command, Failure> {
        let default = || Command::Render(Box::new(render::RenderArgs::parse_from(["spherule"])));
        if version::is_asked_in_detail(&std::env::args_os().collect::<Vec<_>>()) {
            return Ok(Command::Version);
        }
        let (program, line) = help::shortened(program.clone(), command_line(program)?);
        let matches = program.try_get_matches_from(line).map_err(Failure::Arguments)?;
        let args = Self::from_arg_matches(&matches).map_err(Failure::Arguments)?;
        Ok(args.command.unwrap_or_else(default))
    }
}
