//! Helpers of tests that render: short scenes, images, means and their errors.

#![allow(dead_code, reason = "each test crate uses its own part of this")]

use glam::DVec3;
use spherule_render::World;
use spherule_render::image::Image;
use spherule_render::render::{Options, Render, render};
use spherule_render::scene::{
    Camera, ConductorFresnel, Environment, EnvironmentMap, Filter, Ground, Lens, Light, Material,
    NamedMaterial, Pose, Projection, Rgb, Roulette, Scene, Settings,
};
use std::ops::Range;
use std::sync::Arc;

/// Tolerance of means in standard errors; exceeded by chance once in 30 000 comparisons.
pub(crate) const SIGMAS: f64 = 4.2;

/// Number of images for an estimate from several; its error is known to an eighth.
const SEEDS: u64 = 32;

/// Relative rounding error of a radiance, after a dozen single-precision operations.
const ROUNDING: f64 = 12.0 * f32::EPSILON as f64;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) error: f64,
}

impl Estimate {
    /// Returns mean and error of independent values.
    pub(crate) fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
        Self { mean, error: (squares / (count - 1.0) / count).sqrt() }
    }

    /// Returns mean and error of the red channel over an image. Pixels have independent random numbers, so
    /// their variance gives the error for every sampler. If the expected value varies, the error is
    /// overestimated.
    pub(crate) fn of_image(image: &Image) -> Self {
        Self::of(image.pixels.iter().map(|pixel| f64::from(pixel[0])))
    }

    /// Multiplies by an exact number.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, error: self.error * factor.abs() }
    }
}

/// Returns whether a mean agrees with the expected value, given its standard error.
pub(crate) fn within(mean: f64, truth: f64, sigmas: f64, error: f64) -> bool {
    (mean - truth).abs() <= sigmas * error + ROUNDING * truth.abs()
}

/// Asserts that the estimate agrees with the expected value.
#[track_caller]
pub(crate) fn assert_expected(estimate: Estimate, truth: f64, what: &str) {
    let Estimate { mean, error } = estimate;
    let sigmas = (mean - truth) / error;
    assert!(
        within(mean, truth, SIGMAS, error),
        "{what}: {mean} +- {error}, not {truth}: {sigmas} sigma"
    );
}

/// Asserts that two estimates agree.
#[track_caller]
pub(crate) fn assert_agree(a: Estimate, b: Estimate, what: &str) {
    assert_expected(Estimate { error: a.error.hypot(b.error), ..a }, b.mean, what);
}

/// Asserts that every channel of every pixel is exactly `value`.
#[track_caller]
pub(crate) fn assert_every_pixel(image: &Image, value: f32, what: &str) {
    for (i, pixel) in image.pixels.iter().enumerate() {
        assert_eq!(*pixel, [value; 3], "{what}: pixel {i}");
    }
}

/// Returns a sphere of radius 1 at height 3 above a ground under a sun at the zenith, with direct light only.
pub(crate) fn noon() -> Scene {
    let mut scene = dark();
    sphere(&mut scene, [0.0, 0.0, 3.0], 1.0, lambertian(0.5));
    ground(&mut scene, lambertian(0.5));
    scene.lights =
        vec![Light::Sun { direction: DVec3::Z, irradiance: Rgb::ONE, angular_radius: 0.0 }];
    scene.settings.depth = Some(1);
    scene
}

/// Returns an empty scene without light: 16 x 16 pixels, box filter, no roulette.
pub(crate) fn dark() -> Scene {
    let settings = Settings {
        width: 16,
        height: 16,
        spp: 64,
        filter: Filter::Box,
        roulette: Roulette::None,
        ..Settings::default()
    };
    let mut scene = Scene { settings, ..Scene::default() };
    scene.environment.map = EnvironmentMap::Constant(Rgb::ZERO);
    look(&mut scene, DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO, 40.0);
    scene
}

/// Returns the same scene in an environment of radiance 1.
pub(crate) fn furnace() -> Scene {
    Scene { environment: Environment::default(), ..dark() }
}

/// Returns a gradient from radiance 0 below, along -z, to 1 above.
pub(crate) fn gradient() -> EnvironmentMap {
    EnvironmentMap::Gradient { bottom: Rgb::ZERO, top: Rgb::ONE, up: DVec3::Z }
}

/// Adds a material and returns its row.
pub(crate) fn material(scene: &mut Scene, material: Material) -> u32 {
    let name = format!("material {}", scene.materials.len());
    scene.materials.push(NamedMaterial { name, material });
    scene.materials.len() as u32 - 1
}

/// Adds a sphere with its own material.
pub(crate) fn sphere(scene: &mut Scene, center: impl Into<DVec3>, radius: f64, made_of: Material) {
    let row = material(scene, made_of);
    scene.spheres.push(center.into(), radius, row, Rgb::ONE);
}

/// Adds the plane z = 0.
pub(crate) fn ground(scene: &mut Scene, made_of: Material) {
    let material = material(scene, made_of);
    scene.ground = Some(Ground { normal: DVec3::Z, height: 0.0, material });
}

pub(crate) fn lambertian(albedo: f32) -> Material {
    Material::Lambertian { color: Rgb::splat(albedo) }
}

pub(crate) fn emitter(radiance: f32, albedo: f32) -> Material {
    Material::Emitter { radiance: Rgb::splat(radiance), albedo: Rgb::splat(albedo) }
}

pub(crate) fn glass(ior: f64) -> Material {
    Material::Dielectric { ior, color: Rgb::ONE }
}

pub(crate) fn mirror() -> Material {
    metal(0.0)
}

/// Returns a white metal.
pub(crate) fn metal(roughness: f64) -> Material {
    Material::Conductor { fresnel: ConductorFresnel::Constant(Rgb::ONE), roughness }
}

/// Places the camera at `eye`, looking at `target`, with a field of view in degrees; up is z, or y for views
/// along z.
pub(crate) fn look(scene: &mut Scene, eye: DVec3, target: DVec3, fov: f64) {
    aim(scene, eye, target, Projection::Perspective { fov });
}

/// Places an orthographic camera at `eye`, looking at `target`, with an image of this height.
pub(crate) fn look_parallel(scene: &mut Scene, eye: DVec3, target: DVec3, height: f64) {
    aim(scene, eye, target, Projection::Orthographic { height: Some(height) });
}

fn aim(scene: &mut Scene, eye: DVec3, target: DVec3, projection: Projection) {
    let pose = Pose::LookAt { eye, target };
    scene.camera = Camera { projection, pose, up: DVec3::Z, ..Camera::default() };
}

/// Builds and renders a scene.
pub(crate) fn render_scene(scene: &Scene) -> Render {
    render_scene_with(scene, &Options::default())
}

/// Builds and renders a scene with options.
pub(crate) fn render_scene_with(scene: &Scene, options: &Options) -> Render {
    let world = World::build(scene).expect("the scene is sound");
    let render = render(&world, &scene.settings, options).expect("settings in range");
    assert_eq!(render.counters.bad_samples, 0);
    render
}

/// Returns the mean radiance of an image.
pub(crate) fn measure(scene: &Scene) -> Estimate {
    Estimate::of_image(&render_scene(scene).image)
}

/// Estimates a number from images with different seeds. If the expected value varies over the image, the
/// variance of pixels does not give the error of their mean.
pub(crate) fn over_seeds(scene: &Scene, number: impl Fn(&Image) -> f64) -> Estimate {
    let [estimate] = each_over_seeds(scene, |image| [number(image)]);
    estimate
}

/// Estimates several numbers from images with different seeds.
pub(crate) fn each_over_seeds<const N: usize>(
    scene: &Scene,
    numbers: impl Fn(&Image) -> [f64; N],
) -> [Estimate; N] {
    let world = World::build(scene).expect("the scene is sound");
    let pictures: Vec<[f64; N]> = (0..SEEDS)
        .map(|seed| {
            let settings = Settings { seed, ..scene.settings.clone() };
            numbers(
                &render(&world, &settings, &Options::default()).expect("settings in range").image,
            )
        })
        .collect();
    std::array::from_fn(|i| Estimate::of(pictures.iter().map(|numbers| numbers[i])))
}

/// Asserts that images of two scenes agree in each of six bands of rows.
#[track_caller]
pub(crate) fn assert_scenes_agree(a: &Scene, b: &Scene, what: &str) {
    assert_scenes_agree_with(a, std::slice::from_ref(b), what);
}

/// Asserts the same of one scene and each of the others.
#[track_caller]
pub(crate) fn assert_scenes_agree_with(scene: &Scene, others: &[Scene], what: &str) {
    let bands = |image: &Image| {
        let rows = image.height / 6;
        [0, 1, 2, 3, 4, 5].map(|band| mean_of_rows(image, band * rows..(band + 1) * rows))
    };
    let means = each_over_seeds(scene, bands);
    for (place, other) in others.iter().enumerate() {
        for (band, (a, b)) in means.iter().zip(each_over_seeds(other, bands)).enumerate() {
            assert_agree(*a, b, &format!("{what}, {place}, band {band}"));
        }
    }
}

/// Returns the mean of the red channel over rows.
pub(crate) fn mean_of_rows(image: &Image, rows: Range<u32>) -> f64 {
    let width = image.width as usize;
    let pixels = &image.pixels[rows.start as usize * width..rows.end as usize * width];
    pixels.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / pixels.len() as f64
}

/// Returns the mean of the red channel.
pub(crate) fn mean(image: &Image) -> f64 {
    mean_of_rows(image, 0..image.height)
}

/// Returns the radiance from `point` toward `eye`, seen in a field of view so narrow that it does not vary.
pub(crate) fn probe(scene: &mut Scene, point: DVec3, eye: DVec3) -> Estimate {
    look_parallel(scene, eye, point, 1e-5);
    measure(scene)
}

/// Returns a small scene with spheres of every material on a ground, every kind of light, and a lens.
/// Coordinates are exact in single precision, also far from the origin.
pub(crate) fn menagerie() -> Scene {
    let mut scene = dark();
    scene.environment = Environment { map: menagerie_sky(), illuminates: true };
    let gold = ConductorFresnel::Schlick(Rgb::new(1.0, 0.75, 0.25));
    let copper =
        ConductorFresnel::Exact { eta: Rgb::new(0.2, 0.9, 1.1), k: Rgb::new(3.9, 2.5, 2.4) };
    let materials = [
        lambertian(0.75),
        Material::Conductor { fresnel: gold, roughness: 0.0 },
        Material::Conductor { fresnel: copper, roughness: 0.25 },
        glass(1.5),
        Material::Plastic { color: Rgb::new(0.75, 0.25, 0.5), ior: 1.5 },
        Material::Reflective { color: Rgb::splat(0.75), diffuse: 0.5, mirror: 0.25 },
        emitter(4.0, 0.25),
    ];
    let rows = materials.map(|made_of| material(&mut scene, made_of));
    for i in 0..33_u32 {
        let place =
            DVec3::new(f64::from(i * 7 % 12) - 6.0, f64::from(i * 5 % 11) - 5.0, f64::from(i % 5));
        let color = Rgb::new(1.0, f32::from(i as u8 % 4) / 4.0, 0.5);
        let radius = 0.25 + f64::from(i % 3) / 4.0;
        scene.spheres.push(place + DVec3::Z, radius, rows[i as usize % rows.len()], color);
    }
    // Nested glass with an emitter inside.
    sphere(&mut scene, [0.0, 0.0, 7.0], 1.0, glass(1.5));
    sphere(&mut scene, [0.25, 0.0, 7.0], 0.5, glass(1.25));
    sphere(&mut scene, [0.25, 0.0, 7.0], 0.125, emitter(8.0, 0.0));
    ground(
        &mut scene,
        Material::Reflective { color: Rgb::splat(0.5), diffuse: 0.75, mirror: 0.25 },
    );
    let position = DVec3::new(-4.0, -6.0, 8.0);
    scene.lights = vec![
        Light::Point { position, intensity: Rgb::new(8.0, 16.0, 24.0), falloff: true },
        Light::Point { position: -position, intensity: Rgb::splat(0.25), falloff: false },
        Light::Sun {
            direction: DVec3::new(0.6, 0.0, 0.8),
            irradiance: Rgb::ONE,
            angular_radius: 1.0,
        },
        Light::Sun { direction: DVec3::Z, irradiance: Rgb::splat(0.25), angular_radius: 0.0 },
    ];
    look(&mut scene, DVec3::new(6.0, -14.0, 9.0), DVec3::new(0.0, 0.0, 2.0), 45.0);
    scene.camera.lens = Some(Lens { aperture: 0.125, focus: None });
    (scene.settings.depth, scene.settings.spp) = (Some(8), 8);
    scene
}

/// Returns an image of a few pixels, one of them bright.
fn menagerie_sky() -> EnvironmentMap {
    let pixels =
        (0..32).map(|i| if i == 10 { [9.0, 8.0, 7.0] } else { [0.25, 0.5, 0.5] }).collect();
    let image = Arc::new(Image { width: 8, height: 4, pixels });
    EnvironmentMap::Picture { image, up: DVec3::Z, rotation: 30.0, scale: 0.5 }
}
