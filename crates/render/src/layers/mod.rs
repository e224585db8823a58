//! Layers (AOVs): auxiliary channels of each pixel for denoisers and compositors.
//!
//! They are computed by a separate pass of camera rays, so that all integrators have them, and a render
//! without layers costs nothing. The rays are the image's: the same samples of the same filter
//! through the same lens, so that edges and blur are at the same positions.

mod progressive;
mod sums;

pub use self::progressive::ProgressiveLayers;
use self::progressive::TileLayers;
pub use crate::film::{Features, GROUND_PLANE, NOTHING, SAMPLES};
use crate::film::{Film, Region};
use crate::image::{Channel, Values};
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use crate::render::{self, Options, RenderError, Statistics};
use crate::scene::Settings;
use crate::world::World;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::mem::take;
use std::ops::Range;

/// A layer: an auxiliary channel of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Layer {
    /// [`Features::albedo`]: channels `albedo.R`, `albedo.G`, `albedo.B`.
    Albedo,
    /// [`Features::normal`]: channels `normal.X`, `normal.Y`, `normal.Z`.
    Normal,
    /// [`Features::depth`]: channel `depth.Z`.
    Depth,
    /// [`Features::coverage`]: channel `coverage.Y`.
    Coverage,
    /// [`Features::id`]: channel `id.Y`, of integers.
    Id,
    /// [`Statistics::variance`], which the render measures: channels `variance.R`, `variance.G`,
    /// `variance.B`.
    Variance,
    /// [`Statistics::samples`], which the render counts: channel `samples.Y`, of integers.
    Samples,
}

/// The layers of an image, or of a region of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Features, row by row from the top left.
    pub pixels: Vec<Features>,
    /// Statistics of the same pixels from the render; [`layers`] leaves them empty.
    pub statistics: Option<Statistics>,
}

impl Layer {
    /// All layers.
    pub const ALL: [Self; 7] = [
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Coverage,
        Self::Id,
        Self::Variance,
        Self::Samples,
    ];

    /// Returns the number of channels.
    pub fn channel_count(self) -> usize {
        match self {
            Self::Albedo | Self::Normal | Self::Variance => 3,
            Self::Depth | Self::Coverage | Self::Id | Self::Samples => 1,
        }
    }

    /// Returns the name before the dot in its channels' names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::Coverage => "coverage",
            Self::Id => "id",
            Self::Variance => "variance",
            Self::Samples => "samples",
        }
    }

    /// Returns whether the render computes it: see [`Options::statistics`].
    pub fn is_statistic(self) -> bool {
        matches!(self, Self::Variance | Self::Samples)
    }

    fn channels(self, layers: &Layers) -> Vec<Channel> {
        let channel = |part, values| Channel { name: format!("{}.{part}", self.name()), values };
        let pixels = &layers.pixels;
        let floats = |part, value: &dyn Fn(&Features) -> f32| {
            channel(part, Values::Floats(pixels.iter().map(value).collect()))
        };
        let statistics = layers.statistics.iter();
        match self {
            Self::Albedo => [('R', 0), ('G', 1), ('B', 2)]
                .map(|(part, i)| floats(part, &|pixel| pixel.albedo[i]))
                .into(),
            Self::Normal => [('X', 0), ('Y', 1), ('Z', 2)]
                .map(|(part, i)| floats(part, &|pixel| pixel.normal[i]))
                .into(),
            Self::Depth => vec![floats('Z', &|pixel| pixel.depth)],
            Self::Coverage => vec![floats('Y', &|pixel| pixel.coverage)],
            Self::Id => {
                let ids = pixels.iter().map(|pixel| pixel.id).collect();
                vec![channel('Y', Values::Integers(ids))]
            }
            Self::Variance => statistics
                .flat_map(|statistics| {
                    [('R', 0), ('G', 1), ('B', 2)].map(|part| (statistics, part))
                })
                .map(|(statistics, (part, i))| {
                    let variance = statistics.variance.pixels.iter().map(|pixel| pixel[i]);
                    channel(part, Values::Floats(variance.collect()))
                })
                .collect(),
            Self::Samples => statistics
                .map(|statistics| channel('Y', Values::Integers(statistics.samples.clone())))
                .collect(),
        }
    }
}

impl Layers {
    /// Gathers the layers of a region from ranges of tiles, with features as [`features`] returns them;
    /// missing tiles have no features.
    pub fn gather(region: Region, pieces: &[(Range<u32>, Vec<Features>)]) -> Self {
        let Region { x: left, y: top, width, height } = region;
        let mut pixels = vec![Features::NONE; width as usize * height as usize];
        for (tiles, features) in pieces {
            let tiles = Film::tile_regions(region).skip(tiles.start as usize).take(tiles.len());
            let positions = tiles.flat_map(Region::morton);
            for ((x, y), &features) in positions.zip(features) {
                pixels[(y - top) as usize * width as usize + (x - left) as usize] = features;
            }
        }
        Self { width, height, pixels, statistics: None }
    }

    /// Returns the bytes of the features of a region.
    pub fn bytes(region: Region) -> u64 {
        region.area() * size_of::<Features>() as u64
    }

    /// Returns the channels of some layers, for [`Image::write_layers`](crate::Image::write_layers);
    /// none for layers that need missing statistics.
    pub fn channels(&self, layers: &[Layer]) -> Vec<Channel> {
        layers.iter().flat_map(|layer| layer.channels(self)).collect()
    }
}

/// Computes the layers of an image, with as many samples as the image but at most [`SAMPLES`].
///
/// Only the region, the tracer and the flag of `options` are used: once it is set, no pixels are returned. Like the
/// image's, pixels have the same bytes
/// for any number of threads and any tracer, in a region and in the whole. If `wanted` has only
/// [`Layer::Id`] and statistics, one ray per pixel is traced, and only the ids are valid.
///
/// # Errors
/// Those of [`render()`](crate::render::render()).
pub fn layers(
    world: &World,
    settings: &Settings,
    options: &Options,
    wanted: &[Layer],
) -> Result<Layers, RenderError> {
    let region = render::check(world, settings, options)?;
    let Region { width, height, .. } = region;
    // Zeros are memory that is not there before a thread writes to it.
    let mut pixels = bytemuck::zeroed_vec::<Features>(region.area() as usize);
    let tiles = Film::tile_regions(region).zip(Film::tile_rows(region, &mut pixels)).collect();
    trace(world, settings, options, wanted, tiles, |region, rows, features| {
        for ((x, y), features) in region.morton().zip(features) {
            rows[(y - region.y) as usize][(x - region.x) as usize] = features;
        }
    });
    if options.is_cancelled() {
        pixels = Vec::new();
    }
    Ok(Layers { width, height, pixels, statistics: None })
}

/// Computes the features of some tiles of the region, by their numbers: tile by tile, in the order of
/// [`Tile::pixels`](crate::film::Tile::pixels). Tiles that are not begun when the options' flag is set have zeros.
///
/// # Errors
/// Those of [`render()`](crate::render::render()).
pub fn features(
    world: &World,
    settings: &Settings,
    options: &Options,
    wanted: &[Layer],
    tiles: Range<u32>,
) -> Result<Vec<Features>, RenderError> {
    let region = render::check(world, settings, options)?;
    let regions = Film::tile_regions(region).skip(tiles.start as usize).take(tiles.len());
    let regions: Vec<Region> = regions.collect();
    let count: u64 = regions.iter().map(|region| region.area()).sum();
    let mut pixels = bytemuck::zeroed_vec::<Features>(count as usize);
    let mut rest = pixels.as_mut_slice();
    let of_tile = |region: Region| {
        let (tile, others) = take(&mut rest).split_at_mut(region.area() as usize);
        rest = others;
        (region, tile)
    };
    let tiles = regions.into_iter().map(of_tile).collect();
    trace(world, settings, options, wanted, tiles, |_, tile, features| {
        tile.iter_mut().zip(features).for_each(|(pixel, features)| *pixel = features);
    });
    Ok(pixels)
}

/// Traces tiles until the options' flag is set, and has `write` store their features in the memory that is given with
/// each of them.
fn trace<Memory: Send>(
    world: &World,
    settings: &Settings,
    options: &Options,
    wanted: &[Layer],
    tiles: Vec<(Region, Memory)>,
    write: impl Fn(Region, &mut Memory, &mut dyn Iterator<Item = Features>) + Sync,
) {
    let job = Job::new(world, settings, settings.spp, options.tracer, options.elisions);
    let traced = |layer: &Layer| *layer != Layer::Id && !layer.is_statistic();
    let sampled = wanted.iter().any(traced);
    let samples = if sampled { settings.spp.min(SAMPLES) } else { 0 };
    tiles.into_par_iter().filter(|_| !options.is_cancelled()).for_each_init(
        || Workspace::new(world, options.elisions),
        |work, (region, mut memory)| {
            let mut layers = TileLayers::new(region);
            layers.refine(&job, samples, work);
            write(region, &mut memory, &mut layers.features());
        },
    );
}
