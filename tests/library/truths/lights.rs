//! Direct light on a plane: spheres, points and suns, by both integrators.

use crate::common::*;
use glam::DVec3;
use spherule_render::scene::{Integrator, Light, LightChoice, Material, Rgb, Scene, Settings};
use std::f64::consts::PI;

const WHITTED: Integrator = Integrator::Whitted { shadow_samples: 16 };

/// White ground with direct light only.
fn receiver() -> Scene {
    let mut scene = dark();
    ground(&mut scene, lambertian(1.0));
    scene.settings.depth = Some(1);
    scene
}

/// Returns the radiance of the ground at the origin, seen from `eye`, by both integrators.
#[track_caller]
fn assert_at_origin(scene: &mut Scene, eye: DVec3, truth: f64, what: &str) {
    scene.settings.integrator = Integrator::Path;
    assert_expected(probe(scene, DVec3::ZERO, eye), truth, what);
    scene.settings.integrator = WHITTED;
    scene.settings.spp /= 8;
    assert_expected(measure(scene), truth, &format!("{what}, whitted"));
    scene.settings.spp *= 8;
}

#[test]
fn irradiance_of_a_sphere() {
    let truths = [
        (1.0, 3.0, 0.0, 0.111_111_111_1),
        (1.0, 3.0, 60.0, 0.055_555_555_6),
        (1.0, 2.0, 50.0, 0.160_696_902_4),
        (1.0, 2.0, 75.0, 0.070_410_427_0),
        (1.0, 2.0, 90.0, 0.028_834_442_8),
        (1.0, 2.0, 100.0, 0.011_283_772_0),
        (0.01, 10.0, 30.0, 8.660_254_038e-7),
        (1.0, 1.0001, 0.0, 0.999_800_030_0),
        (1.0, 1.0001, 90.0, 0.490_997_812_1),
        (1.0, 1.1, 120.0, 0.068_184_490_8),
    ];
    for (radius, distance, degrees, truth) in truths {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let mut scene = receiver();
        sphere(&mut scene, DVec3::new(sin, 0.0, cos) * distance, radius, emitter(1.0, 0.0));
        // Below a light that nearly touches the ground, and away from one to the side.
        let eye = DVec3::new(-5.0, 0.0, if degrees == 0.0 { 0.05 } else { 3.0 });
        assert_at_origin(&mut scene, eye, truth, &format!("{radius} {distance} {degrees}"));
    }
}

/// A spherical light behind a spherical occluder: the visible fraction of the disc.
#[test]
fn penumbra() {
    let truths = [
        (0.25, 0.2, 0.495_390_546_0),
        (0.25, 0.3, 0.715_247_977_3),
        (0.25, 0.4, 0.895_648_183_0),
        (0.25, 0.5, 0.999_947_304_2),
        (0.25, 0.6, 1.0),
        (0.2, 0.0, 0.36),
        (0.2, 0.15, 0.537_671_604_3),
        (0.26, 0.0, 0.0),
    ];
    for (radius, x, share) in truths {
        let mut scene = receiver();
        sphere(&mut scene, [0.0, 0.0, 10.0], 0.5, emitter(1.0, 0.0));
        sphere(&mut scene, [x, 0.0, 5.0], radius, lambertian(0.0));
        let truth = 0.0025 * share;
        assert_at_origin(&mut scene, DVec3::new(-3.0, 1.0, 2.0), truth, &format!("{radius} {x}"));
    }
}

#[test]
fn point_lights_fall_off_or_do_not() {
    let position = DVec3::new(1.0, 2.0, 3.0);
    let (distance, cosine) = (position.length(), 3.0 / position.length());
    for (falloff, factor) in [(true, distance.powi(-2)), (false, 1.0)] {
        let mut scene = receiver();
        scene.lights.push(Light::Point { position, intensity: Rgb::splat(7.0), falloff });
        let truth = 7.0 * factor * cosine / PI;
        assert_at_origin(&mut scene, DVec3::new(-3.0, 1.0, 2.0), truth, "no sphere");
        // The unit of length in the world differs from the scene's.
        sphere(&mut scene, [900.0, 0.0, 5.0], 1.0, lambertian(0.5));
        assert_at_origin(&mut scene, DVec3::new(-3.0, 1.0, 2.0), truth, "a large world");
    }
}

#[test]
fn suns_give_their_irradiance() {
    for angular_radius in [0.0, 0.25, 5.0, 30.0] {
        let mut scene = receiver();
        scene.lights.push(Light::Sun {
            direction: DVec3::new(0.6, 0.0, 0.8),
            irradiance: Rgb::ONE,
            angular_radius,
        });
        // A disc above the horizon gives its irradiance times the cosine to its center.
        let truth = 0.8 / PI;
        assert_at_origin(
            &mut scene,
            DVec3::new(-3.0, 1.0, 2.0),
            truth,
            &format!("{angular_radius}"),
        );
    }
}

/// A mirror shows the sun's disc with the radiance irradiance / (pi sin^2), and nothing around it.
#[test]
fn a_mirror_shows_the_sun() {
    let angle = 2.0_f64.to_radians();
    let radiance = 1.0 / (PI * angle.sin().powi(2));
    let mut scene = dark();
    ground(&mut scene, mirror());
    scene.lights.push(Light::Sun {
        direction: DVec3::new(0.6, 0.0, 0.8),
        irradiance: Rgb::ONE,
        angular_radius: 2.0,
    });
    for integrator in [Integrator::Path, WHITTED] {
        scene.settings.integrator = integrator;
        for (degrees, truth) in [(0.0, radiance), (1.9, radiance), (2.1, 0.0)] {
            // Rotated away from the mirrored direction in the plane of reflection.
            let turn = f64::to_radians(degrees);
            let view = DVec3::new(
                -0.6 * turn.cos() - 0.8 * turn.sin(),
                0.0,
                0.8 * turn.cos() - 0.6 * turn.sin(),
            );
            let estimate = probe(&mut scene, DVec3::ZERO, view * 3.0);
            assert_expected(estimate, truth, &format!("{degrees} {integrator:?}"));
        }
    }
}

/// All kinds of lights and of lit surfaces, by both integrators.
#[test]
fn path_and_whitted_agree_on_direct_light() {
    let plastic = Material::Plastic { color: Rgb::splat(0.7), ior: 1.5 };
    let reflective = Material::Reflective { color: Rgb::splat(0.9), diffuse: 0.6, mirror: 0.3 };
    for made_of in [lambertian(0.6), plastic, reflective] {
        let mut scene = dark();
        scene.environment.map = gradient();
        ground(&mut scene, made_of.clone());
        sphere(&mut scene, [0.0, 0.0, 1.0], 1.0, made_of.clone());
        sphere(&mut scene, [1.5, 0.5, 0.5], 0.5, made_of.clone());
        sphere(&mut scene, [-2.0, 0.0, 3.0], 0.4, emitter(10.0, 0.3));
        let at = |x, y, z| DVec3::new(x, y, z);
        scene.lights = vec![
            Light::Point { position: at(2.0, 2.0, 3.0), intensity: Rgb::splat(3.0), falloff: true },
            Light::Sun { direction: at(0.6, 0.0, 0.8), irradiance: Rgb::ONE, angular_radius: 3.0 },
        ];
        look(&mut scene, at(4.0, -4.0, 3.0), at(0.0, 0.0, 0.7), 40.0);
        scene.settings.depth = Some(1);
        let [path, whitted] = [(Integrator::Path, 256), (WHITTED, 16)].map(|(integrator, spp)| {
            scene.settings.integrator = integrator;
            scene.settings.spp = spp;
            over_seeds(&scene, mean)
        });
        assert_agree(path, whitted, &format!("{made_of:?}"));
    }
}

/// Many emitters, some of them close to surfaces: sampling one light at a time gives the sum over all lights.
#[test]
fn sampling_one_light_equals_the_sum_over_all() {
    let plastic = Material::Plastic { color: Rgb::splat(0.7), ior: 1.5 };
    for (count, made_of) in [(3, lambertian(0.6)), (40, lambertian(0.6)), (40, plastic)] {
        let mut scene = dark();
        ground(&mut scene, made_of.clone());
        sphere(&mut scene, [0.0, 0.0, 1.0], 1.0, made_of.clone());
        sphere(&mut scene, [1.5, 0.5, 0.5], 0.5, made_of.clone());
        for i in 0..count {
            let (turn, height) = (2.4 * f64::from(i), f64::from(i % 10) / 10.0);
            let at = DVec3::new(2.2 * turn.cos(), 2.2 * turn.sin(), 0.05 + 2.0 * height);
            sphere(&mut scene, at, 0.02 + 0.03 * height, emitter(1.0 + 20.0 * height as f32, 0.0));
        }
        let position = DVec3::new(2.0, 2.0, 3.0);
        scene.lights = vec![Light::Point { position, intensity: Rgb::splat(0.3), falloff: true }];
        look(&mut scene, DVec3::new(4.0, -4.0, 3.0), DVec3::new(0.0, 0.0, 0.7), 40.0);
        scene.settings.depth = Some(1);
        let [path, whitted] =
            [(Integrator::Path, 64), (Integrator::Whitted { shadow_samples: 1 }, 4)].map(
                |(integrator, spp)| {
                    scene.settings.integrator = integrator;
                    scene.settings.spp = spp;
                    over_seeds(&scene, mean)
                },
            );
        assert_agree(path, whitted, &format!("{count} {made_of:?}"));
    }
}

/// Returns emitters of very different sizes and powers above surfaces of several kinds, with a point light
/// and a sun.
fn crowd() -> Scene {
    let mut scene = dark();
    ground(&mut scene, lambertian(0.5));
    for i in 0..40_u32 {
        let place = DVec3::new(f64::from(i * 7 % 12) - 6.0, f64::from(i * 5 % 11) - 5.0, 2.0);
        let power = 0.25_f32 * f32::from(i as u8 % 7).exp();
        sphere(&mut scene, place, 0.05 + 0.02 * f64::from(i % 4), emitter(power, 0.25));
    }
    sphere(&mut scene, [0.0, 0.0, 1.0], 0.75, metal(0.5));
    sphere(&mut scene, [2.0, -2.0, 1.0], 0.75, Material::Plastic { color: Rgb::ONE, ior: 1.5 });
    sphere(&mut scene, [-2.0, 1.0, 1.0], 0.75, lambertian(0.75));
    let position = DVec3::new(1.0, -5.0, 3.0);
    let (direction, irradiance) = (DVec3::new(0.6, 0.0, 0.8), Rgb::splat(0.25));
    scene.lights = vec![
        Light::Point { position, intensity: Rgb::splat(4.0), falloff: true },
        Light::Sun { direction, irradiance, angular_radius: 2.0 },
    ];
    look(&mut scene, DVec3::new(4.0, -9.0, 6.0), DVec3::new(0.0, 0.0, 0.5), 45.0);
    (scene.settings.depth, scene.settings.spp) = (Some(3), 16);
    scene
}

#[test]
fn every_light_choice_has_the_same_expectation() {
    for scene in [crowd(), menagerie()] {
        let by = |light_choice| {
            let settings = Settings { light_choice, ..scene.settings.clone() };
            Scene { settings, ..scene.clone() }
        };
        let others = [by(LightChoice::Power), by(LightChoice::Uniform)];
        assert_scenes_agree_with(&by(LightChoice::Tree), &others, "by power, or all alike");
    }
}
