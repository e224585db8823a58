//! Passes: samples of a tile, batch by batch.

use crate::film::{Pilot, Region, Tile, View};
use crate::integrator::Job;
use crate::integrator::clock::Stage;
use crate::integrator::columns::BATCH_PATHS;
use crate::integrator::generate::generate_streams;
use crate::integrator::probe_batch::ProbeBatch;
use crate::integrator::workspace::Workspace;
use crate::sampling::Sampler;
use crate::scene::Rgb;
use crate::world::World;
use glam::DVec2;
use std::ops::Range;

/// Samples per pixel and pass; those of a tile are one batch of paths.
pub(crate) const PASS: u32 = 16;

/// Returns the surfaces that camera rays of a region may hit.
pub(crate) fn view(job: &Job, Region { x, y, width, height }: Region) -> View {
    let world = job.world;
    let reach = f64::from(job.filter.radius()) - 0.5;
    let low = DVec2::new(f64::from(x), f64::from(y)) - reach;
    let high = DVec2::new(f64::from(x + width), f64::from(y + height)) + reach;
    let beam = world.camera.beam(low, high);
    if world.trees().may_be_hit(&beam) { View::Anything } else { View::Background }
}

/// Returns the radiance of all samples of a tile with this view, if they are equal and known.
pub(super) fn uniform_radiance(world: &World, view: View) -> Option<Rgb> {
    let sky = world.environment.constant().filter(|_| !world.lights.suns_have_discs());
    let seen = world.environment.background.or(sky);
    seen.filter(|_| world.ground.is_none() && view == View::Background)
}

/// The data of a tile that its camera rays need.
#[derive(Clone, Copy)]
pub(super) struct TileView {
    region: Region,
    view: View,
    /// True if the tile keeps features.
    features: bool,
}

/// Samples of tiles that are not yet added to their sums.
pub(super) enum TileSamples {
    /// Samples of equal radiance.
    Uniform(Rgb),
    /// The radiance of the paths of a workspace, tile by tile.
    Paths,
}

impl TileView {
    pub(super) fn of(tile: &Tile) -> Self {
        Self { region: tile.region, view: tile.view, features: tile.keeps_features() }
    }

    /// Returns whether samples of both tiles can be taken in one batch.
    pub(super) fn matches(self, other: Self) -> bool {
        self.view == other.view
    }
}

impl TileSamples {
    /// Takes samples of the pixels of tiles with the same view, no more than a batch of paths.
    pub(super) fn take(
        job: &Job,
        tiles: impl Iterator<Item = TileView> + Clone,
        samples: Range<u32>,
        work: &mut Workspace,
    ) -> Self {
        work.clock.restart();
        let view = tiles.clone().next().map_or(View::Anything, |tile| tile.view);
        let regions = tiles.clone().map(|tile| tile.region);
        let uniform = uniform_radiance(job.world, view).filter(|_| job.elisions.even_background);
        if let Some(radiance) = uniform {
            let pixels: u64 = tiles.map(|tile| tile.region.area()).sum();
            work.counters.skipped_samples += pixels * samples.len() as u64;
            return Self::Uniform(radiance);
        }
        if tiles.clone().any(|tile| tile.features) && Tile::records(&samples) {
            work.features.begin(samples.len());
        }
        let streams = tiles.flat_map(|tile| tile.region.morton()).map(|(x, y)| (x, y, job.sampler));
        trace_paths(job, view, regions, streams, samples, work);
        Self::Paths
    }

    /// Adds the samples of a tile to its sums: these of each of its pixels. The tile's first path is
    /// number `first`. Returns the number of the next tile's.
    pub(super) fn add(
        &self,
        tile: &mut Tile,
        samples: Range<u32>,
        first: usize,
        work: &mut Workspace,
    ) -> usize {
        let count = samples.end - samples.start;
        let end = first + (tile.len() * count) as usize;
        match *self {
            Self::Uniform(radiance) => {
                tile.add_even(radiance, count);
                tile.add_features(samples, &[]);
            }
            Self::Paths => {
                work.counters.bad_samples += tile.add(&work.paths.radiance[first..end], count);
                let pixels = first / count as usize..end / count as usize;
                tile.add_features(samples, work.features.sums(pixels));
            }
        }
        work.clock.end(Stage::Film);
        end
    }
}

/// Adds samples to the pixels of tiles of the same view, no more than a batch of paths.
pub(super) fn tile_pass(
    job: &Job,
    tiles: &mut [&mut Tile],
    samples: Range<u32>,
    work: &mut Workspace,
) {
    let views = tiles.iter().map(|tile| TileView::of(tile));
    let taken = TileSamples::take(job, views, samples.clone(), work);
    let mut path = 0;
    for tile in tiles {
        path = taken.add(tile, samples.clone(), path, work);
    }
}

/// Adds to the probes of tiles the samples that they lack, up to the end, as long as `proceed` is true.
///
/// The tiles are of the same view, and their probes have equally many samples. They are best as many as fill a
/// batch of paths.
pub(super) fn probe_pass(
    job: &Job,
    tiles: &mut [&mut Tile],
    samples: Range<u32>,
    work: &mut Workspace,
    proceed: impl Fn() -> bool,
) {
    let Some(Tile { view, .. }) = tiles.first() else { return };
    let view = *view;
    loop {
        let streams = tiles.iter().map(|tile| tile.probes.streams());
        let taken = tiles.iter().map(|tile| tile.probes.samples).max().unwrap_or(0);
        let first = samples.start + taken;
        let Some(batch) = BATCH_PATHS.checked_div(streams.clone().sum()) else { return };
        if first >= samples.end || !proceed() {
            return;
        }
        let range = first..samples.end.min(first.saturating_add((batch as u32).max(1)));
        let count = range.len() as u32;
        work.clock.restart();
        work.probes = ProbeBatch::new(range.clone(), streams);
        let starts = tiles.iter().flat_map(|tile| tile.probes.starts(&job.sampler));
        let regions = tiles.iter().map(|tile| tile.region);
        trace_paths(job, view, regions, starts, range, work);
        let probes = std::mem::take(&mut work.probes);
        work.near_misses.finish(tiles.iter_mut().map(|tile| {
            let streams = tile.probes.streams();
            (&mut tile.probes.chance, streams)
        }));
        let mut radiance = work.paths.radiance.as_slice();
        for (tile, rays) in tiles.iter_mut().zip(probes.rays()) {
            let (own, rest) = radiance.split_at(tile.probes.streams() * count as usize);
            radiance = rest;
            work.counters.bad_samples += tile.probes.add(own, count);
            tile.probes.rays += rays;
        }
        work.clock.end(Stage::Film);
    }
}

/// Returns the number of paths of `samples` samples of the probes of a tile.
pub(super) fn probe_paths(tile: &Tile, samples: u32) -> usize {
    tile.probes.streams() * samples.min(PASS) as usize
}

/// Takes pilot samples of tiles of the same view, which are not part of the image: one pixel of each `block`,
/// and `samples` of it, at most [`PASS`].
pub(super) fn pilot_pass(
    job: &Job,
    tiles: &mut [&mut Tile],
    block: u32,
    samples: u32,
    work: &mut Workspace,
) {
    let Some(Tile { view, .. }) = tiles.first() else { return };
    if let Some(radiance) = uniform_radiance(job.world, *view) {
        let mean = radiance.to_array().map(f64::from).iter().sum::<f64>() / 3.0;
        for tile in tiles {
            tile.probes.pilot = Some(Pilot { sum: f64::from(tile.len()) * mean, variance: 0.0 });
        }
        return;
    }
    work.clock.restart();
    let pixels = |tile: &&mut Tile| Pilot::starts(tile, &job.sampler, job.settings.seed, block);
    let pixels: Vec<_> = tiles.iter().map(pixels).collect();
    let streams = pixels.iter().flatten().map(|&(x, y, sampler, _)| (x, y, sampler));
    let regions = tiles.iter().map(|tile| tile.region);
    trace_paths(job, *view, regions, streams, 0..samples, work);
    let mut radiance = work.paths.radiance.as_slice();
    for (tile, pixels) in tiles.iter_mut().zip(pixels) {
        let (own, rest) = radiance.split_at(pixels.len() * samples as usize);
        radiance = rest;
        let weights = pixels.iter().map(|&(.., weight)| weight);
        tile.probes.pilot = Some(Pilot::new(own, samples, weights));
    }
    work.clock.end(Stage::Film);
}

/// Returns the number of paths of a tile's pilot.
pub(super) fn pilot_paths(tile: &Tile, block: u32, samples: u32) -> usize {
    tile.len().div_ceil(block) as usize * samples as usize
}

/// Traces the paths of samples of pixels in these regions to their ends.
pub(super) fn trace_paths(
    job: &Job,
    view: View,
    regions: impl Iterator<Item = Region>,
    mut streams: impl Iterator<Item = (u32, u32, Sampler)>,
    samples: Range<u32>,
    work: &mut Workspace,
) {
    work.view = view;
    work.begin(job, regions);
    generate_streams(job, &mut streams, samples, work);
    job.integrate(work);
    work.clock.end(Stage::Shade);
}
