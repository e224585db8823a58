//! Layers beside the picture: what denoisers and compositors want to know of each pixel.
//!
//! They come from a pass of camera rays of its own, so that every integrator has them, and a render
//! without them does nothing for them. The rays are the picture's: the same samples of the same
//! filter through the same lens, so that edges and blur lie where the picture has them.

mod growing;
mod sums;

pub use self::growing::Growing;
use self::growing::Known;
use crate::film::{Film, Region};
use crate::image::{Channel, Values};
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use crate::ray::{GROUND, MISS};
use crate::render::{self, Options, RenderError, Statistics};
use crate::sampling::{PixelFilter, Sampler};
use crate::scene::Settings;
use crate::world::World;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The most samples of a pixel that layers take: with so many an edge is smooth to 1/256.
pub const SAMPLES: u32 = 256;

/// The id of a pixel whose center sees no surface.
pub const NOTHING: u32 = MISS;

/// The id of a pixel whose center sees the ground plane.
pub const GROUND_PLANE: u32 = GROUND;

/// A layer: an auxiliary channel of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
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

/// What is known of a pixel: of what its rays hit first, whatever it is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Features {
    /// Mean of [`World::albedo`], linear RGB, 0..=1; rays that hit nothing count as black.
    pub albedo: [f32; 3],
    /// Mean of the unit normals on the side that is looked at, in the scene's axes; rays that hit
    /// nothing count as 0, so it is shorter at edges.
    pub normal: [f32; 3],
    /// Mean of the distances from the camera, in the scene's unit, of the rays that hit: from the
    /// eye in perspective, from the plane through the eye in parallel projection. Infinite if none
    /// hits.
    pub depth: f32,
    /// Share of the rays that hit a sphere or the ground, 0..=1.
    pub coverage: f32,
    /// Share of the rays that hit the ground, 0..=1: a part of `coverage`.
    pub ground: f32,
    /// The sphere that the pixel's center sees, through the center of the lens: its place in the
    /// scene's order, from 0; or else [`NOTHING`] or [`GROUND_PLANE`].
    pub id: u32,
}

/// The layers of a picture, or of a region of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row from the top left.
    pub pixels: Vec<Features>,
    /// What the render knows of the same pixels; [`layers`] does not.
    pub statistics: Option<Statistics>,
}

impl Layer {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Coverage,
        Self::Id,
        Self::Variance,
        Self::Samples,
    ];

    /// The name before the dot in its channels' names.
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

    /// Whether the render has to know it: see [`Options::statistics`].
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
                .flat_map(|known| [('R', 0), ('G', 1), ('B', 2)].map(|part| (known, part)))
                .map(|(known, (part, i))| {
                    let variance = known.variance.pixels.iter().map(|pixel| pixel[i]);
                    channel(part, Values::Floats(variance.collect()))
                })
                .collect(),
            Self::Samples => statistics
                .map(|known| channel('Y', Values::Integers(known.samples.clone())))
                .collect(),
        }
    }
}

impl Features {
    /// Of a pixel that sees nothing, or of which nothing is known.
    pub const NONE: Self = Self {
        albedo: [0.0; 3],
        normal: [0.0; 3],
        depth: f32::INFINITY,
        coverage: 0.0,
        ground: 0.0,
        id: NOTHING,
    };
}

impl Layers {
    /// The layers of a region whose tiles are given in pieces, as [`features`] gives them; where there
    /// are none, nothing is known.
    pub fn gather(region: Region, pieces: &[(Range<u32>, Vec<Features>)]) -> Self {
        let Region { x: left, y: top, width, height } = region;
        let mut pixels = vec![Features::NONE; width as usize * height as usize];
        for (tiles, features) in pieces {
            let tiles = Film::tile_regions(region).skip(tiles.start as usize).take(tiles.len());
            let places = tiles.flat_map(Region::morton);
            for ((x, y), &features) in places.zip(features) {
                pixels[(y - top) as usize * width as usize + (x - left) as usize] = features;
            }
        }
        Self { width, height, pixels, statistics: None }
    }

    /// Bytes that the layers of a region take while they are found.
    pub fn bytes(region: Region) -> u64 {
        // Tile by tile, then row by row; and what is left of tiles.
        let pixel = 2 * size_of::<Features>() as u64 + 10;
        u64::from(region.width) * u64::from(region.height) * pixel
    }

    /// The channels of some layers, for [`Image::write_layers`](crate::Image::write_layers); none for
    /// those that only statistics know, if there are none.
    pub fn channels(&self, layers: &[Layer]) -> Vec<Channel> {
        layers.iter().flat_map(|layer| layer.channels(self)).collect()
    }
}

/// Finds the layers of a picture, by as many samples as it has but at most [`SAMPLES`].
///
/// Only the region and the tracer of `options` count. Like the picture's, pixels are the same bytes
/// for any number of threads and any tracer, in a region and in the whole. If `wanted` has nothing but
/// [`Layer::Id`] and statistics, one ray for each pixel does, and only the ids are of use.
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
    let tiles = 0..Film::tile_count(region);
    let features = features(world, settings, options, wanted, tiles.clone())?;
    Ok(Layers::gather(region, &[(tiles, features)]))
}

/// The same of some tiles of the region, by their numbers: the features of their pixels, tile by tile
/// and in each in the order of [`Tile::pixels`](crate::film::Tile::pixels).
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
    let sampler = Sampler::new(settings.sampler, settings.seed, settings.spp);
    let filter = PixelFilter::new(settings.filter);
    let (tracer, elisions) = (options.tracer, options.elisions);
    let job = Job { world, settings, sampler: &sampler, filter: &filter, tracer, elisions };
    let traced = |layer: &Layer| *layer != Layer::Id && !layer.is_statistic();
    let sampled = wanted.iter().any(traced);
    let samples = if sampled { settings.spp.min(SAMPLES) } else { 0 };
    let tiles = Film::with_tiles(region, tiles, false).tiles;
    let features: Vec<Vec<Features>> = tiles
        .into_par_iter()
        .map_init(
            || Workspace::new(world, elisions),
            |work, tile| {
                let mut known = Known::new(tile);
                known.grow(&job, samples, work);
                known.features()
            },
        )
        .collect();
    Ok(features.into_iter().flatten().collect())
}
