//! What the window's threads tell it.

use super::App;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::view::command::Event;
use crate::cli::view::load::Stage;
use crate::cli::view::session;
use crate::cli::view::worker::News;
use std::sync::Arc;
use std::time::Instant;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;

/// The largest window that a scene asks for, in pixels.
const LARGEST: (u32, u32) = (1600, 1000);

impl App {
    pub(super) fn hear(&mut self, events: &ActiveEventLoop, news: News) {
        if matches!(news, News::Saved(_)) {
            self.saved(events);
        }
        match news {
            News::Loading(loading) => self.viewer.loading = Some(loading),
            News::Staged(Ok(stage)) => self.set(stage),
            News::Staged(Err(failure)) if self.scene.is_none() => {
                self.failure = Some(failure);
                events.exit();
            }
            News::Picture(Ok(None)) => (),
            News::Picture(Ok(Some(picture))) => {
                self.viewer.accept(picture);
            }
            News::Picked(Ok(picked), purpose) => {
                if let Some(line) = session::picked_by(&mut self.viewer, picked, purpose) {
                    if let Some((window, _)) = &self.screen {
                        window.set_title(&format!("{} - {line}", self.viewer.facts.title));
                    }
                    output::print(line);
                }
            }
            News::Saved(Ok(path)) => {
                let scene = path.with_extension("toml");
                output::print(format_args!("{} {}", path.display(), scene.display()));
                self.viewer.say(format!("saved {} and {}", path.display(), scene.display()));
            }
            News::Staged(Err(failure)) => {
                // What is shown is what was loaded last.
                self.viewer.content = self.loaded.clone();
                self.viewer.loading = None;
                self.complain(&failure);
                if let Some(content) = self.fallback.take() {
                    self.workers.load(&content);
                }
            }
            News::Picture(Err(failure))
            | News::Picked(Err(failure), _)
            | News::Saved(Err(failure)) => self.complain(&failure),
        }
        self.go_on();
    }

    fn complain(&mut self, failure: &Failure) {
        let message = match failure {
            Failure::Scene(error) => format!("{}: {}", error.path.display(), error.message),
            other => other.to_string(),
        };
        output::warn(&message);
        self.viewer.say(message);
    }

    /// Shows what was loaded.
    fn set(&mut self, stage: Box<Stage>) {
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

    /// Gives the window the size of the first scene, or the picture that of the window.
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

    /// Takes the time of a picture that has come into the window.
    pub(super) fn take_times(&mut self) {
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
            self.viewer.pace.judge(time);
        }
    }
}
