//! Adaptive sampling: the error, its estimate, and bias by stopping.

mod bias;
use crate::common::*;
use glam::DVec3;
use spherule_render::film::Region;
use spherule_render::render::{End, Options, Render, render};
use spherule_render::scene::{Integrator, Material, Rgb, Roulette, SamplerKind, Scene, Settings};
use spherule_render::world::World;
use std::sync::OnceLock;
use std::time::Duration;

/// White plastic in a white furnace: 1 in every pixel, with noise on spheres.
fn plastic_heap() -> Scene {
    let mut scene = furnace();
    for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        sphere(&mut scene, [x, y, 0.0], 1.0, Material::Plastic { color: Rgb::ONE, ior: 1.5 });
    }
    look(&mut scene, DVec3::new(1.0, 2.0, 7.0), DVec3::ZERO, 40.0);
    scene.settings.roulette = Roulette::Throughput;
    (scene.settings.width, scene.settings.height) = (28, 28);
    scene
}

/// The inside of an emitter of albedo 0.8: 5 in every pixel. The survival probability is lower than that, so
/// weights of paths grow, and the fourth moment of their radiance is barely finite.
fn spiky() -> Scene {
    let mut scene = dark();
    sphere(&mut scene, [0.0; 3], 1.0, emitter(1.0, 0.8));
    look(&mut scene, DVec3::new(0.3, -0.2, 0.5), DVec3::X, 90.0);
    scene.settings.roulette = Roulette::Fixed(0.75);
    scene
}

/// An emitter above glass on a ground. Caustic sampling is off, so only paths that hit the emitter find the
/// light in the shadow of the glass.
fn caustic() -> Scene {
    let mut scene = dark();
    ground(&mut scene, lambertian(0.8));
    sphere(&mut scene, [0.0, 0.0, 1.0], 1.0, glass(1.5));
    sphere(&mut scene, [1.0, 1.0, 4.0], 1.0, emitter(10.0, 0.0));
    look(&mut scene, DVec3::new(4.0, -4.0, 3.0), DVec3::new(0.0, 0.0, 0.5), 50.0);
    (scene.settings.depth, scene.settings.caustics) = (Some(6), false);
    scene
}

fn with_target(mut scene: Scene, error: f64) -> Scene {
    (scene.settings.until_error, scene.settings.spp) = (Some(error), Settings::HARD_SAMPLES);
    scene
}

/// A scene, and its exact image.
struct Case {
    name: &'static str,
    scene: Scene,
    truth: Vec<f64>,
}

fn cases() -> Vec<Case> {
    static CAUSTIC: OnceLock<Vec<f64>> = OnceLock::new();
    let case = |name, scene: Scene, truth: f64| {
        let pixels = (scene.settings.width * scene.settings.height) as usize;
        Case { name, scene, truth: vec![truth; pixels] }
    };
    let truth = CAUSTIC.get_or_init(|| image_of(&caustic(), 1 << 13)).clone();
    vec![
        case("heap", with_target(plastic_heap(), 0.03), 1.0),
        case("spiky", with_target(spiky(), 0.2), 5.0),
        Case { name: "caustic", scene: with_target(caustic(), 0.16), truth },
    ]
}

/// Returns the pixels of a scene, rendered with many samples.
fn image_of(scene: &Scene, spp: u32) -> Vec<f64> {
    let settings = Settings { spp, seed: 999, ..scene.settings.clone() };
    let reference = Scene { settings, ..scene.clone() };
    render_scene(&reference).image.pixels.iter().map(|pixel| f64::from(pixel[0])).collect()
}

/// Returns the root mean squared error relative to the mean.
fn true_error(render: &Render, truth: &[f64]) -> f64 {
    let count = truth.len() as f64;
    let pairs = render.image.pixels.iter().zip(truth);
    let squares: f64 = pairs.map(|(pixel, truth)| (f64::from(pixel[0]) - truth).powi(2)).sum();
    (squares / count).sqrt() / average(truth)
}

fn average(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn each_seed(scene: &Scene, seeds: u64, statistics: bool) -> Vec<Render> {
    let world = World::build(scene).expect("the scene is sound");
    let one = |seed| {
        let settings = Settings { seed, ..scene.settings.clone() };
        render(&world, &settings, &Options { statistics, ..Options::default() })
            .expect("settings in range")
    };
    (0..seeds).map(one).collect()
}

/// If each bound holds with probability 0.95, fewer of 40 hold by chance once in 300 runs.
const HELD_OF_40: usize = 34;

#[test]
fn errors_are_below_their_bounds_as_often_as_claimed_and_nothing_is_biased() {
    for Case { name, scene, truth } in cases() {
        let target = scene.settings.until_error;
        let renders = each_seed(&scene, 40, false);
        let (mut held, mut estimated, mut actual) = (0, 0.0, 0.0);
        for render in &renders {
            let noise = render.noise.expect("it was measured");
            assert_eq!(render.end, End::Error, "{name}");
            assert!(noise.error <= noise.bound && Some(noise.bound) <= target, "{name}");
            let error = true_error(render, &truth);
            held += usize::from(error <= noise.bound);
            (estimated, actual) = (estimated + noise.error.powi(2), actual + error.powi(2));
        }
        assert!(held >= HELD_OF_40, "{name}: {held} of 40");
        // Renders stop when the estimate is low, so it is slightly too low.
        assert!(
            estimated < 1.3 * actual && actual < 2.0 * estimated,
            "{name}: {estimated} {actual}"
        );
        let means = renders.iter().map(|render| mean(&render.image));
        assert_expected(Estimate::of(means), average(&truth), name);
    }
}

/// With uniform sampling, the estimate agrees with the true error.
#[test]
fn estimates_are_true_on_average() {
    for Case { name, mut scene, truth } in cases() {
        (scene.settings.until_error, scene.settings.spp) = (None, 64);
        let renders = each_seed(&scene, 30, true);
        let of = |number: &dyn Fn(&Render) -> f64| Estimate::of(renders.iter().map(number));
        let actual = of(&|render| true_error(render, &truth).powi(2));
        let estimated = of(&|render| render.noise.map_or(0.0, |noise| noise.error.powi(2)));
        assert_agree(estimated, actual, name);
        let scale = average(&truth).powi(2);
        let by_pixel =
            of(&|render| render.statistics.as_ref().map_or(0.0, |all| mean(&all.variance) / scale));
        // Ratios of sums are unbiased only in large images.
        let error = by_pixel.error.hypot(0.05 * actual.mean);
        assert_agree(Estimate { error, ..by_pixel }, actual, name);
    }
}

#[test]
fn counts_and_bytes_do_not_depend_on_threads() {
    let scene = with_target(plastic_heap(), 0.012);
    let by_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let options = Options { statistics: true, ..Options::default() };
        pool.install(|| render_scene_with(&scene, &options))
    };
    let (one, three) = (by_threads(1), by_threads(3));
    assert!(one.image == three.image && one.samples == three.samples && one.noise == three.noise);
    assert_eq!(one.statistics, three.statistics);
    assert!(one.samples.least < one.samples.most && one.samples.rounds > 2, "{:?}", one.samples);
}

#[test]
fn every_integrator_and_sampler_reaches_its_target() {
    let integrators = [
        Integrator::Path,
        Integrator::Whitted { shadow_samples: 2 },
        Integrator::Ao { distance: 9.0 },
    ];
    for integrator in integrators {
        for sampler in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
            let mut scene = with_target(caustic(), 0.1);
            (scene.settings.integrator, scene.settings.sampler) = (integrator, sampler);
            scene.environment.map = gradient();
            let render = render_scene(&scene);
            assert_eq!(render.end, End::Error, "{integrator:?} {sampler:?}");
        }
    }
}

#[test]
fn small_pictures_and_regions_end() {
    for (width, height) in [(1, 1), (3, 2), (17, 1), (5, 40)] {
        let mut scene = with_target(plastic_heap(), 0.2);
        (scene.settings.width, scene.settings.height) = (width, height);
        let render = render_scene(&scene);
        assert_eq!(render.end, End::Error, "{width} x {height}");
        assert_eq!(render.image.pixels.len() as u32, width * height);
    }
    let region = Some(Region { x: 13, y: 15, width: 9, height: 5 });
    let options = Options { region, ..Options::default() };
    let render = render_scene_with(&with_target(plastic_heap(), 0.1), &options);
    assert_eq!((render.image.width, render.image.height, render.end), (9, 5, End::Error));
}

#[test]
fn pictures_without_noise_end_at_once() {
    let mut black = with_target(dark(), 0.01);
    sphere(&mut black, [0.0; 3], 1.0, lambertian(0.5));
    let mut white = with_target(furnace(), 0.01);
    sphere(&mut white, [0.0; 3], 1.0, lambertian(1.0));
    for (scene, value) in [(black, 0.0), (white, 1.0), (with_target(furnace(), 0.01), 1.0)] {
        let render = render_scene(&scene);
        assert_every_pixel(&render.image, value, "no noise");
        assert_eq!(render.end, End::Error);
        assert!(render.samples.most <= 16 && render.samples.rounds <= 1, "{:?}", render.samples);
    }
}

#[test]
fn samples_per_pixel_are_a_limit() {
    for spp in [1, 8, 50, 100] {
        let mut scene = with_target(caustic(), 1e-6);
        scene.settings.spp = spp;
        let render = render_scene(&scene);
        assert_eq!((render.end, render.complete), (End::Samples, true));
        assert_eq!((render.samples.least, render.samples.most), (spp, spp));
        // Uniform sampling: the same image as without an error goal.
        scene.settings.until_error = None;
        assert!(render_scene(&scene).image == render.image, "{spp}");
    }
}

#[test]
fn a_time_limit_leaves_no_pixel_out() {
    let mut scene = plastic_heap();
    scene.settings.spp = Settings::HARD_SAMPLES;
    for milliseconds in [1, 300] {
        scene.settings.time = Some(Duration::from_millis(milliseconds));
        let render = render_scene(&scene);
        assert_eq!((render.end, render.complete), (End::Time, true));
        assert!(render.samples.least > 0 && render.noise.is_some(), "{:?}", render.samples);
    }
}

/// A lamp in view, and by way of two mirrors and a nested glass sphere, which only paths that hit it find.
fn small_emitter(radius: f64) -> Scene {
    let mut scene = dark();
    ground(&mut scene, lambertian(0.6));
    sphere(&mut scene, [0.5, 2.0, 2.2], radius, emitter((1.0 / (radius * radius)) as f32, 0.0));
    sphere(&mut scene, [-1.2, 0.0, 0.8], 0.8, mirror());
    sphere(&mut scene, [0.7, 0.3, 0.7], 0.7, mirror());
    sphere(&mut scene, [2.2, 0.0, 0.6], 0.6, glass(1.5));
    sphere(&mut scene, [2.2, 0.0, 0.6], 0.4, glass(1.3));
    look(&mut scene, DVec3::new(0.0, -7.0, 3.0), DVec3::new(0.3, 0.0, 0.9), 35.0);
    scene.settings.depth = Some(8);
    scene
}

#[test]
fn bounds_hold_where_lights_are_found_by_chance() {
    const SEEDS: u64 = 10;
    let mut diffuse = small_emitter(0.05);
    diffuse.settings.caustics = false;
    let truths = [0.05, 0.2].map(|radius| image_of(&small_emitter(radius), 1 << 12));
    for (what, scene, truth) in [
        ("small", small_emitter(0.05), &truths[0]),
        ("by chance", diffuse, &truths[0]),
        ("large", small_emitter(0.2), &truths[1]),
    ] {
        let held = (0..SEEDS).filter(|&seed| {
            let mut scene = with_target(scene.clone(), 1e-6);
            (scene.settings.spp, scene.settings.seed) = (16, seed);
            let render = render_scene(&scene);
            let bound = render.noise.expect("an error is measured").bound;
            true_error(&render, truth) <= bound
        });
        let held = held.count();
        assert!(held >= 9, "{what}: {held} of {SEEDS}");
    }
}
