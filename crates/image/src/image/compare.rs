//! Comparison of an image with a reference.

use super::Image;
use crate::elementary::log10;
use serde::Serialize;

/// Keeps the relative error finite where the reference is black.
const RELATIVE_EPSILON: f64 = 1e-2;

/// The result of [`compare()`], in linear radiance.
///
/// A value is one channel of one pixel. Values that are not finite in either image are only counted
/// and excluded from all other statistics: a comparison is valid only if [`Comparison::non_finite`] is
/// 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Number of pixels of each image.
    pub pixels: u64,
    /// Root of the mean squared difference of values.
    pub rmse: f64,
    /// Mean of `(a - b)^2 / (b^2 + 0.01)` over values; `b` is the reference.
    pub relative_mse: f64,
    /// Peak signal-to-noise ratio in decibels for a peak of 1; infinite if no value differs, which
    /// JSON shows as null.
    pub psnr: f64,
    /// The largest absolute difference of values.
    pub max_difference: Difference,
    /// Mean of `a - b` over pixels, each the mean of its channels: positive if the image is too
    /// bright.
    pub bias: f64,
    /// Standard error of `bias`, for differences independent between pixels; infinite (in JSON, null)
    /// if fewer than two pixels are finite.
    pub bias_standard_error: f64,
    /// Number of pixels with at least one different value; NaN equals NaN.
    pub differing_pixels: u64,
    /// Number of values that are NaN or infinite in at least one of the images.
    pub non_finite: u64,
}

/// A difference between two images with its position; of equal ones the first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Absolute value.
    pub value: f64,
    /// Column from the left.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// Channel: 0 for red, 1 for green, 2 for blue.
    pub channel: u8,
}

/// The reason why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// Their sizes differ.
    #[error(
        "the pictures differ in size: {} x {} and {} x {}; render both in one size",
        sizes[0].0, sizes[0].1, sizes[1].0, sizes[1].1
    )]
    Sizes {
        /// Width and height of the image and of the reference.
        sizes: [(u32, u32); 2],
    },
    /// The number of pixels of an image differs from width times height.
    #[error("the number of pixels of a picture differs from its size; make it by Image::new")]
    Shape,
    /// No value is finite in both images.
    #[error("no value is finite in both pictures; render them again")]
    NothingFinite,
}

/// Sums over values and pixels, in row-major order.
#[derive(Default)]
struct Sums {
    values: u64,
    squares: f64,
    relative_squares: f64,
    largest: f64,
    largest_at: (usize, u8),
    /// Mean differences of the pixels whose values are all finite.
    pixel_differences: Vec<f64>,
    differing_pixels: u64,
    non_finite: u64,
}

/// Compares image `a` with the reference `b`, in linear values.
///
/// # Errors
/// [`CompareError`] if the sizes differ, or if there is nothing to compare.
pub fn compare(a: &Image, b: &Image) -> Result<Comparison, CompareError> {
    let sizes = [(a.width, a.height), (b.width, b.height)];
    if sizes[0] != sizes[1] {
        return Err(CompareError::Sizes { sizes });
    }
    let area = u64::from(a.width) * u64::from(a.height);
    if [a, b].iter().any(|image| image.pixels.len() as u64 != area) {
        return Err(CompareError::Shape);
    }
    let mut sums = Sums::default();
    for (index, (a, b)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        sums.add_pixel(index, a, b);
    }
    if sums.values == 0 { Err(CompareError::NothingFinite) } else { Ok(sums.finish(a.width, area)) }
}

impl Sums {
    fn add_pixel(&mut self, index: usize, a: &[f32; 3], b: &[f32; 3]) {
        let differs = |(a, b): (&f32, &f32)| a != b && !(a.is_nan() && b.is_nan());
        self.differing_pixels += u64::from(a.iter().zip(b).any(differs));
        let before = self.non_finite;
        let mut total = 0.0;
        for (channel, (&a, &b)) in a.iter().zip(b).enumerate() {
            if a.is_finite() && b.is_finite() {
                total += self.add_value((index, channel as u8), f64::from(a), f64::from(b));
            } else {
                self.non_finite += 1;
            }
        }
        if self.non_finite == before {
            self.pixel_differences.push(total / 3.0);
        }
    }

    fn add_value(&mut self, position: (usize, u8), a: f64, b: f64) -> f64 {
        let difference = a - b;
        self.values += 1;
        self.squares += difference * difference;
        self.relative_squares += difference * difference / (b * b + RELATIVE_EPSILON);
        if difference.abs() > self.largest {
            self.largest = difference.abs();
            self.largest_at = position;
        }
        difference
    }

    fn finish(self, width: u32, pixels: u64) -> Comparison {
        let mean_square = self.squares / self.values as f64;
        let (bias, bias_standard_error) = mean_and_error(&self.pixel_differences);
        let (index, channel) = self.largest_at;
        let (x, y) = (index % width as usize, index / width as usize);
        Comparison {
            pixels,
            rmse: mean_square.sqrt(),
            relative_mse: self.relative_squares / self.values as f64,
            psnr: if mean_square > 0.0 { -10.0 * log10(mean_square) } else { f64::INFINITY },
            max_difference: Difference { value: self.largest, x: x as u32, y: y as u32, channel },
            bias,
            bias_standard_error,
            differing_pixels: self.differing_pixels,
            non_finite: self.non_finite,
        }
    }
}

/// Returns the mean and its standard error from the sample variance, in two passes against
/// cancellation.
fn mean_and_error(samples: &[f64]) -> (f64, f64) {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count.max(1.0);
    if samples.len() < 2 {
        return (mean, f64::INFINITY);
    }
    let squares: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: u32, pixels: &[[f32; 3]]) -> Image {
        Image::new(width, pixels.len() as u32 / width, pixels.to_vec()).unwrap()
    }

    #[test]
    fn results_agree_with_manual_calculation() {
        let a = image(2, &[[1.0, 0.5, 0.0], [0.25; 3], [0.0; 3], [2.0, 2.0, 1.25]]);
        let b = image(2, &[[0.5, 0.5, 0.0], [0.25; 3], [0.25, 0.0, 0.0], [2.0, 2.0, 2.0]]);
        let found = compare(&a, &b).unwrap();
        // The differences: 0.5 from 0.5, -0.25 from 0.25, -0.75 from 2.
        let squares = 0.25 + 0.0625 + 0.5625;
        let relative = 0.25 / 0.26 + 0.0625 / 0.0725 + 0.5625 / 4.01;
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(found.rmse, (squares / 12.0_f64).sqrt());
        close(found.relative_mse, relative / 12.0);
        close(found.psnr, 10.0 * (12.0 / squares).log10());
        assert_eq!(found.max_difference, Difference { value: 0.75, x: 1, y: 1, channel: 2 });
        // Over pixels: 1/6, 0, -1/12, -1/4.
        let mean = -1.0 / 24.0;
        let deviations = [5.0 / 24.0, 1.0 / 24.0, -1.0 / 24.0, -5.0 / 24.0];
        close(found.bias, mean);
        let variance = deviations.iter().map(|d| d * d).sum::<f64>() / 3.0;
        close(found.bias_standard_error, (variance / 4.0).sqrt());
        assert_eq!((found.pixels, found.differing_pixels, found.non_finite), (4, 3, 0));
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let a = image(1, &[[0.0, -0.0, 3.0], [1e30, 1e-30, 7.0]]);
        let found = compare(&a, &a).unwrap();
        assert_eq!((found.rmse, found.relative_mse, found.bias), (0.0, 0.0, 0.0));
        assert_eq!((found.psnr, found.differing_pixels), (f64::INFINITY, 0));
        assert_eq!(found.max_difference, Difference { value: 0.0, x: 0, y: 0, channel: 0 });
    }

    #[test]
    fn values_that_are_not_finite_are_counted_and_excluded() {
        let nan = f32::NAN;
        let a = image(1, &[[nan, 1.0, 1.0], [f32::INFINITY, nan, nan], [3.0; 3], [1.0; 3]]);
        let b = image(1, &[[nan, 1.0, 2.0], [f32::INFINITY, nan, nan], [2.0; 3], [0.0; 3]]);
        let found = compare(&a, &b).unwrap();
        assert_eq!((found.non_finite, found.differing_pixels), (4, 3));
        assert_eq!((found.bias, found.bias_standard_error), (1.0, 0.0));
        assert_eq!(found.rmse, (7.0_f64 / 8.0).sqrt());
    }

    #[test]
    fn incomparable_pictures_are_refused() {
        let (wide, tall) = (image(2, &[[0.0; 3]; 2]), image(1, &[[0.0; 3]; 2]));
        let message = compare(&wide, &tall).unwrap_err().to_string();
        assert!(message.contains("2 x 1 and 1 x 2"), "{message}");
        let nan = image(1, &[[f32::NAN; 3]]);
        assert_eq!(compare(&nan, &nan), Err(CompareError::NothingFinite));
        let torn = Image { width: 2, height: 1, pixels: vec![[0.0; 3]] };
        assert_eq!(compare(&torn, &torn), Err(CompareError::Shape));
        assert_eq!(compare(&image(1, &[[1.0; 3]]), &image(1, &[[0.0; 3]])).unwrap().bias, 1.0);
    }
}
