//! Arguments of `spherule field`.

use crate::cli::options::values::{self, Radii};
use clap::ValueEnum;
use std::path::PathBuf;

/// Examples at the end of `--help`.
pub(in crate::cli) const EXAMPLES: &str = "\
Examples:
  spherule field -o field.toml               the scene of `spherule render`
  spherule field --count 500 --mix 1,0,0 --seed 7 -o large.toml
  spherule field grid --count 50 --radius 0.3 -o grid.toml
  spherule field lattice --jitter 0.03 -o crystal.toml";

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    /// Kind of scene
    #[arg(value_enum, default_value_t = Kind::Field)]
    pub(super) kind: Kind,
    /// Output scene, a name that ends in .toml; the spheres are written to a .csv file of the same name
    #[arg(short, long, value_name = "FILE.toml")]
    pub(super) output: PathBuf,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,
    /// Print only errors
    #[arg(short, long)]
    pub(super) quiet: bool,
    #[command(flatten)]
    pub(super) parameters: ParameterArgs,
}

/// Kinds of generated scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Kind {
    /// N x N equal spheres on a plane
    Grid,
    /// N x N random spheres on a plane, as `spherule render` shows without a scene
    Field,
    /// N random spheres in a cube
    Volume,
    /// Face-centered cubic crystal of N x N x N cells of four spheres
    Lattice,
    /// Haines' sphereflake
    Sphereflake,
    /// Final scene of "Ray Tracing in One Weekend"
    Weekend,
}

/// Parameters of the generators; each applies to some of the kinds.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Parameters [default for each kind]")]
pub(super) struct ParameterArgs {
    /// grid, field: spheres along each side [20]; volume: spheres [10000]; lattice: cells along
    /// each edge [10]
    #[arg(long, value_name = "N")]
    pub(super) count: Option<u64>,
    /// grid [0.4], lattice, sphereflake [0.5]: radius of all spheres; field [0.1,0.45], volume: minimum and
    /// maximum radius
    #[arg(long, value_name = "R|MIN,MAX", allow_hyphen_values = true, value_parser = values::radii)]
    pub(super) radius: Option<Radii>,
    /// grid: distance between neighboring centers [1]
    #[arg(long, value_name = "DISTANCE", value_parser = values::finite)]
    pub(super) spacing: Option<f64>,
    /// field: fractions of diffuse, metal and glass spheres [0.68,0.2,0.12]
    #[arg(long, value_name = "D,M,G", allow_hyphen_values = true, value_parser = values::mix)]
    pub(super) mix: Option<[f64; 3]>,
    /// field [true], volume [false]: give each sphere its own color
    #[arg(long, value_name = "BOOL")]
    pub(super) colors: Option<bool>,
    /// volume: edge length of the cube [the cube root of N]
    #[arg(long, value_name = "LENGTH", value_parser = values::finite)]
    pub(super) size: Option<f64>,
    /// lattice: standard deviation of the thermal displacement, in nearest-neighbor distances [0]
    #[arg(long, value_name = "DEVIATION", value_parser = values::finite)]
    pub(super) jitter: Option<f64>,
    /// sphereflake: recursion depth [4]
    #[arg(long, value_name = "N")]
    pub(super) level: Option<u32>,
}
