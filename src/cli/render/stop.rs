//! When a render stops that is not told, and whether its image is denoised.

use super::job::Job;
use crate::cli::failure::Failure;
use spherule_render::denoise::{self, Choice};
use spherule_render::film::Region;
use spherule_render::scene::Scene;
use spherule_render::settings::Denoise;

/// Completes the settings of a render, and returns how it is denoised, if at all. `spheres` is the number of spheres, which
/// the scene itself does not have any more if it was prepared.
///
/// Without a stop condition, the render stops where the error of the denoised image is below
/// [`denoise::MAX_ERROR`], or at a number of samples that depends on the scene alone.
pub(super) fn choose(
    job: &Job,
    scene: &mut Scene,
    region: Region,
    spheres: usize,
) -> Result<Option<Choice>, Failure> {
    let settings = &mut scene.settings;
    // A scene's number of samples is that of its image, denoised or not; one on the command line asks for these samples.
    let samples_asked = job.picture.settings.spp().is_some() && settings.time.is_none();
    let chosen = settings.until_error.is_some() || samples_asked;
    let choice = match settings.denoise {
        Denoise::On if job.part.is_some() => {
            let message = "--denoise on needs the whole image; remove it with --part";
            return Err(Failure::usage("render", message));
        }
        Denoise::On => Some(Choice::Always),
        Denoise::Auto if !chosen && job.part.is_none() => Some(Choice::UnlessWorse),
        Denoise::Auto | Denoise::Off => None,
    };
    if choice.is_none() {
        settings.denoise = Denoise::Off;
    } else if !settings.stop_given {
        settings.until_error = Some(denoise::MAX_ERROR);
        settings.spp = denoise::max_samples(region, spheres, &scene.materials);
    }
    Ok(choice)
}
