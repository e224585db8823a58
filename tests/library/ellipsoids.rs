//! Ellipsoids: compared with spheres, with closed forms, and between traversals.

use crate::bodies::{assert_one_picture, assert_traversals_agree, at, features, numbers, parallel};
use crate::common::{
    assert_every_pixel, assert_expected, assert_scenes_agree, furnace, glass, lambertian, look,
    look_parallel, material, measure, metal, mirror, render_scene, sphere,
};
use glam::{DMat3, DQuat, DVec3};
use spherule_render::ray::MISS;
use spherule_render::scene::{Material, Rgb, Scene, Slice, SliceMode, Spheres, write};
use spherule_render::world::World;
use std::f64::consts::PI;

/// A rotation about no axis of coordinates.
fn turned() -> DQuat {
    DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1)
}

#[test]
fn equal_semi_axes_make_a_sphere() {
    let scene = |ellipsoid: bool| {
        let mut scene = furnace();
        scene.settings.depth = Some(3);
        let row = material(&mut scene, lambertian(0.6));
        for (x, radius) in [(-1.0, 0.7), (0.8, 1.0)] {
            let center = DVec3::new(x, 0.1, 0.0);
            if ellipsoid {
                scene.ellipsoids.push(center, DVec3::splat(radius), turned(), row, Rgb::ONE);
            } else {
                scene.spheres.push(center, radius, row, Rgb::ONE);
            }
        }
        look(&mut scene, DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 40.0);
        scene
    };
    assert_scenes_agree(&scene(true), &scene(false), "diffuse");
    let (ellipsoids, spheres) = (features(&scene(true)), features(&scene(false)));
    for (ellipsoid, sphere) in ellipsoids.iter().zip(&spheres) {
        assert!((ellipsoid.coverage - sphere.coverage).abs() < 0.02);
        if sphere.coverage == 1.0 && ellipsoid.coverage == 1.0 {
            let normals = ellipsoid.normal.iter().zip(sphere.normal);
            assert!(normals.into_iter().all(|(a, b)| (a - b).abs() < 1e-3));
            assert!((ellipsoid.depth - sphere.depth).abs() < 1e-3);
            assert_eq!(ellipsoid.id, sphere.id);
        }
    }
}

#[test]
fn an_ellipsoid_covers_its_outline() {
    let semi_axes = DVec3::new(2.0, 0.9, 0.5);
    for orientation in [DQuat::IDENTITY, turned()] {
        let mut scene = parallel();
        let row = material(&mut scene, lambertian(0.5));
        scene.ellipsoids.push(DVec3::new(0.2, -0.1, 1.0), semi_axes, orientation, row, Rgb::X);
        let features = features(&scene);
        let covered: f64 = features.iter().map(|pixel| f64::from(pixel.coverage)).sum();
        // The outline is an ellipse: the upper left part of the matrix of second moments, which are the squares of the semi-axes.
        let axes = DMat3::from_quat(orientation) * DMat3::from_diagonal(semi_axes);
        let moments = axes * axes.transpose();
        let (a, b, c) = (moments.x_axis.x, moments.y_axis.y, moments.x_axis.y);
        let outline = PI * (a * b - c * c).sqrt();
        assert!((covered / 100.0 - outline).abs() < 0.005 * outline, "{covered} {outline}");
        let middle = at(&features, 0.2, -0.1);
        assert_eq!((middle.albedo, middle.id), ([0.5, 0.0, 0.0], 0));
        // The nearest point of the surface on the view axis, by the inverse of the moments.
        let depth = 9.0 - (1.0 / moments.inverse().z_axis.z).sqrt();
        assert!((f64::from(middle.depth) - depth).abs() < 0.02, "{} {depth}", middle.depth);
    }
}

/// Spheres, sticks and ellipsoids, many of which overlap.
fn bodies() -> Scene {
    let mut scene = furnace();
    let rows = [material(&mut scene, lambertian(0.7)), material(&mut scene, metal(0.1))];
    let mut number = numbers(7);
    let mut point = || DVec3::from([number(), number(), number()].map(|x| 2.0 * x - 1.0));
    for i in 0..60 {
        let (center, axis) = (point(), point());
        let semi_axes = [DVec3::new(0.3, 0.1, 0.05), DVec3::new(0.1, 0.1, 0.2)][i % 2];
        let row = rows[usize::from(i % 5 == 0)];
        let orientation = DQuat::from_axis_angle(axis.normalize(), 3.0 * axis.x);
        scene.ellipsoids.push(center, semi_axes, orientation, row, [Rgb::ONE, Rgb::X][i % 2]);
        if i % 3 == 0 {
            scene.spheres.push(center + axis * 0.1, 0.1, rows[0], Rgb::ONE);
        }
        if i % 4 == 0 {
            scene.sticks.push([center, center + axis * 0.5], 0.05, row, [Rgb::ONE, Rgb::Z]);
        }
    }
    look(&mut scene, DVec3::new(0.5, 0.8, 4.0), DVec3::ZERO, 40.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (48, 32, 4);
    scene
}

#[test]
fn all_traversals_find_the_same_hits() {
    let mut counts = [0; 3];
    assert_traversals_agree(&bodies(), |world, hit| {
        let first = world.spheres.len();
        counts[usize::from(hit >= first) + usize::from(hit >= first + 2 * world.sticks.len())] += 1;
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
fn the_background_is_attenuated_by_translucent_ellipsoids() {
    let mut scene = furnace();
    let surface = Box::new(lambertian(0.0));
    let row = material(&mut scene, Material::Translucent { opacity: 0.3, surface });
    for z in [-0.4, 0.0, 0.4] {
        let semi_axes = DVec3::new(1.5, 1.0, 0.3);
        scene.ellipsoids.push(DVec3::Z * z, semi_axes, turned(), row, Rgb::ONE);
    }
    look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
    assert_expected(measure(&scene), 0.7_f64.powi(3), "three ellipsoids");
}

/// Twenty bodies have their own material, among twenty of another kind, as five of them have.
#[test]
fn each_of_many_bodies_has_its_own_material() {
    let mut scene = furnace();
    let (black, white) = (material(&mut scene, metal(0.0)), material(&mut scene, lambertian(1.0)));
    for x in 0..20 {
        let (center, away) = (DVec3::X * f64::from(x), DVec3::new(f64::from(x), 9.0, 0.0));
        scene.ellipsoids.push(center, DVec3::new(0.4, 0.3, 0.2), turned(), white, Rgb::ONE);
        scene.spheres.push(away, 0.2, black, Rgb::ONE);
    }
    let mut alone = scene.clone();
    alone.spheres = Spheres::default();
    for mut scene in [scene, alone] {
        look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
        assert_expected(measure(&scene), 1.0, "white among black");
        look_parallel(&mut scene, DVec3::new(19.0, 0.0, 5.0), DVec3::X * 19.0, 0.1);
        assert_expected(measure(&scene), 1.0, "the last one");
    }
}

#[test]
fn caps_are_flat_ellipses() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    scene.ellipsoids.push(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5), DQuat::IDENTITY, row, Rgb::Y);
    scene.slices = vec![Slice { normal: DVec3::Z, distance: 0.9, mode: SliceMode::Caps }];
    let features = features(&scene);
    let middle = at(&features, 0.3, 0.2);
    assert_eq!(middle.albedo, [0.0, 0.5, 0.0]);
    assert!((f64::from(middle.depth) - 9.1).abs() < 1e-5 && middle.normal[2] > 0.9999);
    // The cap is smaller by 0.8 than the ellipsoid, and its normal is that of the cut.
    for (x, y, is_flat) in
        [(1.3, 0.0, true), (1.8, 0.0, false), (0.0, 0.6, true), (0.0, 0.92, false)]
    {
        let normal = at(&features, x + 0.01, y - 0.01).normal;
        assert_eq!(normal[2] > 0.9999, is_flat, "{x} {y} {normal:?}");
    }
}

#[test]
fn slices_remove_and_hide_ellipsoids_by_their_centers() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    for x in [-1.5, 1.5] {
        let semi_axes = DVec3::new(0.4, 1.0, 0.3);
        scene.ellipsoids.push(DVec3::X * x, semi_axes, DQuat::IDENTITY, row, Rgb::ONE);
    }
    for mode in [SliceMode::Remove, SliceMode::Hide] {
        scene.slices = vec![Slice { normal: DVec3::X, distance: 0.0, mode }];
        let features = features(&scene);
        let ids = (at(&features, -1.5, 0.5).id, at(&features, 1.5, 0.5).id);
        assert_eq!(ids, (0, MISS), "{mode:?}");
    }
}

#[test]
fn hidden_ellipsoids_still_throw_shadows() {
    let mut scene = furnace();
    sphere(&mut scene, DVec3::ZERO, 0.5, lambertian(0.5));
    look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 10.0);
    let free = measure(&scene);
    let row = material(&mut scene, lambertian(0.0));
    let semi_axes = DVec3::new(3.0, 0.4, 0.4);
    scene.ellipsoids.push(DVec3::Z * 1.2, semi_axes, DQuat::IDENTITY, row, Rgb::ONE);
    scene.slices = vec![Slice { normal: DVec3::Z, distance: 1.0, mode: SliceMode::Hide }];
    let shaded = measure(&scene);
    assert!(shaded.mean < free.mean - 0.05, "{shaded:?} {free:?}");
}

#[test]
fn nothing_is_seen_from_within() {
    let mut scene = furnace();
    scene.settings.depth = Some(3);
    let row = material(&mut scene, lambertian(0.9));
    scene.ellipsoids.push(DVec3::ZERO, DVec3::new(3.0, 1.0, 2.0), turned(), row, Rgb::ONE);
    look(&mut scene, DVec3::new(0.2, 0.1, 0.0), DVec3::new(1.0, 0.5, 0.2), 60.0);
    assert_every_pixel(&render_scene(&scene).image, 0.0, "inside");
}

#[test]
fn a_white_ellipsoid_vanishes_in_a_furnace() {
    for surface in [mirror(), lambertian(1.0)] {
        let mut scene = furnace();
        scene.settings.depth = None;
        let row = material(&mut scene, surface);
        scene.ellipsoids.push(DVec3::ZERO, DVec3::new(1.2, 0.2, 0.6), turned(), row, Rgb::ONE);
        look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 40.0);
        assert_expected(measure(&scene), 1.0, "furnace");
    }
}

#[test]
fn written_scenes_keep_their_ellipsoids() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bodies.toml");
    let scene = bodies();
    write(&scene, &path).unwrap();
    let read = Scene::load(&path).unwrap();
    assert_eq!(read.ellipsoids.center, scene.ellipsoids.center);
    assert_eq!(read.ellipsoids.semi_axes, scene.ellipsoids.semi_axes);
    assert_eq!(read.ellipsoids.color, scene.ellipsoids.color);
    for (a, b) in read.ellipsoids.orientation.iter().zip(&scene.ellipsoids.orientation) {
        assert!(a.angle_between(*b) < 1e-7);
    }
}

#[test]
fn invalid_ellipsoids_are_refused_by_name() {
    let refused = |change: fn(&mut Scene)| {
        let mut scene = bodies();
        change(&mut scene);
        World::build(&scene).unwrap_err().to_string()
    };
    assert!(refused(|scene| scene.ellipsoids.semi_axes[3].y = 0.0).contains("ellipsoid 3"));
    assert!(refused(|scene| scene.ellipsoids.semi_axes[3].y = 1e9).contains("ellipsoid 3"));
    assert!(refused(|scene| scene.ellipsoids.center[4].x = f64::NAN).contains("ellipsoid 4"));
    assert!(refused(|scene| scene.ellipsoids.material[5] = 9).contains("ellipsoid 5"));
    assert!(refused(|scene| scene.ellipsoids.color[6].x = 2.0).contains("ellipsoid 6"));
    assert!(refused(|scene| scene.ellipsoids.orientation[7].w = 9.0).contains("ellipsoid 7"));
    assert!(refused(|scene| scene.ellipsoids.color.truncate(3)).contains("differ in length"));
    let with_glass = refused(|scene| {
        let row = material(scene, glass(1.5));
        scene.ellipsoids.material[8] = row;
    });
    assert!(with_glass.contains("ellipsoid 8") && with_glass.contains("glass"));
    for (line, words) in [
        ("semi_axes = [1, 1, 0]", "0"),
        ("semi_axes = [1, 1]", "3 numbers"),
        ("semi_axes = [1, 1, 1e-9]", "16384"),
        ("semi_axes = [1, 1, 1]\norientation = [0, 0, 0, 0]", "quaternion"),
        ("semi_axes = [1, 1, 1]\nmaterial = \"nowhere\"", "nowhere"),
        ("semi_axes = [1, 1, 1]\nradius = 1", "radius"),
    ] {
        let text = format!("[[ellipsoid]]\ncenter = [0, 0, 0]\n{line}\n");

        let error = Scene::parse(&text, "test", std::path::Path::new("")).unwrap_err();
        assert!(error.to_string().contains(words), "{line}: {error}");
    }
}
