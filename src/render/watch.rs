//! What all threads of a render share: whether to go on, and what was done.

use super::{Options, Progress};
use crate::integrator::clock::Times;
use crate::integrator::workspace::{Counters, Workspace};
use crate::noise::Noise;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What all threads of a render share.
pub(super) struct Watch<'a> {
    options: &'a Options<'a>,
    start: Instant,
    rays: AtomicU64,
    totals: Mutex<(Counters, Times)>,
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
            totals.1.add(&work.clock.take());
        }
        if let Some(progress) = self.options.progress {
            progress(Progress { done, rays, elapsed: self.elapsed(), noise });
        }
    }

    /// All that was done.
    pub(super) fn totals(self) -> (Counters, Times) {
        self.totals.into_inner().unwrap_or_default()
    }
}
