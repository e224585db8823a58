//! Settings and lights at their limits, and interrupted renders.

use crate::common::*;
use glam::DVec3;
use spherule_render::render::{Options, Progress};
use spherule_render::scene::{Integrator, Light, Rgb, Roulette, SamplerKind};
use std::f64::consts::PI;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

#[test]
fn pictures_of_any_shape() {
    for (width, height) in [(1, 1), (1, 17), (17, 1), (65_535, 1), (1, 65_535), (33, 16), (15, 40)]
    {
        let mut scene = furnace();
        sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
        look_parallel(&mut scene, DVec3::Z * 3.0, DVec3::ZERO, 3.0 / f64::from(width.max(height)));
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (width, height, 1);
        let image = render_scene(&scene).image;
        assert_eq!((image.width, image.height), (width, height));
        assert_eq!(image.pixels.len(), width as usize * height as usize);
        // Pixels are square, so the sphere has equal width and height.
        let seen = image.pixels.iter().filter(|pixel| **pixel == [0.5; 3]).count();
        assert!(seen > 0, "{width} x {height}");
    }
}

#[test]
fn a_wide_picture_is_a_high_one_turned() {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.0));
    let mut dark_pixels = |width, height| {
        look_parallel(&mut scene, DVec3::Z * 3.0, DVec3::ZERO, 4.0 * f64::from(height) / 64.0);
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (width, height, 16);
        over_seeds(&scene, |image| mean(image) * f64::from(width * height))
    };
    // Each covers the disc, of radius 16 pixels.
    let area = |width: u32, height: u32| f64::from(width * height) - PI * 256.0;
    assert_expected(dark_pixels(64, 40), area(64, 40), "wide");
    assert_expected(dark_pixels(40, 64), area(40, 64), "high");
}

#[test]
fn depth_from_zero_to_a_million() {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
    sphere(&mut scene, [2.0, 0.0, 0.0], 1.0, mirror());
    sphere(&mut scene, [0.0, 2.0, 0.0], 1.0, emitter(0.25, 0.5));
    look(&mut scene, DVec3::new(1.0, 1.0, 4.0), DVec3::new(0.7, 0.7, 0.0), 40.0);
    let mut picture = |depth| {
        scene.settings.depth = depth;
        render_scene(&scene).image
    };
    let nothing = picture(Some(0));
    assert!(nothing.pixels.iter().all(|pixel| pixel[0] <= 1.0) && nothing != picture(Some(1)));
    assert_eq!(picture(Some(1_000_000)), picture(None), "no path is that long");
}

#[test]
fn samples_of_any_number() {
    for sampler in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
        for spp in [1, 2, 3, 7, 16, 17, 61] {
            let mut scene = dark();
            scene.environment.map = gradient();
            sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
            (scene.settings.sampler, scene.settings.spp) = (sampler, spp);
            // Half of the sky is visible from the equator, and it is symmetric.
            let estimate = probe(&mut scene, DVec3::X, DVec3::X * 3.0);
            assert_expected(estimate, 0.5, &format!("{sampler:?} {spp}"));
        }
    }
}

/// More samples than in the first block of a Sobol sequence.
#[test]
fn a_hundred_thousand_samples() {
    let mut scene = dark();
    scene.environment.map = gradient();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(1.0));
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (2, 2, 100_000);
    assert_expected(probe(&mut scene, DVec3::X, DVec3::X * 3.0), 0.5, "1e5 samples");
}

#[test]
fn lights_of_any_size_from_any_distance() {
    // Radius, position, radiance: nearly a point, one at the horizon, one that fills the sky.
    let lights = [
        (1e-6, DVec3::new(0.0, 1.0, 2.0), 1e12),
        (1e-12, DVec3::new(0.0, 1.0, 2.0), 1e24),
        (0.5, DVec3::new(0.0, 1e4, 1.0), 1e8),
        (1e3, DVec3::new(0.0, 0.0, 1e3 + 1.0), 1.0),
    ];
    for (radius, center, radiance) in lights {
        let mut scene = dark();
        ground(&mut scene, lambertian(1.0));
        sphere(&mut scene, center, radius, emitter(radiance, 0.0));
        scene.settings.depth = Some(1);
        // Form factor: (r / d)^2 times the cosine, if the emitter is above the horizon.
        let distance = center.length();
        let truth = (radius / distance).powi(2) * center.z / distance * f64::from(radiance);
        for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 4 }] {
            scene.settings.integrator = integrator;
            let eye = DVec3::new(1.0, -1.0, 0.02);
            assert_expected(
                probe(&mut scene, DVec3::ZERO, eye),
                truth,
                &format!("{radius} {center}"),
            );
        }
    }
}

/// The radiance of this small disc overflows single precision, its irradiance does not.
#[test]
fn suns_of_any_size() {
    for angular_radius in [0.0, 1e-300, 1e-30, 1e-18, 1e-7, 1e-5, 1e-3] {
        let mut scene = dark();
        ground(&mut scene, lambertian(1.0));
        let (direction, irradiance) = (DVec3::Z, Rgb::splat(1e5));
        scene.lights = vec![Light::Sun { direction, irradiance, angular_radius }];
        for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 4 }] {
            scene.settings.integrator = integrator;
            let estimate = probe(&mut scene, DVec3::ZERO, DVec3::new(1.0, -1.0, 2.0));
            assert_expected(estimate, 1e5 / PI, &format!("{angular_radius}"));
        }
    }
}

/// An emitter around the scene: its inside gives uniform light, and is not sampled as a light.
#[test]
fn a_light_that_covers_everything() {
    for roulette in [Roulette::None, Roulette::Throughput] {
        let mut scene = dark();
        sphere(&mut scene, [0.0; 3], 100.0, emitter(2.0, 0.0));
        sphere(&mut scene, [1.0, 0.0, 0.0], 1.0, lambertian(0.5));
        look(&mut scene, DVec3::Z * 5.0, DVec3::X, 10.0);
        scene.settings.roulette = roulette;
        assert_every_pixel(&render_scene(&scene).image, 1.0, "inside a light");
    }
}

#[test]
fn scenes_without_lights_are_black() {
    for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 4 }] {
        let mut scene = dark();
        sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
        scene.settings.integrator = integrator;
        let render = render_scene(&scene);
        assert_every_pixel(&render.image, 0.0, "no lights");
        assert_eq!(render.counters.shadow_rays, 0);
        // Lights without radiance are dropped.
        scene.lights.push(Light::Point {
            position: DVec3::Y * 3.0,
            intensity: Rgb::ZERO,
            falloff: true,
        });
        sphere(&mut scene, [3.0, 0.0, 0.0], 1.0, emitter(0.0, 0.0));
        assert_every_pixel(&render_scene(&scene).image, 0.0, "dark lights");
    }
}

/// A light on a surface, and one inside: images are finite.
#[test]
fn lights_on_surfaces() {
    for position in [DVec3::Z, DVec3::ZERO, DVec3::Z * (1.0 + 1e-9)] {
        for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 4 }] {
            let mut scene = dark();
            sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.5));
            scene.lights.push(Light::Point { position, intensity: Rgb::ONE, falloff: true });
            look_parallel(&mut scene, DVec3::Z * 3.0, DVec3::ZERO, 0.1);
            scene.settings.integrator = integrator;
            assert_eq!(render_scene(&scene).image.count_non_finite(), 0);
        }
    }
}

/// Roughness from a mirror's to values whose squares underflow in single precision.
#[test]
fn metal_of_any_roughness() {
    for roughness in [1.0, 1e-2, 1e-4, 1e-10, 1e-20, 1e-24, 1e-30, 1e-44, 1e-60, 0.0] {
        let mut scene = furnace();
        sphere(&mut scene, [0.0; 3], 1.0, metal(roughness));
        sphere(&mut scene, [3.0, 0.0, 0.0], 1.0, emitter(1.0, 0.0));
        look(&mut scene, DVec3::Z * 3.0, DVec3::ZERO, 20.0);
        let estimate = measure(&scene);
        // Masked light is lost, which is negligible for nearly flat facets.
        let truth = if roughness < 1e-3 { 1.0 } else { estimate.mean.min(1.0) };
        assert_expected(estimate, truth, &format!("{roughness}"));
    }
}

#[test]
fn a_cancelled_render_keeps_its_samples() {
    let scene = {
        let mut scene = furnace();
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (64, 64, 64);
        scene
    };
    let cancel = AtomicBool::new(true);
    let stopped =
        render_scene_with(&scene, &Options { cancel: Some(&cancel), ..Options::default() });
    assert!(!stopped.complete);
    assert_every_pixel(&stopped.image, 0.0, "nothing was done");

    let cancel = AtomicBool::new(false);
    let progress = |progress: Progress| cancel.store(progress.done > 0.3, Ordering::Relaxed);
    let options =
        Options { cancel: Some(&cancel), progress: Some(&progress), ..Options::default() };
    let stopped = render_scene_with(&scene, &options);
    assert!(!stopped.complete);
    // A third of the samples is one pass over all tiles, so every pixel has samples, all of them 1.
    assert_every_pixel(&stopped.image, 1.0, "some samples");
    assert!(stopped.counters.camera_rays < 64 * 64 * 64);
}

#[test]
fn progress_ends_at_one() {
    let mut scene = furnace();
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (40, 20, 33);
    let last = Mutex::new((0.0, 0));
    let progress = |progress: Progress| {
        let mut last = last.lock().expect("no thread fails");
        if progress.done > last.0 {
            *last = (progress.done, progress.rays);
        }
    };
    let render =
        render_scene_with(&scene, &Options { progress: Some(&progress), ..Options::default() });
    let (done, rays) = *last.lock().expect("no thread fails");
    assert!(render.complete && done == 1.0 && rays == render.counters.rays());
}
