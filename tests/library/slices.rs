//! Slices: hits of cut spheres by all traversals, compared with an oracle and closed forms.

use crate::common::{
    assert_every_pixel, assert_expected, dark, emitter, furnace, glass, ground, lambertian, look,
    look_parallel, material, mean, menagerie, mirror, noon, probe, render_scene, render_scene_with,
    sphere,
};
use glam::{DVec3, Vec3};
use spherule_render::layers::{Layer, layers};
use spherule_render::ray::{GROUND, Hits, MISS, Rays};
use spherule_render::render::Options;
use spherule_render::sampling::{stream, uniform_sphere, unit};
use spherule_render::scene::{Material, Rgb, Scene, Slice, SliceMode};
use spherule_render::trace::{self, PacketWidth, Tracer, Traversal};
use spherule_render::world::{World, WorldError};

fn slice(normal: DVec3, distance: f64, mode: SliceMode) -> Slice {
    Slice { normal: normal.normalize(), distance, mode }
}

fn caps(normal: DVec3, distance: f64) -> Slice {
    slice(normal, distance, SliceMode::Caps)
}

/// Returns the random numbers of a test.
struct Numbers(u64);

impl Numbers {
    fn unit(&mut self) -> f32 {
        self.0 += 1;
        unit(stream(0x51ce, self.0) as u32)
    }
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
    fn direction(&mut self) -> Vec3 {
        uniform_sphere([self.unit(), self.unit()])
    }
}

/// Returns overlapping spheres, cut by some planes.
fn crowd(slices: Vec<Slice>) -> Scene {
    let (mut scene, n) = (dark(), &mut Numbers(3));
    let row = material(&mut scene, lambertian(0.5));
    for _ in 0..300 {
        let radius = 0.05 + 0.2 * f64::from(n.unit());
        scene.spheres.push(n.point().as_dvec3(), radius, row, Rgb::ONE);
    }
    scene.slices = slices;
    scene
}

/// Perturbation of the oracle. Results that it changes cannot be decided in single precision, and are
/// skipped.
#[derive(Clone, Copy, Default)]
struct Shift {
    radius: f64,
    height: f64,
    origin: DVec3,
}

/// The oracle: the remaining part of each sphere is convex, so a ray hits its near end from outside and its
/// far end from inside. Returns distance and row of the nearest hit, in double precision.
fn nearest(
    world: &World,
    slices: &[Slice],
    rays: &Rays,
    row: usize,
    by: Shift,
) -> Option<(f64, u32)> {
    let (origin, d) =
        (rays.origin.row(row).as_dvec3() + by.origin, rays.direction.row(row).as_dvec3());
    let (mut from, mut to) = (0.0_f64, f64::INFINITY);
    for slice in slices {
        let height = world.transform.length(slice.depth(world.transform.shift)) + by.height;
        let (above, rise) = (slice.normal.dot(origin) + height, slice.normal.dot(d));
        if rise < 0.0 {
            from = from.max(-above / rise);
        } else if rise > 0.0 {
            to = to.min(-above / rise);
        } else if above > 0.0 {
            return None;
        }
    }
    let mut best: Option<(f64, f64, u32)> = None;
    for sphere in 0..world.spheres.len() {
        if sphere as u32 == rays.own[row] {
            continue;
        }
        let (center, radius) = world.spheres.exact(sphere);
        let (f, r) = (origin - center, radius * (1.0 + by.radius));
        let (a, b) = (d.length_squared(), -f.dot(d));
        let square = b * b - a * (f.length_squared() - r * r);
        if square <= 0.0 {
            continue;
        }
        let (near, far) = ((b - square.sqrt()) / a, (b + square.sqrt()) / a);
        let (near, far) = (near.max(from), far.min(to));
        if near >= far {
            continue;
        }
        let t = if near > 0.0 { near } else { far };
        let power = (origin + d * t - center).length_squared() - r * r;
        // Many caps are at the same distance.
        let closer = |(other, least, _)| (t, power) < (other, least);
        if best.is_none_or(closer) {
            best = Some((t, power, sphere as u32));
        }
    }
    best.map(|(t, _, sphere)| (t, sphere))
}

/// Returns rays from random points in space and on surfaces, in the world's unit.
fn rays(world: &World, count: usize) -> Rays {
    let (mut rays, n) = (Rays::with_capacity(count), &mut Numbers(9));
    for i in 0..count {
        let (direction, target) = (n.direction(), n.point());
        if i % 2 == 0 {
            let origin = n.direction() * (0.2 + 2.0 * n.unit());
            rays.push(origin, (target * 0.3 - origin).normalize(), MISS);
        } else {
            rays.push(n.point() * world.transform.scale as f32, direction, GROUND);
        }
    }
    rays
}

fn planes() -> Vec<Vec<Slice>> {
    vec![
        vec![caps(DVec3::Z, 0.1)],
        vec![caps(DVec3::new(0.3, -0.5, 0.2), -0.05), caps(DVec3::NEG_X, 0.2)],
        vec![caps(DVec3::Z, 0.2), caps(DVec3::NEG_Z, 0.15), caps(DVec3::ONE, 0.3)],
    ]
}

#[test]
fn hits_on_cut_spheres_agree_with_closed_forms() {
    let shift = |radius: f64, height: f64, x: f64| Shift {
        radius,
        height,
        origin: DVec3::new(x, -0.6 * x, 0.8 * x),
    };
    let e = 3e-6;
    let shifts = [shift(e, e, e), shift(-e, e, -e), shift(e, -e, -e), shift(-e, -e, e)];
    for slices in planes() {
        let scene = crowd(slices.clone());
        let mut world = World::build(&scene).expect("a sound scene");
        world.features.around_camera = true;
        let rays = rays(&world, 4000);
        let mut hits = Hits::with_capacity(rays.len());
        trace::closest(Tracer::default(), &world, &rays, &mut hits);
        let (mut found, mut unclear) = (0, 0);
        for row in 0..rays.len() {
            let truth = |by| nearest(&world, &slices, &rays, row, by);
            let expected = truth(Shift::default());
            let sphere = expected.map_or(MISS, |hit| hit.1);
            if shifts.iter().any(|&by| truth(by).map_or(MISS, |hit| hit.1) != sphere) {
                unclear += 1;
                continue;
            }
            assert_eq!(hits.sphere[row], sphere, "{row} {expected:?} {}", hits.t[row]);
            if let Some((t, _)) = expected {
                assert!((hits.t[row] - t).abs() < 2e-3 * t.max(0.01), "{row} {t} {}", hits.t[row]);
                found += 1;
            }
        }
        assert!(found > 500 && unclear < 40, "{found} {unclear}");
    }
}

#[test]
fn any_hit_queries_agree_with_closest_hits() {
    for slices in planes() {
        let world = World::build(&crowd(slices)).expect("a sound scene");
        let rays = rays(&world, 3000);
        let (mut hits, mut any) = (Hits::with_capacity(3000), Hits::with_capacity(3000));
        let tracer = Tracer::default();
        trace::closest(tracer, &world, &rays, &mut hits);
        for (row, factor) in (0..rays.len()).zip([0.5, 0.99999, 1.00001, 2.0].into_iter().cycle()) {
            let bound = if hits.sphere[row] == MISS { 9.0 } else { hits.t[row] * factor };
            any.set(row, bound, MISS);
        }
        let bounds = any.t.clone();
        trace::occluded(tracer, &world, &rays, &mut any);
        for (row, &bound) in bounds.iter().enumerate().take(rays.len()) {
            let nearer = hits.sphere[row] != MISS && hits.t[row] < bound;
            assert_eq!(any.sphere[row] != MISS, nearer, "{row}");
        }
    }
}

#[test]
fn pictures_are_the_same_for_every_traversal() {
    let mut scene = menagerie();
    let opaque = lambertian(0.6);
    for named in &mut scene.materials {
        if matches!(named.material, Material::Dielectric { .. }) {
            named.material = opaque.clone();
        }
    }
    for mode in [SliceMode::Caps, SliceMode::Hide, SliceMode::Remove] {
        scene.slices = vec![slice(DVec3::new(0.5, -1.0, 0.2), 1.0, mode), caps(DVec3::Z, 4.5)];
        let usual = render_scene(&scene).image;
        for traversal in [Traversal::Brute, Traversal::Single, Traversal::Stream, Traversal::Packet]
        {
            for width in PacketWidth::ALL {
                let options = Options { tracer: Tracer { traversal, width }, ..Options::default() };
                assert_eq!(
                    render_scene_with(&scene, &options).image,
                    usual,
                    "{mode:?} {traversal:?} {width:?}"
                );
            }
        }
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let image = pool.expect("threads").install(|| render_scene(&scene).image);
            assert_eq!(image, usual, "{mode:?} {threads}");
        }
    }
}

/// Returns a half sphere of radius 1, seen by parallel rays in an image of 4 x 4 units.
fn half(eye: DVec3) -> Scene {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
    scene.slices = vec![caps(DVec3::Z, 0.0)];
    look_parallel(&mut scene, eye, DVec3::ZERO, 4.0);
    (scene.settings.width, scene.settings.height) = (64, 64);
    scene
}

#[test]
fn half_a_sphere_has_half_its_outline_and_a_round_cap() {
    let area = |scene: &Scene| {
        let world = World::build(scene).expect("a sound scene");
        let found = layers(&world, &scene.settings, &Options::default(), &[Layer::Normal])
            .expect("settings in range");
        let sum = |of: fn(&spherule_render::layers::Features) -> f32| {
            found.pixels.iter().map(|pixel| f64::from(of(pixel))).sum::<f64>() * 16.0 / 4096.0
        };
        [sum(|pixel| pixel.coverage), sum(|pixel| pixel.normal[2])]
    };
    let pi = std::f64::consts::PI;
    let near = |found: f64, truth: f64| assert!((found - truth).abs() < 0.01, "{found} {truth}");
    let [side, _] = area(&half(DVec3::X * 5.0));
    near(side, pi / 2.0);
    // From above, only the cap is visible, with an upward normal.
    let [above, upward] = area(&half(DVec3::Z * 5.0));
    near(above, pi);
    near(upward, pi);
    let [below, downward] = area(&half(DVec3::Z * -5.0));
    near(below, pi);
    near(downward, -2.0 / 3.0 * pi);
    // At 45 degrees: a half disk and a half ellipse beyond it, or the whole cap and the part of the sphere
    // below it.
    let [slanted, _] = area(&half(DVec3::new(5.0, 0.0, 5.0)));
    near(slanted, pi / 2.0 * (1.0 + 0.5_f64.sqrt()));
}

#[test]
fn caps_have_the_color_of_their_sphere() {
    // Under a white sky, a convex body of albedo 0.5 has radiance 0.5, including its cap.
    let mut scene = half(DVec3::Z * 5.0);
    look_parallel(&mut scene, DVec3::new(0.0, 1e-3, 5.0), DVec3::ZERO, 1e-3);
    for pixel in &render_scene(&scene).image.pixels {
        assert!((pixel[0] - 0.5).abs() < 1e-6, "{pixel:?}");
    }
    // Two overlapping spheres: their border on the cap is in the middle.
    scene.spheres.push(DVec3::X * 1.2, 1.0, 0, Rgb::new(1.0, 0.5, 0.5));
    for (x, green) in [(0.59, 0.5), (0.61, 0.25)] {
        let at = DVec3::X * x;
        look_parallel(&mut scene, at + DVec3::Z * 5.0, at, 1e-3);
        for pixel in &render_scene(&scene).image.pixels {
            assert!((pixel[1] - green).abs() < 1e-6, "{x} {pixel:?}");
        }
    }
}

#[test]
fn a_section_through_a_crystal_is_flat() {
    let mut scene = furnace();
    let row = material(&mut scene, lambertian(1.0));
    for i in 0..1000_i32 {
        let place = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100));
        scene.spheres.push(place, 0.5, row, Rgb::ONE);
    }
    // Within a layer of spheres: a square lattice of circles of radius 0.4.
    scene.slices = vec![caps(DVec3::Z, 5.3)];
    let middle = DVec3::new(4.5, 4.5, 5.0);
    look_parallel(&mut scene, middle + DVec3::Z * 20.0, middle, 10.0);
    (scene.settings.width, scene.settings.height) = (100, 100);
    let world = World::build(&scene).expect("a sound scene");
    assert_eq!((world.features.cut_away, world.features.cuts), (400, 1));
    let found = layers(&world, &scene.settings, &Options::default(), &[Layer::Normal])
        .expect("settings in range");
    let flat = found.pixels.iter().filter(|pixel| pixel.normal[2] > 1.0 - 1e-6);
    assert!(flat.clone().all(|pixel| (pixel.depth - 19.7).abs() < 1e-4));
    let share = flat.count() as f64 / 1e4;
    // Pixels on the edges of circles are only partly covered.
    assert!((0.3..0.5).contains(&share), "{share}");
    // A white crystal under a white sky is invisible, wherever it is cut.
    scene.settings.spp = 4;
    assert_every_pixel(&render_scene(&scene).image, 1.0, "a white crystal");
}

#[test]
fn hidden_parts_keep_their_shadow() {
    let mut scene = noon();
    let radiance = |scene: &Scene, eye: DVec3, at: DVec3| {
        let mut scene = scene.clone();
        look_parallel(&mut scene, eye, at, 1e-3);
        mean(&render_scene(&scene).image)
    };
    let (above, side) = (DVec3::Z * 9.0, DVec3::new(9.0, 0.0, 0.5));
    let sunny = 0.5 / std::f64::consts::PI;
    for (mode, seen, shadow) in [
        (None, sunny, 0.0),
        (Some(SliceMode::Hide), 0.0, 0.0),
        (Some(SliceMode::Remove), sunny, sunny),
    ] {
        scene.slices = mode.map(|mode| slice(DVec3::Z, 2.0, mode)).into_iter().collect();
        // From above, the sphere or the ground is visible; from the side, only the ground.
        assert!((radiance(&scene, above, DVec3::ZERO) - seen).abs() < 1e-6, "{mode:?}");
        assert!((radiance(&scene, side, DVec3::ZERO) - shadow).abs() < 1e-6, "{mode:?}");
        let beside = DVec3::X * 2.0;
        assert!((radiance(&scene, side, beside) - sunny).abs() < 1e-6, "{mode:?}");
    }
}

/// Lamps in the picture are sampled where a mirror is in the scene; all paths are of one batch here.
#[test]
fn hidden_lamps_are_seen_in_mirrors_alone() {
    let mut scene = dark();
    sphere(&mut scene, [-1.0, 0.0, 0.0], 0.6, mirror());
    sphere(&mut scene, [0.42, 0.0, 0.0], 0.35, emitter(10.0, 0.0));
    look(&mut scene, DVec3::new(0.0, 0.0, 8.0), DVec3::ZERO, 30.0);
    let sums = |scene: &Scene| {
        let pixels = render_scene(scene).image.pixels;
        let sum = |columns: std::ops::Range<usize>| -> f32 {
            pixels.chunks(16).flat_map(|row| &row[columns.clone()]).map(|pixel| pixel[0]).sum()
        };
        [sum(0..8), sum(8..16)]
    };
    let [mirrored, direct] = sums(&scene);
    assert!(mirrored > 0.01 && direct > 0.1, "{mirrored} {direct}");
    scene.slices = vec![slice(DVec3::X, 0.3, SliceMode::Hide)];
    assert_eq!(sums(&scene), [mirrored, 0.0]);
    scene.slices = vec![slice(-DVec3::X, 0.5, SliceMode::Hide)];
    assert_eq!(sums(&scene), [0.0, direct]);
    // Hidden veils before a lamp that is not hidden.
    scene.slices = vec![slice(DVec3::Y, 0.6, SliceMode::Hide)];
    for row in 0..20 {
        let place = 0.3 * f64::from(row) - 3.0;
        sphere(&mut scene, [place, 1.0, 1.0], 0.95, lambertian(0.5));
    }
    assert_eq!(sums(&scene)[1], direct);
}

#[test]
fn removed_spheres_are_absent() {
    let mut cut = menagerie();
    cut.slices = vec![slice(DVec3::Z, 3.5, SliceMode::Remove)];
    let world = World::build(&cut).expect("a sound scene");
    let above = (0..cut.spheres.len()).filter(|&row| cut.spheres.z[row] > 3.5).count();
    assert_eq!(world.features.cut_away, above as u64);
    let picture = render_scene(&cut).image;
    let mut dropped = cut.clone();
    assert_eq!(dropped.drop_cut(), above);
    dropped.slices.clear();
    assert_eq!(render_scene(&dropped).image, picture);
}

#[test]
fn half_an_emitter_lights_as_its_disk() {
    let mut scene = dark();
    sphere(&mut scene, [0.0, 0.0, 2.0], 1.0, emitter(4.0, 0.0));
    ground(&mut scene, lambertian(0.5));
    scene.slices = vec![caps(DVec3::NEG_Z, -2.0)];
    // The disk at height 2 subtends an angle with a squared sine of 1/5.
    let estimate = probe(&mut scene, DVec3::ZERO, DVec3::new(6.0, 0.0, 2.0));
    assert_expected(estimate, 0.5 * 4.0 / 5.0, "below half an emitter");
}

#[test]
fn glass_has_no_caps() {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
    sphere(&mut scene, [3.0, 0.0, 0.0], 1.0, glass(1.5));
    let mut built = |slice: Slice| {
        scene.slices = vec![slice];
        World::build(&scene)
    };
    assert!(matches!(built(caps(DVec3::Z, 0.5)), Err(WorldError::Glass(1))));
    assert!(built(caps(DVec3::X, 1.5)).is_ok() && built(caps(DVec3::Z, 1.0)).is_ok());
    assert!(built(slice(DVec3::Z, 0.5, SliceMode::Remove)).is_ok());
    let crooked = Slice { normal: DVec3::ONE, distance: 0.0, mode: SliceMode::Caps };
    assert!(matches!(built(crooked), Err(WorldError::Invalid(_))));
}

#[test]
fn cameras_frame_the_remaining_spheres() {
    let mut scene = furnace();
    for x in [0.0, 10.0] {
        sphere(&mut scene, [x, 0.0, 0.0], 1.0, lambertian(0.5));
    }
    scene.camera = spherule_render::scene::Camera::default();
    scene.slices = vec![caps(DVec3::X, 5.0)];
    let world = World::build(&scene).expect("a sound scene");
    let eye = world.camera.eye / world.transform.scale + world.transform.shift;
    assert!(eye.length() < 6.0, "{eye}");
    scene.slices = vec![caps(DVec3::X, -5.0)];
    assert!(matches!(World::build(&scene), Err(WorldError::NothingToFit)));
    look(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 40.0);
    assert_every_pixel(&render_scene(&scene).image, 1.0, "nothing is left");
}
