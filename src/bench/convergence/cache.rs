//! References in files: called by a digest of all that they depend on, so that what has changed is
//! rendered anew: the scene, the settings, and what renders, told by a picture of one sample.

use crate::atomic::check_destination;
use crate::bench::BenchError;
use crate::bench::scenes::NamedScene;
use crate::image::{Image, WriteOptions};
use crate::scene::Settings;
use std::fmt::{self, Write};
use std::fs;
use std::path::Path;

/// Of the files; to be raised where old ones are to be forgotten.
const FORMAT: u32 = 2;

/// The picture of a scene with these settings: from the folder, or else rendered and put there.
/// `sample` is what the renderer makes of the scene by one sample of each pixel: another renderer
/// makes another one.
///
/// # Errors
/// It cannot be written.
pub(super) fn kept(
    folder: &Path,
    scene: &NamedScene,
    (settings, sample): (&Settings, &Image),
    render: impl FnOnce() -> Result<Image, BenchError>,
) -> Result<Image, BenchError> {
    let digest = digest(scene, settings, sample);
    let path = folder.join(format!("{}-{digest:016x}.pfm", scene.stem()));
    let fits = |image: &Image| (image.width, image.height) == (settings.width, settings.height);
    // What cannot be read, or is damaged, is rendered again.
    if let Some(image) = Image::read(&path).ok().filter(fits) {
        return Ok(image);
    }
    let unwritable = |error| BenchError::Write(path.clone(), error);
    fs::create_dir_all(folder).map_err(unwritable)?;
    // The room for the file is checked before hours go into it.
    check_destination(&path).map_err(unwritable)?;
    let image = render()?;
    image.write(&path, &WriteOptions::default())?;
    Ok(image)
}

/// Of all that the picture depends on: the scene, the settings, and the program's version and work.
fn digest(scene: &NamedScene, settings: &Settings, sample: &Image) -> u64 {
    let mut digest = Digest(0xcbf2_9ce4_8422_2325);
    let version = env!("CARGO_PKG_VERSION");
    // Hashing cannot fail.
    let _ = write!(digest, "{FORMAT} {version} {settings:?} {:?}", scene.scene);
    digest.add(bytemuck::cast_slice(&sample.pixels));
    digest.0
}

/// FNV-1a of 64 bits (Fowler, Noll, Vo, "The FNV Non-Cryptographic Hash Algorithm", IETF draft), of
/// what is written to it: the standard library's hash may differ between its versions.
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
    fn digests_are_the_published_ones() {
        let mut digest = Digest(0xcbf2_9ce4_8422_2325);
        digest.write_str("foobar").unwrap();
        assert_eq!(digest.0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn pictures_are_kept_until_something_changes() {
        let folder = tempfile::tempdir().unwrap();
        let scene = NamedScene::named("furnace").unwrap().resized(2);
        let settings = &scene.scene.settings;
        let render = |x: f32| move || Ok(Image::filled(2, 2, [x; 3])?);
        let of = |settings: &Settings, sample, x| {
            let sample = Image::filled(2, 2, [sample; 3]).unwrap();
            kept(folder.path(), &scene, (settings, &sample), render(x)).unwrap().pixels[0][0]
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
