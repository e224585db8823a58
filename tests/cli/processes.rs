//! Closed pipes and signals.

use crate::folder::{Folder, SMALL, text};
use crate::process::Process;
use std::io::pipe;
use std::process::Stdio;

#[test]
fn closed_pipes_are_not_errors() {
    let folder = Folder::new();
    let small = [&SMALL[..5], &["--json"]].concat();
    for args in [&small[..], &["completions", "bash"], &["--help"], &["render", "--help"]] {
        let (reader, writer) = pipe().unwrap();
        drop(reader);
        let mut command = folder.command(args);
        command.stdin(Stdio::null()).stdout(writer).stderr(Stdio::piped());
        let output = Process::start(&mut command).end();
        assert!(output.status.success(), "{args:?}");
        assert!(!text(&output.stderr).contains("panicked"), "{args:?}");
    }
    assert!(folder.path("spherule.png").exists());
}

#[test]
#[cfg(target_os = "linux")]
fn interrupted_renders_are_saved() {
    use crate::process::wait_for;
    use spherule_render::image::Image;
    let folder = Folder::new();
    // It ends by itself even if the test is killed.
    let long = ["render", "--size", "40x24", "--spp", "10000000", "--time", "5m"];
    let mut command = folder.command(&long);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let render = Process::start(&mut command);
    wait_for("a handler of signals", || catches_interrupts(render.id()));
    // Also with a few samples.
    std::thread::sleep(std::time::Duration::from_millis(300));
    render.signal(&["INT"]);
    let output = render.end();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("interrupted"), "{message}");
    let picture = Image::read(folder.path("spherule.png")).unwrap();
    assert_eq!((picture.width, picture.height), (40, 24));
    assert!(picture.pixels.iter().any(|pixel| pixel[0] > 0.0));
}

/// Returns whether the process has a handler for signal 2.
#[cfg(target_os = "linux")]
fn catches_interrupts(process: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let mask = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 0b10 != 0)
}
