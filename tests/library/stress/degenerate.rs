//! Arrangements that builders cannot split, and extreme ratios of radii.

use crate::common::*;
use glam::DVec3;
use spherule_render::image::Image;
use spherule_render::render::Options;
use spherule_render::scene::{Rgb, Scene};
use spherule_render::trace::{Tracer, Traversal};

/// Returns spheres of one diffuse material under a white sky.
fn of_spheres(spheres: impl Iterator<Item = (DVec3, f64)>) -> Scene {
    let mut scene = furnace();
    material(&mut scene, lambertian(0.6));
    for (center, radius) in spheres {
        scene.spheres.push(center, radius, 0, Rgb::ONE);
    }
    look(&mut scene, DVec3::new(3.0, 2.0, 5.0), DVec3::ZERO, 40.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (16, 16, 4);
    scene.settings.depth = Some(3);
    scene
}

fn by_brute_force(scene: &Scene) -> Image {
    let tracer = Tracer { traversal: Traversal::Brute, ..Tracer::default() };
    render_scene_with(scene, &Options { tracer, ..Options::default() }).image
}

#[test]
fn the_tree_never_changes_the_picture() {
    let at = |i: i32| f64::from(i);
    let scenes =
        [
            ("identical", of_spheres((0..1000).map(|_| (DVec3::ZERO, 1.0)))),
            ("concentric", of_spheres((0..1000).map(|i| (DVec3::ZERO, 0.5 + at(i) / 2000.0)))),
            ("collinear", of_spheres((0..1000).map(|i| (DVec3::Y * (at(i) / 400.0 - 1.25), 0.02)))),
            (
                "coplanar",
                of_spheres((0..1024).map(|i| {
                    (DVec3::new(at(i % 32) / 16.0 - 1.0, 0.0, at(i / 32) / 16.0 - 1.0), 0.03125)
                })),
            ),
            (
                "lattice",
                of_spheres((0..1000).map(|i| {
                    (DVec3::new(at(i % 10), at(i / 10 % 10), at(i / 100)) / 5.0 - 0.9, 0.1)
                })),
            ),
        ];
    for (what, scene) in scenes {
        assert_eq!(render_scene(&scene).image, by_brute_force(&scene), "{what}");
    }
}

#[test]
fn few_spheres_equal_brute_force() {
    for count in (0..=9).chain(15..=17) {
        let scene = of_spheres((0..count).map(|i| {
            let angle = f64::from(i) * 2.4;
            (DVec3::new(angle.cos(), angle.sin(), 0.3 * angle.cos()), 0.3)
        }));
        let image = render_scene(&scene).image;
        assert_eq!(image, by_brute_force(&scene), "{count}");
        if count == 0 {
            assert_every_pixel(&image, 1.0, "nothing but sky");
        }
    }
}

#[test]
fn a_million_spheres_in_one_place() {
    const COUNT: u32 = 1_000_000;
    let small = |mut scene: Scene| {
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (4, 4, 1);
        look(&mut scene, DVec3::new(3.0, 2.0, 5.0), DVec3::ZERO, 25.0);
        render_scene(&scene).image
    };
    let one = small(of_spheres(std::iter::once((DVec3::ZERO, 1.0))));
    let identical = (0..COUNT).map(|_| (DVec3::ZERO, 1.0));
    assert_eq!(small(of_spheres(identical)), one, "identical");
    // Exact in single precision; the outermost is visible.
    let radius = |i: u32| f64::from(COUNT + 1 + i) / f64::from(2 * COUNT);
    let concentric = (0..COUNT).map(|i| (DVec3::ZERO, radius(i)));
    assert_eq!(small(of_spheres(concentric)), one, "concentric");
}

/// Small spheres on a huge sphere look as on a plane, also if they are stacked so high that the huge sphere's
/// center needs all digits.
#[test]
fn dust_on_a_giant() {
    let row: Vec<_> =
        (0..5).map(|i| DVec3::new(f64::from(i) * 2.5 - 5.0, f64::from(i % 2), 1.0)).collect();
    let tower: Vec<_> = (0..4).map(|i| DVec3::new(0.0, 0.0, f64::from(2 * i + 1))).collect();
    for (radius, size) in [(1e7, 1e-3), (1e7, 0.05), (1e5, 0.01), (1e5, 0.5)] {
        for (what, centers) in [("row", &row), ("tower", &tower)] {
            let scene = |plane: bool| {
                let mut scene = furnace();
                if plane {
                    ground(&mut scene, lambertian(0.5));
                } else {
                    sphere(&mut scene, [0.0, 0.0, -radius], radius, lambertian(0.5));
                }
                for center in centers {
                    sphere(&mut scene, *center * size, size, lambertian(0.9));
                }
                look(&mut scene, DVec3::new(6.0, -15.0, 9.0) * size, DVec3::Z * 2.0 * size, 40.0);
                scene.settings.depth = Some(3);
                (scene.settings.width, scene.settings.height) = (24, 24);
                scene.settings.spp = 4;
                scene
            };
            let what = format!("{what} of {size} on {radius}");
            assert_scenes_agree(&scene(false), &scene(true), &what);
        }
    }
}
