//! Scenes of `scenes/` and its gallery: all render, and some have known images.

use spherule_render::render::{Options, Render, render};
use spherule_render::scene::Scene;
use spherule_render::scene::particles::{self, ReadOptions};
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
fn the_quartz_of_the_gallery_is_complete() {
    let path = folder().join("gallery/quartz.cif");
    let read = particles::read(&path, &ReadOptions::default()).expect("a crystal");
    let (spheres, cell) = (read.spheres, read.cell.expect("a cell"));
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
