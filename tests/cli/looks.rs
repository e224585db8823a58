//! Appearance of particles on the command line.

use crate::folder::{Folder, text};
use spherule_render::image::Image;

const DUST: &str = "id,element,x,y,z,q,note\n7,C,0,0,0,-1,a\n8,O,3,0,0,0,b\n9,H,0,3,0,4,a\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("dust.csv", DUST);
    folder.write("a.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    folder
}

/// Returns the image of the particles with these options.
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
        picture(&["--color-by", "q", "--color-map", "coolwarm_r"]),
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
    assert!(picture(&["--color-by", "charge"]) == pictures[1], "an alias");
    let blue = ["--type", "C:color=blue", "--type", "O:radius=0.5"];
    assert!(picture(&blue) == pictures[12], "a color by name");
}

#[test]
fn type_options_override_presets() {
    let materials = ["plastic", "metal", "glass", "mirror", "emitter"];
    for preset in ["chalk", "studio", "cloudy", "glossy", "depthcue", "outline", "ghost", "x-ray"] {
        let look = |typed: &str| picture(&["--preset", preset, "--type", typed]);
        let mut pictures = vec![picture(&["--preset", preset])];
        for typed in materials.map(|name| format!("O:material={name}")) {
            pictures.push(look(&typed));
        }
        pictures.push(look("O:color=#0000ff"));
        pictures.push(look("O:radius=0.5"));
        for (place, picture) in pictures.iter().enumerate() {
            assert!(!pictures[..place].contains(picture), "{preset} {place}");
        }
        let colored = ["--preset", preset, "--color-by", "q", "--type", "O:material=glass"];
        assert!(picture(&colored) != picture(&colored[..4]), "{preset}");
    }
}

#[test]
fn material_columns_override_presets() {
    let folder = folder();
    folder.write("clay.csv", "x,y,z\n0,0,0\n3,0,0\n");
    folder.write("made.csv", "x,y,z,kind\n0,0,0,\n3,0,0,Glass\n");
    for preset in [&["--radii", "1"][..], &["--radii", "1", "--preset", "studio"]] {
        let clay = folder.picture("a.ppm", &[&["clay.csv"], preset].concat());
        let made = ["made.csv", "--columns", "material=kind"];
        assert!(clay != folder.picture("a.ppm", &[&made, preset].concat()), "{preset:?}");
    }
    folder.write("odd.csv", "x,y,z,material\n0,0,0,oak\n3,0,0,glass\n");
    let output = folder.run(&["render", "odd.csv", "--size", "9x9", "--spp", "1"]);
    let stderr = text(&output.stderr);
    assert!(output.status.success() && stderr.contains("oak"), "{stderr}");
    assert!(!stderr.contains("glass, oak") && !stderr.contains("oak, glass"), "{stderr}");
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
    assert!(bar.contains(">q</text>") && bar.contains(">4</text>"), "{bar}");
    // Exposure and tone curve do not affect it.
    let args = ["dust.csv", "--color-by", "q", "--color-bar", "b.svg", "--exposure", "2"];
    folder.picture("dust.ppm", &args);
    assert_eq!(text(&folder.read("b.svg")), bar);
}

#[test]
fn titles_have_subscripts_and_percentiles_arrows() {
    let folder = folder();
    let bar = |options: &[&str]| {
        let args = ["dust.csv", "--color-by", "q", "--color-bar", "b.svg"];
        folder.picture("dust.ppm", &[&args[..], options].concat());
        text(&folder.read("b.svg"))
    };
    let shapes = |svg: &str| svg.matches("<path").count() + svg.matches("<polygon").count();
    let plain = bar(&[]);
    let titled = bar(&["--color-title", "v_{max} (m/s)"]);
    for part in [">v</text>", ">max</text>", "> (m/s)</text>"] {
        assert!(titled.contains(part), "{titled}");
    }
    // -1, 0 and 4: the middle of -1 and 0, and of 0 and 4.
    let robust = bar(&["--color-range", "25%,75%"]);
    assert_eq!(robust, bar(&["--color-range", "-0.5,2"]));
    assert_eq!(shapes(&robust), shapes(&plain) + 2, "{robust}");
    assert_eq!(bar(&["--color-range", "0%,auto"]), plain);
}

#[test]
fn invalid_looks_are_refused() {
    let folder = folder();
    for (args, code, message) in [
        (&["a.toml", "--colors", "cpk"][..], 2, "a scene"),
        (&["--color-by", "q"], 2, "particle file"),
        (&["dust.csv", "--color-map", "magma"], 2, "--color-by"),
        (&["dust.csv", "--color-by", "q", "--color-map", "jet"], 2, "viridis"),
        (&["dust.csv", "--color-by", "q", "--color-map", "virdis_r"], 2, "viridis"),
        (&["dust.csv", "--color-by", "elment"], 1, "did you mean `element`"),
        (&["dust.csv", "--type", "c:radius=1"], 1, "did you mean `C`"),
        (&["dust.csv", "--color-by", "q", "--color-range", "1"], 2, "the lower one first"),
        (&["dust.csv", "--color-by", "q", "--color-range", "2%,101%"], 2, "the lower one first"),
        (&["dust.csv", "--color-title", "a"], 2, "--color-by"),
        (&["dust.csv", "--color-by", "q / 3", "--color-map", "categories"], 1, "are integers"),
        (
            &["dust.csv", "--color-by", "q", "--color-map", "categories", "--color-log"],
            1,
            "`q` is colored by categories",
        ),
        (&["dust.csv", "--color-by", "q", "--colors", "cpk"], 2, "cannot be used with"),
        (&["dust.csv", "--color-by", "q", "--color-bar", "bar.exr"], 2, ".svg or .pdf"),
        (&["dust.csv", "--color-by", "note", "--color-bar", "bar.png"], 2, "a numeric column"),
        (&["dust.csv", "--color-by", "q", "--color-bar", "no/bar.png"], 1, "cannot be written"),
        (&["dust.csv", "--select", "z > "], 2, "name here z > ^"),
        (&["dust.csv", "--select", "mass > 1"], 1, "--> selection:1:1 | 1 | mass > 1 | ^^^^"),
        (&["dust.csv", "--select", "x > 9"], 1, "none of its 3 particles"),
        (&["dust.csv", "--type", "C:material=wood"], 2, "materials are: lambertian"),
        (&["dust.csv", "--type", "Fe:radius=1"], 1, "`Fe`; there are C, O, H"),
        (&["dust.csv", "--color-by", "mass"], 1, "there are id, element, x, y, z, q, note, radius"),
        (&["dust.csv", "--color-by", "note", "--color-log"], 1, "`note` holds texts"),
    ] {
        let output = folder.run(&[&["render", "--spp", "1", "-o", "x.ppm"], args].concat());
        let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
        assert!(stderr.contains(message), "{args:?}: {stderr}");
        assert!(!folder.path("x.ppm").exists(), "{args:?}");
    }
}

#[test]
fn options_without_effect_on_particles_are_named() {
    let folder = Folder::new();
    folder.write("a.csv", "x,y,z,radius,q\n0,0,0,0.5,1\n1,0,0,0.5,2\n");
    let cases = [
        ("--smooth", "3"),
        ("--trail", "3"),
        ("--slice", "z>1e9"),
        ("--translucent", "q > 9"),
        ("--bond-radius", "0.1"),
    ];
    for (option, value) in cases {
        let line = ["render", "a.csv", "--size", "8x6", "--spp", "1", "-o", "a.ppm", option, value];
        let output = folder.run(&line);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(stderr.contains(&format!("{option} has no effect")), "{option}: {stderr}");
    }
}

const COMPLEX: &str = "\
ATOM      1  CA  GLY A   1       0.000   0.000   0.000  1.00  0.00           C
ATOM      2  C   GLY A   1       1.500   0.000   0.000  1.00  1.00           C
ATOM      3  CB  ALA B   2       3.000   0.000   0.000  1.00  2.00           C
HETATM    4  C1  LIG C   1       0.000   5.000   0.000  1.00  3.00           C
HETATM    5  O1  LIG C   1       1.300   5.000   0.000  1.00  4.00           O
HETATM    6  O   HOH D   1       0.000   0.000   5.000  1.00  5.00           O
";

#[test]
fn selections_have_styles_of_their_own() {
    let folder = Folder::new();
    folder.write("a.pdb", COMPLEX);
    let picture = |args: &[&str]| {
        folder.picture("a.ppm", &[&["a.pdb"], args].concat());
        Image::read(folder.path("a.ppm")).expect("a picture")
    };
    let ligand = ["--style", "ligand: model=ball-and-stick color=magenta"];
    let pictures = [
        picture(&[]),
        picture(&ligand),
        picture(&[&ligand[..], &["--hide", "water"]].concat()),
        picture(&[&ligand[..], &["--style", "protein: opacity=0.3"]].concat()),
        picture(&[&ligand[..], &["--color-by", "chain", "--legend", "right"]].concat()),
        picture(&["--style", "protein: color=bfactor map=turbo", "--style", "all: scale=0.8"]),
    ];
    for (place, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..place].contains(picture), "{place}");
    }
    assert!(picture(&["--hide", "water"]) == picture(&["--style", "water: visible=no"]));
    assert!(picture(&["--hide", "water"]) == picture(&["--select", "not water"]));
    assert!(picture(&["--type", "O1:color=red"]) == picture(&["--style", "name O1: color=red"]));
    folder.write("scene.toml", "[[file]]\npath = \"a.pdb\"\n[[style]]\nselect = \"ligandd\"\n");
    for (file, style, message) in [
        ("a.pdb", "ligand color=red", "expected a selection"),
        ("a.pdb", "ligand: colr=red", "did you mean `color`"),
        ("a.pdb", "resname ATP: color=red", "none of its 6 particles is styled"),
        ("a.pdb", "ligandd: color=red", "did you mean `ligand`"),
        ("scene.toml", "all: color=red", "need a particle file"),
    ] {
        let line = ["render", file, "--spp", "1", "-o", "x.ppm", "--style", style];
        let output = folder.run(&line);
        assert!(!output.status.success(), "{style}");
        let stderr = text(&output.stderr);
        assert!(stderr.contains(message), "{style}: {stderr}");
        assert!(!folder.path("x.ppm").exists(), "{style}");
    }
}

#[test]
fn films_have_one_range_for_the_numbers_of_a_style() {
    let folder = Folder::new();
    let frame = |charges: [f64; 2]| {
        let [a, b] = charges;
        format!("2\nProperties=species:S:1:pos:R:3:q:R:1\nC 0 0 0 {a}\nO 3 0 0 {b}\n")
    };
    let empty = "0\nProperties=species:S:1:pos:R:3:q:R:1\n";
    folder.write("a.xyz", &format!("{}{empty}{}", frame([0.0, 1.0]), frame([2.0, 4.0])));
    let style = ["--style", "all: color=q map=turbo"];
    let size = ["--size", "32x24", "--spp", "2", "--quiet"];
    let line = ["render", "a.xyz", "--frame", "all", "-o", "film.ppm"];
    assert!(folder.run(&[&line[..], &size, &style].concat()).status.success());
    let last = Image::read(folder.path("film-0002.ppm")).expect("the last frame");
    let ranged = ["--style", "all: color=q map=turbo range=0,4"];
    assert!(folder.run(&[&line[..], &size, &ranged].concat()).status.success());
    assert!(last == Image::read(folder.path("film-0002.ppm")).expect("the last frame"));
    let none = folder.run(&[&line[..], &size, &["--style", "element N: color=red"]].concat());
    assert!(text(&none.stderr).contains("no particle of a frame is styled"));
}
