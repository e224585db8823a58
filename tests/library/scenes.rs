//! Scenes of `scenes/` and its gallery: all render, and some have known images.

use glam::DVec3;
use spherule_render::render::{Options, Render, render};
use spherule_render::scene::particles::{
    self, ParticleStyle, Particles, ReadOptions, TypeMaterial,
};
use spherule_render::scene::{Integrator, Preset, Rgb, Scene};
use spherule_render::world::World;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Returns a scene of the folder with a small image.
fn picture(path: &Path, (width, height): (u32, u32), spp: u32) -> Render {
    let mut scene = Scene::load(path).unwrap_or_else(|error| panic!("{error}"));
    (scene.settings.width, scene.settings.height) = (width, height);
    scene.settings.spp = spp;
    let world = World::build(&scene).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    render(&world, &scene.settings, &Options::default()).expect("settings in range")
}

#[test]
fn every_scene_renders_and_shows_something() {
    let mut count = 0;
    let entries = |path: PathBuf| std::fs::read_dir(path).expect("the folder is there").flatten();
    for entry in entries(folder()).chain(entries(folder().join("gallery"))) {
        let path = entry.path();
        if path.extension().is_some_and(|suffix| suffix == "toml") {
            let Render { image, counters, .. } = picture(&path, (40, 30), 2);
            assert_eq!(counters.bad_samples, 0, "{}", path.display());
            let values = || image.pixels.iter().flatten();
            assert!(values().all(|v| v.is_finite() && *v >= 0.0), "{}", path.display());
            assert!(values().any(|v| *v > 0.01), "{} is black", path.display());
            count += 1;
        }
    }
    assert!(count >= 14, "{count} scenes");
}

#[test]
fn every_preset_makes_a_world() {
    for preset in Preset::ALL {
        let mut scene = Scene::of_particles(Particles::default(), "");
        scene.spheres.push(DVec3::new(3.0, 4.0, 5.0), 1.0, 0, Rgb::X);
        scene.spheres.push(DVec3::new(3.0, 8.0, 5.0), 2.0, 0, Rgb::Y);
        preset.replace_materials(&mut scene);
        preset.set(&mut scene);
        preset.light(&mut scene, DVec3::Y);
        let world = World::build(&scene).expect("a world");
        assert_eq!(world.ground.is_some(), preset == Preset::Studio);
        let ao = matches!(scene.settings.integrator, Integrator::Ao { .. });
        assert_eq!(ao, matches!(preset, Preset::Chalk | Preset::XRay));
    }
}

#[test]
fn every_material_of_types_is_one_of_the_scene() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("water.xyz");
    std::fs::write(&path, "3\nwater\nO 0 0 0\nH 1 0 0\nH 0 1 0\n").expect("a file");
    for (name, material) in TypeMaterial::ALL {
        assert_eq!(material.name(), name);
        let types = vec![format!("H:material={name}").parse().expect("a valid style")];
        let style = ParticleStyle { types, ..ParticleStyle::default() };
        let mut particles = particles::read(&path, &ReadOptions::default()).expect("particles");
        style.apply(&path, &mut particles).expect("a style for water");
        let scene = Scene::of_particles(particles, "water");
        assert!(World::build(&scene).is_ok(), "{name}");
    }
}

/// A background hides the sky and the suns behind a sphere, and nothing else: not their light, their images
/// in mirrors, or the ground.
#[test]
fn backgrounds_are_seen_and_do_not_light() {
    let text = "[camera]\nprojection = \"orthographic\"\nheight = 4\neye = [0, 0, 5]\n\
                target = [0, 0, 0]\n[environment]\nkind = \"gradient\"\n\
                [[light]]\nkind = \"sun\"\ndirection = [0, 0.2, -1]\nirradiance = 2\n\
                angular_radius = 60\n[material.mirror]\nkind = \"conductor\"\ncolor = 0.9\n\
                [[sphere]]\ncenter = [-0.9, 0, 0]\nradius = 0.8\n\
                [[sphere]]\ncenter = [0.9, 0, 0]\nradius = 0.8\nmaterial = \"mirror\"\n";
    for (integrator, ground) in ["path", "whitted", "ao"]
        .into_iter()
        .flat_map(|name| ["", "[ground]\nheight = -1\n"].map(|ground| (name, ground)))
    {
        let image = |look: &str| {
            let text = format!(
                "[render]\nsize = [80, 60]\nspp = 4\nfilter = \"box\"\nintegrator = \
                 \"{integrator}\"\n{look}\n{text}{ground}"
            );
            let scene = Scene::parse(&text, "test", Path::new("")).expect("a scene");
            let world = World::build(&scene).expect("a world");
            render(&world, &scene.settings, &Options::default()).expect("settings").image
        };
        let (sky, blue) = (image(""), image("[look]\nbackground = [0, 0, 1]"));
        for y in 0..60 {
            for x in 0..80 {
                let (seen, other) = (blue.pixel(x, y), sky.pixel(x, y));
                let near =
                    |column: f64| (f64::from(x) + 0.5 - column).hypot(f64::from(y) + 0.5 - 30.0);
                let nearest = near(26.5).min(near(53.5));
                if nearest < 11.0 {
                    assert_eq!(seen, other, "{integrator} {x} {y}");
                } else if nearest > 13.0 && ground.is_empty() {
                    assert_eq!(seen, Some([0.0, 0.0, 1.0]), "{integrator} {x} {y}");
                }
            }
        }
    }
}

#[test]
fn glass_shows_the_background_behind_it() {
    for integrator in ["path", "whitted"] {
        let text = format!(
            "[render]\nsize = [40, 40]\nspp = 16\nintegrator = \"{integrator}\"\n\
             [look]\nbackground = [0, 0, 1]\n[environment]\ncolor = 0.25\n\
             [camera]\nprojection = \"orthographic\"\n\
             [material.glass]\nkind = \"dielectric\"\n\
             [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"glass\"\n"
        );
        let scene = Scene::parse(&text, "test", Path::new("")).expect("a scene");
        let world = World::build(&scene).expect("a world");
        let image = render(&world, &scene.settings, &Options::default()).expect("settings").image;
        for pixel in &image.pixels {
            let near = pixel.iter().zip([0.0, 0.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near, "{integrator} {pixel:?}");
        }
    }
}

#[test]
fn the_quartz_of_the_gallery_is_complete() {
    let path = folder().join("gallery/quartz.cif");
    let read = particles::read(&path, &ReadOptions::default()).expect("a crystal");
    let (spheres, cell) = (read.spheres, read.frame.cell.expect("a cell"));
    assert_eq!(spheres.len(), 9);
    // Every silicon has four oxygen neighbors at 1.60 to 1.62 angstrom, also across faces.
    for silicon in 0..3 {
        let bond = |oxygen: usize, shift: usize| {
            let neighbor = [shift % 3, shift / 3 % 3, shift / 9].map(|share| share as f64 - 1.0);
            let shift = cell.cartesian(neighbor) - cell.origin;
            (spheres.center(oxygen) + shift).distance(spheres.center(silicon))
        };
        let bonds = (3..9).flat_map(|oxygen| (0..27).map(move |shift| bond(oxygen, shift)));
        let lengths: Vec<f64> = bonds.filter(|length| *length < 2.5).collect();
        assert!(lengths.len() == 4 && lengths.iter().all(|length| (1.60..1.62).contains(length)));
    }
}

#[test]
fn furnaces_give_their_closed_forms_exactly() {
    let outside = picture(&folder().join("furnace.toml"), (33, 33), 4).image;
    assert_eq!(outside.pixels[33 * 16 + 16], [0.8; 3], "the sphere's albedo");
    assert_eq!(outside.pixels[0], [1.0; 3], "the environment");
    let inside = picture(&folder().join("furnace-inside.toml"), (33, 33), 4).image;
    assert!(inside.pixels.iter().all(|pixel| *pixel == [1.0; 3]));
}

#[test]
fn a_mirror_in_a_gradient_sky_matches_its_closed_form() {
    let Render { image, .. } = picture(&folder().join("mirror-sky.toml"), (65, 65), 64);
    let middle = image.pixels[65 * 32 + 32];
    // Straight back: the horizon.
    assert!((middle[1] - 0.5).abs() < 1e-3, "{middle:?}");
    // The reflections of the sky above and below the center are symmetric.
    for row in 0..32 {
        let (above, below) =
            (image.pixels[65 * row + 32][1], image.pixels[65 * (64 - row) + 32][1]);
        assert!((above + below - 1.0).abs() < 5e-3, "row {row}: {above} {below}");
    }
}
