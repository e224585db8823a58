//! Closed pipes and signals.

use crate::folder::{Folder, SMALL, text};
use spherule_render::image::Image;
use std::fs;
use std::process::{Command, Stdio};

#[test]
fn closed_pipes_are_not_errors() {
    let folder = Folder::new();
    let small = [&SMALL[..5], &["--json"]].concat();
    for args in [&small[..], &["completions", "bash"], &["--help"], &["render", "--help"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_spherule"))
            .args(args)
            .current_dir(folder.root())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{args:?}");
        assert!(!text(&output.stderr).contains("panicked"), "{args:?}");
    }
    assert!(folder.path("spherule.png").exists());
}

#[test]
#[cfg(target_os = "linux")]
fn interrupted_renders_are_saved() {
    use std::time::Duration;
    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_spherule"))
        .args(["render", "--size", "40x24", "--spp", "10000000"])
        .current_dir(folder.root())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let pause = || std::thread::sleep(Duration::from_millis(300));
    let ready = (0..200).any(|_| {
        pause();
        catches_interrupts(child.id())
    });
    // Also with a few samples.
    pause();
    let kill = format!("kill -INT {}", child.id());
    let sent = Command::new("sh").args(["-c", &kill]).status();
    if !ready || !sent.is_ok_and(|status| status.success()) {
        child.kill().unwrap();
    }
    let output = child.wait_with_output().unwrap();
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
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let mask = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 0b10 != 0)
}
