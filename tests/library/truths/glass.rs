//! Glass spheres: Fresnel reflectance, and all internal reflections in a gradient.

use crate::common::*;
use glam::DVec3;
use spherule_render::scene::LightChoice;
use std::f64::consts::PI;

/// Returns the Fresnel reflectance of glass.
fn fresnel(cosine: f64, ior: f64) -> f64 {
    let refracted = (1.0 - (1.0 - cosine * cosine) / (ior * ior)).sqrt();
    let s = (cosine - ior * refracted) / (cosine + ior * refracted);
    let p = (refracted - ior * cosine) / (refracted + ior * cosine);
    0.5 * (s * s + p * p)
}

/// Returns the point of the unit sphere that a ray along -z hits at this distance from the axis.
fn at_impact(impact: f64) -> DVec3 {
    DVec3::new(impact, 0.0, (1.0 - impact * impact).sqrt())
}

/// With one bounce, only outside reflections reach the sky; with two, paths through the sphere as well.
#[test]
fn one_interface_and_two() {
    let truths = [
        (30.0, 0.041_522_626_0),
        (45.0, 0.050_239_911_0),
        (60.0, 0.089_186_712_8),
        (75.0, 0.253_060_563_0),
        (85.0, 0.612_799_645_3),
        (89.0, 0.904_184_949_8),
    ];
    let mut scene = furnace();
    scene.settings.spp = 256;
    sphere(&mut scene, [0.0; 3], 1.0, glass(1.5));
    for (degrees, reflected) in truths {
        let cosine = f64::to_radians(degrees).cos();
        assert!(within(fresnel(cosine, 1.5), reflected, 1.0, 1e-10));
        let point = at_impact(f64::to_radians(degrees).sin());
        for (depth, truth) in [(1, reflected), (2, reflected + (1.0 - reflected).powi(2))] {
            scene.settings.depth = Some(depth);
            let estimate = probe(&mut scene, point, point + DVec3::Z * 2.0);
            assert_expected(estimate, truth, &format!("{degrees} degrees, depth {depth}"));
        }
    }
}

/// Returns the radiance of a glass sphere at an impact parameter under the sky (1 + z) / 2, seen along -z.
///
/// An outside reflection deflects the ray by pi - 2 i, two refractions by 2 (i - t), and each reflection
/// inside adds pi - 2 t: a geometric series of deflections, weighted by Fresnel factors.
fn in_gradient(impact: f64, ior: f64) -> f64 {
    let (i, t) = (impact.asin(), (impact / ior).asin());
    let reflected = fresnel(i.cos(), ior);
    let mut sum = reflected * (PI - 2.0 * i).cos();
    let mut share = (1.0 - reflected).powi(2);
    for bounce in 0..200 {
        sum += share * (2.0 * (i - t) + f64::from(bounce) * (PI - 2.0 * t)).cos();
        share *= reflected;
    }
    (1.0 - sum) / 2.0
}

#[test]
fn a_glass_sphere_in_a_gradient() {
    let mut scene = dark();
    scene.environment.map = gradient();
    scene.settings.spp = 256;
    let truths = [
        (1.5, 0.0, 0.076_923_076_9),
        (1.5, 0.25, 0.081_057_899_5),
        (1.5, 0.5, 0.099_431_487_2),
        (1.5, 0.75, 0.163_421_837_2),
        (1.5, 0.9, 0.279_222_679_2),
        (1.5, 0.99, 0.311_122_157_2),
        (1.33, 0.0, 0.039_329_697_7),
        (2.4, 0.0, 0.289_940_828_4),
    ];
    for (ior, impact, truth) in truths {
        assert!(within(in_gradient(impact, ior), truth, 1.0, 1e-9), "{ior} {impact}");
        scene.spheres = spherule_render::scene::Spheres::default();
        sphere(&mut scene, [0.0; 3], 1.0, glass(ior));
        let point = at_impact(impact);
        let estimate = probe(&mut scene, point, point + DVec3::Z * 2.0);
        assert_expected(estimate, truth, &format!("ior {ior}, impact {impact}"));
    }
}

#[test]
fn the_disc_of_a_glass_sphere_in_a_gradient() {
    for (ior, truth) in [(1.33, 0.116_625_299_1), (1.5, 0.174_955_296_4), (2.4, 0.359_124_623_8)] {
        let mut scene = dark();
        scene.environment.map = gradient();
        sphere(&mut scene, [0.0; 3], 1.0, glass(ior));
        look_parallel(&mut scene, DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 2.0);
        let disc = over_seeds(&scene, mean).times(4.0 / PI);
        assert_expected(disc, truth, &format!("{ior}"));
    }
}

/// A bubble in glass around the camera, and glass that only surrounds it: with equal indices they are
/// invisible.
#[test]
fn equal_indices_do_not_refract() {
    let mut scene = dark();
    scene.environment.map = gradient();
    scene.settings.spp = 256;
    sphere(&mut scene, [0.0; 3], 1.0, glass(1.5));
    sphere(&mut scene, [0.1, 0.0, 0.2], 0.5, glass(1.5));
    sphere(&mut scene, [0.5, 0.2, -0.2], 0.3, glass(1.5));
    let point = at_impact(0.5);
    let estimate = probe(&mut scene, point, point + DVec3::Z * 2.0);
    assert_expected(estimate, in_gradient(0.5, 1.5), "nested spheres of one index");
}

/// A surface of glass inside of a smaller glass sphere is no interface. Light samples don't pass it, but paths do: a sphere of
/// radius 0.3 lights a point at a distance of 0.8 as in air.
#[test]
fn light_from_behind_a_surface_inside_of_other_glass_is_found() {
    for light_choice in [LightChoice::Tree, LightChoice::Power, LightChoice::Uniform] {
        let mut scene = dark();
        sphere(&mut scene, [-0.5, 0.0, 0.0], 0.2, lambertian(0.5));
        sphere(&mut scene, [0.5, 0.0, 0.0], 0.3, emitter(1.0, 0.0));
        sphere(&mut scene, [0.0; 3], 1.0, glass(1.0));
        sphere(&mut scene, [1.2, 0.0, 0.0], 1.2, glass(1.0));
        scene.settings.light_choice = light_choice;
        let eye = DVec3::new(-0.1, 0.3, 0.0);
        let found = probe(&mut scene, DVec3::new(-0.3, 0.0, 0.0), eye);
        assert_expected(found, 0.5 * 0.3 * 0.3 / 0.64, &format!("{light_choice:?}"));
    }
}
