//! The data of PNG images: rows of samples, filtered and compressed by all threads.

use crate::deflate;
use flate2::CompressError;
use rayon::prelude::*;

/// The layout of samples.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Bytes of a row of pixels.
    pub row: usize,
    /// Bytes of a pixel.
    pub pixel: usize,
}

/// Filters and compresses rows of samples of 8 bits, or of 16 with the high byte first. Returns the content of the file's
/// `IDAT` chunks, a zlib stream, which is the same for any number of threads. Samples after the last whole row are left out.
///
/// # Errors
/// Those of the compressor, which has none for what this gives it.
///
/// # Panics
/// If a row has no bytes.
pub fn compress(samples: Vec<u8>, layout: Layout) -> Result<Vec<u8>, CompressError> {
    let filtered = filter(&samples, layout);
    drop(samples);
    deflate::compress(&filtered)
}

/// Returns the rows of samples, each after the number of its filter: the one with the least sum of
/// absolute differences, as the specification recommends.
fn filter(samples: &[u8], layout: Layout) -> Vec<u8> {
    let Layout { row, pixel } = layout;
    let mut filtered = vec![0; samples.len() / row * (1 + row)];
    let rows = filtered.par_chunks_exact_mut(1 + row).enumerate();
    rows.for_each_init(
        || (vec![0; pixel + row], vec![0; pixel + row], vec![0; row]),
        |(this, above, differences), (y, filtered)| {
            // Samples before the first pixel and above the first row count as 0.
            this[pixel..].copy_from_slice(&samples[y * row..][..row]);
            match y {
                0 => above.fill(0),
                _ => above[pixel..].copy_from_slice(&samples[(y - 1) * row..][..row]),
            }
            let mut least = u64::MAX;
            for number in 0..FILTERS {
                predict(number, this, above, pixel, differences);
                let size = |byte: &u8| u64::from(byte.cast_signed().unsigned_abs());
                let sum = differences.iter().map(size).sum();
                if sum < least {
                    least = sum;
                    filtered[0] = number;
                    filtered[1..].copy_from_slice(differences);
                }
            }
        },
    );
    filtered
}

/// Number of filters.
const FILTERS: u8 = 5;

/// Computes the differences between the samples of a row and their predictions by a filter. Both rows,
/// this one and the one above, begin with a pixel of zeros.
fn predict(filter: u8, this: &[u8], above: &[u8], pixel: usize, differences: &mut [u8]) {
    match filter {
        0 => subtract(this, above, pixel, differences, |_, _, _| 0),
        1 => subtract(this, above, pixel, differences, |left, _, _| left),
        2 => subtract(this, above, pixel, differences, |_, up, _| up),
        3 => subtract(this, above, pixel, differences, |left, up, _| left.midpoint(up)),
        _ => subtract(this, above, pixel, differences, paeth),
    }
}

/// Subtracts the prediction of each sample, from those to the left, above, and above to the left.
#[inline(always)]
fn subtract(
    this: &[u8],
    above: &[u8],
    pixel: usize,
    differences: &mut [u8],
    predicted: impl Fn(u8, u8, u8) -> u8,
) {
    let left = this.iter().zip(&this[pixel..]);
    let up = above.iter().zip(&above[pixel..]);
    for (difference, ((&left, &sample), (&corner, &up))) in differences.iter_mut().zip(left.zip(up))
    {
        *difference = sample.wrapping_sub(predicted(left, up, corner));
    }
}

/// Returns the neighbor that is nearest to `left + up - corner`.
fn paeth(left: u8, up: u8, corner: u8) -> u8 {
    let [a, b, c] = [left, up, corner].map(i16::from);
    let (of_left, of_up, of_corner) = ((b - c).abs(), (a - c).abs(), (a + b - 2 * c).abs());
    let nearer = if of_up <= of_corner { up } else { corner };
    if of_left <= of_up && of_left <= of_corner { left } else { nearer }
}
