//! When a render stops that is not told, and whether its image is denoised.

use super::{Choice, MAX_ERROR, max_samples};
use crate::film::Region;
use crate::settings::{Denoise, Settings};

/// Completes the settings of a render of this many spheres, and returns how it is denoised, if at all; a `part` of
/// an image is not, since that needs the whole.
///
/// Without a stop condition, the render stops where the error of the denoised image is below [`MAX_ERROR`], or at a
/// number of samples that depends on the scene alone.
pub fn choose(
    settings: &mut Settings,
    region: Region,
    spheres: usize,
    part: bool,
) -> Option<Choice> {
    let chosen = settings.until_error.is_some() || settings.stop_given && settings.time.is_none();
    let choice = match settings.denoise {
        _ if part => None,
        Denoise::On => Some(Choice::Always),
        Denoise::Auto if !chosen => Some(Choice::UnlessWorse),
        Denoise::Auto | Denoise::Off => None,
    };
    if choice.is_none() {
        settings.denoise = Denoise::Off;
    } else if !settings.stop_given {
        settings.until_error = Some(MAX_ERROR);
        settings.spp = max_samples(region, spheres);
    }
    choice
}
