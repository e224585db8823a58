//! Arguments of `spherule render`.

use crate::cli::annotations::AnnotationArgs;
use crate::cli::appearance::AppearanceArgs;
use crate::cli::checkpoint::CheckpointArgs;
use crate::cli::memory::MemoryArgs;
use crate::cli::options::picture::{
    EncodingArgs, PictureArgs, ReportArgs, SpeedArgs, picture_help,
};
use crate::cli::part::{self, PartArgs};
use crate::cli::particles::ParticleArgs;
use crate::cli::sequences::SequenceArgs;
use crate::cli::slices::SliceArgs;
use crate::cli::views::{StyleArgs, ViewArgs};
use clap::Parser;
use std::path::PathBuf;

#[derive(Debug, Parser)]
pub(in crate::cli) struct RenderArgs {
    /// Scene (.toml), particle file (any other name), or - to read particles from standard input [default: a
    /// random field of spheres]
    pub(in crate::cli) scene: Option<PathBuf>,
    #[arg(
        short,
        long,
        value_name = "FILE",
        default_value = "spherule.png",
        help = page_help()
    )]
    pub(in crate::cli) output: PathBuf,
    #[command(flatten)]
    pub(in crate::cli) particles: ParticleArgs,
    #[command(flatten)]
    pub(in crate::cli) looks: AppearanceArgs,
    #[command(flatten)]
    pub(in crate::cli) slices: SliceArgs,
    #[command(flatten)]
    pub(in crate::cli) views: ViewArgs,
    #[command(flatten)]
    pub(in crate::cli) style: StyleArgs,
    #[command(flatten)]
    pub(in crate::cli) annotations: AnnotationArgs,
    #[command(flatten)]
    pub(in crate::cli) picture: PictureArgs,
    #[command(flatten)]
    pub(in crate::cli) encoding: EncodingArgs,
    #[command(flatten)]
    pub(in crate::cli) checkpoints: CheckpointArgs,
    #[command(flatten)]
    pub(in crate::cli) speed: SpeedArgs,
    #[command(flatten)]
    pub(in crate::cli) memory: MemoryArgs,
    #[command(flatten)]
    pub(in crate::cli) sequence: SequenceArgs,
    #[command(flatten)]
    pub(in crate::cli) part: PartArgs,
    /// Write the scene and its acceleration structure to FILE instead of rendering. Rendering FILE, or parts
    /// of it, starts at once; settings may differ then, but not spheres, materials and camera
    #[arg(
        long,
        value_name = "FILE",
        help_heading = part::HEADING,
        conflicts_with_all = ["output", "part", "checkpoint", "resume", "turntable", "skip_existing", "layers"]
    )]
    pub(in crate::cli) prepare: Option<PathBuf>,
    #[command(flatten)]
    pub(in crate::cli) report: ReportArgs,
}

impl RenderArgs {
    /// Returns whether the command renders a sequence of images.
    pub(in crate::cli) fn is_sequence(&self) -> bool {
        self.views.turntable().is_some() || self.particles.frames().is_some()
    }
}

/// Help of the option that names the output image or page.
fn page_help() -> String {
    format!("{}; .svg and .pdf hold the image with annotations as vectors and text", picture_help())
}
