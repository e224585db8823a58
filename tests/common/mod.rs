//! What the tests that render share: scenes in a few lines, pictures, means and their errors.

#![allow(dead_code, reason = "each test crate uses its own part of this")]

use glam::DVec3;
use spherule::World;
use spherule::image::Image;
use spherule::render::{Options, Render, render};
use spherule::scene::{
    Camera, ConductorFresnel, Environment, EnvironmentMap, Filter, Ground, Lens, Light, Material,
    NamedMaterial, Pose, Projection, Rgb, Roulette, Scene, Settings,
};
use std::ops::Range;
use std::sync::Arc;

/// Standard errors that a mean may be off: by chance more than that happens once in 30 000 comparisons.
pub(crate) const SIGMAS: f64 = 4.2;

/// Pictures of an estimate that needs several: they tell its error to an eighth.
const SEEDS: u64 = 32;

/// Relative rounding of a radiance: a dozen single-precision operations lead to it.
const ROUNDING: f64 = 12.0 * f32::EPSILON as f64;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) error: f64,
}

impl Estimate {
    /// From values that do not depend on one another.
    pub(crate) fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
        Self { mean, error: (squares / (count - 1.0) / count).sqrt() }
    }

    /// Of the red channel over a whole picture. Pixels draw independent numbers, so their spread tells the error
    /// whatever the sampler; where the truth varies over the picture the error comes out too large.
    pub(crate) fn of_picture(image: &Image) -> Self {
        Self::of(image.pixels.iter().map(|pixel| f64::from(pixel[0])))
    }

    /// The same after multiplication by an exact number.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, error: self.error * factor.abs() }
    }
}

/// Whether a mean agrees with the truth, given its standard error.
pub(crate) fn within(mean: f64, truth: f64, sigmas: f64, error: f64) -> bool {
    (mean - truth).abs() <= sigmas * error + ROUNDING * truth.abs()
}

/// Fails unless the estimate agrees with the truth.
#[track_caller]
pub(crate) fn assert_truth(estimate: Estimate, truth: f64, what: &str) {
    let Estimate { mean, error } = estimate;
    let sigmas = (mean - truth) / error;
    assert!(
        within(mean, truth, SIGMAS, error),
        "{what}: {mean} +- {error}, not {truth}: {sigmas} sigma"
    );
}

/// Fails unless two estimates agree.
#[track_caller]
pub(crate) fn assert_agree(a: Estimate, b: Estimate, what: &str) {
    assert_truth(Estimate { error: a.error.hypot(b.error), ..a }, b.mean, what);
}

/// Fails unless every channel of every pixel is `value`, to the bit.
#[track_caller]
pub(crate) fn assert_every_pixel(image: &Image, value: f32, what: &str) {
    for (i, pixel) in image.pixels.iter().enumerate() {
        assert_eq!(*pixel, [value; 3], "{what}: pixel {i}");
    }
}

/// A ball of radius 1 at height 3 over a ground under a sun in the zenith, in direct light alone.
pub(crate) fn noon() -> Scene {
    let mut scene = dark();
    sphere(&mut scene, [0.0, 0.0, 3.0], 1.0, lambertian(0.5));
    ground(&mut scene, lambertian(0.5));
    scene.lights =
        vec![Light::Sun { direction: DVec3::Z, irradiance: Rgb::ONE, angular_radius: 0.0 }];
    scene.settings.depth = Some(1);
    scene
}

/// An empty scene in the dark: 16 x 16 pixels, box filter, paths that end by nothing but depth.
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

/// The same in an environment of radiance 1.
pub(crate) fn furnace() -> Scene {
    Scene { environment: Environment::default(), ..dark() }
}

/// Radiance 0 from below, along -z, to 1 from above.
pub(crate) fn gradient() -> EnvironmentMap {
    EnvironmentMap::Gradient { bottom: Rgb::ZERO, top: Rgb::ONE, up: DVec3::Z }
}

/// Adds a material and gives its row.
pub(crate) fn material(scene: &mut Scene, material: Material) -> u32 {
    let name = format!("material {}", scene.materials.len());
    scene.materials.push(NamedMaterial { name, material });
    scene.materials.len() as u32 - 1
}

/// Adds a sphere of a material of its own.
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

/// A white metal.
pub(crate) fn metal(roughness: f64) -> Material {
    Material::Conductor { fresnel: ConductorFresnel::Constant(Rgb::ONE), roughness }
}

/// Looks from `eye` at `target` with a field of view in degrees; up is z, or y along z.
pub(crate) fn look(scene: &mut Scene, eye: DVec3, target: DVec3, fov: f64) {
    aim(scene, eye, target, Projection::Perspective { fov });
}

/// Looks from `eye` at `target` by parallel rays; the picture is `height` high.
pub(crate) fn look_parallel(scene: &mut Scene, eye: DVec3, target: DVec3, height: f64) {
    aim(scene, eye, target, Projection::Orthographic { height: Some(height) });
}

fn aim(scene: &mut Scene, eye: DVec3, target: DVec3, projection: Projection) {
    let pose = Pose::LookAt { eye, target };
    scene.camera = Camera { projection, pose, up: DVec3::Z, ..Camera::default() };
}

/// Builds and renders a scene.
pub(crate) fn shoot(scene: &Scene) -> Render {
    shoot_with(scene, &Options::default())
}

/// Builds and renders a scene, as told.
pub(crate) fn shoot_with(scene: &Scene, options: &Options) -> Render {
    let world = World::build(scene).expect("the scene is sound");
    let render = render(&world, &scene.settings, options).expect("settings in range");
    assert_eq!(render.counters.bad_samples, 0);
    render
}

/// Mean radiance over the whole picture.
pub(crate) fn measure(scene: &Scene) -> Estimate {
    Estimate::of_picture(&shoot(scene).image)
}

/// Estimates a number that pictures show, from pictures with different random numbers: where the picture varies, its
/// pixels do not tell the error of their mean.
pub(crate) fn over_seeds(scene: &Scene, number: impl Fn(&Image) -> f64) -> Estimate {
    let [estimate] = each_over_seeds(scene, |image| [number(image)]);
    estimate
}

/// The same for several numbers of each picture.
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

/// Fails unless two scenes look alike in each of six bands of their pictures' rows.
#[track_caller]
pub(crate) fn assert_alike(a: &Scene, b: &Scene, what: &str) {
    let bands = |image: &Image| {
        let rows = image.height / 6;
        [0, 1, 2, 3, 4, 5].map(|band| mean_of_rows(image, band * rows..(band + 1) * rows))
    };
    let pairs = each_over_seeds(a, bands).into_iter().zip(each_over_seeds(b, bands));
    for (band, (a, b)) in pairs.enumerate() {
        assert_agree(a, b, &format!("{what}, band {band}"));
    }
}

/// Mean of the red channel of rows.
pub(crate) fn mean_of_rows(image: &Image, rows: Range<u32>) -> f64 {
    let width = image.width as usize;
    let pixels = &image.pixels[rows.start as usize * width..rows.end as usize * width];
    pixels.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / pixels.len() as f64
}

/// Mean of the red channel.
pub(crate) fn mean(image: &Image) -> f64 {
    mean_of_rows(image, 0..image.height)
}

/// Radiance that leaves `point` toward `eye`: through a window so narrow that it does not vary.
pub(crate) fn probe(scene: &mut Scene, point: DVec3, eye: DVec3) -> Estimate {
    look_parallel(scene, eye, point, 1e-5);
    measure(scene)
}

/// Spheres of every material on a ground, lit by every kind of light, seen through a lens: small and quick. Coordinates
/// are exact in single precision, also far from the origin.
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
    // Glass in glass, and a lamp in it.
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

/// A few pixels, one of them bright.
fn menagerie_sky() -> EnvironmentMap {
    let pixels =
        (0..32).map(|i| if i == 10 { [9.0, 8.0, 7.0] } else { [0.25, 0.5, 0.5] }).collect();
    let image = Arc::new(Image { width: 8, height: 4, pixels });
    EnvironmentMap::Picture { image, up: DVec3::Z, rotation: 30.0, scale: 0.5 }
}
