//! Periodic cells, views and turntables on the command line.

use crate::folder::{Folder, SMALL, text};
use spherule_render::image::Image;

/// Two particles, one of them outside its tilted cell.
const TILTED: &str = "\
2
Lattice=\"4 0 0 1 4 0 0 0 4\" Properties=species:S:1:pos:R:3 pbc=\"T T F\"
C 1 1 1
C 6 2 2
";

fn picture(folder: &Folder, name: &str, args: &[&str]) -> Image {
    let all = [&SMALL[..], &["a.xyz", "--radii", "0.3", "-o", name], args].concat();
    folder.succeed(&all);
    Image::read(folder.path(name)).expect("a picture")
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.xyz", TILTED);
    folder
}

#[test]
fn cells_wrap_repeat_and_are_drawn() {
    let folder = folder();
    let plain = picture(&folder, "plain.png", &[]);
    let wrapped = picture(&folder, "wrapped.png", &["--wrap"]);
    assert_ne!(plain, wrapped);
    let json = |args: &[&str]| {
        let all = [&SMALL[..], &["a.xyz", "--radii", "0.3", "--json", "-o", "b.png"], args];
        folder.json(&all.concat())["statistics"]["spheres"].clone()
    };
    assert_eq!((json(&[]), json(&["--replicate", "3,2,1"])), (2.into(), 12.into()));
    let with_cell = picture(&folder, "cell.png", &["--wrap", "--cell"]);
    // The cell is framed too, so the particles are smaller, but edges extend across the image.
    let columns = |image: &Image| {
        let gray = |x: u32| (0..image.height).any(|y| image.pixel(x, y).unwrap()[1] < 0.8);
        (0..image.width).filter(|&x| gray(x)).count()
    };
    assert!(columns(&with_cell) >= 15 && columns(&with_cell) > columns(&wrapped));
}

#[test]
fn cameras_are_free() {
    let folder = folder();
    let of =
        |args: &str| picture(&folder, "free.png", &args.split_whitespace().collect::<Vec<_>>());
    // Vectors and angles are sides, too.
    for (side, others) in [("x", ["1,0,0", "0,0"]), ("-y", ["0,-2,0", "-90,0"])] {
        let expected = of(&format!("--view {side}"));
        for other in others {
            assert_eq!(of(&format!("--view {other}")), expected, "{other}");
        }
    }
    let dark = |image: &Image| {
        let is_dark = |pixel: &&[f32; 3]| pixel[1] < 0.8;
        image.pixels.iter().filter(is_dark).count()
    };
    let plain = dark(&of("--view z --select index==0 --margin 0.6"));
    let zoomed = dark(&of("--view z --select index==0 --margin 0.6 --zoom 2"));
    assert!((3 * plain..5 * plain).contains(&zoomed), "{plain} {zoomed}");
    // A round particle alone looks the same wherever it is, and rolled.
    let alone = dark(&of("--view z --look-at index==1"));
    assert!(alone > dark(&of("--view z")));
    assert_ne!(of("--view z"), of("--view z --roll 90"));
    assert_ne!(of("--view z"), of("--view z --look-at 6,2,2"));
    folder.write(
        "camera.toml",
        "[camera]\neye = [3, 2, 30]\ntarget = [3, 1.5, 1]\nfov = 20\n[[file]]\npath = \"none.csv\"\n",
    );
    let taken = of("--camera camera.toml");
    assert_ne!(taken, of(""));
    assert_eq!(taken, of("--camera camera.toml --aperture 0"));
    folder.write("none.toml", "title = \"none\"\n");
    for (args, name) in [
        ("--camera camera.toml --view x", "--view"),
        ("--camera camera.toml --look-at index==0", "--look-at"),
        ("--camera camera.toml --zoom 2", "--zoom"),
        ("--camera none.toml", "[camera]"),
        ("--camera gone.toml", "gone.toml"),
        ("--look-at index==7", "is looked at"),
        ("--look-at nme==7", "nme"),
        ("--zoom 0", "1000"),
        ("--view 0,91", "elevation"),
        ("--roll 3 --turntable 2", "--turntable"),
    ] {
        let line = format!("a.xyz --radii 0.3 -o no.png {args}");
        let words: Vec<&str> = line.split_whitespace().collect();
        let message = text(&folder.run(&words).stderr);
        assert!(message.contains(name), "{args}: {message}");
    }
}

#[test]
fn sides_and_projections_frame_everything() {
    let folder = folder();
    let mut pictures = Vec::new();
    for side in ["auto", "x", "-x", "y", "-y", "z", "-z", "iso"] {
        for projection in ["perspective", "orthographic"] {
            let args = ["--view", side, "--projection", projection, "--margin", "0.2", "--cell"];
            let image = picture(&folder, "side.png", &args);
            let (width, height) = (image.width as usize, image.height as usize);
            // The margin is white, and the rest is not.
            let border = |row: usize| {
                let (x, y) = (row % width, row / width);
                x < 2 || y < 1 || x + 2 >= width || y + 1 >= height
            };
            let rows = || image.pixels.iter().enumerate();
            let painted = |pixel: &[f32; 3]| pixel[1] < 0.9;
            assert!(rows().all(|(row, pixel)| !border(row) || !painted(pixel)), "{side}");
            assert!(rows().filter(|(_, pixel)| painted(pixel)).count() > 30, "{side}");
            assert!(!pictures.contains(&image), "{side}");
            pictures.push(image);
        }
    }
}

#[test]
fn what_is_up_follows_the_cell_or_the_option() {
    let folder = folder();
    // The cell is periodic along a and b, so z is up.
    let found = picture(&folder, "found.png", &[]);
    assert_eq!(found, picture(&folder, "z.png", &["--up", "z"]));
    assert_eq!(found, picture(&folder, "auto.png", &["--up", "auto"]));
    let mut pictures = vec![found];
    for args in [&["--up", "y"][..], &["--up", "-z"], &["--up", "y", "--view", "x"]] {
        let image = picture(&folder, "up.png", args);
        assert!(!pictures.contains(&image), "{args:?}");
        pictures.push(image);
    }
    let sides = ["--view", "x", "--up"];
    let side = picture(&folder, "side.png", &["--view", "x"]);
    assert_eq!(side, picture(&folder, "up.png", &[&sides[..], &["z"]].concat()));
    let info = folder.json(&["info", "a.xyz", "--radii", "0.3", "--json"]);
    assert_eq!(info["particles"]["up"]["axis"], "z");
    let reason = info["particles"]["up"]["reason"].as_str().expect("a reason");
    assert!(reason.contains("periodic"), "{reason}");
    let output = folder.run(&["render", "a.xyz", "--radii", "0.3", "--size", "9x9", "--spp", "1"]);
    let stderr = text(&output.stderr);
    assert!(stderr.contains("z is up: the cell is periodic"), "{stderr}");
}

#[test]
fn turns_are_numbered_pictures_that_differ() {
    let folder = folder();
    let args = ["a.xyz", "--radii", "0.3", "--turntable", "3", "-o", "turn.png"];
    folder.succeed(&[&SMALL[..], &args].concat());
    let files: Vec<_> = (0..3).map(|i| folder.read(&format!("turn-00{i}.png"))).collect();
    assert!(files[0] != files[1] && files[1] != files[2] && files[0] != files[2]);
    assert!(!folder.path("turn.png").exists() && !folder.path("turn-003.png").exists());
}

#[test]
fn settings_without_effect_are_refused() {
    let folder = folder();
    folder.write("bare.xyz", "1\n\nC 0 0 0\n");
    folder.write("a.toml", "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\n");
    folder.write(
        "clear.toml",
        "[look]\nbackground = \"transparent\"\n[[generate]]\nkind = \"grid\"\n",
    );
    for (line, code, message) in [
        ("render bare.xyz --wrap", 1, "cannot wrap particles: the file has no cell"),
        (
            "render bare.xyz --replicate 2,1,1",
            1,
            "cannot replicate particles: the file has no cell",
        ),
        ("render bare.xyz --cell", 1, "no simulation cell"),
        ("render a.xyz --replicate 1,1,2", 1, "not periodic along its edge c"),
        ("render a.xyz --replicate 60000,60000,1", 1, "at most"),
        ("render a.xyz --replicate 2,2", 2, "three integers"),
        ("render a.xyz --view top", 2, "sides are"),
        ("render a.xyz --up top", 2, "directions are"),
        ("render a.xyz --up +z", 2, "did you mean `-z`"),
        ("render a.toml --up z", 2, "particle files"),
        ("render --up z", 2, "particle files"),
        ("render a.xyz --margin 1", 2, "0 to 0.9"),
        ("render a.xyz --turntable 0", 2, "1..=100000"),
        ("render - --turntable 2", 2, "standard input"),
        ("render --cell", 2, "particle file"),
        ("render a.xyz --preset pretty", 2, "presets are: figure"),
        ("render a.xyz --preset studo", 2, "did you mean `studio`"),
        ("render a.xyz --view ISO", 2, "did you mean `iso`"),
        ("render a.xyz --background whit", 2, "did you mean `white`"),
        ("render a.xyz --background 12", 2, "six digits"),
        ("render --preset chalk", 2, "particle file"),
        ("render a.toml --margin 0.1", 2, "add --view"),
        ("render clear.toml -o clear.ppm", 2, "cannot store a transparent background"),
        ("render clear.toml --part 1/2", 2, "the same in a scene need the whole image"),
    ] {
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
        assert!(stderr.contains(message), "{line}: {stderr}");
    }
}

#[test]
fn looks_and_backgrounds_differ() {
    let folder = folder();
    let mut pictures = Vec::new();
    for look in
        ["figure", "chalk", "studio", "cloudy", "glossy", "depthcue", "outline", "ghost", "x-ray"]
    {
        let image = picture(&folder, "look.png", &["--preset", look, "--wrap"]);
        // The corner is background or, in the studio, ground of the same light gray.
        let corner = image.pixel(0, 0).unwrap();
        let background = match look {
            "studio" => 0.8..=1.0,
            "x-ray" => 0.0..=0.0,
            _ => 1.0..=1.0,
        };
        assert!(corner.iter().all(|value| background.contains(value)), "{look}: {corner:?}");
        // Ghosts hide a fifth of the white behind them.
        let light = if look == "ghost" { 0.95 } else { 0.7 };
        assert!(image.pixels.iter().any(|pixel| (0.01..light).contains(&pixel[1])), "{look}");
        assert!(!pictures.contains(&image), "{look}");
        pictures.push(image);
    }
    let blue = picture(&folder, "blue.png", &["--background", "#0000ff", "--view", "z"]);
    assert_eq!(blue.pixel(0, 0), Some([0.0, 0.0, 1.0]));
    let white = picture(&folder, "white.png", &["--view", "z"]);
    for args in [["--background", "white"], ["--preset", "figure"]] {
        let again = picture(&folder, "again.png", &[&["--view", "z"], &args[..]].concat());
        assert_eq!(white, again, "{args:?} is the default");
    }
    let sky = picture(&folder, "sky.png", &["--view", "z", "--background", "sky"]);
    assert!(sky.pixel(0, 0).unwrap()[0] < 0.5, "the sky is dark behind the particles");
}
