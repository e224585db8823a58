//! Outputs: failing standard output, and files that would replace others.

use crate::folder::{Folder, SMALL, text};
use std::fs;
use std::process::Output;

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_cannot_be_written_is_an_error() {
    let folder = Folder::new();
    folder.write("a.csv", "x,y,z\n0,0,0\n");
    folder.picture("a.png", &[]);
    folder.succeed(&[&SMALL[..], &["-o", "p.png", "--part", "1/1"]].concat());
    let small = [&SMALL[..5], &["-o", "b.png"]].concat();
    let lines: [&[&str]; 20] = [
        &small,
        &[&small[..], &["--json"]].concat(),
        &[&small[..], &["--stats"]].concat(),
        &[&small[..], &["--part", "1/2"]].concat(),
        &["merge", "p.1-of-1.part", "-o", "m.png"],
        &["merge", "p.1-of-1.part", "-o", "m.png", "--json"],
        &["info", "a.csv"],
        &["info", "a.csv", "--json"],
        &["compare", "a.png", "a.png"],
        &["compare", "a.png", "a.png", "--json"],
        &["field", "-o", "f.toml"],
        &["stress", "--rays", "640"],
        &["completions", "bash"],
        &["bench", "build", "--quick", "--scenes", "paper400"],
        &["status", "p.1-of-1.part"],
        &["status", "p.1-of-1.part", "--json"],
        &["--help"],
        &["render", "--help"],
        &["help", "field"],
        &["--version"],
    ];
    let check = |line: &[&str], reason: &str, output: &Output| {
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line:?}: {message}");
        assert!(message.contains("standard output"), "{line:?}: {message}");
        assert!(message.contains(reason), "{line:?}: {message}");
    };
    for line in lines {
        check(line, "No space left", &folder.shell("exec \"$0\" \"$@\" >/dev/full", line));
        // The work itself is done.
        if let Some(name) = line.iter().skip_while(|word| **word != "-o").nth(1)
            && !line.contains(&"--part")
        {
            fs::remove_file(folder.path(name)).expect("an output that is there");
        }
        let _ = fs::remove_file(folder.path("f.csv"));
    }
    let lost = folder.shell("exec \"$0\" compare a.png missing.png 2>/dev/full", &[]);
    assert_eq!(lost.status.code(), Some(1));
    let tiny = ["render", "--size", "8x8", "--spp", "1", "--lanes", "4", "--traversal", "scalar"];
    let lost = folder.shell("exec \"$0\" \"$@\" 2>/dev/full", &tiny);
    assert_eq!(lost.status.code(), Some(1));
    // Closed standard error suppresses messages.
    let closed = folder.shell("exec \"$0\" \"$@\" 2>&-", &tiny);
    assert_eq!(closed.status.code(), Some(0));
}

/// Writes a particle file of three frames with a column, a scene with an environment, and a part.
fn with_inputs() -> Folder {
    let folder = Folder::new();
    let frame = "2\nProperties=species:S:1:pos:R:3:heat:R:1\nH 0 0 0 1\nO 0 1 0 2\n";
    folder.write("t.xyz", &frame.repeat(3));
    folder.picture("sky.exr", &[]);
    folder.picture("sky.pfm", &[]);
    let sky = "[environment]\nkind = \"picture\"\nfile = \"sky.exr\"\n";
    folder.write("lit.toml", &format!("{sky}[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n"));
    folder.write("listed.toml", "[[file]]\npath = \"sub/../points.csv\"\n");
    folder.write("points.csv", "x,y,z\n0,0,0\n");
    folder.write("table.toml", "[[file]]\npath = \"build-x.csv\"\n");
    folder.write("build-x.csv", "x,y,z\n0,0,0\n");
    fs::create_dir(folder.path("sub")).expect("a folder");
    folder.succeed(&[&SMALL[..], &["-o", "p.png", "--part", "1/1"]].concat());
    folder.succeed(&[&SMALL[..], &["-o", "old.png", "--checkpoint", "kept"]].concat());
    folder
}

/// Returns all files of a folder with their contents.
fn contents(folder: &Folder) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder.root()).expect("a folder").flatten();
    let files = entries.filter(|entry| entry.path().is_file());
    let mut all: Vec<_> = files
        .map(|entry| {
            let name = text(entry.file_name().as_encoded_bytes());
            (name.clone(), folder.read(&name))
        })
        .collect();
    all.sort();
    all
}

#[cfg(unix)]
#[test]
fn outputs_replace_neither_inputs_nor_each_other() {
    use std::os::unix::fs::symlink;
    let folder = with_inputs();
    symlink("r.png", folder.path("new-link.png")).expect("a link");
    symlink("points.csv", folder.path("points.png")).expect("a link");
    symlink("p.1-of-1.part", folder.path("part.png")).expect("a link");
    fs::hard_link(folder.path("sky.exr"), folder.path("hard.exr")).expect("a link");
    folder.write("a.script", "size 8x8\nsave s.png\nwindow s.png\n");
    folder.write("b.script", "size 8x8\nsave points.toml\n");
    folder.write("c.script", "size 8x8\nkey ctrl+s\n");
    let before = contents(&folder);
    let bar = "render t.xyz --color-by heat --size 8x8 --spp 1";
    let lines = [
        (format!("{bar} --color-bar r.png -o r.png"), ["--color-bar", "--output"]),
        (format!("{bar} --color-bar sub/../r.png -o ./r.png"), ["--color-bar", "--output"]),
        (format!("{bar} --color-bar new-link.png -o r.png"), ["--color-bar", "--output"]),
        (
            format!("{bar} --frame 0-2 --color-bar r-0002.png -o r.png"),
            ["--color-bar", "r-0002.png"],
        ),
        (
            format!("{bar} --frame all --color-bar r-0000.png -o r.png"),
            ["--color-bar", "r-0000.png"],
        ),
        (
            format!("{bar} --turntable 3 --color-bar r-002.png -o r.png"),
            ["--color-bar", "r-002.png"],
        ),
        (format!("{bar} --checkpoint r.svg --color-bar r.svg"), ["--checkpoint", "--color-bar"]),
        (format!("{bar} --json -o r.png > r.png"), ["standard output", "--output"]),
        ("render --checkpoint z.png -o z.png".to_owned(), ["--checkpoint", "--output"]),
        ("render --checkpoint old.png -o old.png".to_owned(), ["--checkpoint", "--output"]),
        (
            "render --resume kept --checkpoint z.png -o z.png".to_owned(),
            ["--checkpoint", "--output"],
        ),
        ("render lit.toml -o sky.exr".to_owned(), ["--output", "lit.toml"]),
        ("render lit.toml -o hard.exr".to_owned(), ["--output", "lit.toml"]),
        ("render listed.toml -o points.png".to_owned(), ["--output", "listed.toml"]),
        ("render points.csv -o points.png".to_owned(), ["--output", "points.csv"]),
        ("render - -o points.png < points.csv".to_owned(), ["--output", "standard input"]),
        ("render points.csv --checkpoint ./points.csv".to_owned(), ["--checkpoint", "points.csv"]),
        ("merge p.1-of-1.part -o part.png".to_owned(), ["--output", "p.1-of-1.part"]),
        ("stress --rays 64 --csv ./s --plot s".to_owned(), ["--plot", "s"]),
        ("stress --rays 64 --csv s.png --plot sub/../s.png".to_owned(), ["--csv", "--plot"]),
        ("view points.csv --headless-script a.script".to_owned(), ["line 2", "line 3"]),
        ("view points.csv --headless-script b.script".to_owned(), ["line 2", "points.csv"]),
        (
            "view points.csv -o points.ppm --headless-script c.script".to_owned(),
            ["--output", "points.csv"],
        ),
        ("info points.csv --json >> points.csv".to_owned(), ["standard output", "points.csv"]),
        ("compare sky.exr sky.pfm >> sky.pfm".to_owned(), ["standard output", "sky.pfm"]),
        ("bench build --quick --scenes table.toml -o .".to_owned(), ["--output", "build-x.csv"]),
    ];
    for (line, words) in lines {
        let output = folder.shell(&format!("exec \"$0\" {line}"), &[]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        for word in words {
            assert!(message.contains(word), "{line} lacks `{word}`: {message}");
        }
        if line.ends_with("> r.png") {
            fs::remove_file(folder.path("r.png")).expect("what the shell made");
        }
        assert!(contents(&folder) == before, "{line}: files changed");
    }
}

#[test]
fn files_beside_a_scene_are_replaced_only_with_their_scene() {
    let folder = Folder::new();
    folder.write("data.csv", "mine");
    let output = folder.run(&["field", "-o", "data.toml"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("data.csv") && message.contains("already exists"), "{message}");
    // Not even if another scene refers to it.
    folder.write("data.toml", "[[file]]\npath = \"data.csv\"\n");
    assert_eq!(folder.run(&["field", "-o", "data.toml"]).status.code(), Some(1));
    assert_eq!(folder.read("data.csv"), b"mine");
    fs::remove_file(folder.path("data.csv")).expect("a file");
    folder.succeed(&["field", "grid", "-o", "data.toml"]);
    let grid = folder.read("data.csv");
    folder.succeed(&["field", "lattice", "-o", "data.toml"]);
    assert!(folder.read("data.csv") != grid);
    folder.write("locked.lock", "mine");
    let output = folder.run(&[&SMALL[..], &["--checkpoint", "locked"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("locked.lock"), "{}", text(&output.stderr));
    assert_eq!(folder.read("locked.lock"), b"mine");
}

#[cfg(unix)]
#[test]
fn replaceable_files_are_replaced() {
    let folder = with_inputs();
    folder.picture("old.png", &["--seed", "2"]);
    let lines = [
        // A checkpoint resumes in its own file, under any name.
        "render --resume ./kept --checkpoint sub/../kept --spp 8 -q",
        "render --resume kept --checkpoint other --spp 8 -q",
        "stress --rays 64 -q --csv /dev/null --plot p.svg",
        "compare sky.exr sky.exr",
        "render --size 8x8 --spp 1 -q -o once.png --json > report.json",
    ];
    for line in lines {
        let output = folder.shell(&format!("exec \"$0\" {line}"), &[]);
        assert!(output.status.success(), "{line}: {}", text(&output.stderr));
    }
}
