//! Arguments of `spherule render`.

use crate::cli::options::annotations::AnnotationArgs;
use crate::cli::options::appearance::AppearanceArgs;
use crate::cli::options::checkpoints::CheckpointArgs;
use crate::cli::options::image::{EncodingArgs, PictureArgs, ReportArgs, SpeedArgs, picture_help};
use crate::cli::options::memory::MemoryArgs;
use crate::cli::options::part::{self, PartArgs};
use crate::cli::options::particles::ParticleArgs;
use crate::cli::options::sequences::SequenceArgs;
use crate::cli::options::slices::SliceArgs;
use crate::cli::options::style::StyleArgs;
use crate::cli::options::views::ViewArgs;
use clap::Parser;
use std::path::PathBuf;

/// Examples at the end of `--help`.
pub(in crate::cli) const EXAMPLES: &str = "\
Examples:
  spherule render                            a random field of spheres, to spherule.png
  spherule render scene.toml -o picture.exr --size 1920x1080 --spp 256
  spherule render scene.toml --until-error 1%       stop at 1% error
  spherule render particles.xyz -o figure.png --integrator ao
  spherule render run.lammpstrj.gz --frame last --radii 0.5 -o last.png
  spherule render run.lammpstrj.gz --frame all -o frame-%04d.png
  spherule render run.lammpstrj.gz --frame all --turntable 360 --fps 24 -o video.mp4
  spherule render run.lammpstrj.gz --frame all -o frame-%04d.png --skip-existing --part 2/4
  spherule render run.gro --size 85mm --dpi 600 --legend -o figure.tif      letters of 7pt
  spherule render run.dump --color-by c_pe --color-map inferno --color-bar energy.svg
  spherule render run.gro --legend --axes --scale-bar --label 't = {time} ps' -o figure.pdf
  spherule render protein.pdb --aperture 6 --focus id:1234 -o depth-of-field.png
  spherule render protein.pdb --select 'element != H and chain == A' -o chain.png
  spherule render salt.xyz --type Na:radius=1,material=glass --type Cl:color=#30a030
  spherule render crystal.cif --wrap --replicate 3,3,2 --cell --view auto -o crystal.png
  spherule render protein.pdb --projection orthographic --turntable 90 -o turn.png
  spherule render protein.pdb --preset outline -o outline.png
  spherule render grains.csv --preset studio --up y -o grains.png
  spherule render grains.data --slice 'z>50%' --slice-mode caps -o section.png
  spherule render scene.toml -o - --output-format jpeg | display
  spherule render scene.toml --region 100,50,64x64 -o detail.png
  spherule render scene.toml -o picture.exr --part 3/8     writes picture.3-of-8.part, for merge
  spherule render scene.toml -o picture.exr --part from-env     in a job array or under mpirun
  spherule render scene.toml --prepare scene.prepared     then render scene.prepared
  parallel spherule render scene.toml -o picture.exr --part {}/8 ::: $(seq 8)
  spherule render scene.toml -o picture.exr --layers albedo,normal,depth,id
  spherule render scene.toml --memory-limit 4GB     fails at once if it needs more
  spherule render scene.toml --json --quiet > statistics.json
  spherule render scene.toml --spp 100000 -o long.exr --checkpoint long.checkpoint
  spherule render --resume long.checkpoint          same image as without a stop
  spherule render --resume long.checkpoint --spp 200000 --threads 8

Ctrl-C and SIGTERM save the unfinished image and the checkpoint, and exit with code 130 or 143. A
second signal ends the program at once, without leaving partial files. In a sequence, an unfinished
image is not written, but the checkpoint is.";

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
    format!(
        "{}; .svg and .pdf hold the image with annotations as vectors and text; .html is a \
         page that names particles, and turns or plays a sequence",
        picture_help()
    )
}
