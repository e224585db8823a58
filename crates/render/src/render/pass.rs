//! Passes: samples of a tile, batch by batch.

use crate::film::{Pilot, Region, Tile, View};
use crate::integrator::Job;
use crate::integrator::clock::Stage;
use crate::integrator::generate::generate_streams;
use crate::integrator::workspace::{BATCH, Workspace};
use crate::sampling::Sampler;
use crate::scene::Rgb;
use crate::world::World;
use glam::DVec2;
use std::ops::Range;

/// Samples per pixel and pass; those of a tile are one batch of paths.
pub(super) const PASS: u32 = 16;

/// Returns the surfaces that camera rays of a tile may hit.
pub(crate) fn view(job: &Job, tile: &Tile) -> View {
    let world = job.world;
    let reach = f64::from(job.filter.radius()) - 0.5;
    let Region { x, y, width, height } = tile.region;
    let low = DVec2::new(f64::from(x), f64::from(y)) - reach;
    let high = DVec2::new(f64::from(x + width), f64::from(y + height)) + reach;
    let hit = world.bvh.may_be_hit(&world.spheres, &world.camera.beam(low, high));
    if hit { View::Anything } else { View::Background }
}

/// Returns the radiance of all samples of a tile, if they are equal and known.
pub(super) fn uniform_radiance(world: &World, tile: &Tile) -> Option<Rgb> {
    uniform_view(world, tile.view)
}

fn uniform_view(world: &World, view: View) -> Option<Rgb> {
    let only = world.ground.is_none() && !world.lights.suns_have_discs();
    world.environment.constant().filter(|_| only && view == View::Background)
}

/// The data of a tile that its camera rays need.
#[derive(Clone, Copy)]
pub(super) struct TileView {
    region: Region,
    view: View,
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
        Self { region: tile.region, view: tile.view }
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
        let uniform = uniform_view(job.world, view).filter(|_| job.elisions.even_background);
        if let Some(radiance) = uniform {
            let pixels: u64 = tiles.map(|tile| tile.region.area()).sum();
            work.counters.skipped_samples += pixels * samples.len() as u64;
            return Self::Uniform(radiance);
        }
        let streams =
            tiles.flat_map(|tile| tile.region.morton()).map(|(x, y)| (x, y, *job.sampler));
        trace_paths(job, (view, regions), (streams, samples), work);
        Self::Paths
    }

    /// Adds the samples of a tile to its sums: `count` for each of its pixels. The tile's first path is
    /// number `first`. Returns the number of the next tile's.
    pub(super) fn add(
        &self,
        tile: &mut Tile,
        count: u32,
        first: usize,
        work: &mut Workspace,
    ) -> usize {
        let end = first + (tile.len() * count) as usize;
        match *self {
            Self::Uniform(radiance) => tile.add_even(radiance, count),
            Self::Paths => {
                work.counters.bad_samples += tile.add(&work.paths.radiance[first..end], count);
            }
        }
        work.clock.end(Stage::Film);
        end
    }
}

/// Adds samples to the pixels of a tile.
pub(super) fn tile_pass(job: &Job, tile: &mut Tile, samples: Range<u32>, work: &mut Workspace) {
    let count = samples.end - samples.start;
    let view = std::iter::once(TileView::of(tile));
    TileSamples::take(job, view, samples, work).add(tile, count, 0, work);
}

/// Adds to the probes of a tile the samples that they lack, up to the end, as long as `proceed` is
/// true.
pub(super) fn probe_pass(
    job: &Job,
    tile: &mut Tile,
    samples: Range<u32>,
    work: &mut Workspace,
    proceed: impl Fn() -> bool,
) {
    let Some(batch) = BATCH.checked_div(tile.probes.streams()) else { return };
    while samples.start + tile.probes.samples < samples.end && proceed() {
        let first = samples.start + tile.probes.samples;
        let range = first..samples.end.min(first.saturating_add(batch as u32));
        let count = range.len() as u32;
        work.clock.restart();
        let rays = work.counters.rays();
        let streams = tile.probes.starts(job.sampler);
        work.near_misses.start(range.clone());
        let paths =
            trace_paths(job, (tile.view, std::iter::once(tile.region)), (streams, range), work);
        let streams = tile.probes.streams();
        work.near_misses.finish(&mut tile.probes.chance, streams);
        work.counters.bad_samples += tile.probes.add(&work.paths.radiance[..paths], count);
        tile.probes.rays += work.counters.rays() - rays;
        work.clock.end(Stage::Film);
    }
}

/// Takes pilot samples, which are not part of the picture: one pixel of each `block`, and `samples` of
/// it, at most [`PASS`].
pub(super) fn pilot_pass(
    job: &Job,
    tile: &mut Tile,
    (block, samples): (u32, u32),
    work: &mut Workspace,
) {
    if let Some(radiance) = uniform_radiance(job.world, tile) {
        let sum = f64::from(tile.len()) * radiance.to_array().map(f64::from).iter().sum::<f64>();
        tile.probes.pilot = Some(Pilot { sum: sum / 3.0, variance: 0.0 });
        return;
    }
    work.clock.restart();
    let pixels = Pilot::starts(tile, job.sampler, job.settings.seed, block);
    let streams = pixels.iter().map(|&(x, y, sampler, _)| (x, y, sampler));
    let paths =
        trace_paths(job, (tile.view, std::iter::once(tile.region)), (streams, 0..samples), work);
    let weights = pixels.iter().map(|&(.., weight)| weight);
    tile.probes.pilot = Some(Pilot::new(&work.paths.radiance[..paths], samples, weights));
    work.clock.end(Stage::Film);
}

/// Traces the paths of samples of pixels in these regions to their ends, and returns their number.
fn trace_paths(
    job: &Job,
    (view, regions): (View, impl Iterator<Item = Region>),
    (streams, samples): (impl Iterator<Item = (u32, u32, Sampler)>, Range<u32>),
    work: &mut Workspace,
) -> usize {
    work.view = view;
    work.begin(job, regions);
    generate_streams(job, streams, samples, work);
    let paths = work.len();
    job.integrate(work);
    work.clock.end(Stage::Shade);
    paths
}
