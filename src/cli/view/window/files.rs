//! Saving of files from the window, and closing it after they are written.

use super::App;
use crate::cli::output;
use crate::cli::view::save::{SavedImage, free_name, save_bar, save_picture, save_scene};
use crate::cli::view::worker::Message;
use std::sync::Arc;
use winit::event_loop::ActiveEventLoop;

impl App {
    /// Closes the window, and ends the program once all files are written.
    pub(super) fn quit(&mut self, events: &ActiveEventLoop) {
        self.workers.cancel();
        if self.files == 0 {
            return events.exit();
        }
        output::note("still saving an image and its scene; press Ctrl-C to discard them");
        (self.screen, self.closed) = (None, true);
    }

    /// Records that a file was written or failed.
    pub(super) fn saved(&mut self, events: &ActiveEventLoop) {
        self.files -= 1;
        if self.closed && self.files == 0 {
            events.exit();
        }
    }

    /// Saves image and scene in a separate thread, because large scenes take seconds.
    pub(super) fn save(&mut self) {
        let (Some(scene), Some(picture), Some(settings)) =
            (&self.scene, self.viewer.sampled(), self.viewer.settings_of_picture())
        else {
            return;
        };
        let (scene, picture, path) = (Arc::clone(scene), picture.clone(), free_name(&self.output));
        let (title, camera) = (self.viewer.facts.title.clone(), self.viewer.control.camera.clone());
        let (notify, look) = (Arc::clone(&self.notify), self.viewer.look());
        let (setup, origin) = (Arc::clone(&self.setup), self.origin.clone());
        let facts = self.viewer.facts.clone();
        self.viewer.show_message(format!("saving {}", path.display()));
        let saver = std::thread::spawn(move || {
            let (title, camera, settings) = (&*title, &camera, &settings);
            let seen = SavedImage { title, camera, settings, look, picture: &picture };
            let toml = path.with_extension("toml");
            let saved = save_picture(&seen, &path)
                .and_then(|()| save_bar(&setup, &facts, settings))
                .and_then(|()| save_scene(&seen, &scene, origin.as_ref(), &toml));
            notify(Message::Saved(saved.map(|()| path)));
        });
        self.savers.push(saver);
        self.files += 1;
    }
}
