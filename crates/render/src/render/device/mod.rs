//! Passes of tiles that a device and the processor take from one queue: the device many tiles at a time, each thread as many as
//! fill a batch of its own. Threads first add up what the device has found.
//!
//! All samples have the bytes of the processor's, and sums are exact: who takes which changes no number. So the processor
//! works while a device compiles its kernels, and a slow device holds up no more than its last batches.

mod found;
mod queue;
#[cfg(test)]
mod tests;

use super::pass::{probe_pass, tile_pass};
use super::watch::Watch;
use crate::film::{Tile, View};
use crate::integrator::Job;
use crate::integrator::SeenLights;
use crate::integrator::clock::Stage;
use crate::integrator::columns::BATCH_PATHS;
use crate::integrator::workspace::Workspace;
use crate::world::DevicePaths;
use queue::{FoundPixels, Taken, TileQueue, Work};
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Batches that a device has at a time: while it follows the paths of one, another is prepared, or read back.
const IN_FLIGHT: usize = 2;

/// Numbers of paths of a batch: the first, and the most. The most is enough for all lanes of the largest GPUs.
const FEWEST: usize = 1 << 16;
const MOST: usize = 1 << 19;

/// Devices that follow a batch within this get one of twice as many paths next; few enough that a render is cancelled
/// soon. The size of batches changes no number.
const QUICK: Duration = Duration::from_millis(20);

/// Takes samples of tiles together with the device, a pass at a time; and of their probes, from `probed` on, if it is given, which
/// the processor follows. `report` gets the number of samples of each pass.
///
/// Tiles whose camera rays hit no sphere get none: they take the processor no time.
pub(super) fn run<'a>(
    job: &Job,
    steps: impl Iterator<Item = (&'a mut Tile, Range<u32>)>,
    probed: Option<u32>,
    watch: &Watch,
    report: impl Fn(&mut Workspace, u64) + Sync,
) {
    let Some(device) = job.device.filter(|_| !watch.cancelled()) else { return };
    let queue = TileQueue::new(steps.filter(|(tile, _)| tile.view == View::Anything));
    // Threads would leave nothing of a small image to the device.
    let first: Vec<Option<Taken>> = (0..IN_FLIGHT).map(|_| queue.take(FEWEST)).collect();
    if first.iter().all(Option::is_none) {
        return;
    }
    std::thread::scope(|scope| {
        for first in first {
            scope.spawn(|| drive(job, device, &queue, first, watch));
        }
        rayon::broadcast(|_| help(job, &queue, probed, &report, watch));
    });
}

/// Has a device follow the paths of batches, beginning with the tiles of `first`, until no tile
/// lacks samples, or the device fails.
fn drive<'q, 'a>(
    job: &Job,
    device: &dyn DevicePaths,
    queue: &'q TileQueue<'a>,
    mut first: Option<Taken<'q, 'a>>,
    watch: &Watch,
) {
    let mut lights = SeenLights::default();
    let mut size = FEWEST;
    loop {
        let next = || queue.next_batch([FEWEST, size], || watch.cancelled());
        let Some(taken) = first.take().or_else(next) else { return };
        let batch = Batch::new(job, &taken, &mut lights);
        let mut found = queue.spare();
        let start = Instant::now();
        if !device.follow(&batch.pixels, taken.pass.clone(), &mut found) {
            return;
        }
        if start.elapsed() < QUICK {
            size = MOST.min(2 * size);
        }
        let all = Arc::new(found);
        let found = batch.tiles.into_iter().map(|(own, left)| FoundPixels {
            all: Arc::clone(&all),
            own,
            left,
        });
        taken.hand_over(found);
    }
}

/// Adds up what the device has found, and samples tiles where there is nothing to add, until no tile lacks samples.
fn help(
    job: &Job,
    queue: &TileQueue,
    probed: Option<u32>,
    report: &(impl Fn(&mut Workspace, u64) + Sync),
    watch: &Watch,
) {
    let mut work = Workspace::new(job.world, job.elisions);
    while let Some(next) = queue.next_work(BATCH_PATHS, || watch.cancelled()) {
        let taken = match next {
            Work::Add(mut taken, pixels) => {
                work.clock.restart();
                for tile in &mut taken.tiles {
                    found::add(job, tile, &taken.pass, &pixels, &mut work);
                }
                work.clock.end(Stage::Film);
                queue.recycle(pixels);
                taken
            }
            Work::Sample(mut taken) => {
                tile_pass(job, &mut taken.tiles, taken.pass.clone(), &mut work);
                taken
            }
        };
        finish(job, taken, probed, report, &mut work);
    }
}

/// Samples the probes of tiles that have the samples of a pass, and gives them back.
fn finish(
    job: &Job,
    mut taken: Taken,
    probed: Option<u32>,
    report: &impl Fn(&mut Workspace, u64),
    work: &mut Workspace,
) {
    if let Some(from) = probed {
        for tile in &mut taken.tiles {
            probe_pass(job, &mut [tile], from..taken.pass.end, work, || true);
        }
    }
    report(work, taken.samples());
    taken.finish();
}

/// Pixels of tiles of which a device follows the paths at once.
struct Batch {
    /// The pixels of all tiles, without those in which the camera sees lights: the processor samples these.
    pixels: Vec<(u32, u32)>,
    /// The places of the pixels of each tile, and flags of those in which the camera sees lights; empty if it sees none.
    tiles: Vec<(Range<usize>, Vec<bool>)>,
}

impl Batch {
    fn new(job: &Job, taken: &Taken, lights: &mut SeenLights) -> Self {
        let mut pixels = Vec::new();
        let tiles = taken.tiles.iter().map(|tile| {
            let first = pixels.len();
            lights.begin(job, std::iter::once(tile.region));
            let seen: Vec<bool> = if lights.is_empty() {
                pixels.extend(tile.pixels());
                Vec::new()
            } else {
                let seen: Vec<_> = tile.pixels().map(|(x, y)| lights.are_in(job, x, y)).collect();
                let left = tile.pixels().zip(&seen).filter(|(_, seen)| !**seen);
                pixels.extend(left.map(|(pixel, _)| pixel));
                seen
            };
            (first..pixels.len(), seen)
        });
        let tiles = tiles.collect();
        Self { pixels, tiles }
    }
}
