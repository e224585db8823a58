//! Furnaces: in uniform light, lossless surfaces are invisible.

use crate::common::*;
use glam::DVec3;
use spherule_render::scene::{Integrator, Material, Rgb, Roulette, SamplerKind, Scene};

const SAMPLERS: [SamplerKind; 3] =
    [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent];

#[test]
fn a_diffuse_sphere_shows_its_albedo_in_every_sample() {
    for sampler in SAMPLERS {
        for albedo in [0.2, 0.5, 0.77] {
            let mut scene = furnace();
            sphere(&mut scene, [0.0; 3], 1.0, lambertian(albedo));
            look(&mut scene, DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 20.0);
            scene.settings.sampler = sampler;
            assert_every_pixel(&render_scene(&scene).image, albedo, "diffuse");
        }
    }
}

/// Returns spheres of all lossless materials: touching, nested and overlapping.
fn heap(materials: &[Material]) -> Scene {
    let mut scene = furnace();
    scene.settings.spp = 32;
    let mut next = materials.iter().cycle().cloned();
    let mut add = |center: [f64; 3], radius: f64| {
        sphere(&mut scene, center, radius, next.next().expect("a cycle has no end"));
    };
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            for z in [-1.0, 1.0] {
                add([x, y, z], 1.0);
            }
        }
    }
    // In the gap, touching all eight; and larger ones behind, which overlap.
    add([0.0; 3], 3.0_f64.sqrt() - 1.0);
    add([0.0, 0.0, -3.0], 1.5);
    add([0.7, 0.0, -3.5], 1.5);
    look(&mut scene, DVec3::new(1.0, 2.0, 7.0), DVec3::ZERO, 40.0);
    scene
}

#[test]
fn white_surfaces_are_invisible() {
    let reflective =
        |diffuse: f64| Material::Reflective { color: Rgb::ONE, diffuse, mirror: 1.0 - diffuse };
    let heaps = [
        ("diffuse", heap(&[lambertian(1.0)])),
        ("mirrors", heap(&[mirror()])),
        ("reflective", heap(&[reflective(0.5), reflective(0.0), reflective(1.0)])),
        ("glass", heap(&[glass(1.5), glass(1.33), glass(2.4), glass(0.8)])),
        ("mixed", heap(&[lambertian(1.0), mirror(), glass(1.5), reflective(0.25)])),
    ];
    for (what, mut scene) in heaps {
        for (roulette, sampler) in [
            (Roulette::None, SamplerKind::Sobol),
            (Roulette::Throughput, SamplerKind::Stratified),
            (Roulette::Fixed(1.0), SamplerKind::Independent),
        ] {
            scene.settings.roulette = roulette;
            scene.settings.sampler = sampler;
            let render = render_scene(&scene);
            assert_eq!(render.counters.cut_paths, 0, "{what}");
            assert_every_pixel(&render.image, 1.0, what);
        }
    }
}

#[test]
fn white_plastic_and_roulette_are_white_on_average() {
    let plastic = Material::Plastic { color: Rgb::ONE, ior: 1.5 };
    let mut scene = heap(&[plastic]);
    assert_expected(measure(&scene), 1.0, "plastic");
    // E[x^2] = e / (1 - (1 - e) / p): finite, since the fraction 1 - e that does not escape is well below p.
    scene.settings.roulette = Roulette::Fixed(0.9);
    assert_expected(measure(&scene), 1.0, "plastic with roulette");
}

/// Returns images from inside a sphere that emits 1 and reflects `albedo`.
fn inside(albedo: f32) -> Scene {
    let mut scene = dark();
    sphere(&mut scene, [0.0; 3], 1.0, emitter(1.0, albedo));
    look(&mut scene, DVec3::new(0.3, -0.2, 0.5), DVec3::X, 90.0);
    scene
}

#[test]
fn depth_cuts_the_geometric_series() {
    let truths =
        [(0, 1.0), (1, 1.8), (2, 2.44), (4, 3.3616), (8, 4.328_911_36), (16, 4.887_410_009)];
    for (depth, truth) in truths {
        let mut scene = inside(0.8);
        scene.settings.depth = Some(depth);
        // The same sum in the arithmetic of the renderer.
        let (mut sum, mut throughput) = (1.0_f32, 1.0_f32);
        for _ in 0..depth {
            throughput *= 0.8;
            sum += throughput;
        }
        assert!(within(f64::from(sum), truth, 0.0, 0.0), "{sum} {truth}");
        assert_every_pixel(&render_scene(&scene).image, sum, "depth");
    }
}

#[test]
fn an_emitting_sphere_from_inside_is_the_whole_series() {
    for albedo in [0.2, 0.5, 0.8, 0.9] {
        let truth = 1.0 / (1.0 - f64::from(albedo));
        let mut scene = inside(albedo);
        // Without randomness, one path is enough.
        scene.settings.spp = 1;
        for roulette in [Roulette::None, Roulette::Fixed(1.0)] {
            scene.settings.roulette = roulette;
            let Estimate { mean, error } = measure(&scene);
            assert!(error == 0.0 && within(mean, truth, 0.0, 0.0), "{albedo} {roulette:?}: {mean}");
        }
        scene.settings.spp = 64;
        scene.settings.roulette = Roulette::Throughput;
        assert_expected(measure(&scene), truth, &format!("{albedo}, roulette by throughput"));
        // A higher albedo would need p above its square for a finite variance.
        for p in [0.9, 0.5] {
            if f64::from(albedo).powi(2) < p {
                scene.settings.roulette = Roulette::Fixed(p);
                assert_expected(measure(&scene), truth, &format!("{albedo} survives by {p}"));
            }
        }
    }
}

#[test]
fn whitted_keeps_the_furnace_without_indirect_light() {
    let mut scene = furnace();
    scene.settings.integrator = Integrator::Whitted { shadow_samples: 4 };
    sphere(&mut scene, [-1.0, 0.0, 0.0], 0.9, mirror());
    sphere(&mut scene, [1.0, 0.0, 0.0], 0.9, glass(1.5));
    assert_every_pixel(&render_scene(&scene).image, 1.0, "mirror and glass");
    let mut scene = furnace();
    scene.settings.integrator = Integrator::Whitted { shadow_samples: 4 };
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
    look(&mut scene, DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 20.0);
    let estimate = measure(&scene);
    assert_expected(estimate, 0.5, "diffuse");
}

/// An emitter of radius 1 in a shell of radius 2, both of one albedo: their radiances by the view factors 1/4
/// and 3/4.
#[test]
fn concentric_spheres_exchange_light() {
    for (albedo, inner, shell) in
        [(0.5, 1.111_111_111_1, 0.222_222_222_2), (0.8, 1.666_666_666_7, 0.833_333_333_3)]
    {
        let mut scene = dark();
        sphere(&mut scene, [0.0; 3], 1.0, emitter(1.0, albedo));
        sphere(&mut scene, [0.0; 3], 2.0, lambertian(albedo));
        scene.settings.roulette = Roulette::Throughput;
        let eye = DVec3::new(0.0, 0.0, 1.5);
        look(&mut scene, eye, DVec3::ZERO, 20.0);
        assert_expected(measure(&scene), inner, &format!("emitter, {albedo}"));
        look(&mut scene, eye, DVec3::new(0.0, 0.0, 2.0), 100.0);
        assert_expected(measure(&scene), shell, &format!("shell, {albedo}"));
    }
}
