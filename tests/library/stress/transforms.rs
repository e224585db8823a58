//! Translated and scaled scenes.

use crate::common::*;
use glam::DVec3;
use spherule_render::World;
use spherule_render::render::{Options, render};
use spherule_render::scene::{Camera, Light, Pose, Projection, Scene};

/// Translates and then scales everything in a scene. Intensities with falloff scale with the square.
fn transformed(scene: &Scene, shift: DVec3, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let place = |p: DVec3| (p + shift) * factor;
    let spheres = &mut scene.spheres;
    for i in 0..spheres.len() {
        let center = place(spheres.center(i));
        (spheres.x[i], spheres.y[i], spheres.z[i]) = center.into();
        spheres.radius[i] *= factor;
    }
    for light in &mut scene.lights {
        if let Light::Point { position, intensity, falloff } = light {
            *position = place(*position);
            if *falloff {
                *intensity *= (factor * factor) as f32;
            }
        }
    }
    if let Some(ground) = &mut scene.ground {
        ground.height = (ground.height + ground.normal.dot(shift)) * factor;
    }
    scene.camera = camera(&scene.camera, place, factor);
    scene
}

fn camera(camera: &Camera, place: impl Fn(DVec3) -> DVec3, factor: f64) -> Camera {
    let mut camera = camera.clone();
    if let Pose::LookAt { eye, target } = camera.pose {
        camera.pose = Pose::LookAt { eye: place(eye), target: place(target) };
    }
    if let Projection::Orthographic { height: Some(height) } = &mut camera.projection {
        *height *= factor;
    }
    if let Some(lens) = &mut camera.lens {
        lens.aperture *= factor;
        lens.focus = lens.focus.map(|focus| focus * factor);
    }
    camera.near *= factor;
    camera
}

#[test]
fn scaling_by_a_power_of_two_changes_nothing() {
    let scene = menagerie();
    let image = render_scene(&scene).image;
    for exponent in [-60, -1, 1, 60] {
        let scaled = transformed(&scene, DVec3::ZERO, f64::from(exponent).exp2());
        assert!(render_scene(&scaled).image == image, "2^{exponent}");
    }
}

/// A camera that is set in an existing world gives the same image as a world that is built for it.
#[test]
fn a_world_is_the_same_through_another_camera() {
    let mut world = World::build(&menagerie()).expect("a valid scene");
    for (distance, fov) in [(0.1, 90.0), (7.0, 40.0), (9.0, 20.0), (100.0, 7.0), (9000.0, 0.1)] {
        let mut scene = menagerie();
        (scene.settings.width, scene.settings.height) = (19, 23);
        let direction = DVec3::new(0.3, -0.2, 1.0).normalize();
        look(&mut scene, DVec3::Z * 7.0 + direction * distance, DVec3::Z * 7.0, fov);
        assert!(world.set_camera(&scene).expect("a camera that sees something"));
        let picture =
            render(&world, &scene.settings, &Options::default()).expect("settings in range").image;
        assert!(picture == render_scene(&scene).image, "from {distance}");
    }
    let mut scene = menagerie();
    look(&mut scene, DVec3::Z * 1e9, DVec3::ZERO, 1e-6);
    assert!(!world.set_camera(&scene).expect("a camera that sees something"), "too far");
    look(&mut scene, DVec3::Z, DVec3::Z, 40.0);
    assert!(world.set_camera(&scene).is_err(), "a camera on its target");
}

/// Without lights with falloff, since an intensity of 1e60 overflows single precision.
#[test]
fn scaling_by_any_number_changes_nothing_but_rounding() {
    let mut scene = menagerie();
    scene.lights.retain(|light| !matches!(light, Light::Point { falloff: true, .. }));
    let expected = over_seeds(&scene, mean);
    for factor in [1e-30, 1e-3, 1e30, 1e38] {
        let scaled = transformed(&scene, DVec3::ZERO, factor);
        assert_agree(over_seeds(&scaled, mean), expected, &format!("{factor}"));
    }
}

/// If coordinates remain exact, and the translation is a multiple of the step by which the world translates
/// scenes, the image is equal byte for byte.
#[test]
fn a_scene_far_away_is_the_same() {
    let scene = menagerie();
    let far = DVec3::new(1.0, -3.0, 2.0) * 20.0_f64.exp2();
    assert!(render_scene(&transformed(&scene, far, 1.0)).image == render_scene(&scene).image);
    // The translated center of the scene is at another fraction of a unit.
    let moved = transformed(&scene, DVec3::new(1e6, -1e6, 1.7e6), 1.0);
    assert_agree(over_seeds(&moved, mean), over_seeds(&scene, mean), "1e6");
}

#[test]
fn a_furnace_far_away_is_a_furnace() {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
    sphere(&mut scene, [2.0, 0.0, 0.0], 1.0, glass(1.5));
    sphere(&mut scene, [0.0, 2.0, 0.0], 1.0, mirror());
    look(&mut scene, DVec3::new(4.0, 5.0, 6.0), DVec3::ZERO, 40.0);
    for shift in [1e3, 1e6, 1e9] {
        let moved = transformed(&scene, DVec3::splat(shift), 1.0);
        assert_every_pixel(&render_scene(&moved).image, 1.0, &format!("{shift}"));
    }
}

#[test]
fn radii_from_denormal_to_the_largest() {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1e38, emitter(0.5, 0.0));
    sphere(&mut scene, [3.0, 0.0, 0.0], 1.0, lambertian(0.0));
    look(&mut scene, DVec3::ZERO, DVec3::NEG_X, 90.0);
    assert_every_pixel(&render_scene(&scene).image, 0.5, "inside 1e38");
    look(&mut scene, DVec3::ZERO, DVec3::X, 20.0);
    assert_every_pixel(&render_scene(&scene).image, 0.0, "a sphere of 1 inside 1e38");

    for radius in [1e-38, 1e-44, 1e-300] {
        let mut scene = furnace();
        scene.environment.map = gradient();
        sphere(&mut scene, [0.25, 0.5, 0.0], radius, mirror());
        sphere(&mut scene, [0.25, 0.5, -2.0], 1.0, lambertian(0.0));
        look(&mut scene, DVec3::new(0.25, 0.5, 4.0), DVec3::new(0.25, 0.5, 0.0), 10.0);
        assert_every_pixel(&render_scene(&scene).image, 0.0, &format!("{radius}"));
        // The field of view is so narrow that every ray passes the center, and hits the sphere if it exists.
        look_parallel(&mut scene, DVec3::new(0.25, 0.5, 4.0), DVec3::new(0.25, 0.5, 0.0), 1e-60);
        let image = render_scene(&scene).image;
        let hit = if radius < 1e-45 { 0.0 } else { 1.0 };
        assert_every_pixel(&image, hit, &format!("{radius}, in the middle"));
    }
}
