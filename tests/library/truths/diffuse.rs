//! Diffuse spheres under lights and skies.

use crate::common::*;
use glam::DVec3;
use spherule_render::scene::{Integrator, Light, Rgb};
use std::f64::consts::PI;

#[test]
fn a_sphere_under_a_gradient() {
    let truths = [
        (0.0, 0.833_333_333_3),
        (45.0, 0.735_702_260_4),
        (90.0, 0.5),
        (135.0, 0.264_297_739_6),
        (180.0, 0.166_666_666_7),
    ];
    for (degrees, truth) in truths {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let normal = DVec3::new(sin, 0.0, cos);
        let mut scene = dark();
        scene.environment.map = gradient();
        sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
        assert_expected(probe(&mut scene, normal, normal * 3.0), truth, &format!("{degrees}"));
        scene.settings.integrator = Integrator::Whitted { shadow_samples: 16 };
        scene.settings.spp = 4;
        assert_expected(measure(&scene), truth, &format!("{degrees}, whitted"));
    }
}

/// The phase function of a diffuse sphere, without noise except in pixels on the limb and the terminator.
#[test]
fn the_phases_of_a_sphere() {
    let truths = [
        (0.0, 0.666_666_666_7),
        (30.0, 0.587_228_519_7),
        (60.0, 0.405_998_520_7),
        (90.0, 0.212_206_590_8),
        (120.0, 0.072_665_187_4),
        (150.0, 0.009_878_250_5),
    ];
    for (degrees, truth) in truths {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let mut scene = dark();
        sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
        scene.lights.push(Light::Sun {
            direction: DVec3::new(sin, 0.0, cos),
            irradiance: Rgb::splat(PI as f32),
            angular_radius: 0.0,
        });
        look_parallel(&mut scene, DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 2.0);
        let disc = over_seeds(&scene, mean).times(4.0 / PI);
        assert_expected(disc, truth, &format!("{degrees}"));
    }
}

/// In the middle column, seen from the side, equal heights are equal areas of a sphere. So the mean is that
/// over the surface, which is the view factor.
#[test]
fn view_factors_between_spheres() {
    let truths = [
        (1.0, 4.0, 0.016_156_244_4),
        (1.0, 2.0, 0.075_586_818_4),
        (0.5, 3.0, 0.007_207_480_7),
        (0.01, 10.0, 2.506_282_081e-7),
    ];
    for (radius, distance, truth) in truths {
        let mut scene = dark();
        sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
        sphere(&mut scene, [0.0, distance, 0.0], radius, emitter(1.0, 0.0));
        look_parallel(&mut scene, DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 2.0);
        (scene.settings.width, scene.settings.height) = (1, 512);
        scene.settings.depth = Some(1);
        assert_expected(over_seeds(&scene, mean), truth, &format!("{radius} at {distance}"));
    }
}
