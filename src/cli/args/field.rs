//! What is said of scenes that are generated.

use crate::cli::values::{self, Radii};
use clap::ValueEnum;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct FieldArgs {
    /// What to generate
    #[arg(value_enum, default_value_t = Kind::Field)]
    pub(in crate::cli) kind: Kind,
    /// The scene: a name that ends in .toml; the spheres go to a .csv file of the same name
    #[arg(short, long, value_name = "FILE.toml")]
    pub(in crate::cli) output: PathBuf,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(in crate::cli) seed: u64,
    /// Nothing but errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
    #[command(flatten)]
    pub(in crate::cli) parameters: ParameterArgs,
}

/// Kinds of generated scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Kind {
    /// N x N equal spheres on a plane
    Grid,
    /// N x N random spheres on a plane: what `spherule render` shows when it is given no scene
    Field,
    /// N random spheres in a cube
    Volume,
    /// A crystal, face-centered cubic, of N x N x N cells of four spheres
    Lattice,
    /// Haines' sphereflake
    Sphereflake,
    /// The last scene of "Ray Tracing in One Weekend"
    Weekend,
}

/// Parameters of the generators; each belongs to some of the kinds.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Parameters; without them, the kind's own")]
pub(in crate::cli) struct ParameterArgs {
    /// grid, field: spheres along each side [20]; volume: spheres [10000]; lattice: cells along
    /// each edge [10]
    #[arg(long, value_name = "N")]
    pub(in crate::cli) count: Option<u64>,
    /// grid [0.4], lattice, sphereflake [0.5]: one radius; field [0.1,0.45], volume: least and
    /// greatest
    #[arg(long, value_name = "R|MIN,MAX", allow_hyphen_values = true, value_parser = values::radii)]
    pub(in crate::cli) radius: Option<Radii>,
    /// grid: distance between neighboring centers [1]
    #[arg(long, value_name = "DISTANCE", value_parser = values::finite)]
    pub(in crate::cli) spacing: Option<f64>,
    /// field: shares of diffuse, metal and glass spheres [0.68,0.2,0.12]
    #[arg(long, value_name = "D,M,G", allow_hyphen_values = true, value_parser = values::mix)]
    pub(in crate::cli) mix: Option<[f64; 3]>,
    /// field [true], volume [false]: whether each sphere has its own color
    #[arg(long, value_name = "BOOL")]
    pub(in crate::cli) colors: Option<bool>,
    /// volume: edge of the cube [the cube root of N]
    #[arg(long, value_name = "LENGTH", value_parser = values::finite)]
    pub(in crate::cli) size: Option<f64>,
    /// lattice: thermal displacement, in distances between neighbors [0]
    #[arg(long, value_name = "DEVIATION", value_parser = values::finite)]
    pub(in crate::cli) jitter: Option<f64>,
    /// sphereflake: generations of children [4]
    #[arg(long, value_name = "N")]
    pub(in crate::cli) level: Option<u32>,
}
