//! Background threads of a session: one loads scenes, the other renders them.
//!
//! The session waits for neither. The latest request wins: the current render is cancelled by a flag, which is
//! checked for each tile.

use super::content::Content;
use super::events::{Picked, Purpose};
use super::image::{Picture, RenderRequest};
use super::load::{LoadedScene, Loader};
use super::loading::{Loading, Progress, ProgressReporter};
use super::renderer::Renderer;
use crate::cli::failure::Failure;
use crate::cli::render::RenderSetup;
use rayon::ThreadPool;
use spherule_render::scene::particles::Selection;
use spherule_render::scene::{Camera, Settings};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

/// Messages to the session.
pub(super) enum Message {
    /// Progress of loading.
    Loading(Loading),
    /// The number of frames is known.
    Counted(u64),
    /// New content is loaded.
    Loaded(Result<Box<LoadedScene>, Failure>),
    /// A request is done; `None` if it was cancelled, or another one is done in its place.
    Picture(Result<Option<Box<Picture>>, Failure>),
    Picked(Result<Option<Picked>, Failure>, Purpose),
    /// The spheres of conditions, for the page that asked.
    Selected(Result<Vec<Picked>, Failure>, u64),
}

/// A request to load.
struct LoadRequest {
    content: Content,
    /// Closed once the current world is dropped, if it is dropped before loading.
    dropped: Option<Receiver<()>>,
}

/// Tasks of the rendering thread.
enum Task {
    Set(Box<LoadedScene>),
    /// Drops the world, and then the sender.
    Drop(Sender<()>),
    Render(RenderRequest, Arc<AtomicBool>),
    Pick((Camera, Settings), (u32, u32), Purpose),
    Select(Vec<Selection>, u64),
}

/// Handles of the threads.
pub(super) struct Workers {
    requests: Sender<LoadRequest>,
    tasks: Sender<Task>,
    /// The last request, and the flag that cancels it.
    current: Option<(RenderRequest, Arc<AtomicBool>)>,
}

impl Workers {
    /// Starts the threads. They send messages through `notify`, which returns false once the receiver is
    /// gone.
    ///
    /// # Errors
    /// The pools of threads cannot be started.
    pub(super) fn start(
        setup: &RenderSetup,
        notify: impl Fn(Message) -> bool + Clone + Send + 'static,
    ) -> Result<Self, Failure> {
        let (requests, wanted) = channel();
        let (tasks, todo) = channel();
        // A render waits for all threads of its pool, so it has a pool of its own.
        let (loaders, renderers) = (setup.pool()?, setup.pool()?);
        let (tracer, builder) = (setup.tracer, setup.builder(usize::MAX, u64::MAX));
        let loaded = notify.clone();
        let loader = Loader::default();
        let quiet = setup.report.quiet;
        thread::spawn(move || load(&loaders, loader, &wanted, loaded, quiet));
        thread::spawn(move || {
            let renderer = |stage| Renderer::new(stage, tracer, builder);
            render(&renderers, &todo, renderer, notify);
        });
        Ok(Self { requests, tasks, current: None })
    }

    /// Requests content.
    pub(super) fn load(&self, content: &Content) {
        self.request(content, None);
    }

    /// Requests content, to be loaded after the current world is dropped.
    pub(super) fn replace(&mut self, content: &Content) {
        self.cancel();
        let (done, dropped) = channel();
        let _ = self.tasks.send(Task::Drop(done));
        self.request(content, Some(dropped));
    }

    fn request(&self, content: &Content, dropped: Option<Receiver<()>>) {
        // If the receiving thread has ended, the session ends too.
        let _ = self.requests.send(LoadRequest { content: content.clone(), dropped });
    }

    /// Sets the loaded content for rendering.
    pub(super) fn set(&mut self, stage: Box<LoadedScene>) {
        self.cancel();
        let _ = self.tasks.send(Task::Set(stage));
    }

    /// Requests an image. An older request is cancelled, unless it is the first image of its version;
    /// otherwise a moving camera would show nothing.
    ///
    /// Returns whether it is a new one: then [`Message::Picture`] follows.
    pub(super) fn request_image(&mut self, request: Option<RenderRequest>) -> bool {
        match (&request, &self.current) {
            (Some(new), Some((old, _))) if new == old => return false,
            (_, Some((old, _))) if !old.first => self.cancel(),
            _ => (),
        }
        let Some(request) = request else { return false };
        let flag = Arc::new(AtomicBool::new(false));
        let _ = self.tasks.send(Task::Render(request.clone(), Arc::clone(&flag)));
        self.current = Some((request, flag));
        true
    }

    /// Requests picking at a pixel, before rendering continues.
    pub(super) fn pick(&mut self, at: (Camera, Settings), pixel: (u32, u32), purpose: Purpose) {
        self.cancel();
        let _ = self.tasks.send(Task::Pick(at, pixel, purpose));
    }

    /// Requests the spheres of conditions, for a page, before rendering continues.
    pub(super) fn select(&mut self, selections: Vec<Selection>, page: u64) {
        self.cancel();
        let _ = self.tasks.send(Task::Select(selections, page));
    }

    /// Cancels the current render.
    pub(super) fn cancel(&mut self) {
        if let Some((_, flag)) = self.current.take() {
            flag.store(true, Ordering::Relaxed);
        }
    }
}

/// Loads the latest request, in a loop.
fn load(
    pool: &ThreadPool,
    mut loader: Loader,
    wanted: &Receiver<LoadRequest>,
    notify: impl Fn(Message) -> bool + Clone + Send + 'static,
    quiet: bool,
) {
    let mut next = None;
    while let Some(mut request) = next.take().or_else(|| wanted.recv().ok()) {
        if let Some(newest) = wanted.try_iter().last() {
            request = newest;
        }
        let LoadRequest { content, dropped } = request;
        let replaces = dropped.is_some();
        if let Some(dropped) = dropped {
            // Nothing is sent; this waits until the sender is dropped.
            let _ = dropped.recv();
        }
        let progress = Arc::new(Progress::default());
        let send = notify.clone();
        let watch = ProgressReporter::start(&progress, quiet, move |loading| {
            _ = send(Message::Loading(loading));
        });
        let staged = pool.install(|| loader.load(&content, &progress).map(Box::new));
        drop(watch);
        next = wanted.try_iter().last();
        if replaces && next.is_some() {
            // Memory may not be sufficient for two large worlds.
            continue;
        }
        let loaded = staged.is_ok();
        if !notify(Message::Loaded(staged)) {
            return;
        }
        // Long files take seconds, in which the first frame is seen.
        if let Some(count) = loaded.then(|| loader.count()).flatten() {
            let tell = notify.clone();
            thread::spawn(move || count().is_some_and(|frames| tell(Message::Counted(frames))));
        }
    }
}

/// Runs tasks in order, but only the latest of render requests.
fn render(
    pool: &ThreadPool,
    todo: &Receiver<Task>,
    new: impl Fn(LoadedScene) -> Renderer,
    notify: impl Fn(Message) -> bool,
) {
    let mut renderer: Option<Renderer> = None;
    while let Ok(first) = todo.recv() {
        let (mut last, mut left_out) = (None, 0);
        for task in std::iter::once(first).chain(todo.try_iter()) {
            match (task, &mut renderer) {
                (Task::Drop(done), _) => {
                    left_out += usize::from(last.take().is_some());
                    renderer = None;
                    drop(done);
                }
                (Task::Set(stage), None) => renderer = Some(new(*stage)),
                (Task::Set(stage), Some(renderer)) => renderer.set(*stage),
                (Task::Render(request, cancel), _) => {
                    left_out += usize::from(last.replace((request, cancel)).is_some());
                }
                (Task::Pick((camera, settings), pixel, purpose), Some(renderer)) => {
                    let picked = pool.install(|| renderer.pick(&camera, &settings, pixel));
                    if !notify(Message::Picked(picked, purpose)) {
                        return;
                    }
                }
                (Task::Select(selections, page), renderer) => {
                    let select = |renderer: &mut Renderer| renderer.select(&selections);
                    let selected = renderer.as_mut().map(|own| pool.install(|| select(own)));
                    if !notify(Message::Selected(selected.unwrap_or(Ok(Vec::new())), page)) {
                        return;
                    }
                }
                (Task::Pick(..), None) => (),
            }
        }
        let rendered = match (last, &mut renderer) {
            (Some((request, cancel)), Some(renderer)) => {
                Some(pool.install(|| Ok(renderer.render(&request, &cancel)?.map(Box::new))))
            }
            (Some(_), None) => Some(Ok(None)),
            (None, _) => None,
        };
        let skipped = (0..left_out).map(|_| Ok(None));
        if !skipped.chain(rendered).all(|picture| notify(Message::Picture(picture))) {
            return;
        }
    }
}
