//! Unusual inputs: folders, devices, pipes, extreme lengths and names.
#![cfg(unix)]

use crate::folder::{Folder, text};
use crate::process::{run, run_with_input};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::Write;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::{Command, Output};

/// Maximum length of an error message in bytes.
const LONGEST: usize = 4000;

/// Runs a command that must fail soon, with a message that contains `word`.
#[track_caller]
fn refuse(folder: &Folder, line: &str, word: &str) {
    let output = folder.run(&line.split(' ').collect::<Vec<_>>());
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{line}: {message}");
    assert!(message.contains(word) && !message.contains("panicked"), "{line}: {message}");
    assert!(message.len() <= LONGEST, "{line}: {} bytes", message.len());
}

#[test]
fn folders_are_refused() {
    let folder = Folder::new();
    for name in ["a.toml", "a.xyz", "a.png"] {
        fs::create_dir(folder.path(name)).unwrap();
    }
    folder.write("file.toml", "[[file]]\npath = \"a.xyz\"\n");
    folder.write("sky.toml", "[environment]\nkind = \"picture\"\nfile = \"a.png\"\n");
    for (line, word) in [
        ("render a.toml", "a.toml: cannot be read"),
        ("render a.xyz", "a.xyz: cannot be read"),
        ("compare a.png a.png", "cannot read the picture \"a.png\""),
        ("info file.toml", "file not found: a.xyz"),
        ("info sky.toml", "cannot read the picture \"a.png\""),
    ] {
        refuse(&folder, line, word);
    }
}

#[test]
fn empty_files_are_refused() {
    let folder = Folder::new();
    folder.write("empty.xyz", "");
    folder.write("empty.png", "");
    symlink("/dev/null", folder.path("null.toml")).unwrap();
    for (line, word) in [
        ("info empty.xyz", "holds no particles"),
        ("compare empty.png empty.png", "not a picture"),
        ("render /dev/null", "holds no particles"),
        ("render null.toml", "no spheres"),
        ("compare /dev/null /dev/null", "not a picture"),
    ] {
        refuse(&folder, line, word);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn endless_files_are_refused() {
    let folder = Folder::new();
    symlink("/dev/zero", folder.path("zero.toml")).unwrap();
    refuse(&folder, "info zero.toml", "longer than 67.1 MB");
    refuse(&folder, "info /dev/zero", "not a text file");
    refuse(&folder, "compare /dev/zero /dev/zero", "not a picture");
}

#[test]
fn scene_files_have_a_maximum_length() {
    let folder = Folder::new();
    // A sparse file, which takes no disk space.
    File::create(folder.path("long.toml")).unwrap().set_len((1 << 26) + 1).unwrap();
    refuse(&folder, "render long.toml", "cannot be read: it is longer than 67.1 MB");
}

#[test]
fn errors_about_long_lines_are_short() {
    let folder = Folder::new();
    let long = "9 ".repeat(20_000);
    folder.write("rows.txt", &format!("{long}x\n"));
    folder.write("quote.csv", &format!("x,y,z\n1,2,\"{}", "3,4,5\n".repeat(200_000)));
    folder.write("list.toml", &format!("[camera]\neye = [{}]\n", long.replace(' ', ", ")));
    folder.write("name.toml", &format!("[camera]\n\"{long}\" = 1\n"));
    folder.write("syntax.toml", &format!("title = \"{long}\" \"\n"));
    refuse(&folder, "info rows.txt", "columns");
    refuse(&folder, "info quote.csv", "a quote is not closed");
    refuse(&folder, "info list.toml", "a list of 3 numbers");
    refuse(&folder, "info name.toml", "unknown key");
    refuse(&folder, "info syntax.toml", "syntax.toml:1");
}

/// Runs a command while `content` is written to the pipe `name`, which is then closed.
fn run_with_pipe(line: &str, name: &str, content: &'static [u8]) -> Output {
    let folder = Folder::new();
    let path = folder.path(name);
    assert!(run(Command::new("mkfifo").arg(&path)).status.success(), "no pipe");
    // Waits for a reader, which need not read everything. Without a reader it never ends, so nothing joins it.
    std::thread::spawn(move || {
        let _ = File::create(path).and_then(|mut pipe| pipe.write_all(content));
    });
    folder.run(&line.split(' ').collect::<Vec<_>>())
}

#[test]
fn pipes_are_read_once() {
    for (name, content) in [
        ("pipe.csv", &b"x,y,z,r\n0,0,0,1\n"[..]),
        ("pipe.toml", b"[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n"),
    ] {
        let output = run_with_pipe(&format!("info {name}"), name, content);
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
    }
}

#[test]
fn pipes_that_end_early_are_refused() {
    for (name, content, word) in [
        ("pipe.csv", &b"x,y,z,r\n0,0,0,1\n0,0"[..], "2 columns, but the header has 4"),
        ("pipe.csv", b"x,y", "no column is named `z`"),
        ("pipe.xyz", b"3\nwater\nO 0 0 0\n", "ends after 1 of 3 atoms"),
        ("pipe.txt", b"0 0 0 1\n0 0", "2 columns"),
        ("pipe.toml", b"[[sphere]]\ncenter = [0, 0", "pipe.toml:2"),
        ("pipe.txt", b"", "holds no particles"),
    ] {
        let output = run_with_pipe(&format!("info {name}"), name, content);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{name}: {message}");
        assert!(message.contains(word), "{name}: {message}");
    }
    let output = run_with_pipe("compare pipe.png pipe.png", "pipe.png", b"\x89PNG\r\n\x1a\n\0\0");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
}

#[test]
fn files_that_cannot_be_opened_are_refused() {
    let folder = Folder::new();
    // Links to themselves, which, unlike files without permissions, the superuser cannot open either.
    for name in ["loop.toml", "loop.xyz", "loop.png"] {
        symlink(name, folder.path(name)).unwrap();
    }
    refuse(&folder, "info loop.toml", "loop.toml: cannot be read");
    refuse(&folder, "info loop.xyz", "loop.xyz: cannot be read");
    refuse(&folder, "compare loop.png loop.png", "cannot read the picture");
}

#[test]
#[cfg(target_os = "linux")]
fn file_names_need_not_be_utf8() {
    let folder = Folder::new();
    let [scene, rows, picture] =
        [&b"a\xff.toml"[..], b"b\xff.csv", b"c\xff.png"].map(OsStr::from_bytes);
    fs::write(folder.root().join(scene), "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n").unwrap();
    fs::write(folder.root().join(rows), "x,y,z,r\n0,0,0,1\n").unwrap();
    for input in [scene, rows] {
        let small = ["--size", "4x4", "--spp", "1", "--quiet", "-o"].map(OsStr::new);
        let args = [&[OsStr::new("render"), input][..], &small, &[picture]].concat();
        let output = run(folder.command(&[]).args(args));
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(folder.root().join(picture).exists());
        let output = run(folder.command(&["compare"]).args([picture, picture]));
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    fs::write(folder.root().join(rows), "x,y,z,r\n0,0,0,one\n").unwrap();
    let output = run(folder.command(&["info"]).arg(rows));
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("not a number"));
}

#[test]
fn a_dash_is_standard_input() {
    let frames = "1\na\nC 0 0 0\n1\nb\nO 0 0 0\n";
    let folder = Folder::new();
    let output = run_with_input(&mut folder.command(&["info", "-", "--frame", "last"]), frames);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let types = "type         O (O by symbol): 1";
    assert!(text(&output.stdout).contains(types), "{}", text(&output.stdout));
}
