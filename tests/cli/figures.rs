//! Images for figures: transparent background, color bar inside, and metadata.

use crate::folder::{Folder, SMALL, text};
use spherule_render::image::{Image, read_metadata};
use std::fs::File;
use std::io::BufReader;

/// Three spheres in a row, with a column of numbers.
const ATOMS: &str = "\
3
Properties=species:S:1:pos:R:3:q:R:1
C 0 0 0 1
C 1 0 0 2
O 2 0 0 4
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.xyz", ATOMS);
    folder
}

fn picture(folder: &Folder, args: &[&str]) {
    folder.succeed(&[&SMALL[..], &["a.xyz", "--radii", "0.5", "--view", "z"], args].concat());
}

/// Returns red, green, blue and alpha of each pixel of a PNG file.
pub(crate) fn codes(folder: &Folder, name: &str) -> Vec<[u8; 4]> {
    let file = BufReader::new(File::open(folder.path(name)).expect("a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a header");
    let mut codes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut codes).expect("pixels");
    codes.as_chunks().0.to_vec()
}

#[test]
fn transparent_pictures_have_no_sky_and_keep_shadows() {
    let folder = folder();
    picture(&folder, &["--background", "transparent", "-o", "a.png"]);
    let plain = codes(&folder, "a.png");
    assert_eq!(plain.len(), 40 * 24);
    // The margin is empty, the center opaque, and no pixel is brighter than white spheres.
    assert_eq!((plain[0], plain[12 * 40 + 20][3]), ([0; 4], 255));
    picture(&folder, &["--background", "transparent", "--preset", "studio", "-o", "b.png"]);
    let studio = codes(&folder, "b.png");
    let is_translucent = |pixel: &&[u8; 4]| pixel[..3] == [0; 3] && (10..250).contains(&pixel[3]);
    let count_translucent = |codes: &[[u8; 4]]| codes.iter().filter(is_translucent).count();
    assert!(count_translucent(&studio) > count_translucent(&plain) + 20, "shadows on the ground");
    picture(&folder, &["--background", "transparent", "-o", "c.exr"]);
    let linear = Image::read(folder.path("c.exr")).expect("a picture");
    assert_eq!(linear.pixel(0, 0), Some([0.0; 3]));
    for look in ["depthcue", "outline", "chalk"] {
        picture(&folder, &["--background", "transparent", "--preset", look, "-o", "d.png"]);
        let codes = codes(&folder, "d.png");
        assert_eq!((codes[0][3], codes[12 * 40 + 20][3]), (0, 255), "{look}");
    }
}

#[test]
fn color_bars_are_drawn_in_their_corner() {
    let folder = folder();
    let fixed = "render a.xyz --radii 0.5 --view z --color-by q --size 240x400 --spp 1 --quiet";
    let fixed: Vec<&str> = fixed.split(' ').collect();
    let render = |args: &[&str]| folder.succeed(&[&fixed[..], args].concat());
    for (place, corner) in [
        ("inside", [true, true]),
        ("inside:bottom-right", [true, true]),
        ("bottom-left", [false, true]),
        ("inside:top-right", [true, false]),
        ("top-left", [false, false]),
    ] {
        render(&["--color-bar", place, "-o", "b.svg"]);
        let svg = text(&folder.read("b.svg"));
        let lines: Vec<&str> = svg.lines().filter(|line| line.starts_with("<text")).collect();
        assert!(lines.len() > 3, "{place}");
        for line in lines {
            let number = |key: &str| -> f64 {
                let value = line.split_once(key).and_then(|(_, rest)| rest.split('"').next());
                value.expect("a position").parse().expect("a number")
            };
            let found = [number("x=\"") >= 120.0, number("y=\"") >= 200.0];
            assert_eq!(found, corner, "{place}");
        }
    }
    render(&["--color-bar", "inside", "--background", "transparent", "-o", "c.png"]);
    let opaque =
        codes(&folder, "c.png").iter().skip(200 * 240).filter(|code| code[3] == 255).count();
    assert!(opaque > 300, "the bar is not transparent");
}

#[test]
fn metadata_has_the_appearance_of_particles() {
    let folder = folder();
    let looks = ["--color-by", "q", "--color-log", "--select", "q > 0.5", "--type", "O:radius=0.7"];
    picture(&folder, &[&looks[..], &["--slice", "z > 3", "-o", "a.png"]].concat());
    let metadata = read_metadata(folder.path("a.png")).expect("metadata");
    for (name, value) in [
        ("color_by", "q"),
        ("color_map", "viridis"),
        ("color_range", "1,4"),
        ("color_log", "true"),
        ("select", "q > 0.5"),
        ("type", "O:radius=0.7"),
        ("radii", "0.5"),
        ("slice", "z > 3"),
        ("slice_mode", "remove"),
        ("view", "z"),
    ] {
        assert_eq!(metadata.value(name), Some(value), "{name}");
    }
    picture(&folder, &["--colors", "cpk", "--radius-scale", "2", "--frame", "all", "-o", "b.png"]);
    let metadata = read_metadata(folder.path("b-0000.png")).expect("metadata");
    for (name, value) in [("colors", "cpk"), ("radius_scale", "2.0"), ("frame", "0")] {
        assert_eq!(metadata.value(name), Some(value), "{name}");
    }
    assert_eq!(metadata.value("select"), None);
}

#[test]
fn invalid_figures_are_refused() {
    let folder = folder();
    for (args, message) in [
        (&["--background", "transparent", "-o", "a.ppm"][..], "an --output that ends in .png"),
        (&["--background", "clear"], "transparent or sky"),
        (&["--color-by", "q", "--color-bar", "inside:middle"], "top-left"),
        (&["--color-by", "q", "--color-bar", "inside", "--region", "0,0,8x8"], "whole image"),
        (&["--color-by", "species", "--color-bar", "inside"], "a numeric column"),
    ] {
        let output = folder.run(&[&SMALL[..], &["a.xyz"], args].concat());
        let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
        assert!(stderr.contains(message), "{args:?}: {stderr}");
    }
}
