//! Renders that give every pixel as many samples.

use super::pass::{PASS, Place, probe_pass};
use super::schedule::{Schedule, Task};
use super::state::State;
use super::target::End;
use super::watch::Watch;
use crate::film::{Film, Tile};
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Gives every pixel the samples that it lacks of a share.
///
/// A task is a pass over a tile or a part of one, and threads take them off one counter: none ever
/// waits for a whole pass over the picture to end, nor for another that has samples of the same tile,
/// but while these are added up. It does not matter in which order they are.
pub(super) fn run(job: &Job, share: Range<u32>, state: &mut State, watch: &Watch) -> End {
    let spp = share.len() as u32;
    let taken: Vec<u32> = state.film.tiles.iter().map(|tile| tile.samples).collect();
    let all = taken.len() as u64 * u64::from(spp);
    let done = AtomicU64::new(taken.iter().map(|&taken| u64::from(taken.min(spp))).sum());
    let schedule = Schedule::new(taken, spp, rayon::current_num_threads());
    let next = AtomicUsize::new(0);
    let tiles: Vec<_> = state.film.tiles.iter_mut().map(shared).collect();
    rayon::broadcast(|_| {
        let mut work = Workspace::new(job.world, job.elisions);
        while !watch.cancelled() {
            let next = next.fetch_add(1, Ordering::Relaxed);
            let Some(Task { tile, samples, of }) = schedule.task(next) else { return };
            let count = samples.len() as u64;
            if count > 0 {
                let samples = share.start + samples.start..share.start + samples.end;
                add(job, &tiles[tile], samples, share.start, &mut work);
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

/// A tile whose sums all threads may add to.
fn shared(tile: &mut Tile) -> (Place, Mutex<&mut Tile>) {
    (Place::of(tile), Mutex::new(tile))
}

/// Takes samples of a tile and adds them up; gives its probes theirs, from `first` on.
fn add(
    job: &Job,
    (place, tile): &(Place, Mutex<&mut Tile>),
    samples: Range<u32>,
    first: u32,
    work: &mut Workspace,
) {
    let (count, end) = (samples.len() as u32, samples.end);
    let taken = place.take(job, samples, work);
    if let Ok(mut tile) = tile.lock() {
        taken.add(&mut tile, count, work);
        probe_pass(job, &mut tile, first..end, work, || true);
    }
}

/// Passes of the tile that has had most.
pub(super) fn rounds_taken(film: &Film) -> u32 {
    film.tiles.iter().map(|tile| tile.samples.div_ceil(PASS)).max().unwrap_or(0)
}
