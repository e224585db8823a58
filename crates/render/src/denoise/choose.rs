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

#[cfg(test)]
mod tests {
    use super::*;

    const REGION: Region = Region { x: 0, y: 0, width: 80, height: 60 };

    fn chosen(change: impl Fn(&mut Settings), part: bool) -> (Option<Choice>, Settings) {
        let mut settings = Settings::default();
        change(&mut settings);
        let choice = choose(&mut settings, REGION, 1000, part);
        (choice, settings)
    }

    #[test]
    fn renders_without_a_stop_condition_stop_at_the_error_of_the_denoised_image() {
        let (choice, settings) = chosen(|_| (), false);
        assert_eq!((choice, settings.until_error), (Some(Choice::UnlessWorse), Some(MAX_ERROR)));
        assert_eq!(settings.spp, max_samples(REGION, 1000));
    }

    #[test]
    fn chosen_samples_and_errors_are_not_denoised_unless_asked_for() {
        let samples = |settings: &mut Settings| (settings.spp, settings.stop_given) = (7, true);
        let (choice, settings) = chosen(samples, false);
        assert_eq!((choice, settings.spp, settings.denoise), (None, 7, Denoise::Off));
        let error = |settings: &mut Settings| {
            (settings.until_error, settings.stop_given) = (Some(0.1), true);
        };
        assert_eq!(chosen(error, false).0, None);
        let asked = |settings: &mut Settings| {
            samples(settings);
            settings.denoise = Denoise::On;
        };
        let (choice, settings) = chosen(asked, false);
        assert_eq!((choice, settings.spp, settings.until_error), (Some(Choice::Always), 7, None));
    }

    #[test]
    fn parts_are_not_denoised() {
        let (choice, settings) = chosen(|_| (), true);
        assert_eq!((choice, settings.denoise, settings.until_error), (None, Denoise::Off, None));
    }
}
