//! `render --prepare`: prepared scenes, and renders of them.

use crate::folder::{Folder, SMALL, text};
use std::fs;

/// Particles in a periodic cell, with a column to color by.
const PARTICLES: &str = "4\nLattice=\"4 0 0 0 4 0 0 0 4\" Properties=species:S:1:pos:R:3:charge:R:1\n\
    Na 0 0 0 1\nCl 2 0 0 -1\nNa 2 2 0 1.5\nCl 0 2 0 -0.5\n";

/// A viewer without a window.
const VIEW: [&str; 4] = ["view", "a.prepared", "--headless-script", "a.txt"];

/// Options of appearance and camera.
const LOOKS: [&str; 6] = ["--color-by", "charge", "--view", "iso", "--replicate", "2,1,1"];

#[test]
fn pictures_of_prepared_scenes_are_those_of_the_scene() {
    let folder = Folder::new();
    folder.write("a.xyz", PARTICLES);
    let preset = ["--preset", "studio", "--seed", "7"];
    let args = [&["a.xyz"], &LOOKS[..], &preset].concat();
    folder.succeed(&[&SMALL[..], &args, &["--prepare", "a.prepared"]].concat());
    assert!(!folder.path("spherule.png").exists());
    for name in ["a.png", "a.exr"] {
        let whole = folder.picture(name, &args);
        fs::remove_file(folder.path(name)).expect("it is there");
        // Size, samples and seed are those given when it was prepared.
        folder.succeed(&["render", "a.prepared", "--quiet", "-o", name]);
        assert!(folder.read(name) == whole, "{name}");
    }
    let more = ["--spp", "9", "--exposure", "1", "--size", "80x48", "--quiet", "-o", "more.png"];
    folder.succeed(&[&["render"], &args[..], &more].concat());
    let whole = folder.read("more.png");
    fs::remove_file(folder.path("more.png")).expect("it is there");
    folder.succeed(&[&["render", "a.prepared"], &more[..]].concat());
    assert!(folder.read("more.png") == whole);
}

#[test]
fn prepared_scenes_stop_by_themselves_if_nothing_was_said() {
    let folder = Folder::new();
    folder.write("a.xyz", PARTICLES);
    let size = ["render", "--size", "24x16", "--quiet", "--json"];
    folder.succeed(&[&size[..], &["a.xyz", "--prepare", "a.prepared"]].concat());
    let whole = folder.json(&[&size[..], &["a.xyz", "-o", "a.png"]].concat());
    let again = folder.json(&["render", "a.prepared", "--quiet", "--json", "-o", "b.png"]);
    assert_eq!(again["noise"]["denoised"], whole["noise"]["denoised"]);
    assert!(folder.read("a.png") == folder.read("b.png"));
    let few = ["render", "a.prepared", "--spp", "4", "--quiet", "-o", "c.png"];
    assert_eq!(folder.run(&few).stderr, b"", "no error was asked for");
}

#[test]
fn parts_of_prepared_scenes_merge_with_those_of_the_scene() {
    let folder = Folder::new();
    folder.write(
        "a.toml",
        "[render]\nspp = 4\n[camera]\nfit = true\n[[generate]]\nkind = \"field\"\ncount = 9\n",
    );
    let whole = folder.picture("whole.exr", &["a.toml", "--layers", "all"]);
    folder.succeed(&[&SMALL[..], &["a.toml", "--prepare", "a.prepared"]].concat());
    for (scene, part) in [("a.toml", "1/3"), ("a.prepared", "2/3"), ("a.prepared", "3/3")] {
        let args = [scene, "-o", "a.exr", "--layers", "all", "--part", part];
        folder.succeed(&[&SMALL[..], &args].concat());
    }
    let parts = ["a.1-of-3.part", "a.2-of-3.part", "a.3-of-3.part"];
    folder.succeed(&[&["merge", "-q", "-o", "a.exr"], &parts[..]].concat());
    assert!(folder.read("a.exr") == whole);
}

#[test]
fn checkpoints_of_prepared_scenes_are_resumed() {
    let folder = Folder::new();
    folder.succeed(&[&SMALL[..], &["--prepare", "a.prepared"]].concat());
    folder.picture("b.png", &["a.prepared", "--checkpoint", "b.part"]);
    folder.succeed(&["render", "--resume", "b.part", "--spp", "8", "-o", "b.png", "--quiet"]);
    folder.succeed(&["render", "--size", "40x24", "--spp", "8", "-o", "a.png", "--quiet"]);
    let whole = folder.read("a.png");
    assert!(folder.read("b.png") == whole);
}

#[test]
fn options_that_prepared_scenes_fix_are_refused() {
    let folder = Folder::new();
    folder.write("a.xyz", PARTICLES);
    folder.succeed(&[&SMALL[..], &["a.xyz", "--prepare", "a.prepared"]].concat());
    let refused = |args: &[&str], code: i32, words: &[&str]| {
        let output = folder.run(&[&SMALL[..], args].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {message}");
        for word in words {
            assert!(message.contains(word), "no {word}: {message}");
        }
    };
    for change in [
        &["--radii", "2"][..],
        &["--color-by", "charge"],
        &["--type", "Na:radius=2"],
        &["--slice", "x>1"],
        &["--view", "x"],
        &["--margin", "0.2"],
        &["--turntable", "3"],
        &["--frame", "all"],
        &["--preset", "chalk"],
        &["--background", "white"],
        &["--wrap"],
        &["--prepare", "b.prepared"],
    ] {
        refused(&[&["a.prepared"], change].concat(), 2, &["prepared"]);
    }
    let square = folder.run(&["render", "a.prepared", "--size", "40x40"]);
    assert_eq!(square.status.code(), Some(1));
    let message = text(&square.stderr);
    assert!(message.contains("40 x 24") && message.contains("aspect"), "{message}");
    refused(&["a.xyz", "--prepare", "b.prepared", "-o", "b.png"], 2, &["--output"]);
    refused(&["a.xyz", "--prepare", "b.prepared", "--part", "1/2"], 2, &["--part"]);
    refused(&["a.xyz", "--frame", "all", "--prepare", "b.prepared"], 2, &["--prepare"]);
    let before = folder.read("a.xyz");
    refused(&["a.xyz", "--prepare", "./a.xyz"], 2, &["--prepare", "a.xyz"]);
    assert!(folder.read("a.xyz") == before);
    refused(&["a.xyz", "--prepare", "none/b.prepared"], 1, &["none"]);
    for name in ["spherule.png", "b.png", "b.prepared"] {
        assert!(!folder.path(name).exists(), "{name}");
    }
}

#[test]
fn other_commands_name_prepared_scenes() {
    let folder = Folder::new();
    folder.succeed(&[&SMALL[..], &["--prepare", "a.prepared"]].concat());
    folder.write("a.toml", "[[file]]\npath = \"a.prepared\"\n");
    folder.write("a.txt", "quit\n");
    for args in [&["info", "a.prepared"][..], &["render", "a.toml"], &VIEW[..]] {
        let output = folder.run(args);
        assert_eq!(output.status.code(), Some(1), "{args:?}");
        let message = text(&output.stderr);
        assert!(message.contains("prepared scene"), "{args:?}: {message}");
    }
}

#[test]
fn damaged_prepared_scenes_are_refused() {
    let folder = Folder::new();
    folder.succeed(&[&SMALL[..], &["--prepare", "a.prepared"]].concat());
    let bytes = folder.read("a.prepared");
    for (content, word) in [
        (&bytes[..bytes.len() - 1], "damaged"),
        (&bytes[..40], "damaged"),
        (&[&bytes[..2000], &[!bytes[2000]], &bytes[2001..]].concat(), "damaged"),
        (&[&bytes[..18], &9_u32.to_le_bytes(), &bytes[22..]].concat(), "version 9"),
    ] {
        fs::write(folder.path("b.prepared"), content).expect("the folder is there");
        let output = folder.run(&[&SMALL[..], &["b.prepared"]].concat());
        assert_eq!(output.status.code(), Some(1));
        let message = text(&output.stderr);
        assert!(message.contains("b.prepared") && message.contains(word), "{message}");
    }
    assert!(!folder.path("spherule.png").exists());
}
