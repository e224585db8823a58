//! Many frames of a file on the command line.

use crate::folder::{Folder, SMALL, text};
use spherule::image::Image;

/// A particle that moves one unit to the right from frame to frame, and a column that grows.
fn moving(frames: usize) -> String {
    let header = "Properties=species:S:1:pos:R:3:q:R:1";
    let frame =
        |i: usize| format!("2\n{header}\nC 0 0 0 {i}\nC {x} 0 0 {q}\n", x = i + 3, q = 2 * i + 1);
    (0..frames).map(frame).collect()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.xyz", &moving(4));
    folder
}

fn run(folder: &Folder, args: &[&str]) {
    folder.succeed(&[&SMALL[..], &["a.xyz", "--view", "z"], args].concat());
}

fn names(folder: &Folder) -> Vec<String> {
    let entries = std::fs::read_dir(folder.root()).expect("a folder");
    let name = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = entries.map(|entry| name(entry.expect("an entry"))).collect();
    names.retain(|name| name.ends_with("png"));
    names.sort();
    names
}

#[test]
fn every_frame_has_its_picture() {
    let folder = folder();
    run(&folder, &["--frame", "all", "-o", "b.png"]);
    assert_eq!(names(&folder), ["b-0000.png", "b-0001.png", "b-0002.png", "b-0003.png"]);
    // The first particle stays where it is, for the camera does, and the other one moves.
    let pictures: Vec<Image> =
        names(&folder).iter().map(|name| Image::read(folder.path(name)).expect("read")).collect();
    let column = |image: &Image, x: u32| -> Vec<_> {
        (0..image.height).map(|y| image.pixel(x, y)).collect()
    };
    for later in &pictures[1..] {
        assert!((0..12).all(|x| column(later, x) == column(&pictures[0], x)));
        assert_ne!(later, &pictures[0]);
    }
}

#[test]
fn parts_of_a_file_are_drawn() {
    for (range, expected) in [
        ("1-2", &["b1.png", "b2.png"][..]),
        ("0..3..2", &["b0.png", "b2.png"]),
        ("2..", &["b2.png", "b3.png"]),
        ("3-3", &["b3.png"]),
    ] {
        let folder = folder();
        run(&folder, &["--frame", range, "-o", "b%d.png"]);
        assert_eq!(names(&folder), expected, "{range}");
    }
}

#[test]
fn colors_stand_for_the_same_numbers_in_all_frames() {
    let folder = folder();
    let colors = ["--color-by", "q", "--color-bar", "bar.svg"];
    run(&folder, &[&colors[..], &["--frame", "all", "-o", "b.png"]].concat());
    run(
        &folder,
        &[&colors[..2], &["--color-range", "0,1", "--frame", "all", "-o", "c.png"]].concat(),
    );
    for frame in 0..4 {
        let read =
            |name: &str| Image::read(folder.path(&format!("{name}-000{frame}.png"))).unwrap();
        assert_eq!(read("b"), read("c"), "{frame}");
    }
}

#[test]
fn faults_name_their_frame_and_leave_the_pictures_before_it() {
    let folder = folder();
    folder.write("cut.xyz", &format!("{}2\n\nC 0 0 0\nC 0 zero 0\n", moving(2)));
    for (line, code, message) in [
        ("render cut.xyz --frame all", 1, "frame 2:"),
        ("render a.xyz --frame 2-9", 1, "has no frame 9, but 4"),
        ("render a.xyz --frame 7..", 1, "has no frame 7, but 4"),
        ("render a.xyz --frame 3-1", 2, "A no more than B"),
        ("render a.xyz --frame all --turntable 3", 2, "a single one"),
        ("info a.xyz --frame all", 2, "one frame here"),
        ("render --frame all", 2, "name one"),
    ] {
        let args: Vec<&str> = line.split(' ').collect();
        let size = ["--size", "8x8", "--spp", "1"];
        let size = if args[0] == "render" { &size[..] } else { &[] };
        let output = folder.run(&[&args[..], size].concat());
        let said = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{line}: {said}");
        assert!(said.contains(message), "{line}: {said}");
    }
    assert!(folder.path("spherule-0001.png").exists() && folder.path("spherule-0003.png").exists());
    assert!(!folder.path("spherule-0004.png").exists());
}
