//! Pictures whose rays a device traces: the bytes of the processor's pictures, also where the device is taken away.

#![allow(clippy::unwrap_used, reason = "tests fail so")]

mod common;

use common::device;
use spherule_gpu::{Device, DeviceError, DeviceTree};
use spherule_render::World;
use spherule_render::bvh::Tree;
use spherule_render::render::{Options, Progress, render};
use spherule_render::scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// Reads a scene, for a small picture of few samples.
fn load(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut scene = Scene::load(&folder.join(name)).unwrap();
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp, settings.until_error) = (48, 36, 2, None);
    scene
}

/// Renders a world, on the device if it has one; `show` is called in the middle.
fn pixels(world: &World, scene: &Scene, show: &(dyn Fn(Progress) + Sync)) -> Vec<[u32; 3]> {
    let options = Options { progress: Some(show), ..Options::default() };
    let rendered = render(world, &scene.settings, &options).unwrap();
    rendered.image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Gives a world's rays to a device.
fn attach(world: &mut World, device: &Arc<Device>) -> Arc<DeviceTree> {
    let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
    let on_device = Arc::new(DeviceTree::new(device, tree).unwrap());
    world.device = Some(on_device.clone());
    on_device
}

#[test]
fn pictures_of_all_scenes_are_the_processors() {
    let Some(device) = device() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut seen = 0;
    for entry in folder.read_dir().unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if Path::new(&name).extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let scene = load(&name);
        let mut world = World::build(&scene).unwrap();
        let own = pixels(&world, &scene, &|_| ());
        let on_device = attach(&mut world, &device);
        assert_eq!(pixels(&world, &scene, &|_| ()), own, "{name}");
        let tally = on_device.tally();
        assert!(tally.rays > 1000, "{name}: {tally:?}");
        assert!(tally.unknown * 2 < tally.rays, "{name}: {tally:?}");
        seen += 1;
    }
    assert!(seen >= 12, "{seen}");
    assert_eq!(device.fault(), None);
}

#[test]
fn a_picture_is_finished_without_the_device_that_is_taken_away() {
    let Some(device) = device() else { return };
    let scene = load("paper-field-20.toml");
    let mut world = World::build(&scene).unwrap();
    let own = pixels(&world, &scene, &|_| ());
    let on_device = attach(&mut world, &device);
    assert_eq!(pixels(&world, &scene, &|_| device.destroy()), own);
    let lost = on_device.tally();
    assert!(matches!(device.fault(), Some(DeviceError::Lost(_))));
    assert!(lost.unknown > lost.rays / 10 && lost.unknown < lost.rays, "{lost:?}");
    // All of the next is the processor's.
    assert_eq!(pixels(&world, &scene, &|_| ()), own);
    let after = on_device.tally();
    assert_eq!(after.rays - lost.rays, after.unknown - lost.unknown);
}
