//! Renders with the same number of samples for every pixel.

use super::end::End;
use super::pass::{PASS, TileView, probe_pass};
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
/// A task is a pass over a tile or a part of one, and threads take tasks from one counter. No thread
/// waits for the end of a pass over the whole picture, nor for another that has samples of the same
/// tile, except while these are added up, in any order.
pub(super) fn run(job: &Job, part: Range<u32>, state: &mut State, watch: &Watch) -> End {
    let spp = part.len() as u32;
    let taken: Vec<u32> = state.film.tiles.iter().map(|tile| tile.samples).collect();
    let all = taken.len() as u64 * u64::from(spp);
    let done = AtomicU64::new(taken.iter().map(|&taken| u64::from(taken.min(spp))).sum());
    let schedule = Schedule::new(taken, spp, rayon::current_num_threads());
    let next = AtomicUsize::new(0);
    let tiles: Vec<_> = state.film.tiles.iter_mut().map(shared_tile).collect();
    rayon::broadcast(|_| {
        let mut work = Workspace::new(job.world, job.elisions);
        while !watch.cancelled() {
            let next = next.fetch_add(1, Ordering::Relaxed);
            let Some(Task { tile, samples, of }) = schedule.task(next) else { return };
            let count = samples.len() as u64;
            if count > 0 {
                let samples = part.start + samples.start..part.start + samples.end;
                add(job, &tiles[tile], samples, part.start, &mut work);
                let done = done.fetch_add(count, Ordering::Relaxed) + count;
                watch.report(&mut work, Some(of), done as f64 / all as f64, None);
            }
        }
    });
    drop(tiles);
    state.round = rounds_taken(&state.film);
    let complete = state.film.tiles.iter().all(|tile| tile.samples >= spp);
    if complete { End::Samples } else { End::Cancelled }
}

/// Returns a tile that all threads may add samples to.
fn shared_tile(tile: &mut Tile) -> (TileView, Mutex<&mut Tile>) {
    (TileView::of(tile), Mutex::new(tile))
}

/// Takes samples of a tile and adds them up, also for its probes, from `first` on.
fn add(
    job: &Job,
    (view, tile): &(TileView, Mutex<&mut Tile>),
    samples: Range<u32>,
    first: u32,
    work: &mut Workspace,
) {
    let (count, end) = (samples.len() as u32, samples.end);
    let taken = view.take(job, samples, work);
    if let Ok(mut tile) = tile.lock() {
        taken.add(&mut tile, count, work);
        probe_pass(job, &mut tile, first..end, work, || true);
    }
}

/// Returns the number of passes of the tile with the most.
pub(super) fn rounds_taken(film: &Film) -> u32 {
    film.tiles.iter().map(|tile| tile.samples.div_ceil(PASS)).max().unwrap_or(0)
}
