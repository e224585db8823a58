//! Renders that give every pixel as many samples.

use super::pass::{self, PASS};
use super::state::State;
use super::target::End;
use super::watch::Watch;
use crate::film::{Film, Tile};
use crate::integrator::Job;
use crate::integrator::workspace::Workspace;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Gives every pixel the samples that it lacks of a share.
///
/// A task is a pass over a tile, and threads take them off one counter: none ever waits for a whole pass
/// over the picture to end. Whoever comes to a tile takes the samples that are next there, so their
/// order does not depend on that of the tasks, nor on how often the render was stopped.
pub(super) fn run(job: &Job, share: Range<u32>, state: &mut State, watch: &Watch) -> End {
    let spp = share.len() as u32;
    let left = |tile: &Tile| passes_left(tile.samples, spp);
    let all = state.film.tiles.len() * spp.div_ceil(PASS) as usize;
    let rounds = state.film.tiles.iter().map(left).max().unwrap_or(0);
    let waiting: usize = state.film.tiles.iter().map(left).sum();
    let tiles: Vec<Mutex<&mut Tile>> = state.film.tiles.iter_mut().map(Mutex::new).collect();
    let tasks = tiles.len() * rounds;
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(all.saturating_sub(waiting)));
    rayon::broadcast(|_| {
        let mut work = Workspace::new(job.world, job.sampler, job.skips);
        while !watch.cancelled() {
            let task = next.fetch_add(1, Ordering::Relaxed);
            let Some(Ok(mut tile)) = (task < tasks).then(|| tiles[task % tiles.len()].lock())
            else {
                return;
            };
            if left(&tile) > 0 {
                let first = share.start + tile.samples;
                let end = share.start + pass_end(tile.samples, spp);
                pass::tile_pass(job, &mut tile, first..end, &mut work);
                pass::probe_pass(job, &mut tile, share.start..end, &mut work, || true);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                watch.report(&mut work, done as f64 / all as f64, None);
            }
        }
    });
    drop(tiles);
    state.round = rounds_taken(&state.film);
    let complete = state.film.tiles.iter().all(|tile| left(tile) == 0);
    if complete { End::Samples } else { End::Cancelled }
}

/// Where the pass ends that begins at sample `first`: passes begin where those of a render that
/// never stopped do.
fn pass_end(first: u32, spp: u32) -> u32 {
    spp.min((first / PASS + 1).saturating_mul(PASS))
}

/// Passes until a tile of so many samples has `spp`.
fn passes_left(samples: u32, spp: u32) -> usize {
    if samples < spp { (spp.div_ceil(PASS) - samples / PASS) as usize } else { 0 }
}

/// Passes of the tile that has had most.
pub(super) fn rounds_taken(film: &Film) -> u32 {
    film.tiles.iter().map(|tile| tile.samples.div_ceil(PASS)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_those_of_a_render_that_never_stopped() {
        for (first, spp, end, left) in [
            (0, 1, 1, 1),
            (0, 40, 16, 3),
            (16, 40, 32, 2),
            (20, 40, 32, 2),
            (32, 40, 40, 1),
            (40, 40, 40, 0),
            (u32::MAX - 1, u32::MAX, u32::MAX, 1),
        ] {
            assert_eq!(passes_left(first, spp), left, "{first} of {spp}");
            assert!(left == 0 || pass_end(first, spp) == end, "{first} of {spp}");
        }
    }
}
