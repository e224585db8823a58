//! What all threads of a render share: whether to go on, and what was done.

use super::{Options, Progress};
use crate::integrator::clock::Times;
use crate::integrator::workspace::{Counters, Workspace};
use crate::noise::Noise;
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

/// What all threads of a render share.
pub(super) struct Watch<'a> {
    options: &'a Options<'a>,
    start: Instant,
    rays: AtomicU64,
    totals: Mutex<(Counters, Times, Tasks)>,
}

impl<'a> Watch<'a> {
    pub(super) fn new(options: &'a Options<'a>) -> Self {
        let (rays, totals) = (AtomicU64::new(0), Mutex::default());
        Self { options, start: Instant::now(), rays, totals }
    }

    /// Since the render began.
    pub(super) fn elapsed(&self) -> Duration {
        self.start.elapsed()
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
            totals.0.add(&counted);
            let times = work.clock.take();
            totals.1.add(&times);
            totals.2.count += 1;
            totals.2.longest = totals.2.longest.max(times.total());
            totals.2.total += times.total();
        }
        if let Some(progress) = self.options.progress {
            progress(Progress { done, rays, elapsed: self.elapsed(), noise });
        }
    }

    /// All that was done.
    pub(super) fn totals(self) -> (Counters, Times, Tasks) {
        self.totals.into_inner().unwrap_or_default()
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
