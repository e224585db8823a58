//! Very long renders, and the files that they write.

use crate::folder::{Folder, text};
use crate::process::{Process, wait_for};
use spherule_render::checkpoint;
use std::fs;
use std::path::Path;
use std::process::Stdio;

/// Arguments of a very long render, which ends by itself even if the test is killed.
pub(crate) const LONG: [&str; 8] = [
    "render",
    "--size",
    "80x60",
    "--spp",
    "1000000",
    "--quiet",
    "--time=5m",
    "--checkpoint-every=20ms",
];

/// Starts the program in a folder.
pub(crate) fn start(folder: &Folder, args: &[&str]) -> Process {
    let mut command = folder.command(args);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    Process::start(&mut command)
}

/// Returns the exit code and the messages of a program that ends.
#[track_caller]
pub(crate) fn end(process: Process) -> (Option<i32>, String) {
    let output = process.end();
    (output.status.code(), text(&output.stderr))
}

/// Waits until a file exists and has been replaced once.
#[track_caller]
pub(crate) fn wait_for_change(path: &Path) {
    use std::os::unix::fs::MetadataExt;
    let number = || fs::metadata(path).map(|file| file.ino()).ok();
    wait_for("a checkpoint", || number().is_some());
    let first = number();
    wait_for("a second checkpoint", || number().is_some_and(|now| Some(now) != first));
}

/// Returns the number of samples of a checkpoint, which must be intact.
#[track_caller]
pub(crate) fn samples(path: &Path) -> u64 {
    let (_, render) = checkpoint::read(path).unwrap_or_else(|error| panic!("{error}"));
    render.samples().total
}

/// Returns the names of all files in a folder.
pub(crate) fn names(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(folder.root()).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| text(entry.expect("a file").file_name().as_encoded_bytes())).collect();
    names.sort();
    names
}
