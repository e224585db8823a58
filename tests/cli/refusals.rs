//! Invalid input: exit codes and messages, without changed files.

use crate::folder::{Folder, text};
use std::fs;

#[test]
fn bad_input_is_refused_with_help() {
    let folder = Folder::new();
    folder.write("key.toml", "[render]\nsppp = 3\n");
    folder.write("fov.toml", "[camera]\nfov = 180\n");
    folder.write("empty.toml", "");
    folder.write("bad.xyz", "0 0 0 1\n1 2 x 1\n");
    let cases: &[(&str, i32, &[&str])] = &[
        ("render --size 0x5", 2, &["--size", "1 to 65535"]),
        ("render --size 70000x1", 2, &["--size", "1 to 65535"]),
        ("render --size -4x4", 2, &["--size", "1 to 65535"]),
        ("render --size 85", 2, &["--size", "85mm"]),
        ("render --size 85mmx60", 2, &["--size", "85mmx60mm"]),
        ("render --size 9cm --dpi 65535", 2, &["at most 65535 pixels", "--size"]),
        ("render --size 0.1mm --dpi 72", 1, &["[0, 0]", "1 to 65535"]),
        ("render --dpi 0", 2, &["--dpi", "1 to 65535"]),
        ("render --opacity 130%", 2, &["--opacity", "between 0 and 1"]),
        ("render a.toml --size 85 mm", 2, &["'mm'", "quotes"]),
        ("render --view top", 2, &["--view", "0,90"]),
        ("render -o a.foo", 1, &["a.foo", ".ppm, .pdf, .svg"]),
        ("render --spp 0", 2, &["--spp", "from 1 to 16777216"]),
        ("render --spp -3", 2, &["--spp"]),
        ("render --until-error 0%", 2, &["--until-error", "1%"]),
        ("render --until-error 0.5", 2, &["--until-error", "0.5%"]),
        ("render --time 60", 2, &["--time", "60s"]),
        ("render --depth -1", 2, &["--depth", "unlimited"]),
        ("render --seed -1", 2, &["--seed"]),
        ("render --threads 0", 2, &["--threads", "1..=4096"]),
        ("render --exposure NaN", 2, &["--exposure", "-100 to 100"]),
        ("render --roulette 0", 2, &["--roulette", "more than 0"]),
        ("render --roulette 1.5", 2, &["--roulette", "at most 1"]),
        ("render --shadow-samples 0", 2, &["--shadow-samples"]),
        ("render --ao-distance=-1", 2, &["--ao-distance", "0 or more"]),
        ("render --lanes 3", 2, &["--lanes", "1, 4, 8, 16"]),
        ("render --traversal quick", 2, &["--traversal", "brute, scalar, stream, packet"]),
        ("render --builder best", 2, &["--builder", "median, surface-area, morton"]),
        ("render --region 1,2,0x4", 2, &["--region", "at least 1"]),
        ("render --region 900,0,100x10", 2, &["--region", "960x540"]),
        ("render --region 4294967295,0,1x1", 2, &["--region", "960x540"]),
        ("render --memory-limit 4", 2, &["--memory-limit", "4GB"]),
        (
            "render --memory-limit 90MB --size 2000x2000 --spp 4",
            1,
            &["400 spheres (", "2000 x 2000 pixels (216.0 MB)", "of the memory limit", "--size"],
        ),
        (
            "render --size 65535x65535 --denoise off",
            1,
            &["65535 x 65535 pixels (231.9 GB) need 231.9 GB", "left", "--size or --region"],
        ),
        (
            "render --size 65535x65535",
            1,
            &["65535 x 65535 pixels (953.5 GB)", "--size or --region", "--denoise off"],
        ),
        (
            "render --size 65535x65535 --spp 4 --layers all -o a.exr",
            1,
            &["their layers", "--size or --region"],
        ),
        ("render --quiet --verbose", 2, &["--quiet", "--verbose"]),
        ("render missing.toml", 1, &["missing.toml", "cannot be read"]),
        ("render ky.toml", 1, &["ky.toml", "`key.toml`"]),
        ("render bda.xyz", 1, &["bda.xyz", "`bad.xyz`"]),
        ("render missing.csv", 1, &["missing.csv", "cannot be read"]),
        ("render key.toml", 1, &["key.toml:2:1", "sppp", "spp`?"]),
        ("render fov.toml", 1, &["fov.toml:2", "180"]),
        ("render empty.toml", 1, &["empty.toml", "no spheres"]),
        ("render bad.xyz", 1, &["bad.xyz:2:5", "not a number"]),
        ("info empty.toml", 1, &["no spheres"]),
        ("info .", 1, &["cannot be read"]),
        ("render -o missing/a.png", 1, &["missing", "folder"]),
        ("render -o a.bmp", 1, &["a.bmp", ".png", ".webp"]),
        ("render -o a.gif", 2, &["a video", "--frame all", ".png"]),
        ("compare missing.png missing.png", 1, &["missing.png"]),
        ("compare key.toml key.toml", 1, &["not a picture"]),
        ("field", 2, &["--output"]),
        ("field -o a.csv", 2, &[".toml"]),
        ("field -o missing/a.toml", 1, &["missing"]),
        ("field grid --level 3 -o a.toml", 2, &["--level", "sphereflake"]),
        ("field grid --radius 1,2 -o a.toml", 2, &["--radius", "single radius"]),
        ("field volume --size -1 -o a.toml", 1, &["--size", "more than 0"]),
        ("field sphereflake --level 60 -o a.toml", 1, &["--level", "spheres"]),
        ("completions cobol", 2, &["cobol", "bash"]),
        ("paint", 2, &["paint", "neither a command nor a file"]),
    ];
    refused(&folder, cases);
    assert!(!folder.path("spherule.png").exists() && !folder.path("a.toml").exists());
}

#[test]
fn words_of_other_programs_are_answered_by_those_that_do_the_same() {
    let cases: &[(&str, i32, &[&str])] = &[
        ("render --width 800", 2, &["'--size'"]),
        ("render --resolution=300", 2, &["'--size'", "'--dpi'"]),
        ("render --transparent", 2, &["'--background transparent'"]),
        ("render --cmap jet", 2, &["'--color-map'"]),
        ("render --dof 5", 2, &["'--aperture'"]),
        ("render --color red", 2, &["'--color-by'"]),
        ("render --model vdw", 2, &["'space-filling'"]),
        ("render --title x", 2, &["'--label'"]),
    ];
    refused(&Folder::new(), cases);
}

/// Checks the exit code of each command, and that the message has these words.
fn refused(folder: &Folder, cases: &[(&str, i32, &[&str])]) {
    for (line, code, words) in cases {
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{line}: {message}");
        assert!(!message.contains("panicked"), "{line}: {message}");
        assert!(output.stdout.is_empty(), "{line}");
        for word in *words {
            assert!(message.contains(word), "{line} lacks `{word}`: {message}");
        }
    }
}

#[test]
fn failures_leave_old_files_alone() {
    let folder = Folder::new();
    folder.write("old.png", "old");
    folder.write("empty.toml", "");
    fs::create_dir(folder.path("folder.png")).unwrap();
    for args in [
        &["render", "empty.toml", "-o", "old.png"][..],
        &["render", "--region", "0,0,9999x1", "-o", "old.png"],
        &["render", "-o", "folder.png"],
        &["render", "-o", "old.png/a.png"],
    ] {
        let output = folder.run(args);
        assert!(!output.status.success(), "{args:?}");
        assert!(!text(&output.stderr).contains("panicked"));
    }
    assert_eq!(folder.read("old.png"), b"old");
    assert_eq!(fs::read_dir(folder.path("folder.png")).unwrap().count(), 0);
}
