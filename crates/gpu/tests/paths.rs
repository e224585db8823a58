//! Pictures whose paths a device follows: the bytes of the processor's pictures.

#![allow(clippy::unwrap_used, reason = "tests fail so")]
#![allow(clippy::print_stdout, reason = "shares of unknown paths, with --nocapture")]

use crate::common::{device, own_device, scene_folder, scratch_folder};
use glam::DVec3;
use spherule_gpu::{Answered, Device, DeviceError, DeviceTree, Integrator as DeviceIntegrator};
use spherule_measure::random_scene;
use spherule_render::World;
use spherule_render::bvh::Tree;
use spherule_render::film::Region;
use spherule_render::image::Image;
use spherule_render::render::{
    End, ImagePart, Options, Progress, Render, ResumableRender, not_followed, render,
};
use spherule_render::scene::{
    Background, ConductorFresnel, EnvironmentMap, Integrator, Lens, Light, LightChoice, Material,
    NamedMaterial, Pose, Preset, Rgb, Roulette, Scene,
};
use spherule_render::settings::{Filter, SamplerKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Returns the files of scenes.
fn files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        scene_folder().read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

/// Reads a scene, for a small picture of few samples.
fn load(path: &Path) -> Scene {
    let mut scene = Scene::load(path).unwrap();
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp, settings.until_error) = (45, 34, 5, None);
    settings.sampler = SamplerKind::Sobol;
    scene
}

/// Reads a scene of the repository by its name.
fn named(name: &str) -> Scene {
    load(&scene_folder().join(name))
}

/// Gives the paths of a world to a device.
fn attach(world: &mut World, device: &Arc<Device>) -> Arc<DeviceTree> {
    let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
    let on_device = Arc::new(DeviceTree::new(device, tree).unwrap());
    let paths = DeviceIntegrator::new(&on_device, world).unwrap();
    world.device_paths = Some(Arc::new(paths));
    on_device
}

fn image(world: &World, scene: &Scene) -> Render {
    render(world, &scene.settings, &Options::default()).unwrap()
}

/// Compares pictures of the device and of the processor; returns what the device answered.
fn compare(name: &str, scene: &Scene, device: &Arc<Device>) -> Answered {
    let mut world = World::build(scene).unwrap();
    assert_eq!(not_followed(&world, &scene.settings), None, "{name}");
    let own = image(&world, scene);
    let on_device = attach(&mut world, device);
    let found = image(&world, scene);
    let bits = |render: &Render| -> Vec<[u32; 3]> {
        render.image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
    };
    let (expected, pixels) = (bits(&own), bits(&found));
    let differ = expected.iter().zip(&pixels).filter(|(a, b)| a != b).count();
    let tally = on_device.tally();
    let share = tally.unknown_paths as f64 / tally.paths.max(1) as f64;
    println!("{name}: {differ} pixels differ; {} paths, {share:.1e} unknown", tally.paths);
    assert_eq!(differ, 0, "{name}");
    let [own, found] = [own, found].map(|render| render.counters);
    assert_eq!(found.camera_rays, own.camera_rays, "{name}");
    assert_eq!(found.bounce_rays, own.bounce_rays, "{name}");
    assert_eq!(found.shadow_rays, own.shadow_rays, "{name}");
    assert_eq!(device.fault(), None);
    tally
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn ambient_occlusion_of_all_scenes_is_the_processors() {
    let device = device();
    let mut all = Answered::default();
    for path in files() {
        let mut scene = load(&path);
        let far = scene.spheres.len().is_multiple_of(2);
        let distance = if far { f64::INFINITY } else { 0.7 };
        scene.settings.integrator = Integrator::Ao { distance };
        all += compare(&path.display().to_string(), &scene, device);
    }
    assert!(all.paths > 50_000, "{all:?}");
    assert!(all.unknown_paths * 100 < all.paths, "{all:?}");
}

/// Makes all surfaces diffuse, under the sky alone.
fn diffuse(scene: &mut Scene) {
    scene.lights.clear();
    if !matches!(scene.environment.map, EnvironmentMap::Gradient { .. }) {
        scene.environment.map = EnvironmentMap::Constant(Rgb::new(0.9, 0.7, 0.4));
    }
    for (row, material) in scene.materials.iter_mut().enumerate() {
        let color = Rgb::new(0.8, 0.75 - 0.02 * (row % 9) as f32, 0.6);
        material.material = Material::Lambertian { color };
    }
    scene.settings.integrator = Integrator::Path;
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn paths_among_diffuse_surfaces_are_the_processors() {
    let device = device();
    let mut all = Answered::default();
    for path in files() {
        let mut scene = load(&path);
        diffuse(&mut scene);
        all += compare(&path.display().to_string(), &scene, device);
    }
    assert!(all.paths > 50_000, "{all:?}");
    assert!(all.unknown_paths * 100 < all.paths, "{all:?}");
}

/// Makes surfaces of these materials in turn, by the order of the scene's.
fn of_materials(scene: &mut Scene, materials: &[Material]) {
    for (named, material) in scene.materials.iter_mut().zip(materials.iter().cycle()) {
        named.material = material.clone();
    }
}

/// Returns a material of each kind that is opaque, or several.
fn opaque_materials() -> Vec<(&'static str, Material)> {
    let color = Rgb::new(0.9, 0.6, 0.3);
    let (eta, k) = (Rgb::new(0.143, 0.375, 1.442), Rgb::new(3.983, 2.386, 1.603));
    let metal = |fresnel, roughness| Material::Conductor { fresnel, roughness };
    vec![
        ("lambertian", Material::Lambertian { color }),
        ("mirror", metal(ConductorFresnel::Constant(color), 0.0)),
        ("schlick", metal(ConductorFresnel::Schlick(color), 0.3)),
        ("gold", metal(ConductorFresnel::Exact { eta, k }, 0.0)),
        ("rough gold", metal(ConductorFresnel::Exact { eta, k }, 0.15)),
        ("plastic", Material::Plastic { color, ior: 1.5 }),
        ("reflective", Material::Reflective { color, diffuse: 0.6, mirror: 0.3 }),
        ("black", Material::Reflective { color, diffuse: 0.0, mirror: 0.0 }),
    ]
}

/// Adds a sun, the only light beside the sky.
fn add_sun(scene: &mut Scene, angular_radius: f64) {
    let direction = DVec3::new(0.4, 0.7, 0.5).normalize();
    let irradiance = Rgb::new(2.0, 1.8, 1.5);
    scene.lights = vec![Light::Sun { direction, irradiance, angular_radius }];
}

/// Compares a scene of one material, with other colors for each sphere, under the sky and under suns of these
/// angular radii.
fn compare_material(name: &str, material: &Material, suns: &[f64], device: &Arc<Device>) {
    for sun in [None].into_iter().chain(suns.iter().copied().map(Some)) {
        let mut scene = named("paper-field-20.toml");
        diffuse(&mut scene);
        for named in scene.materials.iter_mut().filter(|row| row.name != "floor") {
            named.material = material.clone();
        }
        if let Some(radius) = sun {
            add_sun(&mut scene, radius);
        }
        let found = compare(&format!("{name}, sun {sun:?}"), &scene, device);
        assert!(found.unknown_paths * 50 < found.paths, "{name} {sun:?} {found:?}");
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn each_material_under_sky_and_sun_is_the_processors() {
    let device = device();
    for (name, material) in opaque_materials() {
        compare_material(name, &material, &[0.0, 3.0, 30.0], device);
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn light_that_coats_mirror_is_the_processors() {
    let device = device();
    for name in ["plastic", "reflective", "lambertian"] {
        let all = opaque_materials();
        let (_, material) = all.iter().find(|row| row.0 == name).unwrap();
        for background in [false, true] {
            let mut scene = named("paper-field-20.toml");
            diffuse(&mut scene);
            of_materials(&mut scene, std::slice::from_ref(material));
            // So large that no caustics are sampled.
            add_sun(&mut scene, 25.0);
            if background {
                scene.look.background = Background::Color(Rgb::new(0.1, 0.5, 0.3));
            } else {
                scene.environment.illuminates = false;
            }
            compare(&format!("{name} {background}"), &scene, device);
        }
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn mixed_materials_in_all_scenes_are_the_processors() {
    let device = device();
    let materials: Vec<Material> =
        opaque_materials().into_iter().map(|(_, material)| material).collect();
    for path in files() {
        let mut scene = load(&path);
        diffuse(&mut scene);
        of_materials(&mut scene, &materials);
        add_sun(&mut scene, 12.0);
        compare(&path.display().to_string(), &scene, device);
    }
}

/// Makes every third sphere emit, some brightly, and others diffuse or of these materials.
fn add_emitters(scene: &mut Scene, others: &[Material]) {
    of_materials(scene, others);
    for (row, named) in scene.materials.iter_mut().enumerate().filter(|(row, _)| row % 3 == 1) {
        let radiance = Rgb::new(4.0, 3.0, 0.5 + row as f32 % 5.0);
        named.material = Material::Emitter { radiance, albedo: Rgb::new(0.2, 0.5, 0.3) };
    }
}

/// Adds points with falloff and without, and suns with extent and without.
fn add_lights(scene: &mut Scene) {
    let intensity = Rgb::new(3.0, 5.0, 8.0);
    let sun = |direction: [f64; 3], angular_radius| Light::Sun {
        direction: DVec3::from(direction).normalize(),
        irradiance: Rgb::new(0.7, 0.4, 0.3),
        angular_radius,
    };
    scene.lights = vec![
        sun([0.4, 0.7, 0.5], 4.0),
        Light::Point { position: DVec3::new(1.0, 3.0, 2.0), intensity, falloff: true },
        Light::Point {
            position: DVec3::new(-4.0, 2.0, 1.0),
            intensity: 0.1 * intensity,
            falloff: false,
        },
        sun([-0.4, 0.9, 0.1], 0.0),
        sun([0.5, 0.6, 0.5], 30.0),
    ];
}

/// Returns diffuse and rough materials, which no light is mirrored by.
fn rough_materials() -> Vec<Material> {
    let all = opaque_materials()
        .into_iter()
        .filter(|(name, _)| ["lambertian", "schlick", "rough gold"].contains(name));
    all.map(|(_, material)| material).collect()
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn lights_of_every_kind_are_the_processors() {
    let device = device();
    let all: Vec<Material> = opaque_materials().into_iter().map(|(_, material)| material).collect();
    for choice in [LightChoice::Tree, LightChoice::Power, LightChoice::Uniform] {
        for (name, materials) in [("rough", &rough_materials()), ("all", &all)] {
            for (lights, emitters) in [(true, false), (false, true), (true, true)] {
                let mut scene = named("paper-field-20.toml");
                diffuse(&mut scene);
                of_materials(&mut scene, materials);
                if emitters {
                    add_emitters(&mut scene, materials);
                }
                if lights {
                    add_lights(&mut scene);
                }
                scene.settings.light_choice = choice;
                let case = format!("{name}, {choice:?}, lights {lights}, emitters {emitters}");
                let found = compare(&case, &scene, device);
                assert!(found.unknown_paths * 20 < found.paths, "{case} {found:?}");
            }
        }
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn one_emitter_and_hundreds_are_the_processors() {
    let device = device();
    for (name, every) in
        [("paper-two-spheres.toml", 2), ("paper-grid-500.toml", 3), ("sphereflake.toml", 2)]
    {
        let mut scene = named(name);
        diffuse(&mut scene);
        let materials = rough_materials();
        of_materials(&mut scene, &materials);
        let glowing = scene.materials.len() as u32;
        let radiance = Rgb::new(3.0, 2.0, 1.0);
        let material = Material::Emitter { radiance, albedo: Rgb::splat(0.4) };
        scene.materials.push(NamedMaterial { name: "glowing".to_owned(), material });
        for material in scene.spheres.material.iter_mut().step_by(every) {
            *material = glowing;
        }
        let found = compare(name, &scene, device);
        assert!(found.unknown_paths * 20 < found.paths, "{name} {found:?}");
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn emitters_that_smooth_surfaces_mirror_are_the_processors() {
    let device = device();
    let mirror = Material::Reflective { color: Rgb::new(0.9, 0.8, 0.7), diffuse: 0.5, mirror: 0.4 };
    for suns in [false, true] {
        let mut scene = named("paper-field-20.toml");
        diffuse(&mut scene);
        add_emitters(&mut scene, std::slice::from_ref(&mirror));
        if suns {
            add_lights(&mut scene);
        }
        let found = compare(&format!("mirrored emitters, suns {suns}"), &scene, device);
        assert!(found.unknown_paths * 20 < found.paths, "{found:?}");
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn glass_that_stands_alone_is_the_processors() {
    let device = device();
    for (name, color) in [("clear", Rgb::ONE), ("tinted", Rgb::new(0.9, 0.7, 0.95))] {
        for background in [false, true] {
            for lights in [false, true] {
                let mut scene = named("paper-field-20.toml");
                diffuse(&mut scene);
                let glass = Material::Dielectric { ior: 1.5, color };
                let [rough, ..] = &rough_materials()[..] else { panic!("there are some") };
                let spheres = scene.materials.iter_mut().filter(|row| row.name != "floor");
                for (named, material) in spheres.zip([rough.clone(), glass]) {
                    named.material = material;
                }
                if lights {
                    add_lights(&mut scene);
                }
                if background {
                    scene.look.background = Background::Color(Rgb::new(0.1, 0.5, 0.3));
                }
                let case = format!("{name} glass, background {background}, lights {lights}");
                let found = compare(&case, &scene, device);
                assert!(found.unknown_paths * 20 < found.paths, "{case} {found:?}");
            }
        }
    }
}

/// Returns smooth materials, which cast caustics.
fn smooth_materials() -> Vec<(&'static str, Material)> {
    let smooth = |(name, _): &(&str, Material)| ["mirror", "plastic", "gold"].contains(name);
    let mut all: Vec<_> = opaque_materials().into_iter().filter(smooth).collect();
    all.push(("glass", Material::Dielectric { ior: 1.5, color: Rgb::new(0.9, 0.7, 0.95) }));
    all
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn caustics_are_the_processors() {
    let device = device();
    let [rough, ..] = &rough_materials()[..] else { panic!("there are some") };
    for (name, smooth) in smooth_materials() {
        for (suns, emitters) in [(true, false), (false, true), (true, true)] {
            let mut scene = named("paper-field-20.toml");
            diffuse(&mut scene);
            of_materials(&mut scene, &[rough.clone(), smooth.clone()]);
            if emitters {
                add_emitters(&mut scene, &[rough.clone(), smooth.clone()]);
            }
            if suns {
                add_sun(&mut scene, 3.0);
            }
            let case = format!("caustics of {name}, suns {suns}, emitters {emitters}");
            let found = compare(&case, &scene, device);
            assert!(found.unknown_paths * 20 < found.paths, "{case} {found:?}");
        }
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn whitted_ray_tracing_is_the_processors() {
    let device = device();
    let mut all: Vec<Material> =
        opaque_materials().into_iter().map(|(_, material)| material).collect();
    all.push(Material::Dielectric { ior: 1.5, color: Rgb::new(0.9, 1.0, 0.8) });
    let mut followed = 0;
    for path in files() {
        for (shadow_samples, own_lights) in [(1, true), (3, false), (20, false)] {
            let mut scene = load(&path);
            scene.settings.integrator = Integrator::Whitted { shadow_samples };
            if !own_lights {
                diffuse(&mut scene);
                add_emitters(&mut scene, &all);
                // The ground cannot be glass or an emitter.
                if let Some(ground) = &scene.ground {
                    scene.materials[ground.material as usize].material = all[5].clone();
                }
                add_lights(&mut scene);
                scene.settings.integrator = Integrator::Whitted { shadow_samples };
                scene.settings.spp = 2;
                if shadow_samples == 3 {
                    scene.look.background = Background::Color(Rgb::new(0.1, 0.5, 0.3));
                }
            }
            let case = format!("whitted {shadow_samples}, {}", path.display());
            let world = World::build(&scene).unwrap();
            // Hundreds of emitters have too many shadow samples.
            if not_followed(&world, &scene.settings).is_none() {
                compare(&case, &scene, device);
                followed += 1;
            }
        }
    }
    assert!(followed >= 28, "{followed}");
    let mut scene = named("paper-field-20.toml");
    diffuse(&mut scene);
    let image = Arc::new(sky_picture(20, 10, true));
    scene.environment.map =
        EnvironmentMap::Picture { image, up: DVec3::Z, rotation: 0.7, scale: 1.3 };
    scene.settings.integrator = Integrator::Whitted { shadow_samples: 5 };
    let found = compare("whitted, picture of a sky", &scene, device);
    assert!(found.unknown_paths * 20 < found.paths, "{found:?}");
}

/// A picture of a sky with some colors, a small sun or none, and black pixels.
fn sky_picture(width: u32, height: u32, sun: bool) -> Image {
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        if sun && (x, y) == (width / 3, height / 4) {
            return [900.0, 800.0, 600.0];
        }
        let shade = (i.wrapping_mul(0x9e37_79b9) >> 24) as f32 / 256.0;
        if y > height / 2 && x > width / 2 { [0.0; 3] } else { [0.6 * shade, 0.5, 1.1 - shade] }
    };
    Image { width, height, pixels: (0..width * height).map(pixel).collect() }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn pictures_of_skies_are_the_processors() {
    let device = device();
    for (size, sun, illuminates) in [
        ((40, 20), true, true),
        ((3, 2), false, true),
        ((1, 1), false, true),
        ((17, 30), true, false),
    ] {
        for choice in [LightChoice::Tree, LightChoice::Power] {
            for others in [false, true] {
                let mut scene = named("paper-field-20.toml");
                diffuse(&mut scene);
                of_materials(&mut scene, &rough_materials());
                if others {
                    add_emitters(&mut scene, &rough_materials());
                    add_lights(&mut scene);
                }
                let image = Arc::new(sky_picture(size.0, size.1, sun));
                let up = DVec3::new(0.1, 1.0, 0.2).normalize();
                scene.environment.map =
                    EnvironmentMap::Picture { image, up, rotation: 0.7, scale: 1.3 };
                scene.environment.illuminates = illuminates;
                scene.settings.light_choice = choice;
                for integrator in [Integrator::Path, Integrator::Ao { distance: 2.0 }] {
                    scene.settings.integrator = integrator;
                    let case = format!("sky {size:?}, {choice:?}, others {others} {integrator:?}");
                    let found = compare(&case, &scene, device);
                    assert!(found.unknown_paths * 20 < found.paths, "{case} {found:?}");
                }
            }
        }
    }
}

/// Returns where the camera is.
fn eye_of(scene: &Scene) -> DVec3 {
    let Pose::LookAt { eye, .. } = scene.camera.pose else { panic!("it has a place") };
    eye
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn nested_and_overlapping_glass_is_the_processors() {
    let device = device();
    for tint in [Rgb::ONE, Rgb::new(0.9, 0.95, 0.7)] {
        let mut scene = named("paper-field-20.toml");
        diffuse(&mut scene);
        let dense = Material::Dielectric { ior: 1.9, color: tint };
        let glass = Material::Dielectric { ior: 1.3, color: tint };
        for named in scene.materials.iter_mut().filter(|row| row.name != "floor") {
            named.material = glass.clone();
        }
        let row = scene.materials.len() as u32;
        scene.materials.push(NamedMaterial { name: "dense".to_owned(), material: dense });
        // In each sphere one, one that overlaps it, and one more of its size.
        for sphere in 0..scene.spheres.len() {
            let (center, radius) = (scene.spheres.center(sphere), scene.spheres.radius[sphere]);
            scene.spheres.push(center + 0.1 * radius, 0.6 * radius, row, Rgb::ONE);
            scene.spheres.push(center + DVec3::Y * radius, 0.7 * radius, row, Rgb::ONE);
            scene.spheres.push(center + DVec3::X * radius, radius, row, Rgb::ONE);
        }
        let found = compare(&format!("nested glass {tint}"), &scene, device);
        assert!(found.unknown_paths * 20 < found.paths, "{found:?}");
        // And around the camera, two of them.
        let eye = eye_of(&scene);
        scene.spheres.push(eye, 0.3, row, Rgb::ONE);
        scene.spheres.push(eye + 0.1, 0.4, row, Rgb::ONE);
        for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 2 }] {
            scene.settings.integrator = integrator;
            let case = format!("glass {tint} around the camera, {integrator:?}");
            let found = compare(&case, &scene, device);
            assert!(found.unknown_paths * 20 < found.paths, "{case} {found:?}");
        }
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn paths_of_many_bounces_are_the_processors() {
    let device = device();
    let mut scene = named("paper-field-20.toml");
    diffuse(&mut scene);
    let white = Material::Lambertian { color: Rgb::splat(0.98) };
    of_materials(&mut scene, &[white]);
    // Nothing leaves it.
    scene.spheres.push(eye_of(&scene), 40.0, 0, Rgb::ONE);
    add_lights(&mut scene);
    scene.settings.roulette = Roulette::None;
    scene.settings.depth = Some(45);
    scene.settings.spp = 2;
    let found = compare("many bounces", &scene, device);
    assert!(found.rays > 40 * found.paths && found.unknown_paths * 5 < found.paths, "{found:?}");
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn scenes_that_devices_follow_are_the_processors() {
    let device = device();
    let mut followed = Vec::new();
    for path in files() {
        let scene = load(&path);
        let world = World::build(&scene).unwrap();
        let why = not_followed(&world, &scene.settings);
        println!("{}: {why:?}", path.display());
        if why.is_none() {
            compare(&path.display().to_string(), &scene, device);
            followed.push(path.file_stem().unwrap().display().to_string());
        }
    }
    println!("{followed:?}");
    for name in ["veach", "weekend", "glass-nested", "paper-grid-500"] {
        assert!(followed.iter().any(|own| own == name), "{name} is not among {followed:?}");
    }
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn looks_of_particles_are_the_processors() {
    let device = device();
    // The processor renders translucent ones.
    let opaque = Preset::ALL.into_iter().filter(|preset| preset.material(1).opacity() == 1.0);
    for preset in opaque {
        let mut scene = named("paper-field-20.toml");
        diffuse(&mut scene);
        scene.look = preset.look();
        preset.replace_materials(&mut scene);
        preset.set(&mut scene);
        preset.light(&mut scene, DVec3::Y);
        let found = compare(preset.name(), &scene, device);
        assert!(found.paths > 1000 && found.unknown_paths * 50 < found.paths, "{found:?}");
    }
}

/// A change of a scene.
type Change = fn(&mut Scene);

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn settings_of_paths_are_heeded() {
    let device = device();
    let changes: [(&str, Change); 9] = [
        ("box", |scene| scene.settings.filter = Filter::Box),
        ("gaussian", |scene| scene.settings.filter = Filter::Gaussian),
        ("harris", |scene| scene.settings.filter = Filter::BlackmanHarris),
        ("depth", |scene| scene.settings.depth = Some(2)),
        ("none", |scene| scene.settings.roulette = Roulette::None),
        ("fixed", |scene| scene.settings.roulette = Roulette::Fixed(0.6)),
        ("lens", |scene| scene.camera.lens = Some(Lens { aperture: 0.5, focus: Some(9.0) })),
        ("near", |scene| scene.camera.near = 0.3),
        ("gradient", |scene| {
            let (bottom, top, up) = (Rgb::new(0.1, 0.2, 0.1), Rgb::new(0.5, 0.8, 1.0), DVec3::Z);
            scene.environment.map = EnvironmentMap::Gradient { bottom, top, up };
            scene.settings.seed = u64::MAX - 9;
        }),
    ];
    for (name, change) in changes {
        let mut scene = named("paper-field-20.toml");
        diffuse(&mut scene);
        change(&mut scene);
        compare(name, &scene, device);
    }
}

/// A picture of diffuse spheres for tests of renders that are divided.
fn divided_scene() -> Scene {
    let mut scene = named("paper-field-20.toml");
    diffuse(&mut scene);
    scene.settings.spp = 40;
    scene
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn renders_that_are_resumed_or_meet_an_error_are_the_processors() {
    let device = device();
    let mut scene = divided_scene();
    let mut world = World::build(&scene).unwrap();
    let whole = image(&world, &scene);
    scene.settings.until_error = Some(0.04);
    scene.settings.spp = 4000;
    let exact = image(&world, &scene);
    let statistics = Options { statistics: true, ..Options::default() };
    let mut measured = scene.clone();
    (measured.settings.until_error, measured.settings.spp) = (None, 40);
    let expected = render(&world, &measured.settings, &statistics).unwrap();
    let on_device = attach(&mut world, device);
    // It is stopped after its first batch, and goes on with other samples there.
    let stop = AtomicBool::new(false);
    let show = |_: Progress| stop.store(true, Ordering::Relaxed);
    let stopped = Options { progress: Some(&show), cancel: Some(&stop), ..Options::default() };
    let mut resumed = ResumableRender::begin(&world, &measured.settings, &stopped).unwrap();
    assert_eq!(resumed.run(&world, &stopped), End::Cancelled);
    let part = resumed.samples();
    assert!(part.most > 0 && part.least < 40, "{part:?}");
    assert_eq!(resumed.run(&world, &Options::default()), End::Samples);
    assert_eq!(resumed.render().image, whole.image);
    let found = image(&world, &scene);
    assert_eq!((found.image, found.samples), (exact.image, exact.samples));
    let found = render(&world, &measured.settings, &statistics).unwrap();
    assert_eq!((found.image, found.statistics), (expected.image, expected.statistics));
    assert!(on_device.tally().paths > 40_000, "{:?}", on_device.tally());
    assert_eq!(device.fault(), None);
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn parts_of_both_merge_to_the_whole() {
    let device = device();
    let scene = divided_scene();
    let mut world = World::build(&scene).unwrap();
    let whole = image(&world, &scene);
    let region = Region { x: 0, y: 0, width: 45, height: 34 };
    let part = |samples| ImagePart { samples, ..ImagePart::whole(region, 40) };
    let run = |world: &World, part: ImagePart| {
        let options = Options::default();
        let mut render =
            ResumableRender::begin_part(world, &scene.settings, &options, part).unwrap();
        render.run(world, &options);
        render
    };
    let first = run(&world, part(0..13));
    let on_device = attach(&mut world, device);
    let second = run(&world, part(13..40));
    // The first of three passes at least, without the tiles that see no sphere.
    let paths = on_device.tally().paths;
    assert!(paths > 45 * 34 * 3 / 2, "{paths}");
    let mut film = first.film().clone();
    assert!(film.merge(second.film().clone()));
    assert_eq!(film.resolve(), whole.image);
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn paths_are_finished_without_the_device_that_is_taken_away() {
    let device = own_device();
    let scene = divided_scene();
    let mut world = World::build(&scene).unwrap();
    let own = image(&world, &scene).image;
    let on_device = attach(&mut world, &device);
    let show = |_: Progress| device.destroy();
    let options = Options { progress: Some(&show), ..Options::default() };
    assert_eq!(render(&world, &scene.settings, &options).unwrap().image, own);
    assert!(matches!(device.fault(), Some(DeviceError::Lost(_))));
    // The first of three passes, without the tiles that see no sphere.
    let paths = on_device.tally().paths;
    assert!(paths > 45 * 34 * 16 / 2 && paths <= 45 * 34 * 16, "{paths}");
    assert_eq!(image(&world, &scene).image, own);
    assert_eq!(on_device.tally().paths, paths);
}

#[test]
fn what_devices_do_not_do_is_told() {
    let told = |change: &dyn Fn(&mut Scene)| {
        let mut scene = named("paper-field-20.toml");
        diffuse(&mut scene);
        change(&mut scene);
        let world = World::build(&scene).unwrap();
        not_followed(&world, &scene.settings)
    };
    assert_eq!(told(&|_| ()), None);
    let whitted = |scene: &mut Scene| {
        add_sun(scene, 5.0);
        scene.settings.integrator = Integrator::Whitted { shadow_samples: 1025 };
    };
    assert_eq!(told(&whitted).as_deref(), Some("each surface has many shadow samples"));
    let independent = |scene: &mut Scene| scene.settings.sampler = SamplerKind::Independent;
    assert_eq!(told(&independent).as_deref(), Some("devices have Sobol points only"));
    let suns = |scene: &mut Scene| {
        let light = {
            add_sun(scene, 5.0);
            scene.lights[0].clone()
        };
        scene.lights = vec![light; 5];
    };
    assert_eq!(told(&suns).as_deref(), Some("many suns are mirrored"));
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn random_scenes_are_the_processors() {
    let device = device();
    let mut all = Answered::default();
    // For more scenes.
    let count = std::env::var("SPHERULE_SCENES").map_or(150, |count| count.parse().unwrap());
    for seed in 0..count {
        // The file of a scene that fails stays.
        let file = scratch_folder().join(format!("random-{seed}.toml"));
        std::fs::write(&file, random_scene(seed)).unwrap();
        let mut scene = Scene::load(&file).unwrap();
        if seed % 8 == 0 {
            let image = Arc::new(sky_picture(11, 6, true));
            scene.environment.map =
                EnvironmentMap::Picture { image, up: DVec3::Y, rotation: 0.7, scale: 1.3 };
        }
        let world = World::build(&scene).unwrap();
        if not_followed(&world, &scene.settings).is_none() {
            all += compare(&file.display().to_string(), &scene, device);
        }
        std::fs::remove_file(&file).unwrap();
    }
    assert!(all.paths > 900 * count, "{all:?}");
    // In some the camera is inside of many spheres of glass.
    assert!(all.unknown_paths * 20 < all.paths, "{all:?}");
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn coincident_spheres_are_known() {
    let device = device();
    let mut scene = named("weekend.toml");
    let count = scene.spheres.len();
    for row in 0..count {
        let other = scene.spheres.material_of((row + 1) % count);
        let (center, radius) = (scene.spheres.center(row), scene.spheres.radius[row]);
        scene.spheres.push(center, radius, other, Rgb::ONE);
    }
    let found = compare("coincident spheres", &scene, device);
    assert!(found.unknown_paths * 100 < found.paths, "{found:?}");
}
