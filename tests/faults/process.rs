//! Processes that the tests start.

use crate::folder::{Folder, text};
use spherule_render::checkpoint;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Arguments of a very long render.
pub(crate) const LONG: [&str; 7] =
    ["render", "--size", "80x60", "--spp", "1000000", "--quiet", "--checkpoint-every=20ms"];

/// Time limit of everything that a test waits for.
const PATIENCE: Duration = Duration::from_secs(120);

/// Starts the program in a folder.
pub(crate) fn start(folder: &Folder, args: &[&str]) -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_spherule"));
    program.args(args).current_dir(folder.root());
    program.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    program.spawn().expect("a program that starts")
}

/// Starts the program in a shell, after the commands `before`.
pub(crate) fn shell(folder: &Folder, before: &str, args: &[&str]) -> Output {
    let mut shell = Command::new("sh");
    let script = format!("{before}; exec \"$0\" \"$@\"");
    shell.args(["-c", &script, env!("CARGO_BIN_EXE_spherule")]).args(args);
    shell.current_dir(folder.root()).output().expect("a shell that starts")
}

/// Sends one or more signals by name.
pub(crate) fn signal(child: &Child, names: &[&str]) {
    let kill: Vec<String> =
        names.iter().map(|name| format!("kill -{name} {}", child.id())).collect();
    let sent = Command::new("sh").args(["-c", &kill.join("; ")]).status();
    assert!(sent.is_ok_and(|status| status.success()), "{kill:?}");
}

/// Waits until a condition is true.
#[track_caller]
pub(crate) fn wait_for(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < PATIENCE, "{what} never came");
        sleep(Duration::from_millis(5));
    }
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

/// Returns the messages and the exit code of a program.
pub(crate) fn end(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().expect("a program that ends");
    (output.status.code(), text(&output.stderr))
}

/// Returns the names of all files in a folder.
pub(crate) fn names(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(folder.root()).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| text(entry.expect("a file").file_name().as_encoded_bytes())).collect();
    names.sort();
    names
}
