//! Memory: estimates compared with the peak of the process, and limits.

use crate::folder::{Folder, text};
use serde_json::Value;
use std::fmt::Write as _;

/// Number of spheres of each source, which dominate the memory.
const COUNT: usize = 500_000;

/// Number of rows of files of text, which still dominate.
const ROWS: usize = 120_000;

/// Arguments of an image that is small enough for spheres to dominate.
const TINY: [&str; 7] = ["--size", "32x24", "--spp", "1", "--quiet", "-o", "x.png"];

/// Renders a file of the folder; returns the estimated and the peak memory in bytes.
fn bytes(folder: &Folder, file: &str, args: &[&str]) -> (f64, f64) {
    let report = folder.json(&[&["render", file, "--json"], &TINY[..], args].concat());
    let number =
        |name: &str| report["statistics"].get(name).and_then(Value::as_f64).expect("a number");
    (number("estimated_peak_bytes"), number("peak_bytes"))
}

/// Asserts that the estimate for a file is within 15 % of the peak.
#[track_caller]
fn estimated(folder: &Folder, file: &str, args: &[&str]) {
    let (estimate, peak) = bytes(folder, file, args);
    let ratio = estimate / peak;
    assert!((0.85..1.15).contains(&ratio), "{file}: {estimate} for {peak}, {ratio}");
}

/// Returns the positions of many particles, in a cube.
fn place(row: usize) -> [f64; 3] {
    let side = 80;
    [row % side, row / side % side, row / side / side].map(|cell| 0.7 * cell as f64)
}

/// Returns the rows of a file, between header and trailer.
fn rows(head: &str, count: usize, row: impl Fn(usize, [f64; 3]) -> String) -> String {
    let mut text = head.to_owned();
    for index in 0..count {
        writeln!(text, "{}", row(index, place(index))).expect("a text takes everything");
    }
    text
}

#[test]
fn estimates_are_right_for_every_generator() {
    let folder = Folder::new();
    let kinds = [
        "kind = \"grid\"\ncount = 500",
        "kind = \"field\"\ncount = 500",
        "kind = \"field\"\ncount = 500\ncolors = false",
        "kind = \"field\"\ncount = 500\nmix = [3, 2, 1]",
        "kind = \"volume\"\ncount = 250000\ncolors = true",
        "kind = \"lattice\"\ncount = 40",
        "kind = \"sphereflake\"\nlevel = 6",
        "kind = \"volume\"\ncount = 200000\nmaterial = \"emitter\"",
    ];
    let emitter = "[material.emitter]\nkind = \"emitter\"\nradiance = [1, 1, 1]\n";
    for kind in kinds {
        folder.write("a.toml", &format!("{emitter}[camera]\nfit = true\n[[generate]]\n{kind}\n"));
        estimated(&folder, "a.toml", &["--builder", "auto"]);
    }
    for builder in ["morton", "median", "surface-area"] {
        folder.write("b.toml", "[[generate]]\nkind = \"volume\"\ncount = 200000\n");
        estimated(&folder, "b.toml", &["--builder", builder]);
    }
}

#[test]
fn estimates_are_right_for_scenes_with_single_spheres() {
    let folder = Folder::new();
    let mut scene = "[camera]\nfit = true\n".to_owned();
    for row in 0..30_000 {
        let [x, y, z] = place(row);
        write!(scene, "[[sphere]]\ncenter = [{x}, {y}, {z}]\nradius = 0.3\n").expect("a text");
    }
    folder.write("spheres.toml", &scene);
    estimated(&folder, "spheres.toml", &[]);
}

#[test]
fn estimates_are_right_for_every_format_of_text() {
    let folder = Folder::new();
    let element = |row: usize| ["C", "O", "N"][row % 3];
    folder.write(
        "a.xyz",
        &rows(&format!("{ROWS}\n\n"), ROWS, |row, [x, y, z]| {
            format!("{} {x} {y} {z}", element(row))
        }),
    );
    folder.write(
        "a.csv",
        &rows("x,y,z,radius,red,green,blue\n", ROWS, |row, [x, y, z]| {
            format!("{x},{y},{z},0.3,{},{},{}", row as f64 / 1e6, 0.1, 0.9)
        }),
    );
    folder.write("a.txt", &rows("", ROWS, |_, [x, y, z]| format!("{x} {y} {z} 0.3")));
    folder.write("a.dump", &rows(
        &format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{ROWS}\nITEM: BOX BOUNDS pp pp pp\n0 60\n0 60\n\
             0 60\nITEM: ATOMS id type x y z\n"
        ),
        ROWS,
        |row, [x, y, z]| format!("{} {} {x} {y} {z}", row + 1, 1 + row % 2),
    ));
    folder.write(
        "a.data",
        &rows(
            &format!(
                "data\n\n{ROWS} atoms\n2 atom types\n0 60 xlo xhi\n0 60 ylo yhi\n0 60 zlo zhi\n\n\
             Atoms # atomic\n\n"
            ),
            ROWS,
            |row, [x, y, z]| format!("{} {} {x} {y} {z}", row + 1, 1 + row % 2),
        ),
    );
    folder.write(
        "a.gro",
        &(rows(&format!("water\n{ROWS}\n"), ROWS, |row, [x, y, z]| {
            let number = (row + 1) % 100_000;
            format!("{number:5}SOL  {:>5}{number:5}{x:8.3}{y:8.3}{z:8.3}", ["OW", "HW1"][row % 2])
        }) + "60 60 60\n"),
    );
    folder.write("a.pdb", &rows("", ROWS, |row, [x, y, z]| {
        let (number, name) = ((row + 1) % 100_000, element(row));
        format!(
            "ATOM  {number:5}  {name:<3} MOL A   1    {x:8.3}{y:8.3}{z:8.3}  1.00  0.00          {name:>2}"
        )
    }));
    for file in ["a.xyz", "a.csv", "a.txt", "a.dump", "a.data", "a.gro", "a.pdb"] {
        estimated(&folder, file, &[]);
    }
    estimated(&folder, "a.csv", &["--color-by", "x"]);
    folder.write("file.toml", "[camera]\nfit = true\n[[file]]\npath = \"a.csv\"\n");
    estimated(&folder, "file.toml", &[]);
}

#[test]
fn estimates_are_right_for_large_pictures() {
    let folder = Folder::new();
    folder.write("a.toml", "[camera]\nfit = true\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    // Pixels of the default scene are all written; those that are not take no memory in layers.
    for (scene, output, layers) in [
        (Some("a.toml"), "a.png", None),
        (Some("a.toml"), "a.ppm", None),
        (None, "a.exr", None),
        (None, "a.exr", Some("albedo")),
        (None, "a.exr", Some("all")),
    ] {
        let layers = layers.map_or(Vec::new(), |layers| vec!["--layers", layers]);
        let args = ["render", "--size", "800x500", "--spp", "1", "--quiet", "--json", "-o", output];
        let report = folder.json(&[&args[..], &Vec::from_iter(scene), &layers].concat());
        let number = |name: &str| report["statistics"][name].as_f64().expect("a number");
        let ratio = number("estimated_peak_bytes") / number("peak_bytes");
        assert!((0.85..1.2).contains(&ratio), "{output} {layers:?}: {ratio}");
    }
}

#[test]
fn renders_are_refused_just_below_their_estimate() {
    let folder = Folder::new();
    folder.write("a.toml", "[camera]\nfit = true\n[[generate]]\nkind = \"field\"\ncount = 707\n");
    let (_, peak) = bytes(&folder, "a.toml", &[]);
    let limited = |factor: f64| {
        let limit = format!("{:.3}MB", factor * peak / 1e6);
        folder.run(&[&["render", "a.toml", "--memory-limit", &limit], &TINY[..]].concat())
    };
    let enough = limited(1.15);
    assert!(enough.status.success(), "{}", text(&enough.stderr));
    let refused = limited(0.85);
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("of the memory limit"), "{}", text(&refused.stderr));
}

#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_shell_are_obeyed_and_named() {
    let folder = Folder::new();
    folder.write("a.toml", "[camera]\nfit = true\n[[generate]]\nkind = \"field\"\ncount = 707\n");
    folder.write("a.txt", &rows("", COUNT, |_, [x, y, z]| format!("{x} {y} {z} 0.3")));
    folder.write("one.txt", "0 0 0 0.3\n");
    let limited = |file: &str, option: &str, bytes: u64| {
        let line = format!("ulimit -{option} {}; exec \"$0\" \"$@\"", bytes >> 10);
        folder.shell(&line, &[&["render", file, "--threads", "2"], &TINY[..]].concat())
    };
    // Virtual memory includes that of the program itself, of which features and optimization make more or less.
    let suffices = |bytes: &u64| limited("one.txt", "v", *bytes).status.success();
    let own = (4..64).map(|step| step << 22).find(suffices).expect("a limit that suffices");
    for (file, least) in [("a.toml", 40_u64), ("a.txt", 32)] {
        let named = [("v", own, "virtual memory (ulimit -v)"), ("d", 0, "data (ulimit -d)")];
        for (option, own, name) in named {
            let few = limited(file, option, own + COUNT as u64 * least);
            assert_eq!(few.status.code(), Some(1), "{file} -{option}: {}", text(&few.stderr));
            assert!(text(&few.stderr).contains(name), "{file}: {}", text(&few.stderr));
            let enough = limited(file, option, 1 << 30);
            assert!(enough.status.success(), "{file} -{option}: {}", text(&enough.stderr));
        }
    }
}
