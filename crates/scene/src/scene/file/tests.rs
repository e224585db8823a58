mod spheres;

use super::*;
use crate::scene::{ConductorFresnel, Integrator, Lens, Pose, Projection, Roulette, Tone};
use glam::DVec3;
use proptest::prelude::*;

fn parse(text: &str) -> Result<Scene, FileError> {
    Scene::parse(text, "scene.toml", Path::new(""))
}

/// Parses a valid scene.
fn scene(text: &str) -> Scene {
    parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Returns the error of an invalid scene.
fn fault(text: &str) -> FileError {
    match parse(text) {
        Err(error) => error,
        Ok(_) => panic!("this is accepted:\n{text}"),
    }
}

#[test]
fn errors_name_line_column_and_fix() {
    let cases = [
        (
            "[camera]\nfvo = 40\n",
            "scene.toml:2:1: unknown key `fvo` in [camera]\nhelp: did you mean `fov`?",
        ),
        (
            "[camera]\n  fov = 180\n",
            "scene.toml:2:9: `fov` is 180, but must be more than 0 and less than 180",
        ),
        (
            "[material.a]\nkind = \"lambertian\"\nior = 1.5\n",
            "scene.toml:3:1: `ior` has no meaning with kind = \"lambertian\"\nhelp: it belongs to \
             kind = \"dielectric\" or \"plastic\": remove it",
        ),
        (
            "[render]\nshadow_samples = 4\n",
            "scene.toml:2:1: `shadow_samples` has no meaning with integrator = \"path\"\nhelp: it \
             belongs to integrator = \"whitted\": remove it",
        ),
        (
            "[material.gold]\nkind = \"lambertian\"\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n\
             material = \"glod\"\n",
            "scene.toml:6:12: unknown material \"glod\"\nhelp: did you mean `gold`?",
        ),
        (
            "[material.\"ä\"]\nkind = \"lambertain\"\n",
            "scene.toml:2:8: unknown kind \"lambertain\"\nhelp: did you mean `lambertian`?",
        ),
        (
            "[[light]]\nkind = \"lamp\"\n",
            "scene.toml:2:8: unknown kind \"lamp\"\nhelp: possible values: sun, point",
        ),
        (
            "[[sphere]]\ncenter = [0, 0, nan]\nradius = 1\n",
            "scene.toml:2:17: `center` is nan, but must be a finite number",
        ),
        (
            "title = \"t\"\n\n[[sphere]]\nradius = 1\n",
            "scene.toml:3:1: missing key `center` in [[sphere]]\nhelp: write center = [x, y, z]",
        ),
        ("title = 3\n", "scene.toml:1:9: `title` is 3, but must be a string in quotes"),
    ];
    for (text, message) in cases {
        assert_eq!(fault(text).to_string(), message);
    }
}

#[test]
fn errors_carry_the_text_to_be_shown() {
    let text = "[render]\nspp = 0\n";
    let place = fault(text).place.unwrap_or_else(|| panic!("no place"));
    assert_eq!((place.source_text.as_str(), &text[place.span], place.first_line), (text, "0", 1));
}

#[test]
fn syntax_errors_have_a_position_too() {
    let error = fault("[render]\nspp = \n");
    assert_eq!((error.line(), error.path), (Some(2), "scene.toml".into()));
    assert_eq!(fault("[render]\nspp = 1\nspp = 2\n").line(), Some(3));
    assert_eq!(fault("[render\n").line(), Some(1));
}

#[test]
fn sections_in_wrong_brackets_are_reported() {
    let error = fault("[light]\nkind = \"sun\"\n");
    assert!(error.help.is_some_and(|help| help.contains("[[light]]")));
    assert!(fault("[[camera]]\nfov = 3\n").message.contains("must be a table"));
    assert!(fault("render = 3\n").message.contains("must be a table"));
    assert!(fault("[material]\nkind = \"lambertian\"\n").message.contains("must be a table"));
}

/// Texts with one value each that is out of its range, and one at the range's end.
#[test]
fn every_range_is_checked() {
    let cases: [(&str, &[&str], &str); 56] = [
        ("[color_bar]\nrange = ?", &["[2, 1]", "[0, inf]", "1", "[1]"], "[1, 1]"),
        ("[color_bar]\nrange = [1, 2]\nposition = ?", &["\"middle\"", "1"], "\"top-left\""),
        ("[legend]\nentries = ?", &["1", "[\"C\"]", "[[\"C\"]]", "[[1, 1]]"], "[[\"C\", \"red\"]]"),
        ("[axes]\ndirections = ?", &["1", "[[1, 0, 0]]"], "[[1, 0, 0], [0, 1, 0], [0, 0, 2]]"),
        ("[axes]\nnames = ?", &["\"a\"", "[\"a\", \"b\"]"], "[\"a\", \"b\", \"c\"]"),
        ("[scale_bar]\nlength = ?", &["0", "-1", "inf", "\"1\""], "2.5"),
        ("[[label]]\ntext = ?", &["1", "[\"a\"]"], "\"a\""),
        ("[lettering]\nsize = ?", &["0", "0.5", "nan"], "0.05"),
        ("[camera]\ninsets = ?", &["0.1", "[0, 0, 1, 0]", "[0.5, 0.5, 0, 0]"], "[0, 0.3, 0, 0]"),
        ("[look]\nbackground = ?", &["\"rde\"", "\"#12\"", "-1", "[1, 2]"], "\"transparent\""),
        ("[look]\nbackground = ?", &["true", "2e30"], "[0, 1e30, 0.5]"),
        ("[look]\noutline = ?", &["1", "\"yes\""], "true"),
        (
            "[look]\ncell = [[0, 0, 0], [9, 0, 0], [0, 9, 0], ?]",
            &["1", "[0, 0]", "[0, 0, inf]"],
            "[0, 0, 9]",
        ),
        ("[render]\nsize = ?", &["[0, 5]", "[5, 65536]", "[5]", "5", "[1.5, 2]"], "[65535, 1]"),
        ("[render]\nspp = ?", &["0", "-1", "16777217", "1.5", "\"many\""], "16777216"),
        ("[render]\nuntil_error = ?", &["0", "-1", "1.1", "nan", "\"1%\""], "1"),
        ("[render]\ntime = ?", &["0", "-1", "inf", "2e9", "\"60s\""], "0.001"),
        ("[render]\ndepth = ?", &["-1", "1.5", "\"infinite\"", "4294967296"], "\"unlimited\""),
        ("[render]\nseed = ?", &["-1", "18446744073709551616"], "18446744073709551615"),
        ("[render]\nroulette = ?", &["0", "1.1", "nan", "\"maybe\""], "1"),
        ("[render]\nlight_choice = ?", &["\"random\"", "1"], "\"power\""),
        ("[render]\ncaustics = ?", &["1", "\"on\""], "false"),
        ("[render]\nexposure = ?", &["101", "inf", "\"1\""], "-100"),
        ("[render]\nsampler = ?", &["\"halton\"", "1"], "\"stratified\""),
        ("[render]\nfilter = ?", &["\"tent\""], "\"box\""),
        ("[render]\ntone = ?", &["\"aces\""], "\"filmic\""),
        ("[render]\nintegrator = \"whitted\"\nshadow_samples = ?", &["0", "-1"], "1"),
        ("[render]\nintegrator = \"ao\"\nao_distance = ?", &["-1e-9", "inf", "-1"], "0"),
        ("[camera]\nfov = ?", &["0", "-1", "180", "nan", "inf"], "179.9"),
        ("[camera]\nprojection = \"orthographic\"\nheight = ?", &["0", "-1", "inf"], "1e-9"),
        (
            "[camera]\neye = [0, 0, 1]\ntarget = ?",
            &["[0, 0, 1]", "[0, nan, 0]", "[0, 0]"],
            "[0, 0, 0]",
        ),
        ("[camera]\nup = ?", &["[0, 0, 0]", "[0, inf, 0]", "1"], "[0, 0, -5]"),
        ("[camera]\ndirection = ?", &["[0, 0, 0]", "[nan, 0, 0]"], "[0, 0, -5]"),
        ("[camera]\nmargin = ?", &["1", "-0.1", "nan"], "0"),
        ("[camera]\naperture = ?", &["-0.1", "nan", "inf"], "0"),
        ("[camera]\naperture = 1\nfocus = ?", &["0", "-1", "inf"], "1e-9"),
        ("[camera]\nnear = ?", &["-1", "nan"], "0"),
        ("[camera]\nzoom = ?", &["0", "-1", "1001", "nan"], "2.5"),
        ("[camera]\nradius = 1\ncenter = ?", &["1", "[0, inf, 0]"], "[1, 2, 3]"),
        ("[camera]\ncenter = [1, 2, 3]\nradius = ?", &["0", "-1", "inf"], "0.5"),
        ("[environment]\ncolor = ?", &["-1", "[1, 2, inf]", "\"#12345\"", "1e31"], "1e30"),
        ("[environment]\nkind = \"gradient\"\nup = ?", &["[0, 0, 0]"], "[1, 0, 0]"),
        ("[environment]\nilluminates = ?", &["1", "\"yes\""], "false"),
        ("[ground]\nnormal = ?", &["[0, 0, 0]", "[0, nan, 0]"], "[0, 0, 1e-300]"),
        ("[ground]\nheight = ?", &["nan", "inf", "1e999"], "-1e300"),
        ("[[light]]\nkind = \"sun\"\nirradiance = 1\ndirection = ?", &["[0, 0, 0]"], "[0, 9, 0]"),
        (
            "[[light]]\nkind = \"sun\"\ndirection = [0, 1, 0]\nirradiance = ?",
            &["-1", "1e31"],
            "1e30",
        ),
        (
            "[[light]]\nkind = \"sun\"\ndirection = [1, 1, 1]\nirradiance = 1\nangular_radius = ?",
            &["-1", "90", "nan"],
            "0",
        ),
        (
            "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = ?",
            &["-1", "1e39"],
            "1e38",
        ),
        ("[material.a]\nkind = \"lambertian\"\ncolor = ?", &["1.01", "[0, -0.1, 0]", "nan"], "1"),
        ("[material.a]\nkind = \"conductor\"\ncolor = 1\nroughness = ?", &["1.1", "-1"], "1"),
        ("[material.a]\nkind = \"dielectric\"\nior = ?", &["0", "-1", "inf", "nan"], "0.5"),
        ("[material.a]\nkind = \"plastic\"\nior = ?", &["1", "0.9", "inf"], "1.001"),
        ("[material.a]\nkind = \"reflective\"\nmirror = ?", &["0.51", "-0.1"], "0.5"),
        (
            "[[sphere]]\ncenter = [0, 0, 0]\nradius = ?",
            &["0", "-1", "nan", "inf", "1e-400"],
            "1e-300",
        ),
        ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\ncolor = ?", &["1.01", "-1"], "\"#ff8000\""),
    ];
    for (text, outside, inside) in cases {
        let line = text.lines().count();
        for value in outside {
            let error = fault(&text.replace('?', value));
            assert_eq!(error.line(), Some(line), "{text} {value}: {error}");
        }
        scene(&text.replace('?', inside));
    }
}

#[test]
fn contradicting_keys_are_reported() {
    let cases = [
        ("[camera]\nfit = true\neye = [0, 0, 0]\n", 3),
        ("[camera]\neye = [0, 0, 0]\ntarget = [1, 0, 0]\nmargin = 0.1\n", 4),
        ("[camera]\neye = [0, 0, 0]\n", 1),
        ("[camera]\nfit = false\n", 1),
        ("[camera]\nfit = false\nmargin = 0.1\n", 3),
        ("[camera]\nfit = true\ntarget = [0, 0, 0]\n", 3),
        ("[camera]\neye = [1, 0, 0]\ntarget = [1, 0, 0]\n", 3),
        ("[camera]\nfocus = 3\n", 2),
        ("[camera]\ncenter = [1, 2, 3]\n", 2),
        ("[camera]\nradius = 2\n", 2),
        ("[camera]\neye = [0, 0, 0]\ntarget = [1, 0, 0]\ncenter = [0, 0, 0]\n", 4),
        ("[camera]\nprojection = \"orthographic\"\nfov = 3\n", 3),
        ("[material.a]\nkind = \"conductor\"\n", 1),
        ("[material.a]\nkind = \"conductor\"\neta = 1\n", 1),
        ("[material.a]\nkind = \"conductor\"\neta = 1\nk = 1\ncolor = 1\n", 5),
        ("[material.a]\nkind = \"reflective\"\ndiffuse = 0.6\n", 3),
        ("[material.a]\nkind = \"emitter\"\n", 1),
        ("[material.a]\ncolor = 1\n", 1),
        ("[material.\" a\"]\nkind = \"lambertian\"\n", 1),
        ("[material.\"\"]\nkind = \"lambertian\"\n", 1),
        ("[ground]\nmaterial = \"g\"\n[material.g]\nkind = \"dielectric\"\n", 2),
        ("[ground]\nmaterial = \"g\"\n[material.g]\nkind = \"emitter\"\nradiance = 1\n", 2),
        ("[ground]\n[material.default]\nkind = \"dielectric\"\n", 1),
        ("[[light]]\ndirection = [0, 1, 0]\n", 1),
        ("[environment]\nkind = \"picture\"\n", 1),
        ("[environment]\nkind = \"picture\"\nfile = \"none.hdr\"\n", 3),
        ("[[generate]]\nkind = \"field\"\nmix = [1, 0, 0]\nmaterial = \"a\"\n", 4),
        ("[[generate]]\nkind = \"grid\"\nseed = 1\n", 3),
        (
            "[[stick]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradius = 1\ncolor = 1\ncolors = [1, 1]\n",
            5,
        ),
        ("[[ellipsoid]]\ncenter = [0, 0, 0]\nsemi_axes = [1, 1, 20000]\n", 3),
        ("[[cone]]\napex = [0, 0, 0]\nbase = [0, 0, 0]\nradius = 1\n", 3),
        ("[[cone]]\napex = [0, 0, 0]\nbase = [0, 0, 1]\nradius = 20000\n", 4),
    ];
    for (text, line) in cases {
        let error = fault(text);
        assert_eq!(error.line(), Some(line), "{text}{error}");
    }
}

#[test]
fn values_are_read() {
    let scene = scene(
        "title = \"t\"\n[render]\nsize = [3, 2]\nspp = 0x10\ndepth = 0\nintegrator = \"whitted\"\n\
         roulette = 0.9\ntone = \"filmic\"\n[camera]\nprojection = \"orthographic\"\nheight = 2.5\n\
         eye = [0, 0, 9]\ntarget = [0, 0, 0]\naperture = 0\n\
         [ground]\nnormal = [0, 0, 2]\nheight = -0.5\n\
         [material.b]\nkind = \"conductor\"\ncolor = \"#ffffff\"\nfresnel = \"constant\"\n\
         [material.a]\nkind = \"emitter\"\nradiance = [1, 2, 3]\n\
         [[sphere]]\ncenter = [1, 2, 3]\nradius = 4\nmaterial = \"a\"\n",
    );
    assert_eq!((scene.settings.width, scene.settings.height, scene.settings.spp), (3, 2, 16));
    assert_eq!((scene.settings.depth, scene.settings.tone), (Some(0), Tone::Filmic));
    assert_eq!(scene.settings.integrator, Integrator::Whitted { shadow_samples: 16 });
    assert_eq!(scene.settings.roulette, Roulette::Fixed(0.9));
    assert_eq!(scene.camera.projection, Projection::Orthographic { height: Some(2.5) });
    let eye = DVec3::new(0.0, 0.0, 9.0);
    assert_eq!(scene.camera.pose, Pose::LookAt { eye, target: DVec3::ZERO });
    assert_eq!(scene.camera.lens, Some(Lens { aperture: 0.0, focus: None }));
    let ground = scene.ground.map(|ground| (ground.normal, ground.height, ground.material));
    assert_eq!(ground, Some((DVec3::Z, -0.5, 2)));
    let names: Vec<&str> = scene.materials.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["b", "a", "default"]);
    let fresnel = ConductorFresnel::Constant(Rgb::ONE);
    assert_eq!(scene.materials[0].material, Material::Conductor { fresnel, roughness: 0.0 });
    assert_eq!(scene.spheres.material, [1]);
    assert_eq!(scene.spheres.center(0), DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn the_environment_is_white_only_without_lights() {
    let sky = |text: &str| match scene(text).environment.map {
        EnvironmentMap::Constant(color) => color,
        other => panic!("{other:?}"),
    };
    let emitter = "[material.glow]\nkind = \"emitter\"\nradiance = 1\n";
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    assert_eq!(sky(""), Rgb::ONE);
    assert_eq!(sky(emitter), Rgb::ONE);
    assert_eq!(sky(&[emitter, sphere, "material = \"glow\"\n"].concat()), Rgb::ZERO);
    assert_eq!(
        sky("[[light]]\nkind = \"sun\"\ndirection = [0, 1, 0]\nirradiance = 1\n"),
        Rgb::ZERO
    );
}

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic(
        start in 0_usize..1500,
        length in 0_usize..30,
        text in "[\\[\\]=\"a-z0-9.,# \n\u{0}ä-]{0,12}",
    ) {
        let whole = include_str!("../../../../../scenes/glass-nested.toml");
        let tail: String = whole.chars().skip(start + length).collect();
        let head: String = whole.chars().take(start).collect();
        if let Err(error) = parse(&[head, text, tail].concat()) {
            prop_assert!(error.line().is_some() && !error.message.is_empty());
        }
    }
}

#[test]
fn numbers_may_be_grouped_and_signed() {
    let scene = scene("[render]\nspp = 1_000\nexposure = -1_0.5e-1\n[camera]\nnear = +3\n");
    let numbers = (scene.settings.spp, scene.settings.exposure, scene.camera.near);
    assert_eq!(numbers, (1000, -1.05, 3.0));
}

#[test]
fn cameras_of_one_line_are_those_of_files() {
    let mut camera = Camera { up: DVec3::Z, ..Camera::default() };
    let (eye, target) = (DVec3::new(1.0 / 3.0, -2e-9, 7.25e12), DVec3::new(-0.0, 0.5, 1.0));
    camera.pose = Pose::LookAt { eye, target };
    for projection in [
        Projection::Perspective { fov: 0.1 + 0.2 },
        Projection::Orthographic { height: Some(1e-3) },
    ] {
        camera.projection = projection;
        camera.lens = Some(Lens { aperture: 0.125, focus: Some(9.5) });
        let line = camera.to_line();
        assert!(!line.contains('\n') && Camera::is_line(Path::new(&line)), "{line}");
        assert_eq!(Camera::read(Path::new(&line)).unwrap(), camera, "{line}");
    }
    let fault = Camera::read(Path::new("eye = [0, 0, 1], target = [0, 0]")).unwrap_err();
    assert!(fault.to_string().contains("target"), "{fault}");
    assert!(Camera::read(Path::new("fvo = 3")).unwrap_err().to_string().contains("`fov`"));
    assert!(Camera::read(Path::new("no-such-file.toml")).is_err());
}
