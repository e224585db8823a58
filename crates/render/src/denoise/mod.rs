//! Denoising: local regression of radiance on features that have no noise of light.
//!
//! The filter is that of [`spherule_denoise`].
//!
//! # The stated error
//!
//! The error by which the filter chooses windows does not judge. The error of the denoised image, bias included, is measured by
//! [`Probes`](crate::film::Probes): the means `a` and `b` of a probe's two streams are independent of each other and of
//! the denoised pixel `d`, so the expectation of `(d - a)(d - b)` is the squared error of `d`.
//! [`crate::noise`] has the bound.

mod choose;
mod features;
mod target;

pub use choose::{Asked, choose};
pub use target::{Choice, Denoiser, Judged, MAX_ERROR, max_samples, trajectory_samples};

pub use spherule_denoise::Denoised;

use crate::film::{Film, Role};
use crate::image::Image;
use crate::layers::Layers;
use crate::noise::{self, Noise};
use crate::render::{Options, Statistics};
use spherule_denoise::Input;

/// Denoises an image, by the variance of its pixels and their features. All three must have the same size.
///
/// The result has the same bytes for any number of threads. Pixels depend on others up to 17 pixels away.
///
/// # Panics
/// The sizes differ.
pub fn denoise(image: &Image, statistics: &Statistics, layers: &Layers) -> Denoised {
    let mut denoised = Denoised::black(image.width, image.height);
    denoise_until(image, statistics, layers, &Options::default(), &mut denoised);
    denoised
}

/// Writes the same to an image of this size until the flag of the options is set: tiles that are not begun by then stay as they
/// are. Returns false if there are any.
fn denoise_until(
    image: &Image,
    statistics: &Statistics,
    layers: &Layers,
    options: &Options,
    denoised: &mut Denoised,
) -> bool {
    assert_eq!(
        (layers.width, layers.height),
        (image.width, image.height),
        "layers of another size"
    );
    let input = Input {
        image,
        variance: &statistics.variance,
        features: &layers.pixels,
        // The unit of relative errors, so that an image of another brightness is treated alike.
        floor: mean_square(image),
    };
    input.denoise(denoised, || options.is_cancelled())
}

/// Returns whether denoising raised the error of an image of this film, by its steering probes and more than by chance.
///
/// Few probes have nearly all of the difference if rare paths of much light make most of the error. It is compared with
/// its standard error, so that they do not decide alone.
pub fn is_worse(film: &Film, image: &Image, denoised: &Image) -> bool {
    let pairs = film.tiles.iter().flat_map(|tile| tile.probes.pairs(Role::Steer));
    let (mut sum, mut squares) = (0.0, 0.0);
    for pair in pairs {
        let (x, y) = (pair.x - film.region.x, pair.y - film.region.y);
        let at = (y * image.width + x) as usize;
        let error = |image: &Image| pair.squared_error(image.pixels[at]);
        let rise = pair.weight * (error(denoised) - error(image));
        sum += rise;
        squares += rise * rise;
    }
    sum > squares.sqrt()
}

/// Estimates the relative error of a denoised image of this film, by its judging probes; `mean` is the film's radiance.
fn error_of(film: &Film, mean: noise::Estimate, denoised: &Denoised) -> Noise {
    let Denoised { image, squared_error } = denoised;
    let measured = noise::squared_error_of(film, image, squared_error, Role::Judge);
    // Light that neither samples nor probes have found is missing in the denoised image, too.
    let missing = noise::missing(film);
    let all = measured + missing;
    let expected = missing.value;
    Noise::new(noise::SquaredError { all, expected }, film.pixels(), mean)
}

/// Returns the mean square of the image's radiance, over pixels and channels.
fn mean_square(image: &Image) -> f32 {
    let squares =
        noise::sum(&image.pixels, |pixel| pixel.iter().map(|&x| f64::from(x).powi(2)).sum());
    (squares / (3 * image.pixels.len()) as f64) as f32
}

#[cfg(test)]
mod tests;
