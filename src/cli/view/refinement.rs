//! Progressive refinement: the next image.

use super::frame_rate::Moving;
use super::image::{Picture, Quality, RenderRequest};
use super::tonemap::DisplaySettings;
use super::viewer::Viewer;
use spherule_render::scene::{SamplerKind, Settings};
use std::sync::Arc;

/// Samples per pixel of the first image after a preview: denoised, it looks finished.
const FIRST: u32 = 4;

/// Number of samples per pixel from which images grow by a constant number of samples, and that number.
const STEP: u32 = 16;

impl Viewer {
    /// Returns the next image to render, unless the current one is finished.
    pub(super) fn next_request(&self) -> Option<RenderRequest> {
        let size = (self.settings.width, self.settings.height);
        let whole = Moving { size, shadows: true };
        let shown = self.shown.as_ref().filter(|picture| picture.version == self.version);
        let limited = self.is_dragging() && self.most_pixels < u64::MAX;
        let preview = |Moving { size, shadows }| (size, Quality::Preview { shadows }, 1);
        let (size, quality, spp) = match shown {
            None => preview(self.frame_rate.moving(size, self.most_pixels)),
            // On a slow connection, a whole preview would delay the next motion.
            Some(picture) if picture.samples == 0 && picture.moving() != whole && !limited => {
                preview(whole)
            }
            Some(picture) if picture.samples >= self.settings.spp => return None,
            Some(picture) => (size, Quality::Sampled, self.more(picture.samples)),
        };
        let (width, height) = size;
        Some(RenderRequest {
            version: self.version,
            camera: self.control.camera.clone(),
            settings: Settings { width, height, spp, ..self.settings.clone() },
            quality,
            look: self.look(),
            whole: size == whole.size,
            display: DisplaySettings::of(&self.settings),
            first: shown.is_none(),
        })
    }

    /// Returns the number of samples of the image after one with `samples`.
    fn more(&self, samples: u32) -> u32 {
        // Strata depend on the number of samples, so each image starts anew.
        let doubled = samples < STEP || self.settings.sampler == SamplerKind::Stratified;
        let next = match samples {
            0 => FIRST,
            _ if doubled => samples.saturating_mul(2),
            _ => samples.saturating_add(STEP - samples % STEP),
        };
        self.settings.spp.min(next)
    }

    /// Shows an image; returns false if it is outdated.
    pub(super) fn accept(&mut self, picture: Picture) -> bool {
        if self.shown.as_ref().is_some_and(|shown| shown.version > picture.version) {
            return false;
        }
        if let Quality::Preview { shadows } = picture.quality {
            let (width, height) = picture.size();
            let pixels = u64::from(width) * u64::from(height);
            self.frame_rate.record_time(pixels, shadows, picture.elapsed);
        }
        self.shown = Some(Arc::new(picture));
        true
    }
}
