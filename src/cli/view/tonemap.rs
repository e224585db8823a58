//! Tone mapping of images to display values, by the rendering thread, so that the page does not wait.

use super::checkerboard::over_checkerboard;
use rayon::prelude::*;
use spherule_render::image::Image;
use spherule_render::image::tone::{Codes8, DisplayTransform};
use spherule_render::overlay::Matte;
use spherule_render::scene::{Settings, Tone};

/// Display settings of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DisplaySettings {
    exposure: f64,
    tone: Tone,
}

/// Tone mapper, which caches the lookup table of the last settings.
#[derive(Clone, Debug, Default)]
pub(super) struct ToneMapper {
    table: Option<(f64, Tone, Codes8)>,
}

impl DisplaySettings {
    /// Returns the display settings of an image.
    pub(super) fn of(settings: &Settings) -> Self {
        let Settings { exposure, tone, .. } = *settings;
        Self { exposure, tone }
    }
}

impl ToneMapper {
    /// Tone-maps an image as for a PNG file.
    pub(super) fn map(
        &mut self,
        image: &Image,
        matte: Option<&Matte>,
        display: DisplaySettings,
    ) -> Vec<u32> {
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
        let pixels = match matte {
            Some(matte) => over_checkerboard(image, &matte.encoded(), |value| table.code(value)),
            None => image.pixels.par_iter().with_min_len(1 << 14).map(packed).collect(),
        };
        self.table = Some((display.exposure, display.tone, table));
        pixels
    }
}
