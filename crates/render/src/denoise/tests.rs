use super::*;
use crate::denoise::columns::Columns;
use crate::denoise::features::MissingFeatures;
use crate::denoise::observations::{ID, WEIGHT};
use crate::denoise::regression::{SQUARE, predict, predict_by_squares};
use crate::denoise::rows::MARGIN;
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::layers::{Features, Layer, layers};
use crate::noise::CONFIDENCE;
use crate::render::{Options, ResumableRender, render};
use crate::sampling::{mix, unit};
use crate::scene::generate::default_scene;
use crate::scene::{Material, NamedMaterial, Rgb, Scene, Settings};
use crate::trace::{Tracer, Traversal};
use crate::world::World;
use std::sync::atomic::AtomicBool;

const WIDTH: u32 = 150;
const HEIGHT: u32 = 70;

/// Returns a number in -1/2..1/2 for a pixel.
fn noise_at(pixel: u32) -> f32 {
    unit(mix(pixel.into()) as u32) - 0.5
}

/// An image of two surfaces, on the left and on the right, with noise of this size.
fn picture(noise: f32) -> (Image, Statistics, Layers) {
    let pixels: Vec<u32> = (0..WIDTH * HEIGHT).collect();
    let is_left = |pixel: u32| pixel % WIDTH < WIDTH / 2;
    let radiance = |&pixel: &u32| {
        let light = 1.0 + noise * noise_at(pixel);
        if is_left(pixel) { [0.5 * light, 0.1 * light, 0.0] } else { [0.25 * light; 3] }
    };
    let features = |&pixel: &u32| {
        let (albedo, normal) = if is_left(pixel) {
            ([1.0, 0.2, 0.0], [1.0, 0.0, 0.0])
        } else {
            ([0.5; 3], [0.0, 0.0, 1.0])
        };
        let id = u32::from(is_left(pixel));
        Features { albedo, normal, depth: 1.0, coverage: 1.0, ground: 0.0, id }
    };
    let image =
        Image { width: WIDTH, height: HEIGHT, pixels: pixels.iter().map(radiance).collect() };
    let of_pixel = |pixel: &[f32; 3]| pixel.map(|x| (noise * x).powi(2) / 12.0);
    let variance = Image { pixels: image.pixels.iter().map(of_pixel).collect(), ..image.clone() };
    let statistics = Statistics { variance, samples: vec![16; pixels.len()] };
    let features = pixels.iter().map(features).collect();
    let layers = Layers { width: WIDTH, height: HEIGHT, pixels: features, statistics: None };
    (image, statistics, layers)
}

#[test]
fn pictures_without_noise_stay_as_they_are() {
    let (image, statistics, layers) = picture(0.0);
    let denoised = denoise(&image, &statistics, &layers);
    assert_eq!(denoised.image, image);
    assert!(denoised.squared_error.iter().all(|&error| error == 0.0));
}

#[test]
fn cancelled_denoising_leaves_the_tiles_that_remain() {
    let (image, statistics, layers) = picture(0.4);
    let until = |flag| {
        let flag = AtomicBool::new(flag);
        let options = Options { cancel: Some(&flag), ..Options::default() };
        let mut denoised =
            Denoised { image: image.clone(), squared_error: vec![0.0; image.pixels.len()] };
        let is_whole = denoise_until(&image, &statistics, &layers, &options, &mut denoised);
        (is_whole, denoised)
    };
    let (is_whole, denoised) = until(true);
    assert!(!is_whole && denoised.image == image);
    let (is_whole, denoised) = until(false);
    assert!(is_whole && denoised == denoise(&image, &statistics, &layers));
}

#[test]
fn noise_falls_and_edges_stay() {
    let (truth, ..) = picture(0.0);
    let (image, statistics, layers) = picture(0.4);
    let denoised = denoise(&image, &statistics, &layers);
    let error = |image: &Image| {
        let pairs = image.pixels.as_flattened().iter().zip(truth.pixels.as_flattened());
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / f64::from(3 * WIDTH * HEIGHT)
    };
    let (before, after) = (error(&image), error(&denoised.image));
    assert!(after < before / 20.0, "{before} {after}");
    // The surfaces differ in both features, so neither pixel beside the edge has any of the other's green. Squares across the
    // edge have some of its blue.
    let column = (WIDTH / 2) as usize;
    for row in denoised.image.pixels.chunks(WIDTH as usize) {
        assert!((row[column - 1][1] - 0.1).abs() < 0.03 && (row[column][1] - 0.25).abs() < 0.06);
        assert!((0.0..1e-4).contains(&row[column - 1][2]));
    }
    let stated = denoised.squared_error.iter().map(|&x| f64::from(x)).sum::<f64>();
    let stated = stated / f64::from(WIDTH * HEIGHT);
    // Estimates of single pixels are uncertain by some hundredths of the noise, and not below 0, so their mean is above the
    // true error.
    assert!(after < stated && stated < after + before / 20.0, "{stated} {after} {before}");
}

#[test]
fn rare_bright_pixels_leave_no_stain() {
    let (mut image, mut statistics, layers) = picture(0.1);
    let at = (40 * WIDTH + 100) as usize;
    image.pixels[at] = [50.0; 3];
    // One bright sample of sixteen, of a sequence with less noise than independent samples.
    statistics.variance.pixels[at] = [0.4 * 50.0 * 50.0; 3];
    let denoised = denoise(&image, &statistics, &layers).image;
    assert!(denoised.pixels.iter().all(|pixel| pixel.iter().all(|&x| x < 1.0)));
}

/// The columns of a tile of the image with noise of this size, as far as predictions of row `y` need them.
fn columns_of(noise: f32, y: usize) -> Columns {
    let (image, statistics, layers) = picture(noise);
    let input = tile::Input {
        image: &image,
        variance: &statistics.variance,
        features: &layers.pixels,
        floor: mean_square(&image),
    };
    let mut columns = Columns::default();
    columns.begin();
    for y in 0..=y {
        columns.advance(&input, Region { x: 0, y: 0, width: 120, height: 64 }, MARGIN[1] + y);
    }
    columns
}

#[test]
fn squares_are_means_of_their_pixels() {
    // At a corner of the image, on a surface, and across the edge of both.
    for (x, y) in [(0, 0), (20, 30), (75, 30)] {
        let columns = columns_of(0.3, y);
        let (x, y) = (MARGIN[0] + x, MARGIN[1] + y);
        let value = |column: usize, [x, y]: [usize; 2]| columns.pixels.row(y)[column][x];
        let around = (0..SQUARE * SQUARE)
            .map(|i| [x + i % SQUARE - SQUARE / 2, y + i / SQUARE - SQUARE / 2]);
        let squares = columns.squares.row(y);
        let weight: f32 = around.clone().map(|at| value(WEIGHT, at)).sum();
        let count = (SQUARE * SQUARE) as f32;
        assert!((squares[WEIGHT][x] - weight / count).abs() < 1e-6);
        for (column, squares) in squares.iter().enumerate().take(WEIGHT) {
            let product = |at| value(WEIGHT, at) * value(column, at);
            let mean = around.clone().map(product).sum::<f32>() / weight;
            assert!((squares[x] - mean).abs() < 1e-6, "{column}");
        }
        assert_eq!(squares[ID][x].to_bits(), value(ID, [x, y]).to_bits());
    }
}

#[test]
fn rows_are_denoised_alike_after_rows_without_noise() {
    // The image with noise, a part without, and the image again: all in a tile, or from the middle of that part on.
    let (mut image, mut statistics, mut layers) = picture(0.3);
    let count = image.pixels.len();
    let repeat = |pixels: &mut Vec<[f32; 3]>, between: [f32; 3]| {
        let noisy = pixels.clone();
        pixels.resize(2 * count, between);
        pixels.extend(noisy);
    };
    repeat(&mut image.pixels, [0.5; 3]);
    repeat(&mut statistics.variance.pixels, [0.0; 3]);
    let features = layers.pixels.clone();
    layers.pixels.resize(2 * count, features[0]);
    layers.pixels.extend(features);
    let below = |pixels: &[[f32; 3]], rows| Image {
        width: WIDTH,
        height: rows,
        pixels: pixels[pixels.len() - (rows * WIDTH) as usize..].to_vec(),
    };
    let denoised = |rows: u32| {
        let (image, variance) =
            (below(&image.pixels, rows), below(&statistics.variance.pixels, rows));
        let features = &layers.pixels[3 * count - image.pixels.len()..];
        let input = tile::Input { image: &image, variance: &variance, features, floor: 0.1 };
        let region = Region { x: 0, y: 0, width: 120, height: rows };
        let pixels = Workspace::default().denoise(&input, region);
        pixels[pixels.len() - 120 * HEIGHT as usize..].to_vec()
    };
    assert!(denoised(3 * HEIGHT) == denoised(HEIGHT + HEIGHT / 2));
}

#[test]
fn much_noise_is_averaged_over_squares() {
    let (truth, ..) = picture(0.0);
    let (image, mut statistics, layers) = picture(1.0);
    let of_light = |light: &[f32; 3]| light.map(|x| x * x / 12.0);
    statistics.variance.pixels = truth.pixels.iter().map(of_light).collect();
    let denoised = denoise(&image, &statistics, &layers);
    // Of the surface on the right, far from its edges.
    let error = |image: &Image| {
        let rows = image.pixels.chunks(WIDTH as usize).zip(truth.pixels.chunks(WIDTH as usize));
        let inner = rows.skip(20).take(30).flat_map(|(a, b)| a[100..130].iter().zip(&b[100..130]));
        inner.map(|(a, b)| f64::from(a[0] - b[0]).powi(2)).sum::<f64>()
    };
    // A window of pixels alone would leave a 49th.
    let (before, after) = (error(&image), error(&denoised.image));
    assert!(after < before / 80.0, "{before} {after}");
}

#[test]
fn lanes_do_not_change_predictions() {
    const Y: usize = 30;
    let columns = columns_of(0.3, Y);
    for first in [0, 64, 96] {
        let (y, x) = (MARGIN[1] + Y, MARGIN[0] + first);
        let wide = [&predict::<F32x16>(&columns, y, x)[..], &[predict_by_squares(&columns, y, x)]];
        for lane in 0..MAX_LANES {
            let [near, far] = predict::<f32>(&columns, y, x + lane);
            let one = [near, far, predict_by_squares(&columns, y, x + lane)];
            for (wide, one) in wide.concat().iter().zip(one) {
                let mut row = [0.0; MAX_LANES];
                Lanes::store(wide.leverage, &mut row);
                assert_eq!(row[lane].to_bits(), one.leverage.to_bits());
                Lanes::store(wide.irradiance[0], &mut row);
                assert_eq!(row[lane].to_bits(), one.irradiance[0].to_bits());
            }
        }
    }
}

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
