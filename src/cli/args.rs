//! The command line as typed.

use super::keep::KeepArgs;
use super::looks::LookArgs;
use super::memory::MemoryArgs;
use super::names::{
    BITS, Builder, FILTERS, INTEGRATORS, LANES, LAYERS, LIGHT_CHOICES, PPM, SAMPLERS, TONES,
    Traversal,
};
use super::part::PartArgs;
use super::particles::ParticleArgs;
use super::slices::SliceArgs;
use super::values::{self, DepthLimit, Radii, SAMPLES, Size, THREADS, Target};
use super::views::{StyleArgs, ViewArgs};
use super::{bench, compare, examples, merge, stress, view};
use clap::{Parser, Subcommand, ValueEnum, value_parser};
use spherule::film::Region;
use spherule::image::{Depth, PpmEncoding};
use spherule::layers::Layer;
use spherule::scene::{Filter, Integrator, LightChoice, Roulette, SamplerKind, Tone};
use spherule::trace::Width;
use std::path::PathBuf;
use std::time::Duration;

/// Renders scenes made of spheres: exact visibility, and the same picture at every speed setting
#[derive(Debug, Parser)]
#[command(name = "spherule", version, after_help = examples::PROGRAM)]
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
    /// The picture: .png, .ppm, .pfm or .exr
    #[arg(short, long, value_name = "FILE", default_value = "spherule.png")]
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
    pub(super) part: PartArgs,
    #[command(flatten)]
    pub(super) report: ReportArgs,
}

/// What replaces the scene's own settings.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Picture, instead of what the scene says")]
pub(super) struct PictureArgs {
    /// Width and height in pixels, each 1 to 65535
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = values::size)]
    pub(super) size: Option<Size>,
    /// Samples per pixel; with --until-error or --time, the most of them
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    pub(super) spp: Option<u32>,
    /// Stop when the picture is 95 % sure to be right: when the root of its mean squared error, by
    /// its mean radiance, is below this; none for as many samples as --spp says
    #[arg(long, value_name = "PERCENT", allow_hyphen_values = true, value_parser = values::error)]
    pub(super) until_error: Option<Target<f64>>,
    /// Stop when this time is over, as in 60s or 5m, with the best picture that it allows
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = values::time)]
    pub(super) time: Option<Target<Duration>>,
    /// Most scatterings on a path: a number, or unlimited
    #[arg(long, value_name = "N", value_parser = values::depth)]
    pub(super) depth: Option<DepthLimit>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,
    /// How light is gathered
    #[arg(long, value_parser = INTEGRATORS.parser())]
    pub(super) integrator: Option<Integrator>,
    /// Samples toward each light at each hit, for the integrator whitted
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    pub(super) shadow_samples: Option<u32>,
    /// What is farther does not occlude, for the integrator ao; in the scene's unit, or inf
    #[arg(long, value_name = "DISTANCE", value_parser = values::distance)]
    pub(super) ao_distance: Option<f64>,
    /// Where samples lie
    #[arg(long, value_parser = SAMPLERS.parser())]
    pub(super) sampler: Option<SamplerKind>,
    /// How samples become pixels
    #[arg(long, value_parser = FILTERS.parser())]
    pub(super) filter: Option<Filter>,
    /// How paths end by chance: none, throughput, or the probability P to survive each bounce
    #[arg(long, value_name = "none|throughput|P", value_parser = values::roulette)]
    pub(super) roulette: Option<Roulette>,
    /// How a path chooses the light that it looks for, for the integrator path
    #[arg(long, value_parser = LIGHT_CHOICES.parser())]
    pub(super) light_choice: Option<LightChoice>,
    /// Render this part alone: column and row of its top left corner, its width and height
    #[arg(long, value_name = "X,Y,WxH", allow_hyphen_values = true, value_parser = values::region)]
    pub(super) region: Option<Region>,
}

/// How the picture becomes a file.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "File")]
pub(super) struct EncodingArgs {
    /// Stops: PNG and PPM show the radiance multiplied by 2 to this power
    #[arg(long, value_name = "STOPS", value_parser = values::exposure)]
    pub(super) exposure: Option<f64>,
    /// From radiance to what PNG and PPM can show
    #[arg(long, value_parser = TONES.parser())]
    pub(super) tone: Option<Tone>,
    /// Bits of each channel of PNG and PPM [default: 8]
    #[arg(long, value_parser = BITS.parser())]
    pub(super) bits: Option<Depth>,
    /// Dialect of PPM [default: binary]
    #[arg(long, value_parser = PPM.parser())]
    pub(super) ppm: Option<PpmEncoding>,
    /// More channels in an EXR file, for denoisers and compositors; several with commas
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = LAYERS.parser())]
    pub(super) layers: Vec<Option<Layer>>,
}

/// What never changes the picture.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Speed; the picture is the same to the last bit")]
pub(super) struct SpeedArgs {
    /// Threads [default: what the affinity mask and the control group's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(super) threads: Option<u16>,
    /// How rays find spheres
    #[arg(long, value_enum, default_value_t = Traversal::Auto)]
    pub(super) traversal: Traversal,
    /// How the tree is built
    #[arg(long, value_enum, default_value_t = Builder::Auto)]
    pub(super) builder: Builder,
    /// Rays in a packet; [default: 16]
    #[arg(long, value_parser = LANES.parser())]
    pub(super) lanes: Option<Width>,
}

/// What is told.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "Reports")]
#[expect(clippy::struct_excessive_bools, reason = "one for each option")]
pub(super) struct ReportArgs {
    /// Nothing but warnings and errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(super) quiet: bool,
    /// Also what the scene contains and what is skipped because it contains no such thing
    #[arg(short, long)]
    pub(super) verbose: bool,
    /// Also which stage of the render took which share of the time
    #[arg(long, conflicts_with = "quiet")]
    pub(super) stats: bool,
    /// Statistics and settings as one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
    /// Draw the picture in the terminal too, while it refines
    #[arg(long, conflicts_with = "json")]
    pub(super) terminal: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct FieldArgs {
    /// What to generate
    #[arg(value_enum, default_value_t = Kind::Field)]
    pub(super) kind: Kind,
    /// The scene: a name that ends in .toml; the spheres go to a .csv file of the same name
    #[arg(short, long, value_name = "FILE.toml")]
    pub(super) output: PathBuf,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,
    /// Nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
    #[command(flatten)]
    pub(super) parameters: ParameterArgs,
}

/// Kinds of generated scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Kind {
    /// N x N equal spheres on a plane
    Grid,
    /// N x N random spheres on a plane: what `spherule render` shows when it is given no scene
    Field,
    /// N random spheres in a cube
    Volume,
    /// A crystal, face-centered cubic, of N x N x N cells of four spheres
    Lattice,
    /// Haines' sphereflake
    Sphereflake,
    /// The last scene of "Ray Tracing in One Weekend"
    Weekend,
}

/// Parameters of the generators; each belongs to some of the kinds.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Parameters; without them, the kind's own")]
pub(super) struct ParameterArgs {
    /// grid, field: spheres along each side [20]; volume: spheres [10000]; lattice: cells along
    /// each edge [10]
    #[arg(long, value_name = "N")]
    pub(super) count: Option<u64>,
    /// grid [0.4], lattice, sphereflake [0.5]: one radius; field [0.1,0.45], volume: least and
    /// greatest
    #[arg(long, value_name = "R|MIN,MAX", allow_hyphen_values = true, value_parser = values::radii)]
    pub(super) radius: Option<Radii>,
    /// grid: distance between neighboring centers [1]
    #[arg(long, value_name = "DISTANCE", value_parser = values::finite)]
    pub(super) spacing: Option<f64>,
    /// field: shares of diffuse, metal and glass spheres [0.68,0.2,0.12]
    #[arg(long, value_name = "D,M,G", allow_hyphen_values = true, value_parser = values::mix)]
    pub(super) mix: Option<[f64; 3]>,
    /// field [true], volume [false]: whether each sphere has its own color
    #[arg(long, value_name = "BOOL")]
    pub(super) colors: Option<bool>,
    /// volume: edge of the cube [the cube root of N]
    #[arg(long, value_name = "LENGTH", value_parser = values::finite)]
    pub(super) size: Option<f64>,
    /// lattice: thermal displacement, in distances between neighbors [0]
    #[arg(long, value_name = "DEVIATION", value_parser = values::finite)]
    pub(super) jitter: Option<f64>,
    /// sphereflake: generations of children [4]
    #[arg(long, value_name = "N")]
    pub(super) level: Option<u32>,
}

#[derive(Debug, clap::Args)]
pub(super) struct InfoArgs {
    /// A scene (.toml), a file of particles (any other name) or - for particles on standard input
    pub(super) scene: PathBuf,
    #[command(flatten)]
    pub(super) particles: ParticleArgs,
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

impl Args {
    /// What this process was called with; leaves the process if that is a call for help, or not
    /// understood.
    pub(super) fn of_process() -> Command {
        let usual = || Command::Render(Box::new(RenderArgs::parse_from(["spherule"])));
        Self::parse().command.unwrap_or_else(usual)
    }
}
