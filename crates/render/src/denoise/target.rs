//! Renders whose denoised picture has an error target.

use super::{Denoised, denoise, error_of, is_better};
use crate::film::{Film, Region};
use crate::layers::{Layers, ProgressiveLayers, SAMPLES};
use crate::noise::{self, Estimate, Noise};
use crate::render::{Options, RenderError, Statistics};
use crate::settings::Settings;
use crate::world::World;
use std::ops::RangeInclusive;
use std::sync::{Mutex, PoisonError};

/// Error of the denoised picture at which a render stops if nothing else is said: 1 %.
pub const MAX_ERROR: f64 = 0.01;

/// Cost of the samples of a picture of a thousand spheres that some ten seconds of a laptop pay for, in samples.
const BUDGET: f64 = (1 << 25) as f64;

/// Binary logarithm of the number of spheres that have unit cost, and the power of it that costs grow with.
const UNIT_COST: (f64, i32) = (10.0, 3);

/// Range of the number of samples per pixel where the render stops if its error is not met.
const LIMITS: RangeInclusive<f64> = 16.0..=1024.0;

/// Returns the maximum number of samples per pixel of a render that nothing but [`MAX_ERROR`] stops: by the size of the
/// picture and the number of spheres alone, so that it is the same on all machines.
pub fn max_samples(region: Region, spheres: usize) -> u32 {
    let depth = f64::from((spheres.max(1) as u64).ilog2() + 1);
    let cost = (depth / UNIT_COST.0).max(1.0).powi(UNIT_COST.1);
    let samples = BUDGET / (cost * region.area() as f64);
    samples.clamp(*LIMITS.start(), *LIMITS.end()) as u32
}

/// Denoises a render, as it is refined, and measures the error of the result.
pub struct Denoiser<'a> {
    world: &'a World,
    settings: &'a Settings,
    options: Options<'a>,
    choice: Choice,
    progress: Mutex<Progress>,
}

/// Layers accumulated and the last result.
struct Progress {
    layers: ProgressiveLayers,
    /// The last result, and the number of samples that it was made from.
    last: Option<(u64, Judged)>,
}

/// When the denoised picture is preferred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Always.
    Always,
    /// If that lowers the measured error.
    Better,
}

/// A picture whose error is measured, denoised or not.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The denoised picture, if it is preferred.
    pub denoised: Option<Denoised>,
    /// Error of the picture as it was rendered.
    pub before: Noise,
    /// Error of the preferred picture.
    pub noise: Noise,
}

impl<'a> Denoiser<'a> {
    /// Creates the denoiser of renders of `world` with these settings and options, whose flag cancels it.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn new(
        world: &'a World,
        settings: &'a Settings,
        options: &Options<'a>,
        choice: Choice,
    ) -> Result<Self, RenderError> {
        let layers = ProgressiveLayers::begin(world, settings, options)?;
        let progress = Mutex::new(Progress { layers, last: None });
        Ok(Self { world, settings, options: *options, choice, progress })
    }

    /// Denoises the picture of a film that has statistics, without regard to the flag that cancels. Returns `None` if
    /// not all pixels have samples.
    ///
    /// # Panics
    /// The film is of another region, or without sums of squares.
    pub fn finish(&self, film: &Film) -> Option<Judged> {
        self.denoise(film, &Options { cancel: None, ..self.options })
    }

    fn denoise(&self, film: &Film, options: &Options) -> Option<Judged> {
        let least = film.tiles.iter().map(|tile| tile.samples).min().filter(|&least| least > 0)?;
        // A thread that panicked with the lock has ended the render.
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let total = film.tiles.iter().map(|tile| u64::from(tile.samples) * u64::from(tile.len()));
        let total = total.sum();
        if let Some((_, judged)) = progress.last.as_ref().filter(|(of, _)| *of == total) {
            return Some(judged.clone());
        }
        let settings = Settings { spp: least.min(SAMPLES), ..self.settings.clone() };
        if !progress.layers.refine(self.world, &settings, options) {
            return None;
        }
        let judged = self.judge_picture(film, &progress.layers.layers());
        progress.last = Some((total, judged.clone()));
        Some(judged)
    }

    fn judge_picture(&self, film: &Film, layers: &Layers) -> Judged {
        let image = film.resolve();
        let denoised = denoise(&image, &Statistics::of(film), layers);
        let mean = Estimate { value: film.mean(), ..Estimate::default() };
        let before = Noise::new(noise::squared_error(film), film.pixels(), mean);
        if self.choice == Choice::Better && !is_better(film, &image, &denoised.image) {
            return Judged { denoised: None, before, noise: before };
        }
        let noise = error_of(film, &denoised);
        Judged { denoised: Some(denoised), before, noise }
    }

    /// Returns the error of the preferred picture: see [`Options::judge`].
    pub fn judge(&self, film: &Film) -> Option<Noise> {
        self.denoise(film, &self.options).map(|judged| judged.noise)
    }
}
