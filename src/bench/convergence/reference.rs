//! Pictures that others are held against, rendered once and kept.

use super::cache;
use crate::bench::BenchError;
use crate::bench::scenes::NamedScene;
use crate::image::Image;
use crate::render::{self, render};
use crate::scene::Settings;
use crate::world::World;
use std::path::Path;

/// Added to squares of the reference where errors are divided by them: as in
/// [`compare`](crate::image::compare()).
const EPSILON: f64 = 1e-2;

/// Seeds of the halves: none that anything else uses.
const SEEDS: [u64; 2] = [0x7265_6665_7265_6e63, 0x7265_6665_7265_6e64];

/// A converged picture, and how far from the truth it is.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The mean of both halves.
    pub mean: Image,
    /// Its own mean squared errors: an estimate.
    pub error: Squares,
    /// Samples per pixel of each half.
    pub samples: u32,
}

/// Mean squared errors over all values that are finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Squares {
    /// In squares of linear radiance.
    pub absolute: f64,
    /// Each divided by the square of the reference and 0.01.
    pub relative: f64,
}

impl Reference {
    /// Renders both halves, `samples` per pixel each, or takes what is kept in the folder.
    ///
    /// # Errors
    /// The halves cannot be kept.
    pub fn of(
        scene: &NamedScene,
        world: &World,
        samples: u32,
        folder: Option<&Path>,
    ) -> Result<Self, BenchError> {
        let own = &scene.scene.settings;
        let picture =
            |settings: &Settings| Ok(render(world, settings, &render::Options::default())?.image);
        let sample = folder.map(|_| picture(&Settings { spp: 1, ..own.clone() })).transpose()?;
        let half = |seed: u64| {
            let settings = Settings { spp: samples, seed, ..own.clone() };
            match folder.zip(sample.as_ref()) {
                Some((folder, sample)) => {
                    cache::kept(folder, scene, (&settings, sample), || picture(&settings))
                }
                None => picture(&settings),
            }
        };
        let [first, second] = [half(SEEDS[0])?, half(SEEDS[1])?];
        let mut mean = first.clone();
        for (pixel, other) in mean.pixels.iter_mut().zip(&second.pixels) {
            *pixel = std::array::from_fn(|i| f32::midpoint(pixel[i], other[i]));
        }
        // The mean is off by half the sum of two independent errors, the halves differ by the
        // difference of the same two: both have the same mean square, but for the factor of 4.
        let Squares { absolute, relative } = squares(&first, &second, &mean);
        let error = Squares { absolute: absolute / 4.0, relative: relative / 4.0 };
        Ok(Self { mean, error, samples })
    }

    /// The root of mean squares by the mean radiance: what [`Settings::until_error`] is about.
    pub fn relative_to_mean(&self, squares: Squares) -> f64 {
        let values = self.mean.pixels.iter().flatten().map(|&value| f64::from(value));
        squares.absolute.sqrt() * 3.0 * self.mean.pixels.len() as f64 / values.sum::<f64>()
    }

    /// How far a picture is from the reference.
    pub fn squares(&self, image: &Image) -> Squares {
        squares(image, &self.mean, &self.mean)
    }
}

/// Mean squares of differences, relative ones by the squares of a third picture.
fn squares(a: &Image, b: &Image, by: &Image) -> Squares {
    let values = |image: &Image| image.pixels.clone().into_flattened();
    let mut sums = (0_u64, Squares::default());
    for ((a, b), by) in values(a).into_iter().zip(values(b)).zip(values(by)) {
        let square = (f64::from(a) - f64::from(b)).powi(2);
        if square.is_finite() {
            sums.0 += 1;
            sums.1.absolute += square;
            sums.1.relative += square / (f64::from(by).powi(2) + EPSILON);
        }
    }
    let count = sums.0.max(1) as f64;
    Squares { absolute: sums.1.absolute / count, relative: sums.1.relative / count }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::compare;

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
    fn the_halves_tell_the_error_of_their_mean() {
        let scene = NamedScene::named("field").unwrap().resized(32);
        let world = scene.world().unwrap();
        let truth = Reference::of(&scene, &world, 1024, None).unwrap();
        let rough = Reference::of(&scene, &world, 8, None).unwrap();
        assert!(truth.error.absolute < rough.error.absolute / 50.0);
        let off = truth.squares(&rough.mean).absolute / rough.error.absolute;
        assert!((0.5..2.0).contains(&off), "{off}");
    }
}
