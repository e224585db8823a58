//! What was seen as files: the picture, and a scene that renders to it.

use crate::cli::failure::Failure;
use crate::cli::render::Subject;
use spherule::film::Region;
use spherule::image::{Format, Image, WriteOptions};
use spherule::scene::{Camera, Scene, Settings, write};
use std::path::Path;
#[cfg(feature = "view")]
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};

/// All that makes a picture, and the picture.
pub(super) struct Seen<'a> {
    pub(super) title: &'a str,
    pub(super) camera: &'a Camera,
    /// With the samples that the picture has.
    pub(super) settings: &'a Settings,
    pub(super) image: &'a Image,
}

/// Writes the picture, as `spherule render` would of the saved scene.
pub(super) fn save_picture(seen: &Seen, path: &Path) -> Result<(), Failure> {
    let Settings { width, height, exposure, tone, .. } = *seen.settings;
    let mut options = WriteOptions { exposure, tone, ..WriteOptions::default() };
    let region = Region { x: 0, y: 0, width, height };
    let subject = Subject { title: seen.title, settings: seen.settings, region, looks: &[] };
    options.metadata = subject.describe(Format::of_suffix(path)?, &options);
    Ok(seen.image.write(path, &options)?)
}

/// Writes the scene, with its spheres in a file beside it.
pub(super) fn save_scene(seen: &Seen, scene: &RwLock<Scene>, path: &Path) -> Result<(), Failure> {
    let mut scene = scene.write().unwrap_or_else(PoisonError::into_inner);
    scene.camera = seen.camera.clone();
    scene.settings = seen.settings.clone();
    seen.title.clone_into(&mut scene.title);
    Ok(write(&scene, path)?)
}

/// `view-002.png` if there is a picture or a scene `view-001` already.
#[cfg(feature = "view")]
pub(super) fn free_name(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let suffix = path.extension().unwrap_or_default();
    let names = (1_u32..)
        .map(|number| path.with_file_name(format!("{stem}-{number:03}")).with_extension(suffix));
    let free = |name: &PathBuf| {
        !name.exists()
            && !name.with_extension("toml").exists()
            && !name.with_extension("csv").exists()
    };
    names.into_iter().find(free).unwrap_or_else(|| path.to_owned())
}
