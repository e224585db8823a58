//! Caustics have the same expected value with and without caustic sampling.

use crate::common::*;
use glam::DVec3;
use spherule_render::image::Image;
use spherule_render::scene::{Integrator, Light, Material, Rgb, Scene, Settings};

/// Blocks of an image along each axis.
const BLOCKS: usize = 4;

/// Returns a ground under an emitter.
fn lit() -> Scene {
    let mut scene = dark();
    ground(&mut scene, lambertian(0.7));
    sphere(&mut scene, [1.5, 1.0, 4.0], 0.8, emitter(20.0, 0.3));
    look(&mut scene, DVec3::new(0.0, -7.0, 4.0), DVec3::new(0.0, 0.0, 0.3), 35.0);
    scene.settings.depth = Some(6);
    scene
}

fn plastic() -> Material {
    Material::Plastic { color: Rgb::splat(0.5), ior: 1.5 }
}

fn red_glass() -> Material {
    Material::Dielectric { ior: 1.7, color: Rgb::new(0.8, 0.3, 0.3) }
}

/// Returns the means of the blocks.
fn blocks(image: &Image) -> [f64; BLOCKS * BLOCKS] {
    let (width, height) = (image.width as usize, image.height as usize);
    let mut sums = [0.0; BLOCKS * BLOCKS];
    for (place, pixel) in image.pixels.iter().enumerate() {
        let (x, y) = (place % width * BLOCKS / width, place / width * BLOCKS / height);
        sums[BLOCKS * y + x] += f64::from(pixel[0]);
    }
    sums.map(|sum| sum * (BLOCKS * BLOCKS) as f64 / (width * height) as f64)
}

/// Asserts that all blocks have the same mean with and without caustic sampling, and that sampling changes
/// the image.
#[track_caller]
fn assert_unbiased(scene: &Scene, what: &str) {
    let mut chance = scene.clone();
    chance.settings.caustics = false;
    assert_ne!(render_scene(scene).image.pixels, render_scene(&chance).image.pixels, "{what}");
    let pairs = each_over_seeds(scene, blocks).into_iter().zip(each_over_seeds(&chance, blocks));
    for (block, (looked, found)) in pairs.enumerate() {
        assert_agree(looked, found, &format!("{what}, block {block}"));
    }
}

#[test]
fn one_specular_sphere_of_each_kind() {
    let kinds =
        [("mirror", mirror()), ("glass", glass(1.5)), ("red", red_glass()), ("coat", plastic())];
    for (what, kind) in kinds {
        for height in [1.0, 1.8] {
            let mut scene = lit();
            sphere(&mut scene, [0.0, 0.0, height], 1.0, kind.clone());
            assert_unbiased(&scene, &format!("{what} at {height}"));
        }
    }
}

#[test]
fn several_specular_spheres_emitters_and_occluders() {
    let mut scene = lit();
    sphere(&mut scene, [-1.3, 0.0, 1.0], 1.0, mirror());
    sphere(&mut scene, [0.8, 0.0, 0.7], 0.7, glass(1.4));
    sphere(&mut scene, [-3.0, 1.0, 3.0], 0.5, emitter(30.0, 0.0));
    assert_unbiased(&scene, "two spheres and two emitters");
    sphere(&mut scene, [0.9, 0.3, 2.4], 0.4, lambertian(0.5));
    sphere(&mut scene, [0.2, -1.0, 0.3], 0.3, lambertian(0.9));
    assert_unbiased(&scene, "something in between");
}

#[test]
fn paths_reach_the_maximum_depth() {
    for depth in 2..5 {
        let mut scene = lit();
        sphere(&mut scene, [-1.0, 0.0, 1.0], 1.0, mirror());
        sphere(&mut scene, [1.1, 0.0, 1.0], 1.0, glass(1.5));
        scene.settings.depth = Some(depth);
        // Path tracing alone finds little of the light that a nearly transparent sphere reflects.
        scene.settings.spp = 128;
        assert_unbiased(&scene, &format!("depth {depth}"));
    }
}

/// Returns the same scene under a sun instead of an emitter.
fn sunny(mut scene: Scene) -> Scene {
    scene.materials[scene.spheres.material[0] as usize].material = lambertian(0.3);
    scene.lights.push(Light::Sun {
        direction: DVec3::new(0.5, -0.3, 0.8).normalize(),
        irradiance: Rgb::splat(3.0),
        angular_radius: 18.0,
    });
    scene
}

#[test]
fn suns_and_surfaces_of_every_kind() {
    for (what, kind) in [("mirror", mirror()), ("glass", glass(1.5)), ("coat", plastic())] {
        let mut scene = sunny(lit());
        sphere(&mut scene, [0.0, 0.0, 1.0], 1.0, kind);
        assert_unbiased(&scene, &format!("{what} under a sun"));
        sphere(&mut scene, [-1.6, -0.5, 0.6], 0.6, plastic());
        sphere(&mut scene, [1.4, -0.8, 0.5], 0.5, metal(0.3));
        sphere(&mut scene, [0.3, -1.7, 0.4], 0.4, red_glass());
        assert_unbiased(&scene, &format!("{what} among others"));
    }
}

#[test]
fn many_specular_spheres() {
    let mut scene = sunny(lit());
    scene.materials[scene.spheres.material[0] as usize].material = emitter(15.0, 0.2);
    let kinds = [mirror(), glass(1.5), plastic(), red_glass(), lambertian(0.6)];
    for place in 0..60 {
        let (x, y) = (f64::from(place % 10) - 4.5, f64::from(place / 10) - 2.5);
        let radius = 0.2 + 0.05 * f64::from(place * 7 % 5);
        sphere(&mut scene, [x, y, radius], radius, kinds[(place % 5) as usize].clone());
    }
    assert_unbiased(&scene, "sixty spheres");
}

/// Glass that touches, contains or cuts other things casts no caustics that are sampled; light that it
/// mirrors is.
#[test]
fn glass_that_does_not_stand_alone() {
    let mut nested = lit();
    sphere(&mut nested, [0.0, 0.0, 1.0], 1.0, glass(1.5));
    sphere(&mut nested, [0.0, 0.0, 1.0], 0.5, glass(1.3));
    let mut filled = lit();
    sphere(&mut filled, [0.0, 0.0, 1.0], 1.0, glass(1.5));
    sphere(&mut filled, [0.0, 0.0, 1.0], 0.5, lambertian(0.5));
    let mut sunk = lit();
    sphere(&mut sunk, [0.0, 0.0, 0.5], 1.0, glass(1.5));
    for (what, scene) in [("nested", nested), ("filled", filled), ("sunk", sunk)] {
        assert_unbiased(&scene, what);
        assert_unbiased(&sunny(scene), &format!("{what} under a sun"));
    }
}

/// Scenes to which caustic sampling does not apply.
#[test]
fn other_scenes_do_not_change() {
    let mut rough = lit();
    sphere(&mut rough, [0.0, 0.0, 1.0], 1.0, metal(0.2));
    let mut shallow = lit();
    sphere(&mut shallow, [0.0, 0.0, 1.0], 1.0, mirror());
    shallow.settings.depth = Some(0);
    let mut direct = lit();
    sphere(&mut direct, [0.0, 0.0, 1.0], 1.0, mirror());
    direct.settings.integrator = Integrator::Whitted { shadow_samples: 4 };
    for (case, scene) in [rough, shallow, direct].iter().enumerate() {
        let chance = Settings { caustics: false, ..scene.settings.clone() };
        let chance = Scene { settings: chance, ..scene.clone() };
        assert_eq!(
            render_scene(scene).image.pixels,
            render_scene(&chance).image.pixels,
            "case {case}"
        );
    }
}

#[test]
fn lights_that_the_camera_sees() {
    for (what, radius, aperture) in
        [("small", 0.5, 0.0), ("large", 1.0, 0.0), ("blurred", 0.7, 0.2)]
    {
        let mut scene = dark();
        ground(&mut scene, lambertian(0.5));
        sphere(&mut scene, [0.2, 3.0, 2.5], radius, emitter((2.0 / (radius * radius)) as f32, 0.0));
        sphere(&mut scene, [-1.5, 0.0, 0.9], 0.9, mirror());
        sphere(&mut scene, [0.4, -0.4, 0.8], 0.8, glass(1.5));
        sphere(&mut scene, [2.1, 0.0, 0.7], 0.7, plastic());
        look(&mut scene, DVec3::new(0.0, -8.0, 2.5), DVec3::new(0.2, 0.0, 1.2), 32.0);
        scene.camera.lens =
            (aperture > 0.0).then_some(spherule_render::scene::Lens { aperture, focus: None });
        assert_unbiased(&scene, what);
    }
}

#[test]
fn only_path_tracing_samples_them() {
    let mut scene = lit();
    sphere(&mut scene, [0.0, 0.0, 1.0], 1.0, glass(1.5));
    sphere(&mut scene, [-2.0, 0.5, 0.7], 0.7, plastic());
    scene.settings.integrator = Integrator::Whitted { shadow_samples: 2 };
    let with = render_scene(&scene).image.pixels;
    scene.settings.caustics = false;
    assert_eq!(with, render_scene(&scene).image.pixels);
}
