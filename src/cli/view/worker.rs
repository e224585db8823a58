//! The two threads behind a window: one reads and builds what is to be seen, the other renders it.
//!
//! Neither is waited for. The newest order wins: what is being rendered is cancelled by its flag, at
//! the grain of a tile.

use super::command::Purpose;
use super::content::Content;
use super::load::{Loader, Stage};
use super::loading::{Loading, Progress, Watch};
use super::picture::{Order, Picture};
use super::studio::{Picked, Studio};
use crate::cli::failure::Failure;
use crate::cli::render::Job;
use rayon::ThreadPool;
use spherule::scene::{Camera, Settings};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

/// What a window hears of.
pub(super) enum News {
    /// Progress of loading.
    Loading(Loading),
    /// There is something else to be seen.
    Staged(Result<Box<Stage>, Failure>),
    /// An order is done; nothing if it was cancelled.
    Picture(Result<Option<Picture>, Failure>),
    Picked(Result<Option<Picked>, Failure>, Purpose),
    /// A file is there, or why not.
    Saved(Result<PathBuf, Failure>),
}

/// What is to be loaded.
struct Request {
    content: Content,
    /// Closed once the world that is shown is dropped, if it is dropped before.
    dropped: Option<Receiver<()>>,
}

/// What is to be rendered.
enum Task {
    Set(Box<Stage>),
    /// Drops the world, and then the sender.
    Drop(Sender<()>),
    Expose(Order, Arc<AtomicBool>),
    Pick((Camera, Settings), (u32, u32), Purpose),
}

/// The threads, as the window sees them.
pub(super) struct Workers {
    requests: Sender<Request>,
    tasks: Sender<Task>,
    /// What was ordered last, and the flag that cancels it.
    ordered: Option<(Order, Arc<AtomicBool>)>,
}

impl Workers {
    /// Starts the threads; what they have done they tell by `tell`, which returns false when nobody
    /// listens any more.
    ///
    /// # Errors
    /// The pools of threads cannot be started.
    pub(super) fn start(
        job: &Arc<Job<'static>>,
        tell: impl Fn(News) -> bool + Clone + Send + 'static,
    ) -> Result<Self, Failure> {
        let (requests, wanted) = channel();
        let (tasks, todo) = channel();
        // A render waits for all threads of its pool: it does not share them with a reader.
        let (loaders, renderers) = (job.pool()?, job.pool()?);
        let (tracer, builder) = (job.tracer, job.builder(usize::MAX, u64::MAX));
        let loaded = tell.clone();
        let loader = Loader::new(Arc::clone(job));
        let quiet = job.report.quiet;
        thread::spawn(move || load(&loaders, loader, &wanted, loaded, quiet));
        thread::spawn(move || {
            let studio = |stage| Studio::new(stage, tracer, builder);
            render(&renderers, &todo, studio, tell);
        });
        Ok(Self { requests, tasks, ordered: None })
    }

    /// Has something loaded.
    pub(super) fn load(&self, content: &Content) {
        self.request(content, None);
    }

    /// Has something loaded after the world that is shown has left the memory.
    pub(super) fn replace(&mut self, content: &Content) {
        self.cancel();
        let (done, dropped) = channel();
        let _ = self.tasks.send(Task::Drop(done));
        self.request(content, Some(dropped));
    }

    fn request(&self, content: &Content, dropped: Option<Receiver<()>>) {
        // A thread that does not receive has ended, and so does the window.
        let _ = self.requests.send(Request { content: content.clone(), dropped });
    }

    /// Has pictures made of what was loaded.
    pub(super) fn set(&mut self, stage: Box<Stage>) {
        self.cancel();
        let _ = self.tasks.send(Task::Set(stage));
    }

    /// Has a picture made. An older order is cancelled, unless it is the first picture of what a
    /// moving camera sees: else nothing would be seen of its way.
    pub(super) fn order(&mut self, order: Option<Order>) {
        match (&order, &self.ordered) {
            (Some(new), Some((old, _))) if new == old => return,
            (_, Some((old, _))) if !old.first => self.cancel(),
            _ => (),
        }
        let Some(order) = order else { return };
        let flag = Arc::new(AtomicBool::new(false));
        let _ = self.tasks.send(Task::Expose(order.clone(), Arc::clone(&flag)));
        self.ordered = Some((order, flag));
    }

    /// Asks what is at a pixel: before the picture goes on.
    pub(super) fn pick(&mut self, at: (Camera, Settings), pixel: (u32, u32), purpose: Purpose) {
        self.cancel();
        let _ = self.tasks.send(Task::Pick(at, pixel, purpose));
    }

    /// Cancels what is being rendered.
    pub(super) fn cancel(&mut self) {
        if let Some((_, flag)) = self.ordered.take() {
            flag.store(true, Ordering::Relaxed);
        }
    }
}

/// Loads the newest of what is wanted, again and again.
fn load(
    pool: &ThreadPool,
    mut loader: Loader,
    wanted: &Receiver<Request>,
    tell: impl Fn(News) -> bool + Clone + Send + 'static,
    quiet: bool,
) {
    let mut next = None;
    while let Some(mut request) = next.take().or_else(|| wanted.recv().ok()) {
        if let Some(newest) = wanted.try_iter().last() {
            request = newest;
        }
        let Request { content, dropped } = request;
        let replaces = dropped.is_some();
        if let Some(dropped) = dropped {
            // Nothing is sent: this waits until the sender is gone.
            let _ = dropped.recv();
        }
        let progress = Arc::new(Progress::default());
        let told = tell.clone();
        let watch = Watch::start(&progress, quiet, move |loading| _ = told(News::Loading(loading)));
        let staged = pool.install(|| loader.load(&content, &progress).map(Box::new));
        drop(watch);
        next = wanted.try_iter().last();
        if replaces && next.is_some() {
            // Two large worlds do not fit into the memory of one.
            continue;
        }
        if !tell(News::Staged(staged)) {
            return;
        }
    }
}

/// Does what is to be done in order, but of orders only the newest.
fn render(
    pool: &ThreadPool,
    todo: &Receiver<Task>,
    new: impl Fn(Stage) -> Studio,
    tell: impl Fn(News) -> bool,
) {
    let mut studio: Option<Studio> = None;
    while let Ok(first) = todo.recv() {
        let mut last = None;
        for task in std::iter::once(first).chain(todo.try_iter()) {
            match (task, &mut studio) {
                (Task::Drop(done), _) => {
                    (studio, last) = (None, None);
                    drop(done);
                }
                (Task::Set(stage), None) => studio = Some(new(*stage)),
                (Task::Set(stage), Some(studio)) => studio.set(*stage),
                (Task::Expose(order, cancel), _) => last = Some((order, cancel)),
                (Task::Pick((camera, settings), pixel, purpose), Some(studio)) => {
                    let picked = pool.install(|| studio.pick(&camera, &settings, pixel));
                    if !tell(News::Picked(picked, purpose)) {
                        return;
                    }
                }
                (Task::Pick(..), None) => (),
            }
        }
        if let (Some((order, cancel)), Some(studio)) = (last, &mut studio)
            && !tell(News::Picture(pool.install(|| studio.expose(&order, &cancel))))
        {
            return;
        }
    }
}
