//! Images for figures: transparent background, color bar inside, and metadata.

use crate::folder::{Folder, SMALL, text};
use flate2::read::ZlibDecoder;
use spherule_render::image::{Image, read_metadata};
use std::fs::File;
use std::io::{BufReader, Read};

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

/// Returns the bytes of a text in Base64, decompressed if they are.
fn unpacked(text: &str) -> Vec<u8> {
    let digits = text.bytes().map(|letter| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    });
    let digits: Vec<u8> = digits.collect();
    let four = |four: &[u8]| four.iter().fold(0, |word, digit| word << 6 | u32::from(*digit));
    let bytes: Vec<u8> = digits
        .chunks_exact(4)
        .flat_map(|digits| four(digits).to_be_bytes()[1..].to_vec())
        .collect();
    let mut found = Vec::new();
    match ZlibDecoder::new(&bytes[..]).read_to_end(&mut found) {
        Ok(_) => found,
        Err(_) => bytes,
    }
}

/// Returns what is between two parts of a page, wherever it is.
fn between<'p>(page: &'p str, first: &str, last: &str) -> Vec<&'p str> {
    page.split(first).skip(1).filter_map(|rest| Some(rest.split_once(last)?.0)).collect()
}

#[test]
fn pages_name_the_particles_that_they_show() {
    let folder = folder();
    picture(&folder, &["-o", "a.html"]);
    let page = text(&folder.read("a.html"));
    assert!(!page.contains("http:") && !page.contains("https:"), "it needs nothing else");
    let texts =
        String::from_utf8(unpacked(between(&page, "id=\"texts\">", "<")[0])).expect("texts");
    let texts: Vec<&str> = texts.lines().collect();
    for (row, (kind, charge)) in [("C", "q = 1"), ("C", "q = 2"), ("O", "q = 4")].iter().enumerate()
    {
        let named = format!("type {kind}, at {row} 0 0");
        let found = texts.iter().any(|text| text.contains(&named) && text.contains(charge));
        assert!(found, "{named}: {texts:?}");
    }
    let [numbers] = between(&page, "data-numbers=\"", "\"")[..] else { panic!("one image") };
    let (numbers, width) = (unpacked(numbers), 40);
    let mut numbers: Vec<u8> = numbers;
    for at in width..numbers.len() {
        numbers[at] ^= numbers[at - width];
    }
    let row = || {
        numbers[12 * width..13 * width]
            .iter()
            .map(|number| *number as usize)
            .filter(|&number| number > 0)
    };
    let (left, right) = (row().next().expect("a sphere"), row().next_back().expect("a sphere"));
    assert!(texts[left - 1].contains("type C, at 0 0 0"), "{left}");
    assert!(texts[right - 1].contains("type O, at 2 0 0"), "{right}");
    assert_eq!(numbers[0], 0);
    picture(&folder, &["-o", "b.png"]);
    let [file] = between(&page, "data:image/png;base64,", "\"")[..] else { panic!("a PNG file") };
    let png = unpacked(file);
    std::fs::write(folder.path("c.png"), &png).expect("a file");
    let read = |name: &str| Image::read(folder.path(name)).expect("an image");
    assert!(read("b.png") == read("c.png"));
}

#[test]
fn pages_turn_their_images() {
    let folder = folder();
    picture(&folder, &["--turntable", "5", "-o", "a.html"]);
    let page = text(&folder.read("a.html"));
    assert_eq!(between(&page, "data:image/jpeg;base64,", "\"").len(), 5);
    assert!(page.contains("max=\"4\"") && page.contains("TURNS = true"));
    for (args, word) in
        [("--layers id", "--layers"), ("--skip-existing", "--skip"), ("--fps 3", "--fps")]
    {
        let line = format!("render a.xyz -o b.html {args}");
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(word), "{line}");
    }
}
