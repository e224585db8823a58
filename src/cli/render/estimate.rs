//! Estimates of the memory of a render.

use super::setup::RenderSetup;
use crate::cli::contents::spheres;
use crate::cli::failure::Failure;
use spherule_render::denoise::Denoiser;
use spherule_render::film::{Film, Region};
use spherule_render::image::Format;
use spherule_render::layers::Layers;
use spherule_render::memory::{self, Shortage, Size};
use spherule_render::scene::{Footprint, Look, Scene};
use std::fmt;

/// Bytes of a thread's working memory.
const WORKSPACE: u64 = 1 << 20;

/// Bytes per pixel of two copies of the 8-bit image and of its file.
const CODES: u64 = 12;

/// Bytes per pixel of overlays, without the layers.
const OVERLAY: u64 = 16;

/// Bytes per pixel of overlays with a transparent background, including the image of the ground without
/// spheres.
const MATTE: u64 = 64;

/// Estimated peak memory of a render, without the scene's columns, which are loaded already.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    region: Region,
    spheres: u64,
    /// True if layers are part of the image.
    layered: bool,
    /// True if the image is denoised.
    denoised: bool,
    /// Bytes during the construction of columns and tree.
    build: u64,
    /// Bytes of the scene's columns, which are freed once the world is built.
    scene: u64,
    /// Bytes of the world.
    world: u64,
    /// Bytes of the sample sums and of the image.
    film: u64,
    /// Bytes of the layers or of the file, whichever is more.
    output: u64,
    /// Bytes of the working memory of all threads.
    threads: u64,
}

impl Estimate {
    /// Estimates the memory needed in addition to a loaded scene.
    pub(super) fn new(scene: &Scene, region: Region, setup: &RenderSetup, denoised: bool) -> Self {
        let footprint = Footprint::of(scene);
        Self {
            region,
            spheres: footprint.spheres,
            layered: !setup.encoding.layers.is_empty(),
            denoised,
            build: footprint.peak().saturating_sub(footprint.scene()),
            scene: footprint.scene(),
            world: footprint.resident(),
            film: Film::bytes(region, setup.encoding.needs_statistics() || denoised),
            output: output(setup, &scene.look, region).max(if denoised {
                Denoiser::bytes(region)
            } else {
                0
            }),
            threads: setup.threads as u64 * WORKSPACE,
        }
    }

    /// Scales the estimate to a number of the region's tiles.
    pub(super) fn of_tiles(self, tiles: usize) -> Self {
        let part = |bytes: u64| {
            let portion = u128::from(bytes) * tiles as u128;
            (portion / u128::from(Film::tile_count(self.region)).max(1)) as u64
        };
        Self { film: part(self.film), output: part(self.output), ..self }
    }

    /// Bytes needed in addition to the current use.
    fn need(&self) -> u64 {
        let rendering = self.world.saturating_add(self.picture()).saturating_add(self.threads);
        self.build.max(rendering.saturating_sub(self.scene))
    }

    /// Bytes that depend on the size of the image.
    fn picture(&self) -> u64 {
        self.film.saturating_add(self.output)
    }

    /// Returns an error if memory is insufficient, and else the estimated peak memory of the process in
    /// bytes.
    pub(super) fn check(self) -> Result<u64, Failure> {
        let need = self.need();
        memory::check(need).map_err(|shortage| Failure::Memory(self.message(&shortage)))?;
        Ok(memory::resident().saturating_add(need).max(memory::peak().unwrap_or(0)))
    }

    /// Formats the error message.
    fn message(&self, shortage: &Shortage) -> String {
        let hint = if self.build > self.picture() {
            "render fewer spheres, or use a machine with more memory"
        } else if self.denoised {
            "use a smaller --size or --region, or --denoise off"
        } else {
            "use a smaller --size or --region"
        };
        format!("{self} need {shortage}; {hint}")
    }
}

/// Bytes of the layers or of the encoded file, whichever is more, because layers are dropped before the file
/// is encoded from their channels.
fn output(setup: &RenderSetup, look: &Look, region: Region) -> u64 {
    let pixels = u64::from(region.width) * u64::from(region.height);
    let layers = setup.encoding.wanted_layers();
    let traced = layers.iter().any(|layer| !layer.is_statistic());
    let drawn = match (look.is_plain(), look.is_transparent()) {
        (true, _) => 0,
        (false, false) => OVERLAY,
        (false, true) => MATTE,
    };
    let gathered = if traced || drawn > 0 { Layers::bytes(region) + pixels * drawn } else { 0 };
    let channels: u64 = layers.iter().map(|layer| layer.channel_count() as u64).sum();
    let value = size_of::<f32>() as u64;
    let file = match setup.format {
        // Channels, and the compressed file.
        Format::Exr => (3 + channels) * 2 * value,
        _ => CODES,
    };
    gathered.max(pixels * (file + channels * value))
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
