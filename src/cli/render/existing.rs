//! Detection of existing images for `--skip-existing`, by their metadata.

use super::metadata::{self, BEFORE, DENOISED, INTERRUPTED, SAMPLES_TAKEN, SCENE};
use super::prepare::PlacedScene;
use super::setup::RenderSetup;
use crate::cli::output;
use spherule_render::image::{Image, Metadata, read_metadata};

/// Metadata keys of results, which are not compared.
const RESULTS: [&str; 6] = ["rounds", SAMPLES_TAKEN, "error", "error bound", DENOISED, BEFORE];

/// Returns whether the output file already is the image to render. Prints the reason if it exists but is
/// another image.
pub(super) fn is_up_to_date(setup: &RenderSetup, placed: &PlacedScene) -> bool {
    if !setup.sequence.skip_existing || !setup.output.exists() {
        return false;
    }
    let Some(why) = difference(setup, placed) else { return true };
    if !setup.report.quiet {
        output::note(format_args!(
            "{}: already exists, but {why}; rendering it again",
            setup.output.display()
        ));
    }
    false
}

/// Returns the reason why the file is another image.
fn difference(setup: &RenderSetup, placed: &PlacedScene) -> Option<String> {
    let found = match read_metadata(&setup.output) {
        Ok(found) => found,
        Err(error) => return Some(format!("cannot be read ({error})")),
    };
    let timed = placed.scene.settings.has_target();
    if let Some(why) = differs(&metadata::expected(setup, placed), &found, timed) {
        return Some(why);
    }
    // A truncated file may have complete metadata.
    match Image::read(&setup.output) {
        Err(error) => Some(format!("cannot be read ({error})")),
        Ok(image) if (image.width, image.height) != (placed.region.width, placed.region.height) => {
            Some(format!("its size is {}x{}", image.width, image.height))
        }
        Ok(_) => None,
    }
}

/// Returns the first difference of a file's metadata from the expected metadata. If `measured` is true, the
/// number of samples depends on a target and is recorded.
fn differs(expected: &Metadata, found: &Metadata, measured: bool) -> Option<String> {
    if found.value(SCENE).is_none() {
        return Some("its metadata does not identify the scene".to_owned());
    }
    if found.value(INTERRUPTED).is_some() || !measured && found.value(SAMPLES_TAKEN).is_some() {
        return Some("was interrupted".to_owned());
    }
    for (key, value) in expected.iter() {
        match found.value(key) {
            Some(own) if own == value => {}
            Some(own) if key == SCENE => return Some(scene_differs(value, own)),
            Some(own) => return Some(format!("its {key} is {own} instead of {value}")),
            None => return Some(format!("its metadata lacks {key}, which is {value}")),
        }
    }
    let mut keys = found.iter().map(|(key, _)| key);
    let other = keys.find(|key| expected.value(key).is_none() && !RESULTS.contains(key));
    other.map(|key| format!("its metadata has {key}, which is not set"))
}

/// Returns a message that names the part of the scene that differs.
fn scene_differs(expected: &str, found: &str) -> String {
    let mut parts = expected.split(", ").zip(found.split(", "));
    let other = parts.find(|(expected, found)| expected != found);
    let name = other.and_then(|(part, _)| part.split(' ').next()).unwrap_or("scene");
    format!("it shows another scene, with different {name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata(entries: &[(&str, &str)]) -> Metadata {
        entries.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn every_difference_is_named() {
        let expected = metadata(&[("spp", "4"), ("frame", "2"), (SCENE, "spheres 01, camera 02")]);
        let with = |entries: &[(&str, &str)]| {
            let own = [("spp", "4"), ("frame", "2"), (SCENE, "spheres 01, camera 02")];
            let kept = own.iter().filter(|(key, _)| entries.iter().all(|(other, _)| other != key));
            let all: Vec<_> =
                kept.chain(entries).copied().filter(|(_, value)| !value.is_empty()).collect();
            differs(&expected, &metadata(&all), false).unwrap_or_default()
        };
        assert_eq!(with(&[]), "");
        assert_eq!(with(&[("error", "0.1")]), "");
        for (entries, word) in [
            (&[("spp", "9")][..], "spp is 9"),
            (&[("frame", "")], "frame"),
            (&[(SCENE, "")], "identify the scene"),
            (&[(SCENE, "spheres 01, camera 03")], "camera"),
            (&[("slice", "z>3")], "slice"),
            (&[(SAMPLES_TAKEN, "7")], "interrupted"),
            (&[(INTERRUPTED, "true")], "interrupted"),
        ] {
            assert!(with(entries).contains(word), "{entries:?}: {}", with(entries));
        }
        assert_eq!(
            differs(&expected, &metadata(&[]), true).as_deref(),
            Some("its metadata does not identify the scene")
        );
    }
}
