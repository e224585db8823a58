//! Progress of loading, for the page and for the terminal.

use crate::cli::progress::LoadMeter;
use indicatif::HumanCount;
use spherule_render::scene::particles::ReadProgress;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time between two reports.
const PAUSE: Duration = Duration::from_millis(100);

/// Progress of loading.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Loading {
    step: Step,
    /// Fraction of the step that is done, 0..=1; `None` if unknown.
    pub(super) done: Option<f64>,
}

/// A step of loading.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    /// Reading or generating the spheres of this file.
    Reading(String),
    /// Building the BVH of a number of spheres.
    Building(usize),
}

/// Progress of a loading thread, which other threads read.
#[derive(Debug, Default)]
pub(super) struct Progress {
    /// Size of the file in bytes.
    pub(super) read: ReadProgress,
    step: Mutex<Option<Step>>,
}

/// A thread that reports progress until this is dropped.
pub(super) struct ProgressReporter {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Loading {
    /// Returns the first report, before anything is read.
    pub(super) fn of(name: &str) -> Self {
        Self { step: Step::reading(name), done: None }
    }

    /// Formats the step and its progress.
    pub(super) fn text(&self) -> String {
        let step = match &self.step {
            Step::Reading(name) => format!("reading {name}"),
            Step::Building(spheres) => {
                format!("building the tree over {} spheres", HumanCount(*spheres as u64))
            }
        };
        match self.done {
            Some(done) => format!("{step}: {:.0} %", 100.0 * done),
            None => step,
        }
    }
}

impl Step {
    /// Creates the step of reading a file, named without its folders.
    pub(super) fn reading(name: &str) -> Self {
        let file = Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
        Self::Reading(file.unwrap_or_else(|| name.to_owned()))
    }
}

impl Progress {
    /// Starts a step.
    pub(super) fn begin(&self, step: Step) {
        *self.step.lock().unwrap_or_else(PoisonError::into_inner) = Some(step);
    }

    fn loading(&self) -> Option<Loading> {
        let step = self.step.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        let done = match step {
            Step::Reading(_) => self.read.fraction(),
            Step::Building(_) => None,
        };
        Some(Loading { step, done })
    }
}

impl ProgressReporter {
    /// Reports on the terminal, unless `quiet`, and through `notify`.
    pub(super) fn start(
        progress: &Arc<Progress>,
        quiet: bool,
        notify: impl Fn(Loading) + Send + 'static,
    ) -> Self {
        let (stop, stopped) = channel();
        let progress = Arc::clone(progress);
        let thread = std::thread::spawn(move || {
            let mut meter = LoadMeter::new(quiet);
            while stopped.recv_timeout(PAUSE) == Err(RecvTimeoutError::Timeout) {
                if let Some(loading) = progress.loading() {
                    meter.show(&loading.text(), loading.done);
                    notify(loading);
                }
            }
            meter.finish();
        });
        Self { stop: Some(stop), thread: Some(thread) }
    }
}

impl Drop for ProgressReporter {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_shown_with_their_progress() {
        let progress = Progress::default();
        assert_eq!(progress.loading(), None);
        progress.begin(Step::reading("some/where/big.csv"));
        assert_eq!(
            progress.loading().map(|loading| loading.text()),
            Some("reading big.csv".into())
        );
        progress.read.expect(200);
        progress.read.add(50);
        let loading = progress.loading().expect("a step");
        assert_eq!((loading.text().as_str(), loading.done), ("reading big.csv: 25 %", Some(0.25)));
        progress.begin(Step::Building(10_000_000));
        let text = progress.loading().expect("a step").text();
        assert_eq!(text, "building the tree over 10,000,000 spheres");
    }
}
