//! The command line as typed.

mod field;
mod picture;

pub(super) use field::{FieldArgs, Kind, ParameterArgs};
pub(super) use picture::{EncodingArgs, PictureArgs, ReportArgs, SpeedArgs};

use super::command_line::command_line;
use super::keep::KeepArgs;
use super::looks::LookArgs;
use super::memory::MemoryArgs;
use super::part::PartArgs;
use super::particles::ParticleArgs;
use super::sequences::SequenceArgs;
use super::slices::SliceArgs;
use super::views::{StyleArgs, ViewArgs};
use super::{Failure, bench, compare, examples, merge, part, status, stress, view};
use clap::{Parser, Subcommand};
use spherule::image::Format;
use std::path::PathBuf;

/// Renders scenes made of spheres: exact visibility, and the same picture at every speed setting
#[derive(Debug, Parser)]
#[command(
    name = "spherule",
    version,
    override_usage = "spherule [FILE] [OPTIONS]\n       spherule <COMMAND>",
    after_help = examples::PROGRAM
)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene or a particle file to a picture (the default command)
    #[command(allow_negative_numbers = true, after_help = examples::RENDER)]
    Render(Box<RenderArgs>),
    /// Look at a scene or a particle file while it refines: turn it, color it, name its spheres
    #[command(allow_negative_numbers = true, after_help = view::examples())]
    View(Box<view::ViewerArgs>),
    /// Put the parts of a render together that several machines have made
    #[command(allow_negative_numbers = true, after_help = examples::MERGE)]
    Merge(merge::Args),
    /// Tell what parts of a render have been done, what is missing, and how long it will take
    #[command(after_help = examples::STATUS)]
    Status(status::Args),
    /// Write a generated scene: a TOML file, and its spheres in a CSV file beside it
    #[command(allow_negative_numbers = true, after_help = examples::FIELD)]
    Field(FieldArgs),
    /// Say what is in a scene, and what a render of it will do without
    #[command(after_help = examples::INFO)]
    Info(InfoArgs),
    /// Measure how far a picture is from a reference
    #[command(after_help = examples::COMPARE)]
    Compare(compare::Args),
    /// Count wrong decisions of this program, and of usual forms, where rounding is at its worst
    #[command(after_help = stress::EXAMPLES)]
    Stress(stress::Args),
    /// Measure how fast this program is on this machine: tables, plots, and a report
    #[command(after_help = bench::EXAMPLES)]
    Bench(bench::Args),
    /// Print a completion script for a shell
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArgs),
}

#[derive(Debug, Parser)]
pub(super) struct RenderArgs {
    /// A scene (.toml), a file of particles (any other name) or - for particles on standard input;
    /// without it, a random field of spheres
    pub(super) scene: Option<PathBuf>,
    #[arg(
        short,
        long,
        value_name = "FILE",
        default_value = "spherule.png",
        help = picture_help()
    )]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) particles: ParticleArgs,
    #[command(flatten)]
    pub(super) looks: LookArgs,
    #[command(flatten)]
    pub(super) slices: SliceArgs,
    #[command(flatten)]
    pub(super) views: ViewArgs,
    #[command(flatten)]
    pub(super) style: StyleArgs,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) encoding: EncodingArgs,
    #[command(flatten)]
    pub(super) keep: KeepArgs,
    #[command(flatten)]
    pub(super) speed: SpeedArgs,
    #[command(flatten)]
    pub(super) memory: MemoryArgs,
    #[command(flatten)]
    pub(super) sequence: SequenceArgs,
    #[command(flatten)]
    pub(super) part: PartArgs,
    /// Write the scene with its tree to FILE, and render nothing. Parts, and other renders, of FILE begin
    /// at once; settings may be others then, but not spheres, looks and camera
    #[arg(
        long,
        value_name = "FILE",
        help_heading = part::HEADING,
        conflicts_with_all = ["output", "part", "checkpoint", "resume", "turntable", "skip_existing", "layers"]
    )]
    pub(super) prepare: Option<PathBuf>,
    #[command(flatten)]
    pub(super) report: ReportArgs,
}

impl RenderArgs {
    /// Returns whether it makes many pictures.
    pub(super) fn is_sequence(&self) -> bool {
        self.views.turntable().is_some() || self.particles.frames().is_some()
    }
}

#[derive(Debug, clap::Args)]
pub(super) struct InfoArgs {
    /// A scene (.toml), a file of particles (any other name) or - for particles on standard input
    pub(super) scene: PathBuf,
    #[command(flatten)]
    pub(super) particles: ParticleArgs,
    /// List the first and last N particles of a particle file
    #[arg(long, value_name = "N")]
    pub(super) rows: Option<usize>,
    /// One JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub(super) shell: clap_complete::Shell,
}

/// Help of the option that names the picture.
pub(super) fn picture_help() -> String {
    format!(
        "The picture: a name that ends in {}, or - for standard output",
        Format::written_suffixes()
    )
}

/// Help of a picture that is read.
pub(super) fn read_help() -> String {
    format!("The picture: {}", Format::read_names())
}

impl Args {
    /// Returns the command of this process, or what there is to print instead: help, the version, or what
    /// is wrong.
    pub(super) fn of_process() -> Result<Command, Failure> {
        let usual = || Command::Render(Box::new(RenderArgs::parse_from(["spherule"])));
        let args = Self::try_parse_from(command_line()?).map_err(Failure::Usage)?;
        Ok(args.command.unwrap_or_else(usual))
    }
}
