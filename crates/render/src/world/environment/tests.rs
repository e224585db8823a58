//! Tests of samples of an environment map against their density.

use super::*;
use crate::image::Image;
use crate::sampling::Basis;
use crate::sampling::statistics::{Grid, random_pairs};

const WIDTH: usize = 12;
const HEIGHT: usize = 8;

/// Black on one half; on the other, one pixel is brighter than all others together.
fn picture(brightest: f32) -> Picture {
    let value = |column, row| match (column, row) {
        (0..6, _) => 0.0,
        (8, 2) => brightest,
        _ => 1.0 + 0.1 * row as f32,
    };
    let pixels = (0..WIDTH * HEIGHT).map(|i| [value(i % WIDTH, i / WIDTH); 3]).collect();
    let image = Image::new(WIDTH as u32, HEIGHT as u32, pixels).unwrap();
    Picture::new(Arc::new(image), DVec3::new(0.6, 0.0, 0.8), 0.5, 2.0)
}

/// A grid whose cells each lie in one pixel.
fn grid(picture: &Picture) -> Grid {
    let [tangent, bitangent, normal] =
        [picture.to_world.x_axis, picture.to_world.y_axis, picture.to_world.z_axis];
    let basis = Basis { tangent, bitangent, normal };
    Grid {
        basis,
        rings: 3 * HEIGHT,
        sectors: 2 * WIDTH,
        ..Grid::cone(normal, std::f64::consts::PI)
    }
}

#[test]
fn directions_follow_the_density() {
    for brightest in [0.0, 1.0, 1e2, 1e5] {
        let picture = picture(brightest);
        let sampled = random_pairs(1_000_000, 3).map(|u| picture.sample(u));
        let directions = sampled.map(|sample| sample.map(|sample| sample.direction));
        grid(&picture).check(directions, |toward| picture.pdf(toward), Some(0.0));
    }
}

#[test]
fn samples_come_with_their_density_and_radiance() {
    let picture = picture(1e5);
    let mut apart = 0;
    for sample in random_pairs(100_000, 4).filter_map(|u| picture.sample(u)) {
        assert!(sample.pdf > 0.0 && sample.radiance == picture.radiance(sample.direction));
        // Except if rounding moves the direction to the next pixel.
        let pdf = picture.pdf(sample.direction);
        apart += i32::from((pdf - sample.pdf).abs() > 1e-3 * sample.pdf);
    }
    assert!(apart < 20, "{apart}");
}

#[test]
fn the_density_is_in_proportion_to_the_light() {
    // If both neighbors are equal, the mean of a pixel is its own value.
    let picture = picture(1.0);
    let pdf = |row: usize| {
        let polar = PI * (row as f32 + 0.5) / HEIGHT as f32;
        let azimuth = TAU * 10.5 / WIDTH as f32;
        let local =
            Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
        picture.pdf(picture.to_world * local)
    };
    for row in 1..HEIGHT - 1 {
        let light = (1.0 + 0.1 * row as f32) / 1.1;
        assert!((pdf(row) / pdf(1) / light - 1.0).abs() < 1e-3, "{row}");
    }
}

#[test]
fn there_is_a_density_wherever_there_is_light() {
    let picture = picture(1e5);
    let directions = random_pairs(200_000, 5).map(crate::sampling::uniform_sphere);
    let lit: Vec<Vec3> = directions.filter(|&d| picture.radiance(d) != Rgb::ZERO).collect();
    assert!((90_000..130_000).contains(&lit.len()), "{}", lit.len());
    assert!(lit.iter().all(|&direction| picture.pdf(direction) > 0.0));
}

#[test]
fn the_mean_luminance_of_one_color_is_that_color() {
    let image = Image::filled(WIDTH as u32, HEIGHT as u32, [2.0; 3]).unwrap();
    let picture = Picture::new(Arc::new(image), DVec3::Z, 0.0, 0.5);
    assert!((picture.mean_luminance() - 1.0).abs() < 1e-6, "{}", picture.mean_luminance());
}
