//! Sequences of images: frames, turntables, parts, existing images, videos.

use crate::folder::{Folder, text};
use crate::process::{run, run_with_input};
use spherule_render::image::{Image, WriteOptions, read_metadata};
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::process::Output;

/// Frames of three particles, the last of which moves between the others.
fn trajectory(frames: usize) -> String {
    let frame = |i: usize| format!("3\n\nC 0 0 0\nN 9 2 3\nO {}.5 1 1\n", i + 1);
    (0..frames).map(frame).collect()
}

fn folder(frames: usize) -> Folder {
    let folder = Folder::new();
    folder.write("a.xyz", &trajectory(frames));
    folder
}

/// Runs `render a.xyz` at a small size, and returns its messages in one line.
#[track_caller]
fn render(folder: &Folder, code: i32, args: &str) -> String {
    let line = format!("render a.xyz --size 32x24 --spp 2 {args}");
    stderr(&folder.run(&line.split(' ').collect::<Vec<_>>()), code, &line)
}

#[track_caller]
fn stderr(output: &Output, code: i32, line: &str) -> String {
    let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
    stderr
}

/// Returns the contents of all files with this suffix.
fn files(folder: &Folder, suffix: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder.root()).expect("a folder");
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let names = entries.map(|entry| name(entry.expect("an entry")));
    let ours = names.filter(|name| name.ends_with(suffix));
    ours.map(|name| (name.clone(), folder.read(&name))).collect()
}

#[test]
fn frames_are_spread_over_the_pictures_of_a_turn() {
    for (pictures, expected) in [(3, "0 1 2"), (6, "0 0 1 1 2 2"), (2, "0 1")] {
        let folder = folder(3);
        render(&folder, 0, &format!("--frame all --turntable {pictures} -q -o t.png"));
        let found = files(&folder, ".png");
        let frame = |name: &String| {
            let metadata = read_metadata(folder.path(name)).expect("a picture");
            metadata.value("frame").expect("its frame").to_owned()
        };
        let frames: Vec<String> = found.keys().map(frame).collect();
        assert_eq!(frames.join(" "), expected);
        let names: Vec<String> = (0..pictures).map(|i| format!("t-{i:03}.png")).collect();
        assert!(found.keys().eq(&names), "{:?}", found.keys());
        let all: Vec<_> = found.values().collect();
        assert!((1..all.len()).all(|i| !all[..i].contains(&all[i])));
    }
    let folder = folder(3);
    let mut command = folder.command(&["render", "-", "--frame", "all", "--turntable", "3"]);
    let input = run_with_input(&mut command, &trajectory(3));
    assert!(stderr(&input, 2, "standard input").contains("--turntable"));
}

#[test]
fn parts_of_a_sequence_are_its_pictures() {
    for sequence in ["--frame all", "--turntable 5", "--frame 1..4 --turntable 7"] {
        let folder = folder(5);
        render(&folder, 0, &format!("{sequence} -q -o p.png"));
        let whole = files(&folder, ".png");
        for name in whole.keys() {
            fs::remove_file(folder.path(name)).expect("it is there");
        }
        for part in ["3/3", "1/3", "2/3"] {
            let before = files(&folder, ".png").len();
            render(&folder, 0, &format!("{sequence} -q -o p.png --part {part}"));
            let own = files(&folder, ".png").len() - before;
            assert!(own >= 1 && own <= whole.len().div_ceil(3), "{sequence} {part}: {own}");
        }
        assert!(files(&folder, ".png") == whole, "{sequence}");
        assert_eq!(files(&folder, ".part").len(), 0);
    }
    let folder = folder(2);
    let none = render(&folder, 0, "--frame all -q --part 3/4");
    assert!(none.contains("no image of part 3/4"), "{none}");
    let split = render(&folder, 2, "--frame all -q --part 1/2 --split tiles");
    assert!(split.contains("--split"), "{split}");
    assert_eq!(files(&folder, ".png").len(), 0);
}

#[test]
fn pictures_that_exist_are_kept_if_they_are_the_same() {
    let folder = folder(6);
    let sequence = "--frame all -o p.png";
    render(&folder, 0, &format!("{sequence} -q"));
    let whole = files(&folder, ".png");
    let again = format!("{sequence} --skip-existing");
    let numbers = |folder: &Folder| -> Vec<u64> {
        let number = |name: &String| fs::metadata(folder.path(name)).expect("a file").ino();
        files(folder, ".png").keys().map(number).collect()
    };
    let before = numbers(&folder);
    let kept = render(&folder, 0, &again);
    assert!(kept.contains("6 of 6 images already existed"), "{kept}");
    assert_eq!(numbers(&folder), before);
    // Missing, truncated, with other samples, of another frame, and without metadata.
    fs::remove_file(folder.path("p-0000.png")).expect("it is there");
    let short = &whole["p-0001.png"];
    fs::write(folder.path("p-0001.png"), &short[..short.len() - 40]).expect("written");
    fs::write(folder.path("p-0003.png"), &whole["p-0002.png"]).expect("written");
    let other = "render a.xyz --size 32x24 --spp 3 --frame all -q -o q.png";
    folder.succeed(&other.split(' ').collect::<Vec<_>>());
    fs::rename(folder.path("q-0002.png"), folder.path("p-0002.png")).expect("renamed");
    let bare = Image::read(folder.path("p-0004.png")).expect("a picture");
    bare.write(folder.path("p-0004.png"), &WriteOptions::default()).expect("written");
    for name in files(&folder, ".png").into_keys().filter(|name| name.starts_with('q')) {
        fs::remove_file(folder.path(&name)).expect("it is there");
    }
    let repaired = render(&folder, 0, &again);
    assert!(files(&folder, ".png") == whole, "{repaired}");
    for (name, why) in [
        ("p-0001.png", "cannot be read"),
        ("p-0002.png", "spp is 3 instead of 2"),
        ("p-0003.png", "frame is 2 instead of 3"),
        ("p-0004.png", "does not identify the scene"),
    ] {
        assert!(repaired.contains(&format!("{name}: already exists, but")), "{name}: {repaired}");
        assert!(repaired.contains(why), "{why}: {repaired}");
    }
    assert!(repaired.contains("1 of 6 images already existed"));
}

#[test]
fn other_scenes_and_settings_are_rendered_again() {
    let folder = folder(4);
    render(&folder, 0, "--frame all -q -o p.exr");
    let again = "--frame all -o p.exr --skip-existing";
    for (args, why) in [
        ("--view x", "view"),
        ("--radii 0.4", "radii"),
        ("--layers id", "layers"),
        ("--select element!=O", "select"),
        ("--background black", "background"),
    ] {
        let message = render(&folder, 0, &format!("{again} {args}"));
        assert!(message.contains(why) && !message.contains("already existed"), "{args}: {message}");
        // Restored.
        let back = render(&folder, 0, again);
        assert!(!back.contains("already existed"), "{args}: {back}");
    }
    // Between the others, so that the camera does not change.
    let moved = trajectory(4).replace("O 3.5", "O 3.25");
    folder.write("a.xyz", &moved);
    let message = render(&folder, 0, again);
    assert!(
        message.contains("p-0002.exr: already exists, but")
            && message.contains("different spheres"),
        "{message}"
    );
    assert!(message.contains("3 of 4 images already existed"), "{message}");
    assert!(render(&folder, 2, "--frame all -o p.pfm --skip-existing").contains(".exr"));
    // Single images too.
    render(&folder, 0, "-q -o one.png --skip-existing");
    let number = || fs::metadata(folder.path("one.png")).expect("a file").ino();
    let first = number();
    assert!(render(&folder, 0, "-o one.png --skip-existing").contains("skipped"));
    assert_eq!(number(), first);
    render(&folder, 0, "-q -o one.png --skip-existing --seed 5");
    assert_ne!(number(), first);
}

/// Replaces `ffmpeg` by a shell script, or removes it.
fn film(folder: &Folder, script: Option<&str>, args: &str) -> Output {
    let tools = folder.path("tools");
    fs::create_dir_all(&tools).expect("a folder");
    let program = tools.join("ffmpeg");
    let _ = fs::remove_file(&program);
    let mut path = tools.clone().into_os_string();
    if let Some(script) = script {
        let head = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\n";
        fs::write(&program, format!("{head}{script}\n")).expect("a script");
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("a script");
        path.push(":/usr/bin:/bin");
    }
    let line = format!("render a.xyz --size 31x24 --spp 2 -q {args}");
    run(folder.command(&line.split(' ').collect::<Vec<_>>()).env("PATH", path))
}

/// Stores its input and its arguments.
const KEEPS: &str = "echo \"$@\" > called; cat > \"$last\"";

#[test]
fn videos_are_piped_to_ffmpeg() {
    let folder = folder(3);
    let plain = "render a.xyz --frame all --size 31x24 --spp 2 -q -o p.ppm";
    folder.succeed(&plain.split(' ').collect::<Vec<_>>());
    let raster = |bytes: &[u8]| {
        let codes = &bytes[bytes.len() - 31 * 24 * 3..];
        let row = |row: &[u8]| [row, &row[row.len() - 3..]].concat();
        codes.chunks(31 * 3).flat_map(row).collect::<Vec<u8>>()
    };
    let expected: Vec<u8> = files(&folder, ".ppm").values().flat_map(|file| raster(file)).collect();
    for (name, format) in
        [("f.mp4", "-f mp4"), ("f.mov", "-f mov"), ("f.webm", "-f webm"), ("f.gif", "-f gif")]
    {
        let output = film(&folder, Some(KEEPS), &format!("--frame all --fps 12.5 -o {name}"));
        assert_eq!(stderr(&output, 0, name), "");
        assert!(folder.read(name) == expected, "{name}");
        let called = text(&folder.read("called"));
        assert!(called.contains("-video_size 32x24 -framerate 12.5 -i -"), "{called}");
        assert!(called.contains(format), "{called}");
        assert_eq!(called.contains("-pix_fmt yuv420p"), name != "f.gif", "{called}");
    }
    let turn = film(&folder, Some(KEEPS), "--turntable 5 -o turn.mp4");
    stderr(&turn, 0, "a turn");
    assert_eq!(folder.read("turn.mp4").len(), 5 * 32 * 24 * 3);
    assert!(text(&folder.read("called")).contains("-framerate 30 "));
    assert_eq!(fs::read_dir(folder.root()).expect("a folder").count(), 3 + 5 + 3);
}

#[test]
fn failed_videos_leave_the_old_file() {
    let folder = folder(3);
    folder.write("f.mp4", "an older film");
    for (script, expected) in [
        ("echo Unknown encoder >&2; exit 3", "Unknown encoder"),
        ("cat > /dev/null; echo no space >&2; exit 1", "no space"),
        ("cat > /dev/null", "wrote nothing"),
        ("head -c 100 > \"$last\"; kill -9 $$", "ffmpeg failed"),
    ] {
        let output = film(&folder, Some(script), "--frame all -o f.mp4");
        let message = stderr(&output, 1, script);
        assert!(message.contains("f.mp4") && message.contains(expected), "{script}: {message}");
        assert_eq!(folder.read("f.mp4"), b"an older film", "{script}");
    }
    let message = stderr(&film(&folder, None, "--frame all --fps 12 -o f.mp4"), 1, "no ffmpeg");
    for word in [
        "apt install ffmpeg",
        "-framerate 12 -pattern_type glob -i 'f-*.png' -vf 'pad=",
        "-o f-%04d.png",
    ] {
        assert!(message.contains(word), "{word}: {message}");
    }
    let names = fs::read_dir(folder.root()).expect("a folder");
    assert_eq!(names.count(), 3, "the input, the film and the tools");
}

#[test]
fn options_that_videos_do_not_support_are_refused() {
    let folder = folder(2);
    for (args, word) in [
        ("-o f.mp4", "--frame all or --turntable N"),
        ("--frame 1 -o f.webm", "--frame all"),
        ("--frame all -o f.mp4 --checkpoint c", "--checkpoint"),
        ("--frame all -o f.mp4 --part 1/2", "--part"),
        ("--frame all -o f.mp4 --skip-existing", "--skip-existing"),
        ("--frame all -o f.mp4 --layers id", "--layers"),
        ("--frame all -o f.mp4 --bits 16", "--bits"),
        ("--frame all -o f.mp4 --background transparent", "transparent"),
        ("--frame all -o f.png --fps 20", "--fps"),
        ("--frame all -o f.mp4 --fps 0", "per second"),
    ] {
        let message = stderr(&film(&folder, Some(KEEPS), args), 2, args);
        assert!(message.contains(word), "{args}: {message}");
    }
    assert_eq!(fs::read_dir(folder.root()).expect("a folder").count(), 2);
}

/// A lattice that does not move, of which half is in a later frame a little larger, and a particle that moves above it.
fn flicker() -> String {
    let frame = |shift: usize| {
        let point = |i: usize| format!("Si {} {} {}\n", 4 * (i / 16), 4 * (i / 4 % 4), 4 * (i % 4));
        let points: String = (0..64).map(point).collect();
        format!("65\nframe\n{points}O 6.{shift} 30 6\n")
    };
    [0, 5, 0].map(frame).concat()
}

/// Returns the greatest difference of the codes of two pictures in their lower half.
fn difference(folder: &Folder, names: [&str; 2]) -> u8 {
    let [a, b] = names.map(|name| {
        let bytes = folder.read(name);
        bytes[bytes.len() - 3 * 96 * 72..].to_vec()
    });
    let lower = 3 * 96 * 36..3 * 96 * 72;
    let pairs = a[lower.clone()].iter().zip(&b[lower]);
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn what_does_not_move_does_not_flicker() {
    let folder = Folder::new();
    folder.write("f.xyz", &flicker());
    for (options, most) in [("", 4), ("--spp 16 --denoise on", 4)] {
        let line = format!("render f.xyz --frame all --size 96x72 -q -o f-%d.ppm {options}");
        stderr(&folder.run(&line.split_whitespace().collect::<Vec<_>>()), 0, &line);
        assert!(difference(&folder, ["f-0.ppm", "f-1.ppm"]) <= most, "{options}");
        assert_eq!(difference(&folder, ["f-0.ppm", "f-2.ppm"]), 0);
        // The last frame alone, whose camera sees the same as that of all.
        let line = format!("render f.xyz --frame 0 --size 96x72 -q -o one.ppm {options}");
        stderr(&folder.run(&line.split_whitespace().collect::<Vec<_>>()), 0, &line);
        let samples = |name: &str| {
            let metadata = read_metadata(folder.path(name)).expect("a picture");
            (
                metadata.value("spp").map(str::to_owned),
                metadata.value("denoised").map(str::to_owned),
            )
        };
        assert_eq!(samples("one.ppm"), samples("f-0.ppm"));
    }
}

#[test]
fn frames_alone_are_those_of_their_sequence() {
    // Unnamed particles, so radii are guessed; their spacing differs, but not what the camera frames.
    let frame = |inner: usize| {
        let corner = |i: usize| format!("{} {} {}\n", 9 * (i / 4), 9 * (i / 2 % 2), 9 * (i % 2));
        let corners: String = (0..8).map(corner).collect();
        let within = |i: usize| format!("{} 4 4\n", 3 + i);
        let inner: String = (0..inner).map(within).collect();
        let count = 8 + inner.lines().count();
        format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
             ITEM: ATOMS x y z\n{corners}{inner}"
        )
    };
    let folder = Folder::new();
    folder.write("a.dump", &[1, 3, 2].map(frame).concat());
    let run = |args: &str| {
        let line = format!("render a.dump --size 32x24 -q {args}");
        stderr(&folder.run(&line.split(' ').collect::<Vec<_>>()), 0, &line);
    };
    run("--frame all -o all-%d.pfm");
    run("--frame 1.. -o some-%d.pfm");
    for (number, name) in [("0", "0"), ("1", "1"), ("2", "2"), ("last", "2")] {
        run(&format!("--frame {number} -o one.pfm"));
        assert!(folder.read("one.pfm") == folder.read(&format!("all-{name}.pfm")), "{number}");
    }
    assert!(folder.read("some-1.pfm") == folder.read("all-1.pfm"));
}
