//! Renders whose denoised image has an error target.

use super::features::MissingFeatures;
use super::{Denoised, denoise_until, error_of, is_worse};
use crate::film::{Film, Region};
use crate::layers::Layers;
use crate::noise::{self, Estimate, Noise};
use crate::render::{self, Options, RenderError, Statistics};
use crate::scene::{Material, NamedMaterial};
use crate::settings::Settings;
use crate::world::World;
use std::ops::RangeInclusive;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Error of the denoised image at which a render stops if nothing else is said: 1 %.
pub const MAX_ERROR: f64 = 0.01;

/// Cost of the samples of an image of a thousand spheres that some ten seconds of a laptop pay for, in samples.
const BUDGET: f64 = (1 << 25) as f64;

/// Factor of the same for scenes whose surfaces are all diffuse: their paths take a third of the time of those of the
/// default field.
const DIFFUSE: f64 = 2.75;

/// Cost of a sample among translucent bodies, whose rays find all of them on their way, relative to one among opaque ones: 3.5 to
/// 6.8 with the presets `ghost` and `x-ray` beside `figure`, in two proteins and a lipid bilayer.
const TRANSLUCENT: f64 = 4.0;

/// Binary logarithm of the number of spheres that have unit cost, and the power of it that costs grow with.
const UNIT_COST: (f64, i32) = (10.0, 3);

/// Range of the number of samples per pixel where the render stops if its error is not met.
const LIMITS: RangeInclusive<f64> = 16.0..=1024.0;

/// Returns the maximum number of samples per pixel of a render that nothing but [`MAX_ERROR`] stops: by the size of the
/// image, the number of spheres and the kinds of materials alone, so that it is the same on all machines.
pub fn max_samples(region: Region, spheres: usize, materials: &[NamedMaterial]) -> u32 {
    let depth = f64::from((spheres.max(1) as u64).ilog2() + 1);
    let cost = (depth / UNIT_COST.0).max(1.0).powi(UNIT_COST.1);
    let is_diffuse = |row: &NamedMaterial| {
        matches!(row.material.surface(), Material::Lambertian { .. } | Material::Emitter { .. })
    };
    let budget = if materials.iter().all(is_diffuse) { BUDGET * DIFFUSE } else { BUDGET };
    let translucent = materials.iter().any(|row| row.material.opacity() < 1.0);
    let budget = if translucent { budget / TRANSLUCENT } else { budget };
    let samples = budget / (cost * region.area() as f64);
    samples.clamp(*LIMITS.start(), *LIMITS.end()) as u32
}

/// Numbers of samples per pixel of the frames of a trajectory whose surfaces scatter light widely, that are translucent, or that
/// reflect or refract.
const TRAJECTORY: [u32; 3] = [32, 64, 128];

/// Returns the number of samples per pixel of each frame of a trajectory: by the size of the image, the number of particles in the
/// first frame and the kinds of materials alone, so that it is the same in all frames.
pub fn trajectory_samples(region: Region, spheres: usize, materials: &[NamedMaterial]) -> u32 {
    let samples = |row: &NamedMaterial| match row.material.surface() {
        Material::Conductor { .. } | Material::Dielectric { .. } | Material::Reflective { .. } => {
            TRAJECTORY[2]
        }
        _ if row.material.opacity() < 1.0 => TRAJECTORY[1],
        _ => TRAJECTORY[0],
    };
    let samples = materials.iter().map(samples).max().unwrap_or(TRAJECTORY[0]);
    samples.min(max_samples(region, spheres, materials))
}

/// Denoises a render, as it is refined, and measures the error of the result.
pub struct Denoiser {
    choice: Choice,
    progress: Mutex<Progress>,
}

/// Features that films have not recorded, and the last result.
struct Progress {
    missing: MissingFeatures,
    /// The last result, unless it was returned, and the number of samples that it was made from.
    last: Option<(u64, Judged)>,
}

/// When the denoised image is preferred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Always.
    Always,
    /// Unless the measured error rises by it, more than by chance.
    UnlessWorse,
}

/// An image whose error is measured, denoised or not.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The denoised image, if it is preferred.
    pub denoised: Option<Denoised>,
    /// Error of the image as it was rendered.
    pub before: Noise,
    /// Error of the preferred image.
    pub noise: Noise,
}

impl Denoiser {
    /// Estimates the bytes of denoising a region, beside those of its film: features and their sums, and the denoised
    /// image with its error.
    pub fn bytes(region: Region) -> u64 {
        let denoised = size_of::<[f32; 3]>() + size_of::<f32>();
        let pixels = u64::from(region.width) * u64::from(region.height);
        MissingFeatures::bytes(region) + Layers::bytes(region) + pixels * denoised as u64
    }

    /// Creates the denoiser of renders of `world` with these settings, in the region of `options`.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn new(
        world: &World,
        settings: &Settings,
        options: &Options,
        choice: Choice,
    ) -> Result<Self, RenderError> {
        render::check(world, settings, options)?;
        let missing = MissingFeatures::new(settings);
        Ok(Self { choice, progress: Mutex::new(Progress { missing, last: None }) })
    }

    /// Denoises the image of a film that has statistics, and judges it; with less than two samples per pixel the
    /// variance is unknown, and the image stays as it is. Returns `None` if not all pixels have samples, or if the
    /// flag of the options cancels it. `world` must be that of the beginning.
    ///
    /// # Panics
    /// The film is of another region, or without sums of squares.
    pub fn judge(&self, world: &World, film: &Film, options: &Options) -> Option<Judged> {
        let mut progress = self.update(world, film, options)?;
        progress.last.take().map(|(_, judged)| judged)
    }

    /// Returns the error of the image that [`Denoiser::judge`] returns, which is kept for it.
    ///
    /// # Panics
    /// The same.
    pub fn noise(&self, world: &World, film: &Film, options: &Options) -> Option<Noise> {
        let progress = self.update(world, film, options)?;
        progress.last.as_ref().map(|(_, judged)| judged.noise)
    }

    /// Makes the last result that of this film.
    fn update(
        &self,
        world: &World,
        film: &Film,
        options: &Options,
    ) -> Option<MutexGuard<'_, Progress>> {
        let least = film.tiles.iter().map(|tile| tile.samples).min().filter(|&least| least > 0)?;
        // A thread that panicked with the lock has ended the render.
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let total = film.tiles.iter().map(|tile| u64::from(tile.samples) * u64::from(tile.len()));
        let total = total.sum();
        if progress.last.as_ref().is_some_and(|(of, _)| *of == total) {
            return Some(progress);
        }
        let mean = Estimate { value: film.mean(), ..Estimate::default() };
        let before = Noise::new(noise::squared_error(film), film.pixels(), mean);
        if least == 1 {
            progress.last = Some((total, Judged { denoised: None, before, noise: before }));
            return Some(progress);
        }
        if !progress.missing.trace(world, film, options) {
            return None;
        }
        let layers = progress.missing.layers(film, options);
        let judged = self.judge_picture(film, mean, &layers, before, options)?;
        progress.last = Some((total, judged));
        Some(progress)
    }

    fn judge_picture(
        &self,
        film: &Film,
        mean: Estimate,
        layers: &Layers,
        before: Noise,
        options: &Options,
    ) -> Option<Judged> {
        let go_on = || (!options.is_cancelled()).then_some(());
        go_on()?;
        let image = film.resolve();
        go_on()?;
        let statistics = Statistics::of(film, options);
        go_on()?;
        let mut denoised = Denoised::black(image.width, image.height);
        denoise_until(&image, &statistics, layers, options, &mut denoised).then_some(())?;
        if self.choice == Choice::UnlessWorse && is_worse(film, &image, &denoised.image) {
            return Some(Judged { denoised: None, before, noise: before });
        }
        go_on()?;
        let noise = error_of(film, mean, &denoised);
        Some(Judged { denoised: Some(denoised), before, noise })
    }
}
