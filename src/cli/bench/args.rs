//! The command as typed.

use crate::cli::threads;
use crate::cli::values::{SAMPLES, THREADS};
use clap::{Subcommand, value_parser};
use spherule::bench::paper::Scale;
use spherule::bench::{Effort, Options};
use spherule::scene::included_files;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    #[command(subcommand)]
    pub(super) measurement: Measurement,
}

/// What is measured.
#[derive(Debug, Subcommand)]
pub(super) enum Measurement {
    /// Finding what rays hit: every walk, for four classes of rays
    #[command(after_help = TRAVERSAL)]
    Traversal(Common),
    /// What more threads bring, and what one generator of random numbers for all of them costs
    #[command(after_help = THREADS_EXAMPLES)]
    Threads(ThreadsArgs),
    /// Building trees: time, memory and quality of each builder
    #[command(after_help = BUILD)]
    Build(Common),
    /// What is saved by leaving out what a scene does not need
    #[command(after_help = SKIPS)]
    Skips(Common),
    /// Error against time and samples, for sets of settings
    #[command(after_help = ERROR)]
    Error(Common),
    /// The paper's tables and its figure 3, its tracer beside this program
    #[command(after_help = PAPER)]
    Paper(PaperArgs),
    /// Russian roulette: error against time for each probability, in the paper's tracer and here
    #[command(after_help = ROULETTE)]
    Roulette(Common),
    /// All of these, on one page: report.html
    #[command(after_help = EVERYTHING)]
    All(Common),
}

#[derive(Debug, clap::Args)]
pub(super) struct ThreadsArgs {
    /// Compare 1 to N threads [default: as --threads]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=256))]
    threads_up_to: Option<u16>,
    #[command(flatten)]
    pub(super) common: Common,
}

impl ThreadsArgs {
    /// What is asked of the measurement.
    pub(super) fn options(&self) -> Options {
        let usual = self.common.options();
        let threads = self.threads_up_to.map_or(usual.threads, usize::from);
        Options { threads, ..usual }
    }
}

/// What all measurements take.
#[derive(Debug, clap::Args)]
pub(super) struct Common {
    /// Scenes [default: the measurement's own]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    scenes: Vec<String>,
    /// How often each contestant has its turn
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = value_parser!(u32).range(1..=1000))]
    rounds: u32,
    /// Threads [default: what the affinity mask and the control group's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(super) threads: Option<u16>,
    /// The folder for CSV, JSON, SVG, PNG and HTML; it is made if it is not there
    #[arg(short, long, value_name = "FOLDER", default_value = "bench")]
    pub(super) output: PathBuf,
    /// A second instead of a minute: only whether it runs
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Everything, for as long as it takes
    #[arg(long)]
    full: bool,
    /// Nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct PaperArgs {
    #[command(flatten)]
    pub(super) common: Common,
    /// Pixels along each side; the paper has 512 [default: 64, --full: 512]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(8..=4096))]
    size: Option<u32>,
    /// Samples in each pixel; the paper has 16 [default: 4, --full: 16]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SAMPLES))]
    spp: Option<u32>,
}

impl PaperArgs {
    /// What is asked of the measurement.
    pub(super) fn options(&self) -> Options {
        let scale = Scale { size: self.size, spp: self.spp };
        Options { scale, ..self.common.options() }
    }
}

impl Common {
    /// Whether scenes are named.
    pub(super) fn has_scenes(&self) -> bool {
        !self.scenes.is_empty()
    }

    /// Files that the scenes read.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.scenes.iter().flat_map(|scene| included_files(Path::new(scene))).collect()
    }

    /// What is asked of a measurement.
    pub(super) fn options(&self) -> Options {
        let effort = match (self.quick, self.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Usual,
        };
        let rounds = if self.quick { self.rounds.min(2) } else { self.rounds };
        let threads = threads::count(self.threads);
        let references = Some(self.output.join("references"));
        let scale = Scale::default();
        Options { scenes: self.scenes.clone(), rounds, threads, references, effort, scale }
    }
}

pub(in crate::cli) const EXAMPLES: &str = "\
Each measurement prints tables and writes them to a folder, as CSV and JSON, with plots as SVG and
PNG, and a page with everything. Contestants run by turns; medians are reported, with the least and
the greatest. Results are compared: a difference is an error.

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
The picture is the same to the byte with each saving and without it. Converged tiles alone are
compared otherwise: a picture that ends at an error, and gives samples to the tiles where they help
most, with one that has as many samples of every pixel and the same error.

Examples:
  spherule bench skips
  spherule bench skips --rounds 15 --scenes veach my-scene.toml";

const ERROR: &str = "\
Compared are, by error against time, samples and rays:
  in each scene            samplers, roulette, single rays, and samples where they help (adaptive)
  where there are lights   choices among them: by the tree, by power, all alike (-lights)
  where paths scatter once path tracing and whitted with 1 to 16 shadow samples (-direct)
  without --scenes, too    those and ambient occlusion on chalk under a white sky (-sky)
All of a group lead to the same picture. References are kept in the folder `references` of the output:
the next run with the same scene, settings and renderer takes them from there.

Examples:
  spherule bench error
  spherule bench error --scenes veach my-scene.toml --rounds 3
  spherule bench error --full";

const PAPER: &str = "\
The paper's scenes at its own scale, without a tree, take minutes for each render: --full measures
that. Otherwise pictures are smaller, which the report says, and times at full scale extrapolated
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

const EVERYTHING: &str = "\
Examples:
  spherule bench all
  spherule bench all --rounds 9 --output measured";
