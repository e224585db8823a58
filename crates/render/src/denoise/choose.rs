//! When a render stops that is not told, and whether its image is denoised.

use super::{Choice, MAX_ERROR, max_samples, trajectory_samples};
use crate::film::Region;
use crate::scene::Scene;
use crate::settings::Denoise;

/// Requests of a caller that its scene does not state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// True for a part of an image.
    pub part: bool,
    /// True if the number of samples is.
    pub spp: bool,
    /// Number of particles in the first frame of a file with several frames; `None` for other scenes.
    pub first_frame: Option<usize>,
}

/// Completes the settings of a render of a scene with this many spheres, and returns how it is denoised, if at all. A part
/// of an image is not, since that needs the whole. A scene's number of samples is that of its image, denoised or not; if
/// it is asked for, these very samples are meant.
///
/// Without a stop condition, the render stops where the error of the denoised image is below [`MAX_ERROR`], or at a
/// number of samples that depends on the scene alone. A frame of a trajectory has [`trajectory_samples`] in all pixels, and is always
/// denoised: where frames had samples and choices of their own, what does not move would flicker.
pub fn choose(scene: &mut Scene, region: Region, spheres: usize, asked: Asked) -> Option<Choice> {
    let settings = &mut scene.settings;
    let chosen = settings.until_error.is_some() || asked.spp && settings.time.is_none();
    let choice = match settings.denoise {
        _ if asked.part => None,
        Denoise::On => Some(Choice::Always),
        Denoise::Auto if !chosen => Some(Choice::UnlessWorse),
        Denoise::Auto | Denoise::Off => None,
    };
    if let Some(first) = asked.first_frame.filter(|_| choice.is_some() && !settings.stop_given) {
        settings.spp = trajectory_samples(region, first, &scene.materials);
        return Some(Choice::Always);
    }
    if choice.is_none() {
        settings.denoise = Denoise::Off;
    } else if !settings.stop_given {
        settings.until_error = Some(MAX_ERROR);
        settings.spp = max_samples(region, spheres, &scene.materials);
    }
    choice
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    const REGION: Region = Region { x: 0, y: 0, width: 80, height: 60 };

    fn chosen(change: impl Fn(&mut Settings), asked: Asked) -> (Option<Choice>, Settings) {
        let mut scene = Scene::default();
        change(&mut scene.settings);
        let choice = choose(&mut scene, REGION, 1000, asked);
        (choice, scene.settings)
    }

    #[test]
    fn renders_without_a_stop_condition_stop_at_the_error_of_the_denoised_image() {
        let (choice, settings) = chosen(|_| (), Asked::default());
        assert_eq!((choice, settings.until_error), (Some(Choice::UnlessWorse), Some(MAX_ERROR)));
        assert_eq!(settings.spp, max_samples(REGION, 1000, &[]));
    }

    #[test]
    fn samples_of_a_scene_are_denoised_and_those_asked_for_are_not() {
        let samples = |settings: &mut Settings| (settings.spp, settings.stop_given) = (7, true);
        let (choice, settings) = chosen(samples, Asked::default());
        assert_eq!((choice, settings.spp), (Some(Choice::UnlessWorse), 7));
        assert_eq!(settings.until_error, None);
        let spp = Asked { spp: true, ..Asked::default() };
        let (choice, settings) = chosen(samples, spp);
        assert_eq!((choice, settings.spp, settings.denoise), (None, 7, Denoise::Off));
        let on = |settings: &mut Settings| {
            samples(settings);
            settings.denoise = Denoise::On;
        };
        let (choice, settings) = chosen(on, spp);
        assert_eq!((choice, settings.spp, settings.until_error), (Some(Choice::Always), 7, None));
    }

    #[test]
    fn frames_of_a_trajectory_have_the_same_samples_and_choices() {
        let first_frame = Asked { first_frame: Some(1000), ..Asked::default() };
        let (choice, settings) = chosen(|_| (), first_frame);
        assert_eq!((choice, settings.spp, settings.until_error), (Some(Choice::Always), 32, None));
        let samples = |settings: &mut Settings| (settings.spp, settings.stop_given) = (7, true);
        let spp = Asked { spp: true, ..first_frame };
        assert_eq!(chosen(samples, spp), chosen(samples, Asked { first_frame: None, ..spp }));
        let part = Asked { part: true, ..first_frame };
        assert_eq!(chosen(|_| (), part), chosen(|_| (), Asked { first_frame: None, ..part }));
    }

    #[test]
    fn other_error_targets_are_those_of_the_picture_itself() {
        let error = |settings: &mut Settings| {
            (settings.until_error, settings.stop_given) = (Some(0.1), true);
        };
        assert_eq!(chosen(error, Asked::default()).0, None);
    }

    #[test]
    fn parts_are_not_denoised() {
        let (choice, settings) = chosen(|_| (), Asked { part: true, ..Asked::default() });
        assert_eq!((choice, settings.denoise, settings.until_error), (None, Denoise::Off, None));
    }
}
