//! Cameras inside and on surfaces, nested and coincident surfaces.

use crate::common::*;
use glam::DVec3;
use spherule_render::render::Render;
use spherule_render::scene::{Material, Rgb, Scene};

#[test]
fn on_a_surface_the_direction_decides() {
    let directions = [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8)];
    for normal in directions {
        for (made_of, inward) in
            [(emitter(0.5, 0.0), 0.5), (lambertian(0.0), 0.0), (glass(1.5), 1.0)]
        {
            let mut scene = furnace();
            sphere(&mut scene, [0.0; 3], 1.0, made_of);
            look(&mut scene, normal, normal * 2.0, 120.0);
            assert_every_pixel(&render_scene(&scene).image, 1.0, &format!("outward, {normal}"));
            // Narrower than the angle of total reflection, at which paths would never leave the glass.
            look(&mut scene, normal, DVec3::ZERO, 50.0);
            assert_every_pixel(&render_scene(&scene).image, inward, &format!("inward, {normal}"));
            look(&mut scene, DVec3::ZERO, normal, 120.0);
            assert_every_pixel(
                &render_scene(&scene).image,
                inward,
                &format!("from the center, {normal}"),
            );
        }
    }
}

/// The first of equal spheres is visible, from outside, from inside, and through glass, and no other.
#[test]
fn the_first_of_equal_spheres_wins() {
    let kinds = [lambertian(0.3), emitter(2.0, 0.1), glass(1.5), mirror()];
    for (i, first) in kinds.iter().enumerate() {
        for second in kinds.iter().skip(i + 1).chain(&kinds[..i]) {
            let with = |materials: &[&Material]| {
                let mut scene = dark();
                scene.environment.map = gradient();
                scene.settings.spp = 16;
                scene.settings.depth = Some(20);
                for &made_of in materials {
                    sphere(&mut scene, [0.3, 0.1, -0.2], 1.0, made_of.clone());
                }
                scene
            };
            for (eye, fov) in [(DVec3::new(4.0, 3.0, 2.0), 25.0), (DVec3::new(0.5, 0.3, 0.1), 90.0)]
            {
                let picture = |mut scene: Scene| {
                    look(&mut scene, eye, DVec3::ZERO, fov);
                    render_scene(&scene).image
                };
                let (twins, alone) = (picture(with(&[first, second])), picture(with(&[first])));
                assert!(twins == alone, "{first:?} before {second:?} from {eye}");
            }
        }
    }
}

/// An emitter that coincides with an earlier sphere is not sampled as a light either.
#[test]
fn an_emitter_inside_a_coincident_sphere_does_not_light() {
    let mut scene = dark();
    ground(&mut scene, lambertian(0.5));
    sphere(&mut scene, [0.0, 0.0, 2.0], 1.0, lambertian(0.5));
    sphere(&mut scene, [0.0, 0.0, 2.0], 1.0, emitter(5.0, 0.0));
    assert_every_pixel(&render_scene(&scene).image, 0.0, "the emitter comes second");
    scene.spheres.material.reverse();
    assert!(mean(&render_scene(&scene).image) > 0.0, "the emitter comes first");
}

/// Nested, touching and overlapping glass, and shells too thin for single precision: energy is conserved.
#[test]
fn glass_in_glass_keeps_the_furnace() {
    let shells = [0.5, 0.1, 1e-3, 1e-6, 1e-7, 0.0];
    for offset in [0.0, 100.0] {
        for thickness in shells {
            let mut scene = furnace();
            scene.settings.spp = 256;
            let center = DVec3::splat(offset);
            sphere(&mut scene, center, 1.0, glass(1.5));
            sphere(&mut scene, center, 1.0 - thickness, glass(1.33));
            sphere(&mut scene, center + DVec3::X * 2.0, 1.0, glass(2.4));
            sphere(
                &mut scene,
                center + DVec3::Y * (1.0 - thickness),
                thickness.max(0.1),
                glass(0.9),
            );
            for eye in [DVec3::new(3.0, 2.0, 4.0), DVec3::new(0.1, 0.95, 0.0), DVec3::ZERO] {
                look(&mut scene, center + eye, center - DVec3::Y * 0.1, 60.0);
                let Render { image, counters, .. } = render_scene(&scene);
                // Paths that total reflection traps in a shell for 4096 bounces are ended and counted.
                let lost = (1.0 - mean(&image)) * counters.camera_rays as f64;
                let what = format!("shell {thickness}, {eye}: {lost}");
                assert!((lost - counters.cut_paths as f64).abs() < 0.01, "{what}, {counters:?}");
                assert!(lost < 1e-3 * counters.camera_rays as f64, "{what}");
            }
        }
    }
}

/// Two touching white spheres, small and far from the rest of a scene, so that the gap next to the contact is
/// about one unit in the last place of single precision: light leaves it as near the origin.
#[test]
fn contacts_do_not_absorb_light() {
    const SIZE: f64 = 0.007_812_5;
    let gap = |contact: DVec3| {
        let mut scene = furnace();
        for i in 0..5 {
            sphere(&mut scene, [f64::from(i), -2.0, 0.0], 0.5, lambertian(1.0));
        }
        for up in [1.0, -1.0] {
            sphere(&mut scene, contact + DVec3::Y * (up * SIZE), SIZE, lambertian(1.0));
        }
        let (sin, cos) = 8.0_f64.to_radians().sin_cos();
        let point = contact + DVec3::new(0.0, cos - 1.0, sin) * SIZE;
        scene.settings.depth = Some(200);
        probe(&mut scene, point, point + DVec3::Z)
    };
    assert_agree(gap(DVec3::new(96.0, 32.0, -24.0)), gap(DVec3::ZERO), "far and near");
}

/// The inside of a sphere that touches another one inside it, seen along the gap between them: no light of
/// the sky enters.
#[test]
fn no_light_leaks_into_closed_spheres() {
    for offset in [0.0, 50.0] {
        let contact = DVec3::new(offset, 0.25 * offset, -0.75 * offset);
        for z in [1.0, 0.3, 0.1] {
            let mut scene = furnace();
            sphere(&mut scene, contact + DVec3::Y * 2.0, 2.0, lambertian(0.9));
            sphere(&mut scene, contact + DVec3::Y, 1.0, lambertian(0.9));
            // Between the two surfaces at z^2 / 4 and z^2 / 2.
            let eye = contact + DVec3::new(0.0, 0.37 * z * z, z);
            look(&mut scene, eye, contact, 90.0);
            scene.settings.depth = Some(50);
            assert_every_pixel(&render_scene(&scene).image, 0.0, &format!("{offset} {z}"));
        }
    }
}

/// No path leaves a closed white sphere: paths are ended by the depth limit, and counted.
#[test]
fn paths_in_a_closed_white_sphere_end_at_the_hard_limit() {
    for made_of in [lambertian(1.0), mirror()] {
        let mut scene = furnace();
        sphere(&mut scene, [0.0; 3], 1.0, made_of);
        look(&mut scene, DVec3::new(0.2, 0.1, 0.3), DVec3::X, 90.0);
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (4, 4, 2);
        let render = render_scene(&scene);
        assert_eq!(render.counters.cut_paths, 32);
        assert_every_pixel(&render.image, 0.0, "no light gets in");
        scene.settings.depth = Some(100_000);
        assert_eq!(render_scene(&scene).counters.cut_paths, 32);
    }
}

/// Colors of single spheres are factors, also if other spheres have none.
#[test]
fn colors_of_spheres_are_factors() {
    let mut scene = furnace();
    let row = material(&mut scene, lambertian(0.5));
    scene.spheres.push(DVec3::ZERO, 1.0, row, Rgb::new(1.0, 0.5, 0.25));
    look(&mut scene, DVec3::Z * 3.0, DVec3::ZERO, 20.0);
    assert!(render_scene(&scene).image.pixels.iter().all(|pixel| *pixel == [0.5, 0.25, 0.125]));
}
