//! Arguments for the image, its file, performance and reports.

use super::names::{self, BITS, Builder, Device, LANES, LAYERS, PPM, TRAVERSALS};
use super::settings::SettingArgs;
use super::values::{self, THREADS};
use crate::cli::failure::Failure;
use clap::value_parser;
use spherule_render::film::Region;
use spherule_render::image::{Depth, Format, PpmEncoding};
use spherule_render::layers::Layer;
use spherule_render::trace::{PacketWidth, Traversal};

/// Render settings that override those of the scene.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Image (overrides the scene's settings)")]
pub(in crate::cli) struct PictureArgs {
    #[command(flatten)]
    pub(in crate::cli) settings: SettingArgs<false>,
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
    #[command(flatten)]
    pub(in crate::cli) display: SettingArgs<true>,
    /// Bits per channel of PNG, PPM and TIFF [default: 8]
    #[arg(long, value_parser = names::parser(&BITS))]
    pub(in crate::cli) bits: Option<Depth>,
    /// JPEG quality, 1 to 100 [default: 90]
    #[arg(long, value_name = "N", value_parser = value_parser!(u8).range(1..=100))]
    pub(in crate::cli) quality: Option<u8>,
    /// PPM encoding [default: binary]
    #[arg(long, value_parser = names::parser(&PPM))]
    pub(in crate::cli) ppm: Option<PpmEncoding>,
    /// Additional channels of an EXR file (AOVs), for denoisers and compositing; separated by commas
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = names::parser(&LAYERS))]
    pub(in crate::cli) layers: Vec<Option<Layer>>,
}

impl EncodingArgs {
    /// Returns the requested layers without repetition; all if one is `None`.
    pub(in crate::cli) fn wanted_layers(&self) -> Vec<Layer> {
        let typed = &self.layers;
        let all = typed.contains(&None);
        Layer::ALL.into_iter().filter(|layer| all || typed.contains(&Some(*layer))).collect()
    }

    /// Rejects layers for formats that cannot store them.
    pub(in crate::cli) fn check_layers(
        &self,
        command: &str,
        format: Format,
    ) -> Result<(), Failure> {
        if self.layers.is_empty() || format == Format::Exr {
            return Ok(());
        }
        let message = format!(
            "{format} files cannot store --layers; use an --output that ends in .exr, or --output-format exr"
        );
        Err(Failure::usage(command, message))
    }

    /// Returns whether a requested layer needs statistics of the render.
    pub(in crate::cli) fn needs_statistics(&self) -> bool {
        self.wanted_layers().into_iter().any(Layer::is_statistic)
    }
}

/// Performance settings, which never change the image.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Performance (never changes the image)")]
pub(in crate::cli) struct SpeedArgs {
    /// Number of threads [default: as the CPU affinity mask and the cgroup's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(in crate::cli) threads: Option<u16>,
    /// Traversal of the acceleration structure
    #[arg(long, default_value = "auto", value_parser = names::parser(&TRAVERSALS))]
    pub(in crate::cli) traversal: Traversal,
    /// Builder of the acceleration structure
    #[arg(long, value_enum, default_value_t = Builder::Auto)]
    pub(in crate::cli) builder: Builder,
    /// Rays per packet [default: 16]
    #[arg(long, value_parser = names::parser(&LANES))]
    pub(in crate::cli) lanes: Option<PacketWidth>,
    /// Device that follows paths
    #[arg(long, value_enum, default_value_t = Device::Auto)]
    pub(in crate::cli) device: Device,
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
    /// Also print samples, rays, decisions without rounding, memory, and the time of each stage of the render
    #[arg(long, conflicts_with = "quiet")]
    pub(in crate::cli) stats: bool,
    /// Print statistics and settings as one JSON object to standard output
    #[arg(long)]
    pub(in crate::cli) json: bool,
    /// Also show the image in the terminal while it refines
    #[arg(long, conflicts_with = "json")]
    pub(in crate::cli) terminal: bool,
}

/// Help of the option that names the output image.
pub(in crate::cli) fn picture_help() -> String {
    format!(
        "Output image: a name that ends in {}, or - for standard output",
        Format::written_suffixes(&[])
    )
}

/// Help of an argument that names an input image.
pub(in crate::cli) fn read_help() -> String {
    format!("Image: {}", Format::read_names())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        encoding: EncodingArgs,
    }

    #[test]
    fn layers_are_unique_and_in_order() {
        let wanted = |words: &[&str]| {
            let line = Line::try_parse_from(["spherule"].iter().chain(words));
            line.expect("options").encoding.wanted_layers()
        };
        assert_eq!(wanted(&[]), []);
        assert_eq!(wanted(&["--layers", "id,albedo,id"]), [Layer::Albedo, Layer::Id]);
        assert_eq!(wanted(&["--layers", "id,all"]), Layer::ALL);
    }
}
