//! Devices that are taken away: the processor answers, and the device says what happened.

#![allow(clippy::unwrap_used, reason = "tests fail so")]

use crate::common::own_device;
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::bvh::{Tracer, Tree};
use spherule_core::internals::ray::{Hits, MISS, Rays};
use spherule_core::{Hits as Columns, NOTHING, RayColumns, SphereTree};
use spherule_gpu::{DeviceError, DeviceSpheres, DeviceTree};
use spherule_measure::workload::{Class, SphereScene, Views};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Waits until a condition is true, but no longer than a limit; returns whether it is.
fn wait_for(holds: impl Fn() -> bool) -> bool {
    let start = Instant::now();
    while !holds() && start.elapsed() < Duration::from_secs(120) {
        std::thread::yield_now();
    }
    holds()
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn a_device_that_is_taken_away_in_the_middle_loses_no_hit() {
    let device = own_device();
    let scene = SphereScene::PAPER2500;
    let mut spheres = scene.spheres().unwrap();
    let bvh = build(&mut spheres, Builder::default());
    let tree = Tree { bvh: &bvh, spheres: &spheres };
    let views = Views::new(scene, tree, 64);
    let rays: &Rays = views.rays(Class::Camera);
    let mut expected = Hits::with_capacity(rays.len());
    Tracer::default().closest(tree, rays, &mut expected);
    assert!(expected.sphere.iter().any(|&sphere| sphere != MISS));
    let on_device = DeviceTree::new(&device, tree).unwrap();
    let asked = AtomicUsize::new(0);
    let unknown: Vec<u64> = std::thread::scope(|scope| {
        scope.spawn(|| {
            wait_for(|| asked.load(Ordering::Relaxed) >= 3);
            device.destroy();
        });
        let ask = |_| {
            let mut hits = Hits::with_capacity(rays.len());
            let answered = on_device.closest(tree, rays, &mut hits);
            asked.fetch_add(1, Ordering::Relaxed);
            assert_eq!(hits.sphere, expected.sphere);
            assert_eq!(hits.t, expected.t);
            answered.unknown
        };
        let mut unknown: Vec<u64> = (0..10).map(ask).collect();
        assert!(wait_for(|| device.fault().is_some()), "the loss is not noticed");
        unknown.push(ask(10));
        unknown
    });
    let all = rays.len() as u64;
    assert!(unknown[..3].iter().all(|&unknown| unknown < all / 20), "{unknown:?}");
    assert_eq!(unknown.last(), Some(&all));
    let fault = device.fault();
    assert!(matches!(fault, Some(DeviceError::Lost(_))), "{fault:?}");
    assert!(fault.unwrap().to_string().starts_with("the GPU was lost: "));
    // Nothing else is tried on it.
    assert!(matches!(DeviceTree::new(&device, tree).err(), Some(DeviceError::Lost(_))));
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn columns_of_rays_are_answered_without_the_device() {
    let device = own_device();
    let tree = SphereTree::from_columns(&[0.0, 3.0], &[0.0; 2], &[0.0; 2], &[1.0, 0.5]).unwrap();
    let on_device = DeviceSpheres::new(&device, &tree).unwrap();
    device.destroy();
    let rays = RayColumns {
        origin: [&[-5.0, 9.0, 0.0], &[0.0; 3], &[0.0, 0.0, 9.0]],
        direction: [&[2.0, -1.0, 1.0], &[0.0; 3], &[0.0; 3]],
    };
    let (mut t, mut sphere) = ([f64::INFINITY; 3], [7; 3]);
    let hits = Columns { t: &mut t, sphere: &mut sphere, surface: None };
    let answered = on_device.intersect_columns(&rays, hits).unwrap();
    assert_eq!((t, sphere), ([2.0, 5.5, f64::INFINITY], [0, 1, NOTHING]));
    assert_eq!((answered.rays, answered.unknown), (3, 3));
    let mut occluded = [false; 3];
    on_device.occluded_columns(&rays, &[f64::INFINITY; 3], &mut occluded).unwrap();
    assert_eq!(occluded, [true, true, false]);
    assert!(device.fault().is_some());
}
