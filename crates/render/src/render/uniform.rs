//! Renders with the same number of samples for every pixel.

use super::device;
use super::end::End;
use super::pass::{PASS, TileSamples, TileView, probe_pass};
use super::schedule::{Schedule, Task};
use super::state::State;
use super::watch::Watch;
use crate::film::{Film, Tile};
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Gives every pixel the samples that it lacks of `part`, a range of samples.
///
/// A task is a pass over a tile or a part of one, and threads take tasks from one counter: several at
/// once if their samples fill a batch of paths together. No thread waits for the end of a pass over the
/// whole image, nor for another that has samples of the same tile, except while these are added up,
/// in any order.
pub(super) fn run(job: &Job, part: Range<u32>, state: &mut State, watch: &Watch) -> End {
    let spp = part.len() as u32;
    let pixels = state.film.pixels().max(1) as f64 * f64::from(spp.max(1));
    let followed = AtomicU64::new(state.film.tiles.iter().map(samples_taken).sum());
    let lacking = |tile: &Tile| part.start + tile.samples.min(spp)..part.end;
    let steps = state.film.tiles.iter_mut().map(|tile| {
        let samples = lacking(tile);
        (tile, samples)
    });
    device::run(job, steps, Some(part.start), watch, |work, added| {
        let followed = followed.fetch_add(added, Ordering::Relaxed) + added;
        watch.report(work, None, (followed as f64 / pixels).min(1.0), None);
    });
    let taken: Vec<u32> = state.film.tiles.iter().map(|tile| tile.samples).collect();
    let all = taken.len() as u64 * u64::from(spp);
    let done = AtomicU64::new(taken.iter().map(|&taken| u64::from(taken.min(spp))).sum());
    let schedule = Schedule::new(taken, spp, rayon::current_num_threads());
    let next = AtomicUsize::new(0);
    let tiles: Vec<_> = state.film.tiles.iter_mut().map(shared_tile).collect();
    rayon::broadcast(|_| {
        let mut work = Workspace::new(job.world, job.elisions);
        while !watch.cancelled() {
            let first = next.fetch_add(schedule.at_once(), Ordering::Relaxed);
            let Some(tasks) = schedule.tasks(first) else { return };
            let in_one_batch = |a: &Task, b: &Task| {
                a.samples == b.samples && tiles[a.tile].0.matches(tiles[b.tile].0)
            };
            for batch in tasks.chunk_by(in_one_batch) {
                let [.., Task { samples, of, .. }] = batch else { continue };
                let count = (batch.len() * samples.len()) as u64;
                let samples = part.start + samples.start..part.start + samples.end;
                add(job, &tiles, batch, samples, part.start, &mut work);
                let done = done.fetch_add(count, Ordering::Relaxed) + count;
                watch.report(&mut work, Some(*of), done as f64 / all as f64, None);
            }
        }
    });
    drop(tiles);
    state.round = rounds_taken(&state.film);
    let complete = state.film.tiles.iter().all(|tile| tile.samples >= spp);
    if complete { End::Samples } else { End::Cancelled }
}

/// Returns the number of samples of all pixels of a tile.
fn samples_taken(tile: &Tile) -> u64 {
    u64::from(tile.len()) * u64::from(tile.samples)
}

/// A tile that all threads may add samples to.
type SharedTile<'a> = (TileView, Mutex<&'a mut Tile>);

fn shared_tile(tile: &mut Tile) -> SharedTile<'_> {
    (TileView::of(tile), Mutex::new(tile))
}

/// Takes samples of the tiles of a batch and adds them up, also for their probes, from `first` on.
fn add(
    job: &Job,
    tiles: &[SharedTile],
    batch: &[Task],
    samples: Range<u32>,
    first: u32,
    work: &mut Workspace,
) {
    let end = samples.end;
    let tiles = batch.iter().map(|task| &tiles[task.tile]);
    let taken = TileSamples::take(job, tiles.clone().map(|tile| tile.0), samples.clone(), work);
    let mut path = 0;
    for (_, tile) in tiles.clone() {
        if let Ok(mut tile) = tile.lock() {
            path = taken.add(&mut tile, samples.clone(), path, work);
        }
    }
    // Probes are paths, too: they replace those of the tiles.
    for (_, tile) in tiles {
        if let Ok(mut tile) = tile.lock() {
            probe_pass(job, &mut [&mut tile], first..end, work, || true);
        }
    }
}

/// Returns the number of passes of the tile with the most.
pub(super) fn rounds_taken(film: &Film) -> u32 {
    film.tiles.iter().map(|tile| tile.samples.div_ceil(PASS)).max().unwrap_or(0)
}
