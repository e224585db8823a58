//! State that all threads of a render use: cancellation, counters, times.

use super::schedule::Pass;
use super::tasks::Tasks;
use super::{Judge, Options, Progress};
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
    /// Time in each stage, summed over threads.
    pub times: Times,
    /// Division of the work into tasks.
    pub tasks: Tasks,
    /// Rendering time.
    pub elapsed: Duration,
}

impl Totals {
    /// Adds those of another part of the render, from another machine or another time.
    pub(super) fn add(&mut self, other: &Self) {
        self.counters.add(&other.counters);
        self.times.add(&other.times);
        self.tasks.add(&other.tasks);
        self.elapsed = self.elapsed.saturating_add(other.elapsed);
    }
}

/// State that all threads of a render use.
pub(super) struct Watch<'a> {
    options: &'a Options<'a>,
    start: Instant,
    /// Rendering time before this run.
    before: Duration,
    rays: AtomicU64,
    totals: Mutex<Totals>,
}

impl<'a> Watch<'a> {
    /// Continues from earlier totals.
    pub(super) fn new(options: &'a Options<'a>, totals: &Totals) -> Self {
        Self {
            options,
            start: Instant::now(),
            before: totals.elapsed,
            rays: AtomicU64::new(totals.counters.rays()),
            totals: Mutex::new(*totals),
        }
    }

    /// Returns the estimate that is compared with the target, if it is not that of the image itself.
    pub(super) fn judge(&self) -> Option<&'a Judge<'a>> {
        self.options.judge
    }

    /// Returns the rendering time, without interruptions.
    pub(super) fn elapsed(&self) -> Duration {
        self.before + self.start.elapsed()
    }

    /// Returns whether the render is to be cancelled.
    pub(super) fn cancelled(&self) -> bool {
        self.options.is_cancelled()
    }

    /// Adds the counters of a task, and reports the progress: the fraction `done`.
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

    /// Returns the totals.
    pub(super) fn totals(self) -> Totals {
        let elapsed = self.elapsed();
        Totals { elapsed, ..self.totals.into_inner().unwrap_or_default() }
    }
}
