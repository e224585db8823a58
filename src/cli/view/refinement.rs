//! Progressive refinement: the next image, and the noise of the last one.

use super::frame_rate::refined;
use super::image::{Picture, RenderRequest};
use super::tonemap::DisplaySettings;
use super::viewer::Viewer;
use spherule_render::image::Image;
use spherule_render::scene::{SamplerKind, Settings};

/// Number of samples per pixel from which images grow by a constant number of samples, and that number.
const STEP: u32 = 16;

impl Viewer {
    /// Returns the next image to render, unless the current one is finished.
    pub(super) fn next_request(&self) -> Option<RenderRequest> {
        let whole = (self.settings.width, self.settings.height);
        let shown = self.shown.as_ref().filter(|picture| picture.version == self.version);
        let (size, spp) = match shown {
            None => (self.frame_rate.moving(whole), 1),
            Some(picture) if picture.size() != whole => (refined(whole, picture.size()), 1),
            Some(picture) if picture.samples >= self.settings.spp => return None,
            Some(picture) => (whole, self.more(picture.samples)),
        };
        let (width, height) = size;
        Some(RenderRequest {
            version: self.version,
            camera: self.control.camera.clone(),
            settings: Settings { width, height, spp, ..self.settings.clone() },
            look: self.look(),
            display: DisplaySettings::of(&self.settings),
            first: shown.is_none(),
        })
    }

    /// Returns the number of samples of the image after one with `samples`.
    fn more(&self, samples: u32) -> u32 {
        // Strata depend on the number of samples, so each image starts anew.
        let doubled = samples < STEP || self.settings.sampler == SamplerKind::Stratified;
        let more = if doubled { samples } else { STEP - samples % STEP };
        self.settings.spp.min(samples.saturating_add(more))
    }

    /// Shows an image; returns false if it is outdated.
    pub(super) fn accept(&mut self, picture: Picture) -> bool {
        if self.shown.as_ref().is_some_and(|shown| shown.version > picture.version) {
            return false;
        }
        let (width, height) = picture.size();
        // Larger images have less overhead for a camera at rest.
        let first = self.shown.as_ref().is_none_or(|shown| shown.version < picture.version);
        if first && picture.samples == 1 {
            self.frame_rate.record_time(u64::from(width) * u64::from(height), picture.elapsed);
        }
        self.measure(&picture);
        self.shown = Some(picture);
        true
    }

    /// Estimates the noise by the difference to an image of half as many samples. For independent samples,
    /// this difference equals the error of the image; for well-distributed samples the error is smaller.
    fn measure(&mut self, picture: &Picture) {
        let comparable =
            |half: &&Picture| half.version == picture.version && half.size() == picture.size();
        let half = self.half.as_ref().filter(comparable);
        match half {
            None => self.noise = None,
            Some(half) if picture.samples == 2 * half.samples => {
                self.noise = Some(difference(&half.image, &picture.image));
            }
            Some(_) => (),
        }
        if picture.samples.is_power_of_two() {
            self.half = Some(picture.clone());
        }
    }
}

/// Root mean square difference, relative to the mean.
fn difference(a: &Image, b: &Image) -> f64 {
    let channels = || a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    let squares: f64 = channels().map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let (sum, count) = (channels().map(|(_, b)| f64::from(*b)).sum::<f64>(), b.pixels.len() * 3);
    if sum > 0.0 { (squares * count as f64).sqrt() / sum } else { 0.0 }
}
