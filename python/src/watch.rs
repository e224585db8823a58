//! Work on other threads while Python waits: without its lock, and with an eye on signals.

use crate::errors::internal;
use pyo3::prelude::*;
use rayon::ThreadPool;
use spherule::render::Progress;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time between two looks at signals.
const GLANCE: Duration = Duration::from_millis(15);

/// Ends renders from another thread: `render(..., stop=stop)` returns the picture so far after `stop.set()`.
#[pyclass(frozen, module = "spherule")]
#[derive(Default)]
pub(crate) struct Stop {
    flag: Arc<AtomicBool>,
}

#[pymethods]
impl Stop {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Ends the renders that were given this object, and those that will be.
    fn set(&self) {
        self.flag.store(true, Ordering::SeqCst);
    }

    /// True after `set`.
    fn is_set(&self) -> bool {
        self.flag.load(Ordering::SeqCst)
    }
}

/// State that work and watcher share.
#[derive(Default)]
pub(crate) struct Shared {
    /// Set to end the work early, with what there is.
    pub(crate) cancel: AtomicBool,
    /// True as long as there is something to keep, so that the end of the work is awaited.
    pub(crate) keeps: AtomicBool,
    progress: Mutex<Option<Progress>>,
}

impl Shared {
    /// Stores the progress; may be called from any thread.
    pub(crate) fn show(&self, progress: Progress) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
    }

    fn take_progress(&self) -> Option<Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Who may end the work, and who hears of its progress.
#[derive(Default)]
pub(crate) struct Watcher<'py> {
    pub(crate) stop: Option<Arc<AtomicBool>>,
    /// Called with the fraction done, the rays, the seconds, and the error if known.
    pub(crate) report: Option<Bound<'py, PyAny>>,
}

impl<'py> Watcher<'py> {
    pub(crate) fn new(stop: Option<&Stop>, report: Option<Bound<'py, PyAny>>) -> Self {
        Self { stop: stop.map(|stop| Arc::clone(&stop.flag)), report }
    }

    /// Runs work with the threads of a pool. A signal, an exception of the report or a stop cancels it; then what it
    /// returns is what it has so far, beside the exception if there was one. Work that has nothing yet to keep is
    /// left behind: the exception comes at once.
    pub(crate) fn run<T: Send + 'static>(
        &self,
        py: Python<'py>,
        pool: Arc<ThreadPool>,
        work: impl FnOnce(&Shared) -> T + Send + 'static,
    ) -> PyResult<(T, Option<PyErr>)> {
        self.run_outside(py, move |shared| pool.install(|| work(shared)))
    }

    /// Runs work on a thread of its own, as [`Watcher::run`] otherwise. Locks that work in a pool needs are taken outside of
    /// it: a thread of the pool that waits for others begins other work meanwhile, which may want the same lock.
    pub(crate) fn run_outside<T: Send + 'static>(
        &self,
        py: Python<'py>,
        work: impl FnOnce(&Shared) -> T + Send + 'static,
    ) -> PyResult<(T, Option<PyErr>)> {
        let shared = Arc::new(Shared::default());
        let (sender, receiver) = mpsc::channel();
        let watched = Arc::clone(&shared);
        thread::spawn(move || {
            let result = work(&watched);
            // Nobody waits for work that was left behind.
            let _ = sender.send(result);
        });
        let mut interrupt = None;
        let receiver = Mutex::new(receiver);
        loop {
            let result = py.detach(|| {
                let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
                receiver.recv_timeout(GLANCE)
            });
            match result {
                Ok(result) => return Ok((result, interrupt)),
                Err(RecvTimeoutError::Disconnected) => return Err(internal()),
                Err(RecvTimeoutError::Timeout) => (),
            }
            let stopped = self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::SeqCst));
            if stopped {
                shared.cancel.store(true, Ordering::SeqCst);
            }
            let looked = py.check_signals().and_then(|()| self.tell(&shared));
            if let Err(error) = looked {
                shared.cancel.store(true, Ordering::SeqCst);
                // A second signal does not wait either.
                if interrupt.is_some() || !shared.keeps.load(Ordering::SeqCst) {
                    return Err(error);
                }
                interrupt = Some(error);
            }
        }
    }

    fn tell(&self, shared: &Shared) -> PyResult<()> {
        if let Some(report) = &self.report
            && let Some(Progress { done, rays, elapsed, noise }) = shared.take_progress()
        {
            let error = noise.map(|noise| noise.error);
            report.call1((done, rays, elapsed.as_secs_f64(), error))?;
        }
        Ok(())
    }
}
