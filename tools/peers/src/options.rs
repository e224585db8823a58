//! The command line.

use crate::embree::{Build, Device, EmbreeError};
use crate::levels::Program;
use crate::rays::{Class, Order};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, ValueEnum};
use spherule_measure::workload::SphereScene;
use std::path::PathBuf;

/// The scenes that are compared when nobody says which.
const USUAL: [&str; 7] =
    ["paper400", "volume10k", "volume1m", "volume10m", "layer250k", "fcc1m", "lognormal1m"];

/// Measures Embree beside Spherule: the same rays, one run, one thread.
#[derive(Debug, Parser)]
#[command(version, about)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
pub struct Options {
    /// Embree's library, 4.4 or later 4.x: `libembree4.so` or the like.
    #[arg(long, value_name = "FILE")]
    pub embree: PathBuf,

    /// Scenes, separated by commas.
    #[arg(long, value_delimiter = ',', default_values = USUAL, value_parser = scene)]
    pub scenes: Vec<SphereScene>,

    /// Spheres of a file in place of scenes: an NPY array of x, y, z and radius, raw numbers of single precision (.raw), or a
    /// particle file with radii.
    #[arg(
        long,
        value_name = "FILE",
        requires = "rays",
        conflicts_with_all = ["scenes", "classes", "side", "orders", "level"]
    )]
    pub spheres: Option<PathBuf>,

    /// Rays of a file: an NPY array of origin x, y, z and direction x, y, z; after these `t_max`, or `t_min` and
    /// `t_max`.
    #[arg(long, value_name = "FILE", requires = "spheres")]
    pub rays: Option<PathBuf>,

    /// The query for the rays of a file: the closest hit, or any hit.
    #[arg(
        long,
        requires = "rays",
        default_value = "closest",
        value_parser = PossibleValuesParser::new(["closest", "any"]).map(|text| query(&text))
    )]
    pub query: Class,

    /// Classes of rays, separated by commas; all by default.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Class::value_variants().to_vec())]
    pub classes: Vec<Class>,

    /// Rays in each of Embree's calls, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "1,4,8,16", value_parser = width)]
    pub calls: Vec<usize>,

    /// Pixels along the side of the picture, made a multiple of 4.
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub side: u32,

    /// Orders of all rays, separated by commas; the same for both systems.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Order::Blocks, Order::Random])]
    pub orders: Vec<Order>,

    /// Does not ask Spherule for points and normals, which Embree always computes.
    #[arg(long)]
    pub hits_only: bool,

    /// Rounds in which all that are compared run once, by turns; medians count.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub rounds: u32,

    /// How many of Embree's calls, the fastest of a first heat, run in the rounds.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    pub finalists: u32,

    /// Embree's configuration, but for threads; may be given several times, and the fastest counts.
    #[arg(
        long,
        value_name = "TEXT",
        default_values = ["frequency_level=simd256", "frequency_level=simd512"]
    )]
    pub configuration: Vec<String>,

    /// Embree's build quality: 0 low, 1 medium, 2 high.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..=2))]
    pub quality: u32,

    /// Lets Embree test boxes so that rounding loses nothing.
    #[arg(long)]
    pub robust: bool,

    /// This program compiled for another processor level, as v3=FILE; may be given several times. Each runs in
    /// the rounds too, and must find the same hits.
    #[arg(long, value_name = "LEVEL=FILE")]
    pub level: Vec<Program>,

    /// Measures for another process of this program.
    #[arg(long, hide = true)]
    pub serve: bool,

    /// Does not measure builds.
    #[arg(long)]
    pub no_builds: bool,

    /// Writes everything measured to a file.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

impl Options {
    /// How Embree builds.
    pub fn build(&self) -> Build {
        Build { robust: self.robust, quality: self.quality }
    }

    /// Starts Embree with a configuration and so many threads.
    ///
    /// # Errors
    /// As [`Device::new`].
    pub fn device(&self, configuration: &str, threads: usize) -> Result<Device, EmbreeError> {
        Device::new(&self.embree, &format!("threads={threads},{configuration}"))
    }
}

fn scene(text: &str) -> Result<SphereScene, String> {
    let names = || SphereScene::ALL.map(|scene| scene.name).join(", ");
    SphereScene::named(text)
        .ok_or_else(|| format!("there is no such scene; give some of {}", names()))
}

fn query(text: &str) -> Class {
    if text == "any" { Class::Any } else { Class::Closest }
}

fn width(text: &str) -> Result<usize, String> {
    match text {
        "1" => Ok(1),
        "4" => Ok(4),
        "8" => Ok(8),
        "16" => Ok(16),
        _ => Err("Embree takes 1, 4, 8 or 16 rays at a time".to_owned()),
    }
}
