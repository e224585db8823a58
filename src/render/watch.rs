//! What all threads of a render share: whether to go on, and what was done.

use super::{Options, Progress};
use crate::integrator::clock::Times;
use crate::integrator::counters::Counters;
use crate::integrator::workspace::Workspace;
use crate::noise::Noise;
use serde::{Deserialize, Serialize};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How a render's work was divided: a task is what one thread does between looking for something to do
/// and looking again, alone and without waiting for anyone.
///
/// On `n` threads a render takes no longer than its work over `n` and one task: nobody is idle before
/// there is nothing left to begin (Graham, "Bounds on Multiprocessing Timing Anomalies", SIAM Journal on
/// Applied Mathematics 1969). That is so for pictures of more tiles than threads, as far as memory keeps
/// up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tasks {
    /// How many.
    pub count: u64,
    /// How long the longest took.
    pub longest: Duration,
    /// How long all took together.
    pub total: Duration,
}

impl Tasks {
    /// The least efficiency on so many threads, 0..=1: speed-up over threads.
    pub fn efficiency(&self, threads: u32) -> f64 {
        let ideal = self.total / threads;
        let longest = self.longest.mul_f64(1.0 - 1.0 / f64::from(threads));
        if self.total.is_zero() { 1.0 } else { ideal.div_duration_f64(ideal + longest) }
    }
}

/// What was done, and how long it took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Totals {
    /// What was done, for probes too.
    pub counters: Counters,
    /// Time in each stage, of all threads together.
    pub times: Times,
    /// The tasks that the threads shared.
    pub tasks: Tasks,
    /// Time that it took.
    pub elapsed: Duration,
}

impl Totals {
    /// Adds what another share of the render took, on another machine or at another time.
    pub(super) fn add(&mut self, other: &Self) {
        self.counters.add(&other.counters);
        self.times.add(&other.times);
        self.tasks.count += other.tasks.count;
        self.tasks.longest = self.tasks.longest.max(other.tasks.longest);
        self.tasks.total += other.tasks.total;
        self.elapsed += other.elapsed;
    }
}

/// What all threads of a render share.
pub(super) struct Watch<'a> {
    options: &'a Options<'a>,
    start: Instant,
    /// Time that the render took before.
    before: Duration,
    rays: AtomicU64,
    totals: Mutex<Totals>,
}

impl<'a> Watch<'a> {
    /// Goes on from what was done before.
    pub(super) fn new(options: &'a Options<'a>, totals: Totals) -> Self {
        Self {
            options,
            start: Instant::now(),
            before: totals.elapsed,
            rays: AtomicU64::new(totals.counters.rays()),
            totals: Mutex::new(totals),
        }
    }

    /// Since the render began, but for pauses.
    pub(super) fn elapsed(&self) -> Duration {
        self.before + self.start.elapsed()
    }

    /// Whether someone wants the render to end.
    pub(super) fn cancelled(&self) -> bool {
        self.options.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Takes in what a task has done, and tells how far the render is: `done` of it.
    pub(super) fn report(&self, work: &mut Workspace, done: f64, noise: Option<Noise>) {
        let counted = std::mem::take(&mut work.counters);
        let rays = self.rays.fetch_add(counted.rays(), Ordering::Relaxed) + counted.rays();
        if let Ok(mut totals) = self.totals.lock() {
            totals.counters.add(&counted);
            let times = work.clock.take();
            totals.times.add(&times);
            totals.tasks.count += 1;
            totals.tasks.longest = totals.tasks.longest.max(times.total());
            totals.tasks.total += times.total();
        }
        if let Some(progress) = self.options.progress {
            progress(Progress { done, rays, elapsed: self.elapsed(), noise });
        }
    }

    /// All that was done.
    pub(super) fn totals(self) -> Totals {
        let elapsed = self.elapsed();
        Totals { elapsed, ..self.totals.into_inner().unwrap_or_default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_long_task_bounds_the_efficiency() {
        let of = |longest, total| Tasks {
            count: 2,
            longest: Duration::from_millis(longest),
            total: Duration::from_millis(total),
        };
        assert_eq!(Tasks::default().efficiency(64), 1.0);
        assert_eq!(of(10, 1000).efficiency(1), 1.0);
        // 100 ms of work each and 9 ms more.
        assert!((of(10, 1000).efficiency(10) - 100.0 / 109.0).abs() < 1e-12);
    }
}
