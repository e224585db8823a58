//! Memory that a render takes, before it takes it.

use super::job::Job;
use super::layers::{need_statistics, wanted};
use crate::cli::contents::spheres;
use crate::cli::failure::Failure;
use spherule::film::{Film, Region};
use spherule::image::Format;
use spherule::layers::{Layer, Layers};
use spherule::memory::{self, Shortage, Size};
use spherule::scene::{Look, Scene};
use spherule::world::Footprint;
use std::fmt;

/// Bytes that a thread writes while it renders tiles.
const WORKSPACE: u64 = 1 << 20;

/// Bytes of a pixel's codes, twice, and of the file that they become.
const CODES: u64 = 12;

/// Bytes of a pixel that drawing over a picture takes beside its layers.
const OVERLAY: u64 = 16;

/// The same where the background is transparent, with what is seen without the spheres.
const MATTE: u64 = 50;

/// Memory that a render takes at most, beside the scene's columns, which are there.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    region: Region,
    spheres: u64,
    /// Whether layers are part of the picture.
    layered: bool,
    /// Bytes while spheres become columns and a tree.
    build: u64,
    /// Bytes of the scene's columns, which are given back when the world is there.
    scene: u64,
    /// Bytes of the world.
    world: u64,
    /// Bytes of the sums and of the picture.
    film: u64,
    /// Bytes of the layers and of the file, whichever are more.
    output: u64,
    /// Bytes of all threads' own columns.
    threads: u64,
}

impl Estimate {
    /// Estimates what comes on top of a scene that is loaded.
    pub(super) fn new(scene: &Scene, region: Region, job: &Job) -> Self {
        let footprint = Footprint::of(scene);
        Self {
            region,
            spheres: footprint.spheres,
            layered: !job.encoding.layers.is_empty(),
            build: footprint.peak().saturating_sub(footprint.scene()),
            scene: footprint.scene(),
            world: footprint.resident(),
            film: Film::bytes(region, need_statistics(job)),
            output: output(job, &scene.look, region),
            threads: job.threads as u64 * WORKSPACE,
        }
    }

    /// The same of so many of the region's tiles.
    pub(super) fn of_tiles(self, tiles: usize) -> Self {
        let part = |bytes: u64| {
            let share = u128::from(bytes) * tiles as u128;
            (share / u128::from(Film::tile_count(self.region)).max(1)) as u64
        };
        Self { film: part(self.film), output: part(self.output), ..self }
    }

    /// Bytes on top of what is taken now.
    fn need(&self) -> u64 {
        let rendering = self.world.saturating_add(self.picture()).saturating_add(self.threads);
        self.build.max(rendering.saturating_sub(self.scene))
    }

    /// Bytes of all that grows with the picture's size.
    fn picture(&self) -> u64 {
        self.film.saturating_add(self.output)
    }

    /// Refuses a render that there is no memory for. Returns the bytes that the process has in memory at
    /// most, by this estimate.
    pub(super) fn check(self) -> Result<u64, Failure> {
        let need = self.need();
        memory::check(need).map_err(|shortage| Failure::Memory(self, shortage))?;
        Ok(memory::resident().saturating_add(need).max(memory::peak().unwrap_or(0)))
    }

    /// The whole story, for people.
    pub(crate) fn message(&self, shortage: &Shortage) -> String {
        let mend = if self.build > self.picture() {
            "render fewer spheres, or where there is more memory"
        } else {
            "give --size or --region smaller numbers"
        };
        format!("{self} need {shortage}; {mend}")
    }
}

/// Bytes of layers and of the encoded file: the more of both, for layers are dropped before the file is
/// made of their channels.
fn output(job: &Job, look: &Look, region: Region) -> u64 {
    let pixels = u64::from(region.width) * u64::from(region.height);
    let layers = wanted(&job.encoding.layers);
    let traced = layers.iter().any(|layer| !layer.is_statistic());
    let drawn = match (look.is_plain(), look.is_transparent()) {
        (true, _) => 0,
        (false, false) => OVERLAY,
        (false, true) => MATTE,
    };
    let gathered = if traced || drawn > 0 { Layers::bytes(region) + pixels * drawn } else { 0 };
    let channels: u64 = layers.iter().map(|layer| channels(*layer)).sum();
    let value = size_of::<f32>() as u64;
    let file = match job.format {
        // Columns of values, and the compressed file.
        Format::Exr => (3 + channels) * 2 * value,
        _ => CODES,
    };
    gathered.max(pixels * (file + channels * value))
}

/// Channels of a layer.
fn channels(layer: Layer) -> u64 {
    match layer {
        Layer::Albedo | Layer::Normal | Layer::Variance => 3,
        Layer::Depth | Layer::Coverage | Layer::Id | Layer::Samples => 1,
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Region { width, height, .. } = self.region;
        if self.spheres > 0 {
            write!(formatter, "{} ({}) and ", spheres(self.spheres), Size(self.build))?;
        }
        let layers = if self.layered { " with their layers" } else { "" };
        write!(formatter, "{width} x {height} pixels{layers} ({})", Size(self.picture()))
    }
}
