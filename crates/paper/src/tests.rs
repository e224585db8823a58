//! Compares the baseline with brute force, closed forms and Spherule.

use super::*;
use spherule_render::SphereTree;
use spherule_render::image::{Image, compare};
use spherule_render::render::{Options, render};
use spherule_render::scene::generate::{Field, Generator};
use spherule_render::scene::{
    Environment, EnvironmentMap, Filter, Ground, Integrator, Lens, Light, Pose, Projection, Rgb,
    Roulette, SamplerKind, Settings, Spheres,
};
use std::path::Path;

/// Returns a scene of the paper with a small image.
fn load(name: &str, side: u32, spp: u32) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let mut scene = Scene::load(&path).unwrap();
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (side, side, spp);
    scene
}

fn tracer(scene: &Scene, hierarchy: bool) -> PaperTracer {
    PaperTracer::new(scene, &World::build(scene).unwrap(), hierarchy).unwrap()
}

fn render_paper(scene: &Scene, threading: Threading) -> Image {
    tracer(scene, true).render(&scene.settings, threading).unwrap().image
}

fn render_spherule(scene: &Scene) -> Image {
    let world = World::build(scene).unwrap();
    render(&world, &scene.settings, &Options::default()).unwrap().image
}

/// Returns random numbers in 0..1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut random = random::Random::Own(random::Random::sequence(seed));
    move || random.unit()
}

/// Returns random spheres that are exact in single precision.
fn cloud(count: usize, seed: u64) -> Scene {
    let (mut scene, mut unit) = (Scene::default(), numbers(seed));
    for _ in 0..count {
        let mut single = || f64::from(unit() as f32);
        let center = DVec3::new(single(), single(), single());
        let radius = f64::from((0.01 + 0.1 * single()) as f32);
        scene.spheres.push(center, radius, 0, Rgb::ONE);
    }
    let material = Material::Lambertian { color: Rgb::ONE };
    scene.materials.push(NamedMaterial { name: "white".into(), material });
    scene
}

#[test]
fn the_hierarchy_the_array_and_spherule_find_the_same_spheres() {
    for (count, seed) in [(1, 1), (2, 2), (3, 3), (300, 4)] {
        let scene = cloud(count, seed);
        let [with, without] = [true, false].map(|hierarchy| tracer(&scene, hierarchy));
        let columns = &scene.spheres;
        let [x, y, z, radius] = [&columns.x, &columns.y, &columns.z, &columns.radius]
            .map(|column| column.iter().map(|v| *v as f32).collect::<Vec<_>>());
        let tree = SphereTree::from_columns(&x, &y, &z, &radius).unwrap();
        let (mut unit, mut hits) = (numbers(seed + 10), 0);
        for _ in 0..2000 {
            let mut single = || unit() as f32;
            let from = [single() * 4.0 - 2.0, single() * 4.0 - 2.0, -2.0];
            let to = [single(), single(), single()];
            let direction = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
            let (origin, d) = (DVec3::from(from.map(f64::from)), direction.map(f64::from));
            let unit = DVec3::from(d).normalize();
            let found = with.closest(origin, unit);
            assert_eq!(found, without.closest(origin, unit));
            let expected = tree.intersect(from, direction).map(|hit| hit.sphere as usize);
            let row = found.map(|hit| hit.primitive);
            assert_eq!(row, expected.map(Primitive::Sphere), "{from:?} {direction:?}");
            let ray = Ray { origin, direction: unit };
            for t_max in [0.5, 2.5, f64::INFINITY] {
                let nearer = found.is_some_and(|hit| hit.t < t_max);
                assert_eq!([&with, &without].map(|t| t.occluded(&ray, t_max)), [nearer; 2]);
            }
            hits += usize::from(found.is_some());
        }
        assert!(hits > 5, "{hits}");
    }
}

/// Returns overlapping white spheres under a white sky.
fn furnace(material: Material) -> Scene {
    let mut scene = cloud(40, 7);
    scene.materials[0].material = material;
    scene.environment = Environment { map: EnvironmentMap::Constant(Rgb::ONE), illuminates: true };
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp) = (24, 24, 16);
    settings.integrator = Integrator::Whitted { shadow_samples: 4 };
    settings.roulette = Roulette::None;
    settings.depth = Some(PaperTracer::MAX_BOUNCES);
    scene
}

fn mean(image: &Image) -> (f64, f64) {
    let values: Vec<f64> = image.pixels.iter().map(|pixel| f64::from(pixel[1])).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[test]
fn lossless_mirrors_are_invisible_in_a_furnace() {
    let fresnel = ConductorFresnel::Constant(Rgb::ONE);
    let mut scene = furnace(Material::Conductor { fresnel, roughness: 0.0 });
    assert!(
        render_paper(&scene, Threading::Independent).pixels.iter().flatten().all(|v| *v == 1.0)
    );
    // Roulette adds noise, but no bias.
    for probability in [0.9, 0.5] {
        scene.settings.roulette = Roulette::Fixed(probability);
        let (mean, error) = mean(&render_paper(&scene, Threading::Critical));
        assert!(error > 1e-4 && (mean - 1.0).abs() < 4.0 * error, "{mean} {error}");
    }
}

#[test]
fn a_lone_diffuse_sphere_shows_its_albedo() {
    let mut scene = furnace(Material::Lambertian { color: Rgb::splat(0.75) });
    scene.spheres = Spheres::default();
    scene.spheres.push(DVec3::new(0.5, 0.25, 0.0), 1.0, 0, Rgb::new(1.0, 1.0, 0.5));
    scene.camera.projection = Projection::Orthographic { height: Some(0.5) };
    for threading in [Threading::Critical, Threading::Independent] {
        let image = render_paper(&scene, threading);
        assert!(image.pixels.iter().all(|pixel| *pixel == [0.75, 0.75, 0.375]));
    }
}

#[test]
fn flat_colors_agree_to_the_last_bit() {
    let mut scene = furnace(Material::Emitter { radiance: Rgb::ONE, albedo: Rgb::ZERO });
    scene.materials = (0..40)
        .map(|row| {
            let radiance = Rgb::new(1.0, 0.1, 0.03) * row as f32;
            let material = Material::Emitter { radiance, albedo: Rgb::ZERO };
            NamedMaterial { name: row.to_string(), material }
        })
        .collect();
    scene.spheres.material = (0..40).collect();
    (scene.settings.width, scene.settings.height) = (96, 96);
    scene.settings.filter = Filter::Box;
    let (theirs, ours) = (render_paper(&scene, Threading::Independent), render_spherule(&scene));
    let flat = |pixel: &[f32; 3]| {
        let of_one = |row: u32| (Rgb::new(1.0, 0.1, 0.03) * row as f32).to_array();
        (0..40).any(|row| of_one(row) == *pixel)
    };
    let pairs = || theirs.pixels.iter().zip(&ours.pixels);
    let equal = pairs().filter(|(a, b)| a == b && flat(a) && **a != [0.0; 3]).count();
    let differ = pairs().filter(|(a, b)| a != b && flat(a) && flat(b)).count();
    assert!(equal > 1000 && differ < 20, "{equal} {differ}");
}

/// Asserts that images differ only by noise, in each of 5 x 5 regions.
#[track_caller]
fn assert_equal_up_to_noise(a: &Image, b: &Image, what: &str) {
    for region in 0..25 {
        let (column, row) = (region % 5, region / 5);
        let inside = |index: usize| {
            let (x, y) = (index % a.width as usize, index / a.width as usize);
            x * 5 / a.width as usize == column && y * 5 / a.height as usize == row
        };
        let crop = |image: &Image| {
            let pixels = image.pixels.iter().enumerate().filter(|(index, _)| inside(*index));
            let pixels: Vec<_> = pixels.map(|(_, pixel)| *pixel).collect();
            Image::new(pixels.len() as u32, 1, pixels).unwrap()
        };
        let found = compare(&crop(a), &crop(b)).unwrap();
        let allowed = 4.5 * found.bias_standard_error + 1e-6;
        assert!(found.bias.abs() <= allowed, "{what}, region {region}: {found:?}");
    }
}

#[test]
fn images_of_the_papers_scenes_agree() {
    for name in ["paper-two-spheres.toml", "paper-grid-20.toml", "paper-field-20.toml"] {
        let mut scene = load(name, 60, 16);
        scene.settings.integrator = Integrator::Whitted { shadow_samples: 6 };
        let ours = render_spherule(&scene);
        let critical = render_paper(&scene, Threading::Critical);
        assert_equal_up_to_noise(&critical, &ours, name);
        assert_equal_up_to_noise(&critical, &render_paper(&scene, Threading::Independent), name);
        scene.settings.roulette = Roulette::Fixed(0.5);
        assert_equal_up_to_noise(&render_paper(&scene, Threading::Independent), &ours, name);
    }
}

#[test]
fn images_with_every_light_agree() {
    let field = Field { count: 6, ..Field::default() };
    let generator = Generator::Field(field);
    let mut scene = Scene { spheres: generator.generate(3).unwrap().spheres, ..cloud(0, 0) };
    scene.materials.push(NamedMaterial {
        name: "emitter".into(),
        material: Material::Emitter { radiance: Rgb::splat(20.0), albedo: Rgb::splat(0.5) },
    });
    scene.spheres.push(DVec3::new(-1.0, 2.0, 1.0), 0.5, 1, Rgb::ONE);
    scene.ground = Some(Ground { normal: DVec3::Y, height: 0.0, material: 0 });
    let irradiance = Rgb::new(1.0, 0.8, 0.5);
    let direction = DVec3::new(0.6, 0.8, 0.0);
    scene.lights = [0.0, 12.0]
        .map(|angular_radius| Light::Sun { direction, irradiance, angular_radius })
        .to_vec();
    let position = DVec3::new(0.0, 3.0, 0.0);
    scene.lights.extend([false, true].map(|falloff| Light::Point {
        position,
        intensity: Rgb::new(0.5, 0.6, 0.9),
        falloff,
    }));
    scene.environment.illuminates = true;
    scene.camera.lens = Some(Lens { aperture: 0.3, focus: None });
    scene.camera.pose =
        Pose::LookAt { eye: DVec3::new(0.0, 4.0, 6.0), target: DVec3::new(0.0, 0.0, 0.0) };
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp, settings.depth) = (60, 60, 16, Some(4));
    settings.integrator = Integrator::Whitted { shadow_samples: 5 };
    (settings.filter, settings.sampler) = (Filter::Box, SamplerKind::Independent);
    settings.roulette = Roulette::None;
    assert_equal_up_to_noise(
        &render_paper(&scene, Threading::Independent),
        &render_spherule(&scene),
        "lights",
    );
}

#[test]
fn images_are_reproducible_with_independent_rows_or_one_thread() {
    let scene = load("paper-two-spheres.toml", 16, 2);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let with =
        |pool: &rayon::ThreadPool, threading| pool.install(|| render_paper(&scene, threading));
    assert_eq!(with(&one, Threading::Independent), with(&three, Threading::Independent));
    assert_eq!(with(&one, Threading::Critical), with(&one, Threading::Critical));
}

#[test]
fn unsupported_scenes_and_settings_are_refused() {
    let mut scene = furnace(Material::Dielectric { ior: 1.5, color: Rgb::ONE });
    let refused = PaperTracer::new(&scene, &World::build(&scene).unwrap(), true).err();
    assert_eq!(refused, Some(Unsupported::Material("white".into())));
    scene.materials[0].material = Material::Lambertian { color: Rgb::ONE };
    let tracer = tracer(&scene, true);
    let refuses = |change: fn(&mut Settings), why| {
        let mut settings = scene.settings.clone();
        change(&mut settings);
        assert_eq!(tracer.render(&settings, Threading::Independent).err(), Some(why));
    };
    refuses(|settings| settings.integrator = Integrator::Path, Unsupported::Integrator);
    refuses(|settings| settings.roulette = Roulette::Throughput, Unsupported::Roulette);
    refuses(|settings| settings.depth = None, Unsupported::Depth);
}
