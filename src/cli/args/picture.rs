//! Arguments for the image, its file, performance and reports.

use crate::cli::names::{
    self, BITS, Builder, FILTERS, INTEGRATORS, LANES, LAYERS, LIGHT_CHOICES, PPM, SAMPLERS, TONES,
    TRAVERSALS,
};
use crate::cli::values::{self, DepthLimit, OrNone, SAMPLES, Size, THREADS};
use clap::value_parser;
use spherule_render::film::Region;
use spherule_render::image::{Depth, Format, PpmEncoding};
use spherule_render::layers::Layer;
use spherule_render::scene::{Filter, Integrator, LightChoice, Roulette, SamplerKind, Tone};
use spherule_render::trace::{PacketWidth, Traversal};
use std::time::Duration;

/// Render settings that override those of the scene.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Image (overrides the scene's settings)")]
pub(in crate::cli) struct PictureArgs {
    /// Width and height in pixels, each 1 to 65535
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = values::size)]
    pub(in crate::cli) size: Option<Size>,
    /// Samples per pixel; with --until-error or --time, the maximum
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    pub(in crate::cli) spp: Option<u32>,
    /// Stop when the relative error of the image, its root mean square error divided by its mean radiance, is
    /// below this with 95 % confidence; none to take as many samples as --spp says
    #[arg(long, value_name = "PERCENT", allow_hyphen_values = true, value_parser = values::error)]
    pub(in crate::cli) until_error: Option<OrNone<f64>>,
    /// Stop after this time, as in 60s or 5m; none for no limit
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = values::time)]
    pub(in crate::cli) time: Option<OrNone<Duration>>,
    /// Maximum number of bounces of a path: a number, or unlimited
    #[arg(long, value_name = "N", value_parser = values::depth)]
    pub(in crate::cli) depth: Option<DepthLimit>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N")]
    pub(in crate::cli) seed: Option<u64>,
    /// Rendering algorithm
    #[arg(long, value_parser = INTEGRATORS.parser())]
    pub(in crate::cli) integrator: Option<Integrator>,
    /// Shadow rays to each light at each hit, for the integrator whitted
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    pub(in crate::cli) shadow_samples: Option<u32>,
    /// Maximum distance of occluders, for the integrator ao; in the scene's unit, or inf
    #[arg(long, value_name = "DISTANCE", value_parser = values::distance)]
    pub(in crate::cli) ao_distance: Option<f64>,
    /// Generator of sample points
    #[arg(long, value_parser = SAMPLERS.parser())]
    pub(in crate::cli) sampler: Option<SamplerKind>,
    /// Pixel filter
    #[arg(long, value_parser = FILTERS.parser())]
    pub(in crate::cli) filter: Option<Filter>,
    /// Russian roulette: none, throughput, or the probability P of a path to survive each bounce
    #[arg(long, value_name = "none|throughput|P", value_parser = values::roulette)]
    pub(in crate::cli) roulette: Option<Roulette>,
    /// Light selection for direct lighting, for the integrator path
    #[arg(long, value_parser = LIGHT_CHOICES.parser())]
    pub(in crate::cli) light_choice: Option<LightChoice>,
    /// Do not sample lights through mirrors and glass: caustics then come only from paths that hit a light by
    /// chance; for the integrator path
    #[arg(long)]
    pub(in crate::cli) no_caustics: bool,
    /// Render only this region: column and row of its top left corner, its width and height
    #[arg(long, value_name = "X,Y,WxH", allow_hyphen_values = true, value_parser = values::region)]
    pub(in crate::cli) region: Option<Region>,
}

/// Encoding of the image file.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "File")]
pub(in crate::cli) struct EncodingArgs {
    /// Image format [default: by the suffix of --output, or png for -]
    #[arg(long, value_name = "FORMAT", value_parser = names::formats())]
    pub(in crate::cli) output_format: Option<Format>,
    /// Exposure in stops: multiplies the radiance by 2 to this power, for all formats but EXR and PFM
    #[arg(long, value_name = "STOPS", value_parser = values::exposure)]
    pub(in crate::cli) exposure: Option<f64>,
    /// Tone curve, for all formats but EXR and PFM
    #[arg(long, value_parser = TONES.parser())]
    pub(in crate::cli) tone: Option<Tone>,
    /// Bits per channel of PNG, PPM and TIFF [default: 8]
    #[arg(long, value_parser = BITS.parser())]
    pub(in crate::cli) bits: Option<Depth>,
    /// JPEG quality, 1 to 100 [default: 90]
    #[arg(long, value_name = "N", value_parser = value_parser!(u8).range(1..=100))]
    pub(in crate::cli) quality: Option<u8>,
    /// PPM encoding [default: binary]
    #[arg(long, value_parser = PPM.parser())]
    pub(in crate::cli) ppm: Option<PpmEncoding>,
    /// Additional channels of an EXR file (AOVs), for denoisers and compositing; separated by commas
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = LAYERS.parser())]
    pub(in crate::cli) layers: Vec<Option<Layer>>,
}

/// Performance settings, which never change the image.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Performance (never changes the image)")]
pub(in crate::cli) struct SpeedArgs {
    /// Number of threads [default: as the CPU affinity mask and the cgroup's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(in crate::cli) threads: Option<u16>,
    /// How rays are traced
    #[arg(long, default_value = "auto", value_parser = TRAVERSALS.parser())]
    pub(in crate::cli) traversal: Traversal,
    /// Builder of the acceleration structure
    #[arg(long, value_enum, default_value_t = Builder::Auto)]
    pub(in crate::cli) builder: Builder,
    /// Rays per packet [default: 16]
    #[arg(long, value_parser = LANES.parser())]
    pub(in crate::cli) lanes: Option<PacketWidth>,
}

/// Reports on standard output and standard error.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = "Reports")]
#[expect(clippy::struct_excessive_bools, reason = "one for each option")]
pub(in crate::cli) struct ReportArgs {
    /// Print only warnings and errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(in crate::cli) quiet: bool,
    /// Also print the contents of the scene, and the work that is skipped because the scene does not need it
    #[arg(short, long)]
    pub(in crate::cli) verbose: bool,
    /// Also print the time of each stage of the render
    #[arg(long, conflicts_with = "quiet")]
    pub(in crate::cli) stats: bool,
    /// Print statistics and settings as one JSON object to standard output
    #[arg(long)]
    pub(in crate::cli) json: bool,
    /// Also show the image in the terminal while it refines
    #[arg(long, conflicts_with = "json")]
    pub(in crate::cli) terminal: bool,
}
