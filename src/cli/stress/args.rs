//! The command as typed.

use crate::cli::names::regime;
use crate::cli::values::{RAYS, THREADS};
use clap::value_parser;
use spherule::stress::Regime;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    /// Rays, of all regimes together
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    #[arg(value_parser = value_parser!(u64).range(RAYS))]
    pub(super) rays: u64,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,
    /// Threads [default: what the affinity mask and the control group's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(super) threads: Option<u16>,
    /// Regimes [default: all]
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = regime())]
    pub(super) regime: Vec<&'static Regime>,
    /// The report as one JSON object on standard output; what is infinite is null
    #[arg(long)]
    pub(super) json: bool,
    /// The report as CSV: a row for each regime and form
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// A picture of the wrong decisions: .png or .svg
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
    /// No progress and no tables
    #[arg(short, long)]
    pub(super) quiet: bool,
}

pub(in crate::cli) const EXAMPLES: &str = "\
Every ray is decided again in whole numbers, without any rounding. Of one ray in 16 that hits, this
program is also asked whether anything is nearer than seven bounds at the distance and next to it,
down to the next number of double precision. Exit code 0 says that it was never wrong, 1 that it was.

Examples:
  spherule stress
  spherule stress --seed 7 --csv stress.csv --plot stress.png
  spherule stress --regime far_1e6 ground_1e7 --rays 1000000 --json";
