//! Features of a film's pixels: those that were recorded with its samples, and those that it lacks.

use crate::film::{
    FeatureSums, Film, MeanFeatures, Region, SampleSet, TILE, Tile, TileFeatures, View,
};
use crate::integrator::generate::{generate, generate_centers};
use crate::integrator::workspace::Workspace;
use crate::integrator::{Job, stages};
use crate::layers::{Features, Layers, NOTHING};
use crate::render::{Options, PASS, strata};
use crate::settings::Settings;
use crate::world::World;
use rayon::prelude::*;

/// Features that a film has not recorded, of samples of a render that was resumed, or that a device has taken; and the
/// bodies at the pixels' centers.
#[derive(Debug)]
pub(super) struct MissingFeatures {
    settings: Settings,
    /// By the film's tiles.
    tiles: Vec<Missing>,
}

/// Features that a tile has not recorded.
#[derive(Clone, Debug, Default)]
struct Missing {
    features: TileFeatures,
    /// The bodies at the pixels' centers, in the order of [`Tile::pixels`]; empty as long as they are unknown.
    ids: Vec<u32>,
}

impl MissingFeatures {
    /// Estimates the bytes of a region's features, recorded or missing.
    pub(super) fn bytes(region: Region) -> u64 {
        region.area() * (2 * size_of::<FeatureSums>() + size_of::<u32>()) as u64
    }

    /// Creates the features of films with these settings, of which all are missing.
    pub(super) fn new(settings: &Settings) -> Self {
        Self { settings: settings.clone(), tiles: Vec::new() }
    }

    /// Traces what a film lacks. Returns false if the options' flag cancels it, which is checked for each tile.
    pub(super) fn trace(&mut self, world: &World, film: &Film, options: &Options) -> bool {
        self.tiles.resize(film.tiles.len(), Missing::default());
        let settings = &self.settings;
        let job = Job::new(world, settings, strata(settings), options.tracer, options.elisions);
        let tiles = self.tiles.par_iter_mut().zip(&film.tiles);
        let tiles = tiles.filter_map(|(missing, tile)| {
            missing.forget_recorded(tile);
            missing.is_incomplete(tile).then_some((missing, tile))
        });
        let done = tiles.map_init(
            || Workspace::new(world, options.elisions),
            |work, (missing, tile)| {
                !options.is_cancelled() && {
                    missing.trace(&job, tile, work);
                    true
                }
            },
        );
        done.reduce(|| true, |a, b| a && b)
    }

    /// Returns the features of a film that lacks nothing else. Once the flag of the options is set, pixels are left out.
    pub(super) fn layers(&self, film: &Film, options: &Options) -> Layers {
        let Region { x: left, width, height, .. } = film.region;
        let in_row = width as usize;
        // Zeros are memory that is not there before a thread writes to it.
        let mut pixels = bytemuck::zeroed_vec::<Features>(in_row * height as usize);
        let rows = pixels.par_chunks_mut(in_row * TILE as usize);
        let columns = film.columns();
        let rows = rows.zip(film.tiles.par_chunks(columns)).zip(self.tiles.par_chunks(columns));
        rows.for_each(|((pixels, tiles), missing)| {
            let tiles = tiles.iter().zip(missing).take_while(|_| !options.is_cancelled());
            for (tile, missing) in tiles {
                for ((x, y), features) in tile.pixels().zip(missing.features(tile)) {
                    let row = (y - tile.region.y) as usize;
                    pixels[row * in_row + (x - left) as usize] = features;
                }
            }
        });
        Layers { width, height, pixels, statistics: None }
    }
}

impl Missing {
    /// Returns the samples whose features are unknown.
    fn samples(&self, tile: &Tile) -> SampleSet {
        let known = tile.features().recorded().union(self.features.recorded());
        SampleSet::first(tile.samples).without(known)
    }

    /// Forgets all features if the tile has recorded some of them itself: it is one of another render.
    fn forget_recorded(&mut self, tile: &Tile) {
        if self.features.recorded().overlaps(tile.features().recorded()) {
            self.features.clear();
        }
    }

    fn is_incomplete(&self, tile: &Tile) -> bool {
        self.ids.is_empty() || self.samples(tile) != SampleSet::default()
    }

    fn trace(&mut self, job: &Job, tile: &Tile, work: &mut Workspace) {
        if tile.view == View::Background && job.world.ground.is_none() {
            self.features.add(0..tile.samples, &[]);
            self.ids.resize(tile.len() as usize, NOTHING);
            return;
        }
        for samples in self.samples(tile).ranges(PASS) {
            work.view = tile.view;
            work.features.begin(samples.len());
            generate(job, tile.pixels(), samples.clone(), work);
            stages::intersect(job, work);
            self.features.add(samples, work.features.sums(0..tile.len() as usize));
        }
        if self.ids.is_empty() {
            work.view = tile.view;
            generate_centers(job, tile.pixels(), work);
            stages::intersect(job, work);
            self.ids.extend(
                work.hits.sphere[..tile.len() as usize].iter().map(|&hit| job.world.id_of(hit)),
            );
        }
    }

    /// Returns the features of the pixels, without depth and ground.
    fn features(&self, tile: &Tile) -> impl Iterator<Item = Features> {
        let means = tile.features().means_with(&self.features);
        means.zip(&self.ids).map(|(MeanFeatures { albedo, normal, coverage }, &id)| Features {
            albedo,
            normal,
            coverage,
            id,
            ..Features::NONE
        })
    }
}
