//! Which picture comes next, and how good the last one is.

use super::develop::Print;
use super::pace::refined;
use super::picture::{Order, Picture};
use super::viewer::Viewer;
use spherule::image::Image;
use spherule::scene::{SamplerKind, Settings};

/// From so many samples of a pixel on, each picture has so many more.
const STEP: u32 = 16;

impl Viewer {
    /// The next picture to be rendered, if there is still something to gain.
    pub(super) fn order(&self) -> Option<Order> {
        let whole = (self.settings.width, self.settings.height);
        let shown = self.shown.as_ref().filter(|picture| picture.version == self.version);
        let (size, spp) = match shown {
            None => (self.pace.moving(whole), 1),
            Some(picture) if picture.size() != whole => (refined(whole, picture.size()), 1),
            Some(picture) if picture.samples >= self.settings.spp => return None,
            Some(picture) => (whole, self.more(picture.samples)),
        };
        let (width, height) = size;
        Some(Order {
            version: self.version,
            camera: self.rig.camera.clone(),
            settings: Settings { width, height, spp, ..self.settings.clone() },
            look: self.look(),
            print: Print::of(&self.settings),
            first: shown.is_none(),
        })
    }

    /// How many samples the picture has that follows one of so many.
    fn more(&self, samples: u32) -> u32 {
        // Strata are those of the number of samples: each picture begins anew.
        let doubled = samples < STEP || self.settings.sampler == SamplerKind::Stratified;
        let more = if doubled { samples } else { STEP - samples % STEP };
        self.settings.spp.min(samples.saturating_add(more))
    }

    /// Takes in a picture; false if something newer is shown already.
    pub(super) fn accept(&mut self, picture: Picture) -> bool {
        if self.shown.as_ref().is_some_and(|shown| shown.version > picture.version) {
            return false;
        }
        let (width, height) = picture.size();
        // Larger ones of a camera at rest waste less on what every picture takes.
        let first = self.shown.as_ref().is_none_or(|shown| shown.version < picture.version);
        if first && picture.samples == 1 {
            self.pace.learn(u64::from(width) * u64::from(height), picture.elapsed);
        }
        self.measure(&picture);
        self.shown = Some(picture);
        true
    }

    /// Estimates the noise by the difference to a picture of half as many samples, whose other half
    /// are independent of them: what a picture differs by from its half, it differs by from its
    /// limit. Well-distributed samples do better than that.
    fn measure(&mut self, picture: &Picture) {
        let alike =
            |half: &&Picture| half.version == picture.version && half.size() == picture.size();
        let half = self.half.as_ref().filter(alike);
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

/// Root of the mean squared difference, by the mean.
fn difference(a: &Image, b: &Image) -> f64 {
    let channels = || a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    let squares: f64 = channels().map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let (sum, count) = (channels().map(|(_, b)| f64::from(*b)).sum::<f64>(), b.pixels.len() * 3);
    if sum > 0.0 { (squares * count as f64).sqrt() / sum } else { 0.0 }
}
