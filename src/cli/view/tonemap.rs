//! Tone mapping of images to pixels of the window. The rendering thread does it in advance if it knows the
//! window's settings, so that the window does not wait.

use super::checkerboard::over_checkerboard;
use rayon::prelude::*;
use spherule_render::image::Image;
use spherule_render::image::tone::{Codes8, DisplayTransform};
use spherule_render::overlay::Matte;
use spherule_render::scene::{Settings, Tone};

/// Display settings of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DisplaySettings {
    /// Size of the window in pixels.
    pub(super) size: (u32, u32),
    exposure: f64,
    tone: Tone,
}

/// A tone-mapped image: `0x00RRGGBB`, row by row from the top left.
#[derive(Debug)]
pub(super) struct ToneMapped {
    pub(super) display: DisplaySettings,
    pub(super) pixels: Vec<u32>,
}

/// Tone mapper, which caches the lookup table of the last settings.
#[derive(Clone, Debug, Default)]
pub(super) struct ToneMapper {
    table: Option<(f64, Tone, Codes8)>,
}

impl DisplaySettings {
    /// Returns the display settings for a window with the size of the settings.
    pub(super) fn of(settings: &Settings) -> Self {
        let Settings { width, height, exposure, tone, .. } = *settings;
        Self { size: (width, height), exposure, tone }
    }
}

impl ToneMapper {
    /// Tone-maps an image as for a PNG file, and stretches it to the window.
    pub(super) fn map(
        &mut self,
        image: &Image,
        matte: Option<&Matte>,
        display: DisplaySettings,
        pixels: &mut [u32],
    ) {
        let table = match self.table.take() {
            Some((exposure, tone, table))
                if (exposure, tone) == (display.exposure, display.tone) =>
            {
                table
            }
            _ => Codes8::new(DisplayTransform::nearest(display.exposure, display.tone)),
        };
        let packed = |pixel: &[f32; 3]| {
            let [red, green, blue] = pixel.map(|value| u32::from(table.code(value)));
            red << 16 | green << 8 | blue
        };
        if let Some(matte) = matte {
            let code = |value| table.code(value);
            let codes = over_checkerboard(image, &matte.encoded(), display.size.0, code);
            stretch(&codes, (image.width, image.height), pixels, display.size);
        } else if (image.width, image.height) == display.size {
            let pairs = pixels.par_iter_mut().zip(&image.pixels).with_min_len(1 << 14);
            pairs.for_each(|(pixel, radiance)| *pixel = packed(radiance));
        } else {
            let codes: Vec<u32> =
                image.pixels.par_iter().with_min_len(1 << 14).map(packed).collect();
            stretch(&codes, (image.width, image.height), pixels, display.size);
        }
        self.table = Some((display.exposure, display.tone, table));
    }
}

/// Resizes an image of display values by bilinear interpolation.
fn stretch(codes: &[u32], from: (u32, u32), pixels: &mut [u32], to: (u32, u32)) {
    let width = from.0 as usize;
    let across = taps(to.0 as usize, width);
    let down = taps(to.1 as usize, from.1 as usize);
    let rows = pixels.par_chunks_mut(to.0 as usize);
    rows.zip(&down).for_each(|(row, &(upper, below, weight))| {
        let [upper, below] = [upper, below].map(|y| &codes[y * width..(y + 1) * width]);
        let column: Vec<u32> =
            upper.iter().zip(below).map(|(a, b)| blended(*a, *b, weight)).collect();
        for (pixel, &(left, right, weight)) in row.iter_mut().zip(&across) {
            *pixel = blended(column[left], column[right], weight);
        }
    });
}

/// Returns for each of `count` positions the two neighbors among `from` pixels, and the weight of the second
/// one times 256.
fn taps(count: usize, from: usize) -> Vec<(usize, usize, u32)> {
    let place = |i: usize| {
        let at =
            ((i as f64 + 0.5) * from as f64 / count as f64 - 0.5).clamp(0.0, from as f64 - 1.0);
        let first = at as usize;
        (first, (first + 1).min(from - 1), ((at - first as f64) * 256.0) as u32)
    };
    (0..count).map(place).collect()
}

/// Interpolates two colors, with weight `weight / 256` of the second: red and blue at once, then green.
fn blended(a: u32, b: u32, weight: u32) -> u32 {
    let mix = |mask: u32| (((a & mask) * (256 - weight) + (b & mask) * weight) >> 8) & mask;
    mix(0x00FF_00FF) | mix(0x0000_FF00)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretching_keeps_colors_and_goes_from_end_to_end() {
        let mut pixels = [0; 32];
        stretch(&[0x0010_2030; 6], (3, 2), &mut pixels, (8, 4));
        assert!(pixels.iter().all(|pixel| *pixel == 0x0010_2030));
        stretch(&[0, 0x00FF_FFFF], (2, 1), &mut pixels, (8, 4));
        let row = &pixels[..8];
        assert_eq!((row[0], row[7]), (0, 0x00FF_FFFF));
        assert!(row.is_sorted());
    }
}
