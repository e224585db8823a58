//! Parts of renders, merged images, and errors.

use crate::folder::{Folder, SMALL, text};
use crate::process;
use std::fs;
use std::process::Output;

/// Renders parts of the small image.
fn render(folder: &Folder, args: &[&str], parts: &[&str]) {
    for part in parts {
        let output = folder.succeed(&[&SMALL, args, &["--part", part]].concat());
        assert!(output.is_empty(), "{output}");
    }
}

#[track_caller]
fn refused(output: &Output, code: i32, words: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "no {word}: {message}");
    }
}

#[test]
fn merged_parts_equal_the_whole_file() {
    let folder = Folder::new();
    let all = ["-o", "a.exr", "--layers", "all", "--tone", "filmic"];
    let whole = folder.picture("whole.exr", &all[2..]);
    for split in ["samples", "tiles"] {
        render(&folder, &[&all[..], &["--split", split]].concat(), &["2/3", "3/3", "1/3"]);
        assert!(!folder.path("a.exr").exists());
        let parts = ["a.3-of-3.part", "a.1-of-3.part", "a.2-of-3.part"];
        folder.succeed(&[&["merge"], &parts[..], &["-o", "b.exr", "-q"]].concat());
        assert!(folder.read("b.exr") == whole, "{split}");
        // Without layers and statistics, except for measurements; with the exposure given here.
        folder.succeed(&[&["merge"], &parts[..], &["-o", "b.png", "-q"]].concat());
        folder
            .succeed(&[&["merge"], &parts[..], &["-o", "c.exr", "-q", "--layers", "id"]].concat());
        assert!(folder.read("c.exr").len() < whole.len());
        for part in parts {
            fs::remove_file(folder.path(part)).expect("it is there");
        }
    }
    let png = ["--layers", "variance", "--exposure", "1"];
    render(&folder, &[&["-o", "a.exr"], &png[..]].concat(), &["1/2", "2/2"]);
    let merge = ["merge", "a.1-of-2.part", "a.2-of-2.part", "-q", "-o"];
    folder.succeed(&[&merge[..], &["plain.png"]].concat());
    folder.succeed(&[&merge[..], &["again.png", "--exposure", "0"]].concat());
    assert!(folder.read("plain.png") != folder.read("again.png"));
}

#[test]
fn pictures_of_parts_are_those_of_the_whole_in_every_format() {
    let folder = Folder::new();
    render(&folder, &["-o", "a.png", "--exposure", "0.5"], &["1/4", "2/4", "3/4", "4/4"]);
    let parts: Vec<String> = (1..=4).map(|number| format!("a.{number}-of-4.part")).collect();
    let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
    for name in ["a.png", "a.ppm", "a.pfm", "a.exr"] {
        folder.succeed(&[&["merge", "-q", "-o", name], &parts[..]].concat());
        let merged = folder.read(name);
        assert!(merged == folder.picture(name, &["--exposure", "0.5"]), "{name}");
    }
    let report = folder.json(&[&["merge", "--json", "-o", "b.png"], &parts[..]].concat());
    assert_eq!((&report["parts"], &report["samples"]), (&4.into(), &(40 * 24 * 4).into()));
    assert_eq!((&report["complete"], &report["missing"]), (&true.into(), &serde_json::json!([])));
}

#[test]
fn parts_have_annotations() {
    let folder = Folder::new();
    folder.write("a.xyz", "2\n\nH 0 0 0\nO 1 0 0\n");
    let marks = ["--legend", "--axes", "--scale-bar", "--label", "t = 1 ps"];
    let all = [&["a.xyz"], &marks[..]].concat();
    render(&folder, &[&["-o", "a.png"], &all[..]].concat(), &["1/2", "2/2"]);
    let merge = ["merge", "-q", "-o", "a.png", "a.1-of-2.part", "a.2-of-2.part"];
    folder.succeed(&merge);
    let merged = folder.read("a.png");
    assert!(merged == folder.picture("a.png", &all));
    assert!(merged != folder.picture("a.png", &["a.xyz"]));
}

#[test]
fn parts_have_presets_and_colored_backgrounds() {
    let folder = Folder::new();
    folder.write("a.xyz", "2\n\nH 0 0 0\nO 1 0 0\n");
    for args in [&[][..], &["--preset", "studio"], &["--background", "steelblue"]] {
        let all = [&["a.xyz"], args].concat();
        render(&folder, &[&["-o", "a.png"], &all[..]].concat(), &["1/2", "2/2"]);
        let parts = ["a.1-of-2.part", "a.2-of-2.part"];
        folder.succeed(&[&["merge", "-q", "-o", "a.png"], &parts[..]].concat());
        let merged = folder.read("a.png");
        assert!(merged == folder.picture("a.png", &all), "{args:?}");
        for part in parts {
            fs::remove_file(folder.path(part)).expect("it is there");
        }
    }
}

#[test]
fn the_environment_selects_parts() {
    let folder = Folder::new();
    let run = |task: &str, count: &str| {
        let mut command = folder.command(&SMALL);
        command
            .args(["-o", "a.png", "--part", "from-env"])
            .env("SLURM_ARRAY_TASK_ID", task)
            .env("SLURM_ARRAY_TASK_MIN", "0")
            .env("SLURM_ARRAY_TASK_MAX", "1")
            .env("SLURM_ARRAY_TASK_COUNT", count);
        process::run(&mut command)
    };
    for task in ["0", "1"] {
        let output = run(task, "2");
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    folder.succeed(&["merge", "a.1-of-2.part", "a.2-of-2.part", "-o", "b.png", "-q"]);
    assert!(folder.read("b.png") == folder.picture("a.png", &[]));
    refused(&run("2", "2"), 2, &["SLURM_ARRAY_TASK_ID is 2", "from 0 to 1"]);
    refused(&run("1", "9"), 2, &["SLURM_ARRAY_TASK_COUNT is 9"]);
}

#[test]
fn mismatched_parts_are_named() {
    let folder = Folder::new();
    let render = |args: &[&str], parts: &[&str]| {
        render(&folder, &[args, &["--split", "samples"]].concat(), parts);
    };
    render(&["-o", "a.png"], &["1/4", "2/4", "4/4", "1/2"]);
    render(&["-o", "b.png", "--seed", "5"], &["3/4"]);
    render(&["-o", "c.exr", "--layers", "id"], &["3/4"]);
    let merge =
        |args: &[&str]| folder.run(&[&["merge", "-o", "x.png", "a.4-of-4.part"], args].concat());
    let hole = merge(&["a.2-of-4.part"]);
    refused(&hole, 1, &["no part has sample 1 of tiles 1 to 6", "; nor sample 3", "--partial"]);
    let twice = merge(&["a.2-of-4.part", "a.1-of-2.part", "--partial"]);
    refused(&twice, 1, &["a.1-of-2.part: has sample 2 of", "as does a.2-of-4.part"]);
    refused(&merge(&["b.3-of-4.part"]), 1, &["b.3-of-4.part: is of another scene", "spheres"]);
    refused(&merge(&["c.3-of-4.part"]), 1, &["c.3-of-4.part: has other layers", "a.4-of-4.part"]);
    refused(&merge(&["x.part"]), 1, &["x.part: cannot be read"]);
    assert!(!folder.path("x.png").exists());
    let some = merge(&["a.1-of-2.part", "--partial"]);
    assert!(some.status.success(), "{}", text(&some.stderr));
    refused(&some, 0, &["warning", "no part has sample 3 of tiles 1 to 6", "3 to 3 of 4 samples"]);
    assert!(folder.path("x.png").exists());
}

#[test]
fn damaged_parts_are_refused() {
    let folder = Folder::new();
    render(&folder, &["-o", "a.png"], &["1/1"]);
    let path = folder.path("a.1-of-1.part");
    let whole = fs::read(&path).expect("it is there");
    let merge = || folder.run(&["merge", "a.1-of-1.part", "-o", "b.png"]);
    for at in (0..whole.len()).step_by(whole.len() / 12) {
        let mut damaged = whole.clone();
        damaged[at] ^= 4;
        fs::write(&path, &damaged).expect("it can be written");
        refused(&merge(), 1, &["a.1-of-1.part"]);
        fs::write(&path, &whole[..at]).expect("it can be written");
        refused(&merge(), 1, &["a.1-of-1.part"]);
    }
    fs::write(&path, &whole).expect("it can be written");
    assert!(merge().status.success());
}

#[test]
fn parts_resume_only_by_the_same_command() {
    let folder = Folder::new();
    let samples = ["-o", "a.png", "--split", "samples"];
    render(&folder, &samples, &["2/2"]);
    let first = folder.read("a.2-of-2.part");
    render(&folder, &samples, &["2/2"]);
    folder.succeed(&["merge", "a.2-of-2.part", "--partial", "-o", "once.pfm", "-q"]);
    fs::write(folder.path("a.2-of-2.part"), &first).expect("it can be written");
    folder.succeed(&["render", "--resume", "a.2-of-2.part", "--quiet"]);
    folder.succeed(&["merge", "a.2-of-2.part", "--partial", "-o", "twice.pfm", "-q"]);
    assert!(folder.read("once.pfm") == folder.read("twice.pfm"));
    let other = folder.run(&[&SMALL, &samples[..], &["--part", "2/2", "--filter", "box"]].concat());
    refused(&other, 1, &["a.2-of-2.part", "filter"]);
    let split = ["--part", "2/2", "-o", "a.png", "--split", "tiles"];
    refused(&folder.run(&[&SMALL, &split[..]].concat()), 1, &["a.2-of-2.part", "samples 3 to 4"]);
}

#[test]
fn options_that_parts_do_not_support_are_refused() {
    let folder = Folder::new();
    folder.write("a.xyz", "1\n\nH 0 0 0\n");
    let cases: &[(&str, &[&str])] = &[
        ("--part 0/3", &["--part", "from 1 to N"]),
        ("--part 4/3", &["--part", "3/8"]),
        ("--part from-env/0", &["--part", "from-env/8"]),
        ("--split tiles", &["--part"]),
        ("--part 1/2 --until-error 5%", &["--part", "--until-error none"]),
        ("--part 1/2 --time 5s", &["--part", "--time none"]),
        ("--part 1/9", &["9 parts", "4 samples", "6 parts or fewer"]),
        ("--part 1/5 --split samples", &["5 parts", "by tiles"]),
        ("--part 1/2 --background transparent", &["--background", "--part"]),
        ("--part 1/2 --checkpoint c", &["--checkpoint", "--part"]),
        ("a.xyz --part 1/2 --turntable 3 --split tiles", &["--split", "whole"]),
    ];
    for (line, words) in cases {
        let args: Vec<&str> = line.split(' ').collect();
        refused(&folder.run(&[&SMALL, &args[..]].concat()), 2, words);
    }
    refused(&folder.run(&["merge", "-o", "a.png"]), 2, &["PART"]);
    refused(&folder.run(&["merge", "a.part", "-o", "a.png", "--layers", "id"]), 2, &[".exr"]);
}
