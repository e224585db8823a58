//! Image formats, images on standard output, and files that are rendered without the name of a command.

use crate::figures::codes;
use crate::folder::{Folder, SMALL, text};
use crate::process::Process;
use spherule_render::image::{Format, Image, compare, read_metadata};
use std::fs::File;
use std::process::{Output, Stdio};

const XYZ: &str = "2\nProperties=species:S:1:pos:R:3\nH 0 0 0\nO 0 1 0\n";

/// Runs the program with a file as standard input.
fn run_with_input(folder: &Folder, args: &[&str], input: &str) -> Output {
    let input = File::open(folder.path(input)).expect("a file");
    let mut command = folder.command(args);
    command.stdin(Stdio::from(input)).stdout(Stdio::piped()).stderr(Stdio::piped());
    Process::start(&mut command).end()
}

#[test]
fn every_format_holds_the_picture_and_its_settings() {
    let folder = Folder::new();
    folder.picture("reference.png", &["--tone", "filmic"]);
    let reference = Image::read(folder.path("reference.png")).expect("a picture");
    for format in Format::WRITTEN {
        for suffix in format.suffixes() {
            let name = format!("a.{suffix}");
            let bytes = folder.picture(&name, &["--tone", "filmic", "--quality", "95"]);
            assert_eq!(Format::of_content(&bytes), Some(format), "{name}");
            assert!(
                folder.picture(&name, &["--tone", "filmic", "--quality", "95"]) == bytes,
                "{name}"
            );
            let image = Image::read(folder.path(&name)).expect("a picture");
            assert_eq!((image.width, image.height), (40, 24), "{name}");
            if format.is_linear() {
                continue;
            }
            let rmse = compare(&image, &reference).expect("equal sizes").rmse;
            assert!(rmse <= if format == Format::Jpeg { 0.05 } else { 0.0 }, "{name}: {rmse}");
            let metadata = read_metadata(folder.path(&name)).expect("metadata");
            assert_eq!(metadata.value("tone"), Some("filmic"), "{name}");
            assert_eq!(metadata.value("bits"), Some("8"), "{name}");
            let quality = metadata.value("quality");
            assert_eq!(quality, (format == Format::Jpeg).then_some("95"), "{name}");
        }
    }
    folder.picture("deep.tif", &["--bits", "16"]);
    folder.picture("deep.png", &["--bits", "16"]);
    let read = |name| Image::read(folder.path(name)).expect("a picture");
    assert_eq!(read("deep.tif"), read("deep.png"));
    // Lower quality gives smaller files.
    let small = folder.picture("q.jpg", &["--quality", "20"]).len();
    assert!(small < folder.picture("q.jpg", &["--quality", "95"]).len());
}

#[test]
fn alpha_is_stored_where_the_format_allows() {
    let folder = Folder::new();
    folder.write("a.xyz", XYZ);
    let clear = ["a.xyz", "--background", "transparent"];
    for name in ["a.png", "a.tif", "a.webp"] {
        folder.picture(name, &clear);
    }
    let read = |name| -> Vec<[u8; 4]> {
        let picture = image::open(folder.path(name)).expect("a picture").into_rgba8();
        picture.pixels().map(|pixel| pixel.0).collect()
    };
    let png = codes(&folder, "a.png");
    assert!(png.iter().any(|pixel| pixel[3] == 0) && png.iter().any(|pixel| pixel[3] == 255));
    assert!(read("a.tif") == png && read("a.webp") == png);
    for name in ["a.jpg", "a.ppm", "a.pfm"] {
        let output = folder.run(&[&SMALL[..], &clear, &["-o", name]].concat());
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(text(&output.stderr).contains(".webp"), "{name}: {}", text(&output.stderr));
    }
    let wide = ["render", "--size", "16385x1", "--spp", "1", "-o", "wide.webp"];
    let output = folder.run(&wide);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("16384"), "{}", text(&output.stderr));
}

#[test]
fn standard_output_takes_a_picture_and_nothing_else() {
    let folder = Folder::new();
    folder.succeed(&[&SMALL[..], &["-o", "p.png", "--part", "1/1"]].concat());
    let small = &SMALL[..5];
    for format in Format::WRITTEN {
        let name = format!("a.{}", format.suffixes()[0]);
        let expected = folder.picture(&name, &[]);
        let typed = ["--output-format", format.option_name(), "--stats", "-o", "-"];
        let output = folder.run(&[small, &typed].concat());
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
        assert!(output.stdout == expected, "{name}");
        assert!(text(&output.stderr).contains("samples"), "{name}: {}", text(&output.stderr));
        let merged = ["merge", "p.1-of-1.part", "-o", "-", "--output-format", format.option_name()];
        let output = folder.run(&merged);
        assert!(output.status.success() && output.stdout == expected, "{name} merged");
        assert!(text(&output.stderr).contains("samples"), "{name}: {}", text(&output.stderr));
    }
    assert!(folder.run(&[small, &["-o", "-"]].concat()).stdout == folder.read("a.png"));
    folder.succeed(&[small, &["-o", "exr-in.png", "--output-format", "exr"]].concat());
    assert!(folder.read("exr-in.png") == folder.read("a.exr"));
    folder.write("a.xyz", XYZ);
    folder.write("a.script", "save a.png\n");
    for line in [
        "render -o - --json",
        "render -o - --turntable 3",
        "render a.xyz -o - --frame all",
        "render -o - --part 1/2",
        "render -o - --terminal",
        "render -o - --layers id",
        "merge p.1-of-1.part -o - --json",
        "view -o - --headless-script a.script",
    ] {
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{line}: {}", text(&output.stderr));
        assert!(output.stdout.is_empty(), "{line}");
    }
    assert!(!folder.path("-").exists() && !folder.path("--000").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let folder = Folder::new();
    let output =
        folder.shell("exec \"$0\" \"$@\" >/dev/full", &[&SMALL[..], &["-o", "-"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("standard output"), "{}", text(&output.stderr));
}

#[test]
fn files_are_rendered_without_a_subcommand() {
    let folder = Folder::new();
    folder.write("dump.xyz", XYZ);
    folder.write("info", XYZ);
    let options = ["--size", "40x24", "--spp", "4", "-q", "-o"];
    folder.succeed(&[&["render", "dump.xyz"], &options[..], &["a.png"]].concat());
    let expected = folder.read("a.png");
    let same = |output: &Output, line: &str| {
        assert!(output.status.success(), "{line}: {}", text(&output.stderr));
        assert!(folder.read("b.png") == expected, "{line}");
        std::fs::remove_file(folder.path("b.png")).expect("a picture");
    };
    same(&folder.run(&[&["dump.xyz"], &options[..], &["b.png"]].concat()), "file first");
    same(&folder.run(&[&options[..], &["b.png", "dump.xyz"]].concat()), "options first");
    let piped = run_with_input(&folder, &[&["-"], &options[..], &["b.png"]].concat(), "dump.xyz");
    // Images name their source.
    assert!(piped.status.success() && Image::read(folder.path("b.png")).is_ok());
    // The command line is stored in a checkpoint, too.
    folder.succeed(&[&["dump.xyz"], &options[..], &["c.png", "--checkpoint", "c"]].concat());
    folder.succeed(&["--resume", "c", "--spp", "8", "-q"]);
    assert_eq!(read_metadata(folder.path("c.png")).expect("metadata").value("spp"), Some("8"));
    // The name of a command takes precedence over a file.
    assert_eq!(folder.run(&["info"]).status.code(), Some(2));
    folder.succeed(&[&["./info"], &options[..], &["d.png"]].concat());
    for (word, like) in [("dupm.xyz", "dump.xyz"), ("rendr", "render"), ("./dump.xy", "./dump.xyz")]
    {
        let output = folder.run(&[word]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("did you mean") && message.contains(like), "{message}");
    }
}

#[test]
fn help_and_readme_list_every_format() {
    let folder = Folder::new();
    let readme = include_str!("../../README.md");
    let help = [
        folder.succeed(&["render", "--help"]),
        folder.succeed(&["merge", "--help"]),
        folder.succeed(&["view", "--help"]),
        readme.to_owned(),
    ];
    for text in help {
        for format in Format::WRITTEN {
            let suffix = format!(".{}", format.suffixes()[0]);
            assert!(text.contains(&suffix), "{suffix} is missing: {text}");
        }
    }
}
