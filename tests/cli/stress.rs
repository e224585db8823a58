//! `spherule stress`.

use crate::folder::{Folder, text};
use std::fs;

#[test]
fn the_table_ends_with_the_verdict() {
    let folder = Folder::new();
    let output = folder.run(&["stress", "--rays", "3300", "--seed", "3"]);
    let (table, messages) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{table}{messages}");
    assert!(table.starts_with("decisions") && table.contains("\nfar_1e6 "), "{table}");
    let last = table.lines().last().unwrap_or_default();
    assert!(last.starts_with("0 wrong results in 4,"), "{last}");
    assert!(messages.contains("3,300 rays in"), "{messages}");
    let quiet = folder.run(&["stress", "--rays", "3300", "--seed", "3", "--quiet"]);
    assert_eq!(text(&quiet.stdout).trim_end(), last);
    assert!(quiet.stderr.is_empty());
}

#[test]
fn the_report_is_the_same_on_every_number_of_threads() {
    let folder = Folder::new();
    let usual = ["stress", "--rays", "4000", "--json", "--quiet", "--threads"];
    let run = |threads| folder.json(&[&usual[..], &[threads]].concat());
    let report = run("1");
    assert_eq!(report, run("3"));
    assert_eq!((&report["wrong"], &report["rays"]), (&0.into(), &4000.into()));
    let far = &report["regimes"][4];
    assert_eq!((&far["name"], &far["forms"][0]["form"]), (&"far_1e5".into(), &"naive".into()));
    assert!(far["forms"][0]["wrong_hits"].as_u64() > Some(0));
    assert_eq!(far["forms"][3]["wrong_hits"], 0);
}

#[test]
fn files_hold_the_regimes_asked_for() {
    let folder = Folder::new();
    let usual = ["stress", "--rays", "2000", "--quiet", "--csv", "a.csv"];
    let regimes = ["--regime", "twins", "near_unit", "--plot"];
    for name in ["a.png", "a.svg"] {
        folder.succeed(&[&usual[..], &regimes, &[name]].concat());
    }
    let table = text(&folder.read("a.csv"));
    assert_eq!(table.lines().count(), 9);
    assert!(table.lines().nth(4).is_some_and(|row| row.starts_with("near_unit,1000,")), "{table}");
    let svg = text(&folder.read("a.svg"));
    assert!(svg.contains("twins") && svg.contains("near_unit") && !svg.contains("far_1e5"));
    assert!(folder.read("a.png").starts_with(b"\x89PNG"));
    assert_eq!(fs::read_dir(folder.root()).unwrap().count(), 3);
}

#[test]
fn wrong_commands_are_refused_before_the_run() {
    let folder = Folder::new();
    let cases: &[(&str, i32, &[&str])] = &[
        ("stress --rays 0", 2, &["--rays", "1.."]),
        ("stress --rays 1e7", 2, &["--rays"]),
        ("stress --threads 0", 2, &["--threads", "1..=4096"]),
        ("stress --regime nowhere", 2, &["nowhere", "far_1e6"]),
        ("stress --plot a.pdf", 2, &["--plot", ".png or .svg"]),
        ("stress --csv missing/a.csv", 1, &["missing", "folder"]),
        ("stress --plot missing/a.svg", 1, &["missing", "folder"]),
    ];
    for (line, code, words) in cases {
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{line}: {message}");
        assert!(output.stdout.is_empty(), "{line}");
        for word in *words {
            assert!(message.contains(word), "{line}: {message}");
        }
    }
}
