//! A cache of reference images in files. File names contain a digest of everything that the image
//! depends on: the scene, the settings, and the renderer, represented by an image of one sample per
//! pixel. So a change of any of these renders the reference again.

use crate::bench::BenchError;
use crate::bench::scenes::NamedScene;
use spherule_render::atomic::check_destination;
use spherule_render::image::{Image, WriteOptions};
use spherule_render::scene::Settings;
use std::fmt::{self, Write};
use std::fs;
use std::path::Path;

/// Version of the cache, part of the digest; a new one invalidates old files.
const FORMAT: u32 = 2;

/// Reads the image of a scene with these settings from the folder, or renders it and writes it there.
/// `sample` is the scene rendered with one sample per pixel, which identifies the renderer.
///
/// # Errors
/// The image cannot be rendered or written.
pub(super) fn load_or_render(
    folder: &Path,
    scene: &NamedScene,
    settings: &Settings,
    sample: &Image,
    render: impl FnOnce() -> Result<Image, BenchError>,
) -> Result<Image, BenchError> {
    let digest = digest(scene, settings, sample);
    let path = folder.join(format!("{}-{digest:016x}.pfm", scene.stem()));
    let fits = |image: &Image| (image.width, image.height) == (settings.width, settings.height);
    // A missing or damaged file is rendered again.
    if let Some(image) = Image::read(&path).ok().filter(fits) {
        return Ok(image);
    }
    let unwritable = |error| BenchError::Write(path.clone(), error);
    fs::create_dir_all(folder).map_err(unwritable)?;
    // The render may take hours, so check first that the file can be written.
    check_destination(&path).map_err(unwritable)?;
    let image = render()?;
    image.write(&path, &WriteOptions::default())?;
    Ok(image)
}

/// Returns a digest of all that the image depends on: scene, settings, version and renderer.
fn digest(scene: &NamedScene, settings: &Settings, sample: &Image) -> u64 {
    let mut digest = Digest(0xcbf2_9ce4_8422_2325);
    let version = env!("CARGO_PKG_VERSION");
    // Hashing cannot fail.
    let _ = write!(digest, "{FORMAT} {version} {settings:?} {:?}", scene.scene);
    digest.add(bytemuck::cast_slice(&sample.pixels));
    digest.0
}

/// The 64-bit FNV-1a hash of the bytes written to it (Fowler, Noll, Vo, "The FNV Non-Cryptographic
/// Hash Algorithm", IETF draft). The standard library's hash may differ between its versions.
struct Digest(u64);

impl Digest {
    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_match_published_values() {
        let mut digest = Digest(0xcbf2_9ce4_8422_2325);
        digest.write_str("foobar").unwrap();
        assert_eq!(digest.0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn images_are_cached_until_something_changes() {
        let folder = tempfile::tempdir().unwrap();
        let scene = NamedScene::named("furnace").unwrap().resized(2);
        let settings = &scene.scene.settings;
        let render = |x: f32| move || Ok(Image::filled(2, 2, [x; 3])?);
        let of = |settings: &Settings, sample, x| {
            let sample = Image::filled(2, 2, [sample; 3]).unwrap();
            load_or_render(folder.path(), &scene, settings, &sample, render(x)).unwrap().pixels[0]
                [0]
        };
        let first = |x| of(settings, 0.5, x);
        assert_eq!([first(1.0), first(2.0)], [1.0; 2]);
        let other = Settings { seed: 99, ..settings.clone() };
        assert_eq!(of(&other, 0.5, 3.0), 3.0);
        // Another renderer.
        assert_eq!(of(settings, 0.25, 5.0), 5.0);
        for entry in fs::read_dir(folder.path()).unwrap() {
            fs::write(entry.unwrap().path(), "damaged").unwrap();
        }
        assert_eq!(first(4.0), 4.0);
    }
}
