//! Images of a sphere by pinhole and lens.

use crate::common::*;
use glam::DVec3;
use spherule_render::image::Image;
use spherule_render::scene::{Lens, Projection, Scene};

/// Returns a sphere that emits 1 at (x, 0, -z), seen from the origin along -z with tangents up to `tangent`.
fn emissive_sphere(radius: f64, z: f64, x: f64, tangent: f64) -> Scene {
    let mut scene = dark();
    sphere(&mut scene, [x, 0.0, -z], radius, emitter(1.0, 0.0));
    look(&mut scene, DVec3::ZERO, DVec3::NEG_Z, 2.0 * tangent.atan().to_degrees());
    (scene.settings.width, scene.settings.height) = (64, 64);
    scene.settings.spp = 16;
    scene
}

/// Returns sums over an image of 2 `half` by 2 `half`: of radiance, and of radiance times x and x squared.
fn moments(image: &Image, half: f64) -> [f64; 3] {
    let pixel = 2.0 * half / f64::from(image.width);
    let mut sums = [0.0; 3];
    for (i, value) in image.pixels.iter().enumerate() {
        let x = ((i as u32 % image.width) as f64 + 0.5) * pixel - half;
        let energy = f64::from(value[0]) * pixel * pixel;
        for (sum, power) in sums.iter_mut().zip([1.0, x, x * x]) {
            *sum += energy * power;
        }
    }
    sums
}

#[test]
fn a_pinhole_projects_a_sphere_to_an_ellipse() {
    let truths = [
        (1.0, 5.0, 0.0, 0.25, 0.130_899_693_9, 0.0),
        (1.0, 5.0, 2.0, 1.0, 0.141_387_828_9, 0.416_666_666_7),
        (1.0, 3.0, 3.0, 2.0, 0.572_452_363_6, 1.125),
        (1.0, 100.0, 0.0, 0.02, 3.141_906_844e-4, 0.0),
        (0.001, 10.0, 0.0, 2e-4, 3.141_592_685e-8, 0.0),
    ];
    for (radius, z, x, tangent, area, center) in truths {
        let scene = emissive_sphere(radius, z, x, tangent);
        let [seen, shifted, _] = each_over_seeds(&scene, |image| moments(image, tangent));
        assert_expected(seen, area, &format!("area, {radius} {z} {x}"));
        assert_expected(shifted, area * center, &format!("center, {radius} {z} {x}"));
    }
}

/// A point blurs to a disc of diameter A |D - S| / D in the focal plane, with variance diameter^2 / 16. If
/// the whole disc is in the image, no energy is lost.
#[test]
fn a_thin_lens_blurs_by_its_diameter() {
    let (aperture, focus) = (0.1, 2.0);
    for distance in [1.0, 4.0, 1000.0, 2.0] {
        // The same size in the image at all distances.
        let tangent = 0.04;
        let mut scene = emissive_sphere(0.004 * distance, distance, 0.0, tangent);
        let energy_and_variance = |image: &Image| {
            let [energy, _, second] = moments(image, tangent);
            [energy, second / energy]
        };
        let sharp = each_over_seeds(&scene, energy_and_variance);
        scene.camera.lens = Some(Lens { aperture, focus: Some(focus) });
        let blurred = each_over_seeds(&scene, energy_and_variance);
        assert_agree(blurred[0], sharp[0], &format!("energy at {distance}"));
        // Variances of independent offsets add.
        let added = Estimate {
            mean: blurred[1].mean - sharp[1].mean,
            error: blurred[1].error.hypot(sharp[1].error),
        };
        let diameter = aperture * (distance - focus).abs() / distance / focus;
        assert_expected(added, diameter.powi(2) / 16.0, &format!("variance at {distance}"));
    }
}

#[test]
fn a_zero_aperture_is_a_pinhole() {
    let mut scene = emissive_sphere(1.0, 3.0, 0.5, 1.0);
    let pinhole = render_scene(&scene).image;
    scene.camera.lens = Some(Lens { aperture: 0.0, focus: None });
    assert_eq!(render_scene(&scene).image, pinhole);
    assert!(matches!(scene.camera.projection, Projection::Perspective { .. }));
}
