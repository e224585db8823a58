//! Ambient occlusion in closed form, and contact between spheres and ground.

use crate::common::*;
use glam::DVec3;
use spherule_render::scene::{Integrator, Scene};

const AO: Integrator = Integrator::Ao { distance: f64::INFINITY };

/// Returns white ground and one sphere above the origin, under a white sky.
fn above_ground(height: f64) -> Scene {
    let mut scene = furnace();
    scene.settings.integrator = AO;
    ground(&mut scene, lambertian(1.0));
    sphere(&mut scene, [0.0, 0.0, height], 1.0, lambertian(1.0));
    scene
}

/// Returns the visible fraction of the sky from the ground at `x`, seen along a ray that passes under the
/// sphere.
fn sky_seen_from_ground(scene: &mut Scene, x: f64) -> Estimate {
    let point = DVec3::new(x, 0.0, 0.0);
    probe(scene, point, point + DVec3::new(5.0, 0.0, 0.1))
}

#[test]
fn a_plane_touched_by_a_sphere() {
    let truths = [
        (0.5, 0.284_458_247_2),
        (1.0, 0.646_446_609_4),
        (1.5, 0.829_323_016_5),
        (2.0, 0.910_557_280_9),
        (3.0, 0.968_377_223_4),
        (5.0, 0.992_457_071_7),
        (10.0, 0.999_014_814_7),
    ];
    for (x, truth) in truths {
        let mut scene = above_ground(1.0);
        assert_expected(sky_seen_from_ground(&mut scene, x), truth, &format!("{x}"));
    }
}

#[test]
fn a_plane_under_and_through_a_sphere() {
    let occlusions = [
        (2.0, 0.0, 0.25),
        (2.0, 1.0, 0.178_885_438_2),
        (2.0, 3.0, 0.042_669_245_9),
        (0.0, 2.0, 0.028_834_442_8),
        (0.5, 2.0, 0.062_643_982_8),
        (-0.5, 2.0, 0.005_576_776_9),
        (0.9, 2.0, 0.085_411_662_8),
    ];
    for (height, x, occlusion) in occlusions {
        let mut scene = above_ground(height);
        let estimate = sky_seen_from_ground(&mut scene, x);
        assert_expected(estimate, 1.0 - occlusion, &format!("{height} {x}"));
    }
}

#[test]
fn two_touching_spheres() {
    let truths: [(f64, f64); 9] = [
        (5.0, 0.029_502_000_8),
        (10.0, 0.111_129_653_3),
        (20.0, 0.358_630_884_8),
        (30.0, 0.603_261_297_2),
        (45.0, 0.843_838_833_0),
        (60.0, 0.954_139_443_3),
        (75.0, 0.993_198_477_3),
        (90.0, 1.0),
        (120.0, 1.0),
    ];
    for (degrees, truth) in truths {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut scene = furnace();
        scene.settings.integrator = AO;
        sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
        sphere(&mut scene, [0.0, 0.0, 2.0], 1.0, lambertian(0.3));
        let point = DVec3::new(sin, 0.0, cos);
        // Along the plane between the spheres, into the gap.
        assert_expected(
            probe(&mut scene, point, point + DVec3::X * 5.0),
            truth,
            &format!("{degrees}"),
        );
    }
}

/// Spheres beyond the limit do not occlude: from straight below, the nearest point of the sphere is at
/// distance 1.
#[test]
fn occlusion_ends_at_its_distance() {
    for (distance, truth) in [(0.999, 1.0), (100.0, 0.75)] {
        let mut scene = above_ground(2.0);
        scene.settings.integrator = Integrator::Ao { distance };
        assert_expected(sky_seen_from_ground(&mut scene, 0.0), truth, &format!("{distance}"));
    }
}

/// A ground sphere of radius 1e7 equals the plane; with 1e5, the tilt of the ground toward a small light is
/// visible. Their images match in each band of rows, without rings.
#[test]
fn a_giant_sphere_is_a_plane() {
    let scene = |plane: bool| {
        let mut scene = dark();
        if plane {
            ground(&mut scene, lambertian(0.5));
        } else {
            sphere(&mut scene, [0.0, 0.0, -1e7], 1e7, lambertian(0.5));
        }
        for (x, y, radius) in
            [(0.0, 0.0, 0.45), (1.0, 0.3, 0.3), (-0.8, 0.7, 0.2), (0.2, -1.0, 0.1)]
        {
            sphere(&mut scene, [x, y, radius], radius, lambertian(0.5));
        }
        sphere(&mut scene, [8.0, 6.0, 14.0], 2.0, emitter(40.0, 0.0));
        look(&mut scene, DVec3::new(3.0, -6.0, 4.0), DVec3::ZERO, 40.0);
        (scene.settings.width, scene.settings.height) = (36, 36);
        scene.settings.spp = 32;
        scene.settings.depth = Some(5);
        scene
    };
    assert_scenes_agree(&scene(false), &scene(true), "giant and plane");
}
