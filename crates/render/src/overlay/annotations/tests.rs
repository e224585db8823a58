use super::*;
use crate::color::{Map, Range, Scale, Spacing};
use crate::image::Image;
use crate::scene::particles::Particles;
use crate::scene::{
    Anchor, AxisTripod, Camera, ColorBar, ColorLegend, Label, Measure, Projection, ScaleBar,
};

const SIZE: (u32, u32) = (320, 240);

/// A box full of spheres.
fn scene() -> Scene {
    let mut scene = Scene::of_particles(Particles::default(), "");
    for i in 0..1000 {
        let place = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100));
        scene.spheres.push(place, 0.5, 0, Rgb::ONE);
    }
    (scene.settings.width, scene.settings.height) = SIZE;
    scene
}

fn color_bar(position: Anchor) -> ColorBar {
    let range = Range::new(0.0, 1.0, Spacing::Linear).unwrap();
    ColorBar { scale: Scale::new(Map::Viridis, range), label: "q (e)".to_owned(), position }
}

fn everything() -> Annotations {
    let entries = ["C", "N", "O"].map(|name| (Rgb::ONE, name.to_owned())).to_vec();
    let label = Label { text: "t = 5 ps".to_owned(), position: Anchor::TopLeft, at: None };
    Annotations {
        color_bar: Some(color_bar(Anchor::Right)),
        legend: Some(ColorLegend {
            entries,
            omitted: 3,
            position: Anchor::TopRight,
            ..ColorLegend::default()
        }),
        axes: Some(AxisTripod::default()),
        scale_bar: Some(ScaleBar { unit: "nm".to_owned(), ..ScaleBar::default() }),
        labels: vec![label],
        ..Annotations::default()
    }
}

/// Returns the pixels that the drawing changes.
fn drawn(scene: &Scene, turns: bool) -> (Image, bool) {
    let world = World::build(scene).unwrap();
    let AnnotationDrawing { drawing, fits } =
        draw(&scene.annotations, &world, &scene.look, None, turns);
    let mut image = Image::filled(SIZE.0, SIZE.1, [1.0; 3]).unwrap();
    drawing.draw_over(&mut image);
    (image, fits)
}

/// Returns whether no annotation is drawn where a sphere is.
fn is_clear(scene: &Scene) -> bool {
    let world = World::build(scene).unwrap();
    let (image, _) = drawn(scene, false);
    (0..SIZE.1).all(|y| {
        (0..SIZE.0).all(|x| {
            let low = DVec2::new(f64::from(x), f64::from(y));
            let is_white = image.pixel(x, y) == Some([1.0; 3]);
            is_white || !covers_sphere(&world, low, low + 1.0)
        })
    })
}

#[test]
fn fitted_cameras_keep_spheres_clear_of_annotations() {
    let only_bar =
        |anchor| Annotations { color_bar: Some(color_bar(anchor)), ..Annotations::default() };
    let all = Anchor::ALL.map(|(_, anchor)| only_bar(anchor));
    for projection in
        [Projection::Perspective { fov: 40.0 }, Projection::Orthographic { height: None }]
    {
        for annotations in all.iter().chain([&everything()]) {
            let mut scene = Scene { annotations: annotations.clone(), ..scene() };
            scene.camera = Camera { projection, ..Camera::default() };
            scene.camera.insets = insets(&scene, false);
            assert_ne!(scene.camera.insets, Insets::default(), "{annotations:?}");
            assert!(is_clear(&scene), "{annotations:?}");
        }
    }
}

#[test]
fn annotations_over_spheres_have_a_panel() {
    let mut scene = Scene { annotations: everything(), ..scene() };
    scene.camera.pose = Pose::LookAt { eye: DVec3::new(4.5, 4.5, 14.0), target: DVec3::splat(4.5) };
    assert_eq!(insets(&scene, false), Insets::default());
    scene.look.background = Background::Color(Rgb::X);
    let (image, _) = drawn(&scene, false);
    // A corner of the panel behind the label, white and red.
    let edge = (0..SIZE.0).find_map(|x| image.pixel(x, 10).filter(|pixel| pixel[1] != 1.0));
    assert!(edge.is_some_and(|pixel| pixel[1] < 0.9 && pixel[0] == 1.0), "{edge:?}");
    scene.annotations = Annotations::default();
    let (image, fits) = drawn(&scene, false);
    assert!(fits && image.pixels.iter().all(|pixel| *pixel == [1.0; 3]));
}

#[test]
fn letters_contrast_with_what_is_behind_them() {
    let darkest = |background, sky: Rgb| {
        let mut scene = Scene { annotations: everything(), ..scene() };
        scene.look.background = background;
        scene.environment.map = crate::scene::EnvironmentMap::Constant(sky);
        let world = World::build(&scene).unwrap();
        ink(&world, &scene.look).max_element()
    };
    assert!(darkest(Background::Sky, Rgb::ONE) < 0.1);
    assert!(darkest(Background::Sky, Rgb::ZERO) > 0.5);
    assert!(darkest(Background::Color(Rgb::ONE), Rgb::ZERO) < 0.1);
    assert!(darkest(Background::Color(Rgb::ZERO), Rgb::ONE) > 0.5);
    assert!(darkest(Background::Transparent, Rgb::ZERO) < 0.1);
}

#[test]
fn scale_bars_have_their_length_at_the_target() {
    for projection in
        [Projection::Perspective { fov: 40.0 }, Projection::Orthographic { height: None }]
    {
        let mut scene = scene();
        scene.camera = Camera { projection, ..Camera::default() };
        let bar = ScaleBar { length: Some(2.0), position: Anchor::TopLeft, ..ScaleBar::default() };
        scene.annotations.scale_bar = Some(bar);
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 40.0, target: DVec3::Z * 9.0 };
        let world = World::build(&scene).unwrap();
        let ends = [DVec3::Z * 9.0, DVec3::new(2.0, 0.0, 9.0)]
            .map(|end| world.camera.pixel(world.camera.view(world.transform.point(end))));
        let expected = ends[0].distance(ends[1]);
        let (image, _) = drawn(&scene, false);
        let dark = |y: u32| -> f32 {
            (0..SIZE.0).map(|x| 1.0 - image.pixel(x, y).unwrap()[0]).sum::<f32>() / 0.98
        };
        let longest = (0..SIZE.1).map(dark).fold(0.0, f32::max);
        assert!((f64::from(longest) - expected).abs() < 0.1, "{longest} {expected}");
    }
}

#[test]
fn letters_shrink_until_all_fits() {
    let long = |count| {
        let label = Label { text: "w".repeat(count), position: Anchor::Top, at: None };
        let mut scene = scene();
        scene.annotations.labels = vec![label];
        drawn(&scene, false).1
    };
    assert!(long(10) && long(50) && !long(500));
    let entries = vec![(Rgb::ONE, "type".to_owned()); 200];
    let mut scene = scene();
    scene.annotations.legend = Some(ColorLegend { entries, ..ColorLegend::default() });
    assert_eq!(insets(&scene, false), Insets::default(), "no room");
    assert!(!drawn(&scene, false).1);
}

#[test]
fn turning_tripods_stay_in_their_place() {
    let mut scene = scene();
    scene.annotations.axes = Some(AxisTripod::default());
    let insets = |direction, turns| {
        let mut scene = Scene { spheres: scene.spheres.clone(), ..scene.clone() };
        scene.camera.pose = Pose::Fit { direction, margin: 0.05 };
        insets(&scene, turns)
    };
    let (side, corner) = (DVec3::NEG_Z, DVec3::NEG_ONE);
    assert_ne!(insets(side, false), insets(corner, false));
    assert_eq!(insets(side, true), insets(corner, true));
}

#[test]
fn measures_and_labels_are_drawn_over_spheres() {
    let mut scene = scene();
    scene.camera.projection = Projection::Orthographic { height: Some(20.0) };
    let (eye, target) = (DVec3::new(4.5, 4.5, 50.0), DVec3::splat(4.5));
    (scene.camera.pose, scene.camera.up) = (Pose::LookAt { eye, target }, DVec3::Y);
    let at = |x: f64, y: f64| DVec3::new(4.5 + x, 4.5 + y, 0.0);
    let changed = |annotations: Annotations| {
        let scene = Scene { annotations, ..scene.clone() };
        let (image, fits) = drawn(&scene, false);
        assert!(fits);
        // Bounds of the pixels that are changed; 12 of them are as long as the scene's unit.
        let all = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let dark = all.filter(|&(x, y)| image.pixel(x, y).is_some_and(|own| own != [1.0; 3]));
        dark.fold([u32::MAX, u32::MAX, 0, 0], |[left, top, right, bottom], (x, y)| {
            [left.min(x), top.min(y), right.max(x), bottom.max(y)]
        })
    };
    // Half a line, and the white around it, are thinner than two pixels.
    let points = vec![at(-8.0, 5.0), at(8.0, 5.0)];
    let measure = Measure { points, unit: String::new() };
    let lines = changed(Annotations { measures: vec![measure], ..Annotations::default() });
    assert_eq!([lines[0], lines[2]], [160 - 96, 160 + 95], "{lines:?}");
    assert!(lines[1] >= 50 && lines[3] <= 70, "{lines:?}");
    let label = Label { text: "CA".to_owned(), position: Anchor::Top, at: Some(at(-8.0, -5.0)) };
    let [left, top, right, bottom] =
        changed(Annotations { labels: vec![label.clone()], ..Annotations::default() });
    assert!((62..=66).contains(&(left.midpoint(right))), "{left} {right}");
    assert!((178..=182).contains(&(top.midpoint(bottom))), "{top} {bottom}");
    // Beyond the image, and behind the camera.
    for at in [at(200.0, 0.0), DVec3::new(4.5, 4.5, 51.0)] {
        let labels = vec![Label { at: Some(at), ..label.clone() }];
        let points = vec![at, at + DVec3::Z];
        let measures = vec![Measure { points, unit: String::new() }];
        let none = changed(Annotations { labels, measures, ..Annotations::default() });
        assert_eq!(none, [u32::MAX, u32::MAX, 0, 0]);
    }
}
