//! Layers of images on the command line.

use crate::folder::{Folder, text};
use exr::meta::MetaData;
use spherule_render::image::Image;

/// Returns the names of a file's channels.
fn channels(folder: &Folder, name: &str) -> Vec<String> {
    let meta = MetaData::read_from_file(folder.path(name), true).expect("an EXR file");
    assert_eq!(meta.headers.len(), 1);
    meta.headers[0].channels.list.iter().map(|channel| channel.name.to_string()).collect()
}

#[test]
fn the_picture_has_the_requested_layers() {
    let folder = Folder::new();
    folder.picture("plain.exr", &[]);
    assert_eq!(channels(&folder, "plain.exr"), ["B", "G", "R"]);
    folder.picture("two.exr", &["--layers", "id,depth"]);
    assert_eq!(channels(&folder, "two.exr"), ["B", "G", "R", "depth.Z", "id.Y"]);
    let all = folder.picture("all.exr", &["--layers", "all", "--threads", "1"]);
    assert_eq!(channels(&folder, "all.exr").len(), 16);
    folder.picture("noise.exr", &["--layers", "variance,samples"]);
    let noise = ["B", "G", "R", "samples.Y", "variance.B", "variance.G", "variance.R"];
    assert_eq!(channels(&folder, "noise.exr"), noise);
    assert!(folder.picture("all.exr", &["--layers", "all", "--lanes", "4"]) == all);
    let picture = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert_eq!(picture("all.exr"), picture("plain.exr"));
    assert_eq!(picture("two.exr"), picture("plain.exr"));
}

#[test]
fn invalid_layers_are_refused_with_help() {
    let folder = Folder::new();
    for (line, words) in [
        ("render -o a.exr --layers albedo,shade", ["shade", "albedo, normal, depth"]),
        ("render -o a.exr --layers", ["--layers", "value"]),
        ("render -o a.png --layers id", ["PNG", ".exr"]),
        ("render --layers all", ["PNG", ".exr"]),
    ] {
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        for word in words {
            assert!(message.contains(word), "{line} lacks `{word}`: {message}");
        }
    }
    assert!(!folder.path("a.exr").exists());
}
