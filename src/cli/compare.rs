//! `spherule compare`: measures the difference between an image and a reference.

use super::failure::Failure;
use super::files::Files;
use super::options::image::read_help;
use super::output;
use indicatif::HumanCount;
use serde::Serialize;
use spherule_render::image::{Comparison, Image, compare};
use std::borrow::Cow;
use std::path::PathBuf;
use std::process::ExitCode;

/// Examples at the end of `--help`.
pub(super) const EXAMPLES: &str = "\
Differences are in linear radiance. Exit code 0 means that the images could be compared, not that they
are equal.

Examples:
  spherule compare picture.exr reference.exr
  spherule compare a.png b.png --json";

/// Arguments of `spherule compare`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[arg(value_name = "A", help = read_help())]
    picture: PathBuf,
    /// Reference image
    #[arg(value_name = "B")]
    reference: PathBuf,
    /// Print one JSON object to standard output; infinite values are null
    #[arg(long)]
    json: bool,
}

/// A comparison, with the names and size of the images.
#[derive(Serialize)]
struct Report<'a> {
    picture: Cow<'a, str>,
    reference: Cow<'a, str>,
    width: u32,
    height: u32,
    #[serde(flatten)]
    comparison: Comparison,
}

/// Compares the images and prints the result.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let mut files = Files::new("compare");
    files.reads("the image", &args.picture);
    files.reads("the reference", &args.reference);
    files.check()?;
    let picture = Image::read(&args.picture)?;
    let reference = Image::read(&args.reference)?;
    let report = Report {
        picture: args.picture.to_string_lossy(),
        reference: args.reference.to_string_lossy(),
        width: picture.width,
        height: picture.height,
        comparison: compare(&picture, &reference)?,
    };
    if args.json {
        output::print_json(&report);
    } else {
        print(&report);
    }
    Ok(ExitCode::SUCCESS)
}

fn print(report: &Report) {
    let comparison = &report.comparison;
    let most = &comparison.max_difference;
    let channel = ["red", "green", "blue"][usize::from(most.channel) % 3];
    output::print(format_args!(
        "RMSE                {:.6e}\n\
         relative MSE        {:.6e}\n\
         PSNR                {:.2} dB\n\
         maximal difference  {:.6e} ({channel} of pixel {}, {})\n\
         bias                {:+.6e} +- {:.1e}\n\
         differing pixels    {} of {}",
        comparison.rmse,
        comparison.relative_mse,
        comparison.psnr,
        most.value,
        most.x,
        most.y,
        comparison.bias,
        comparison.bias_standard_error,
        HumanCount(comparison.differing_pixels),
        HumanCount(comparison.pixels),
    ));
    if comparison.non_finite > 0 {
        output::warn(format_args!(
            "{} values are NaN or infinite in at least one image; they are left out of all statistics",
            HumanCount(comparison.non_finite)
        ));
    }
}
