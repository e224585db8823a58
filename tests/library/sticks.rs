//! Sticks: compared with spheres, with closed forms, and between traversals.

use crate::bodies::{assert_one_picture, assert_traversals_agree, at, features, numbers, parallel};
use crate::common::{
    assert_every_pixel, assert_expected, assert_scenes_agree, furnace, glass, lambertian, look,
    material, measure, metal, mirror, render_scene, sphere,
};
use glam::DVec3;
use spherule_render::ray::MISS;
use spherule_render::scene::{Rgb, Scene, Slice, SliceMode};
use spherule_render::world::World;

#[test]
fn a_stick_of_no_length_is_a_sphere() {
    let scene = |stick: bool| {
        let mut scene = furnace();
        scene.settings.depth = Some(3);
        let row = material(&mut scene, lambertian(0.6));
        for (x, radius) in [(-1.0, 0.7), (0.8, 1.0)] {
            let center = DVec3::new(x, 0.1, 0.0);
            if stick {
                scene.sticks.push([center; 2], radius, row, [Rgb::ONE; 2]);
            } else {
                scene.spheres.push(center, radius, row, Rgb::ONE);
            }
        }
        look(&mut scene, DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 40.0);
        scene
    };
    assert_scenes_agree(&scene(true), &scene(false), "diffuse");
    let (sticks, spheres) = (features(&scene(true)), features(&scene(false)));
    for (stick, sphere) in sticks.iter().zip(&spheres) {
        assert!((stick.coverage - sphere.coverage).abs() < 1e-6);
        let normals = stick.normal.iter().zip(sphere.normal);
        assert!(normals.into_iter().all(|(a, b)| (a - b).abs() < 1e-4));
        let near = (stick.depth - sphere.depth).abs() < 1e-4;
        assert!(near || stick.depth == sphere.depth);
        assert_eq!(stick.id, sphere.id);
    }
}

#[test]
fn a_stick_covers_its_outline() {
    let (radius, ends) = (0.8, [DVec3::new(-1.5, -0.7, 1.0), DVec3::new(1.2, 0.9, -2.0)]);
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    scene.sticks.push(ends, radius, row, [Rgb::X, Rgb::Z]);
    let features = features(&scene);
    let covered: f64 = features.iter().map(|pixel| f64::from(pixel.coverage)).sum();
    let length = (ends[1] - ends[0]).truncate().length();
    let outline = 2.0 * radius * length + std::f64::consts::PI * radius * radius;
    // A hundred pixels for a unit of area.
    assert!((covered / 100.0 - outline).abs() < 0.01 * outline, "{covered} {outline}");
    for (end, color) in ends.into_iter().zip([Rgb::X, Rgb::Z]) {
        let pixel = at(&features, end.x * 0.5, end.y * 0.5);
        assert_eq!(pixel.albedo, (color * 0.5).to_array());
    }
}

/// Spheres and sticks, many of which share ends and radii.
fn molecule() -> Scene {
    let mut scene = furnace();
    let rows = [material(&mut scene, lambertian(0.7)), material(&mut scene, metal(0.1))];
    let mut number = numbers(7);
    let mut points: Vec<DVec3> = Vec::new();
    for i in 0..60 {
        let point = DVec3::from([number(), number(), number()].map(|x| 2.0 * x - 1.0));
        points.push(point);
        if i % 2 == 0 {
            scene.spheres.push(point, 0.1, rows[0], Rgb::ONE);
        }
    }
    for i in 0..80 {
        let ends = [points[i % 60], points[(i * 7 + 1) % 60]];
        let radius = [0.1, 0.03][i % 2];
        scene.sticks.push(ends, radius, rows[usize::from(i % 5 == 0)], [Rgb::ONE, Rgb::X]);
    }
    look(&mut scene, DVec3::new(0.5, 0.8, 4.0), DVec3::ZERO, 40.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (48, 32, 4);
    scene
}

#[test]
fn all_traversals_find_the_same_hits() {
    let (mut of_sticks, mut of_spheres) = (0, 0);
    assert_traversals_agree(&molecule(), |world, hit| {
        *(if hit < world.spheres.len() { &mut of_spheres } else { &mut of_sticks }) += 1;
    });
    assert!(of_sticks > 500 && of_spheres > 100, "{of_sticks} {of_spheres}");
}

#[test]
fn pictures_do_not_depend_on_widths_and_threads() {
    assert_one_picture(&molecule());
}

#[test]
fn caps_are_flat_and_have_the_color_of_their_half() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    let ends = [DVec3::NEG_Z * 2.0, DVec3::Z * 2.0];
    scene.sticks.push(ends, 1.0, row, [Rgb::X, Rgb::Y]);
    for (distance, color) in [(1.0, Rgb::Y), (-1.0, Rgb::X)] {
        scene.slices = vec![Slice { normal: DVec3::Z, distance, mode: SliceMode::Caps }];
        let middle = at(&features(&scene), 0.3, 0.2);
        assert_eq!(middle.albedo, (color * 0.5).to_array());
        assert!((f64::from(middle.depth) - (10.0 - distance)).abs() < 1e-5, "{}", middle.depth);
        assert!(middle.normal[2] > 0.9999);
    }
}

#[test]
fn slices_remove_and_hide_sticks_by_their_middle() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    for x in [-1.5, 1.5] {
        let ends = [DVec3::new(x, -1.0, 0.0), DVec3::new(x, 1.0, 0.0)];
        scene.sticks.push(ends, 0.4, row, [Rgb::ONE; 2]);
    }
    for mode in [SliceMode::Remove, SliceMode::Hide] {
        scene.slices = vec![Slice { normal: DVec3::X, distance: 0.0, mode }];
        let features = features(&scene);
        assert_eq!(
            (at(&features, -1.5, 0.5).id, at(&features, 1.5, 0.5).id),
            (0, MISS),
            "{mode:?}"
        );
    }
}

#[test]
fn hidden_sticks_still_throw_shadows() {
    let mut scene = furnace();
    sphere(&mut scene, DVec3::ZERO, 0.5, lambertian(0.5));
    look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 10.0);
    let free = measure(&scene);
    let row = material(&mut scene, lambertian(0.0));
    let ends = [DVec3::new(-3.0, 0.0, 1.2), DVec3::new(3.0, 0.0, 1.2)];
    scene.sticks.push(ends, 0.4, row, [Rgb::ONE; 2]);
    scene.slices = vec![Slice { normal: DVec3::Z, distance: 1.0, mode: SliceMode::Hide }];
    let shaded = measure(&scene);
    assert!(shaded.mean < free.mean - 0.05, "{shaded:?} {free:?}");
}

#[test]
fn nothing_is_seen_from_within() {
    let mut scene = furnace();
    scene.settings.depth = Some(3);
    let row = material(&mut scene, lambertian(0.9));
    scene.sticks.push([DVec3::NEG_X * 3.0, DVec3::X * 3.0], 1.0, row, [Rgb::ONE; 2]);
    look(&mut scene, DVec3::new(0.2, 0.1, 0.0), DVec3::new(1.0, 0.5, 0.2), 60.0);
    assert_every_pixel(&render_scene(&scene).image, 0.0, "inside");
}

#[test]
fn a_white_stick_vanishes_in_a_furnace() {
    let mut scene = furnace();
    let row = material(&mut scene, mirror());
    scene.sticks.push([DVec3::NEG_X, DVec3::new(1.0, 0.3, 0.5)], 0.4, row, [Rgb::ONE; 2]);
    look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 40.0);
    assert_expected(measure(&scene), 1.0, "furnace");
}

#[test]
fn invalid_sticks_are_refused_by_name() {
    let refused = |change: fn(&mut Scene)| {
        let mut scene = molecule();
        change(&mut scene);
        World::build(&scene).unwrap_err().to_string()
    };
    assert!(refused(|scene| scene.sticks.radius[3] = 0.0).contains("stick 3"));
    assert!(refused(|scene| scene.sticks.from[4].x = f64::NAN).contains("stick 4"));
    assert!(refused(|scene| scene.sticks.material[5] = 9).contains("stick 5"));
    assert!(refused(|scene| scene.sticks.colors[6][1].x = 2.0).contains("stick 6"));
    assert!(refused(|scene| scene.sticks.to.truncate(3)).contains("differ in length"));
    let with_glass = refused(|scene| {
        let row = material(scene, glass(1.5));
        scene.sticks.material[7] = row;
    });
    assert!(with_glass.contains("stick 7") && with_glass.contains("glass"));
}
