//! Handling of messages from the window's threads.

use super::App;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::view::events::Event;
use crate::cli::view::load::LoadedScene;
use crate::cli::view::session;
use crate::cli::view::worker::Message;
use std::sync::Arc;
use std::time::Instant;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;

/// Maximum size of a window for a scene, in pixels.
const LARGEST: (u32, u32) = (1600, 1000);

impl App {
    pub(super) fn handle_message(&mut self, events: &ActiveEventLoop, message: Message) {
        if matches!(message, Message::Saved(_)) {
            self.saved(events);
        }
        match message {
            Message::Loading(loading) => self.viewer.loading = Some(loading),
            Message::Loaded(Ok(stage)) => self.set(stage),
            Message::Loaded(Err(failure)) if self.scene.is_none() => {
                self.failure = Some(failure);
                events.exit();
            }
            Message::Picture(Ok(None)) => (),
            Message::Picture(Ok(Some(picture))) => {
                self.viewer.accept(picture);
            }
            Message::Picked(Ok(picked), purpose) => {
                if let Some(line) = session::picked_by(&mut self.viewer, picked, purpose) {
                    if let Some((window, _)) = &self.screen {
                        window.set_title(&format!("{} - {line}", self.viewer.facts.title));
                    }
                    output::print(line);
                }
            }
            Message::Saved(Ok(path)) => {
                let scene = path.with_extension("toml");
                output::print(format_args!("{} {}", path.display(), scene.display()));
                self.viewer.show_message(format!(
                    "saved {} and {}",
                    path.display(),
                    scene.display()
                ));
            }
            Message::Loaded(Err(failure)) => {
                // The visible content is the last loaded one.
                self.viewer.content = self.loaded.clone();
                self.viewer.loading = None;
                self.show_error(&failure);
                if let Some(content) = self.fallback.take() {
                    self.workers.load(&content);
                }
            }
            Message::Picture(Err(failure))
            | Message::Picked(Err(failure), _)
            | Message::Saved(Err(failure)) => self.show_error(&failure),
        }
        self.update();
    }

    fn show_error(&mut self, failure: &Failure) {
        let message = match failure {
            Failure::Scene(error) => format!("{}: {}", error.path.display(), error.message),
            other => other.to_string(),
        };
        output::warn(&message);
        self.viewer.show_message(message);
    }

    /// Shows loaded content.
    fn set(&mut self, stage: Box<LoadedScene>) {
        stage.warnings.iter().for_each(output::warn);
        let size = (self.viewer.settings.width, self.viewer.settings.height);
        if self.scene.is_none() {
            session::begin(&mut self.viewer, &stage, self.samples);
            self.resize(size);
        } else {
            self.viewer.loaded(stage.facts.clone());
        }
        if let Some((window, _)) = &self.screen {
            window.set_title(&self.viewer.facts.title);
        }
        self.scene = Some(Arc::clone(&stage.scene));
        self.origin.clone_from(&stage.origin);
        self.loaded.clone_from(&stage.content);
        self.fallback = None;
        self.workers.set(stage);
    }

    /// Resizes the window to the first scene, or the image to the window.
    fn resize(&mut self, now: (u32, u32)) {
        let settings = &mut self.viewer.settings;
        let wanted = (settings.width, settings.height);
        (settings.width, settings.height) = now;
        let fits = wanted.0 <= LARGEST.0 && wanted.1 <= LARGEST.1;
        if let Some((window, _)) = self.screen.as_ref().filter(|_| fits && !self.sized) {
            let granted = window.request_inner_size(PhysicalSize::new(wanted.0, wanted.1));
            if let Some(size) = granted {
                self.viewer.handle(Event::Resize(size.width, size.height));
            }
        }
    }

    /// Records the time at which an image appeared in the window.
    pub(super) fn record_times(&mut self) {
        let Some(picture) = &self.viewer.shown else { return };
        let (now, clock) = (Instant::now(), &mut self.clock);
        let shown =
            std::mem::replace(&mut clock.shown, (picture.version, picture.size(), picture.samples));
        if shown == clock.shown {
            return;
        }
        let (first, newest) = (shown.0 < picture.version, picture.version == self.viewer.version);
        if newest && !first {
            self.times.rest.extend(clock.moved.take().map(|moved| now - moved));
        }
        let stale = std::mem::replace(&mut clock.stale, (!newest).then_some(now));
        if let Some(time) = stale.filter(|_| first && self.viewer.is_dragging()) {
            let time = now - time;
            self.times.moving.push(time);
            self.viewer.frame_rate.record_interval(time);
        }
    }
}
