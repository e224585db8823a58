//! Saving of the image, and of a scene that renders to it.

use super::image::Picture;
use super::load::Origin;
use super::viewer::Facts;
use crate::cli::failure::Failure;
use crate::cli::render::{
    RenderSetup, Subject, alpha, check_alpha, push_denoised, push_error, write_bar,
};
use spherule_render::film::Region;
use spherule_render::image::{Channel, Format, WriteOptions};
use spherule_render::scene::{Camera, Header, Look, Scene, Settings, write_as};
use std::path::Path;
#[cfg(feature = "view")]
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};

/// An image with the scene and settings that it is made from.
pub(super) struct SavedImage<'a> {
    pub(super) title: &'a str,
    pub(super) camera: &'a Camera,
    /// Settings with the image's number of samples.
    pub(super) settings: &'a Settings,
    pub(super) look: Look,
    pub(super) picture: &'a Picture,
}

/// Writes the image, as `spherule render` does for the saved scene.
pub(super) fn save_picture(seen: &SavedImage, path: &Path) -> Result<(), Failure> {
    let format = Format::of_suffix(path)?;
    check_alpha(seen.look.is_transparent(), format)?;
    let Settings { width, height, exposure, tone, dpi, .. } = *seen.settings;
    let resolution = dpi.filter(|_| format.has_resolution());
    let mut options = WriteOptions { exposure, tone, resolution, ..WriteOptions::default() };
    let region = Region { x: 0, y: 0, width, height };
    let subject = Subject { title: seen.title, settings: seen.settings, region, looks: &[] };
    options.metadata = subject.describe(format, &options);
    if let Picture { noise: Some(noise), before: Some(before), .. } = seen.picture {
        push_error(&mut options.metadata, *noise);
        push_denoised(&mut options.metadata, Some(before));
    }
    let (image, matte) = seen.picture.visible();
    let channels: Vec<Channel> = matte.map(|matte| alpha(matte, format)).into_iter().collect();
    Ok(image.write_layers(path, &channels, &options)?)
}

/// Writes the color bar, if it has its own file and colors represent numbers.
pub(super) fn save_bar(
    setup: &RenderSetup,
    facts: &Facts,
    settings: &Settings,
) -> Result<(), Failure> {
    match &facts.legend {
        Some(legend) => write_bar(setup, Some(legend), settings),
        None => Ok(()),
    }
}

/// Writes the scene, with its spheres in a separate file.
pub(super) fn save_scene(
    seen: &SavedImage,
    scene: &RwLock<Scene>,
    origin: Option<&Origin>,
    path: &Path,
) -> Result<(), Failure> {
    let SavedImage { title, camera, settings, ref look, .. } = *seen;
    let header = Header { title, camera, settings, look };
    // Release the lock while writing, so that other threads do not wait.
    let scene = scene.read().unwrap_or_else(PoisonError::into_inner);
    let Some(origin) = origin else { return Ok(write_as(&scene, &header, path)?) };
    let whole = Scene { spheres: origin.spheres()?, ..scene.clone() };
    Ok(write_as(&whole, &header, path)?)
}

/// Returns the next free name: `view-002.png` if an image or a scene `view-001` exists.
#[cfg(feature = "view")]
pub(super) fn free_name(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let suffix = path.extension().unwrap_or_default();
    let names = (1_u32..)
        .map(|number| path.with_file_name(format!("{stem}-{number:03}")).with_extension(suffix));
    let is_there = |path: &Path| path.symlink_metadata().is_ok();
    let free = |name: &PathBuf| {
        let beside = ["toml", "csv", "pfm"].map(|suffix| name.with_extension(suffix));
        !is_there(name) && !beside.iter().any(|path| is_there(path))
    };
    names.into_iter().find(free).unwrap_or_else(|| path.to_owned())
}
