//! Arguments of all commands.

mod field;
mod picture;
mod settings;

pub(super) use field::{FieldArgs, Kind, ParameterArgs};
pub(super) use picture::{EncodingArgs, PictureArgs, ReportArgs, SpeedArgs};
pub(super) use settings::option_name;

use super::annotations::AnnotationArgs;
use super::appearance::AppearanceArgs;
use super::checkpoint::CheckpointArgs;
use super::command_line::command_line;
use super::failure::Failure;
use super::memory::MemoryArgs;
use super::part::PartArgs;
use super::particles::ParticleArgs;
use super::sequences::SequenceArgs;
use super::slices::SliceArgs;
use super::views::{StyleArgs, ViewArgs};
use super::{bench, compare, examples, merge, part, status, stress, version, view};
use clap::{Parser, Subcommand};
use spherule_render::image::Format;
use std::path::PathBuf;

/// Renders scenes of spheres with exact visibility; the image never depends on the performance settings
#[derive(Debug, Parser)]
#[command(
    name = "spherule",
    version,
    override_usage = "spherule [FILE] [OPTIONS]\n       spherule <COMMAND>",
    after_help = examples::PROGRAM
)]
pub(super) struct Args {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene or a particle file to an image (the default command)
    #[command(allow_negative_numbers = true, after_help = examples::RENDER)]
    Render(Box<RenderArgs>),
    /// Open an interactive viewer for a scene or a particle file
    #[command(
        allow_negative_numbers = true,
        after_help = view::examples(),
        mut_args(view::hide_refused)
    )]
    View(Box<view::ViewerArgs>),
    /// Merge the parts of a render made on several machines
    #[command(allow_negative_numbers = true, after_help = examples::MERGE)]
    Merge(merge::Args),
    /// Show the progress of parts and checkpoints: what is done, what is missing, and the time left
    #[command(after_help = examples::STATUS)]
    Status(status::Args),
    /// Generate a scene: a TOML file, with its spheres in a CSV file next to it
    #[command(allow_negative_numbers = true, after_help = examples::FIELD)]
    Field(FieldArgs),
    /// Show the contents of a scene, and the work that a render of it skips
    #[command(after_help = examples::INFO)]
    Info(Box<InfoArgs>),
    /// Measure the difference between an image and a reference
    #[command(after_help = examples::COMPARE)]
    Compare(compare::Args),
    /// Compare intersection tests with exact arithmetic in numerically hard cases
    #[command(after_help = stress::EXAMPLES)]
    Stress(stress::Args),
    /// Run benchmarks on this machine, and write tables, plots and a report
    #[command(after_help = bench::EXAMPLES)]
    Bench(bench::Args),
    /// Print a completion script for a shell
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Write the manual pages of all commands to a folder
    #[command(hide = true)]
    Man(ManArgs),
    /// Print the version with details: `--version --verbose`
    #[command(skip)]
    Version,
}

#[derive(Debug, Parser)]
pub(super) struct RenderArgs {
    /// Scene (.toml), particle file (any other name), or - to read particles from standard input [default: a
    /// random field of spheres]
    pub(super) scene: Option<PathBuf>,
    #[arg(
        short,
        long,
        value_name = "FILE",
        default_value = "spherule.png",
        help = page_help()
    )]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) particles: ParticleArgs,
    #[command(flatten)]
    pub(super) looks: AppearanceArgs,
    #[command(flatten)]
    pub(super) slices: SliceArgs,
    #[command(flatten)]
    pub(super) views: ViewArgs,
    #[command(flatten)]
    pub(super) style: StyleArgs,
    #[command(flatten)]
    pub(super) annotations: AnnotationArgs,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) encoding: EncodingArgs,
    #[command(flatten)]
    pub(super) checkpoints: CheckpointArgs,
    #[command(flatten)]
    pub(super) speed: SpeedArgs,
    #[command(flatten)]
    pub(super) memory: MemoryArgs,
    #[command(flatten)]
    pub(super) sequence: SequenceArgs,
    #[command(flatten)]
    pub(super) part: PartArgs,
    /// Write the scene and its acceleration structure to FILE instead of rendering. Rendering FILE, or parts
    /// of it, starts at once; settings may differ then, but not spheres, materials and camera
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
    /// Returns whether the command renders a sequence of images.
    pub(super) fn is_sequence(&self) -> bool {
        self.views.turntable().is_some() || self.particles.frames().is_some()
    }
}

#[derive(Debug, clap::Args)]
pub(super) struct InfoArgs {
    /// Scene (.toml), particle file (any other name), or - to read particles from standard input
    #[arg(required_unless_present = "devices")]
    pub(super) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(super) particles: ParticleArgs,
    /// List GPUs, their limits, and what a test of their arithmetic finds
    #[arg(long, conflicts_with_all = ["scene", "rows"])]
    pub(super) devices: bool,
    /// List the first and last N particles of a particle file
    #[arg(long, value_name = "N")]
    pub(super) rows: Option<usize>,
    /// Print one JSON object to standard output
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct CompletionsArgs {
    /// Shell to print the script for
    #[arg(value_enum)]
    pub(super) shell: clap_complete::Shell,
}

#[derive(Debug, clap::Args)]
pub(super) struct ManArgs {
    /// Existing folder
    pub(super) folder: PathBuf,
}

/// Help of the option that names the output image.
pub(super) fn picture_help() -> String {
    format!(
        "Output image: a name that ends in {}, or - for standard output",
        Format::written_suffixes()
    )
}

/// Help of the option that names the output image or page.
fn page_help() -> String {
    format!("{}; .svg and .pdf hold the image with annotations as vectors and text", picture_help())
}

/// Help of an argument that names an input image.
pub(super) fn read_help() -> String {
    format!("Image: {}", Format::read_names())
}

impl Args {
    /// Parses the command line of this process. The error holds the text to print instead: help, the version,
    /// or a usage error.
    pub(super) fn of_process() -> Result<Command, Failure> {
        let default = || Command::Render(Box::new(RenderArgs::parse_from(["spherule"])));
        if version::is_asked_in_detail(&std::env::args_os().collect::<Vec<_>>()) {
            return Ok(Command::Version);
        }
        let args = Self::try_parse_from(command_line()?).map_err(Failure::Arguments)?;
        Ok(args.command.unwrap_or_else(default))
    }
}
