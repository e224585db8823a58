//! Properties of bodies of all kinds but spheres, for each kind alike, and helpers of other tests of bodies.

use crate::common::{
    assert_every_pixel, assert_expected, dark, furnace, glass, lambertian, look, look_parallel,
    material, measure, metal, mirror, render_scene, render_scene_with, sphere,
};
use glam::{DQuat, DVec3};
use spherule_render::body_rows::BodyKind;
use spherule_render::layers::{Features, Layer, layers};
use spherule_render::ray::{GROUND, Hits, MISS, Rays};
use spherule_render::render::Options;
use spherule_render::sampling::{stream, unit};
use spherule_render::scene::{Material, Rgb, Scene, Slice, SliceMode, Spheres, write};
use spherule_render::trace::{self, PacketWidth, Tracer, Traversal};
use spherule_render::world::World;

/// Returns numbers from 0 to 1.
pub(crate) fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut count = 0;
    move || {
        count += 1;
        f64::from(unit(stream(seed, count) as u32))
    }
}

/// A scene without light that the camera sees from the z axis, six units high, with a hundred pixels for a unit of area.
pub(crate) fn parallel() -> Scene {
    let mut scene = dark();
    look_parallel(&mut scene, DVec3::Z * 10.0, DVec3::ZERO, 6.0);
    (scene.settings.width, scene.settings.height) = (60, 60);
    scene
}

/// The layers of all pixels.
pub(crate) fn features(scene: &Scene) -> Vec<Features> {
    let world = World::build(scene).expect("a valid scene");
    layers(&world, &scene.settings, &Options::default(), &Layer::ALL)
        .expect("valid settings")
        .pixels
}

/// The pixel of [`parallel`] at a place.
pub(crate) fn at(features: &[Features], x: f64, y: f64) -> Features {
    let pixel = |v: f64| ((v + 3.0) * 10.0) as usize;
    features[pixel(-y) * 60 + pixel(x)]
}

/// Compares the hits of all traversals and widths with those of all bodies, without slices and with each kind of them, and calls
/// `count` with each hit on a body.
pub(crate) fn assert_traversals_agree(scene: &Scene, mut count: impl FnMut(&World, usize)) {
    let mut slices = vec![Vec::new()];
    for mode in [SliceMode::Caps, SliceMode::Hide, SliceMode::Remove] {
        slices.push(vec![Slice { normal: DVec3::X, distance: 0.1, mode }]);
    }
    for slices in slices {
        let world = World::build(&Scene { slices, ..scene.clone() }).expect("a valid scene");
        let (mut number, unit) = (numbers(9), world.transform.length(1.0));
        for from_camera in [true, false] {
            let mut rays = Rays::with_capacity(500);
            for _ in 0..500 {
                let mut point =
                    || DVec3::from([number(), number(), number()].map(|x| 2.0 * x - 1.0)) * unit;
                let own = if from_camera { MISS } else { GROUND };
                let origin = point() * 2.0;
                let direction = (point() - origin).normalize();
                rays.push(origin.as_vec3(), direction.as_vec3(), own);
            }
            let found = |traversal, width| {
                let (mut hits, mut shadows) = (Hits::with_capacity(500), Hits::with_capacity(500));
                let tracer = Tracer { traversal, width };
                trace::closest(tracer, &world, &rays, &mut hits);
                trace::occluded(tracer, &world, &rays, &mut shadows);
                let hidden =
                    shadows.sphere.iter().map(|&sphere| sphere != MISS).collect::<Vec<_>>();
                (hits.sphere, hidden)
            };
            let expected = found(Traversal::Brute, PacketWidth::One);
            for traversal in
                [Traversal::Single, Traversal::Stream, Traversal::Packet, Traversal::Auto]
            {
                for width in PacketWidth::ALL {
                    assert_eq!(found(traversal, width), expected);
                }
            }
            for (row, (&hit, &hidden)) in expected.0.iter().zip(&expected.1).enumerate() {
                assert_eq!(hit != MISS, hidden, "row {row}");
                if hit != MISS {
                    count(&world, hit as usize);
                }
            }
        }
    }
}

/// Compares the picture of one thread and single rays with those of packets and more threads.
pub(crate) fn assert_one_picture(scene: &Scene) {
    let picture = |traversal, width, threads| {
        let tracer = Tracer { traversal, width };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let options = Options { tracer, ..Options::default() };
        pool.install(|| render_scene_with(scene, &options).image.pixels)
    };
    let expected = picture(Traversal::Single, PacketWidth::One, 1);
    for (width, threads) in [(PacketWidth::Four, 2), (PacketWidth::Sixteen, 3)] {
        assert!(picture(Traversal::Auto, width, threads) == expected);
    }
}

/// A rotation about no axis of coordinates.
pub(crate) fn turned() -> DQuat {
    DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1)
}

/// Appends a body of a kind about a center, within a box with these half sides, the longest first or second: with a material and a color.
type Push = fn(&mut Scene, DVec3, DVec3, u32, Rgb);

/// The kinds.
const KINDS: [(BodyKind, Push); BodyKind::ALL.len() - 1] = [
    (BodyKind::Capsule, |scene, center, half, row, color| {
        let (axis, radius) = (longest(half), half.min_element());
        let end = axis * (half.max_element() - radius);
        scene.sticks.push([center - end, center + end], radius, row, [color; 2]);
    }),
    (BodyKind::Ellipsoid, |scene, center, half, row, color| {
        scene.ellipsoids.push(center, half, DQuat::IDENTITY, row, color);
    }),
    (BodyKind::Cone, |scene, center, half, row, color| {
        let axis = longest(half);
        let radius = (half - axis * half.max_element()).max_element();
        let end = axis * half.max_element();
        scene.cones.push(center + end, center - end, radius, row, color);
    }),
    (BodyKind::Triangle, |scene, center, half, row, color| {
        let long = longest(half) * half.max_element();
        let rest = half - long;
        let side = longest(rest) * rest.max_element();
        let corners = [center + long, center - long + side, center - long - side];
        scene.triangles.push(corners, row, color);
    }),
];

/// The axis along which a box is longest.
fn longest(half: DVec3) -> DVec3 {
    DVec3::AXES[half.max_position()]
}

/// Spheres and bodies of all kinds, many of which overlap.
fn bodies() -> Scene {
    let mut scene = furnace();
    let rows = [material(&mut scene, lambertian(0.7)), material(&mut scene, metal(0.1))];
    let mut number = numbers(8);
    let mut point = || DVec3::from([number(), number(), number()].map(|x| 2.0 * x - 1.0));
    for i in 0..60 {
        for (_, push) in KINDS {
            let half = [DVec3::new(0.25, 0.1, 0.05), DVec3::new(0.1, 0.2, 0.1)][i % 2];
            let color = [Rgb::ONE, Rgb::X][i % 2];
            push(&mut scene, point(), half, rows[usize::from(i % 5 == 0)], color);
        }
        let (base, axis) = (point(), point());
        if i % 3 == 0 {
            // An arrow, which begins in a sphere, and an ellipsoid that is turned.
            scene.spheres.push(base, 0.1, rows[0], Rgb::ONE);
            scene.sticks.push([base, base + axis * 0.5], 0.1, rows[0], [Rgb::ONE, Rgb::Z]);
            let apex = base + axis * 0.5 + axis.normalize() * 0.3;
            scene.cones.push(apex, base + axis * 0.5, 0.15, rows[0], Rgb::Z);
            let semi_axes = DVec3::new(0.3, 0.1, 0.05);
            scene.ellipsoids.push(point(), semi_axes, turned(), rows[0], Rgb::Y);
        }
    }
    look(&mut scene, DVec3::new(0.5, 0.8, 4.0), DVec3::ZERO, 40.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (48, 32, 4);
    scene
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

/// Returns how often bodies of each kind are hit, by all traversals.
fn hits_by_kind(scene: &Scene) -> [usize; BodyKind::ALL.len()] {
    let mut counts = [0; BodyKind::ALL.len()];
    assert_traversals_agree(scene, |world, hit| {
        let body = world.body(hit as u32).expect("a body");
        counts[body.kind as usize] += 1;
    });
    counts
}

#[test]
fn all_traversals_find_the_same_hits() {
    let counts = hits_by_kind(&bodies());
    assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
    let [of_spheres, of_sticks, ..] = hits_by_kind(&molecule());
    assert!(of_sticks > 500 && of_spheres > 100, "{of_sticks} {of_spheres}");
}

#[test]
fn pictures_do_not_depend_on_widths_and_threads() {
    assert_one_picture(&molecule());
    let mut scene = bodies();
    assert_one_picture(&scene);
    let surface = Box::new(scene.materials[0].material.clone());
    scene.materials[0].material = Material::Translucent { opacity: 0.4, surface };
    assert_one_picture(&scene);
}

#[test]
fn the_background_is_attenuated_by_translucent_bodies() {
    for (kind, push) in KINDS {
        let mut scene = furnace();
        let surface = Box::new(lambertian(0.0));
        let row = material(&mut scene, Material::Translucent { opacity: 0.3, surface });
        for z in [-0.4, 0.0, 0.4] {
            push(&mut scene, DVec3::Z * z, DVec3::new(1.5, 1.0, 0.3), row, Rgb::ONE);
        }
        look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
        assert_expected(measure(&scene), 0.7_f64.powi(3), kind.name());
    }
}

/// Twenty bodies have their own material, among twenty of another kind, as five of them have.
#[test]
fn each_of_many_bodies_has_its_own_material() {
    for (kind, push) in KINDS {
        let mut scene = furnace();
        let black = material(&mut scene, metal(0.0));
        let white = material(&mut scene, lambertian(1.0));
        for x in 0..20 {
            let (center, away) = (DVec3::X * f64::from(x), DVec3::new(f64::from(x), 9.0, 0.0));
            push(&mut scene, center, DVec3::new(0.4, 0.3, 0.2), white, Rgb::ONE);
            scene.spheres.push(away, 0.2, black, Rgb::ONE);
        }
        let mut alone = scene.clone();
        alone.spheres = Spheres::default();
        for mut scene in [scene, alone] {
            for x in [0.0, 19.0] {
                look_parallel(&mut scene, DVec3::new(x, 0.0, 5.0), DVec3::X * x, 0.1);
                assert_expected(measure(&scene), 1.0, kind.name());
            }
        }
    }
}

#[test]
fn slices_remove_and_hide_bodies_by_their_middles() {
    for (kind, push) in KINDS {
        let mut scene = parallel();
        let row = material(&mut scene, lambertian(0.5));
        for x in [-1.5, 1.5] {
            push(&mut scene, DVec3::X * x, DVec3::new(0.4, 1.0, 0.3), row, Rgb::ONE);
        }
        for mode in [SliceMode::Remove, SliceMode::Hide] {
            scene.slices = vec![Slice { normal: DVec3::X, distance: 0.0, mode }];
            let features = features(&scene);
            let ids = (at(&features, -1.5, -0.5).id, at(&features, 1.5, -0.5).id);
            assert_eq!(ids, (0, MISS), "{kind:?} {mode:?}");
        }
    }
}

#[test]
fn hidden_bodies_still_throw_shadows() {
    for (kind, push) in KINDS {
        let mut scene = furnace();
        sphere(&mut scene, DVec3::ZERO, 0.5, lambertian(0.5));
        look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 10.0);
        let free = measure(&scene);
        let row = material(&mut scene, lambertian(0.0));
        push(&mut scene, DVec3::Z * 1.6, DVec3::new(3.0, 1.0, 0.4), row, Rgb::ONE);
        scene.slices = vec![Slice { normal: DVec3::Z, distance: 1.0, mode: SliceMode::Hide }];
        let shaded = measure(&scene);
        assert!(shaded.mean < free.mean - 0.05, "{kind:?} {shaded:?} {free:?}");
    }
}

#[test]
fn nothing_is_seen_from_within() {
    // Triangles have no inside.
    let solid = KINDS.into_iter().filter(|(kind, _)| *kind != BodyKind::Triangle);
    for (kind, push) in solid {
        let mut scene = furnace();
        scene.settings.depth = Some(3);
        let row = material(&mut scene, lambertian(0.9));
        push(&mut scene, DVec3::ZERO, DVec3::new(3.0, 1.0, 2.0), row, Rgb::ONE);
        look(&mut scene, DVec3::new(0.2, 0.1, 0.0), DVec3::new(1.0, 0.5, 0.2), 60.0);
        assert_every_pixel(&render_scene(&scene).image, 0.0, kind.name());
    }
}

#[test]
fn white_bodies_vanish_in_a_furnace() {
    for (kind, push) in KINDS {
        for surface in [mirror(), lambertian(1.0)] {
            let mut scene = furnace();
            scene.settings.depth = None;
            let row = material(&mut scene, surface);
            push(&mut scene, DVec3::ZERO, DVec3::new(1.2, 0.6, 0.2), row, Rgb::ONE);
            let turned = turned() * DVec3::Z * 4.0;
            look(&mut scene, turned, DVec3::ZERO, 40.0);
            assert_expected(measure(&scene), 1.0, kind.name());
        }
    }
}

#[test]
fn written_scenes_keep_their_bodies() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bodies.toml");
    let scene = bodies();
    write(&scene, &path).unwrap();
    let read = Scene::load(&path).unwrap();
    assert_eq!((&read.sticks, &read.cones), (&scene.sticks, &scene.cones));
    assert_eq!(read.triangles, scene.triangles);
    let (mut found, expected) = (read.ellipsoids, scene.ellipsoids);
    for (a, b) in found.orientation.iter_mut().zip(&expected.orientation) {
        assert!(a.angle_between(*b) < 1e-7);
        *a = *b;
    }
    assert_eq!(found, expected);
}

#[test]
fn invalid_bodies_are_refused_by_name() {
    let refused = |change: &dyn Fn(&mut Scene), name: &str| {
        let mut scene = bodies();
        change(&mut scene);
        let error = World::build(&scene).unwrap_err().to_string();
        assert!(error.contains(name), "{name}: {error}");
    };
    for (name, change) in [
        ("stick 3", (|scene| scene.sticks.radius[3] = 0.0) as fn(&mut Scene)),
        ("stick 4", |scene| scene.sticks.from[4].x = f64::NAN),
        ("stick 6", |scene| scene.sticks.colors[6][1].x = 2.0),
        ("differ in length", |scene| scene.sticks.to.truncate(3)),
        ("ellipsoid 3", |scene| scene.ellipsoids.semi_axes[3].y = 0.0),
        ("ellipsoid 3", |scene| scene.ellipsoids.semi_axes[3].y = 1e9),
        ("ellipsoid 4", |scene| scene.ellipsoids.center[4].x = f64::NAN),
        ("ellipsoid 6", |scene| scene.ellipsoids.color[6].x = 2.0),
        ("ellipsoid 7", |scene| scene.ellipsoids.orientation[7].w = 9.0),
        ("differ in length", |scene| scene.ellipsoids.color.truncate(3)),
        ("cone 3", |scene| scene.cones.radius[3] = 0.0),
        ("cone 3", |scene| scene.cones.radius[3] = 1e9),
        ("cone 4", |scene| scene.cones.apex[4].x = f64::NAN),
        ("cone 4", |scene| scene.cones.base[4] = scene.cones.apex[4]),
        ("cone 6", |scene| scene.cones.color[6].x = 2.0),
        ("differ in length", |scene| scene.cones.color.truncate(3)),
        ("triangle 3", |scene| scene.triangles.corners[3][1].x = f64::INFINITY),
        ("triangle 4", |scene| {
            scene.triangles.corners[4] = [DVec3::X, DVec3::X * 3.0, DVec3::X * 2.0];
        }),
        ("triangle 6", |scene| scene.triangles.color[6].x = 2.0),
        ("differ in length", |scene| scene.triangles.color.truncate(3)),
    ] {
        refused(&change, name);
    }
    for (row, (kind, push)) in KINDS.into_iter().enumerate() {
        let last = bodies().other_bodies()[row].len();
        let half = DVec3::new(0.3, 0.2, 0.1);
        let name = format!("{} {last}", kind.name());
        refused(&|scene| push(scene, DVec3::ZERO, half, 9, Rgb::ONE), &name);
        let of_glass = |scene: &mut Scene| {
            let glass = material(scene, glass(1.5));
            push(scene, DVec3::ZERO, half, glass, Rgb::ONE);
        };
        refused(&of_glass, &format!("{name} must have a material, which cannot be glass"));
    }
}

#[test]
fn invalid_sections_of_bodies_are_refused() {
    for (body, keys, words) in [
        ("ellipsoid", "center = [0, 0, 0]\nsemi_axes = [1, 1, 0]", "0"),
        ("ellipsoid", "center = [0, 0, 0]\nsemi_axes = [1, 1]", "3 numbers"),
        ("ellipsoid", "center = [0, 0, 0]\nsemi_axes = [1, 1, 1e-9]", "16384"),
        (
            "ellipsoid",
            "center = [0, 0, 0]\nsemi_axes = [1, 1, 1]\norientation = [0, 0, 0, 0]",
            "quaternion",
        ),
        (
            "ellipsoid",
            "center = [0, 0, 0]\nsemi_axes = [1, 1, 1]\nmaterial = \"nowhere\"",
            "nowhere",
        ),
        ("ellipsoid", "center = [0, 0, 0]\nsemi_axes = [1, 1, 1]\nradius = 1", "radius"),
        ("cone", "apex = [0, 0, 0]\nbase = [0, 0, 1]\nradius = 0", "0"),
        ("cone", "apex = [0, 0, 0]\nbase = [0, 0, 0]\nradius = 1", "apex"),
        ("cone", "apex = [0, 0, 0]\nbase = [0, 0, 1]", "radius"),
        ("cone", "apex = [0, 0, 0]\nbase = [0, 0, 1]\nradius = 1e9", "16384"),
        (
            "cone",
            "apex = [0, 0, 0]\nbase = [0, 0, 1]\nradius = 1\nmaterial = \"nowhere\"",
            "nowhere",
        ),
        ("cone", "apex = [0, 0, 0]\nbase = [0, 0, 1]\nradius = 1\nheight = 1", "height"),
        ("triangle", "a = [0, 0, 0]\nb = [0, 0, 1]", "c = [x, y, z]"),
        ("triangle", "a = [0, 0, 0]\nb = [0, 0, 1]\nc = [0, 0, 3]", "one line"),
        ("triangle", "a = [0, 0, 0]\nb = [0, 0, 1]\nc = [0, 1, inf]", "inf"),
        ("triangle", "a = [0, 0, 0]\nb = [0, 0, 1]\nc = [0, 1, 0]\nradius = 1", "radius"),
        ("mesh", "path = \"nowhere.ply\"", "nowhere.ply"),
        ("mesh", "color = \"red\"", "path"),
    ] {
        let text = format!("[[{body}]]\n{keys}\n");
        let error = Scene::parse(&text, "test", std::path::Path::new("")).unwrap_err();
        assert!(error.to_string().contains(words), "{keys}: {error}");
    }
}

/// A closed mesh: an octahedron whose faces are divided, on a sphere, as PLY.
fn spherical_mesh(radius: f64) -> String {
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    for x in [DVec3::X, DVec3::NEG_X] {
        for (y, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            triangles.push([x, DVec3::Y * y, DVec3::Z * z]);
        }
    }
    for _ in 0..3 {
        let divided = triangles.iter().flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        triangles = divided.collect();
    }
    let count = triangles.len();
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        3 * count,
        count + 1
    );
    text.extend(triangles.as_flattened().iter().map(|corner| {
        let [x, y, z] = (*corner * radius).as_vec3().to_array();
        format!("{x} {y} {z}\n")
    }));
    let face = |first: usize| format!("3 {first} {} {}\n", first + 1, first + 2);
    text.extend((0..count).map(|row| face(3 * row)));
    // One without area.
    text + "3 0 1 1\n"
}

#[test]
fn meshes_are_closed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sphere.ply"), spherical_mesh(0.5)).unwrap();
    let path = folder.path().join("mesh.toml");
    let text = "[material.black]\nkind = \"lambertian\"\ncolor = 0\n\
                [[mesh]]\npath = \"sphere.ply\"\nscale = 2\nmaterial = \"black\"\n";
    std::fs::write(&path, text).unwrap();
    let mut scene = Scene::load(&path).unwrap();
    assert_eq!(scene.triangles.len(), 512);
    assert!(scene.warnings[0].contains("1 of 513 triangles"), "{:?}", scene.warnings);
    assert!(
        spherule_render::scene::included_files(&path)
            .iter()
            .any(|file| file.ends_with("sphere.ply"))
    );
    // No light of the white environment comes in.
    scene.settings.depth = Some(2);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (64, 64, 4);
    look(&mut scene, DVec3::new(0.2, 0.1, 0.0), DVec3::new(1.0, 0.5, 0.2), 120.0);
    assert_every_pixel(&render_scene(&scene).image, 0.0, "inside");
    // White from outside, and within it a sphere that nothing lights.
    scene.materials[scene.triangles.material[0] as usize].material = lambertian(1.0);
    scene.settings.depth = None;
    sphere(&mut scene, DVec3::ZERO, 0.9, lambertian(0.0));
    look(&mut scene, DVec3::Z * 4.0, DVec3::ZERO, 40.0);
    assert_expected(measure(&scene), 1.0, "furnace");
}
