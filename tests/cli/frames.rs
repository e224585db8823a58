//! Frames of a file on the command line.

use crate::folder::{Folder, SMALL, text};
use crate::process::run_with_input;
use spherule_render::image::{Image, read_metadata};

/// Particles, one of which moves one unit to the right in each frame, with an increasing column.
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
    // The camera is fixed and frames all frames, so the first particle stays and the other one moves.
    let pictures: Vec<Image> =
        names(&folder).iter().map(|name| Image::read(folder.path(name)).expect("read")).collect();
    let column = |image: &Image, x: u32| -> Vec<_> {
        (0..image.height).map(|y| image.pixel(x, y)).collect()
    };
    for later in &pictures[1..] {
        assert!((0..9).all(|x| column(later, x) == column(&pictures[0], x)));
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
fn the_color_range_is_shared_by_all_frames() {
    let folder = folder();
    let colors = ["--color-by", "q", "--color-bar", "bar.svg"];
    run(&folder, &[&colors[..], &["--frame", "all", "-o", "b.png"]].concat());
    run(
        &folder,
        &[&colors[..2], &["--color-range", "0,7", "--frame", "all", "-o", "c.png"]].concat(),
    );
    let bar = text(&folder.read("bar.svg"));
    assert!(bar.contains(">6</text>") && bar.contains(">0</text>"), "{bar}");
    for frame in 0..4 {
        let read =
            |name: &str| Image::read(folder.path(&format!("{name}-000{frame}.png"))).unwrap();
        assert_eq!(read("b"), read("c"), "{frame}");
    }
}

/// The arrow of the second frame is twice as long as that of the first, for which the scale is chosen.
#[test]
fn the_scale_of_arrows_is_shared_by_all_frames() {
    let folder = Folder::new();
    let frame = |v: f64| format!("1\nProperties=species:S:1:pos:R:3:velo:R:3\nC 0 0 0 {v} 0 0\n");
    folder.write("a.xyz", &[frame(1.0), frame(2.0)].concat());
    let arrows = ["--radii", "0.5", "--arrows", "velocity"];
    run(&folder, &[&arrows[..], &["--frame", "all", "-o", "b.png"]].concat());
    // Four times the radius for the first frame's vector, and a quarter of the radius.
    let sizes = ["--arrow-scale", "2", "--arrow-radius", "0.125"];
    run(&folder, &[&arrows[..], &sizes, &["--frame", "all", "-o", "c.png"]].concat());
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert_eq!(read("b-0000.png"), read("c-0000.png"));
    assert_eq!(read("b-0001.png"), read("c-0001.png"));
    assert_ne!(read("b-0000.png"), read("b-0001.png"));
}

#[test]
fn ranges_are_those_of_the_frames_that_have_numbers() {
    let folder = Folder::new();
    let header = "Properties=species:S:1:pos:R:3:q:R:1";
    let frame = |q: [&str; 2]| format!("2\n{header}\nC 0 0 0 {}\nC 3 0 0 {}\n", q[0], q[1]);
    let frames = [["nan", "nan"], ["-2", "5"], ["nan", "0.5"]].map(frame);
    folder.write("a.xyz", &frames.concat());
    folder.write("none.xyz", &[frame(["nan", "nan"]), frame(["-1", "inf"])].concat());
    for (options, range) in [("", "-2,5"), (" --color-log", "0.5,5")] {
        let line = format!("render a.xyz --frame all --color-by q {TINY} -o a.png{options}");
        let output = stderr(&folder, 0, &line);
        assert!(output.contains("2 particles have no value of `q`"), "{output}");
        for frame in 0..3 {
            let path = folder.path(&format!("a-000{frame}.png"));
            let metadata = read_metadata(path).expect("a picture");
            assert_eq!(metadata.value("color_range"), Some(range), "{line}: {frame}");
        }
    }
    let none = "render none.xyz --frame all --color-by q --color-log -o n.png";
    let output = stderr(&folder, 1, none);
    assert!(output.contains("cannot color by the column `q`"), "{output}");
    assert!(!names(&folder).iter().any(|name| name.starts_with('n')));
}

#[test]
fn types_have_one_color_in_all_frames() {
    let folder = Folder::new();
    let head = |count: usize| format!("{count}\nProperties=species:S:1:pos:R:3:chain:S:1\n");
    let left = |name: &str| format!("{name} 0 0 0 {name}\n");
    let right = |name: &str| format!("{name} 4 0 0 {name}\n");
    let frames = [
        [head(2), left("Q1"), right("Q2")],
        [head(2), right("Q2"), left("Q1")],
        [head(2), right("Q3"), left("Q1")],
        [head(1), right("Q2"), String::new()],
    ];
    folder.write("a.xyz", &frames.map(|frame| frame.concat()).concat());
    let middle = |frame: u32, x: u32| {
        let image = Image::read(folder.path(&format!("a-000{frame}.png"))).expect("a picture");
        image.pixel(x, 12).expect("a pixel")
    };
    let similar = |a: [f32; 3], b: [f32; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 0.1);
    let shown = TINY.replace("--spp 4", "--spp 64");
    for coloring in ["", " --color-by type", " --color-by chain"] {
        let line = format!("render a.xyz --frame all --radii 1 --view z {shown} -o a.png");
        stderr(&folder, 0, &format!("{line}{coloring}"));
        let lefts = [0, 1, 2].map(|frame| middle(frame, 11));
        let rights = [0, 1, 2, 3].map(|frame| middle(frame, 28));
        assert!(
            similar(lefts[0], lefts[1]) && similar(lefts[0], lefts[2]),
            "{coloring}: {lefts:?}"
        );
        assert!(similar(rights[0], rights[1]) && similar(rights[0], rights[3]), "{rights:?}");
        assert!(!similar(rights[0], rights[2]) && !similar(lefts[0], rights[0]), "{rights:?}");
    }
    // A type may be missing in some of the frames, but not in all.
    let typed = "render a.xyz --frame all --radii 1 -o t.png --size 24x16 --spp 1 -q";
    assert_eq!(stderr(&folder, 0, &format!("{typed} --type Q3:color=red")), "");
    let unknown = stderr(&folder, 1, &format!("{typed} --type Q4:color=red"));
    assert!(unknown.contains("no type is called `Q4`"), "{unknown}");
}

#[test]
fn labels_and_percentiles_are_those_of_all_frames() {
    let folder = Folder::new();
    let head = "2\nProperties=species:S:1:pos:R:3:mol:I:1:q:R:1\n";
    let frame = |left: u32, right: u32, q: [u32; 2]| {
        format!("{head}C 0 0 0 {left} {}\nC 4 0 0 {right} {}\n", q[0], q[1])
    };
    let frames = [frame(5, 9, [1, 2]), frame(9, 9, [3, 5]), frame(7, 9, [6, 9])];
    folder.write("a.xyz", &frames.concat());
    let shown = TINY.replace("--spp 4", "--spp 64");
    let line =
        format!("render a.xyz --frame all --radii 1 --view z {shown} --color-by mol -o a.png");
    stderr(&folder, 0, &line);
    let middle = |frame: u32, x: u32| {
        let image = Image::read(folder.path(&format!("a-000{frame}.png"))).expect("a picture");
        image.pixel(x, 12).expect("a pixel")
    };
    let similar = |a: [f32; 3], b: [f32; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 0.1);
    let [lefts, rights] = [11, 28].map(|x| [0, 1, 2].map(|frame| middle(frame, x)));
    assert!(similar(rights[0], rights[1]) && similar(rights[0], rights[2]), "{rights:?}");
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        assert!(!similar(lefts[a], lefts[b]), "{lefts:?}");
    }
    // A legend has the labels of all frames.
    let listed =
        "render a.xyz --frame all --color-by mol --legend --size 200x150 --spp 1 -q -o l.svg";
    stderr(&folder, 0, listed);
    for frame in ["l-0000.svg", "l-0002.svg"] {
        let svg = text(&folder.read(frame));
        for name in ["mol", "5", "7", "9"] {
            assert!(svg.contains(&format!(">{name}</text>")), "{frame}: {name}");
        }
    }
    let range = |options: &str| {
        let line = format!("render a.xyz --frame all --color-by q {TINY} {options} -o r.png");
        stderr(&folder, 0, &line);
        let of = |frame: u32| {
            let path = folder.path(&format!("r-000{frame}.png"));
            read_metadata(path).expect("a picture").value("color_range").map(str::to_owned)
        };
        assert_eq!(of(0), of(1));
        of(0)
    };
    // Of 1, 2, 3, 5, 6 and 9.
    assert_eq!(range("--color-range 25%,auto").as_deref(), Some("2.25,9"));
    assert_eq!(range("--color-range 0,50%").as_deref(), Some("0,4"));
    assert_eq!(range("--color-map categories"), None);
}

/// Returns frames of particles of one type at these positions, each with its own title.
fn trajectory(frames: &[&[[f64; 3]]]) -> String {
    let row = |[x, y, z]: &[f64; 3]| format!("C {x} {y} {z}\n");
    let rows = |frame: &[[f64; 3]]| frame.iter().map(row).collect::<String>();
    let frame = |frame: &&[[f64; 3]]| {
        format!("{}\nProperties=species:S:1:pos:R:3\n{}", frame.len(), rows(frame))
    };
    frames.iter().map(frame).collect()
}

/// Returns whether an image shows anything but the sky, and whether it is clear of the edges.
fn shown(folder: &Folder, name: &str) -> (bool, bool) {
    let image = Image::read(folder.path(name)).expect("a picture");
    let painted = |x: u32, y: u32| image.pixel(x, y).is_some_and(|pixel| pixel[1] < 0.9);
    let (right, bottom) = (image.width - 1, image.height - 1);
    let mut places = (0..=bottom).flat_map(|y| (0..=right).map(move |x| (x, y)));
    let edge = |x: u32, y: u32| x == 0 || y == 0 || x == right || y == bottom;
    let cropped = places.clone().any(|(x, y)| edge(x, y) && painted(x, y));
    (places.any(|(x, y)| painted(x, y)), !cropped)
}

/// Runs the program, and returns its messages in one line.
#[track_caller]
fn stderr(folder: &Folder, code: i32, line: &str) -> String {
    let args: Vec<&str> = line.split(' ').collect();
    let output = folder.run(&args);
    let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
    stderr
}

const TINY: &str = "--size 40x24 --spp 4 -q --background white --margin 0.2";

#[test]
fn the_camera_frames_all_frames_that_are_drawn() {
    let folder = Folder::new();
    let (near, far) = ([0.0, 0.0, 0.0], [90.0, -20.0, 40.0]);
    let drifting: Vec<[f64; 3]> = (0..5).map(|i| [30.0 * f64::from(i), 0.0, 9.0]).collect();
    let frames: Vec<&[[f64; 3]]> = drifting.iter().map(std::slice::from_ref).collect();
    folder.write("drift.xyz", &trajectory(&frames));
    folder.write("grow.xyz", &trajectory(&[&[near, [2.0, 1.0, 0.0]], &[near, far]]));
    folder.write("shrink.xyz", &trajectory(&[&[near, far], &[near, [2.0, 1.0, 0.0]]]));
    for (file, frames) in [("drift", 5), ("grow", 2), ("shrink", 2)] {
        for view in ["", " --view x", " --projection orthographic", " --view auto"] {
            let line =
                format!("render {file}.xyz --radii 4 --frame all {TINY} -o {file}.png{view}");
            assert_eq!(stderr(&folder, 0, &line), "", "{line}");
            for frame in 0..frames {
                let name = format!("{file}-{frame:04}.png");
                assert_eq!(shown(&folder, &name), (true, true), "{line} {frame}");
            }
        }
    }
    // The camera frames only the frames of the range.
    let line = format!("render drift.xyz --radii 4 --frame 4-4 {TINY} -o one.png");
    stderr(&folder, 0, &line);
    let line = format!("render drift.xyz --radii 4 --frame 4 {TINY} -o single.png");
    stderr(&folder, 0, &line);
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert_eq!(read("one-0004.png"), read("single.png"));
}

#[test]
fn frames_that_show_nothing_are_counted_once() {
    let folder = Folder::new();
    let (low, high): (&[[f64; 3]], &[[f64; 3]]) =
        (&[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]], &[[0.0, 3.0, 8.0]]);
    folder.write("a.xyz", &trajectory(&[low, &[], high, low, high, high]));
    let line = format!("render a.xyz --frame all {TINY} -o a.png");
    let all = stderr(&folder, 0, &line);
    assert!(all.contains("in 1 of 6 images: frames 1"), "{all}");
    for (condition, expected) in [
        ("--select z<5", "in 4 of 6 images: frames 1-2, 4-5"),
        ("--select z>5", "in 3 of 6 images: frames 0-1, 3"),
        ("--slice z>5", "in 4 of 6 images: frames 1-2, 4-5"),
    ] {
        let some = stderr(&folder, 0, &format!("{line} {condition} --view iso"));
        assert!(some.contains(expected), "{condition}: {some}");
        assert_eq!(some.matches("warning").count(), 1, "{some}");
    }
    let (empty, full) = (shown(&folder, "a-0001.png").0, shown(&folder, "a-0000.png").0);
    assert!(!empty && full);
    let none = stderr(&folder, 1, &format!("{line} --select z>50"));
    assert!(none.contains("no sphere in 6 frames"), "{none}");
    // A frame without atoms is valid in plain XYZ too.
    folder.write("plain.xyz", "1\n\nC 0 0 0\n0\n\n1\n\nC 0 0 1\n");
    let plain = stderr(&folder, 0, &format!("render plain.xyz --frame all {TINY} -o p.png"));
    assert!(plain.contains("in 1 of 3 images: frames 1"), "{plain}");
}

#[test]
fn single_pictures_without_spheres_are_reported() {
    let folder = Folder::new();
    let spheres = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    let camera = |eye: &str| format!("[camera]\neye = {eye}\ntarget = [0, 0, 40]\n");
    folder.write("away.toml", &(camera("[0, 0, 20]") + spheres));
    folder.write("toward.toml", &(camera("[0, 0, -20]") + spheres));
    folder.write("tiny.toml", &(camera("[0, 0, -20]") + &spheres.replace("= 1", "= 1e-5")));
    folder.write(
        "hidden.toml",
        &(camera("[0, 0, -20]")
            + spheres
            + "[[slice]]\nnormal = [0, 0, 1]\ndistance = -9\nmode = \"hide\"\n"),
    );
    for (file, expected) in [
        ("away", "none of 1 sphere is in view"),
        ("tiny", "1 sphere in the image"),
        ("hidden", "hide"),
    ] {
        let output = stderr(&folder, 0, &format!("render {file}.toml --size 24x24 --spp 2 -q"));
        assert!(output.contains("no sphere") && output.contains(expected), "{file}: {output}");
    }
    let toward = "render toward.toml --size 24x24 --spp 2 -q";
    assert_eq!(stderr(&folder, 0, toward), "");
    let corner = stderr(&folder, 0, &format!("{toward} --region 0,0,2x2"));
    assert!(corner.contains("region 0,0,2x2"), "{corner}");
}

#[test]
fn pipes_report_frames_outside_the_picture() {
    let folder = Folder::new();
    let frames: Vec<[f64; 3]> = (0..4).map(|i| [5.0 * f64::from(i), 0.0, 0.0]).collect();
    let frames: Vec<&[[f64; 3]]> = frames.iter().map(std::slice::from_ref).collect();
    let input = trajectory(&frames);
    let run = |args: &str| {
        let line = format!("render - --radii 1 {args} {TINY} -o a.png");
        let mut command = folder.command(&line.split(' ').collect::<Vec<_>>());
        let output = run_with_input(&mut command, &input);
        (output.status.code(), text(&output.stderr))
    };
    let (code, output) = run("--frame all");
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("in 3 of 4 images: frames 1-3"), "{output}");
    let (code, output) = run("--frame 1-9");
    assert_eq!(code, Some(1), "{output}");
    assert!(output.contains("no frame 9") && output.contains("--frame 1-3"), "{output}");
    assert_eq!(names(&folder), ["a-0000.png", "a-0001.png", "a-0002.png", "a-0003.png"]);
}

#[test]
fn missing_frames_are_refused_before_rendering() {
    let folder = folder();
    folder.write("damaged.xyz", &format!("{}2\n\nC 0 0 0\nC 0 zero 0\n", moving(2)));
    folder.write("cut.xyz", &format!("{}2\n\nC 0 0 0\n", moving(3)));
    folder.write("more.xyz", &format!("{}two\n", moving(3)));
    for (line, code, message) in [
        ("render damaged.xyz --frame all", 1, "frame 2:"),
        ("render more.xyz --frame all", 1, "frame 3:"),
        ("render a.xyz --frame 2-9", 1, "has no frame 9"),
        ("render a.xyz --frame 2-9", 1, "--frame 2-3"),
        ("render a.xyz --frame 1..9..2", 1, "--frame 1..3..2"),
        ("render a.xyz --frame 7..", 1, "has no frame 7"),
        ("render a.xyz --frame 7-9", 1, "--frame 3"),
        ("render cut.xyz --frame 1-3", 1, "--frame 1-2"),
        ("render a.xyz --frame 3-1", 2, "A no more than B"),
        ("info a.xyz --frame all", 2, "one frame here"),
        ("render --frame all", 2, "particle file"),
    ] {
        let size = if line.starts_with("render") { " --size 8x8 --spp 1" } else { "" };
        let output = stderr(&folder, code, &format!("{line}{size}"));
        assert!(output.contains(message), "{line}: {output}");
    }
    assert_eq!(names(&folder), [""; 0]);
    // Complete frames are drawn, and truncated ones are reported.
    let output = stderr(&folder, 0, &format!("render cut.xyz --frame all {TINY}"));
    assert!(output.contains("the file ends after 1 of 2 atoms"), "{output}");
    assert_eq!(names(&folder).len(), 3);
    stderr(&folder, 0, &format!("render more.xyz --frame 0-2 {TINY}"));
}
