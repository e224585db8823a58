//! Resuming without faults: what can resume, and errors.

use crate::folder::{Folder, text};
use crate::long::{end, start, wait_for_change};
use std::fs;

/// A particle file with columns and a cell.
fn particles(folder: &Folder) {
    let head = "60\nLattice=\"4 0 0 0 4 0 0 0 4\" Properties=species:S:1:pos:R:3:heat:R:1\n";
    let row = |i: usize| {
        let (x, y, z) = (i % 4, i / 4 % 4, i / 16);
        format!("{} {x}.1 {y}.2 {z}.3 {i}\n", ["Na", "Cl"][i % 2])
    };
    let rows = head.to_owned() + &(0..60).map(row).collect::<String>();
    folder.write("salt.xyz", &rows);
}

const LOOKS: [&str; 17] = [
    "render",
    "salt.xyz",
    "--color-by",
    "heat",
    "--color-range",
    "-5,70",
    "--select",
    "heat > 3",
    "--type",
    "Na:radius=0.9",
    "--type",
    "Cl:material=glass",
    "--cell",
    "--view",
    "-x",
    "--size",
    "80x60",
];

/// Starts a render with a checkpoint, and ends it by a signal.
fn interrupt(folder: &Folder, args: &[&str]) {
    let keep = ["--quiet", "--checkpoint", "c", "--checkpoint-every", "1ms"];
    let render = start(folder, &[args, &keep].concat());
    wait_for_change(&folder.path("c"));
    render.signal(&["TERM"]);
    let (code, message) = end(render);
    assert_eq!(code, Some(143), "{message}");
}

#[test]
fn checkpoints_resume_from_any_folder_without_options() {
    let folder = Folder::new();
    particles(&folder);
    let long = [&LOOKS[..], &["--spp", "100", "-o", "a.png"]].concat();
    folder.succeed(&[&long[..], &["--quiet"]].concat());
    let expected = folder.read("a.png");
    interrupt(&folder, &long);
    assert!(folder.read("a.png") != expected);
    // From another folder, with the files of the first.
    fs::create_dir(folder.path("below")).expect("a folder");
    let below = "cd below && exec \"$0\" render --resume ../c --threads 1 --quiet";
    assert!(folder.shell(below, &[]).status.success());
    assert!(folder.read("a.png") == expected);
    // With all files moved: those at the new place are used.
    let moved = Folder::new();
    for name in ["salt.xyz", "c"] {
        fs::copy(folder.path(name), moved.path(name)).expect("a copy");
    }
    drop(folder);
    moved.succeed(&["render", "--resume", "c", "-o", "b.png", "--quiet"]);
    assert!(moved.read("b.png") == expected);
}

#[test]
fn finished_renders_are_extended() {
    let folder = Folder::new();
    let small = ["render", "--size", "80x60", "--quiet"];
    folder.succeed(&[&small[..], &["--spp", "96", "-o", "straight.exr"]].concat());
    folder.succeed(&[&small[..], &["--spp", "10", "--checkpoint", "c"]].concat());
    folder.succeed(&["render", "--resume", "c", "--spp", "50", "--quiet"]);
    let other = ["--traversal", "packet", "--lanes", "4", "--builder", "median", "--threads", "3"];
    let last = ["render", "--resume", "c", "--spp", "96", "-o", "more.exr"];
    folder.succeed(&[&last[..], &other].concat());
    assert!(folder.read("more.exr") == folder.read("straight.exr"));
    // A smaller error after a larger one: the metadata has the smaller one.
    folder.succeed(&[&small[..], &["--until-error", "50%", "--checkpoint", "d"]].concat());
    let report = folder.json(&["render", "--resume", "d", "--until-error", "15%", "--json", "-q"]);
    assert!(report["noise"]["bound"].as_f64().is_some_and(|bound| bound <= 0.15), "{report}");
    let picture = folder.read("spherule.png");
    assert!(text(&picture).contains("earlier targets"));
}

#[test]
fn other_scenes_and_settings_are_refused_by_name() {
    let folder = Folder::new();
    particles(&folder);
    interrupt(&folder, &[&LOOKS[..], &["--spp", "100000"]].concat());
    let kept = folder.read("c");
    let refused = |args: &[&str], named: &str| {
        let output = folder.run(&[&["render", "--resume", "c"], args].concat());
        let message = text(&output.stderr);
        assert!([Some(1), Some(2)].contains(&output.status.code()), "{args:?}: {message}");
        assert!(message.contains(named), "{args:?}: {message}");
        assert!(folder.read("c") == kept, "{args:?}");
    };
    refused(&["--seed", "4"], "seed is 4, but was 0");
    refused(&["--size", "90x60"], "size is [90, 60], but was [80, 60]");
    refused(&["--spp", "5"], "spp is 5, but 100000 was asked for");
    refused(&["--until-error", "1%"], "without until_error");
    refused(&["--region", "0,0,8x8"], "the region is 0,0,8x8");
    refused(&["--view", "y"], "the camera of");
    refused(&["--type", "Na:radius=0.8"], "the spheres of");
    refused(&["--layers", "variance", "-o", "a.exr"], "--layers");
    refused(&["--checkpoint", "salt.xyz"], "already exists");
    let rows = String::from_utf8(folder.read("salt.xyz")).expect("a text");
    folder.write("salt.xyz", &rows.replace("3.1 2.2", "3.1 2.25"));
    refused(&[], "the spheres of");
}
