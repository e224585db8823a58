//! Denoising: local regression of radiance on features that have no noise of light.
//!
//! # The filter
//!
//! Within a small window, irradiance is nearly a linear function of the normal and of the fraction of the pixel that
//! is covered. So each pixel is replaced by the prediction of a weighted linear regression on its neighbors (Moon et
//! al., "Adaptive Rendering Based on Weighted Local Regression", TOG 2014; Bitterli et al., "Nonlinearly Weighted
//! First-Order Regression for Denoising Monte Carlo Renderings", CGF 2016). Radiance is divided by the albedo before,
//! and multiplied by it after, so that colors are not blurred. Features come from the camera rays of the image's own
//! samples, and are recorded with them, so they have its silhouettes, including its lens blur and pixel filter.
//!
//! Edges that features do not have are those of caustics, highlights, and all that is seen in glass and mirrors. There,
//! neighbors count by how similar their radiance is, beside their noise (Buades, Coll and Morel, "A Non-Local Algorithm for
//! Image Denoising", CVPR 2005; Rousselle, Knaus and Zwicker, "Adaptive Rendering with Non-Local Means Filtering", TOG 2012).
//!
//! # The choice of the window
//!
//! Each pixel has a prediction for each of three windows, and stays as it is where none is better. The widest consists of
//! squares of pixels, whose means are the neighbors of its regression. The squared error of a prediction that is linear in
//! the radiance is estimated without a reference (Stein, "Estimation of the Mean of a Multivariate Normal Distribution",
//! 1981; Li et al., "SURE-Based Optimization for Adaptive Sampling and Reconstruction", TOG 2012):
//!
//! ```text
//! (prediction - mean)^2 + (2 leverage - 1) variance of the mean
//! ```
//!
//! where the leverage is the derivative of the prediction by the pixel's own mean. The window with the least error,
//! averaged over neighbors, is taken; wider ones are preferred where errors are nearly equal. As samples increase, the
//! variance vanishes, and with it the denoising. Pixels without noise stay as they are.
//!
//! A rare path of much light makes a pixel and its variance much larger than its neighbors. Such a pixel counts little
//! in their regressions, and where pixels keep their value, it gets theirs as far as its own noise explains the
//! difference.
//!
//! # The stated error
//!
//! The error above chooses, but does not judge. The error of the denoised image, bias included, is measured by
//! [`Probes`](crate::film::Probes): the means `a` and `b` of a probe's two streams are independent of each other and of
//! the denoised pixel `d`, so the expectation of `(d - a)(d - b)` is the squared error of `d`.
//! [`crate::noise`] has the bound.

mod box_sums;
mod choose;
mod columns;
mod features;
mod observations;
mod regression;
mod rows;
mod similarity;
mod target;
mod tile;

pub use choose::{Asked, choose};
pub use target::{Choice, Denoiser, Judged, MAX_ERROR, max_samples, trajectory_samples};

use self::rows::TILE;
use self::tile::{Workspace, tiles};
use crate::film::{Film, Region, Role};
use crate::image::Image;
use crate::layers::Layers;
use crate::noise::{self, Noise};
use crate::render::{Options, Statistics};
use rayon::prelude::*;
use std::sync::Mutex;

/// A denoised image, or a region of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Radiance.
    pub image: Image,
    /// Estimated squared error of each pixel, averaged over channels, row by row. Those of single pixels are
    /// uncertain: means over many are meant.
    pub squared_error: Vec<f32>,
}

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
    let (width, height) = (image.width, image.height);
    let pixels = image.pixels.len();
    assert_eq!((layers.width, layers.height), (width, height), "layers of another size");
    assert!(statistics.variance.pixels.len() == pixels && layers.pixels.len() == pixels);
    let input = tile::Input {
        image,
        variance: &statistics.variance,
        features: &layers.pixels,
        // The unit of relative errors, so that an image of another brightness is treated alike.
        floor: mean_square(image),
    };
    let regions: Vec<Region> = tiles(width, height).collect();
    let band = (width * TILE[1]) as usize;
    let radiance = denoised.image.pixels.chunks_mut(band);
    let bands: Vec<_> =
        radiance.zip(denoised.squared_error.chunks_mut(band)).map(Mutex::new).collect();
    let done = regions.into_par_iter().map_init(Workspace::default, |work, region| {
        if options.is_cancelled() {
            return false;
        }
        let tile = work.denoise(&input, region);
        let Ok(mut band) = bands[(region.y / TILE[1]) as usize].lock() else { return false };
        for (row, pixels) in tile.chunks(region.width as usize).enumerate() {
            let first = row * width as usize + region.x as usize;
            for (at, &(radiance, squared_error)) in (first..).zip(pixels) {
                (band.0[at], band.1[at]) = (radiance, squared_error);
            }
        }
        true
    });
    done.reduce(|| true, |a, b| a && b)
}

impl Denoised {
    /// Returns a black image without error.
    fn black(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        let image = Image { width, height, pixels: vec![[0.0; 3]; pixels] };
        Self { image, squared_error: vec![0.0; pixels] }
    }
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
