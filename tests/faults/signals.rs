//! Signals, time limits, and locks of other processes.

use crate::folder::{Folder, SMALL, text};
use crate::long::{LONG, end, names, samples, start, wait_for_change};
use crate::process::{Process, run, wait_for};
use spherule_render::image::Image;
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

#[test]
fn signals_leave_picture_and_checkpoint_and_set_the_exit_status() {
    for (name, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let folder = Folder::new();
        let render = start(&folder, &[&LONG[..], &["--checkpoint", "c"]].concat());
        wait_for_change(&folder.path("c"));
        render.signal(&[name]);
        let (found, message) = end(render);
        assert_eq!(found, Some(code), "{name}: {message}");
        assert!(message.contains("interrupted"), "{message}");
        assert_eq!(names(&folder), ["c", "spherule.png"]);
        let picture = Image::read(folder.path("spherule.png")).expect("a picture");
        assert!(picture.pixels.iter().any(|pixel| pixel[0] > 0.0));
        assert!(samples(&folder.path("c")) > 0);
    }
}

#[test]
fn a_second_signal_ends_at_once_and_files_are_intact() {
    let folder = Folder::new();
    folder.picture("spherule.png", &[]);
    let old = folder.read("spherule.png");
    let render = start(&folder, &[&LONG[..], &["--checkpoint", "c"]].concat());
    wait_for_change(&folder.path("c"));
    // Two equal signals may be merged.
    render.signal(&["INT", "TERM"]);
    let (code, message) = end(render);
    assert!([Some(143), Some(130)].contains(&code), "{message}");
    samples(&folder.path("c"));
    let whole = || Image::read(folder.path("spherule.png")).is_ok();
    assert!(folder.read("spherule.png") == old || whole());
}

#[test]
fn time_limits_end_renders_and_more_time_resumes_them() {
    let folder = Folder::new();
    let timed = ["render", "--size", "80x60", "--time", "300ms", "--checkpoint", "c"];
    let output = folder.run(&timed);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("--resume c"), "{}", text(&output.stderr));
    let (first, picture) = (samples(&folder.path("c")), folder.read("spherule.png"));
    // Its time is used up, so nothing is added.
    folder.succeed(&["render", "--resume", "c"]);
    assert!(samples(&folder.path("c")) == first && folder.read("spherule.png") == picture);
    folder.succeed(&["render", "--resume", "c", "--time", "700ms"]);
    assert!(samples(&folder.path("c")) > first);
}

#[test]
fn one_process_at_a_time_writes_a_checkpoint() {
    let folder = Folder::new();
    let mut render = start(&folder, &[&LONG[..], &["--checkpoint", "c"]].concat());
    wait_for_change(&folder.path("c"));
    let others: [&[&str]; 2] =
        [&["render", "--resume", "c", "-o", "b.png"], &["render", "--checkpoint", "c"]];
    for other in others {
        let output = folder.run(other);
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains("another process"), "{}", text(&output.stderr));
    }
    assert!(render.status().is_none() && !folder.path("b.png").exists());
    render.kill();
    // The system releases the locks of killed processes.
    let again = start(&folder, &["render", "--resume", "c", "--quiet"]);
    wait_for_change(&folder.path("c"));
    again.signal(&["TERM"]);
    assert_eq!(end(again).0, Some(143));
}

#[test]
fn full_disks_leave_the_old_files() {
    let folder = Folder::new();
    let expected = folder.picture("straight.png", &[]);
    let keep = ["--checkpoint", "c", "--checkpoint-every", "none"];
    // Files are limited to 4 KiB: less than a checkpoint, more than the image.
    let args = [&SMALL[..], &keep, &["-o", "a.png"]].concat();
    let output = folder.shell("ulimit -f 8; exec \"$0\" \"$@\"", &args);
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(
        message.contains("c: cannot write a checkpoint") && message.contains("continues"),
        "{message}"
    );
    assert!(folder.read("a.png") == expected && !folder.path("c").exists());
    // With an existing checkpoint, and an image that exceeds the limit as well.
    folder.succeed(&[&SMALL[..], &["--checkpoint", "c"]].concat());
    let kept = folder.read("c");
    let more = ["render", "--resume", "c", "--spp", "64", "-o", "a.pfm"];
    let output = folder.shell("ulimit -f 8; exec \"$0\" \"$@\"", &more);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the last one remains"), "{message}");
    assert!(message.contains("a.pfm") && !folder.path("a.pfm").exists(), "{message}");
    assert!(folder.read("c") == kept);
    assert_eq!(names(&folder), ["a.png", "c", "spherule.png", "straight.png"]);
}

#[test]
fn folders_that_vanish_do_not_stop_a_render() {
    let folder = Folder::new();
    fs::create_dir(folder.path("kept")).expect("a folder");
    let render = start(&folder, &[&LONG[..], &["--checkpoint", "kept/c"]].concat());
    wait_for_change(&folder.path("kept/c"));
    fs::rename(folder.path("kept"), folder.path("elsewhere")).expect("a folder");
    std::thread::sleep(Duration::from_millis(200));
    render.signal(&["TERM"]);
    let (code, message) = end(render);
    assert_eq!(code, Some(143), "{message}");
    assert!(message.contains("not found") && message.contains("continues"), "{message}");
    assert!(Image::read(folder.path("spherule.png")).is_ok());
    samples(&folder.path("elsewhere/c"));
}

#[test]
fn unusable_checkpoint_paths_are_refused_before_the_render() {
    let folder = Folder::new();
    folder.write("other", "something else");
    for place in ["/proc/c", "none/c", "other", ".", "/dev/null"] {
        let output = folder.run(&[&LONG[..], &["--checkpoint", place]].concat());
        assert_eq!(output.status.code(), Some(1), "{place}");
        assert!(text(&output.stderr).contains(place), "{place}: {}", text(&output.stderr));
    }
    assert_eq!(names(&folder), ["other"]);
    assert_eq!(folder.read("other"), b"something else");
}

#[test]
fn one_signal_ends_programs_that_wait_for_a_pipe() {
    // Frames are longer than the bytes that are read to detect the format.
    let frame =
        format!("4000\nProperties=species:S:1:pos:R:3\n{}", "H 0.125 0.25 0.375\n".repeat(4000));
    let xyz = frame.repeat(4);
    for (name, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let folder = Folder::new();
        assert!(run(Command::new("mkfifo").arg(folder.path("p.png"))).status.success());
        let kept = ["--checkpoint", "c", "--checkpoint-every", "none"];
        let writer = [&SMALL[..], &kept, &["-o", "p.png"]].concat();
        let reader = [&SMALL[..], &["-", "--frame", "all", "-o", "a.png"]].concat();
        for (args, last) in [(&writer, "c"), (&reader, "a-0000.png")] {
            let mut command = folder.command(args);
            command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
            let mut render = Process::start(&mut command);
            // Standard input stays open.
            render.write(if last == "c" { "" } else { &xyz });
            wait_for("the last file before the wait", || folder.path(last).exists());
            std::thread::sleep(Duration::from_millis(200));
            render.signal(&[name]);
            assert_eq!(render.wait().code(), Some(code), "{args:?} {name}");
        }
        let rest = names(&folder).into_iter().filter(|name| !name.starts_with("a-"));
        assert_eq!(rest.collect::<Vec<_>>(), ["c", "p.png"]);
    }
}

#[test]
fn few_file_descriptors_leave_a_whole_picture_and_nothing_else() {
    let folder = Folder::new();
    let old = folder.picture("a.png", &[]);
    let mut written = 0;
    for limit in 3..=12 {
        let new = ["render", "--size", "16x12", "--spp", "1", "--quiet", "-o", "a.png"];
        let output = folder.shell(&format!("ulimit -n {limit}; exec \"$0\" \"$@\""), &new);
        let message = text(&output.stderr);
        assert!(!message.contains("panicked"), "{limit}: {message}");
        assert_eq!(names(&folder), ["a.png"], "{limit}: {message}");
        let width = Image::read(folder.path("a.png")).expect("a whole picture").width;
        assert_eq!(width, if output.status.success() { 16 } else { 40 }, "{limit}: {message}");
        written += u32::from(output.status.success());
        fs::write(folder.path("a.png"), &old).expect("a file");
    }
    assert!(written > 0);
}
