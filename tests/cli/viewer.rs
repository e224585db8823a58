//! The viewer without a page: scripts of events, and saved files.

use crate::folder::{Folder, text};
use crate::process::run_with_input;
use spherule_render::image::Image;
use spherule_render::scene::{Measure, Scene};
use std::path::{Path, PathBuf};

/// Particles of three types, one of them twice, with a column, in two frames.
const SALT: &str = "\
4
Properties=species:S:1:pos:R:3:q:R:1
Na 0 0 0 1
Cl 3 0 0 -1
Cl 0 3 0 -2
K 0 0 3 1
4
Properties=species:S:1:pos:R:3:q:R:1
Na 1 0 0 1
Cl 3 0 0 -1
Cl 0 3 0 -2
K 0 0 3 1
";

/// Runs a script, and returns the program's output.
fn view(folder: &Folder, args: &[&str], script: &str) -> String {
    folder.write("script.txt", script);
    folder.succeed(&[&["view", "--headless-script", "script.txt", "--quiet"], args].concat())
}

/// Asserts that the scene `a.toml` renders to the bytes of the image `a.png`, also in a viewer.
#[track_caller]
fn assert_saved_scene_renders(folder: &Folder, samples: u32) {
    folder.succeed(&["render", "a.toml", "--quiet", "-o", "b.png"]);
    assert!(folder.read("a.png") == folder.read("b.png"), "rendered");
    view(folder, &["a.toml"], &format!("wait {samples}\nsave c.png"));
    assert!(folder.read("a.png") == folder.read("c.png"), "seen again");
}

#[test]
fn saved_scenes_render_to_the_same_picture() {
    let folder = Folder::new();
    let motions = [
        "drag 10,10 40,20\nwheel 3 5,30\nkey e\nkey E\nkey e",
        "key 5\ndrag 20,10 25,30 shift\nkey .\nkey i",
        "click 32,30 ctrl\nkey L\nkey f\nkey m",
        "key 3\nkey home\ndrag 1,1 60,40 alt steps=3\nkey i\nkey i\nkey -",
    ];
    for motion in motions {
        let script = format!("size 64x48\n{motion}\nwait 3\nsave a.png\nsave a.toml\n");
        view(&folder, &[], &script);
        assert_saved_scene_renders(&folder, 3);
    }
}

#[test]
fn hidden_types_cuts_colors_and_lights_are_saved() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let salt = ["salt.xyz", "--radii", "1"];
    let mut pictures: Vec<Vec<u8>> = Vec::new();
    for key in ["key tab", "key c", "key p\nkey p", "key right", "key x\ndrag 32,47 32,0", "key 7"]
    {
        let script = format!("size 64x48\n{key}\nwait 2\nsave a.png\nsave a.toml\n");
        view(&folder, &salt, &script);
        assert_saved_scene_renders(&folder, 2);
        let picture = folder.read("a.png");
        assert!(!pictures.contains(&picture), "{key}");
        pictures.push(picture);
    }
}

#[test]
fn looks_by_key_keep_the_materials_of_types() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let salt = ["salt.xyz", "--radii", "1", "--type", "Cl:material=glass"];
    for (args, keys) in
        [(&[][..], "key p"), (&[], "key p\nkey p"), (&["--preset", "studio"], "key tab")]
    {
        let script = format!("size 64x48\n{keys}\nwait 2\nsave a.png\nsave a.toml\n");
        view(&folder, &[&salt, args].concat(), &script);
        assert_saved_scene_renders(&folder, 2);
        let scene = text(&folder.read("a.toml"));
        assert_eq!(scene.matches("dielectric").count(), 1, "{keys} {scene}");
        assert!(scene.contains("lambertian") && scene.contains("\"path\""), "{scene}");
    }
}

#[test]
fn arrows_of_all_frames_have_one_scale() {
    let folder = Folder::new();
    let frame =
        |speed: f64| format!("1\nProperties=species:S:1:pos:R:3:velo:R:3\nNa 0 0 0 {speed} 0 0\n");
    folder.write("run.xyz", &(frame(1.0) + &frame(3.0)));
    let script = "size 64x48\nwait 1\nsave a.toml\nkey right\nwait 1\nsave b.toml\n";
    view(&folder, &["run.xyz", "--radii", "1", "--arrows", "velocity"], script);
    let [a, b] = ["a.toml", "b.toml"].map(|name| {
        let scene = Scene::load(&folder.path(name)).expect("a scene");
        (scene.cones.apex[0].x, scene.cones.radius[0])
    });
    assert!((b.0 / a.0 - 3.0).abs() < 1e-6 && (b.1 - a.1).abs() < 1e-6, "{a:?} {b:?}");
}

#[test]
fn overlays_are_shown_and_saved() {
    let folder = Folder::new();
    let cell = SALT.replace("Properties", "Lattice=\"4 0 0 0 4 0 0 0 4\" pbc=\"T T T\" Properties");
    folder.write("salt.xyz", &cell);
    let mut pictures: Vec<Vec<u8>> = Vec::new();
    for (args, keys) in [
        ("--preset depthcue", ""),
        ("--preset outline", ""),
        ("--background #ff8000", ""),
        ("--cell", ""),
        ("--preset outline --background black --cell", ""),
        ("--preset outline --background transparent --cell", ""),
        ("--preset studio --background transparent", "key i"),
        ("", "key P\nkey d"),
        ("", "key p\nkey d\nkey b\nkey b"),
        ("", "key o\nkey m\ndrag 5,5 30,9"),
    ] {
        let script = format!("size 64x48\n{keys}\nwait 3\nsave a.png\nsave a.exr\nsave a.toml\n");
        let args: Vec<&str> = args.split_whitespace().collect();
        view(&folder, &[&["salt.xyz", "--radii", "1"], &args[..]].concat(), &script);
        assert_saved_scene_renders(&folder, 3);
        folder.succeed(&["render", "a.toml", "--quiet", "-o", "b.exr"]);
        assert!(folder.read("a.exr") == folder.read("b.exr"), "{args:?}");
        let picture = folder.read("a.png");
        assert!(!pictures.contains(&picture), "{args:?} {keys}");
        pictures.push(picture);
    }
}

#[test]
fn pages_show_looks_as_saved_pictures_do() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    let script = "size 64x48\nkey tab\nwait 2\nsave a.png\nwindow w.png";
    view(&folder, &["salt.xyz", "--preset", "outline"], script);
    assert_eq!(read("a.png"), read("w.png"));
    view(&folder, &["salt.xyz", "--background", "transparent"], script);
    // The checkerboard is visible where nothing is drawn.
    let window = read("w.png");
    assert_ne!(window.pixel(0, 0), window.pixel(12, 0));
}

#[test]
fn clicks_name_spheres_and_their_types_can_be_hidden() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let salt = ["salt.xyz", "--radii", "1", "--view", "z"];
    // Seen from above, potassium is in front, and sodium right behind it.
    let first = view(&folder, &salt, "size 60x60\nclick 17,43\nclick 1,1");
    assert_eq!(first, "sphere 3: type K, at 0 0 3, radius 1, q = 1\n");
    let second = view(&folder, &salt, "size 60x60\nclick 17,43\nkey h\nclick 17,43\nkey c");
    assert!(second.contains("sphere 0: type Na, at 0 0 0, radius 1, q = 1"), "{second}");
    let again = view(&folder, &salt, "size 60x60\nclick 17,43\nkey h\nkey H\nclick 17,43");
    assert_eq!(again.lines().next_back(), first.lines().next());
}

#[test]
fn selected_spheres_are_measured() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let salt = ["salt.xyz", "--radii", "1", "--view", "z"];
    let script = "size 60x60\nclick 17,43\nclick 42,43 shift\nclick 17,18 shift\nkey esc\n\
                  click 17,43 shift\nset measure 3-1 '3-1-2'\nwait 2\nsave a.png\nsave a.toml";
    let told = view(&folder, &salt, script);
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(
        (lines.len(), lines[2], lines[4]),
        (6, "distance 4.24\u{a0}\u{c5}", "angle 60.0\u{b0}")
    );
    let scene = Scene::load(&folder.path("a.toml")).expect("a scene");
    let texts: Vec<String> = scene.annotations.measures.iter().map(Measure::text).collect();
    assert_eq!(texts, ["4.24\u{a0}\u{c5}", "60.0\u{b0}"]);
    assert_saved_scene_renders(&folder, 2);
}

#[test]
fn looks_can_be_undone() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let seen = |keys: &str| {
        view(&folder, &["salt.xyz"], &format!("size 40x30\n{keys}\nwait 1\nsave a.png"));
        folder.read("a.png")
    };
    let plain = seen("");
    assert!(plain == seen("key 1\nkey r"), "the camera");
    assert!(plain == seen("key c\nkey C"), "colors");
    assert!(plain == seen("key right\nkey left"), "frames");
    assert!(plain == seen("key e\nkey E"), "exposure");
    assert!(plain == seen("key m\nkey m\nkey m\nkey i\nkey i\nkey i"), "sampler and integrator");
    assert!(plain == seen("key x\ndrag 20,0 20,29\nkey H"), "cuts");
    assert!(plain != seen("key right\nkey right"));
}

#[test]
fn turns_are_numbered_and_shown() {
    let folder = Folder::new();
    let script = "size 64x48\nrepeat 3\nturn 120 0\nwait 1\nsave turn-{}.png\nend\nwindow w.png\n\
                  turn 9 0\nwindow preview.png\nquit\njust nonsense";
    folder.write("script.txt", script);
    let output = folder.run(&["view", "--headless-script", "script.txt"]);
    assert!(text(&output.stderr).contains("line 11"), "{}", text(&output.stderr));
    view(&folder, &[], script.trim_end_matches("just nonsense"));
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    let turn = ["turn-000.png", "turn-001.png", "turn-002.png"].map(read);
    assert!(turn[0] != turn[1] && turn[1] != turn[2]);
    assert_eq!(read("w.png"), turn[2]);
    assert_eq!(read("preview.png"), turn[2], "an image is shown until the next comes");
}

#[test]
fn options_are_set_and_undone_by_scripts() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let seen = |lines: &str| {
        view(&folder, &["salt.xyz"], &format!("size 40x30\n{lines}\nwait 1\nsave a.png"));
        folder.read("a.png")
    };
    let plain = seen("");
    for (set, same) in [
        ("set color-by q", "set color-by z\nundo\nset color-by q"),
        (
            "set style 'type Na: color=magenta'",
            "set style 'type Na: color=red'\nset style 'type Na: color=magenta'",
        ),
        ("set view 30,20", "set view x\nset view 30,20"),
        ("set preset outline", "set preset studio\nundo\nredo\nunset preset\nset preset outline"),
        ("hide Na", "hide Na\nhide Cl\nshow Cl"),
        ("frame 1", "frame 1\nundo\nredo"),
        ("set exposure 1", "set exposure 2\nset exposure 1"),
        ("set integrator ao", "undo\nset integrator ao"),
    ] {
        let once = seen(set);
        assert!(once != plain, "{set}");
        assert!(once == seen(same), "{same}");
        assert!(plain == seen(&format!("{set}\nundo")), "{set}");
    }
    for line in ["set color-by nothing", "set output x.png", "set model cubes", "set nonsense 1"] {
        folder.write("script.txt", &format!("{line}\nsave b.png"));
        let output = folder.run(&["view", "salt.xyz", "--headless-script", "script.txt"]);
        assert!(!output.status.success() && !folder.path("b.png").exists(), "{line}");
    }
}

#[test]
fn frame_times_of_motion_are_reported() {
    let folder = Folder::new();
    folder.write("script.txt", "size 64x48\nadapt\ndrag 5,5 50,40 steps=20");
    let json = folder.json(&["view", "--headless-script", "script.txt", "--json"]);
    assert_eq!((&json["spheres"], &json["moving"]["count"]), (&400.into(), &20.into()));
}

#[test]
fn options_that_the_viewer_does_not_support_are_refused() {
    let folder = Folder::new();
    folder.write("script.txt", "wait 1");
    for (args, message) in [
        (&["--region", "0,0,1x1"][..], "--region"),
        (&["--turntable", "4"], "--turntable"),
        (&["--terminal"], "--terminal"),
        (&["--headless-script", "nowhere.txt"], "nowhere.txt"),
        (&["--headless-script", "script.txt", "missing.toml"], "missing.toml"),
    ] {
        let output = folder.run(&[&["view"], args].concat());
        assert!(!output.status.success());
        assert!(text(&output.stderr).contains(message), "{}", text(&output.stderr));
    }
}

#[test]
fn help_does_not_list_options_that_the_viewer_refuses() {
    let folder = Folder::new();
    let lists = |help: &str, option: &str| {
        help.lines().any(|line| line.trim_start().split(' ').next() == Some(option))
    };
    let (render, view) =
        (folder.succeed(&["render", "--help"]), folder.succeed(&["view", "--help"]));
    assert!(lists(&view, "--size") && lists(&view, "--color-by"), "{view}");
    for option in [
        "--output-format",
        "--region",
        "--layers",
        "--part",
        "--split",
        "--turntable",
        "--fps",
        "--checkpoint",
        "--checkpoint-every",
        "--resume",
        "--terminal",
    ] {
        assert!(lists(&render, option) && !lists(&view, option), "{option}: {view}");
    }
}

#[test]
fn terminal_pictures_need_a_terminal() {
    let folder = Folder::new();
    let output = folder.run(&["render", "--terminal", "--size", "8x8"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--terminal needs a terminal"));
}

/// Returns every file that may contain particles or a scene.
fn data_files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = [
        "tests/data",
        "tests/fuzz/corpus/particles",
        "tests/fuzz/corpus/scenes",
        "scenes",
        "scenes/gallery",
    ];
    let entries = folders.iter().flat_map(|folder| {
        std::fs::read_dir(root.join(folder)).expect("a folder of the repository")
    });
    // A quarter of a million spheres take seconds, and others show the same.
    let large = "paper-grid-500.toml";
    let other = ["png", "md", "awk"];
    let is_data = |path: &PathBuf| {
        let suffix = path.extension().and_then(std::ffi::OsStr::to_str).unwrap_or_default();
        path.is_file()
            && !other.contains(&suffix)
            && !path.ends_with("make")
            && !path.ends_with(large)
    };
    let mut files: Vec<PathBuf> =
        entries.map(|entry| entry.expect("an entry").path()).filter(is_data).collect();
    files.sort();
    files
}

/// The viewer opens every file that `render` accepts, colors it by every column that it lists, and shows the
/// same image as `render` of the scene that it saves.
#[test]
fn the_viewer_opens_every_file_that_render_takes() {
    let folder = Folder::new();
    let script = format!(
        "size 24x16\nwait 1\nsave a.png\nsave a.toml\nclick 12,8\n{}wait 1\nclick 12,8",
        "key c\n".repeat(8)
    );
    let mut opened = Vec::new();
    for path in data_files() {
        let file = path.to_str().expect("a name in UTF-8");
        let render = ["render", file, "--size", "24x16", "--spp", "1", "--quiet", "-o", "r.png"];
        if !folder.run(&render).status.success() {
            continue;
        }
        view(&folder, &[file], &script);
        folder.succeed(&["render", "a.toml", "--quiet", "-o", "b.png"]);
        assert!(folder.read("a.png") == folder.read("b.png"), "{file}");
        opened.push(path.file_name().map(|name| name.to_string_lossy().into_owned()));
    }
    for name in [
        "velocities.gro",
        "arrays.npz",
        "mixed.csv",
        "chunks.gsd",
        "ragged.xyz",
        "water.gro",
        "stored.npz",
        "models.pdb",
        "moving.data",
        "rows.txt.xz",
        "quartz.cif",
        "weekend.toml",
    ] {
        assert!(opened.iter().flatten().any(|own| own == name), "{name} is not opened");
    }
    assert!(opened.len() >= 50, "{} files", opened.len());
}

#[test]
fn standard_input_is_read_once_with_all_its_columns() {
    let folder = Folder::new();
    folder.write("script.txt", "size 60x60\nkey right\nkey c\nkey C\nclick 17,43");
    let args = ["view", "-", "--radii", "1", "--view", "z", "--headless-script", "script.txt"];
    let output = run_with_input(&mut folder.command(&args), SALT);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "sphere 3: type K, at 0 0 3, radius 1, q = 1\n");
}

#[test]
fn color_bars_are_saved() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let by_charge = ["salt.xyz", "--radii", "1", "--background", "white", "--color-by", "q"];
    // In the image it equals that of `render`, also for the saved scene.
    let inside = [&by_charge[..], &["--color-bar", "inside:top-left"]].concat();
    let by_charge = [&by_charge[..], &["--size", "160x200"]].concat();
    let inside = [&inside[..], &["--size", "160x200", "--denoise", "off"]].concat();
    let script = "wait 2\nsave a.png\nsave a.exr\nsave a.toml\n";
    view(&folder, &inside, script);
    assert_saved_scene_renders(&folder, 2);
    let picture = folder.read("a.png");
    view(&folder, &by_charge, script);
    assert!(picture != folder.read("a.png"), "no bar");
    let view_args = ["--spp", "2", "--quiet", "-o", "r.png"];
    folder.succeed(&[&["render"], &inside[..], &view_args].concat());
    view(&folder, &inside, script);
    folder.succeed(&["render", "a.toml", "--quiet", "-o", "b.png"]);
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert!(read("r.png") == read("b.png"));
    // A separate file.
    view(&folder, &[&by_charge[..], &["--color-bar", "bar.svg"]].concat(), script);
    folder.succeed(&[&["render"], &by_charge[..], &["--color-bar", "c.svg"], &view_args].concat());
    assert!(folder.read("bar.svg") == folder.read("c.svg"));
    let output = folder.run(
        &[
            &["view", "salt.xyz", "--headless-script", "script.txt", "--color-by", "type"][..],
            &["--color-bar", "inside"],
        ]
        .concat(),
    );
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
}

#[test]
fn numbers_have_significant_digits_only() {
    let folder = Folder::new();
    let third = format!("{:.17}", 1.0_f64 / 3.0);
    let tenth = f64::from(0.1_f32);
    folder.write("a.csv", &format!("x,y,z,radius,q\n0,0,{tenth},5,{third}\n90,0,0,5,1e-12\n"));
    let args = ["a.csv", "--view", "z", "--projection", "orthographic", "--size", "60x60"];
    let lines = view(&folder, &args, "click 6,30\nclick 54,30");
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines[0], "sphere 0: at 0 0 0.1, radius 5, q = 0.333333");
    assert_eq!(lines[1], "sphere 1: at 90 0 0, radius 5, q = 1e-12");
}

/// The viewer keeps no copy of this many spheres: it generates them again for the saved scene.
#[test]
fn many_spheres_are_shown_and_saved() {
    let folder = Folder::new();
    // So many that the viewer keeps no second copy.
    let count = if cfg!(debug_assertions) { 65_600 } else { 1_048_600 };
    folder.write("many.toml", &format!("[[generate]]\nkind = \"volume\"\ncount = {count}\n"));
    let script = "size 32x24\nwait 1\nclick 16,12\nsave a.png\nsave a.toml\nkey c\nwait 1\nsave c.png\n\
                  key C\nwait 1\nsave d.png\nkey a\nkey 9\nwait 1";
    let named = view(&folder, &["many.toml"], script);
    assert!(named.starts_with("sphere ") && named.contains(", radius 0."), "{named}");
    let render = ["render", "many.toml", "--size", "32x24", "--spp", "1", "--quiet", "-o", "r.png"];
    folder.succeed(&render);
    assert_eq!(Image::read(folder.path("a.png")).ok(), Image::read(folder.path("r.png")).ok());
    let rows = text(&folder.read("a.csv")).lines().count();
    assert_eq!(rows, count + 1);
    // Another world replaces the first one, which then replaces it again.
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert_ne!(read("c.png"), read("a.png"));
    assert_eq!(read("d.png"), read("a.png"));
}
