//! Cones: compared with closed forms, and between traversals.

use crate::bodies::{assert_one_picture, assert_traversals_agree, at, features, numbers, parallel};
use crate::common::{
    assert_every_pixel, assert_expected, furnace, glass, lambertian, look, look_parallel, material,
    measure, metal, mirror, render_scene, sphere,
};
use glam::{DQuat, DVec3};
use spherule_render::ray::MISS;
use spherule_render::scene::{Material, Rgb, Scene, Slice, SliceMode, write};
use spherule_render::world::World;
use std::f64::consts::PI;

#[test]
fn a_cone_covers_its_outline() {
    // From the side a triangle, from the apex and from the base a disc; its nearest point, and the normal there.
    let (height, radius) = (2.4, 0.7);
    let slant = f64::hypot(height, radius);
    for (toward, area, depth, normal) in [
        (DVec3::Y, height * radius, 10.0 - radius / 2.0, [0.0, radius / slant, height / slant]),
        (DVec3::NEG_Z, PI * radius * radius, 10.0 - height / 2.0, [0.0, 0.0, 1.0]),
    ] {
        let mut scene = parallel();
        let row = material(&mut scene, lambertian(0.5));
        let half = toward * (height / 2.0);
        scene.cones.push(half, -half, radius, row, Rgb::X);
        let features = features(&scene);
        let covered: f64 = features.iter().map(|pixel| f64::from(pixel.coverage)).sum();
        assert!((covered / 100.0 - area).abs() < 0.01 * area, "{covered} {area}");
        let middle = at(&features, 0.01, 0.01);
        assert_eq!((middle.albedo, middle.id), ([0.5, 0.0, 0.0], 0));
        assert!((f64::from(middle.depth) - depth).abs() < 0.03, "{} {depth}", middle.depth);
        // Not across the axis, where it changes within the pixel; from the apex all directions meet.
        if toward == DVec3::Y {
            for axis in 1..3 {
                let off = f64::from(middle.normal[axis]) - normal[axis];
                assert!(off.abs() < 0.02, "{:?} {normal:?}", middle.normal);
            }
        }
    }
}

/// Bodies of all kinds, many of which overlap.
fn bodies() -> Scene {
    let mut scene = furnace();
    let rows = [material(&mut scene, lambertian(0.7)), material(&mut scene, metal(0.1))];
    let mut number = numbers(8);
    let mut point = || DVec3::from([number(), number(), number()].map(|x| 2.0 * x - 1.0));
    for i in 0..60 {
        let (apex, axis) = (point(), point());
        let row = rows[usize::from(i % 5 == 0)];
        let (height, radius) = [(0.5, 0.1), (0.1, 0.3)][i % 2];
        let base = apex + axis.normalize() * height;
        scene.cones.push(apex, base, radius, row, [Rgb::ONE, Rgb::X][i % 2]);
        if i % 3 == 0 {
            scene.spheres.push(apex, 0.1, rows[0], Rgb::ONE);
            // An arrow.
            scene.sticks.push([base, base + axis * 0.5], 0.05, row, [Rgb::ONE, Rgb::Z]);
        }
        if i % 4 == 0 {
            let semi_axes = DVec3::new(0.2, 0.1, 0.1);
            scene.ellipsoids.push(point(), semi_axes, DQuat::IDENTITY, row, Rgb::Y);
        }
    }
    look(&mut scene, DVec3::new(0.5, 0.8, 4.0), DVec3::ZERO, 40.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (48, 32, 4);
    scene
}

#[test]
fn all_traversals_find_the_same_hits() {
    let mut counts = [0; 4];
    assert_traversals_agree(&bodies(), |world, hit| {
        let ends = [world.spheres.len(), 2 * world.sticks.len(), world.ellipsoids.len()];
        let mut end = 0;
        let before = ends.iter().take_while(|&&count| {
            end += count;
            end <= hit
        });
        counts[before.count()] += 1;
    });
    assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
}

#[test]
fn pictures_do_not_depend_on_widths_and_threads() {
    let mut scene = bodies();
    assert_one_picture(&scene);
    let surface = Box::new(scene.materials[0].material.clone());
    scene.materials[0].material = Material::Translucent { opacity: 0.4, surface };
    assert_one_picture(&scene);
}

#[test]
fn the_background_is_attenuated_by_translucent_cones() {
    let mut scene = furnace();
    let surface = Box::new(lambertian(0.0));
    let row = material(&mut scene, Material::Translucent { opacity: 0.3, surface });
    for z in [-0.4, 0.0, 0.4] {
        scene.cones.push(DVec3::new(0.5, 0.0, z), DVec3::new(-0.5, 0.0, z), 0.9, row, Rgb::ONE);
    }
    look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
    assert_expected(measure(&scene), 0.7_f64.powi(3), "three cones");
}

#[test]
fn caps_are_flat_and_end_where_the_cone_does() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    // Cut across at half of the height: a disc of half of the radius remains, the base is behind it.
    scene.cones.push(DVec3::Z * 2.0, DVec3::ZERO, 2.0, row, Rgb::Y);
    scene.slices = vec![Slice { normal: DVec3::Z, distance: 1.0, mode: SliceMode::Caps }];
    let features = features(&scene);
    let middle = at(&features, 0.3, 0.2);
    assert_eq!(middle.albedo, [0.0, 0.5, 0.0]);
    assert!((f64::from(middle.depth) - 9.0).abs() < 1e-5 && middle.normal[2] > 0.9999);
    for (x, is_flat) in [(0.8, true), (1.2, false), (1.8, false)] {
        let pixel = at(&features, x + 0.01, 0.01);
        assert_eq!(pixel.normal[2] > 0.9999, is_flat, "{x} {:?}", pixel.normal);
        assert!(is_flat || (f64::from(pixel.normal[2]) - 0.5_f64.sqrt()).abs() < 0.02);
    }
}

#[test]
fn slices_remove_and_hide_cones_by_their_middles() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    for x in [-1.5, 1.5] {
        scene.cones.push(DVec3::new(x, 1.0, 0.0), DVec3::new(x, -1.0, 0.0), 0.5, row, Rgb::ONE);
    }
    for mode in [SliceMode::Remove, SliceMode::Hide] {
        scene.slices = vec![Slice { normal: DVec3::X, distance: 0.0, mode }];
        let features = features(&scene);
        let ids = (at(&features, -1.5, -0.5).id, at(&features, 1.5, -0.5).id);
        assert_eq!(ids, (0, MISS), "{mode:?}");
    }
}

#[test]
fn hidden_cones_still_throw_shadows() {
    let mut scene = furnace();
    sphere(&mut scene, DVec3::ZERO, 0.5, lambertian(0.5));
    look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 10.0);
    let free = measure(&scene);
    let row = material(&mut scene, lambertian(0.0));
    scene.cones.push(DVec3::Z * 1.5, DVec3::Z * 1.2, 1.5, row, Rgb::ONE);
    scene.slices = vec![Slice { normal: DVec3::Z, distance: 1.0, mode: SliceMode::Hide }];
    let shaded = measure(&scene);
    assert!(shaded.mean < free.mean - 0.05, "{shaded:?} {free:?}");
}

#[test]
fn nothing_is_seen_from_within_and_a_white_cone_vanishes_in_a_furnace() {
    let mut scene = furnace();
    scene.settings.depth = Some(3);
    let row = material(&mut scene, lambertian(0.9));
    scene.cones.push(DVec3::Y * 3.0, DVec3::Y * -1.0, 3.0, row, Rgb::ONE);
    look(&mut scene, DVec3::new(0.2, 0.1, 0.0), DVec3::new(1.0, 0.5, 0.2), 60.0);
    assert_every_pixel(&render_scene(&scene).image, 0.0, "inside");
    for surface in [mirror(), lambertian(1.0)] {
        let mut scene = furnace();
        scene.settings.depth = None;
        let row = material(&mut scene, surface);
        scene.cones.push(DVec3::new(1.0, 0.4, 0.2), DVec3::ZERO, 0.6, row, Rgb::ONE);
        look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 40.0);
        assert_expected(measure(&scene), 1.0, "furnace");
    }
}

#[test]
fn written_scenes_keep_their_cones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bodies.toml");
    let scene = bodies();
    write(&scene, &path).unwrap();
    assert_eq!(Scene::load(&path).unwrap().cones, scene.cones);
}

#[test]
fn invalid_cones_are_refused_by_name() {
    let refused = |change: fn(&mut Scene)| {
        let mut scene = bodies();
        change(&mut scene);
        World::build(&scene).unwrap_err().to_string()
    };
    assert!(refused(|scene| scene.cones.radius[3] = 0.0).contains("cone 3"));
    assert!(refused(|scene| scene.cones.radius[3] = 1e9).contains("cone 3"));
    assert!(refused(|scene| scene.cones.apex[4].x = f64::NAN).contains("cone 4"));
    assert!(refused(|scene| scene.cones.base[4] = scene.cones.apex[4]).contains("cone 4"));
    assert!(refused(|scene| scene.cones.material[5] = 9).contains("cone 5"));
    assert!(refused(|scene| scene.cones.color[6].x = 2.0).contains("cone 6"));
    assert!(refused(|scene| scene.cones.color.truncate(3)).contains("differ in length"));
    let with_glass = refused(|scene| {
        let row = material(scene, glass(1.5));
        scene.cones.material[8] = row;
    });
    assert!(with_glass.contains("cone 8") && with_glass.contains("glass"));
    for (line, words) in [
        ("base = [0, 0, 1]\nradius = 0", "0"),
        ("base = [0, 0, 0]\nradius = 1", "apex"),
        ("base = [0, 0, 1]", "radius"),
        ("base = [0, 0, 1]\nradius = 1e9", "16384"),
        ("base = [0, 0, 1]\nradius = 1\nmaterial = \"nowhere\"", "nowhere"),
        ("base = [0, 0, 1]\nradius = 1\nheight = 1", "height"),
    ] {
        let text = format!("[[cone]]\napex = [0, 0, 0]\n{line}\n");
        let error = Scene::parse(&text, "test", std::path::Path::new("")).unwrap_err();
        assert!(error.to_string().contains(words), "{line}: {error}");
    }
}
