//! `spherule status`: progress of parts and checkpoints.

use crate::folder::{Folder, SMALL, text};
use serde_json::Value;
use spherule_render::checkpoint::Lock;
use std::fs;

/// Renders parts of the small image.
fn render(folder: &Folder, args: &[&str], parts: &[&str]) {
    for part in parts {
        folder.succeed(
            &[&SMALL, args, &["-o", "a.png", "--split", "samples", "--part", part]].concat(),
        );
    }
}

/// Returns the report on some files, and the exit code.
fn status(folder: &Folder, files: &[&str]) -> (Value, Option<i32>) {
    let output = folder.run(&[&["status", "--json"], files].concat());
    let report = serde_json::from_slice(&output.stdout).expect("one JSON object");
    (report, output.status.code())
}

#[test]
fn finished_and_missing_work_is_reported() {
    let folder = Folder::new();
    render(&folder, &[], &["1/4", "4/4"]);
    let (report, code) = status(&folder, &["a.1-of-4.part", "a.4-of-4.part"]);
    assert_eq!((code, &report["complete"]), (Some(3), &Value::Bool(false)));
    assert_eq!(report["missing"], serde_json::json!(["samples 2 to 3 of tiles 1 to 6"]));
    assert_eq!(report["missing_parts"], serde_json::json!([2, 3]));
    let pixels = 40 * 24;
    assert_eq!(
        (&report["samples"], &report["wanted"]),
        (&(2 * pixels).into(), &(4 * pixels).into())
    );
    let seconds = |name: &str| report[name].as_f64().expect("a number");
    let took: f64 =
        (0..2).map(|i| report["files"][i]["render_seconds"].as_f64().expect("a number")).sum();
    // Half of the samples remain, and need as much time as those that are done.
    assert!((seconds("remaining_seconds") - took).abs() < 1e-6 * took);
    assert!((seconds("longest_remaining_seconds") - took / 2.0).abs() < 1e-6 * took);
    render(&folder, &[], &["2/4", "3/4"]);
    let all = ["a.3-of-4.part", "a.1-of-4.part", "a.2-of-4.part", "a.4-of-4.part"];
    let (report, code) = status(&folder, &all);
    assert_eq!((code, &report["complete"]), (Some(0), &Value::Bool(true)));
    assert_eq!(report["remaining_seconds"], 0.0);
    let lines = folder.succeed(&[&["status"], &all[..]].concat());
    assert!(lines.contains("100.0 %") && lines.contains("a.3-of-4.part  complete"), "{lines}");
}

#[test]
fn unusable_files_are_named_with_the_reason() {
    let folder = Folder::new();
    render(&folder, &[], &["1/2", "1/4"]);
    render(&folder, &["--seed", "3"], &["2/2"]);
    render(&folder, &["--filter", "box"], &["2/3"]);
    fs::write(folder.path("b.part"), "no checkpoint").expect("it can be written");
    let mut damaged = folder.read("a.1-of-2.part");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(folder.path("c.part"), damaged).expect("it can be written");
    for (file, word) in [
        ("a.1-of-4.part", "a.1-of-2.part"),
        ("a.2-of-2.part", "another scene than a.1-of-2.part"),
        ("a.2-of-3.part", "filter"),
        ("b.part", "not a checkpoint"),
        ("c.part", "damaged"),
    ] {
        let (report, code) = status(&folder, &["a.1-of-2.part", file]);
        assert_eq!((code, &report["files"][1]["state"]), (Some(1), &"unusable".into()), "{file}");
        let problem = report["files"][1]["problem"].as_str().expect("a reason");
        assert!(problem.contains(word), "{problem}");
        assert_eq!(report["samples"], 40 * 24 * 2, "{file}");
    }
}

#[test]
fn absent_files_are_missing() {
    let folder = Folder::new();
    let (report, code) = status(&folder, &["a.*.part"]);
    assert_eq!((code, &report["files"][0]["state"]), (Some(3), &"missing".into()));
    assert!(report["remaining_seconds"].is_null());
    let lines = folder.run(&["status", "a.*.part"]);
    assert!(text(&lines.stdout).contains("no file matches"), "{}", text(&lines.stdout));
    assert_eq!(folder.run(&["status"]).status.code(), Some(2));
}

#[test]
fn running_parts_are_distinguished_from_interrupted_ones() {
    let folder = Folder::new();
    render(&folder, &[], &["1/3"]);
    let begun = Lock::take(&folder.path("a.2-of-3.part")).expect("nobody else has it");
    let (report, code) = status(&folder, &["a.1-of-3.part"]);
    assert_eq!(code, Some(3));
    assert_eq!(report["files"][1]["state"], "rendering");
    assert_eq!(report["missing_parts"], serde_json::json!([3]));
    drop(begun);
    let (report, _) = status(&folder, &["a.1-of-3.part"]);
    assert_eq!(report["missing_parts"], serde_json::json!([2, 3]));
}
