//! Ctrl-C and its like, limits of time, and other processes.

use crate::folder::{Folder, SMALL, text};
use crate::process::{LONG, end, names, samples, shell, signal, start, wait_for_news};
use spherule::image::Image;
use std::fs;

#[test]
fn signals_leave_picture_and_checkpoint_and_tell_which_they_were() {
    for (name, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let folder = Folder::new();
        let child = start(&folder, &[&LONG[..], &["--checkpoint", "c"]].concat());
        wait_for_news(&folder.path("c"));
        signal(&child, &[name]);
        let (found, message) = end(child);
        assert_eq!(found, Some(code), "{name}: {message}");
        assert!(message.contains("interrupted"), "{message}");
        assert_eq!(names(&folder), ["c", "spherule.png"]);
        let picture = Image::read(folder.path("spherule.png")).expect("a picture");
        assert!(picture.pixels.iter().any(|pixel| pixel[0] > 0.0));
        assert!(samples(&folder.path("c")) > 0);
    }
}

#[test]
fn a_second_signal_ends_it_at_once_and_files_are_whole() {
    let folder = Folder::new();
    folder.picture("spherule.png", &[]);
    let old = folder.read("spherule.png");
    let child = start(&folder, &[&LONG[..], &["--checkpoint", "c"]].concat());
    wait_for_news(&folder.path("c"));
    // Two of a kind may be taken for one.
    signal(&child, &["INT", "TERM"]);
    let (code, message) = end(child);
    assert!([Some(143), Some(130)].contains(&code), "{message}");
    samples(&folder.path("c"));
    let whole = || Image::read(folder.path("spherule.png")).is_ok();
    assert!(folder.read("spherule.png") == old || whole());
}

#[test]
fn time_ends_it_as_it_should_and_more_time_goes_on() {
    let folder = Folder::new();
    let timed = ["render", "--size", "80x60", "--time", "300ms", "--checkpoint", "c"];
    let output = folder.run(&timed);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("--resume c"), "{}", text(&output.stderr));
    let (first, picture) = (samples(&folder.path("c")), folder.read("spherule.png"));
    // Its time is over: nothing is added.
    folder.succeed(&["render", "--resume", "c"]);
    assert!(samples(&folder.path("c")) == first && folder.read("spherule.png") == picture);
    folder.succeed(&["render", "--resume", "c", "--time", "700ms"]);
    assert!(samples(&folder.path("c")) > first);
}

#[test]
fn one_process_at_a_time_writes_a_checkpoint() {
    let folder = Folder::new();
    let mut child = start(&folder, &[&LONG[..], &["--checkpoint", "c"]].concat());
    wait_for_news(&folder.path("c"));
    let others: [&[&str]; 2] =
        [&["render", "--resume", "c", "-o", "b.png"], &["render", "--checkpoint", "c"]];
    for other in others {
        let output = folder.run(other);
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains("another process"), "{}", text(&output.stderr));
    }
    assert!(child.try_wait().expect("a program").is_none() && !folder.path("b.png").exists());
    child.kill().expect("a program");
    child.wait().expect("a program");
    // The system takes the lock back from those that are killed.
    let again = start(&folder, &["render", "--resume", "c", "--quiet"]);
    wait_for_news(&folder.path("c"));
    signal(&again, &["TERM"]);
    assert_eq!(end(again).0, Some(143));
}

#[test]
fn disks_that_are_full_leave_what_was_there() {
    let folder = Folder::new();
    let expected = folder.picture("straight.png", &[]);
    let keep = ["--checkpoint", "c", "--checkpoint-every", "none"];
    // Files of 4 KiB at most: less than a checkpoint, more than the picture.
    let args = [&SMALL[..], &keep, &["-o", "a.png"]].concat();
    let output = shell(&folder, "ulimit -f 8", &args);
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.contains("c: no checkpoint") && message.contains("goes on"), "{message}");
    assert!(folder.read("a.png") == expected && !folder.path("c").exists());
    // With a checkpoint that was there before, and a picture that there is no room for either.
    folder.succeed(&[&SMALL[..], &["--checkpoint", "c"]].concat());
    let kept = folder.read("c");
    let more = ["render", "--resume", "c", "--spp", "64", "-o", "a.pfm"];
    let output = shell(&folder, "ulimit -f 8", &more);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the last one is kept"), "{message}");
    assert!(message.contains("a.pfm") && !folder.path("a.pfm").exists(), "{message}");
    assert!(folder.read("c") == kept);
    assert_eq!(names(&folder), ["a.png", "c", "spherule.png", "straight.png"]);
}

#[test]
fn folders_that_vanish_do_not_stop_a_render() {
    let folder = Folder::new();
    fs::create_dir(folder.path("kept")).expect("a folder");
    let child = start(&folder, &[&LONG[..], &["--checkpoint", "kept/c"]].concat());
    wait_for_news(&folder.path("kept/c"));
    fs::rename(folder.path("kept"), folder.path("elsewhere")).expect("a folder");
    std::thread::sleep(std::time::Duration::from_millis(200));
    signal(&child, &["TERM"]);
    let (code, message) = end(child);
    assert_eq!(code, Some(143), "{message}");
    assert!(message.contains("no folder") && message.contains("goes on"), "{message}");
    assert!(Image::read(folder.path("spherule.png")).is_ok());
    samples(&folder.path("elsewhere/c"));
}

#[test]
fn places_that_take_no_checkpoint_are_told_before_the_render() {
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
