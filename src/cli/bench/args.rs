//! The command as typed.

use crate::cli::values::THREADS;
use clap::{Subcommand, value_parser};
use spherule::bench::{Effort, Options};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    #[command(subcommand)]
    pub(super) measurement: Measurement,
}

/// What is measured.
#[derive(Debug, Subcommand)]
pub(super) enum Measurement {
    /// Building trees: time, memory and quality of each builder
    #[command(after_help = BUILD)]
    Build(Common),
    /// All of these, on one page: report.html
    #[command(after_help = EVERYTHING)]
    All(Common),
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

impl Common {
    /// What is asked of a measurement.
    pub(super) fn options(&self) -> Options {
        let effort = match (self.quick, self.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Usual,
        };
        let rounds = if self.quick { self.rounds.min(2) } else { self.rounds };
        Options { scenes: self.scenes.clone(), rounds, effort }
    }
}

pub(in crate::cli) const EXAMPLES: &str = "\
Each measurement prints tables and writes them to a folder, as CSV and JSON, with plots as SVG and
PNG, and a page with everything. Contestants run by turns; medians are reported, with the least and
the greatest. Results are compared: a difference is an error.

Examples:
  spherule bench all
  spherule bench build --scenes layer250k volume1m --rounds 9 --output measured";

const BUILD: &str = "\
Examples:
  spherule bench build
  spherule bench build --scenes layer250k volume1m --threads 1";

const EVERYTHING: &str = "\
Examples:
  spherule bench all
  spherule bench all --rounds 9 --output measured";
