//! Spheres from blocks, generators and files.

use super::*;
use std::fs;

#[test]
fn too_many_spheres_are_refused_before_they_are_made() {
    let cases = [
        ("kind = \"volume\"\ncount = 1000000000000", "1000000000000 spheres"),
        ("kind = \"grid\"\ncount = 4294967296", "more than 1e19"),
        ("kind = \"field\"\ncount = 65536", "4294967296 spheres"),
        ("kind = \"lattice\"\ncount = 18446744073709551615", "more than 1e19"),
        ("kind = \"sphereflake\"\nlevel = 11", "at most 4294967279"),
        ("kind = \"sphereflake\"\nlevel = 4000000000", "more than 1e19"),
    ];
    for (keys, message) in cases {
        let error = fault(&format!("[[generate]]\n{keys}\n"));
        assert!(error.message.contains(message), "{error}");
        assert_eq!(error.line(), Some(3), "{error}");
    }
    // Each of them would fit alone.
    let two = "[[generate]]\nkind = \"grid\"\ncount = 3\n\
               [[generate]]\nkind = \"volume\"\ncount = 4294967279\n";
    assert_eq!(fault(two).line(), Some(6));
}

#[test]
fn parameters_of_generators_are_errors_at_their_keys() {
    let cases = [
        "kind = \"field\"\nradius = [0.1, 0.6]",
        "kind = \"field\"\nradius = [0.4, 0.1]",
        "kind = \"field\"\nmix = [0, 0, 0]",
        "kind = \"field\"\nmix = [1, -1, 1]",
        "kind = \"volume\"\nsize = 0",
        "kind = \"volume\"\ncount = 0",
        "kind = \"grid\"\nspacing = inf",
        "kind = \"lattice\"\njitter = -1",
        "kind = \"sphereflake\"\nradius = -1",
    ];
    for keys in cases {
        assert_eq!(fault(&format!("[[generate]]\n{keys}\n")).line(), Some(3), "{keys}");
    }
}

#[test]
fn mixes_use_the_materials_of_the_scene() {
    let scene = scene(
        "[material.glass]\nkind = \"dielectric\"\nior = 1.33\n\
         [[sphere]]\ncenter = [0, 9, 0]\nradius = 1\n\
         [[generate]]\nkind = \"field\"\nmix = [1, 1, 1]\n",
    );
    let names: Vec<&str> = scene.materials.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["glass", "default", "diffuse", "metal"]);
    assert_eq!(scene.materials[0].material, Material::Dielectric { ior: 1.33, color: Rgb::ONE });
    assert_eq!(scene.spheres.material_of(0), 1);
    let of = |row: u32| scene.spheres.material[1..].iter().filter(|own| **own == row).count();
    assert!(of(0) > 90 && of(2) > 90 && of(3) > 90 && of(1) == 0);
}

#[test]
fn files_add_spheres_materials_and_warnings() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let csv = "x,y,z,radius,material\n1,2,3,4,b\n5,6,7,8,\n0,0,0,0,a\n";
    fs::write(folder.path().join("p.csv"), csv).expect("a file");
    let text = "[material.a]\nkind = \"lambertian\"\n[material.b]\nkind = \"lambertian\"\n\
                [[file]]\npath = \"p.csv\"\nmaterial = \"a\"\nscale = 0.5\n";
    let scene = Scene::parse(text, "s", folder.path()).expect("a scene");
    assert_eq!(scene.spheres.material, [1, 0]);
    assert_eq!(
        (&scene.spheres.x[..], &scene.spheres.radius[..]),
        (&[0.5, 2.5][..], &[2.0, 4.0][..])
    );
    assert_eq!(scene.warnings.len(), 1);
    let error = Scene::parse(&text.replace("material.b", "material.bb"), "s", folder.path());
    let error = error.expect_err("b is not there");
    assert!(error.message.contains("unknown material \"b\""), "{error}");
    assert_eq!((error.line(), error.help.as_deref()), (Some(6), Some("did you mean `bb`?")));
    let error = Scene::parse(&text.replace("p.csv", "q.csv"), "s", folder.path());
    assert_eq!(error.expect_err("no file").line(), Some(6));
}

#[test]
fn styles_are_of_particles_of_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let water = "3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n";
    fs::write(folder.path().join("water.xyz"), water).expect("a file");
    let parse = |styles: &str| {
        let text = format!(
            "[material.a]\nkind = \"plastic\"\n[[file]]\npath = \"water.xyz\"\nmaterial = \"a\"\n{styles}"
        );
        Scene::parse(&text, "s", folder.path())
    };
    let styles = "[[style]]\nselect = \"all\"\nmodel = \"licorice\"\nbond_radius = 0.1\n[[style]]\n\
                  select = \"element H\"\ncolor = \"red\"\nopacity = 0.5\n";
    let scene = parse(styles).expect("a scene");
    assert_eq!(scene.spheres.radius, [0.1; 3]);
    assert_eq!(scene.spheres.color[1..], [Rgb::X; 2]);
    assert_eq!(scene.sticks.len(), 4, "halves of two opacities");
    let material = |row: usize| &scene.materials[scene.spheres.material_of(row) as usize].material;
    assert!(matches!(material(0), Material::Plastic { .. }));
    assert_eq!([material(0).opacity(), material(1).opacity()], [1.0, 0.5]);
    let scene = parse("[[style]]\nselect = \"element H\"\nvisible = false\n").expect("a scene");
    assert_eq!(scene.spheres.len(), 1);
    let mapped = "[[style]]\nselect = \"all\"\ncolor = \"x\"\nmap = \"magma\"\nrange = [-1, 1]\n";
    assert_eq!(parse(mapped).expect("a scene").spheres.len(), 3);
    for (styles, message) in [
        ("[[style]]\n", "select"),
        ("[[style]]\nselect = \"z >\"\n", "expected a number or a name"),
        ("[[style]]\nselect = \"all\"\nmap = \"magma\"\n", "after color=COLUMN"),
        ("[[style]]\nselect = \"all\"\nmodel = \"balls\"\n", "model"),
        ("[[style]]\nselect = \"all\"\nrange = [0, 1]\n", "for colors by a column"),
        ("[[style]]\nselect = \"all\"\ncolor = \"x\"\nrange = [1, 0]\n", "the lower number"),
        ("[[style]]\nselect = \"all\"\ncolor = \"redd\"\n", "`redd`"),
    ] {
        let error = parse(styles).expect_err(styles);
        assert!(error.to_string().contains(message), "{styles}: {error}");
    }
    assert!(fault("[[style]]\nselect = \"all\"\n").message.contains("[[file]]"));
}

#[test]
fn every_scene_of_the_repository_parses() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut count = 0;
    for entry in fs::read_dir(folder).expect("the folder of scenes") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let scene = Scene::load(&path).unwrap_or_else(|error| panic!("{error}"));
            assert!(!scene.spheres.is_empty() && !scene.title.is_empty(), "{}", path.display());
            assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
            let text = fs::read_to_string(&path).expect("the scene's text");
            assert!(text.starts_with("# "), "{} has no description", path.display());
            count += 1;
        }
    }
    assert!(count >= 12, "{count}");
}

#[test]
fn standard_scenes_have_their_counts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let count = |name: &str| Scene::load(&folder.join(name)).map_or(0, |scene| scene.spheres.len());
    assert_eq!(count("sphereflake.toml"), 7381);
    assert_eq!(count("paper-grid-500.toml"), 250_000);
    assert_eq!(count("paper-field-20.toml"), 401);
    assert_eq!(count("smallpt.toml"), 9);
    assert!((474..=488).contains(&count("weekend.toml")));
}

#[test]
fn particles_are_a_scene_of_their_own() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("p.xyz");
    fs::write(&path, "2\nwater\nO 0 0 0\nH 1 0 0\n").expect("a file");
    let scene = Scene::from_particles(&path, &ReadOptions::default()).expect("a scene");
    assert_eq!((scene.spheres.len(), scene.title.as_str()), (2, "p.xyz"));
    assert_eq!(scene.spheres.radius, [1.5, 1.2]);
    assert_eq!((scene.materials.len(), scene.spheres.material_of(1)), (1, 0));
    assert!(matches!(scene.materials[0].material, Material::Lambertian { .. }));
    crate::scene::write(&scene, &folder.path().join("p.toml")).expect("it can be written");
    fs::write(&path, "x,y,z,r,material\n0,0,0,1,a\n0,0,0,1,\n0,0,0,1,b\n").expect("a file");
    let scene = Scene::from_particles(&path, &ReadOptions::default()).expect("a scene");
    let names: Vec<&str> = scene.materials.iter().map(|row| row.name.as_str()).collect();
    assert_eq!((names, scene.spheres.material), (vec!["particles", "a", "b"], vec![1, 0, 2]));
    assert!(matches!(scene.camera.pose, Pose::Fit { .. }));
}

#[test]
fn binary_files_are_reported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("s.toml");
    fs::write(&path, b"title = \"\xFF\"").expect("a file");
    assert!(Scene::load(&path).is_err_and(|error| error.message.contains("byte 9")));
    assert!(Scene::load(folder.path()).is_err());
    assert!(Scene::load(Path::new("none.toml")).is_err());
}
