//! Images: equal with all speed options, and options that change them.

use crate::folder::{Folder, text};
use spherule_render::image::{Image, read_metadata};

#[test]
fn pictures_of_any_proportions_are_made() {
    let folder = Folder::new();
    for size in ["65535x1", "1x65535"] {
        let output = folder.succeed(&["render", "--size", size, "--spp", "1", "-q", "-o", "a.exr"]);
        assert!(output.is_empty(), "{output}");
        let picture = Image::read(folder.path("a.exr")).expect("a picture");
        assert_eq!(format!("{}x{}", picture.width, picture.height), size);
        let lit = picture.pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
        assert!(lit > picture.pixels.len() / 2, "{size}: {lit}");
    }
}

#[test]
fn speed_settings_never_change_the_file() {
    let folder = Folder::new();
    let mut speeds = vec![vec!["--threads", "2"], vec!["--traversal", "scalar"]];
    for builder in ["median", "surface-area", "morton", "auto"] {
        speeds.push(vec!["--builder", builder]);
    }
    for lanes in ["1", "4", "8", "16"] {
        speeds.push(vec!["--lanes", lanes]);
        speeds.push(vec!["--lanes", lanes, "--traversal", "packet"]);
        speeds.push(vec!["--lanes", lanes, "--traversal", "brute", "--threads", "2"]);
    }
    // Whose numbers are in full, and whose metadata; then one of each option.
    for (name, speeds) in
        [("a.exr", &speeds[..]), ("a.png", &[&speeds[..3], &speeds[8..9]].concat())]
    {
        let reference = folder.picture(name, &["--threads", "1"]);
        for speed in speeds {
            assert!(folder.picture(name, speed) == reference, "{name} {speed:?}");
        }
        assert!(folder.picture(name, &["--seed", "1"]) != reference);
    }
}

#[test]
fn regions_are_parts_of_the_whole() {
    let folder = Folder::new();
    folder.picture("whole.pfm", &[]);
    folder.picture("part.pfm", &["--region", "5,7,20x11"]);
    let whole = Image::read(folder.path("whole.pfm")).unwrap();
    let part = Image::read(folder.path("part.pfm")).unwrap();
    assert_eq!((part.width, part.height), (20, 11));
    for y in 0..part.height {
        for x in 0..part.width {
            assert_eq!(part.pixel(x, y), whole.pixel(x + 5, y + 7), "{x}, {y}");
        }
    }
    folder.picture("corner.pfm", &["--region", "39,23,1x1"]);
    assert_eq!(Image::read(folder.path("corner.pfm")).unwrap().pixel(0, 0), whole.pixel(39, 23));
}

#[test]
fn options_have_an_effect() {
    let folder = Folder::new();
    let usual = folder.picture("a.ppm", &[]);
    assert!(usual.starts_with(b"P6"));
    assert!(folder.picture("a.ppm", &["--ppm", "plain"]).starts_with(b"P3"));
    assert!(text(&folder.picture("a.ppm", &["--bits", "16"])).contains("65535"));
    for options in [
        ["--exposure", "-1.5"],
        ["--tone", "linear"],
        ["--integrator", "whitted"],
        ["--integrator", "ao"],
        ["--sampler", "stratified"],
        ["--sampler", "independent"],
        ["--filter", "box"],
        ["--filter", "gaussian"],
        ["--roulette", "0.5"],
        ["--roulette", "none"],
        ["--depth", "1"],
    ] {
        assert!(folder.picture("b.ppm", &options) != usual, "{options:?}");
        let other = Image::read(folder.path("b.ppm")).unwrap();
        assert_eq!((other.width, other.height), (40, 24));
    }
    folder.succeed(&["render", "--size", "40x24", "--spp", "5", "--quiet", "-o", "b.ppm"]);
    assert!(folder.read("b.ppm") != usual);
}

#[test]
fn metadata_has_settings_and_no_secrets() {
    let folder = Folder::new();
    folder.write("scene.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    let scene = folder.path("scene.toml");
    let scene = scene.to_str().unwrap();
    for name in ["a.png", "a.exr", "a.ppm"] {
        folder.picture(name, &[scene, "--seed", "18446744073709551615"]);
        let metadata = read_metadata(folder.path(name)).unwrap();
        let version = concat!("spherule ", env!("CARGO_PKG_VERSION"));
        assert_eq!(metadata.value("Software"), Some(version));
        assert_eq!(metadata.value("Title"), Some("scene.toml"));
        assert_eq!(metadata.value("seed"), Some("18446744073709551615"));
        assert_eq!(metadata.value("spp"), Some("4"));
        assert!(metadata.iter().all(|(_, value)| !value.contains('/')));
    }
}

#[test]
fn every_kind_of_field_is_written_described_and_rendered() {
    let folder = Folder::new();
    let kinds: [(&str, &[&str], u64); 6] = [
        ("grid", &["--count", "3", "--spacing", "2", "--radius", "0.5"], 9),
        ("field", &["--count", "4", "--mix", "1,1,1", "--radius", "0.2,0.3"], 16),
        ("volume", &["--count", "50", "--size", "3", "--colors", "true"], 50),
        ("lattice", &["--count", "2", "--jitter", "0.03"], 32),
        ("sphereflake", &["--level", "2"], 91),
        ("weekend", &[], 0),
    ];
    for (kind, parameters, count) in kinds {
        folder.succeed(&[&["field", kind, "-o", "scene.toml"], parameters].concat());
        let info = folder.json(&["info", "scene.toml", "--json"]);
        let spheres = info["spheres"].as_u64().unwrap();
        assert!(spheres == count || kind == "weekend" && spheres > 400, "{kind}: {spheres}");
        let bytes = &info["memory"]["sphere_bytes"];
        assert!(bytes.as_u64().unwrap() >= 20 * spheres, "{kind}: {bytes}");
        assert!(folder.succeed(&["info", "scene.toml", "--verbose"]).contains("skipped"));
        assert!(!folder.succeed(&["info", "scene.toml"]).contains("skipped"));
        folder.picture("a.png", &["scene.toml"]);
    }
}

#[test]
fn the_default_field_is_the_default_scene() {
    let folder = Folder::new();
    folder.succeed(&["field", "--seed", "7", "-o", "scene.toml"]);
    let written = folder.picture("a.png", &["scene.toml"]);
    assert!(folder.picture("b.png", &["--seed", "7"]) == written);
}

#[test]
fn particle_files_are_rendered_under_any_suffix() {
    let folder = Folder::new();
    folder.write("dust.txt", "0 0 0 1\n2 0 0 0.5\n");
    assert_eq!(folder.json(&["info", "dust.txt", "--json"])["spheres"], 2);
    folder.picture("a.png", &["dust.txt"]);
    folder.write("gaps.txt", "0 0 0 1\nnan 0 0 0.5\n");
    let info = folder.json(&["info", "gaps.txt", "--json"]);
    assert_eq!(info["warnings"].as_array().unwrap().len(), 1);
}
