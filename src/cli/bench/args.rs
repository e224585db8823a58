//! Arguments of `spherule bench`.

use crate::cli::options::values::{SAMPLES, THREADS};
use crate::cli::threads;
use clap::{Subcommand, value_parser};
use spherule_measure::bench::paper::Scale;
use spherule_measure::bench::{Effort, Options};
use spherule_render::scene::included_files;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    #[command(subcommand)]
    pub(super) measurement: Measurement,
}

/// Benchmarks.
#[derive(Debug, Subcommand)]
pub(super) enum Measurement {
    /// Ray traversal: every algorithm, for four classes of rays
    #[command(after_help = TRAVERSAL)]
    Traversal(Common),
    /// Scaling with threads, and the cost of a shared random number generator
    #[command(after_help = THREADS_EXAMPLES)]
    Threads(ThreadsArgs),
    /// BVH construction: time, memory and quality of each builder
    #[command(after_help = BUILD)]
    Build(Common),
    /// Time saved by skipping work that a scene does not need
    #[command(after_help = SKIPS)]
    Skips(Common),
    /// Error over time and samples, for sets of settings
    #[command(after_help = ERROR)]
    Error(Common),
    /// Tables and figure 3 of the paper, with its ray tracer next to this program
    #[command(after_help = PAPER)]
    Paper(PaperArgs),
    /// Russian roulette: error over time for each probability, in the paper's ray tracer and here
    #[command(after_help = ROULETTE)]
    Roulette(Common),
    /// A GPU: rays per second, shares of stages and time to error, beside the processor; not part of `all`
    #[command(after_help = GPU)]
    Gpu(Common),
    /// All of these but `gpu`, in one page: report.html
    #[command(after_help = EVERYTHING)]
    All(Common),
}

#[derive(Debug, clap::Args)]
pub(super) struct ThreadsArgs {
    /// Measure with 1 to N threads [default: as --threads]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=256))]
    threads_up_to: Option<u16>,
    #[command(flatten)]
    pub(super) common: Common,
}

impl ThreadsArgs {
    /// Options for the benchmark.
    pub(super) fn options(&self) -> Options {
        let default = self.common.options();
        let threads = self.threads_up_to.map_or(default.threads, usize::from);
        Options { threads, ..default }
    }
}

/// Arguments of all benchmarks.
#[derive(Debug, clap::Args)]
pub(super) struct Common {
    /// Scenes [default: those of the benchmark]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    scenes: Vec<String>,
    /// Number of runs of each candidate [default: 5, with --quick: 2]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000))]
    rounds: Option<u32>,
    /// Number of threads [default: as the CPU affinity mask and the cgroup's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(super) threads: Option<u16>,
    /// Output folder for CSV, JSON, SVG, PNG and HTML files; created if it does not exist
    #[arg(short, long, value_name = "FOLDER", default_value = "bench")]
    pub(super) output: PathBuf,
    /// Run for a second instead of a minute, only to check that the benchmark works
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Run at full scale, without a time limit
    #[arg(long)]
    full: bool,
    /// Print only errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct PaperArgs {
    #[command(flatten)]
    pub(super) common: Common,
    /// Image width and height in pixels; the paper has 512 [default: 64, with --full: 512]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(8..=4096))]
    size: Option<u32>,
    /// Samples per pixel; the paper has 16 [default: 4, with --full: 16]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    spp: Option<u32>,
}

impl PaperArgs {
    /// Options for the benchmark.
    pub(super) fn options(&self) -> Options {
        let scale = Scale { size: self.size, spp: self.spp };
        Options { scale, ..self.common.options() }
    }
}

impl Common {
    /// Returns whether scenes were given.
    pub(super) fn has_scenes(&self) -> bool {
        !self.scenes.is_empty()
    }

    /// Files that the scenes include.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.scenes.iter().flat_map(|scene| included_files(Path::new(scene))).collect()
    }

    /// Options for a benchmark.
    pub(super) fn options(&self) -> Options {
        let effort = match (self.quick, self.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Usual,
        };
        let rounds = self.rounds.unwrap_or(if self.quick { 2 } else { 5 });
        let threads = threads::count(self.threads);
        let references = Some(self.output.join("references"));
        let scale = Scale::default();
        Options { scenes: self.scenes.clone(), rounds, threads, references, effort, scale }
    }
}

pub(in crate::cli) const EXAMPLES: &str = "\
Each benchmark prints tables and writes them to a folder as CSV and JSON, with plots as SVG and PNG,
and an HTML page with everything. Candidates run in turns; the report gives the median, the minimum
and the maximum. Results are compared: a difference is an error.

Examples:
  spherule bench all
  spherule bench build --scenes layer250k volume1m --rounds 9 --output measured";

const TRAVERSAL: &str = "\
Examples:
  spherule bench traversal
  spherule bench traversal --scenes fcc1m volume10m
  spherule bench traversal --full --rounds 9";

const THREADS_EXAMPLES: &str = "\
Examples:
  spherule bench threads
  spherule bench threads --threads-up-to 16 --scenes smallpt my-scene.toml";

const BUILD: &str = "\
Examples:
  spherule bench build
  spherule bench build --scenes layer250k volume1m --threads 1";

const SKIPS: &str = "\
The image is the same, byte for byte, whether work is skipped or not. The exception is adaptive
sampling: a render that stops at an error and samples tiles where it helps most is compared with a
render of the same error that takes equally many samples of every pixel.

Examples:
  spherule bench skips
  spherule bench skips --rounds 15 --scenes veach my-scene.toml";

const ERROR: &str = "\
Error is measured against time, samples and rays for these groups of settings:
  every scene               samplers, Russian roulette, single rays, adaptive sampling
  scenes with lights        light selection: tree, power, uniform (-lights)
  scenes with one bounce    path tracing, and whitted with 1 to 16 shadow samples (-direct)
  also without --scenes     these, and ambient occlusion on chalk under a white sky (-sky)
The settings of a group converge to the same image. Reference images are stored in the output's folder
`references`; later runs with the same scene, settings and renderer use them again.

Examples:
  spherule bench error
  spherule bench error --scenes veach my-scene.toml --rounds 3
  spherule bench error --full";

const PAPER: &str = "\
At the paper's scale, without an acceleration structure, each render takes minutes: --full measures
that. Otherwise images are smaller, as the report states, and times at full scale are extrapolated
where they were measured to be linear.

Examples:
  spherule bench paper
  spherule bench paper --size 256 --spp 1 --rounds 3
  spherule bench paper --full --rounds 1";

const ROULETTE: &str = "\
Scenes: two-spheres, grid, field.

Examples:
  spherule bench roulette
  spherule bench roulette --scenes two-spheres field --rounds 9";

const GPU: &str = "\
The report names the adapter, and says if it is software. A GPU needs many rays: --full takes a
million of each class, and ten million spheres.

Examples:
  spherule bench gpu --full
  spherule bench gpu --scenes volume1m --rounds 9";

const EVERYTHING: &str = "\
Examples:
  spherule bench all
  spherule bench all --rounds 9 --output measured";

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Own {
        #[command(flatten)]
        common: Common,
    }

    #[test]
    fn the_number_of_rounds_that_is_given_counts() {
        for (arguments, expected) in [
            (&["bench"][..], 5),
            (&["bench", "--quick"], 2),
            (&["bench", "--quick", "--rounds", "3"], 3),
            (&["bench", "--full", "--rounds", "1"], 1),
        ] {
            assert_eq!(Own::parse_from(arguments).common.options().rounds, expected);
        }
    }
}
