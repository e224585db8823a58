//! Layers: compared with closed forms and brute force, and their channels in files.

mod channels;
mod mattes;

use crate::common::*;
use glam::DVec3;
use rayon::ThreadPoolBuilder;
use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::layers::{Features, GROUND_PLANE, Layer, Layers, NOTHING, layers};
use spherule_render::render::Options;
use spherule_render::scene::{ConductorFresnel, Material, Rgb, Scene};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};

fn all_of(scene: &Scene) -> Layers {
    with(scene, &Options::default())
}

fn with(scene: &Scene, options: &Options) -> Layers {
    let world = World::build(scene).expect("the scene is sound");
    layers(&world, &scene.settings, options, &Layer::ALL).expect("settings in range")
}

/// Returns the layers of a field of view that is so narrow that nothing varies.
fn through_window(scene: &mut Scene, eye: DVec3, point: DVec3, parallel: bool) -> Features {
    (scene.settings.width, scene.settings.height) = (2, 2);
    if parallel {
        look_parallel(scene, eye, point, 1e-7 * eye.distance(point));
    } else {
        look(scene, eye, point, 1e-5);
    }
    let pixels = all_of(scene).pixels;
    let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(pixels.iter().all(|other| close(other.normal, pixels[0].normal)), "{pixels:?}");
    pixels[0]
}

#[track_caller]
fn assert_sees(seen: Features, normal: DVec3, depth: f64, id: u32) {
    let off = (DVec3::from(seen.normal.map(f64::from)) - normal).length();
    assert!(off < 1e-5, "{seen:?}: not the normal {normal}");
    assert!((f64::from(seen.depth) / depth - 1.0).abs() < 1e-6, "{seen:?}: not at {depth}");
    assert_eq!((seen.coverage, seen.id), (1.0, id));
}

#[test]
fn one_sphere_is_known_in_closed_form() {
    // Near the origin and far away, small and large; the second sphere is not visible.
    for (center, radius) in [
        (DVec3::ZERO, 1.0),
        (DVec3::new(1e3, -2e3, 512.0), 0.125),
        (DVec3::new(-4e6, 1e6, 3e7), 1e6),
    ] {
        let mut scene = dark();
        sphere(&mut scene, center + DVec3::X * (4.0 * radius), radius, lambertian(0.5));
        sphere(&mut scene, center, radius, lambertian(0.25));
        let outside = center + DVec3::new(1.0, -5.0, 3.0) * radius;
        let inside = center + DVec3::new(0.25, 0.5, -0.25) * radius;
        for normal in [DVec3::new(0.6, -0.64, 0.48), DVec3::NEG_Y, DVec3::new(0.0, 0.28, 0.96)] {
            let point = center + normal * radius;
            for parallel in [false, true] {
                for (eye, side) in [(outside, 1.0), (inside, -1.0)] {
                    let seen = through_window(&mut scene, eye, point, parallel);
                    assert_sees(seen, normal * side, eye.distance(point), 1);
                    assert_eq!(seen.albedo, [0.25; 3]);
                }
            }
        }
    }
}

#[test]
fn the_near_plane_clips_and_changes_no_depth() {
    let mut scene = dark();
    sphere(&mut scene, DVec3::ZERO, 2.0, glass(1.5));
    let eye = DVec3::new(0.0, -10.0, 0.0);
    let front = through_window(&mut scene, eye, DVec3::ZERO, false);
    assert_sees(front, DVec3::NEG_Y, 8.0, 0);
    look(&mut scene, eye, DVec3::ZERO, 1e-5);
    scene.camera.near = 10.0;
    assert_sees(all_of(&scene).pixels[0], DVec3::NEG_Y, 12.0, 0);
}

#[test]
fn the_ground_has_an_id_of_its_own() {
    let mut scene = dark();
    ground(&mut scene, lambertian(0.75));
    sphere(&mut scene, [0.0, 0.0, 50.0], 1.0, lambertian(0.5));
    let (eye, point) = (DVec3::new(0.0, -3.0, 4.0), DVec3::ZERO);
    let seen = through_window(&mut scene, eye, point, false);
    assert_sees(seen, DVec3::Z, 5.0, GROUND_PLANE);
    assert_eq!(seen.albedo, [0.75; 3]);
    let from_below = through_window(&mut scene, -eye, point, false);
    assert_sees(from_below, DVec3::NEG_Z, 5.0, GROUND_PLANE);
}

#[test]
fn an_empty_scene_has_nothing_anywhere() {
    let nothing = Features {
        albedo: [0.0; 3],
        normal: [0.0; 3],
        depth: f32::INFINITY,
        coverage: 0.0,
        ground: 0.0,
        id: NOTHING,
    };
    assert_eq!(all_of(&dark()).pixels, vec![nothing; 256]);
}

#[test]
fn albedo_is_the_color_of_each_material() {
    let color = Rgb::new(0.5, 0.25, 0.75);
    let gold = Material::Conductor { fresnel: ConductorFresnel::Schlick(color), roughness: 0.25 };
    let cases = [
        (Material::Lambertian { color }, color),
        (gold, color),
        (Material::Dielectric { ior: 1.5, color: Rgb::ONE }, Rgb::ONE),
        (Material::Plastic { color, ior: 1.5 }, color),
        (Material::Reflective { color, diffuse: 0.5, mirror: 0.5 }, color),
        (Material::Emitter { radiance: Rgb::new(9.0, 0.5, 1.0), albedo: color }, {
            Rgb::new(1.0, 0.5, 1.0)
        }),
    ];
    for (made_of, expected) in cases {
        let mut scene = dark();
        let row = material(&mut scene, made_of.clone());
        let tint = Rgb::new(1.0, 0.5, 0.25);
        scene.spheres.push(DVec3::ZERO, 1.0, row, tint);
        let eye = DVec3::new(0.0, -4.0, 0.0);
        let seen = through_window(&mut scene, eye, DVec3::NEG_Y, true);
        let off = (Rgb::from(seen.albedo) - expected * tint).abs().max_element();
        assert!(off < 1e-6, "{made_of:?}: {:?}", seen.albedo);
    }
}

/// A disc in orthographic projection: its area, and the means over it. Nothing outside contributes.
#[test]
fn edges_are_weighted_by_coverage() {
    let mut scene = dark();
    sphere(&mut scene, DVec3::ZERO, 1.0, lambertian(0.5));
    look_parallel(&mut scene, DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 4.0);
    (scene.settings.width, scene.settings.height) = (64, 64);
    let pixels = all_of(&scene).pixels;
    let area = 16.0 / 4096.0;
    let sum = |value: &dyn Fn(&Features) -> f64| pixels.iter().map(value).sum::<f64>() * area;
    let pi = std::f64::consts::PI;
    assert!((sum(&|pixel| f64::from(pixel.coverage)) - pi).abs() < 2e-3);
    assert!((sum(&|pixel| f64::from(pixel.albedo[1])) - 0.5 * pi).abs() < 1e-3);
    // A half ball has the volume 2/3 pi.
    assert!((sum(&|pixel| f64::from(pixel.normal[2])) - 2.0 / 3.0 * pi).abs() < 2e-3);
    for pixel in pixels {
        assert_eq!(pixel.depth.is_infinite(), pixel.coverage == 0.0, "{pixel:?}");
        assert!(pixel.depth.is_infinite() || (4.0..=5.0).contains(&pixel.depth), "{pixel:?}");
        assert!(pixel.coverage > 0.0 || pixel.normal == [0.0; 3]);
    }
}

/// Returns the closest hit by the textbook formula in double precision; `None` where rounding could matter.
fn first_hit(scene: &Scene, origin: DVec3, direction: DVec3) -> Option<u32> {
    let mut nearest = (f64::INFINITY, NOTHING);
    for i in 0..scene.spheres.len() {
        let offset = scene.spheres.center(i) - origin;
        let along = offset.dot(direction);
        let (square, limit) =
            ((offset - direction * along).length_squared(), scene.spheres.radius[i].powi(2));
        if (square - limit).abs() < 1e-5 * limit {
            return None;
        }
        let t = along - (limit - square).sqrt();
        if square < limit && t > 0.0 && t < nearest.0 {
            if nearest.0 - t < 1e-5 {
                return None;
            }
            nearest = (t, i as u32);
        }
    }
    Some(nearest.1)
}

#[test]
fn ids_are_those_of_brute_force_in_the_users_order() {
    let mut scene = dark();
    for i in 0..400_u32 {
        let [x, y, z] = [7, 111, 193].map(|step| f64::from(i * step % 401) / 401.0 * 8.0 - 4.0);
        sphere(&mut scene, [x, y, z], 0.125 + f64::from(i % 5) / 16.0, lambertian(0.5));
    }
    let eye = DVec3::new(0.0, -12.0, 0.0);
    look(&mut scene, eye, DVec3::ZERO, 50.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (60, 60, 1);
    let pixels = all_of(&scene).pixels;
    let tangent = 25_f64.to_radians().tan();
    let (mut checked, mut seen) = (0, Vec::new());
    for (i, pixel) in pixels.iter().enumerate() {
        let [across, down] = [i % 60, i / 60].map(|at| ((at as f64 + 0.5) / 30.0 - 1.0) * tangent);
        let direction = DVec3::new(across, 1.0, -down).normalize();
        if let Some(expected) = first_hit(&scene, eye, direction) {
            assert_eq!(pixel.id, expected, "pixel {i}");
            checked += 1;
            seen.push(expected);
        }
    }
    seen.sort_unstable();
    seen.dedup();
    assert!(checked > 3550 && seen.len() > 100, "{checked} {}", seen.len());
}

#[test]
fn speed_settings_change_nothing() {
    let mut scene = menagerie();
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (52, 40, 20);
    let usual = all_of(&scene);
    assert!(usual.pixels.iter().all(|pixel| pixel.normal.iter().all(|value| value.is_finite())));
    for threads in [1, 3] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        assert_eq!(pool.install(|| all_of(&scene)), usual, "{threads} threads");
    }
    for width in PacketWidth::ALL {
        for traversal in [Traversal::Auto, Traversal::Brute, Traversal::Packet, Traversal::Stream] {
            let options = Options { tracer: Tracer { traversal, width }, ..Options::default() };
            assert_eq!(with(&scene, &options), usual, "{traversal:?} {width:?}");
        }
    }
}

#[test]
fn a_region_is_a_part_of_the_whole() {
    let mut scene = menagerie();
    (scene.settings.width, scene.settings.height) = (40, 40);
    let whole = all_of(&scene);
    let region = Region { x: 5, y: 11, width: 21, height: 18 };
    let part = with(&scene, &Options { region: Some(region), ..Options::default() });
    assert_eq!((part.width, part.height), (21, 18));
    for (i, pixel) in part.pixels.iter().enumerate() {
        let (x, y) = (5 + i % 21, 11 + i / 21);
        assert_eq!(*pixel, whole.pixels[y * 40 + x], "{x} {y}");
    }
}

#[test]
fn a_single_id_layer_has_the_same_ids() {
    let scene = menagerie();
    let world = World::build(&scene).expect("the scene is sound");
    let ids = layers(&world, &scene.settings, &Options::default(), &[Layer::Id])
        .expect("settings in range");
    let all = all_of(&scene);
    assert!(ids.pixels.iter().map(|pixel| pixel.id).eq(all.pixels.iter().map(|pixel| pixel.id)));
}
