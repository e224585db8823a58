//! Translucent bodies: compared with closed forms, with opaque and with absent bodies, and between traversals.

use crate::common::{
    Estimate, assert_every_pixel, assert_expected, dark, furnace, glass, ground, lambertian, look,
    look_parallel, material, measure, probe, render_scene, render_scene_with, sphere,
};
use glam::DVec3;
use spherule_render::layers::{Layer, layers};
use spherule_render::render::{Options, preview};
use spherule_render::scene::{
    Integrator, Light, Material, Rgb, Scene, Slice, SliceMode, Spheres, Sticks, write,
};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};
use spherule_render::world::World;

fn black(opacity: f64) -> Material {
    Material::Translucent { opacity, surface: Box::new(lambertian(0.0)) }
}

/// Overlapping spheres and a stick on the z axis, black and of one opacity, and a parallel camera that sees all of them in
/// every pixel.
fn stack(opacity: f64) -> Scene {
    let mut scene = furnace();
    for z in [-0.5, 0.0, 0.7] {
        sphere(&mut scene, DVec3::Z * z, 1.0, black(opacity));
    }
    let row = material(&mut scene, black(opacity));
    let ends = [DVec3::new(-1.0, 0.0, 0.2), DVec3::new(1.0, 0.0, 0.3)];
    scene.sticks.push(ends, 0.5, row, [Rgb::ONE; 2]);
    look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
    scene
}

#[test]
fn the_background_is_attenuated_by_every_body() {
    for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 1 }] {
        for opacity in [0.1, 0.35, 0.8] {
            let mut scene = stack(opacity);
            scene.settings.integrator = integrator;
            let truth = (1.0 - opacity).powi(4);
            assert_expected(measure(&scene), truth, &format!("{integrator:?} {opacity}"));
        }
    }
}

#[test]
fn previews_composite_translucent_bodies() {
    for bodies in 0..3 {
        let mut scene = furnace();
        for z in 0..bodies {
            sphere(&mut scene, DVec3::Z * f64::from(z), 1.0, black(0.5));
        }
        // Something opaque behind all of them: a pattern of dots decides which body's light stands for all.
        sphere(&mut scene, DVec3::Z * -5.0, 2.0, lambertian(0.9));
        look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
        (scene.settings.width, scene.settings.height) = (20, 12);
        let world = World::build(&scene).unwrap();
        let image = preview(&world, &scene.settings, &Options::default(), true).unwrap().unwrap();
        let light = |x: usize, y: usize| image.pixels[y * 20 + x][1];
        let expected = 0.9 * 0.5_f32.powi(bodies);
        for (left, top) in (0..12).step_by(4).flat_map(|y| (0..20).step_by(4).map(move |x| (x, y)))
        {
            let square: Vec<f32> = (0..16).map(|i| light(left + i % 4, top + i / 4)).collect();
            let mean = square.iter().sum::<f32>() / 16.0;
            assert!((mean - expected).abs() < 0.03, "{bodies} {left} {top}: {mean}");
            // Dots of black and white would be 0.9 apart.
            assert!(square.iter().all(|light| (light - expected).abs() < 0.25), "{square:?}");
        }
    }
}

#[test]
fn the_environment_behind_translucent_bodies_has_no_noise() {
    let mut scene = stack(0.35);
    scene.settings.spp = 2;
    let check = |pixels: &[[f32; 3]], what: &str| {
        for value in pixels.iter().flatten() {
            assert!((value - 0.65_f32.powi(4)).abs() < 1e-6, "{what}: {value}");
        }
    };
    for integrator in [
        Integrator::Path,
        Integrator::Whitted { shadow_samples: 1 },
        Integrator::Ao { distance: f64::INFINITY },
    ] {
        scene.settings.integrator = integrator;
        check(&render_scene(&scene).image.pixels, &format!("{integrator:?}"));
    }
    let world = World::build(&scene).unwrap();
    let image = preview(&world, &scene.settings, &Options::default(), true).unwrap().unwrap();
    check(&image.pixels, "preview");
}

#[test]
fn colors_alone_are_composited_without_noise() {
    let mut scene = furnace();
    let colors = [Rgb::new(0.9, 0.1, 0.2), Rgb::new(0.2, 0.8, 0.4), Rgb::new(0.5, 0.5, 1.0)];
    let opacities = [0.3, 0.6, 0.2];
    let mut seen = Rgb::ZERO;
    let mut passing = 1.0_f32;
    for (i, (&color, &opacity)) in colors.iter().zip(&opacities).enumerate() {
        let surface = Box::new(Material::Lambertian { color });
        sphere(&mut scene, DVec3::Z * -(i as f64), 2.0, Material::Translucent { opacity, surface });
        seen += passing * opacity as f32 * color;
        passing *= 1.0 - opacity as f32;
    }
    scene.settings.integrator = Integrator::Ao { distance: 0.0 };
    look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
    for behind in [None, Some(Rgb::new(0.3, 0.7, 0.1))] {
        // The furnace's light, or an opaque body.
        if let Some(color) = behind {
            sphere(&mut scene, DVec3::Z * -9.0, 3.0, Material::Lambertian { color });
        }
        scene.settings.spp = 1;
        let expected = seen + passing * behind.unwrap_or(Rgb::ONE);
        for pixel in render_scene(&scene).image.pixels {
            assert!(
                (Rgb::from(pixel) - expected).abs().max_element() < 1e-6,
                "{pixel:?} {expected}"
            );
        }
        let world = World::build(&scene).unwrap();
        let image = preview(&world, &scene.settings, &Options::default(), true).unwrap().unwrap();
        for pixel in image.pixels {
            assert!(
                (Rgb::from(pixel) - expected).abs().max_element() < 0.03,
                "{pixel:?} {expected}"
            );
        }
    }
}

#[test]
fn coverage_is_the_opacity_of_all_bodies() {
    let mut scene = stack(0.35);
    scene.settings.spp = 256;
    let world = World::build(&scene).unwrap();
    let pixels =
        layers(&world, &scene.settings, &Options::default(), &[Layer::Coverage]).unwrap().pixels;
    let coverage = Estimate::of(pixels.iter().map(|pixel| f64::from(pixel.coverage)));
    assert_expected(coverage, 1.0 - 0.65_f64.powi(4), "coverage");
}

#[test]
fn shadows_are_as_thin_as_the_bodies() {
    let mut scene = dark();
    ground(&mut scene, lambertian(1.0));
    scene.lights =
        vec![Light::Sun { direction: DVec3::Z, irradiance: Rgb::ONE, angular_radius: 0.0 }];
    scene.settings.depth = Some(1);
    let eye = DVec3::new(8.0, 0.0, 4.0);
    let free = probe(&mut scene, DVec3::ZERO, eye).mean;
    assert!((free - std::f64::consts::FRAC_1_PI).abs() < 1e-6, "{free}");
    for z in [8.0, 9.0] {
        sphere(&mut scene, DVec3::Z * z, 1.0, black(0.3));
    }
    assert_expected(probe(&mut scene, DVec3::ZERO, eye), free * 0.49, "two spheres");
    // A point inside of a translucent sphere is lit as outside, and seen through its surface.
    sphere(&mut scene, DVec3::ZERO, 1.0, black(0.5));
    assert_expected(probe(&mut scene, DVec3::ZERO, eye), free * 0.49 * 0.5, "inside");
}

#[test]
fn ambient_occlusion_is_attenuated() {
    let mut scene = dark();
    ground(&mut scene, lambertian(1.0));
    scene.settings.integrator = Integrator::Ao { distance: f64::INFINITY };
    let eye = DVec3::new(20.0, 0.0, 0.0001);
    let free = probe(&mut scene, DVec3::ZERO, DVec3::Z * 0.5).mean;
    // Half a sphere around the point from within: no attenuation. A sphere beside it hides as much as its opacity.
    sphere(&mut scene, DVec3::ZERO, 1.0, black(0.5));
    assert_expected(probe(&mut scene, DVec3::ZERO, DVec3::Z * 0.5), free, "from within");
    scene.spheres = Spheres::default();
    let hidden = |opacity| {
        let mut scene = scene.clone();
        sphere(&mut scene, DVec3::Z * 3.0, 1.0, black(opacity));
        free - probe(&mut scene, DVec3::ZERO, eye + DVec3::Z * 5.0).mean
    };
    let (part, all) = (hidden(0.5), hidden(1.0));
    assert!(all > 0.05 * free && (part / all - 0.5).abs() < 0.05, "{part} {all} {free}");
}

/// Spheres and sticks of several materials that overlap, some translucent.
fn mixed(opacity: impl Fn(usize) -> f64) -> Scene {
    let mut scene = furnace();
    for i in 0..24 {
        let [x, y, z] = [i % 3, i / 3 % 3, i % 4].map(|step| f64::from(step as u32) * 0.6 - 0.6);
        let surface = Box::new(lambertian([0.3, 0.8][i % 2]));
        let made_of = Material::Translucent { opacity: opacity(i), surface };
        if i % 5 == 4 {
            let row = material(&mut scene, made_of);
            scene.sticks.push([DVec3::new(x, y, z), DVec3::ZERO], 0.2, row, [Rgb::X, Rgb::ONE]);
        } else {
            sphere(&mut scene, DVec3::new(x, y, z), 0.5, made_of);
        }
    }
    scene.lights = vec![Light::Sun {
        direction: DVec3::new(0.6, 0.0, 0.8),
        irradiance: Rgb::ONE,
        angular_radius: 5.0,
    }];
    look(&mut scene, DVec3::new(1.0, -2.0, 5.0), DVec3::ZERO, 40.0);
    scene.settings.spp = 4;
    scene
}

#[test]
fn pictures_do_not_depend_on_traversals_widths_and_threads() {
    for slices in [None, Some(SliceMode::Caps), Some(SliceMode::Hide)] {
        let mut scene = mixed(|i| [0.3, 1.0, 0.0, 0.7][i % 4]);
        scene.slices = slices
            .into_iter()
            .map(|mode| Slice { normal: DVec3::X, distance: 0.2, mode })
            .collect();
        let picture = |traversal, width, threads| {
            let options = Options { tracer: Tracer { traversal, width }, ..Options::default() };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render_scene_with(&scene, &options).image.pixels)
        };
        let expected = picture(Traversal::Brute, PacketWidth::One, 1);
        for (traversal, width, threads) in [
            (Traversal::Single, PacketWidth::One, 2),
            (Traversal::Stream, PacketWidth::Four, 1),
            (Traversal::Packet, PacketWidth::Sixteen, 3),
            (Traversal::Auto, PacketWidth::Eight, 2),
        ] {
            assert!(picture(traversal, width, threads) == expected, "{slices:?} {traversal:?}");
        }
    }
}

#[test]
fn bodies_of_opacity_1_are_opaque_and_those_of_0_absent() {
    let pixels = |scene: &Scene| render_scene(scene).image.pixels;
    let mut opaque = mixed(|_| 1.0);
    let translucent = pixels(&opaque);
    for row in &mut opaque.materials {
        row.material = row.material.surface().clone();
    }
    assert!(translucent == pixels(&opaque));
    let mut absent = mixed(|_| 0.0);
    assert!(pixels(&absent).iter().flatten().all(|&value| value == 1.0));
    // Bodies of opacity 0 change nothing about opaque ones.
    sphere(&mut absent, DVec3::ZERO, 0.4, lambertian(0.6));
    let among = Estimate::of(pixels(&absent).iter().map(|pixel| f64::from(pixel[0])));
    let row = absent.spheres.material_of(absent.spheres.len() - 1);
    let mut lone = absent.clone();
    lone.sticks = Sticks::default();
    lone.spheres = Spheres::default();
    lone.spheres.push(DVec3::ZERO, 0.4, row, Rgb::ONE);
    let lone = Estimate::of(pixels(&lone).iter().map(|pixel| f64::from(pixel[0])));
    assert!((among.mean - lone.mean).abs() < 0.02, "{among:?} {lone:?}");
}

#[test]
fn a_body_around_the_camera_is_not_seen() {
    let mut scene = furnace();
    sphere(&mut scene, DVec3::Z * 10.0, 1.0, black(0.9));
    let row = material(&mut scene, black(0.9));
    scene.sticks.push([DVec3::Z * 9.5, DVec3::Z * 11.0], 0.7, row, [Rgb::ONE; 2]);
    assert_every_pixel(&render_scene(&scene).image, 1.0, "inside");
}

#[test]
fn of_spheres_that_coincide_the_first_is_there() {
    for opacities in [[0.3, 0.3], [0.3, 1.0]] {
        let mut scene = furnace();
        for opacity in opacities {
            sphere(&mut scene, DVec3::ZERO, 1.0, black(opacity));
        }
        look_parallel(&mut scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
        assert_expected(measure(&scene), 0.7, "one sphere");
    }
}

#[test]
fn caps_have_the_opacity_of_their_bodies() {
    let cut = |scene: &mut Scene| {
        let slice = Slice { normal: DVec3::Z, distance: 0.0, mode: SliceMode::Caps };
        scene.slices = vec![slice];
        look_parallel(scene, DVec3::Z * 5.0, DVec3::ZERO, 0.1);
        measure(scene)
    };
    let mut scene = furnace();
    for z in [0.0, 0.2] {
        sphere(&mut scene, DVec3::Z * z, 1.0, black(0.4));
    }
    assert_expected(cut(&mut scene), 0.36, "two translucent spheres");
    // The cap of an opaque sphere is behind those of translucent ones around it.
    let depth = |scene: &Scene| {
        let world = World::build(scene).unwrap();
        let options = Options::default();
        layers(&world, &scene.settings, &options, &[Layer::Depth, Layer::Coverage]).unwrap().pixels
    };
    sphere(&mut scene, DVec3::Z * 0.3, 0.5, lambertian(0.0));
    assert_every_pixel(&render_scene(&scene).image, 0.0, "an opaque cap");
    for pixel in depth(&scene) {
        assert!((pixel.depth - 5.0).abs() < 1e-5 && pixel.coverage == 1.0, "{pixel:?}");
    }
}

#[test]
fn written_scenes_keep_opacities() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let scene = mixed(|i| [0.25, 1.0 / 3.0, 0.0][i % 3]);
    write(&scene, &path).unwrap();
    let read = Scene::load(&path).unwrap();
    let materials = |scene: &Scene| {
        (0..scene.spheres.len())
            .map(|row| scene.materials[scene.spheres.material_of(row) as usize].material.clone())
            .collect::<Vec<_>>()
    };
    assert!(materials(&read) == materials(&scene));
}

#[test]
fn invalid_opacities_are_refused_by_name() {
    let refused = |made_of: Material, as_ground: bool| {
        let mut scene = furnace();
        if as_ground {
            ground(&mut scene, made_of);
        } else {
            sphere(&mut scene, DVec3::ZERO, 1.0, made_of);
        }
        World::build(&scene).unwrap_err().to_string()
    };
    for opacity in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        let message = refused(black(opacity), false);
        assert!(message.contains("opacity") && message.contains("material 0"), "{message}");
    }
    for surface in [glass(1.5), black(0.5)] {
        let message =
            refused(Material::Translucent { opacity: 0.5, surface: Box::new(surface) }, false);
        assert!(message.contains("translucent material \"material 0\""), "{message}");
    }
    assert!(refused(black(0.5), true).contains("ground"));
}

#[test]
fn scene_files_with_invalid_opacities_are_refused_by_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let refused = |material: &str| {
        let text = format!(
            "[material.a]\n{material}\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"a\"\n"
        );
        std::fs::write(&path, text).unwrap();
        Scene::load(&path).unwrap_err().to_string()
    };
    for opacity in ["1.5", "-1", "nan", "\"half\""] {
        let message = refused(&format!("kind = \"lambertian\"\nopacity = {opacity}"));
        assert!(message.contains("opacity") && message.contains("scene.toml:3"), "{message}");
    }
    for kind in ["kind = \"dielectric\"", "kind = \"emitter\"\nradiance = 1"] {
        let message = refused(&format!("{kind}\nopacity = 0.5"));
        assert!(message.contains("opacity"), "{message}");
    }
}
