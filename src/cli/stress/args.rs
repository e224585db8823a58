//! Arguments of `spherule stress`.

use crate::cli::options::names::regime;
use crate::cli::options::values::{RAYS, THREADS};
use clap::value_parser;
use spherule_measure::stress::Regime;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    /// Total number of rays in all regimes
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    #[arg(value_parser = value_parser!(u64).range(RAYS))]
    pub(super) rays: u64,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,
    /// Number of threads [default: as the CPU affinity mask and the cgroup's quota allow]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(THREADS))]
    pub(super) threads: Option<u16>,
    /// Regimes to test [default: all]
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = regime())]
    pub(super) regime: Vec<&'static Regime>,
    /// Print the report as one JSON object to standard output; infinite values are null
    #[arg(long)]
    pub(super) json: bool,
    /// Write the report as CSV, with a row for each regime and intersection test
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Write a plot of the wrong results: .png or .svg
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
    /// Print neither progress nor tables
    #[arg(short, long)]
    pub(super) quiet: bool,
}

pub(in crate::cli) const EXAMPLES: &str = "\
Each ray is also tested in exact integer arithmetic, without rounding. For one hit in 16, Spherule
must also answer correctly for nine maximum distances: the hit distance and values next to it,
down to the adjacent double-precision numbers. With all regimes, sticks, ellipsoids, cones and triangles are tested
too, beside a reference of 180 decimal places.

Exit codes: 0 Spherule made no error, 1 Spherule made at least one

Examples:
  spherule stress
  spherule stress --seed 7 --csv stress.csv --plot stress.png
  spherule stress --regime far_1e6 ground_1e7 --rays 1000000 --json";
