//! Mirrors and rough metals under skies.

use crate::common::*;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

#[test]
fn a_mirror_sphere_in_a_gradient() {
    let mut scene = dark();
    scene.environment.map = gradient();
    scene.settings.spp = 4;
    sphere(&mut scene, [0.0; 3], 1.0, mirror());
    for impact in [0.0_f64, 0.25, 0.5, 0.75, 0.9, 0.99] {
        let point = DVec3::new(impact, 0.0, (1.0 - impact * impact).sqrt());
        let estimate = probe(&mut scene, point, point + DVec3::Z * 2.0);
        assert_expected(estimate, 1.0 - impact * impact, &format!("{impact}"));
    }
}

/// Equal areas of the disc correspond to equal solid angles of reflected directions, so the mean is that of
/// the sky.
#[test]
fn a_mirror_sphere_shows_the_whole_sky() {
    let mut scene = dark();
    scene.environment.map = gradient();
    sphere(&mut scene, [0.0; 3], 1.0, mirror());
    // Black below, so only the disc contributes.
    look_parallel(&mut scene, DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 2.0);
    let disc = over_seeds(&scene, mean).times(4.0 / PI);
    assert_expected(disc, 0.5, "mean of the disc");
}

/// Returns the reflectance toward the angle `theta` of GGX with Smith's height-correlated masking and white
/// facets, by the midpoint rule over incident directions in double precision.
fn ggx_albedo(alpha: f64, theta: f64) -> f64 {
    let lambda = |tangent2: f64| ((1.0 + alpha * alpha * tangent2).sqrt() - 1.0) / 2.0;
    let outgoing = DVec3::new(theta.sin(), 0.0, theta.cos());
    let (steps_z, steps_phi) = (2000, 1000);
    let mut sum = 0.0;
    for i in 0..steps_z {
        // Uniform in the angle, to resolve the horizon.
        let angle = (f64::from(i) + 0.5) / f64::from(steps_z) * PI / 2.0;
        for j in 0..steps_phi {
            let phi = (f64::from(j) + 0.5) / f64::from(steps_phi) * PI;
            let incoming =
                DVec3::new(angle.sin() * phi.cos(), angle.sin() * phi.sin(), angle.cos());
            let half = (incoming + outgoing).normalize();
            let slope2 = (1.0 - half.z * half.z) / (half.z * half.z);
            let density = 1.0
                / (PI * alpha * alpha * half.z.powi(4) * (1.0 + slope2 / (alpha * alpha)).powi(2));
            let masking = 1.0 / (1.0 + lambda(theta.tan().powi(2)) + lambda(angle.tan().powi(2)));
            sum += density * masking / (4.0 * outgoing.z) * angle.sin();
        }
    }
    // Half of the azimuths suffice by symmetry.
    sum * TAU * (PI / 2.0) / f64::from(steps_z * steps_phi)
}

#[test]
fn rough_metal_in_a_furnace_loses_only_masked_light() {
    for alpha in [0.2, 0.5, 1.0] {
        for degrees in [0.0_f64, 45.0, 75.0] {
            let normal = DVec3::new(0.0, 0.0, 1.0);
            let (sin, cos) = degrees.to_radians().sin_cos();
            let mut scene = furnace();
            sphere(&mut scene, [0.0; 3], 1.0, metal(alpha));
            let view = DVec3::new(sin, 0.0, cos);
            let truth = ggx_albedo(alpha, degrees.to_radians());
            let estimate = probe(&mut scene, normal, normal + view * 2.0);
            assert_expected(estimate, truth, &format!("{alpha} {degrees}"));
        }
    }
}
