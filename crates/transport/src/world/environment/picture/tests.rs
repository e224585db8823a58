//! Tests of samples of a picture against its light: positions, densities, means and variances.

use super::*;
use crate::lanes::{F32x16, first_lanes};
use crate::sampling::statistics::{Grid, random_pairs};
use std::f64::consts::TAU;

const WIDTH: usize = 12;
const HEIGHT: usize = 8;

/// Returns a picture in axes that are not the world's.
fn picture_of(width: usize, height: usize, value: impl Fn(usize, usize) -> [f32; 3]) -> Picture {
    let pixels = (0..width * height).map(|i| value(i % width, i / width)).collect();
    let image = Image::new(width as u32, height as u32, pixels).unwrap();
    Picture::new(Arc::new(image), DVec3::new(0.6, 0.0, 0.8), 0.5, 2.0)
}

/// Black on one half; on the other, one pixel may be brighter than all others together.
fn picture(brightest: f32) -> Picture {
    picture_of(WIDTH, HEIGHT, |column, row| match (column, row) {
        (0..6, _) => [0.0; 3],
        (8, 2) => [brightest; 3],
        _ => [1.0, 0.7, 0.9].map(|value| value + 0.1 * row as f32),
    })
}

/// Pictures of all shapes, with bright pixels next to black ones, at the poles, and where longitude
/// wraps around.
fn pictures() -> Vec<Picture> {
    let single = |column, row| {
        picture_of(WIDTH, HEIGHT, move |x, y| [f32::from(u8::from((x, y) == (column, row))); 3])
    };
    vec![
        picture(0.0),
        picture(1.0),
        picture(1e5),
        single(5, 3),
        single(0, 4),
        single(WIDTH - 1, 0),
        single(3, HEIGHT - 1),
        sunny(),
        picture_of(64, 32, |column, row| [f32::from(u8::from((column, row) == (0, 9))); 3]),
        picture_of(1, 1, |_, _| [0.3, 0.2, 0.1]),
        picture_of(7, 1, |column, _| [column as f32; 3]),
        picture_of(1, 5, |_, row| [(row % 3) as f32; 3]),
        picture_of(2, 2, |column, row| [(column + row) as f32; 3]),
    ]
}

/// A sky with a small sun that has most of the light.
fn sunny() -> Picture {
    let sun = |column, row| f32::from(u8::from((column, row) == (20, 10)));
    picture_of(64, 32, |column, row| [0.1 + row as f32 / 64.0 + 1e4 * sun(column, row); 3])
}

/// Samples a part of the picture once.
fn sample(picture: &Picture, part: usize, u: [f32; 2]) -> Option<SkySamples<f32>> {
    Some(picture.sample(part, u, 1)).filter(|sample| sample.lanes == 1)
}

/// Returns the density with which samples of a part find a direction.
fn pdf(picture: &Picture, part: usize, toward: Vec3) -> f32 {
    let light = picture.light::<f32>(toward.into(), 1);
    if light.part[0] as usize == part { light.pdf } else { 0.0 }
}

/// Luminance at longitude and latitude in 0..=1, in double precision, by the definition.
fn bilinear(picture: &Picture, [u, v]: [f64; 2]) -> f64 {
    let (width, height) = (picture.image.width as usize, picture.image.height as usize);
    let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
    let (right, below) = (x - x.floor(), y - y.floor());
    let pixel = |dx: i64, dy: i64| {
        let column = (x.floor() as i64 + dx).rem_euclid(width as i64) as usize;
        let row = (y.floor() as i64 + dy).clamp(0, height as i64 - 1) as usize;
        let pixel = picture.image.pixels[row * width + column].map(f64::from);
        let channels = pixel.iter().zip(LUMINANCE).map(|(value, weight)| value * f64::from(weight));
        channels.sum::<f64>() * f64::from(picture.scale)
    };
    let across = |dy| pixel(0, dy) * (1.0 - right) + pixel(1, dy) * right;
    across(0) * (1.0 - below) + across(1) * below
}

/// A grid in the picture's axes, with lines through the pixel centers.
fn grid(picture: &Picture) -> Grid {
    let (width, height) = (picture.image.width as usize, picture.image.height as usize);
    let grid = Grid::cone(picture.axes.normal, PI);
    Grid { basis: picture.axes, rings: 2 * height, sectors: 2 * width, steps: 16, ..grid }
}

#[test]
fn directions_follow_the_density() {
    for (seed, picture) in pictures().iter().enumerate() {
        for part in 0..picture.parts.len() {
            let sampled = random_pairs(200_000, seed as u64).map(|u| sample(picture, part, u));
            let directions = sampled.map(|sample| sample.map(|sample| sample.direction.into()));
            // Rounding may move directions to the other part.
            let inside = directions.filter(|direction: &Option<Vec3>| {
                direction.is_none_or(|toward| pdf(picture, part, toward) > 0.0)
            });
            grid(picture).check(inside, |toward| pdf(picture, part, toward), Some(0.0));
        }
    }
}

#[test]
fn samples_come_with_their_density_and_radiance() {
    for picture in pictures() {
        for part in 0..picture.parts.len() {
            let mut apart = 0;
            for sample in random_pairs(20_000, 4).filter_map(|u| sample(&picture, part, u)) {
                assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
                let SkyLight { radiance, pdf, part: found } = picture.light(sample.direction, 1);
                assert_eq!(Rgb::from(radiance), picture.radiance(sample.direction.into()));
                let (there, given) = (Rgb::from(radiance), Rgb::from(sample.radiance));
                // Except next to black, where rounding of the direction is much in proportion, and at
                // the edges of parts.
                apart +=
                    i32::from((there - given).abs().max_element() > 1e-3 * given.max_element());
                apart += i32::from(
                    found[0] as usize != part || (pdf - sample.pdf).abs() > 1e-3 * sample.pdf,
                );
            }
            assert!(apart < 20, "{part}: {apart}");
        }
    }
}

#[test]
fn radiance_is_bilinear() {
    for picture in pictures() {
        let brightest = picture.image.pixels.iter().flatten().fold(0.0, |a: f32, &b| a.max(b));
        for u in random_pairs(20_000, 8) {
            let direction = crate::sampling::uniform_sphere(u);
            let local = picture.axes.to_local(direction).as_dvec3();
            let longitude = (local.y.atan2(local.x) / TAU).rem_euclid(1.0);
            let latitude = local.x.hypot(local.y).atan2(local.z) / PI;
            let truth = bilinear(&picture, [longitude, latitude]);
            let found = f64::from(luminance(picture.radiance(direction)));
            let error = (found - truth).abs();
            assert!(error < 1e-5 * f64::from(brightest), "{direction}: {found} {truth}");
        }
    }
}

#[test]
fn radiance_over_density_is_nearly_constant() {
    let picture = sunny();
    assert_eq!(picture.parts.len(), 2);
    for part in 0..2 {
        let (mut least, mut greatest) = (f32::INFINITY, 0.0_f32);
        for sample in random_pairs(100_000, 2).filter_map(|u| sample(&picture, part, u)) {
            let ratio = luminance(sample.radiance.into()) / sample.pdf;
            (least, greatest) = (least.min(ratio), greatest.max(ratio));
        }
        // The sine, from a row above the sun to one below it, differs by 13 %.
        assert!(greatest / least < 1.14, "{part}: {least} {greatest}");
    }
}

#[test]
fn the_sun_is_a_part_of_its_own() {
    let picture = sunny();
    let [rest, sun] = [0, 1].map(|part| picture.parts[part].bounds);
    assert!(sun.light > 0.9 * (rest.light + sun.light) && rest.disc.is_none());
    let (center, radius) = sun.disc.expect("it is a disc");
    assert!((0.1..0.2).contains(&radius), "{radius}");
    for sample in random_pairs(10_000, 7).filter_map(|u| sample(&picture, 1, u)) {
        let direction = Vec3::from(sample.direction).as_dvec3();
        assert!(direction.distance(center) < radius * (1.0 + 1e-6));
    }
    // Alone in a black sky, it is all.
    let alone = &pictures()[8];
    assert!(alone.parts.len() == 1 && alone.parts[0].bounds.disc.is_some());
}

#[test]
fn there_is_a_density_wherever_there_is_light() {
    for picture in pictures() {
        let directions = random_pairs(50_000, 5).map(crate::sampling::uniform_sphere);
        let mut lit = directions.filter(|&d| picture.radiance(d) != Rgb::ZERO);
        assert!(lit.all(|direction| picture.light::<f32>(direction.into(), 1).pdf > 0.0));
    }
}

#[test]
fn the_density_is_finite_at_the_poles() {
    for picture in pictures() {
        let pole = picture.axes.normal;
        let nearby = [1e-30, 1e-12, 1e-6].map(|x| pole + picture.axes.tangent * x);
        for direction in nearby.into_iter().flat_map(|direction| [direction, -direction]) {
            let light = picture.light::<f32>(direction.normalize().into(), 1);
            let SkyLight { radiance, pdf, .. } = light;
            assert!(pdf.is_finite() && pdf >= 0.0 && Rgb::from(radiance).is_finite());
            assert_eq!(pdf > 0.0, Rgb::from(radiance) != Rgb::ZERO, "{direction}");
        }
    }
    // In a picture of one color, the density is the same at poles as everywhere.
    let white = picture_of(64, 32, |_, _| [1.0; 3]);
    let uniform = 1.0 / (4.0 * PI as f32);
    for pole in [white.axes.normal, -white.axes.normal] {
        let found = pdf(&white, 0, pole);
        assert!((found / uniform - 1.0).abs() < 2e-3, "{found}");
    }
}

#[test]
fn a_single_bright_pixel_lights_its_neighborhood_alone() {
    let picture = &pictures()[8];
    for sample in random_pairs(10_000, 5).map(|u| sample(picture, 0, u).expect("there is light")) {
        let local = picture.axes.to_local(sample.direction.into());
        let column = (local.y.atan2(local.x) / TAU as f32).rem_euclid(1.0) * 64.0;
        let row = local.z.acos() / PI as f32 * 32.0;
        let aside = (column - 0.5 + 32.0).rem_euclid(64.0) - 32.0;
        assert!(aside.abs() < 1.001 && (row - 9.5).abs() < 1.001, "{column} {row}");
    }
}

#[test]
fn black_pictures_have_no_parts() {
    let black = picture_of(4, 3, |_, _| [0.0; 3]);
    assert!(black.is_black() && black.parts().count() == 0);
    let SkyLight { radiance, pdf, .. } = black.light::<f32>(Vec3::X.into(), 1);
    assert_eq!((radiance, pdf), (Vec3::ZERO.into(), 0.0));
}

#[test]
fn the_light_of_one_color_is_that_color_from_everywhere() {
    for (width, height, error) in [(WIDTH, HEIGHT, 0.02), (3, 1, 0.3), (256, 128, 1e-4)] {
        let picture = picture_of(width, height, |_, _| [2.0; 3]);
        let light: f64 = picture.parts().map(|part| part.light).sum();
        assert!((light / (4.0 * PI * 4.0) - 1.0).abs() < error, "{light}");
    }
}

/// Integrals over the directions above the picture's equator: of cosine-weighted luminance, and of
/// the second and the fourth central moment of its estimator.
fn moments(picture: &Picture, part: usize) -> [f64; 3] {
    // Nodes and weights of Gauss and Legendre, on [0, 1].
    const NODES: [(f64, f64); 4] = [
        (0.069_431_844_202_973_7, 0.173_927_422_568_726_9),
        (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_9),
    ];
    let (columns, rows) = (2 * picture.image.width, 2 * picture.image.height);
    let cells = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let points: Vec<[f64; 3]> = cells
        .flat_map(|cell| NODES.map(|x| NODES.map(|y| (cell, x, y))).into_iter().flatten())
        .map(|((i, j), (x, across), (y, down))| {
            let [u, v] =
                [(f64::from(i) + x) / f64::from(columns), (f64::from(j) + y) / f64::from(rows)];
            let ((sin, cos), (y, x)) = ((v * PI).sin_cos(), (u * TAU).sin_cos());
            let local = DVec3::new(sin * x, sin * y, cos).as_vec3();
            let density = f64::from(pdf(picture, part, picture.axes.to_world(local)));
            let area = across * down * TAU * PI * sin / f64::from(columns * rows);
            let light = if density > 0.0 { bilinear(picture, [u, v]) } else { 0.0 };
            [light * cos.max(0.0), density, area]
        })
        .collect();
    let mean: f64 = points.iter().map(|[light, _, area]| light * area).sum();
    let central = |power: i32| -> f64 {
        let lit = points.iter().filter(|[_, density, _]| *density > 0.0);
        lit.map(|[light, density, area]| (light / density - mean).powi(power) * density * area)
            .sum()
    };
    [mean, central(2), central(4)]
}

#[test]
fn irradiance_of_a_bare_floor_has_the_exact_mean_and_variance() {
    for picture in pictures() {
        (0..picture.parts.len()).for_each(|part| check_moments(&picture, part));
    }
}

fn check_moments(picture: &Picture, part: usize) {
    let [mean, variance, fourth] = moments(picture, part);
    let count = 200_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for sample in random_pairs(count, 3).map(|u| sample(picture, part, u)) {
        let value = sample.map_or(0.0, |sample| {
            let cosine = picture.axes.normal.dot(sample.direction.into()).max(0.0);
            f64::from(luminance(sample.radiance.into()) * cosine / sample.pdf)
        });
        sum += value;
        squares += (value - mean).powi(2);
    }
    let (sum, squares) = (sum / count as f64, squares / count as f64);
    let error = 5.0 * (variance / count as f64).sqrt() + 1e-5 * mean;
    assert!((sum - mean).abs() <= error, "{sum} is not {mean} +- {error}");
    let error = 5.0 * ((fourth - variance * variance).max(0.0) / count as f64).sqrt();
    let error = error + 1e-4 * variance + 1e-9 * mean * mean;
    assert!((squares - variance).abs() <= error, "{squares} is not {variance} +- {error}");
}

#[test]
fn rows_equal_their_lanes() {
    let lanes = first_lanes(13);
    let numbers: Vec<[f32; 2]> = random_pairs(16, 9).collect();
    let u = [0, 1].map(|i| F32x16::new(std::array::from_fn(|lane| numbers[lane][i])));
    let lane_of = |v: vec3::Vec3<F32x16>, lane: usize| Vec3::from(v.map(|x| x.to_array()[lane]));
    for picture in pictures() {
        for part in 0..picture.parts.len() {
            let row = picture.sample(part, u, lanes);
            let light = picture.light(row.direction, lanes);
            let plain = picture.radiances(row.direction, lanes);
            for lane in set_bits(lanes) {
                let one = picture.sample(part, numbers[lane], 1);
                assert_eq!(one.lanes, row.lanes >> lane & 1);
                assert_eq!(Vec3::from(one.direction), lane_of(row.direction, lane));
                assert_eq!(Vec3::from(one.radiance), lane_of(row.radiance, lane));
                assert_eq!(one.pdf, row.pdf.to_array()[lane]);
                let single = picture.light(one.direction, 1);
                assert_eq!(Vec3::from(single.radiance), lane_of(light.radiance, lane));
                assert_eq!(Vec3::from(single.radiance), lane_of(plain, lane));
                assert_eq!(single.pdf, light.pdf.to_array()[lane]);
                assert_eq!(single.part[0], light.part[lane]);
            }
        }
    }
}

#[test]
fn from_inside_it_is_as_painted() {
    let pixels = (0..WIDTH * HEIGHT).map(|i| [(i % WIDTH) as f32; 3]).collect();
    let image = Image::new(WIDTH as u32, HEIGHT as u32, pixels).unwrap();
    let picture = Picture::new(Arc::new(image), DVec3::Z, 0.0, 1.0);
    // Facing the middle, -x, the greater columns are to the right: +y if up is z.
    let column = |toward| picture.radiance(toward).x;
    assert!((column(Vec3::NEG_X) - 5.5).abs() < 1e-4);
    assert!((column(Vec3::Y) - 8.5).abs() < 1e-4 && (column(Vec3::NEG_Y) - 2.5).abs() < 1e-4);
}
