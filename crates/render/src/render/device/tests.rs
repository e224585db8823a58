//! Devices that know no path: whoever takes which tiles, images are the processor's.

use crate::render::{End, Options, ResumableRender, render};
use crate::scene::Scene;
use crate::world::{
    DeviceIntegrator, DeviceJob, DevicePath, DevicePaths, DevicePixel, DevicePixels, World,
};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// A device that does not know the paths that it is asked for.
#[derive(Clone, Debug, Default)]
struct Ignorant {
    /// The time that it takes for a batch.
    takes: Duration,
    /// Batches after which it fails.
    fails_after: Option<u64>,
    batches: Arc<AtomicU64>,
    paths: Arc<AtomicU64>,
}

impl DeviceIntegrator for Ignorant {
    fn begin(&self, _: &DeviceJob) -> Option<Box<dyn DevicePaths>> {
        Some(Box::new(self.clone()))
    }
}

impl DevicePaths for Ignorant {
    fn follow(&self, pixels: &[(u32, u32)], samples: Range<u32>, found: &mut DevicePixels) -> bool {
        let before = self.batches.fetch_add(1, Ordering::Relaxed);
        if self.fails_after.is_some_and(|batches| before >= batches) {
            return false;
        }
        std::thread::sleep(self.takes);
        let paths = pixels.len() * samples.len();
        self.paths.fetch_add(paths as u64, Ordering::Relaxed);
        let pixel = |place| {
            let mut words = [0_u32; size_of::<DevicePixel>() / 4];
            words[18] = place;
            bytemuck::cast(words)
        };
        found.pixels = (0..pixels.len() as u32).map(pixel).collect();
        found.samples = vec![DevicePath::UNKNOWN; paths];
        true
    }
}

const WIDTH: u32 = 203;
const HEIGHT: u32 = 150;
const SAMPLES: u32 = 40;

fn scene() -> Scene {
    let text = format!(
        r#"
        [render]
        size = [{WIDTH}, {HEIGHT}]
        spp = {SAMPLES}
        depth = 3
        [material.chalk]
        kind = "lambertian"
        color = 0.7
        [material.lamp]
        kind = "emitter"
        radiance = 50
        [[sphere]]
        center = [0, 0, 0]
        radius = 1
        material = "chalk"
        [[sphere]]
        center = [2, 3, 1]
        radius = 0.1
        material = "lamp"
        [camera]
        eye = [0, 1, 6]
        target = [0, 1, 0]
        "#
    );
    Scene::parse(&text, "scene", Path::new(".")).unwrap()
}

/// Returns the scene, its world, and the world with a device.
fn worlds(device: &Ignorant) -> (Scene, World, World) {
    let scene = scene();
    let (own, mut other) = (World::build(&scene).unwrap(), World::build(&scene).unwrap());
    other.device_paths = Some(Arc::new(device.clone()));
    (scene, own, other)
}

/// Compares images; returns the share of paths that the device was asked for.
fn compare(device: &Ignorant, options: &Options) -> f64 {
    let (scene, own, other) = worlds(device);
    let [own, other] = [own, other].map(|world| render(&world, &scene.settings, options).unwrap());
    assert_eq!(own.image, other.image);
    assert_eq!(own.statistics, other.statistics);
    assert_eq!(own.samples, other.samples);
    assert_eq!(own.counters.camera_rays, other.counters.camera_rays);
    assert_eq!(own.counters.shadow_rays, other.counters.shadow_rays);
    let paths = device.paths.load(Ordering::Relaxed);
    paths as f64 / f64::from(WIDTH * HEIGHT * SAMPLES)
}

#[test]
fn a_device_and_the_processor_sample_together() {
    let device = Ignorant::default();
    let share = compare(&device, &Options::default());
    // Tiles that see no sphere are the processor's alone.
    assert!(share > 0.1 && share < 1.0, "{share}");
    assert!(device.batches.load(Ordering::Relaxed) > 2);
    let statistics = Options { statistics: true, ..Options::default() };
    assert!(compare(&device, &statistics) > share);
}

#[test]
fn a_slow_device_leaves_the_rest_to_the_processor() {
    let device = Ignorant { takes: Duration::from_secs(1), ..Ignorant::default() };
    let share = compare(&device, &Options::default());
    assert!(share > 0.0 && share < 0.5, "{share}");
}

#[test]
fn a_device_that_fails_gives_its_tiles_back() {
    for batches in [0, 1, 3] {
        let device = Ignorant { fails_after: Some(batches), ..Ignorant::default() };
        compare(&device, &Options::default());
        assert!(device.batches.load(Ordering::Relaxed) <= batches + 2);
    }
}

#[test]
fn renders_with_a_device_are_cancelled_and_resumed() {
    let device = Ignorant::default();
    let (scene, own, other) = worlds(&device);
    let own = render(&own, &scene.settings, &Options::default()).unwrap();
    let cancel = AtomicBool::new(false);
    let stop = |_| cancel.store(true, Ordering::Relaxed);
    let options = Options { progress: Some(&stop), cancel: Some(&cancel), ..Options::default() };
    let mut resumed = ResumableRender::begin(&other, &scene.settings, &options).unwrap();
    let mut runs = 0;
    while resumed.run(&other, &options) == End::Cancelled {
        cancel.store(false, Ordering::Relaxed);
        runs += 1;
    }
    assert!(runs > 1, "{runs}");
    assert_eq!(resumed.render().image, own.image);
}

#[test]
#[should_panic(expected = "a scoped thread panicked")]
fn a_panic_of_a_device_ends_the_render() {
    #[derive(Debug)]
    struct Broken;
    impl DeviceIntegrator for Broken {
        fn begin(&self, _: &DeviceJob) -> Option<Box<dyn DevicePaths>> {
            Some(Box::new(Self))
        }
    }
    impl DevicePaths for Broken {
        fn follow(&self, _: &[(u32, u32)], _: Range<u32>, _: &mut DevicePixels) -> bool {
            panic!("a broken driver")
        }
    }
    let scene = scene();
    let mut world = World::build(&scene).unwrap();
    world.device_paths = Some(Arc::new(Broken));
    let _ = render(&world, &scene.settings, &Options::default());
}
