//! `spherule bench`: output files and errors.

use crate::folder::{Folder, text};
use serde_json::Value;
use std::fs;

/// Runs a short measurement.
fn quick(folder: &Folder, args: &[&str]) {
    let output = folder.succeed(&[&["bench"], args, &["--quick", "--quiet", "-o", "out"]].concat());
    assert!(output.is_empty(), "{output}");
}

/// Checks that every file in the folder `out` is complete; returns their names in order.
fn check_files(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(folder.path("out")).expect("a folder that is there");
    let files = entries.flatten().filter(|entry| entry.path().is_file());
    let mut names: Vec<_> =
        files.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    for name in &names {
        let content = folder.read(&format!("out/{name}"));
        check(name, &content);
    }
    names
}

fn check(name: &str, content: &[u8]) {
    let words = text(content);
    match name.rsplit_once('.').map(|name| name.1) {
        Some("csv") => {
            let mut table = csv::Reader::from_reader(content);
            assert!(table.headers().is_ok_and(|names| names.len() > 1), "{name}");
            let rows: Result<Vec<_>, _> = table.records().collect();
            assert!(rows.is_ok_and(|rows| !rows.is_empty()), "{name}");
        }
        Some("json") => {
            let report: Value = serde_json::from_slice(content).expect(name);
            assert!(report["machine"]["version"].is_string(), "{name}");
            assert!(report["tables"][0]["rows"][0].is_object(), "{name}");
        }
        Some("svg") => {
            assert!(words.starts_with("<svg") && words.trim_end().ends_with("</svg>"), "{name}");
            assert!(!words.contains("NaN") && !words.contains("inf"), "{name}");
        }
        Some("png") => assert!(content.starts_with(b"\x89PNG") && content.len() > 1000, "{name}"),
        Some("html") => {
            assert!(words.starts_with("<!DOCTYPE html>") && words.ends_with("</html>\n"), "{name}");
            assert!(words.contains("<svg") && !words.contains("src="), "{name}");
        }
        _ => panic!("{name} was not asked for"),
    }
}

#[test]
fn the_builders_are_measured() {
    let folder = Folder::new();
    quick(&folder, &["build", "--scenes", "paper400", "paper2500"]);
    let names = ["build.csv", "build.html", "build.json", "build.png", "build.svg"];
    assert_eq!(check_files(&folder), names);
    let report: Value = serde_json::from_slice(&folder.read("out/build.json")).unwrap();
    assert_eq!(report["tables"][0]["rows"].as_array().unwrap().len(), 6);
    assert_eq!(report["settings"]["scenes"], "paper400, paper2500");
}

#[test]
fn all_reports_are_on_one_page() {
    let folder = Folder::new();
    quick(&folder, &["all", "--rounds", "1"]);
    let names = check_files(&folder);
    for name in ["traversal", "build", "threads", "skips", "error"] {
        for suffix in ["csv", "json"] {
            assert!(names.contains(&format!("{name}.{suffix}")), "{name}.{suffix}: {names:?}");
        }
    }
    let page = text(&folder.read("out/report.html"));
    let count = |suffix: &str| {
        let end = |name: &&String| name.rsplit_once('.').is_some_and(|name| name.1 == suffix);
        names.iter().filter(end).count()
    };
    assert_eq!(page.matches("<svg").count(), count("svg"));
    assert_eq!(page.matches("<h3>").count(), count("csv"));
    assert_eq!(fs::read_dir(folder.path("out/references")).expect("references").count(), 8);
}

#[test]
fn scenes_come_from_files_and_references_are_used_again() {
    let folder = Folder::new();
    folder.succeed(&["field", "grid", "--count", "3", "--quiet", "-o", "own.toml"]);
    quick(&folder, &["error", "--scenes", "own.toml", "--rounds", "1"]);
    let first = text(&folder.read("out/error-references.csv"));
    quick(&folder, &["error", "--scenes", "own.toml", "--rounds", "1"]);
    assert_eq!(text(&folder.read("out/error-references.csv")), first);
    assert!(check_files(&folder).contains(&"error-time-own.svg".to_owned()));
    assert_eq!(fs::read_dir(folder.path("out/references")).expect("references").count(), 6);
}

#[test]
fn the_papers_tables_are_measured_at_the_requested_scale() {
    let folder = Folder::new();
    quick(&folder, &["paper", "--size", "24", "--spp", "2", "--threads", "2"]);
    let names = check_files(&folder);
    let tables = ["paper-roulette", "paper-spheres", "paper-threads", "paper-together"];
    for table in tables {
        assert!(names.contains(&format!("{table}.csv")), "{names:?}");
    }
    assert!(names.contains(&"paper-spheres.png".to_owned()));
    let report: Value = serde_json::from_slice(&folder.read("out/paper.json")).unwrap();
    let scale = report["settings"]["scale"].as_str().unwrap();
    assert!(scale.starts_with("24 x 24 pixels of 2 samples"), "{scale}");
    assert_eq!(report["tables"][1]["rows"][1]["threads"], 2);
}

#[test]
fn roulette_is_measured_on_the_requested_scenes() {
    let folder = Folder::new();
    quick(&folder, &["roulette", "--scenes", "grid"]);
    let names = check_files(&folder);
    assert_eq!(names[..3], ["roulette-equal.csv", "roulette-grid.png", "roulette-grid.svg"]);
    let report: Value = serde_json::from_slice(&folder.read("out/roulette.json")).unwrap();
    let rows = report["tables"][1]["rows"].as_array().unwrap();
    assert!(rows.len() == 7 && rows.iter().all(|row| row["scene"] == "grid"));
}

#[test]
fn only_earlier_reports_are_replaced() {
    let folder = Folder::new();
    fs::create_dir(folder.path("out")).unwrap();
    folder.write("out/points.csv", "x,y,z\n0,0,0\n1,2,3\n");
    folder.write("out/notes.png", "mine");
    folder.write("own.toml", "[[file]]\npath = \"out/points.csv\"\nradius = 0.5\n");
    let (own, paper) = ("own.toml", "paper-field-20");
    // Other files in the folder are permitted, and those of earlier reports are replaced.
    for scene in [own, paper, own] {
        quick(&folder, &["threads", "--scenes", scene, "--threads-up-to", "1"]);
    }
    for name in ["build.csv", "build.svg", "build.json", "build.html"] {
        let folder = Folder::new();
        fs::create_dir(folder.path("out")).unwrap();
        folder.write(&format!("out/{name}"), "{\"mine\": 1}");
        let args = ["bench", "build", "--quick", "--scenes", "paper400", "-o", "out"];
        let output = folder.run(&args);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{name}: {message}");
        assert!(message.contains(name) && message.contains("already exists"), "{message}");
        assert!(output.stdout.is_empty(), "nothing is measured");
        assert_eq!(folder.read(&format!("out/{name}")), b"{\"mine\": 1}");
        assert_eq!(fs::read_dir(folder.path("out")).unwrap().count(), 1);
    }
}

#[test]
fn invalid_commands_change_no_files() {
    let folder = Folder::new();
    folder.write("file", "old");
    let cases: &[(&str, i32, &[&str])] = &[
        ("bench", 2, &["build", "all"]),
        ("bench nothing", 2, &["nothing"]),
        ("bench build --quick --full", 2, &["--quick", "--full"]),
        ("bench build --rounds 0", 2, &["--rounds", "1..=1000"]),
        ("bench build --threads 0", 2, &["--threads"]),
        ("bench build --quick -o out --scenes nowhere", 1, &["\"nowhere\"", "paper400"]),
        ("bench all --quick --scenes field", 2, &["--scenes", "`all`"]),
        ("bench threads --quick -o out --threads-up-to 0", 2, &["--threads-up-to"]),
        ("bench error --quick -o out --scenes nowhere", 1, &["\"nowhere\"", "smallpt", ".toml"]),
        ("bench skips --quick -o out --scenes missing.toml", 1, &["missing.toml"]),
        ("bench paper --quick -o out --scenes grid", 1, &["tables", "--scenes"]),
        ("bench paper --quick -o out --size 7", 2, &["--size", "8..=4096"]),
        ("bench roulette --quick -o out --scenes paper400", 1, &["two-spheres, grid, field"]),
        ("bench build --quick -o file", 1, &["file", "folder"]),
        ("bench build --quick -o missing/out", 1, &["missing", "folder"]),
    ];
    for (line, code, words) in cases {
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{line}: {message}");
        for word in *words {
            assert!(message.contains(word), "{line}: {message}");
        }
    }
    assert_eq!(fs::read_dir(folder.root()).unwrap().count(), 1);
    assert_eq!(folder.read("file"), b"old");
}
