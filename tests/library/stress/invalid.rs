//! Invalid scenes that code can build but files cannot contain: errors that name the problem, never panics.

use crate::common::*;
use glam::DVec3;
use spherule_render::scene::{
    BRIGHTEST, EnvironmentMap, Ground, Integrator, Lens, Light, Material, Pose, Projection, Rgb,
    Roulette, Scene,
};
use spherule_render::{Image, World};
use std::sync::Arc;

/// Asserts that building the world of an invalid scene is an error whose message contains `what`.
#[track_caller]
fn assert_refused(what: &str, spoil: impl FnOnce(&mut Scene)) {
    let mut scene = dark();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
    assert!(World::build(&scene).is_ok());
    spoil(&mut scene);
    let error = World::build(&scene).err().unwrap_or_else(|| panic!("{what} was accepted"));
    assert!(error.to_string().contains(what), "{error}, not {what}");
}

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

#[test]
fn invalid_spheres() {
    for bad in BAD {
        assert_refused("sphere 0", |scene| scene.spheres.x[0] = bad);
        assert_refused("sphere 0", |scene| scene.spheres.radius[0] = bad);
    }
    assert_refused("sphere 0", |scene| scene.spheres.radius[0] = 0.0);
    assert_refused("sphere 0", |scene| scene.spheres.radius[0] = -1.0);
    assert_refused("columns", |scene| scene.spheres.y.clear());
    assert_refused("columns", |scene| scene.spheres.material = vec![0; 2]);
    assert_refused("material 1 ", |scene| scene.spheres.material = vec![1]);
    assert_refused("color", |scene| scene.spheres.color = vec![Rgb::splat(1.5)]);
}

#[test]
fn invalid_cameras() {
    for fov in [0.0, -40.0, 180.0, 200.0, f64::NAN] {
        let projection = Projection::Perspective { fov };
        assert_refused("`fov`", |scene| scene.camera.projection = projection);
    }
    for height in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let projection = Projection::Orthographic { height: Some(height) };
        assert_refused("height", |scene| scene.camera.projection = projection);
    }
    for bad in BAD {
        let eye = DVec3::new(0.0, bad, 3.0);
        let pose = Pose::LookAt { eye, target: DVec3::ZERO };
        assert_refused("camera", |scene| scene.camera.pose = pose);
        assert_refused("up", |scene| scene.camera.up = eye);
    }
    assert_refused("target", |scene| {
        scene.camera.pose = Pose::LookAt { eye: DVec3::ONE, target: DVec3::ONE };
    });
    for (aperture, focus, what) in
        [(-1.0, None, "aperture"), (f64::NAN, None, "aperture"), (0.1, Some(0.0), "focus")]
    {
        assert_refused(what, |scene| scene.camera.lens = Some(Lens { aperture, focus }));
    }
    assert_refused("near", |scene| scene.camera.near = -1.0);
    assert_refused("no spheres", |scene| {
        scene.spheres = spherule_render::scene::Spheres::default();
        scene.camera.pose = Pose::Fit { direction: DVec3::X, margin: 0.0 };
    });
}

#[test]
fn settings_out_of_range() {
    for (width, height) in [(0, 4), (4, 0), (65_536, 1)] {
        assert_refused("`size`", |scene| {
            (scene.settings.width, scene.settings.height) = (width, height);
        });
    }
    assert_refused("`spp`", |scene| scene.settings.spp = 0);
    for p in [0.0, -0.5, 1.5, f64::NAN] {
        assert_refused("roulette", |scene| scene.settings.roulette = Roulette::Fixed(p));
    }
    assert_refused("`shadow_samples`", |scene| {
        scene.settings.integrator = Integrator::Whitted { shadow_samples: 0 };
    });
    assert_refused("`ao_distance`", |scene| {
        scene.settings.integrator = Integrator::Ao { distance: -1.0 };
    });
}

#[test]
fn lights_and_skies_that_are_not_finite_or_too_bright() {
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let bad = Rgb::new(1.0, bad, 1.0);
        assert_refused("sun", |scene| {
            let direction = DVec3::Z;
            scene.lights = vec![Light::Sun { direction, irradiance: bad, angular_radius: 0.0 }];
        });
        assert_refused("point light", |scene| {
            let position = DVec3::Z;
            scene.lights = vec![Light::Point { position, intensity: bad, falloff: true }];
        });
        assert_refused("environment", |scene| {
            scene.environment.map = EnvironmentMap::Constant(bad);
        });
        assert_refused("material", |scene| {
            sphere(scene, [3.0; 3], 1.0, Material::Emitter { radiance: bad, albedo: Rgb::ZERO });
        });
    }
    let bright = Rgb::splat(BRIGHTEST * 2.0);
    assert_refused("environment", |scene| scene.environment.map = EnvironmentMap::Constant(bright));
    assert_refused("material", |scene| {
        sphere(scene, [3.0; 3], 1.0, Material::Emitter { radiance: bright, albedo: Rgb::ZERO });
    });
    assert_refused("picture", |scene| {
        let image = Arc::new(Image { width: 1, height: 1, pixels: vec![[BRIGHTEST, 0.0, 0.0]] });
        let up = DVec3::Z;
        scene.environment.map = EnvironmentMap::Picture { image, up, rotation: 0.0, scale: 2.0 };
    });
    assert_refused("length 1", |scene| {
        let (direction, irradiance) = (DVec3::Z * 2.0, Rgb::ONE);
        scene.lights = vec![Light::Sun { direction, irradiance, angular_radius: 1.0 }];
    });
}

#[test]
fn materials_that_create_energy() {
    for albedo in [1.01, -0.1, f32::NAN] {
        assert_refused("material", |scene| sphere(scene, [3.0; 3], 1.0, lambertian(albedo)));
    }
    assert_refused("material", |scene| sphere(scene, [3.0; 3], 1.0, glass(0.0)));
    assert_refused("material", |scene| sphere(scene, [3.0; 3], 1.0, metal(1.5)));
    assert_refused("material", |scene| {
        let reflective = Material::Reflective { color: Rgb::ONE, diffuse: 0.6, mirror: 0.6 };
        sphere(scene, [3.0; 3], 1.0, reflective);
    });
    for made_of in [glass(1.5), emitter(1.0, 0.0)] {
        assert_refused("ground", |scene| ground(scene, made_of));
    }
    assert_refused("ground", |scene| {
        scene.ground = Some(Ground { normal: DVec3::ONE, height: 0.0, material: 0 });
    });
}
