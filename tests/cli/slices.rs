//! Slices on the command line and in scene files.

use crate::folder::{Folder, SMALL, text};
use spherule_render::image::Image;

/// A row of spheres along x, in a longer cell.
const ROW: &str = "\
5
Lattice=\"20 0 0 0 4 0 0 0 4\" Properties=species:S:1:pos:R:3
C 1 2 2
C 3 2 2
C 5 2 2
C 7 2 2
C 9 2 2
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.xyz", ROW);
    folder
}

fn spheres(folder: &Folder, args: &[&str]) -> u64 {
    let all = [&SMALL[..], &["a.xyz", "--radii", "1", "--json", "-o", "b.png"], args].concat();
    folder.json(&all)["statistics"]["spheres"].as_u64().expect("a count")
}

#[test]
fn planes_cut_particles_away() {
    let folder = folder();
    for (plane, left) in [
        ("x>4", 2),
        ("x<4", 3),
        ("x=20%", 2),
        ("x<20%", 3),
        ("1,0,0,4", 2),
        ("-x>-4", 3),
        ("x+y>7", 3),
    ] {
        assert_eq!(spheres(&folder, &["--slice", plane]), left, "{plane}");
    }
    assert_eq!(spheres(&folder, &["--slice", "x>6", "--slice", "x<2"]), 2);
    assert_eq!(spheres(&folder, &["--slice", "x>5.5", "--slice-mode", "caps"]), 3);
    assert_eq!(spheres(&folder, &["--slice", "x>5.5", "--slice-mode", "hide"]), 5);
    assert_eq!(spheres(&folder, &["--replicate", "2,1,1", "--slice", "x>50%"]), 5);
}

/// Counts red and other pixels in an image of a cube of spheres whose layers next to a cut are red.
fn faces(planes: &[&str], red: impl Fn([u32; 3]) -> bool, args: &[&str]) -> [usize; 2] {
    let folder = Folder::new();
    let atom = |i: u32| {
        let [x, y, z] = [i % 5, i / 5 % 5, i / 25];
        format!("{} {x} {y} {z}\n", if red([x, y, z]) { "K" } else { "C" })
    };
    let atoms: Vec<String> = (0..125).map(atom).collect();
    folder.write("cube.xyz", &format!("125\n\n{}", atoms.concat()));
    let mut all = vec!["cube.xyz", "--radii", "0.55", "--type", "K:color=red"];
    all.extend(["--type", "C:color=blue", "--preset", "chalk"]);
    all.extend(planes.iter().flat_map(|plane| ["--slice", plane]));
    folder.picture("a.png", &[&all, args].concat());
    let image = Image::read(folder.path("a.png")).expect("a picture");
    let count = |own: usize, other: usize| {
        image.pixels.iter().filter(|pixel| pixel[own] > 2.0 * pixel[other]).count()
    };
    [count(0, 2), count(2, 0)]
}

#[test]
fn default_cameras_look_at_cuts() {
    let modes: [&[&str]; 3] = [&[], &["--slice-mode", "caps"], &["--slice-mode", "hide"]];
    for axis in 0..3 {
        for (sign, layer) in [("<", 2), (">", 2)] {
            let at = if sign == "<" { 1.5 } else { 2.5 };
            let plane = format!("{}{sign}{at}", ["x", "y", "z"][axis]);
            for mode in modes {
                let [red, blue] = faces(&[&plane], |place| place[axis] == layer, mode);
                assert!(red > 20 && 4 * red > blue, "{plane} {mode:?}: {red} {blue}");
            }
        }
    }
    let red = |place: [u32; 3]| place[0] == 2 || place[2] == 2;
    let [red, blue] = faces(&["x<1.5", "z<1.5"], red, &[]);
    assert!(red > blue, "{red} {blue}");
    // An explicit view is kept.
    let [red, _] = faces(&["z<1.5"], |place| place[2] == 2, &["--view", "z"]);
    assert_eq!(red, 0);
}

#[test]
fn removing_slices_equal_selections() {
    let folder = folder();
    let view = ["a.xyz", "--radii", "1", "--view", "z"];
    let slice = folder.picture("a.png", &[&view[..], &["--slice", "x>4"]].concat());
    let select = folder.picture("b.png", &[&view[..], &["--select", "x <= 4"]].concat());
    let image = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert_eq!(image("a.png"), image("b.png"));
    let mentions_slice = |bytes: &[u8]| text(bytes).contains("slice");
    assert!(mentions_slice(&slice) && !mentions_slice(&select));
}

#[test]
fn scene_files_hold_slices() {
    let folder = folder();
    folder.write(
        "a.toml",
        "[[file]]\npath = \"a.xyz\"\nradius = 1.0\n[[slice]]\nnormal = [2, 0, 0]\ndistance = 5.5\nmode = \"caps\"\n",
    );
    let info = folder.succeed(&["info", "a.toml"]);
    assert!(info.contains("beyond 5.5 along [1.0, 0.0, 0.0]: caps"), "{info}");
    assert!(info.contains("1 plane at which spheres end"), "{info}");
    assert!(info.contains("slices without 2 spheres"), "{info}");
    let all = [&SMALL[..], &["a.toml", "--slice", "x<2", "--json", "-o", "b.png"]].concat();
    assert_eq!(folder.json(&all)["statistics"]["spheres"], 2);
    folder.write(
        "b.toml",
        "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n[[slice]]\nmode = \"caps\"\n",
    );
    folder.write("c.toml", "[[slice]]\nnormal = [0, 0, 1]\nmode = \"cap\"\n");
    for (name, message) in [("b.toml", "normal = [x, y, z]"), ("c.toml", "unknown mode")] {
        let stderr = text(&folder.run(&["info", name]).stderr);
        assert!(stderr.contains(message), "{stderr}");
    }
}

#[test]
fn invalid_planes_are_refused() {
    let folder = folder();
    for (args, code, message) in [
        (&["--slice", "x>-1"][..], 1, "cut away all of its 5 spheres"),
        (&["--slice", "w>1"], 2, "true for the part to cut away"),
        (&["--slice", "x=200%"], 2, "true for the part to cut away"),
        (&["--slice", "x>1", "--slice-mode", "cap"], 2, "did you mean `caps`"),
        (&["--slice-mode", "caps"], 2, "--slice"),
        (
            &["--slice", "x>1.5", "--slice-mode", "caps", "--type", "C:material=glass"],
            1,
            "of glass",
        ),
    ] {
        let output = folder.run(&[&SMALL[..], &["a.xyz", "--radii", "1"], args].concat());
        let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
        assert!(stderr.contains(message), "{args:?}: {stderr}");
    }
}
