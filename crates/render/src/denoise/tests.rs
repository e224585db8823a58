use super::*;
use crate::denoise::features::MissingFeatures;
use crate::film::Region;
use crate::layers::{Features, Layer, layers};
use crate::noise::CONFIDENCE;
use crate::render::{Options, ResumableRender, render};
use crate::scene::generate::default_scene;
use crate::scene::{Material, NamedMaterial, Rgb, Scene, Settings};
use crate::trace::{Tracer, Traversal};
use crate::world::World;

/// Returns the root mean square of the differences, relative to the mean of `b`.
fn difference(a: &Image, b: &Image) -> f64 {
    let values = |image: &Image| image.pixels.iter().flatten().copied().map(f64::from).collect();
    let [a, b]: [Vec<f64>; 2] = [values(a), values(b)];
    let squares: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / b.len() as f64).sqrt() / (b.iter().sum::<f64>() / b.len() as f64)
}

fn scene() -> (Scene, World) {
    let mut scene = default_scene(4);
    for row in &mut scene.materials {
        row.material = Material::Lambertian { color: Rgb::splat(0.6) };
    }
    (scene.settings.width, scene.settings.height) = (72, 54);
    let world = World::build(&scene).unwrap();
    (scene, world)
}

/// Renders, denoises, and returns the image, its error and that of the picture before.
fn judged(world: &World, settings: &Settings) -> (Image, Noise, Noise) {
    let options = Options { statistics: true, ..Options::default() };
    let denoiser = Denoiser::new(world, settings, &options, Choice::Always).unwrap();
    let mut render = ResumableRender::begin(world, settings, &options).unwrap();
    render.run(world, &options);
    let Judged { denoised, before, noise } =
        denoiser.judge(world, render.film(), &options).unwrap();
    (denoised.unwrap().image, noise, before)
}

#[test]
fn stated_errors_hold() {
    const RUNS: u64 = 24;
    let (scene, world) = scene();
    let settings = |seed, spp| Settings { spp, seed, ..scene.settings.clone() };
    let truth = render(&world, &settings(1 << 40, 1024), &Options::default()).unwrap().image;
    let (mut held, mut squares) = (0, [0.0; 2]);
    for seed in 0..RUNS {
        let (image, noise, _) = judged(&world, &settings(seed, 8));
        let error = difference(&image, &truth);
        held += u64::from(error <= noise.bound);
        squares[0] += noise.error.powi(2);
        squares[1] += error.powi(2);
    }
    assert!(held as f64 >= CONFIDENCE * RUNS as f64 - 1.0, "{held} of {RUNS}");
    let ratio = (squares[0] / squares[1]).sqrt();
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

#[test]
fn targets_are_those_of_the_denoised_picture() {
    const TARGET: f64 = 0.06;
    let (scene, world) = scene();
    let settings = Settings { until_error: Some(TARGET), spp: 4096, ..scene.settings.clone() };
    let options = Options { statistics: true, ..Options::default() };
    let run = |threads: usize, traversal: Traversal| {
        let tracer = Tracer { traversal, ..Tracer::default() };
        let options = Options { tracer, ..options };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let denoiser = Denoiser::new(&world, &settings, &options, Choice::Always).unwrap();
            let judge = |film: &Film| denoiser.noise(&world, film, &options);
            let options = Options { judge: Some(&judge), ..options };
            let mut render = ResumableRender::begin(&world, &settings, &options).unwrap();
            render.run(&world, &options);
            (denoiser.judge(&world, render.film(), &options).unwrap(), render.samples().total)
        })
    };
    let (one, samples) = run(1, Traversal::Auto);
    assert!(one.noise.bound <= TARGET && one.noise.bound > 0.5 * TARGET, "{:?}", one.noise);
    let one = (one.denoised.unwrap(), samples);
    for (threads, traversal) in [(3, Traversal::Auto), (2, Traversal::Brute)] {
        let (other, same) = run(threads, traversal);
        assert!((other.denoised.unwrap(), same) == one, "{threads} {traversal:?}");
    }
}

#[test]
fn more_samples_leave_less_to_denoise() {
    let (scene, world) = scene();
    let change = |spp: u32| {
        let settings = Settings { spp, ..scene.settings.clone() };
        let options = Options { statistics: true, ..Options::default() };
        let picture = render(&world, &settings, &options).unwrap();
        let features = layers(&world, &settings, &options, &[Layer::Normal]).unwrap();
        let denoised = denoise(&picture.image, &picture.statistics.unwrap(), &features).image;
        difference(&denoised, &picture.image)
    };
    let [few, many] = [4, 256].map(change);
    assert!(many < few / 4.0, "{few} {many}");
}

#[test]
fn limits_depend_on_size_spheres_and_materials() {
    let field = default_scene(4).materials;
    let white = Material::Lambertian { color: Rgb::ONE };
    let diffuse = [NamedMaterial { name: "white".into(), material: white }];
    let region = |width, height| Region { x: 0, y: 0, width, height };
    assert_eq!(max_samples(region(960, 540), 400, &field), 64);
    assert_eq!(max_samples(region(1, 1), 1, &[]), 1024);
    assert_eq!(max_samples(region(4000, 4000), 1, &[]), 16);
    assert_eq!(max_samples(region(960, 540), 400, &diffuse), 177);
    let more = [1, 1 << 10, 1 << 14, 1 << 20]
        .map(|spheres| max_samples(region(512, 512), spheres, &field));
    assert!(more.is_sorted_by(|a, b| a >= b) && more[0] > more[3], "{more:?}");
}

/// Renders 20 samples and then all, with or without recording features, and returns the render.
fn render_in_two_parts(world: &World, settings: &Settings, features: [bool; 2]) -> ResumableRender {
    let of = |features| Options { statistics: true, features, ..Options::default() };
    let first = Settings { spp: 20, ..settings.clone() };
    let mut render = ResumableRender::begin(world, &first, &of(features[0])).unwrap();
    render.run(world, &of(features[0]));
    render.extend(settings).unwrap();
    render.run(world, &of(features[1]));
    render
}

#[test]
fn recorded_features_are_those_that_are_traced() {
    let (mut scene, _) = scene();
    scene.settings.spp = 41;
    let world = World::build(&scene).unwrap();
    let features = |kept: [bool; 2]| {
        let render = render_in_two_parts(&world, &scene.settings, kept);
        let mut missing = MissingFeatures::new(&scene.settings);
        assert!(missing.trace(&world, render.film(), &Options::default()));
        missing.layers(render.film(), &Options::default())
    };
    let traced = features([false; 2]);
    for kept in [[true; 2], [false, true]] {
        assert_eq!(features(kept), traced, "{kept:?}");
    }
}

#[test]
fn features_are_those_of_layers() {
    let (mut scene, _) = scene();
    for opacity in [1.0, 0.5] {
        if opacity < 1.0 {
            // A translucent ground is refused.
            scene.ground = None;
            let white = Material::Lambertian { color: Rgb::splat(0.6) };
            scene.materials.iter_mut().for_each(|row| row.material = white.with_opacity(opacity));
        }
        let world = World::build(&scene).unwrap();
        for spp in [1, 16, 37] {
            let settings = Settings { spp, ..scene.settings.clone() };
            let options = Options { features: true, ..Options::default() };
            let mut render = ResumableRender::begin(&world, &settings, &options).unwrap();
            render.run(&world, &options);
            let mut missing = MissingFeatures::new(&settings);
            assert!(missing.trace(&world, render.film(), &options));
            let found = missing.layers(render.film(), &options);
            let oracle = layers(&world, &settings, &options, &[Layer::Normal]).unwrap();
            for (found, oracle) in found.pixels.iter().zip(&oracle.pixels) {
                assert_eq!(found.id, oracle.id);
                let columns = |features: &Features| {
                    let Features { albedo, normal, coverage, .. } = *features;
                    albedo.into_iter().chain(normal).chain([coverage]).collect::<Vec<f32>>()
                };
                let differences = columns(found).into_iter().zip(columns(oracle));
                for (found, oracle) in differences {
                    assert!((found - oracle).abs() < 1e-6, "{opacity} {spp}: {found} {oracle}");
                }
            }
        }
    }
}

#[test]
fn features_of_another_render_are_forgotten() {
    let (scene, world) = scene();
    let settings = Settings { spp: 8, ..scene.settings };
    let mut missing = MissingFeatures::new(&settings);
    let layers = [true, false, true].map(|features| {
        let options = Options { features, ..Options::default() };
        let mut render = ResumableRender::begin(&world, &settings, &options).unwrap();
        render.run(&world, &options);
        assert!(missing.trace(&world, render.film(), &options));
        missing.layers(render.film(), &options)
    });
    assert!(layers.windows(2).all(|pair| pair[0] == pair[1]));
}
