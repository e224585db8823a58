//! Annotations of images, pages with vectors, and the lens of particle files.

use crate::figures::codes;
use crate::folder::{Folder, text};
use spherule_render::Scene;
use spherule_render::image::{Image, read_metadata};
use spherule_render::scene::Anchor;

/// Two frames of three atoms, with a header.
const ATOMS: &str = "\
3
Lattice=\"4 0 0 1 4 0 0 0 4\" Properties=species:S:1:pos:R:3:q:R:1 energy=-7.25 Time=0.5 Step=10
C 0 0 0 1
C 1 0 0 2
O 2 0 0 4
3
Lattice=\"4 0 0 1 4 0 0 0 4\" Properties=species:S:1:pos:R:3:q:R:1 energy=-8 Time=1.5 Step=20
N 0 0 0 1
C 1 0 0 2
O 2 3 0 4
";

const FIXED: &str = "render a.xyz --radii 0.5 --size 320x240 --quiet --spp 1";

/// More samples, without grain.
const SMOOTH: &str = "render a.xyz --radii 0.5 --size 160x120 --quiet --spp 64";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.xyz", ATOMS);
    folder
}

fn render(folder: &Folder, args: &[&str]) {
    let fixed: Vec<&str> = FIXED.split(' ').collect();
    folder.succeed(&[&fixed[..], args].concat());
}

fn refusal(folder: &Folder, args: &[&str]) -> String {
    let fixed: Vec<&str> = FIXED.split(' ').collect();
    let output = folder.run(&[&fixed[..], args].concat());
    assert!(!output.status.success(), "{args:?}");
    text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the texts of an SVG file.
fn texts(folder: &Folder, name: &str) -> Vec<String> {
    let svg = text(&folder.read(name));
    let lines = svg.lines().filter(|line| line.starts_with("<text"));
    let content = |line: &str| Some(line.split_once('>')?.1.strip_suffix("</text>")?.to_owned());
    lines.filter_map(content).collect()
}

#[test]
fn every_annotation_is_drawn_clear_of_the_particles() {
    let folder = folder();
    for (annotation, right, bottom) in [
        ("--legend", true, false),
        ("--axes", false, true),
        ("--axes=cell", false, true),
        ("--scale-bar", true, true),
        ("--label=text", false, false),
        ("--legend=bottom-left", false, true),
    ] {
        render(&folder, &[annotation, "--background", "transparent", "-o", "a.png"]);
        let drawn = codes(&folder, "a.png");
        let column = |x: usize| if right { 319 - x } else { x };
        let row = |y: usize| if bottom { 239 - y } else { y };
        let corner = (0..40).flat_map(|y| (0..50).map(move |x| (x, y)));
        let ink = corner.filter(|&(x, y)| drawn[row(y) * 320 + column(x)][3] > 100).count();
        assert!(ink > 20, "{annotation}: {ink}");
        render(&folder, &[annotation, "-o", "a.svg"]);
        assert!(!text(&folder.read("a.svg")).contains("fill-opacity"), "{annotation}");
    }
    for (position, _) in Anchor::ALL {
        let bar = ["--color-by", "q", "--color-bar", position, "-o", "b.svg"];
        render(&folder, &bar);
        // No panel: nothing covers a particle.
        assert!(!text(&folder.read("b.svg")).contains("fill-opacity"), "{position}");
        assert_eq!(texts(&folder, "b.svg").last().map(String::as_str), Some("q"), "{position}");
    }
}

#[test]
fn labels_have_the_values_of_their_frame() {
    let folder = folder();
    let label = "{file} {time:.2} {step} {frame} {particles} {energy} {{}}";
    render(&folder, &["--label", label, "--label", "bottom:a\\nb", "-o", "a.svg"]);
    let expected = ["a.xyz 0.50 10 0 3 -7.25 {}", "a", "b"];
    assert_eq!(texts(&folder, "a.svg"), expected);
    render(&folder, &["--label", label, "--frame", "last", "-o", "b.svg"]);
    assert_eq!(texts(&folder, "b.svg"), ["a.xyz 1.50 20 1 3 -8 {}"]);
    let frames = ["--frame", "all", "--legend", "--label", "{frame}: {time}"];
    render(&folder, &[&frames[..], &["-o", "c.svg"]].concat());
    assert_eq!(texts(&folder, "c-0000.svg"), ["0: 0.5", "C", "N", "O"]);
    assert_eq!(texts(&folder, "c-0001.svg"), ["1: 1.5", "C", "N", "O"]);
}

#[test]
fn measures_and_labels_at_particles_have_the_values_of_their_frame() {
    let folder = folder();
    let sorted = |name: &str| {
        let mut texts = texts(&folder, name);
        texts.sort();
        texts
    };
    let measures = ["--measure", "0-1", "--measure", "0-1-2", "--measure", "0-2:periodic"];
    render(&folder, &[&measures[..], &["--frame", "all", "-o", "a.svg"]].concat());
    assert_eq!(sorted("a-0000.svg"), ["1.00\u{a0}\u{c5}", "180.0\u{b0}", "2.00\u{a0}\u{c5}"]);
    assert_eq!(sorted("a-0001.svg"), ["1.00\u{a0}\u{c5}", "1.41\u{a0}\u{c5}", "108.4\u{b0}"]);
    let label = "type C or q > 3: {element}{id} {q:.1} {energy}";
    render(&folder, &["--label", label, "--select", "x > 0.5", "-o", "b.svg"]);
    assert_eq!(sorted("b.svg"), ["C1 2.0 -7.25", "O2 4.0 -7.25"]);
    // What is cut away has no label, and what is not drawn no measure.
    render(&folder, &["--label", label, "--slice", "x > 1.5", "-o", "c.svg"]);
    assert_eq!(sorted("c.svg"), ["C0 1.0 -7.25", "C1 2.0 -7.25"]);
    let error = refusal(&folder, &["--measure", "0-1", "--select", "x > 0.5"]);
    assert!(error.contains("no particle that is drawn has the id 0"), "{error}");
}

#[test]
fn legends_and_scale_bars_follow_from_the_file() {
    let folder = folder();
    render(&folder, &["--legend", "--scale-bar", "-o", "a.svg"]);
    assert_eq!(texts(&folder, "a.svg"), ["C", "O", "0.5\u{a0}\u{c5}"]);
    render(
        &folder,
        &["--color-by", "species", "--legend=left", "--scale-bar=1.5:top", "-o", "b.svg"],
    );
    assert_eq!(texts(&folder, "b.svg"), ["1.5\u{a0}\u{c5}", "species", "C", "O"]);
    render(&folder, &["--type", "O:color=#123456", "--legend", "--axes=cell", "-o", "c.svg"]);
    assert!(text(&folder.read("c.svg")).contains("#123456"));
    let mut names = texts(&folder, "c.svg");
    names.sort();
    assert_eq!(names, ["C", "O", "a", "b", "c"]);
}

#[test]
fn pages_hold_the_image_and_its_metadata() {
    let folder = folder();
    let args = ["--scale-bar", "--text-size", "0.05", "--text-color", "#ff0000"];
    render(&folder, &[&args[..], &["-o", "a.pdf"]].concat());
    let pdf = folder.read("a.pdf");
    assert!(pdf.starts_with(b"%PDF-"));
    let has = |word: &str| pdf.windows(word.len()).any(|part| part == word.as_bytes());
    assert!(has("FontFile2") && has("/text_size (0.05)") && has("/scale_bar"));
    render(&folder, &[&args[..], &["-o", "a.svg"]].concat());
    let svg = text(&folder.read("a.svg"));
    assert!(svg.contains("fill=\"#ff0000\"") && svg.contains("font-size=\"12\""));
    assert!(svg.contains("text_color: #ff0000") && svg.contains("data:image/png;base64,"));
    render(&folder, &[&args[..], &["-o", "a.png"]].concat());
    let metadata = read_metadata(folder.path("a.png")).expect("metadata");
    assert_eq!(metadata.value("text_color"), Some("#ff0000"));
    assert_eq!(metadata.value("scale_bar"), Some("bottom-right"));
    // An explicit format applies to images, whatever their names.
    render(&folder, &["--output-format", "png", "-o", "b.pdf"]);
    assert!(folder.read("b.pdf").starts_with(b"\x89PNG"));
}

/// Returns the bytes after a word of a file.
fn after(folder: &Folder, name: &str, word: &[u8]) -> Vec<u8> {
    let bytes = folder.read(name);
    let at = bytes.windows(word.len()).position(|part| part == word).expect("it is there");
    bytes[at + word.len()..].to_vec()
}

#[test]
fn figures_have_their_size_on_paper() {
    let folder = folder();
    let picture = |name: &str, args: &[&str]| {
        let fixed = ["a.xyz", "--radii", "0.5", "--spp", "1", "--quiet", "-o", name];
        folder.succeed(&[&fixed[..], args].concat());
    };
    // 30 mm at 254 pixels per inch are 300 pixels, in the usual aspect.
    picture("a.png", &["--size", "30mm", "--dpi", "254"]);
    let image = Image::read(folder.path("a.png")).expect("a picture");
    assert_eq!((image.width, image.height), (300, 225));
    assert_eq!(after(&folder, "a.png", b"pHYs")[..4], 10_000_u32.to_be_bytes());
    let metadata = read_metadata(folder.path("a.png")).expect("metadata");
    assert_eq!(metadata.value("dpi"), Some("254"));
    picture("a.jpg", &["--size", "1cmx5mm"]);
    assert_eq!(after(&folder, "a.jpg", b"JFIF\0")[2..5], [1, 1, 44]);
    let image = Image::read(folder.path("a.jpg")).expect("a picture");
    assert_eq!((image.width, image.height), (118, 59));
    // Letters of 7 points at 144 pixels per inch.
    let bar = ["--color-by", "q", "--color-bar", "right", "--size", "5inx4in", "--dpi", "144"];
    picture("a.svg", &bar);
    let svg = text(&folder.read("a.svg"));
    assert!(svg.contains("width=\"127mm\" height=\"101.6mm\" viewBox=\"0 0 720 576\""));
    assert!(svg.contains("font-size=\"14\""), "{svg}");
    picture("a.pdf", &bar);
    assert!(after(&folder, "a.pdf", b"/MediaBox [").starts_with(b"0 0 360 288]"));
    let size = ["--size", "400x300", "--scale-bar", "top", "--text-size"];
    for (letters, expected) in [("6pt", "25"), ("2.54mm", "30"), ("5%", "15")] {
        picture("b.svg", &[&size[..], &[letters]].concat());
        let svg = text(&folder.read("b.svg"));
        assert!(svg.contains(&format!("font-size=\"{expected}\"")), "{letters}: {svg}");
        // Letters on paper give the image a resolution.
        assert_eq!(svg.contains("width=\"33.867mm\""), letters != "5%", "{letters}");
    }
    // A bar in a file is as the image is.
    let file = ["--color-by", "q", "--color-bar", "c.svg", "--size", "2inx2in", "--dpi", "144"];
    picture("c.png", &file);
    let svg = text(&folder.read("c.svg"));
    assert!(svg.contains("font-size=\"14\"") && svg.contains("mm\" height"), "{svg}");
}

#[test]
fn lengths_of_scenes_follow_the_resolution() {
    let folder = folder();
    let scene = "[render]\nsize = \"2inx1in\"\ndpi = 100\n[lettering]\nsize = \"9pt\"\n[[label]]\ntext = \"a\"\n\
                 [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    folder.write("a.toml", scene);
    let drawn = |args: &[&str]| {
        let fixed = ["a.toml", "--spp", "1", "--quiet", "-o", "a.svg"];
        folder.succeed(&[&fixed[..], args].concat());
        text(&folder.read("a.svg"))
    };
    for (dpi, args) in [(100.0, &[][..]), (200.0, &["--dpi", "200"])] {
        let (svg, width) = (drawn(args), 2.0 * dpi);
        assert!(svg.contains(&format!(
            "width=\"50.8mm\" height=\"25.4mm\" viewBox=\"0 0 {width} {dpi}\""
        )));
        assert!(svg.contains(&format!("font-size=\"{}\"", dpi / 8.0)), "{svg}");
    }
    // Of the scene's size, a width keeps the aspect.
    assert!(drawn(&["--size", "1in"]).contains("viewBox=\"0 0 100 50\""));
    assert!(drawn(&["--size", "90x60"]).contains("viewBox=\"0 0 90 60\""));
    for (line, message) in
        [("size = \"2\"", "85mm"), ("dpi = 0", "65535"), ("dpi = 1.5", "integer")]
    {
        folder.write("b.toml", &format!("[render]\n{line}\n"));
        let error = text(&folder.run(&["b.toml"]).stderr);
        assert!(error.contains("b.toml:2") && error.contains(message), "{error}");
    }
}

#[test]
fn positions_follow_a_space_and_shares_are_percentages() {
    let folder = folder();
    let spaced = ["--legend", "left", "--axes", "cell", "--scale-bar", "0.5", "--opacity", "30%"];
    render(&folder, &[&spaced[..], &["-o", "a.pfm"]].concat());
    let joined = ["--legend=left", "--axes=cell", "--scale-bar=0.5", "--opacity=0.3"];
    render(&folder, &[&joined[..], &["-o", "b.pfm"]].concat());
    assert!(folder.read("a.pfm") == folder.read("b.pfm"));
}

#[test]
fn scenes_have_annotations_too() {
    let folder = folder();
    let scene = "[camera]\neye = [1, 0, 1.5]\ntarget = [1, 0, 0]\n[[file]]\npath = \"a.xyz\"\n\
                 radius = 0.9\n[[label]]\ntext = \"{own}\"\nposition = \"left\"\n[axes]\n";
    folder.write("a.toml", scene);
    let args = ["a.toml", "--size", "320x240", "--spp", "1", "--quiet"];
    let more = ["--label", "{particles}", "-o", "a.svg"];
    folder.succeed(&[&args[..], &more].concat());
    let svg = text(&folder.read("a.svg"));
    // The camera is in the middle of the spheres.
    assert!(svg.contains("fill-opacity"), "a panel");
    assert!(svg.contains(">{own}</text>") && svg.contains(">3</text>"));
    let error = text(&folder.run(&["a.toml", "--legend"]).stderr);
    assert!(error.contains("--legend needs a particle file"), "{error}");
    let error = text(&folder.run(&["a.toml", "--label", "{time}"]).stderr);
    assert!(error.contains("only particle files have it"), "{error}");
}

#[test]
fn saved_scenes_keep_their_annotations() {
    let folder = folder();
    folder.write("s.txt", "save b.toml\nsave b.png\n");
    let args = ["view", "a.xyz", "--radii", "0.5", "--size", "320x240", "--spp", "1", "--quiet"];
    let more =
        ["--headless-script", "s.txt", "--axes", "--scale-bar", "--legend", "--label", "{step}"];
    folder.succeed(&[&args[..], &more].concat());
    let scene = Scene::load(&folder.path("b.toml")).expect("a scene");
    let annotations = &scene.annotations;
    assert_eq!(annotations.labels[0].text, "10");
    assert_eq!(annotations.scale_bar.as_ref().map(|bar| bar.unit.as_str()), Some("\u{c5}"));
    assert_eq!(annotations.legend.as_ref().map(|legend| legend.entries.len()), Some(2));
    assert!(annotations.axes.is_some());
    folder.succeed(&["b.toml", "--spp", "1", "--quiet", "-o", "c.png"]);
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert_eq!(read("b.png"), read("c.png"));
}

#[test]
fn lenses_blur_what_is_not_in_focus() {
    let folder = folder();
    let contrast = |args: &[&str]| {
        let fixed: Vec<&str> = SMOOTH.split(' ').collect();
        let view = ["--view", "x", "--background", "black", "-o", "a.png"];
        folder.succeed(&[&fixed[..], &view, args].concat());
        let image = Image::read(folder.path("a.png")).expect("a picture");
        let steps = image.pixels.windows(2).map(|pair| (pair[0][0] - pair[1][0]).abs());
        steps.fold(0.0, f32::max)
    };
    let sharp = contrast(&[]);
    assert!(contrast(&["--aperture", "0"]) == sharp);
    let near = contrast(&["--aperture", "1", "--focus", "id:2"]);
    let far = contrast(&["--aperture", "1", "--focus", "100"]);
    assert!(far < near && far < 0.7 * sharp, "{sharp} {near} {far}");
    let parallel = ["--projection", "orthographic", "--aperture", "1", "--focus"];
    let near = contrast(&[&parallel[..], &["id:2"]].concat());
    let far = contrast(&[&parallel[..], &["100"]].concat());
    assert!(far < near, "{near} {far}");
    render(&folder, &["--frame", "all", "--aperture", "0.1", "--focus", "id:2", "-o", "b.png"]);
    let metadata = read_metadata(folder.path("b-0001.png")).expect("metadata");
    assert_eq!(metadata.value("aperture"), Some("0.1"));
    assert_eq!(metadata.value("focus"), Some("id:2"));
}

#[test]
fn mistakes_are_reported() {
    let folder = folder();
    for (args, message) in [
        (&["--legend=middle"][..], "positions are"),
        (&["--axes=lefft"], "left"),
        (&["--scale-bar=-1"], "greater than 0"),
        (&["--label", "{tme}"], "did you mean `time`?"),
        (&["--label", "{time"], "not closed"),
        (&["--text-size", "2"], "0.005 to 0.2"),
        (&["--text-size", "7px"], "7pt"),
        (&["--legend", "topleft"], "`top-left`"),
        (&["--text-color", "blak"], "black"),
        (&["--color-by", "q", "--legend"], "use --color-bar"),
        (&["--label", "a", "--region", "0,0,8x8"], "need the whole image"),
        (&["-o", "a.pdf", "--layers", "all"], "cannot store --layers"),
        (&["-o", "a.svg", "--skip-existing"], "--skip-existing"),
        (&["-o", "a.svg", "--part", "1/2"], "parts of an image"),
        (&["--aperture", "-1"], "0 or more"),
        (&["--measure", "1"], "two to four"),
        (&["--measure", "1-1"], "follows itself"),
        (&["--measure", "0-1:near"], ":periodic"),
        (&["--measure", "0-7"], "--measure 0-7: no particle that is drawn has the id 7"),
        (&["--label", "type C: {nam}"], "element, id, index"),
        (&["--label", "type H: {id}"], "none of its 3 particles is labeled"),
        (&["--focus", "far"], "id:1234"),
        (&["--focus", "3"], "add --aperture"),
        (&["--aperture", "1", "--focus", "id:77"], "no particle that is drawn has the id 77"),
    ] {
        let error = refusal(&folder, args);
        assert!(error.contains(message), "{args:?}: {error}");
    }
    folder.write("b.csv", "x,y,z,red,green,blue\n0,0,0,1,0,0\n1,0,0,0,1,0\n");
    for (args, message) in [
        (&["--legend"][..], "--legend needs a particle file whose colors"),
        (&["--axes=cell"], "with a cell"),
        (&["--label", "{step}"], "the file has no steps"),
        (&["--measure", "0-1:periodic"], "no periodic cell"),
        (&["--text-size", "0.1", "--spp", "1"], "--text-size has no effect"),
    ] {
        let output = folder.run(&[&["render", "b.csv", "--size", "40x24"], args].concat());
        let error = text(&output.stderr);
        assert!(error.contains(message), "{args:?}: {error}");
    }
}
