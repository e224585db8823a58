//! Environment maps: irradiance of a plane by both integrators, compared with a sum over directions.

use crate::common::*;
use glam::DVec3;
use spherule_render::image::Image;
use spherule_render::scene::{Environment, EnvironmentMap, Integrator, Scene};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const WIDTH: usize = 16;
const HEIGHT: usize = 8;

/// Returns a smooth sky with one bright pixel, or only that pixel.
fn value(column: usize, row: usize, smooth: bool) -> f32 {
    let background = if smooth { 0.2 + 0.1 * row as f32 + 0.02 * column as f32 } else { 0.0 };
    if (column, row) == (5, 2) { 300.0 } else { background }
}

fn picture(smooth: bool, rotation: f64) -> EnvironmentMap {
    let pixels = (0..WIDTH * HEIGHT).map(|i| [value(i % WIDTH, i / WIDTH, smooth); 3]).collect();
    let image = Image::new(WIDTH as u32, HEIGHT as u32, pixels).expect("the picture is sound");
    EnvironmentMap::Picture { image: Arc::new(image), up: DVec3::Z, rotation, scale: 2.0 }
}

/// Returns the irradiance divided by pi of a plane that faces the map's top, with bilinear interpolation
/// between pixel centers, by the midpoint rule over latitude and longitude.
fn truth(smooth: bool) -> f64 {
    let (steps_v, steps_u) = (1600, 3200);
    let mut sum = 0.0;
    for j in 0..steps_v {
        let v = (f64::from(j) + 0.5) / f64::from(steps_v) / 2.0;
        let (sin, cos) = (PI * v).sin_cos();
        let y = (v * HEIGHT as f64 - 0.5).max(0.0);
        let mut row_sum = 0.0;
        for i in 0..steps_u {
            let x = (f64::from(i) + 0.5) / f64::from(steps_u) * WIDTH as f64 - 0.5;
            let column = |dx: i64| (x.floor() as i64 + dx).rem_euclid(WIDTH as i64) as usize;
            let pixel = |dx: i64, dy: usize| f64::from(value(column(dx), y as usize + dy, smooth));
            let (fx, fy) = (x - x.floor(), y - y.floor());
            let across = |dy: usize| pixel(0, dy) * (1.0 - fx) + pixel(1, dy) * fx;
            row_sum += across(0) * (1.0 - fy) + across(1) * fy;
        }
        sum += row_sum * sin * cos;
    }
    2.0 * sum * (PI / 2.0) / f64::from(steps_v) * TAU / f64::from(steps_u) / PI
}

fn plane_under(map: EnvironmentMap) -> Scene {
    let mut scene = dark();
    ground(&mut scene, lambertian(1.0));
    scene.environment = Environment { map, illuminates: true };
    scene.settings.spp = 256;
    scene
}

#[test]
fn a_plane_is_lit_by_the_environment_map() {
    for smooth in [true, false] {
        let truth = truth(smooth);
        for rotation in [0.0, 77.0] {
            let mut scene = plane_under(picture(smooth, rotation));
            for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 4 }] {
                scene.settings.integrator = integrator;
                let estimate = probe(&mut scene, DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0));
                assert_expected(estimate, truth, &format!("smooth {smooth}, {integrator:?}"));
            }
        }
    }
}

/// A backdrop is visible to the camera and in mirrors, and lights nothing.
#[test]
fn a_backdrop_does_not_light() {
    for integrator in [Integrator::Path, Integrator::Whitted { shadow_samples: 4 }] {
        for map in [picture(true, 0.0), gradient()] {
            let mut scene = plane_under(map);
            scene.environment.illuminates = false;
            scene.settings.integrator = integrator;
            let estimate = probe(&mut scene, DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0));
            assert_every_pixel(&render_scene(&scene).image, 0.0, &format!("{estimate:?}"));
        }
    }
}
