//! Reference images, rendered once and cached.

use super::cache;
use crate::bench::BenchError;
use crate::bench::scenes::NamedScene;
use spherule_render::image::Image;
use spherule_render::render::{self, render};
use spherule_render::scene::Settings;
use spherule_render::world::World;
use std::path::Path;

/// Offset in the denominator of relative errors, as in [`compare`](spherule_render::image::compare()).
const EPSILON: f64 = 1e-2;

/// Seeds of the halves, which nothing else uses.
const SEEDS: [u64; 2] = [0x7265_6665_7265_6e63, 0x7265_6665_7265_6e64];

/// A converged image, and an estimate of its error.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The mean of both halves.
    pub mean: Image,
    /// Estimate of the mean squared error of `mean`.
    pub error: SquaredError,
    /// Samples per pixel of each half.
    pub samples: u32,
}

/// Mean squared errors over all finite values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredError {
    /// In linear radiance, squared.
    pub absolute: f64,
    /// Each divided by the square of the reference plus 0.01.
    pub relative: f64,
}

impl Reference {
    /// Renders both halves with `samples` per pixel each, or reads them from the folder.
    ///
    /// # Errors
    /// An image cannot be rendered or written.
    pub fn new(
        scene: &NamedScene,
        world: &World,
        samples: u32,
        folder: Option<&Path>,
    ) -> Result<Self, BenchError> {
        let own = &scene.scene.settings;
        let image =
            |settings: &Settings| Ok(render(world, settings, &render::Options::default())?.image);
        let sample = folder.map(|_| image(&Settings { spp: 1, ..own.clone() })).transpose()?;
        let half = |seed: u64| {
            let settings = Settings { spp: samples, seed, ..own.clone() };
            match folder.zip(sample.as_ref()) {
                Some((folder, sample)) => {
                    cache::load_or_render(folder, scene, &settings, sample, || image(&settings))
                }
                None => image(&settings),
            }
        };
        let [first, second] = [half(SEEDS[0])?, half(SEEDS[1])?];
        let mut mean = first.clone();
        for (pixel, other) in mean.pixels.iter_mut().zip(&second.pixels) {
            *pixel = std::array::from_fn(|i| f32::midpoint(pixel[i], other[i]));
        }
        // The error of the mean is half the sum of two independent errors; the halves differ by their
        // difference. So the mean squares differ by a factor of 4.
        let SquaredError { absolute, relative } = squares(&first, &second, &mean);
        let error = SquaredError { absolute: absolute / 4.0, relative: relative / 4.0 };
        Ok(Self { mean, error, samples })
    }

    /// Returns the root mean squared error relative to the mean radiance, as in [`Settings::until_error`].
    pub fn relative_to_mean(&self, squares: SquaredError) -> f64 {
        let values = self.mean.pixels.iter().flatten().map(|&value| f64::from(value));
        squares.absolute.sqrt() * 3.0 * self.mean.pixels.len() as f64 / values.sum::<f64>()
    }

    /// Returns the error of an image relative to the reference.
    pub fn squares(&self, image: &Image) -> SquaredError {
        squares(image, &self.mean, &self.mean)
    }
}

/// Returns the mean squared difference of two images; the relative one is in relation to a third.
fn squares(a: &Image, b: &Image, by: &Image) -> SquaredError {
    let values = |image: &Image| image.pixels.clone().into_flattened();
    let mut sums = (0_u64, SquaredError::default());
    for ((a, b), by) in values(a).into_iter().zip(values(b)).zip(values(by)) {
        let square = (f64::from(a) - f64::from(b)).powi(2);
        if square.is_finite() {
            sums.0 += 1;
            sums.1.absolute += square;
            sums.1.relative += square / (f64::from(by).powi(2) + EPSILON);
        }
    }
    let count = sums.0.max(1) as f64;
    SquaredError { absolute: sums.1.absolute / count, relative: sums.1.relative / count }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::image::compare;

    #[test]
    fn errors_are_those_of_comparisons() {
        let image = |values: &[f32]| {
            let pixels = values.iter().map(|&x| [x, 2.0 * x, 0.5]).collect();
            Image::new(2, 2, pixels).unwrap()
        };
        let (a, b) = (image(&[0.1, 0.5, 2.0, 0.0]), image(&[0.2, 0.4, 1.5, 0.25]));
        let (found, expected) = (squares(&a, &b, &b), compare(&a, &b).unwrap());
        assert!((found.absolute.sqrt() - expected.rmse).abs() < 1e-12);
        assert!((found.relative - expected.relative_mse).abs() < 1e-12);
    }

    #[test]
    fn the_halves_estimate_the_error_of_their_mean() {
        let scene = NamedScene::named("field").unwrap().resized(32);
        let world = scene.world().unwrap();
        let converged = Reference::new(&scene, &world, 1024, None).unwrap();
        let rough = Reference::new(&scene, &world, 8, None).unwrap();
        assert!(converged.error.absolute < rough.error.absolute / 50.0);
        let ratio = converged.squares(&rough.mean).absolute / rough.error.absolute;
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
    }
}
