//! Saving of the image, and of a scene that renders to it.

use super::image::Picture;
use super::load::Origin;
use super::viewer::{Facts, Viewer};
use crate::cli::failure::Failure;
use crate::cli::render::{
    RenderSetup, Subject, alpha, check_alpha, push_denoised, push_error, write_bar,
};
use serde_json::json;
use spherule_render::atomic::write_atomically;
use spherule_render::film::Region;
use spherule_render::image::{Channel, Format, WriteOptions};
use spherule_render::scene::{Camera, Header, Look, Scene, Settings, Tone, write_as};
use std::path::Path;
use std::sync::{Arc, PoisonError, RwLock};

/// An image with the scene and settings that it is made from.
pub(super) struct SavedImage<'a> {
    pub(super) title: &'a str,
    pub(super) camera: &'a Camera,
    /// Settings with the image's number of samples.
    pub(super) settings: &'a Settings,
    pub(super) look: Look,
    pub(super) picture: &'a Picture,
}

/// An image with all that saves it.
pub(super) struct Saved {
    pub(super) title: String,
    pub(super) camera: Camera,
    pub(super) settings: Settings,
    pub(super) look: Look,
    pub(super) picture: Arc<Picture>,
}

impl Saved {
    /// Returns the current image of a viewer, if it is no preview.
    pub(super) fn of(viewer: &Viewer) -> Option<Self> {
        Some(Self {
            title: viewer.facts.title.clone(),
            camera: viewer.control.camera.clone(),
            settings: viewer.settings_of_picture()?,
            look: viewer.look(),
            picture: Arc::clone(viewer.sampled()?),
        })
    }

    /// The head of the scene that renders to it.
    pub(super) fn header(&self) -> Header<'_> {
        let Self { title, camera, settings, look, .. } = self;
        Header { title, camera, settings, look }
    }

    pub(super) fn seen(&self) -> SavedImage<'_> {
        let Self { title, camera, settings, look, picture } = self;
        SavedImage { title, camera, settings, look: *look, picture }
    }
}

/// Writes the image, as `spherule render` does for the saved scene.
pub(super) fn save_picture(seen: &SavedImage, path: &Path) -> Result<(), Failure> {
    let file = encode_picture(seen, Format::of_suffix(path)?)?;
    write_atomically(path, |writer| writer.write_all(&file))
        .map_err(|error| Failure::Write(path.to_owned(), error))
}

/// Returns the file of the image, as `spherule render` writes it for the saved scene.
pub(super) fn encode_picture(seen: &SavedImage, format: Format) -> Result<Vec<u8>, Failure> {
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
    Ok(image.encode(format, &channels, &options)?)
}

/// Returns the numbers of the image, linear RGB in single precision from the top left, lowest byte first, after a header of
/// what the Python package has in `Picture`.
///
/// # Errors
/// The image is transparent.
pub(super) fn raw_picture(seen: &SavedImage) -> Result<(String, Vec<u8>), String> {
    if seen.look.is_transparent() {
        return Err(
            "the background is transparent; choose a color, or save the image in the page".into()
        );
    }
    let Settings { exposure, tone, dpi, .. } = *seen.settings;
    let (image, _) = seen.picture.visible();
    let bytes = image.pixels.as_flattened().iter().flat_map(|value| value.to_le_bytes());
    let Picture { samples, noise, before, .. } = seen.picture;
    let header = json!({
        "file": "view.raw",
        "shape": [image.height, image.width, 3],
        "title": seen.title,
        "exposure": exposure,
        "tone": if tone == Tone::Filmic { "filmic" } else { "linear" },
        "dpi": dpi,
        "samples": samples,
        "error": noise.map(|noise| noise.error),
        "error_bound": noise.map(|noise| noise.bound),
        "denoised": before.is_some(),
    });
    Ok((header.to_string(), bytes.collect()))
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
    header: &Header,
    scene: &RwLock<Scene>,
    origin: Option<&Origin>,
    path: &Path,
) -> Result<(), Failure> {
    // Release the lock while writing, so that other threads do not wait.
    let scene = scene.read().unwrap_or_else(PoisonError::into_inner);
    let Some(origin) = origin else { return Ok(write_as(&scene, header, path)?) };
    let whole = Scene { spheres: origin.spheres()?, ..scene.clone() };
    Ok(write_as(&whole, header, path)?)
}
