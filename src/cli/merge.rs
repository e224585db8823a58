//! `spherule merge`: combines the parts of a render into one image.

use super::contents::plural;
use super::failure::Failure;
use super::files::Files;
use super::options::image::{EncodingArgs, picture_help};
use super::options::lists::{self, List};
use super::options::memory::MemoryArgs;
use super::output;
use super::picture_file;
use super::render::{Subject, warnings};
use super::write_file::write_file;
use indicatif::HumanCount;
use serde::Serialize;
use spherule_render::checkpoint::{self, Caption};
use spherule_render::film::Region;
use spherule_render::graphics::Drawing;
use spherule_render::image::{Channel, Format};
use spherule_render::layers::{Features, Layer, Layers};
use spherule_render::render::{ImagePart, Render, ResumableRender};
use spherule_render::split::{Merge, MergeError};
use std::ops::Range;
use std::path::PathBuf;
use std::process::ExitCode;

/// Examples at the end of `--help`.
pub(super) const EXAMPLES: &str = "\
The merged image has the same bytes as a render in one piece, and the layers of the parts.

Examples:
  spherule merge picture.*.part -o picture.exr
  spherule merge picture.1-of-3.part picture.3-of-3.part --partial -o preview.png";

/// Arguments of `spherule merge`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Files that `spherule render --part` wrote, in any order
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    #[arg(short, long, value_name = "FILE", help = picture_help())]
    output: PathBuf,
    /// Merge even if parts are missing or were interrupted: each pixel is the mean of its available samples,
    /// or black if it has none
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    encoding: EncodingArgs,
    #[command(flatten)]
    memory: MemoryArgs,
    /// Print only warnings and errors
    #[arg(short, long)]
    quiet: bool,
    /// Print statistics and settings as one JSON object to standard output
    #[arg(long)]
    json: bool,
}

/// The merged parts.
struct Merged {
    whole: ResumableRender,
    /// Settings and layers, from the first part.
    caption: Caption,
    /// Features of tiles, from all parts.
    pieces: Vec<(Range<u32>, Vec<Features>)>,
    missing: Vec<ImagePart>,
}

/// Statistics of the merge.
#[derive(Serialize)]
struct Summary {
    program: &'static str,
    version: &'static str,
    output: String,
    parts: usize,
    complete: bool,
    /// Samples and tiles that no part has.
    missing: Vec<String>,
    settings: List,
    samples: u64,
    rays: u64,
    /// Sum of the parts' render times.
    render_seconds: f64,
}

/// Merges the parts, writes the image and prints statistics.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    args.memory.apply();
    let format = picture_file::format(&args.output, args.encoding.output_format)?;
    picture_file::check_stream("merge", &args.output, args.json)?;
    args.encoding.check_layers("merge", format)?;
    let mut files = Files::new("merge");
    args.parts.iter().for_each(|part| files.reads("a part", part));
    files.writes("--output", &args.output);
    files.check()?;
    picture_file::check(&args.output)?;
    let merged = merge(args)?;
    let mut render = merged.whole.render();
    let drawing = Drawing::from_bytes(&merged.caption.annotations);
    let unread = || Failure::UnreadAnnotations(args.parts[0].display().to_string());
    drawing.ok_or_else(unread)?.draw_over(&mut render.image);
    let channels = merged.channels(args, format, &render)?;
    let (region, settings) = (merged.whole.region(), merged.whole.settings());
    picture_file::check_size("merge", region, format)?;
    let Caption { title, looks, .. } = &merged.caption;
    let subject = Subject { title, settings, region, looks };
    let options = subject.write_options(&args.encoding, format, &render, None);
    let file = render.image.encode(format, &channels, &options)?;
    write_file(&args.output, &file)?;
    let mut listed = lists::of_settings(settings, region);
    listed.extend(lists::of_encoding(format, &options));
    report(args, &merged, &render, listed);
    Ok(ExitCode::SUCCESS)
}

/// Reads the parts one by one, so that only one is in memory besides the sums.
fn merge(args: &Args) -> Result<Merged, Failure> {
    let mut merge = Merge::new(args.partial);
    let mut caption: Option<Caption> = None;
    let mut pieces = Vec::new();
    for path in &args.parts {
        let (origin, part) = checkpoint::read(path)?;
        let name = path.display().to_string();
        merge.add(&name, &origin.scene, part)?;
        let mut known = origin.caption;
        pieces.push((known.tiles.clone(), std::mem::take(&mut known.features)));
        let first = caption.get_or_insert_with(|| known.clone());
        if first.layers != known.layers {
            let first = args.parts[0].display().to_string();
            return Err(Failure::Layers(name, first));
        }
    }
    let (whole, missing) = merge.finish()?;
    let caption = caption.ok_or(MergeError::Nothing)?;
    Ok(Merged { whole, caption, pieces, missing })
}

impl Merged {
    /// Channels of the layers of `--layers`, or else of the parts' layers, if the format supports them.
    fn channels(
        &self,
        args: &Args,
        format: Format,
        render: &Render,
    ) -> Result<Vec<Channel>, Failure> {
        let there = &self.caption.layers;
        let typed = &args.encoding.layers;
        let missing = typed.iter().flatten().find(|layer| !there.contains(layer));
        if let Some(layer) = missing {
            let message = format!(
                "the parts have no layer {}; render them with --layers {}",
                layer.name(),
                layer.name()
            );
            return Err(Failure::usage("merge", message));
        }
        if format != Format::Exr {
            return Ok(Vec::new());
        }
        let all = typed.is_empty() || typed.contains(&None);
        let wanted: Vec<Layer> =
            there.iter().copied().filter(|layer| all || typed.contains(&Some(*layer))).collect();
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        let mut layers = Layers::gather(self.whole.region(), &self.pieces);
        layers.statistics.clone_from(&render.statistics);
        if !self.knows_everything() && wanted.iter().any(|layer| !layer.is_statistic()) {
            output::warn("layers are empty in tiles of missing parts");
        }
        Ok(layers.channels(&wanted))
    }

    /// Returns whether the features of all pixels are known.
    fn knows_everything(&self) -> bool {
        let Region { width, height, .. } = self.whole.region();
        let known: usize = self.pieces.iter().map(|(_, features)| features.len()).sum();
        known as u64 == u64::from(width) * u64::from(height)
    }
}

fn report(args: &Args, merged: &Merged, render: &Render, settings: List) {
    let summary = Summary {
        program: "spherule",
        version: env!("CARGO_PKG_VERSION"),
        output: args.output.display().to_string(),
        parts: args.parts.len(),
        complete: render.complete,
        missing: merged.missing.iter().map(ImagePart::to_string).collect(),
        settings,
        samples: render.samples.total,
        rays: render.counters.rays(),
        render_seconds: render.elapsed.as_secs_f64(),
    };
    if args.json {
        output::print_json(&summary);
    } else if !args.quiet {
        output::print(format_args!(
            "{}: {} of {}\nrays    {} in {:.3} s of all parts together",
            summary.output,
            plural(summary.samples, "sample"),
            plural(summary.parts as u64, "part"),
            HumanCount(summary.rays),
            summary.render_seconds,
        ));
    }
    warnings(&render.counters, merged.whole.settings()).iter().for_each(output::warn);
    if merged.caption.drawn_over {
        output::warn(
            "--cell, --background transparent, depth cue and outlines need the scene, and are left out",
        );
    }
    for missing in &summary.missing {
        output::warn(format_args!("missing: no part has {missing}"));
    }
    if !render.complete {
        let (least, most) = (render.samples.least, render.samples.most);
        output::warn(format_args!(
            "{} is incomplete: {least} to {most} of {} samples per pixel",
            summary.output,
            merged.whole.settings().spp
        ));
    }
}
