//! The window, the only module that depends on a display.
//!
//! `winit` opens windows on X11 and Wayland, and `softbuffer` copies pixels to them. Neither needs a GPU, and
//! both load the display's libraries at run time.

mod files;
mod input;
mod messages;

use self::input::Input;
use super::canvas::Canvas;
use super::content::Content;
use super::events::{Action, Event};
use super::frame_rate::FrameRate;
use super::load::Origin;
use super::loading::Loading;
use super::session;
use super::times::Times;
use super::viewer::Viewer;
use super::worker::{Message, Workers};
use crate::cli::failure::Failure;
use crate::cli::render::RenderSetup;
use softbuffer::{Context, Surface};
use spherule_render::scene::{Scene, Settings};
use std::num::NonZeroU32;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::{Arc, RwLock};
use std::thread::JoinHandle;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};

type Screen = Surface<Rc<Window>, Rc<Window>>;

/// Displays ignore the highest byte, but screenshots may treat it as alpha.
const OPAQUE: u32 = 0xFF00_0000;

struct App {
    viewer: Viewer,
    canvas: Canvas,
    input: Input,
    workers: Workers,
    screen: Option<(Rc<Window>, Screen)>,
    /// The scene to save; `None` until one is loaded.
    scene: Option<Arc<RwLock<Scene>>>,
    /// Source of its spheres, if it has only a sketch of them.
    origin: Option<Origin>,
    /// The last loaded content.
    loaded: Content,
    /// Content to return to if loading fails, if its world was dropped to free memory.
    fallback: Option<Content>,
    setup: Arc<RenderSetup<'static>>,
    savers: Vec<JoinHandle<()>>,
    /// Files that are being written.
    files: u32,
    /// True if the window is closed, and only files are still being written.
    closed: bool,
    notify: Arc<dyn Fn(Message) + Send + Sync>,
    output: PathBuf,
    samples: u32,
    /// True if `--size` was given.
    sized: bool,
    /// True if the image will be saved as soon as it has full size.
    saving: bool,
    times: Times,
    clock: Clock,
    failure: Option<Failure>,
}

/// Times of events, for statistics.
#[derive(Default)]
struct Clock {
    /// Time of the last motion, until a finer image follows.
    moved: Option<Instant>,
    /// Time since which the window has been out of date.
    stale: Option<Instant>,
    /// Version, size and samples of the visible image.
    shown: (u64, (u32, u32), u32),
}

/// Opens a window for the setup's scene, and runs until it is closed.
pub(super) fn run(setup: RenderSetup<'static>, json: bool) -> Result<(), Failure> {
    let events = event_loop()?;
    let proxy = events.create_proxy();
    let output = setup.output.clone();
    let sized = setup.picture.settings.value("size").is_some();
    let sizes = setup.request.settings.iter().filter(|(name, _)| ["size", "dpi"].contains(name));
    let sizes: Vec<_> = sizes.copied().collect();
    let samples = setup.picture.settings.spp().unwrap_or(session::SAMPLES);
    let sender = proxy.clone();
    let name = setup.source.name().into_owned();
    let setup = Arc::new(setup);
    let workers = Workers::start(&setup, move |message| sender.send_event(message).is_ok())?;
    let mut settings = Settings { width: 1280, height: 720, ..Settings::default() };
    settings.change(&sizes);
    let camera = spherule_render::scene::Camera::default();
    let mut app = App {
        viewer: Viewer::new(&camera, &settings, FrameRate::measured()),
        canvas: Canvas::default(),
        input: Input::default(),
        workers,
        screen: None,
        scene: None,
        origin: None,
        loaded: Content::default(),
        fallback: None,
        setup,
        savers: Vec::new(),
        files: 0,
        closed: false,
        notify: Arc::new(move |message| drop(proxy.send_event(message))),
        output,
        samples,
        sized,
        saving: false,
        times: Times::default(),
        clock: Clock::default(),
        failure: None,
    };
    app.viewer.loading = Some(Loading::of(&name));
    app.workers.load(&app.viewer.content);
    let ended = events.run_app(&mut app);
    let opened = app.closed || app.screen.is_some();
    let ended = ended.map_err(|error| if opened { lost() } else { no_display(&error) });
    app.workers.cancel();
    for saver in app.savers.drain(..) {
        // A panic has already been reported.
        let _ = saver.join();
    }
    ended?;
    app.times.print(app.viewer.facts.spheres, json);
    app.failure.map_or(Ok(()), Err)
}

/// Connects to the display. Missing libraries make `winit` panic; this is reported as an error.
fn event_loop() -> Result<EventLoop<Message>, Failure> {
    let hook = take_hook();
    set_hook(Box::new(|_| ()));
    let opened = catch_unwind(AssertUnwindSafe(|| EventLoop::<Message>::with_user_event().build()));
    set_hook(hook);
    match opened {
        Ok(opened) => opened.map_err(|error| no_display(&error)),
        Err(panic) => {
            let why = panic.downcast_ref::<String>().map_or("a library is missing", String::as_str);
            Err(no_display(&why))
        }
    }
}

fn no_display(why: &dyn std::fmt::Display) -> Failure {
    let why = why.to_string();
    // System errors start with a location in the source of `winit`.
    let place = why.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    let why = place.map_or(why.as_str(), |(_, rest)| rest).trim_end_matches('.');
    Failure::Window(format!(
        "cannot open a window: {why}; set DISPLAY or WAYLAND_DISPLAY, or use --headless-script FILE or \
         `spherule render`"
    ))
}

/// Error for a window that is gone without having been closed.
fn lost() -> Failure {
    Failure::Window("the connection to the display was lost".to_owned())
}

fn no_picture(why: &dyn std::fmt::Display) -> Failure {
    Failure::Window(format!("cannot draw to the window: {why}"))
}

impl App {
    fn handle(&mut self, events: &ActiveEventLoop, event: Event) {
        let before = self.viewer.version;
        let action = self.viewer.handle(event);
        if self.viewer.version != before {
            let now = Instant::now();
            self.clock.moved = Some(now);
            self.clock.stale.get_or_insert(now);
        }
        match action {
            None => (),
            Some(Action::Quit) => return self.quit(events),
            Some(Action::Load) => self.load(),
            Some(Action::Save) => {
                self.saving = true;
                self.viewer.show_message("saving when the image has full size");
            }
            Some(Action::Frame(side)) => {
                if let Some(scene) = &self.scene {
                    session::frame(&mut self.viewer, scene, side);
                }
            }
            Some(Action::Pick(pixel, purpose)) => {
                let at = (self.viewer.control.camera.clone(), self.viewer.settings.clone());
                self.workers.pick(at, pixel, purpose);
            }
        }
        self.update();
    }

    /// Requests the viewer's content. A large world is dropped first if it can be read again.
    fn load(&mut self) {
        if self.origin.as_ref().is_some_and(Origin::is_readable) {
            self.fallback = Some(self.loaded.clone());
        }
        if self.fallback.is_some() {
            self.workers.replace(&self.viewer.content);
        } else {
            self.workers.load(&self.viewer.content);
        }
    }

    /// Requests the next image and redraws the window.
    fn update(&mut self) {
        if self.closed {
            return;
        }
        if self.scene.is_some() {
            self.workers.request_image(self.viewer.next_request());
        }
        if self.saving && self.viewer.sampled().is_some() {
            self.saving = false;
            self.save();
        }
        if let Some((window, _)) = &self.screen {
            window.request_redraw();
        }
    }
}

impl App {
    /// Copies the canvas to the window.
    fn redraw(&mut self) -> Result<(), softbuffer::SoftBufferError> {
        let Some((window, screen)) = &mut self.screen else { return Ok(()) };
        self.canvas.draw(&self.viewer);
        let (width, height) = (self.canvas.width, self.canvas.height);
        if let (Some(wide), Some(high)) = (NonZeroU32::new(width), NonZeroU32::new(height)) {
            screen.resize(wide, high)?;
            let mut buffer = screen.buffer_mut()?;
            for (pixel, color) in buffer.iter_mut().zip(&self.canvas.pixels) {
                *pixel = OPAQUE | color;
            }
            window.pre_present_notify();
            buffer.present()?;
            self.record_times();
        }
        Ok(())
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), Failure> {
        let Settings { width, height, .. } = self.viewer.settings;
        let attributes = Window::default_attributes()
            .with_title("Spherule")
            .with_inner_size(PhysicalSize::new(width, height));
        let window = Rc::new(events.create_window(attributes).map_err(|error| no_display(&error))?);
        let context = Context::new(Rc::clone(&window)).map_err(|error| no_display(&error))?;
        let screen =
            Surface::new(&context, Rc::clone(&window)).map_err(|error| no_display(&error))?;
        let size = window.inner_size();
        self.viewer.handle(Event::Resize(size.width, size.height));
        self.viewer.handle(Event::Scale(window.scale_factor()));
        self.screen = Some((window, screen));
        Ok(())
    }
}

impl ApplicationHandler<Message> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.screen.is_none()
            && let Err(failure) = self.open(events)
        {
            self.failure = Some(failure);
            events.exit();
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, message: Message) {
        self.handle_message(events, message);
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if matches!(event, WindowEvent::RedrawRequested) {
            if let Err(error) = self.redraw() {
                self.failure = Some(no_picture(&error));
                events.exit();
            }
        } else if let Some(event) = self.input.event(&event) {
            self.handle(events, event);
        }
    }
}
