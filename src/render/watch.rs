//! State that all threads of a render share: cancellation, counters, times.

use super::schedule::Pass;
use super::tasks::Tasks;
use super::{Options, Progress};
use crate::integrator::clock::Times;
use crate::integrator::counters::Counters;
use crate::integrator::workspace::Workspace;
use crate::noise::Noise;
use serde::{Deserialize, Serialize};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Counters and times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Totals {
    /// Counters of rays and decisions, probes included.
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
        self.tasks.add(&other.tasks);
        self.elapsed = self.elapsed.saturating_add(other.elapsed);
    }
}

/// State that all threads of a render share.
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
    pub(super) fn new(options: &'a Options<'a>, totals: &Totals) -> Self {
        Self {
            options,
            start: Instant::now(),
            before: totals.elapsed,
            rays: AtomicU64::new(totals.counters.rays()),
            totals: Mutex::new(*totals),
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
    pub(super) fn report(
        &self,
        work: &mut Workspace,
        of: Option<Pass>,
        done: f64,
        noise: Option<Noise>,
    ) {
        let counted = std::mem::take(&mut work.counters);
        let rays = self.rays.fetch_add(counted.rays(), Ordering::Relaxed) + counted.rays();
        if let Ok(mut totals) = self.totals.lock() {
            totals.counters.add(&counted);
            let times = work.clock.take();
            totals.times.add(&times);
            totals.tasks.push(times.total(), of);
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
