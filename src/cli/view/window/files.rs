//! Files that the window saves, and its end, which they may delay.

use super::App;
use crate::cli::output;
use crate::cli::view::save::{Seen, free_name, save_bar, save_picture, save_scene};
use crate::cli::view::worker::News;
use std::sync::Arc;
use winit::event_loop::ActiveEventLoop;

impl App {
    /// Ends the program; as long as files are still written, only the window.
    pub(super) fn quit(&mut self, events: &ActiveEventLoop) {
        self.workers.cancel();
        if self.files == 0 {
            return events.exit();
        }
        output::note("a picture and its scene are still being saved; Ctrl-C leaves them out");
        (self.screen, self.closed) = (None, true);
    }

    /// Takes note of a file that is there, or is never going to be.
    pub(super) fn saved(&mut self, events: &ActiveEventLoop) {
        self.files -= 1;
        if self.closed && self.files == 0 {
            events.exit();
        }
    }

    /// Saves picture and scene in a thread of its own: large scenes take seconds.
    pub(super) fn save(&mut self) {
        let (Some(scene), Some(picture), Some(settings)) =
            (&self.scene, self.viewer.whole(), self.viewer.settings_of_picture())
        else {
            return;
        };
        let (scene, picture, path) = (Arc::clone(scene), picture.clone(), free_name(&self.output));
        let (title, camera) = (self.viewer.facts.title.clone(), self.viewer.rig.camera.clone());
        let (tell, look) = (Arc::clone(&self.tell), self.viewer.look());
        let (job, origin) = (Arc::clone(&self.job), self.origin.clone());
        let facts = self.viewer.facts.clone();
        self.viewer.say(format!("saving {}", path.display()));
        let saver = std::thread::spawn(move || {
            let (image, matte) = picture.seen();
            let (title, camera, settings) = (&*title, &camera, &settings);
            let seen = Seen { title, camera, settings, look, image, matte };
            let toml = path.with_extension("toml");
            let saved = save_picture(&seen, &path)
                .and_then(|()| save_bar(&job, &facts, settings.height))
                .and_then(|()| save_scene(&seen, &scene, origin.as_ref(), &toml));
            tell(News::Saved(saved.map(|()| path)));
        });
        self.savers.push(saver);
        self.files += 1;
    }
}
