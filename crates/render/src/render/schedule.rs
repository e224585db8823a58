//! Division of an image's samples into tasks.

use super::pass::PASS;
use crate::film::TILE;
use crate::integrator::columns::BATCH_PATHS;
use std::ops::Range;

/// Minimum number of times that each thread takes tasks: then all threads end at about the same time.
pub(super) const TURNS: usize = 8;

/// Division of the last passes into tasks, as pairs: passes per thread, and tasks per pass, from the
/// last pass.
///
/// If a few tiles contain much glass, say, their passes take up to six times as long as others. So the
/// last tasks are shorter, and tasks before them overlap with enough work that starts after them. Tasks
/// with smaller batches of paths take up to a tenth longer, so only the last passes are divided.
const ZONES: [(usize, u32); 2] = [(2, 4), (4, 2)];

/// Returns the number of tasks of a pass that is followed by `left` others.
pub(super) fn parts(left: usize, threads: usize) -> u32 {
    let mut end = 0;
    let zones = ZONES.iter().map(|&(passes, parts)| {
        end += passes * threads;
        (end, parts)
    });
    zones.into_iter().find(|&(end, _)| left < end).map_or(1, |(_, parts)| parts)
}

/// The tasks of a render, in the order in which they are started.
///
/// A pass is [`PASS`] samples of a tile's pixels. Passes cover all tiles before the next round, so that
/// the image progresses uniformly. They end at the same samples as in a render without interruptions.
#[derive(Debug)]
pub(super) struct Schedule {
    /// Samples that each tile has already.
    taken: Vec<u32>,
    /// Samples that each tile is to get in total.
    spp: u32,
    /// Number of all passes, counted as if every tile lacked as many as the one that lacks most.
    passes: usize,
    threads: usize,
}

/// The work of one thread at a time.
#[derive(Clone, Debug)]
pub(super) struct Task {
    /// Index of the tile.
    pub(super) tile: usize,
    /// Samples to take, perhaps none.
    pub(super) samples: Range<u32>,
    /// The pass of which this is a part.
    pub(super) of: Pass,
}

/// A pass of a schedule.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Number of passes after it.
    pub(super) left: usize,
    /// Number of tasks into which it is divided.
    pub(super) parts: u32,
}

impl Schedule {
    /// Creates the schedule up to `spp` samples, if tiles have `taken` some, for a number of threads.
    pub(super) fn new(taken: Vec<u32>, spp: u32, threads: usize) -> Self {
        let rounds = taken.iter().map(|&taken| passes_left(taken, spp)).max().unwrap_or(0);
        Self { passes: rounds * taken.len(), taken, spp, threads }
    }

    /// Returns the number of tasks that a thread takes at once: as many as fill a batch of paths, since
    /// smaller batches take longer, unless too few tasks would remain for the other threads.
    pub(super) fn at_once(&self) -> usize {
        let paths = (TILE * TILE * self.spp.clamp(1, PASS)) as usize;
        (BATCH_PATHS / paths).min(self.passes / (TURNS * self.threads)).max(1)
    }

    /// Returns the tasks with samples that a thread takes at once, from a number on; `None` after the
    /// last one.
    pub(super) fn tasks(&self, first: usize) -> Option<Vec<Task>> {
        self.task(first)?;
        let tasks = (first..first + self.at_once()).map_while(|at| self.task(at));
        Some(tasks.filter(|task| !task.samples.is_empty()).collect())
    }

    /// Returns a task by its number; `None` after the last one.
    fn task(&self, at: usize) -> Option<Task> {
        let (mut first_task, mut first_pass) = (0, 0);
        for (passes, parts) in self.zones() {
            let offset = at - first_task;
            if offset < passes * parts as usize {
                let (pass, part) = (first_pass + offset / parts as usize, offset % parts as usize);
                let samples = self.pass(pass);
                let cut = |part: usize| samples.start + samples.len() as u32 * part as u32 / parts;
                return Some(Task {
                    tile: pass % self.taken.len(),
                    samples: cut(part)..cut(part + 1),
                    of: Pass { left: self.passes - pass - 1, parts },
                });
            }
            first_task += passes * parts as usize;
            first_pass += passes;
        }
        None
    }

    /// Returns, from the first zone, the number of its passes and of tasks per pass.
    fn zones(&self) -> [(usize, u32); ZONES.len() + 1] {
        let mut left = self.passes;
        let mut zones = [(0, 1); ZONES.len() + 1];
        for (zone, (passes, parts)) in zones[1..].iter_mut().rev().zip(ZONES) {
            *zone = ((passes * self.threads).min(left), parts);
            left -= zone.0;
        }
        zones[0].0 = left;
        zones
    }

    /// Returns the samples of a pass.
    fn pass(&self, pass: usize) -> Range<u32> {
        let (tile, round) = (pass % self.taken.len(), pass / self.taken.len());
        let taken = self.taken[tile];
        let end = |round: usize| u64::from(PASS) * (u64::from(taken / PASS) + round as u64);
        let within = |end: u64| end.clamp(taken.into(), self.spp.max(taken).into()) as u32;
        within(end(round))..within(end(round + 1))
    }
}

/// Returns the number of passes until a tile has `spp` samples.
fn passes_left(samples: u32, spp: u32) -> usize {
    if samples < spp { (spp.div_ceil(PASS) - samples / PASS) as usize } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tasks(schedule: &Schedule) -> impl Iterator<Item = Task> {
        (0..).map_while(|at| schedule.task(at))
    }

    #[test]
    fn every_sample_is_taken_once_and_in_order() {
        for (taken, spp) in [
            (vec![0; 7], 40),
            (vec![0; 700], 16),
            (vec![0; 300], 3),
            (vec![20, 0, 40, 16, 39, 50], 40),
            (vec![40, 41], 40),
            (vec![u32::MAX - 1, u32::MAX - 40], u32::MAX),
            (vec![], 9),
        ] {
            for threads in [1, 2, 64] {
                let schedule = Schedule::new(taken.clone(), spp, threads);
                let mut reached = taken.clone();
                for Task { tile, samples, of } in tasks(&schedule) {
                    assert!(samples.is_empty() || samples.start == reached[tile], "{taken:?}");
                    assert!(samples.len() <= (PASS / of.parts) as usize);
                    assert_eq!(of.parts, parts(of.left, threads));
                    reached[tile] = reached[tile].max(samples.end);
                }
                assert!(reached.iter().zip(&taken).all(|(&now, &then)| now == then.max(spp)));
            }
        }
    }

    #[test]
    fn passes_end_as_in_a_render_without_interruptions() {
        let schedule = Schedule::new([20].repeat(9), 75, 1);
        let ends: Vec<u32> = (0..schedule.passes).map(|pass| schedule.pass(pass).end).collect();
        assert_eq!(ends, [[32; 9], [48; 9], [64; 9], [75; 9]].as_flattened());
    }

    #[test]
    fn tasks_become_shorter_toward_the_end() {
        let schedule = Schedule::new(vec![0; 1000], 16, 64);
        let lengths: Vec<_> = tasks(&schedule).map(|task| task.samples.len()).collect();
        assert!(lengths.is_sorted_by(|a, b| a >= b));
        assert_eq!(
            [16, 8, 4].map(|n| lengths.iter().filter(|&&m| m == n).count()),
            [616, 512, 512]
        );
    }
}
