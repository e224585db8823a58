//! Distances, angles and dihedrals over the frames of a file, measured beside the view.

use super::client::{Client, Reply};
use super::content::Content;
use super::load::visit_frames;
use serde_json::json;
use spherule_render::compose::Labels;
use spherule_render::scene::Measure;
use spherule_render::scene::particles::Particles;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two messages about values.
const PAUSE: Duration = Duration::from_millis(200);

/// Particles that are measured in each frame.
pub(super) struct Course {
    pub(super) content: Content,
    pub(super) ids: Vec<f64>,
    /// True to take the nearest periodic images.
    pub(super) periodic: bool,
    pub(super) frames: u64,
    pub(super) unit: String,
}

impl Course {
    /// Measures all frames on another thread, until the flag that is returned is set, and tells a page the values.
    pub(super) fn measure(self, client: Arc<Client>) -> Arc<AtomicBool> {
        let cancel = Arc::new(AtomicBool::new(false));
        let own = Arc::clone(&cancel);
        thread::spawn(move || {
            let tell = |message: serde_json::Value| client.reply(Reply::Text(message.to_string()));
            let name = ["distance", "angle", "dihedral"][self.ids.len() - 2];
            let ids: Vec<String> = self.ids.iter().map(f64::to_string).collect();
            let unit = if self.ids.len() == 2 { &*self.unit } else { "°" };
            let title = format!("{name} {}", ids.join("-"));
            let periodic = if self.periodic { ", nearest images" } else { "" };
            tell(
                json!({ "plot": { "title": title + periodic, "unit": unit, "frames": self.frames } }),
            );
            let (mut rows, mut values, mut told) = (Vec::new(), Vec::new(), Instant::now());
            let visited = visit_frames(&self.content, self.frames, |mut particles| {
                values.push(self.value(&mut particles, &mut rows));
                if told.elapsed() >= PAUSE {
                    tell(json!({ "plot": { "values": std::mem::take(&mut values) } }));
                    told = Instant::now();
                }
                !own.load(Ordering::Relaxed)
            });
            if !own.load(Ordering::Relaxed) {
                tell(json!({ "plot": { "values": values, "done": true } }));
                if let Err(failure) = visited {
                    tell(json!({ "error": failure.brief() }));
                }
            }
        });
        cancel
    }

    /// Returns what the particles measure in a frame; `None` if one of them is not there. `rows` are theirs in the frame
    /// before.
    fn value(&self, particles: &mut Particles, rows: &mut Vec<usize>) -> Option<f64> {
        let numbers = std::mem::take(&mut particles.frame.numbers);
        let texts = std::mem::take(&mut particles.frame.texts);
        let labels = Labels { numbers, texts, ..Labels::default() };
        let count = particles.spheres.len();
        let is_at = |row: usize, id: f64| row < count && labels.id(row) == Some(id);
        let same = rows.len() == self.ids.len()
            && rows.iter().zip(&self.ids).all(|(row, id)| is_at(*row, *id));
        if !same {
            let find = |id: &f64| (0..count).find(|&row| is_at(row, *id));
            *rows = self.ids.iter().map(find).collect::<Option<_>>()?;
        }
        let points = rows.iter().map(|row| particles.spheres.center(*row)).collect();
        let measure = Measure { points, unit: String::new() };
        let cell = particles.frame.cell.filter(|_| self.periodic);
        cell.iter().fold(measure, Measure::with_nearest_images).value()
    }
}
