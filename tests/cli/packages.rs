//! Contents of packages: manual pages, and the level of the program.

use crate::folder::{Folder, text};
use crate::process::run;
use std::fs;

#[test]
fn every_command_has_a_manual_page() {
    let folder = Folder::new();
    fs::create_dir(folder.path("man")).expect("a folder");
    assert_eq!(folder.succeed(&["man", "man"]), "");
    let pages = fs::read_dir(folder.path("man")).expect("a folder");
    let mut names: Vec<String> =
        pages.map(|page| text(page.expect("a page").file_name().as_encoded_bytes())).collect();
    names.sort();
    let commands = [
        "bench",
        "compare",
        "completions",
        "field",
        "info",
        "merge",
        "render",
        "status",
        "stress",
        "view",
    ];
    let kinds =
        ["all", "build", "error", "gpu", "paper", "roulette", "skips", "threads", "traversal"];
    let pages = commands.map(|command| format!("spherule-{command}.1"));
    let of_bench = kinds.map(|kind| format!("spherule-bench-{kind}.1"));
    let mut expected: Vec<String> = pages.into_iter().chain(of_bench).collect();
    expected.push("spherule.1".to_owned());
    expected.sort();
    assert_eq!(names, expected);
    let page = text(&folder.read("man/spherule-render.1"));
    assert!(page.contains("\\-\\-until\\-error") && page.contains(".SH OPTIONS"), "{page}");
    let output = folder.run(&["man", "missing"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("missing: cannot be written: No such file"), "{message}");
}

#[test]
fn the_level_of_the_program_is_named() {
    let folder = Folder::new();
    let lines = folder.succeed(&["--version", "--verbose"]);
    let mut lines = lines.lines();
    assert_eq!(lines.next(), Some(concat!("spherule ", env!("CARGO_PKG_VERSION"))));
    let level = lines.next().expect("a second line");
    let architecture = std::env::consts::ARCH.replace('_', "-");
    assert!(level.starts_with(&format!("level: {architecture}")), "{level}");
    assert!(level.contains("this processor has"), "{level}");
    assert_eq!(lines.next(), Some(concat!("program: ", env!("CARGO_BIN_EXE_spherule"))));
}

/// The advice to get a faster program depends on the processor and on flags of the compiler, but a render never
/// does with `--quiet`, nor where the user chose the level.
#[test]
fn advice_about_the_processor_is_for_who_did_not_choose() {
    let folder = Folder::new();
    let render = |options: &[&str], level: &str| {
        let mut command = folder.command(&["--size", "8x6", "--spp", "1"]);
        text(&run(command.args(options).env("SPHERULE_LEVEL", level)).stderr)
    };
    let details = folder.succeed(&["-Vv"]);
    let advice = "this program was compiled for ";
    assert_eq!(render(&[], "").contains(advice), details.contains("which it was compiled for"));
    assert!(!render(&["--quiet"], "").contains(advice));
    let level = details.split_once("level: ").map_or("", |(_, rest)| rest);
    let level = level.split([',', ' ']).next().unwrap_or_default();
    let name = level.rsplit('-').next().filter(|name| name.starts_with('v')).unwrap_or("baseline");
    assert!(!render(&[], name).contains(advice), "{name}");
}
