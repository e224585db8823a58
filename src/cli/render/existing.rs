//! Pictures that exist: whether a file is the picture that would be rendered, by what it says of itself.

use super::job::Job;
use super::metadata::{self, INTERRUPTED, SAMPLES_TAKEN, SCENE};
use super::prepare::Placed;
use crate::cli::output;
use spherule::image::{Image, Metadata, read_metadata};

/// Metadata keys that say how a render went, not what it was to be.
const RESULTS: [&str; 4] = ["rounds", SAMPLES_TAKEN, "error", "error bound"];

/// Returns whether the file of the picture is that picture already; says why it is not, if there is
/// one.
pub(super) fn is_there(job: &Job, placed: &Placed) -> bool {
    if !job.sequence.skip_existing || !job.output.exists() {
        return false;
    }
    let Some(why) = difference(job, placed) else { return true };
    if !job.report.quiet {
        output::note(format_args!(
            "{}: exists, but {why}; it is rendered anew",
            job.output.display()
        ));
    }
    false
}

/// Why the file is another picture.
fn difference(job: &Job, placed: &Placed) -> Option<String> {
    let found = match read_metadata(&job.output) {
        Ok(found) => found,
        Err(error) => return Some(format!("cannot be read ({error})")),
    };
    let timed = placed.scene.settings.has_target();
    if let Some(why) = differs(&metadata::expected(job, placed), &found, timed) {
        return Some(why);
    }
    // What is cut off may still say what it was to be.
    match Image::read(&job.output) {
        Err(error) => Some(format!("cannot be read ({error})")),
        Ok(image) if (image.width, image.height) != (placed.region.width, placed.region.height) => {
            Some(format!("its size is {}x{}", image.width, image.height))
        }
        Ok(_) => None,
    }
}

/// Returns the first difference of a file's metadata from what is expected; `measured` ones say how
/// many samples they took.
fn differs(expected: &Metadata, found: &Metadata, measured: bool) -> Option<String> {
    if found.value(SCENE).is_none() {
        return Some("does not say of which scene it is".to_owned());
    }
    if found.value(INTERRUPTED).is_some() || !measured && found.value(SAMPLES_TAKEN).is_some() {
        return Some("was interrupted".to_owned());
    }
    for (key, value) in expected.iter() {
        match found.value(key) {
            Some(own) if own == value => {}
            Some(own) if key == SCENE => return Some(scene_differs(value, own)),
            Some(own) => return Some(format!("its {key} is {own}, not {value}")),
            None => return Some(format!("says nothing of {key}, which is {value}")),
        }
    }
    let mut keys = found.iter().map(|(key, _)| key);
    let other = keys.find(|key| expected.value(key).is_none() && !RESULTS.contains(key));
    other.map(|key| format!("says something of {key}, which is not given"))
}

/// The part of a scene that is another one.
fn scene_differs(expected: &str, found: &str) -> String {
    let mut parts = expected.split(", ").zip(found.split(", "));
    let other = parts.find(|(expected, found)| expected != found);
    let name = other.and_then(|(part, _)| part.split(' ').next()).unwrap_or("scene");
    format!("shows another scene: other {name}")
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
            (&[(SCENE, "")], "which scene"),
            (&[(SCENE, "spheres 01, camera 03")], "camera"),
            (&[("slice", "z>3")], "slice"),
            (&[(SAMPLES_TAKEN, "7")], "interrupted"),
            (&[(INTERRUPTED, "true")], "interrupted"),
        ] {
            assert!(with(entries).contains(word), "{entries:?}: {}", with(entries));
        }
        assert_eq!(
            differs(&expected, &metadata(&[]), true).as_deref(),
            Some("does not say of which scene it is")
        );
    }
}
