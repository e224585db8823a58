//! What is said of the picture, of its file, of speed, and of reports.

use crate::cli::names::{
    self, BITS, Builder, FILTERS, INTEGRATORS, LANES, LAYERS, LIGHT_CHOICES, PPM, SAMPLERS, TONES,
    TRAVERSALS,
};
use crate::cli::values::{self, DepthLimit, SAMPLES, Size, THREADS, Target};
use clap::value_parser;
use spherule::film::Region;
use spherule::image::{Depth, Format, PpmEncoding};
use spherule::layers::Layer;
use spherule::scene::{Filter, Integrator, LightChoice, Roulette, SamplerKind, Tone};
use spherule::trace::{PacketWidth, Traversal};
use std::time::Duration;

/// What replaces the scene's own settings.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Picture, instead of what the scene says")]
pub(in crate::cli) struct PictureArgs {
    /// Width and height in pixels, each 1 to 65535
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = values::size)]
    pub(in crate::cli) size: Option<Size>,
    /// Samples per pixel; with --until-error or --time, the most of them
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    pub(in crate::cli) spp: Option<u32>,
    /// Stop when the picture is 95 % sure to be right: when the root of its mean squared error, by
    /// its mean radiance, is below this; none for as many samples as --spp says
    #[arg(long, value_name = "PERCENT", allow_hyphen_values = true, value_parser = values::error)]
    pub(in crate::cli) until_error: Option<Target<f64>>,
    /// Stop when this time is over, as in 60s or 5m, with the best picture that it allows
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = values::time)]
    pub(in crate::cli) time: Option<Target<Duration>>,
    /// Most scatterings on a path: a number, or unlimited
    #[arg(long, value_name = "N", value_parser = values::depth)]
    pub(in crate::cli) depth: Option<DepthLimit>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N")]
    pub(in crate::cli) seed: Option<u64>,
    /// How light is gathered
    #[arg(long, value_parser = INTEGRATORS.parser())]
    pub(in crate::cli) integrator: Option<Integrator>,
    /// Samples toward each light at each hit, for the integrator whitted
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    pub(in crate::cli) shadow_samples: Option<u32>,
    /// What is farther does not occlude, for the integrator ao; in the scene's unit, or inf
    #[arg(long, value_name = "DISTANCE", value_parser = values::distance)]
    pub(in crate::cli) ao_distance: Option<f64>,
    /// Where samples lie
    #[arg(long, value_parser = SAMPLERS.parser())]
    pub(in crate::cli) sampler: Option<SamplerKind>,
    /// How samples become pixels
    #[arg(long, value_parser = FILTERS.parser())]
    pub(in crate::cli) filter: Option<Filter>,
    /// How paths end by chance: none, throughput, or the probability P to survive each bounce
    #[arg(long, value_name = "none|throughput|P", value_parser = values::roulette)]
    pub(in crate::cli) roulette: Option<Roulette>,
    /// How a path chooses the light that it looks for, for the integrator path
    #[arg(long, value_parser = LIGHT_CHOICES.parser())]
    pub(in crate::cli) light_choice: Option<LightChoice>,
    /// Leave it to chance to find lamps by way of mirrors and glass, for the integrator path
    #[arg(long)]
    pub(in crate::cli) no_caustics: bool,
    /// Render this part alone: column and row of its top left corner, its width and height
    #[arg(long, value_name = "X,Y,WxH", allow_hyphen_values = true, value_parser = values::region)]
    pub(in crate::cli) region: Option<Region>,
}

/// How the picture becomes a file.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "File")]
pub(in crate::cli) struct EncodingArgs {
    /// Format of the picture [default: what the suffix of --output says, or png for -]
    #[arg(long, value_name = "FORMAT", value_parser = names::formats())]
    pub(in crate::cli) output_format: Option<Format>,
    /// Exposure in stops: all formats but EXR and PFM show the radiance multiplied by 2 to this power
    #[arg(long, value_name = "STOPS", value_parser = values::exposure)]
    pub(in crate::cli) exposure: Option<f64>,
    /// Tone curve, for all formats but EXR and PFM
    #[arg(long, value_parser = TONES.parser())]
    pub(in crate::cli) tone: Option<Tone>,
    /// Bits of each channel of PNG, PPM and TIFF [default: 8]
    #[arg(long, value_parser = BITS.parser())]
    pub(in crate::cli) bits: Option<Depth>,
    /// Quality of JPEG, 1 to 100 [default: 90]
    #[arg(long, value_name = "N", value_parser = value_parser!(u8).range(1..=100))]
    pub(in crate::cli) quality: Option<u8>,
    /// Dialect of PPM [default: binary]
    #[arg(long, value_parser = PPM.parser())]
    pub(in crate::cli) ppm: Option<PpmEncoding>,
    /// More channels in an EXR file, for denoisers and compositors; several with commas
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = LAYERS.parser())]
    pub(in crate::cli) layers: Vec<Option<Layer>>,
}

/// What never changes the picture.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Speed; the picture is the same to the last bit")]
pub(in crate::cli) struct SpeedArgs {
    /// Threads [default: what the affinity mask and the control group's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(in crate::cli) threads: Option<u16>,
    /// How rays are traced
    #[arg(long, default_value = "auto", value_parser = TRAVERSALS.parser())]
    pub(in crate::cli) traversal: Traversal,
    /// How the tree is built
    #[arg(long, value_enum, default_value_t = Builder::Auto)]
    pub(in crate::cli) builder: Builder,
    /// Rays in a packet; [default: 16]
    #[arg(long, value_parser = LANES.parser())]
    pub(in crate::cli) lanes: Option<PacketWidth>,
}

/// What is told.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "Reports")]
#[expect(clippy::struct_excessive_bools, reason = "one for each option")]
pub(in crate::cli) struct ReportArgs {
    /// Nothing but warnings and errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(in crate::cli) quiet: bool,
    /// Also what the scene contains and what is skipped because it contains no such thing
    #[arg(short, long)]
    pub(in crate::cli) verbose: bool,
    /// Also which stage of the render took which share of the time
    #[arg(long, conflicts_with = "quiet")]
    pub(in crate::cli) stats: bool,
    /// Statistics and settings as one JSON object on standard output
    #[arg(long)]
    pub(in crate::cli) json: bool,
    /// Draw the picture in the terminal too, while it refines
    #[arg(long, conflicts_with = "json")]
    pub(in crate::cli) terminal: bool,
}
