//! The filter of Spherule's denoiser: local regression of radiance on features that have no noise of light.
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
//! This is a part of the crate `spherule`, which has the public interface: use that. Anything here may change in any release.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

mod box_sums;
mod columns;
mod observations;
mod regression;
mod rows;
mod similarity;
mod tile;

use rayon::prelude::*;
use rows::TILE;
use spherule_transport::Image;
use spherule_transport::film::{Features, Region};
use std::sync::Mutex;
use tile::{Workspace, tiles};

/// An image to denoise, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Means of samples.
    pub image: &'a Image,
    /// Variance of each pixel's mean, of the same size.
    pub variance: &'a Image,
    /// Features of as many pixels.
    pub features: &'a [Features],
    /// Mean square of the radiance, to which relative errors are relative.
    pub floor: f32,
}

/// A denoised image, or a region of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Radiance.
    pub image: Image,
    /// Estimated squared error of each pixel, averaged over channels, row by row. Those of single pixels are
    /// uncertain: means over many are meant.
    pub squared_error: Vec<f32>,
}

impl Input<'_> {
    /// Writes the denoised image to one of this size until it is cancelled: tiles that are not begun by then stay as they are.
    /// Returns false if there are any. The bytes are the same for any number of threads.
    ///
    /// # Panics
    /// The sizes differ.
    pub fn denoise(&self, denoised: &mut Denoised, is_cancelled: impl Fn() -> bool + Sync) -> bool {
        let (width, height) = (self.image.width, self.image.height);
        let pixels = self.image.pixels.len();
        assert!(self.variance.pixels.len() == pixels && self.features.len() == pixels);
        assert!(denoised.image.pixels.len() == pixels && denoised.squared_error.len() == pixels);
        let regions: Vec<Region> = tiles(width, height).collect();
        let band = (width * TILE[1]) as usize;
        let radiance = denoised.image.pixels.chunks_mut(band);
        let bands: Vec<_> =
            radiance.zip(denoised.squared_error.chunks_mut(band)).map(Mutex::new).collect();
        let done = regions.into_par_iter().map_init(Workspace::default, |work, region| {
            if is_cancelled() {
                return false;
            }
            let tile = work.denoise(self, region);
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
}

impl Denoised {
    /// Returns a black image without error.
    pub fn black(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        let image = Image { width, height, pixels: vec![[0.0; 3]; pixels] };
        Self { image, squared_error: vec![0.0; pixels] }
    }
}

#[cfg(test)]
mod tests;
