//! Bodies other than spheres, compared with spheres and with closed forms: outlines, nearest points, and caps.

use crate::bodies::{at, features, parallel, turned};
use crate::common::{assert_scenes_agree, furnace, lambertian, look, material};
use glam::{DMat3, DQuat, DVec3};
use spherule_render::layers::Features;
use spherule_render::scene::{Rgb, Scene, Slice, SliceMode};
use std::f64::consts::PI;

/// Area that is covered: a hundred pixels are a unit.
fn covered(features: &[Features]) -> f64 {
    features.iter().map(|pixel| f64::from(pixel.coverage)).sum::<f64>() / 100.0
}

/// Compares bodies with spheres; `near` bounds differences of coverage, and of depths and normals where pixels are covered.
fn assert_spheres(push: fn(&mut Scene, DVec3, f64, u32), near: [f32; 2]) {
    let scene = |push: fn(&mut Scene, DVec3, f64, u32)| {
        let mut scene = furnace();
        scene.settings.depth = Some(3);
        let row = material(&mut scene, lambertian(0.6));
        for (x, radius) in [(-1.0, 0.7), (0.8, 1.0)] {
            push(&mut scene, DVec3::new(x, 0.1, 0.0), radius, row);
        }
        look(&mut scene, DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 40.0);
        scene
    };
    let spheres = scene(|scene, at, radius, row| scene.spheres.push(at, radius, row, Rgb::ONE));
    let bodies = scene(push);
    assert_scenes_agree(&bodies, &spheres, "diffuse");
    for (body, sphere) in features(&bodies).iter().zip(&features(&spheres)) {
        assert!((body.coverage - sphere.coverage).abs() < near[0]);
        if sphere.coverage == 1.0 && body.coverage == 1.0 {
            let mut normals = body.normal.iter().zip(sphere.normal);
            assert!(normals.all(|(a, b)| (a - b).abs() < near[1]));
            assert!((body.depth - sphere.depth).abs() < near[1]);
            assert_eq!(body.id, sphere.id);
        }
    }
}

#[test]
fn sticks_of_no_length_are_spheres() {
    let push = |scene: &mut Scene, at, radius, row| {
        scene.sticks.push([at; 2], radius, row, [Rgb::ONE; 2]);
    };
    assert_spheres(push, [1e-6, 1e-4]);
}

#[test]
fn ellipsoids_of_equal_semi_axes_are_spheres() {
    let push = |scene: &mut Scene, at, radius, row| {
        scene.ellipsoids.push(at, DVec3::splat(radius), turned(), row, Rgb::ONE);
    };
    assert_spheres(push, [0.02, 1e-3]);
}

#[test]
fn a_stick_covers_its_outline() {
    let (radius, ends) = (0.8, [DVec3::new(-1.5, -0.7, 1.0), DVec3::new(1.2, 0.9, -2.0)]);
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    scene.sticks.push(ends, radius, row, [Rgb::X, Rgb::Z]);
    let features = features(&scene);
    let length = (ends[1] - ends[0]).truncate().length();
    let outline = 2.0 * radius * length + PI * radius * radius;
    assert!((covered(&features) - outline).abs() < 0.01 * outline, "{outline}");
    for (end, color) in ends.into_iter().zip([Rgb::X, Rgb::Z]) {
        let pixel = at(&features, end.x * 0.5, end.y * 0.5);
        assert_eq!(pixel.albedo, (color * 0.5).to_array());
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
        // The outline is an ellipse: the upper left part of the matrix of second moments, which are the squares of the semi-axes.
        let axes = DMat3::from_quat(orientation) * DMat3::from_diagonal(semi_axes);
        let moments = axes * axes.transpose();
        let (a, b, c) = (moments.x_axis.x, moments.y_axis.y, moments.x_axis.y);
        let outline = PI * (a * b - c * c).sqrt();
        assert!((covered(&features) - outline).abs() < 0.005 * outline, "{outline}");
        let middle = at(&features, 0.2, -0.1);
        assert_eq!((middle.albedo, middle.id), ([0.5, 0.0, 0.0], 0));
        // The nearest point of the surface on the view axis, by the inverse of the moments.
        let depth = 9.0 - (1.0 / moments.inverse().z_axis.z).sqrt();
        assert!((f64::from(middle.depth) - depth).abs() < 0.02, "{} {depth}", middle.depth);
    }
}

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
        assert!((covered(&features) - area).abs() < 0.01 * area, "{area}");
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

#[test]
fn a_triangle_covers_its_outline_from_both_sides() {
    let corners =
        [DVec3::new(-2.0, -1.5, 1.0), DVec3::new(2.1, -1.0, 0.0), DVec3::new(0.3, 2.0, -1.0)];
    for (order, id) in [([0, 1, 2], 0), ([0, 2, 1], 0)] {
        let mut scene = parallel();
        let row = material(&mut scene, lambertian(0.5));
        scene.triangles.push(order.map(|corner: usize| corners[corner]), row, Rgb::X);
        let features = features(&scene);
        let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = across.z.abs() / 2.0;
        assert!((covered(&features) - area).abs() < 0.005 * area, "{area}");
        let middle = at(&features, 0.05, 0.05);
        assert_eq!((middle.albedo, middle.id), ([0.5, 0.0, 0.0], id));
        let off = DVec3::from(middle.normal.map(f64::from)) - across.normalize();
        assert!(off.length() < 1e-3, "{:?}", middle.normal);
        // The height of the plane there; a pixel is a tenth wide.
        let height = corners[0].z
            - (across.x * (0.05 - corners[0].x) + across.y * (0.05 - corners[0].y)) / across.z;
        assert!(
            (f64::from(middle.depth) - (10.0 - height)).abs() < 0.05,
            "{} {height}",
            middle.depth
        );
    }
}

/// The layers of a scene that is cut across the view axis.
fn capped(scene: &Scene, distance: f64) -> Vec<Features> {
    let slices = vec![Slice { normal: DVec3::Z, distance, mode: SliceMode::Caps }];
    features(&Scene { slices, ..scene.clone() })
}

/// Checks that the middle of a scene is a cap.
fn assert_cap(features: &[Features], distance: f64, color: Rgb) {
    let middle = at(features, 0.3, 0.2);
    assert_eq!(middle.albedo, (color * 0.5).to_array());
    assert!((f64::from(middle.depth) - (10.0 - distance)).abs() < 1e-5, "{}", middle.depth);
    assert!(middle.normal[2] > 0.9999);
}

#[test]
fn caps_of_sticks_have_the_color_of_their_half() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    scene.sticks.push([DVec3::NEG_Z * 2.0, DVec3::Z * 2.0], 1.0, row, [Rgb::X, Rgb::Y]);
    for (distance, color) in [(1.0, Rgb::Y), (-1.0, Rgb::X)] {
        assert_cap(&capped(&scene, distance), distance, color);
    }
}

#[test]
fn caps_of_ellipsoids_are_flat_ellipses() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    scene.ellipsoids.push(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.5), DQuat::IDENTITY, row, Rgb::Y);
    let features = capped(&scene, 0.9);
    assert_cap(&features, 0.9, Rgb::Y);
    // The cap is smaller by 0.8 than the ellipsoid, and its normal is that of the cut.
    for (x, y, is_flat) in
        [(1.3, 0.0, true), (1.8, 0.0, false), (0.0, 0.6, true), (0.0, 0.92, false)]
    {
        let normal = at(&features, x + 0.01, y - 0.01).normal;
        assert_eq!(normal[2] > 0.9999, is_flat, "{x} {y} {normal:?}");
    }
}

#[test]
fn caps_of_cones_end_where_the_cone_does() {
    let mut scene = parallel();
    let row = material(&mut scene, lambertian(0.5));
    // Cut across at half of the height: a disc of half of the radius remains, the base is behind it.
    scene.cones.push(DVec3::Z * 2.0, DVec3::ZERO, 2.0, row, Rgb::Y);
    let features = capped(&scene, 1.0);
    assert_cap(&features, 1.0, Rgb::Y);
    for (x, is_flat) in [(0.8, true), (1.2, false), (1.8, false)] {
        let pixel = at(&features, x + 0.01, 0.01);
        assert_eq!(pixel.normal[2] > 0.9999, is_flat, "{x} {:?}", pixel.normal);
        assert!(is_flat || (f64::from(pixel.normal[2]) - 0.5_f64.sqrt()).abs() < 0.02);
    }
}
