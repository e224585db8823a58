//! Sequences of images that are interrupted or killed, and resumed.

use crate::folder::Folder;
use crate::long::{LONG, end, names, start, wait_for_change};
use crate::process::{Process, wait_for};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Stdio;

/// Frames of a moving particle.
fn folder() -> Folder {
    let folder = Folder::new();
    let frame = |i: usize| format!("2\n\nC 0 0 0\nN {i} 2 1\n");
    folder.write("a.xyz", &(0..4).map(frame).collect::<String>());
    folder
}

/// Sequences of four images, a few tenths of a second each.
const SEQUENCES: [&[&str]; 2] = [
    &["render", "a.xyz", "--frame", "all", "--size", "64x48", "--spp", "90", "-q", "-o", "p.png"],
    &["render", "a.xyz", "--turntable", "4", "--size", "64x48", "--spp", "90", "-q", "-o", "p.png"],
];

fn pictures(folder: &Folder) -> Vec<(String, Vec<u8>)> {
    let names = names(folder).into_iter().filter(|name| name.ends_with("png"));
    names.map(|name| (name.clone(), folder.read(&name))).collect()
}

#[test]
fn interrupted_pictures_are_not_written() {
    for sequence in [&["--frame", "all"][..], &["--turntable", "3"]] {
        for (name, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
            let folder = folder();
            let args = [&LONG[..], &["a.xyz", "--checkpoint", "c"], sequence].concat();
            let render = start(&folder, &args);
            wait_for_change(&folder.path("c"));
            render.signal(&[name]);
            let (found, message) = end(render);
            assert_eq!(found, Some(code), "{message}");
            assert!(message.contains("is not written"), "{message}");
            assert_eq!(names(&folder), ["a.xyz", "c"]);
        }
    }
}

#[test]
fn sequences_resume_to_the_same_bytes() {
    for sequence in SEQUENCES {
        let straight = folder();
        straight.succeed(sequence);
        let expected = pictures(&straight);
        assert_eq!(expected.len(), 4);
        for name in ["TERM", "KILL"] {
            let folder = folder();
            let keep = ["--checkpoint", "c", "--checkpoint-every", "1ms"];
            let render = start(&folder, &[sequence, &keep].concat());
            wait_for("a picture", || !pictures(&folder).is_empty());
            render.signal(&[name]);
            let (code, message) = end(render);
            assert_eq!(code, if name == "TERM" { Some(143) } else { None }, "{message}");
            let before = pictures(&folder);
            assert!(before.len() < 4 && before.iter().all(|picture| expected.contains(picture)));
            folder.succeed(&["render", "--resume", "c", "-q"]);
            assert!(pictures(&folder) == expected, "{name}");
            // Nothing changes once all is complete.
            folder.succeed(&["render", "--resume", "c", "-q"]);
            assert!(pictures(&folder) == expected, "{name}");
        }
    }
}

#[test]
fn parts_of_sequences_resume() {
    let straight = folder();
    straight.succeed(SEQUENCES[0]);
    let folder = folder();
    let part = ["--part", "2/2", "--checkpoint", "c", "--checkpoint-every", "1ms"];
    let render = start(&folder, &[SEQUENCES[0], &part].concat());
    wait_for("a picture", || !pictures(&folder).is_empty());
    render.signal(&["TERM"]);
    assert_eq!(end(render).0, Some(143));
    folder.succeed(&["render", "--resume", "c", "-q"]);
    let all = pictures(&straight);
    assert!(pictures(&folder) == [all[1].clone(), all[3].clone()]);
}

#[test]
fn options_that_would_change_pictures_are_refused() {
    let folder = folder();
    let keep = ["--checkpoint", "c"];
    folder.succeed(&[&SEQUENCES[0][..5], &["8x8", "--spp", "2", "-q"], &keep].concat());
    let refused = |args: &[&str], word: &str| {
        let output = folder.run(&[&["render", "--resume", "c", "-q"], args].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{args:?}: {message}");
        assert!(message.contains(word), "{args:?}: {message}");
    };
    refused(&["--spp", "4"], "--spp");
    refused(&["--until-error", "5%"], "--until-error");
    refused(&["--frame", "2"], "a sequence");
    folder.succeed(&["render", "a.xyz", "--size", "8x8", "--spp", "2", "-q", "--checkpoint", "d"]);
    let output = folder.run(&["render", "--resume", "d", "--turntable", "3"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("a single image"));
}

#[test]
fn interrupted_videos_leave_nothing() {
    let folder = folder();
    fs::create_dir(folder.path("tools")).expect("a folder");
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\n\
                  : > started\nexec cat > \"$last\"\n";
    fs::write(folder.path("tools/ffmpeg"), script).expect("a script");
    let executable = fs::Permissions::from_mode(0o755);
    fs::set_permissions(folder.path("tools/ffmpeg"), executable).expect("a script");
    let path = format!("{}:/usr/bin:/bin", folder.path("tools").display());
    let args = ["render", "a.xyz", "--turntable", "100000", "--size", "32x24", "--spp", "1", "-q"];
    let mut command = folder.command(&[&args[..], &["-o", "f.mp4"]].concat());
    command.env("PATH", path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let render = Process::start(&mut command);
    wait_for("the encoder", || folder.path("started").exists());
    render.signal(&["TERM"]);
    let (code, message) = end(render);
    assert_eq!(code, Some(143), "{message}");
    assert_eq!(names(&folder), ["a.xyz", "started", "tools"]);
}
