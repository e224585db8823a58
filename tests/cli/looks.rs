//! How particles look on the command line.

use crate::folder::{Folder, text};
use spherule::image::Image;

const DUST: &str = "id,element,x,y,z,q,note\n7,C,0,0,0,-1,a\n8,O,3,0,0,0,b\n9,H,0,3,0,4,a\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("dust.csv", DUST);
    folder.write("a.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    folder
}

/// The picture of the dust with these looks.
fn picture(args: &[&str]) -> Image {
    let folder = folder();
    folder.picture("dust.ppm", &[&["dust.csv"], args].concat());
    Image::read(folder.path("dust.ppm")).expect("a picture")
}

#[test]
fn colors_follow_elements_or_columns() {
    let usual = picture(&[]);
    assert!(usual == picture(&["--colors", "jmol"]));
    let by_charge = picture(&["--color-by", "q"]);
    assert!(by_charge == picture(&["--color-by", "q", "--color-range", "-1,4"]));
    let pictures = [
        usual,
        by_charge,
        picture(&["--colors", "cpk"]),
        picture(&["--color-by", "id"]),
        picture(&["--color-by", "note"]),
        picture(&["--color-by", "q", "--color-map", "coolwarm"]),
        picture(&["--color-by", "q", "--color-range", "0,1"]),
        picture(&["--color-by", "id", "--color-log"]),
        picture(&["--type", "C:material=mirror"]),
        picture(&["--select", "element != C"]),
        picture(&["--select", "-q < 0"]),
        picture(&["--type", "C:color=#0000ff", "--type", "O:radius=0.5"]),
    ];
    for (place, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..place].contains(picture), "{place}");
    }
}

#[test]
fn radii_of_types_are_scaled_as_all_are() {
    let scaled = picture(&["--radii", "2", "--radius-scale", "0.5", "--type", "C:radius=0.5"]);
    assert!(scaled == picture(&["--radii", "1", "--type", "C:radius=0.25"]));
}

#[test]
fn color_bars_are_written_beside_the_picture() {
    let folder = folder();
    let plain = folder.picture("plain.ppm", &["dust.csv", "--color-by", "q"]);
    for (bar, start) in [("bar.svg", &b"<svg"[..]), ("bar.png", b"\x89PNG")] {
        let args = ["dust.csv", "--color-by", "q", "--color-bar", bar];
        assert_eq!(folder.picture("dust.ppm", &args), plain);
        assert!(folder.read(bar).starts_with(start), "{bar}");
    }
    let bar = text(&folder.read("bar.svg"));
    assert!(bar.contains("\nq\n") && bar.contains("\n4\n"), "{bar}");
    // Neither exposure nor tone touches it.
    let args = ["dust.csv", "--color-by", "q", "--color-bar", "b.svg", "--exposure", "2"];
    folder.picture("dust.ppm", &args);
    assert_eq!(text(&folder.read("b.svg")), bar);
}

#[test]
fn looks_that_cannot_be_are_refused() {
    let folder = folder();
    for (args, code, message) in [
        (&["a.toml", "--colors", "cpk"][..], 2, "a scene says itself"),
        (&["--color-by", "q"], 2, "for a file of particles"),
        (&["dust.csv", "--color-map", "magma"], 2, "--color-by"),
        (&["dust.csv", "--color-by", "q", "--color-map", "jet"], 2, "viridis"),
        (&["dust.csv", "--color-by", "q", "--color-range", "1"], 2, "the lower one first"),
        (&["dust.csv", "--color-by", "q", "--colors", "cpk"], 2, "cannot be used with"),
        (&["dust.csv", "--color-by", "q", "--color-bar", "bar.pdf"], 2, ".png or .svg"),
        (&["dust.csv", "--color-by", "note", "--color-bar", "bar.png"], 2, "a column of numbers"),
        (&["dust.csv", "--color-by", "q", "--color-bar", "no/bar.png"], 1, "cannot be written"),
        (&["dust.csv", "--select", "z > "], 2, "missing here z > ^"),
        (&["dust.csv", "--select", "mass > 1"], 1, "[selection:1:1] 1 │ mass > 1 · ────"),
        (&["dust.csv", "--select", "x > 9"], 1, "none of its 3 particles"),
        (&["dust.csv", "--type", "C:material=wood"], 2, "materials are lambertian"),
        (&["dust.csv", "--type", "Fe:radius=1"], 1, "`Fe`; there are C, O, H"),
        (&["dust.csv", "--color-by", "mass"], 1, "there are id, element, x, y, z, q, note, radius"),
        (&["dust.csv", "--color-by", "note", "--color-log"], 1, "`note` holds texts"),
    ] {
        let output = folder.run(&[&["render", "--spp", "1", "-o", "x.ppm"], args].concat());
        let said = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains(message), "{args:?}: {said}");
        assert!(!folder.path("x.ppm").exists(), "{args:?}");
    }
}
