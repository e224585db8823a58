//! Rows of light samples against single samples, to the bit.

use super::*;
use crate::sampling::{LightDraw, mix, stream, unit_pair};
use crate::spheres::Spheres;
use crate::vec3::Vec3 as Row3;
use crate::world::Sun;
use crate::world::World;
use glam::{DVec3, Vec3};

fn check(view: &LightView, count: usize, seed: u64) {
    let draws: [[f32; 2]; LANES] =
        std::array::from_fn(|lane| unit_pair(stream(mix(seed), lane as u64)));
    let u = [0, 1].map(|axis| F32x16::new(draws.map(|draw| draw[axis])));
    let row = view.sample_row(u, count);
    assert_eq!(row.lanes, first_lanes(count));
    for (lane, &draw) in draws.iter().enumerate().take(count) {
        let (sample, one) = (row.sample(lane), view.sample(draw).expect("there is light"));
        assert_eq!(sample.direction, one.direction, "lane {lane}");
        assert_eq!((sample.t, sample.target), (one.t, one.target), "lane {lane}");
        assert_eq!(sample.weight, one.weight, "lane {lane}");
    }
}

#[test]
fn rows_equal_their_lanes() {
    let spheres = Spheres::from_columns(&[0.3], &[-0.5], &[0.7], &[0.25]);
    // From far, from near, and from where half of the lanes need the exact distance.
    for distance in [0.250_001, 0.3, 1.0, 100.0, 1e7] {
        let origin = Vec3::new(0.3, -0.5, 0.7) + Vec3::new(0.48, -0.6, 0.64) * distance;
        let disc = Disc::new(&spheres, 0, Rgb::ONE, origin, 1.0).expect("the point is outside");
        let view = LightView::Disc(disc);
        (1..=LANES).for_each(|count| check(&view, count, count as u64));
    }
    for angle in [0.0, 0.27, 90.0] {
        let sun = Sun::new(DVec3::new(0.6, 0.0, 0.8), Rgb::ONE, angle);
        check(&LightView::Sun(&sun), LANES, 1);
    }
    let world = crate::world::lights::tests::world();
    let picture = world.environment.picture().expect("it is not black");
    (1..=LANES).for_each(|count| check(&LightView::Sky(picture, 0), count, count as u64));
}

/// Receivers around the origin, facing many directions.
fn receivers(seed: u64) -> [Receiver; LANES] {
    std::array::from_fn(|lane| {
        let number = |k| stream(mix(seed), 8 * lane as u64 + k);
        let [[a, b], [c, d]] = [0, 1].map(|k| unit_pair(number(k)));
        let normal = crate::sampling::uniform_sphere([a, b]);
        let point = crate::sampling::uniform_sphere([c, d]) * (4.0 * a * a);
        Receiver { point, normal, own: if lane == 3 { 0 } else { MISS } }
    })
}

fn assert_rows_equal_lanes(world: &World) {
    for (seed, lanes) in [(1, 0xffff), (2, 0x0fff), (3, 0xa5a5), (4, 1), (5, 0x8000)] {
        let each = receivers(seed);
        let vector = |of: fn(&Receiver) -> Vec3| {
            let axis = |axis: usize| F32x16::new(each.map(|at| of(&at)[axis]));
            Row3::new(axis(0), axis(1), axis(2))
        };
        let (point, normal) = (vector(|at| at.point), vector(|at| at.normal));
        let at = ReceiverRow { point, normal, own: each.map(|at| at.own) };
        let numbers: [[f32; 4]; LANES] = std::array::from_fn(|lane| {
            let pair = |k| unit_pair(stream(mix(seed + 9), 2 * lane as u64 + k));
            let ([a, b], [c, d]) = (pair(0), pair(1));
            [a, b, c, d]
        });
        let columns = std::array::from_fn(|i| F32x16::new(numbers.map(|draw| draw[i])));
        let row = world.sample_light_row(&at, columns, lanes);
        assert_eq!(row.close & !row.lanes, 0);
        if world.lights.sky_parts > 0 {
            let index = world.lights.len() - world.lights.sky_parts;
            let found = world.lights.sky_probabilities(&at, [0; LANES], lanes);
            for lane in set_bits(lanes) {
                assert_eq!(found[lane], world.lights.probability(&each[lane], index));
            }
        }
        for lane in 0..LANES {
            let draw = LightDraw::new(numbers[lane]);
            let Receiver { point, own, .. } = each[lane];
            let chosen = world.lights.choose(&each[lane], draw.light);
            let one = chosen.filter(|_| lanes >> lane & 1 == 1).and_then(|(light, chance)| {
                Some((world.sample_light(light, point, own, draw.point)?, chance))
            });
            assert_eq!(one.is_some(), row.lanes >> lane & 1 == 1, "{seed} {lane}");
            let Some((one, chance)) = one else { continue };
            let sample = row.sample(lane);
            assert_eq!((sample.direction, sample.t), (one.direction, one.t));
            assert_eq!((sample.target, sample.close), (one.target, one.close));
            assert_eq!(sample.weight, one.weight / chance);
            assert_eq!(sample.pdf, one.pdf.map(|pdf| pdf * chance));
        }
    }
}

#[test]
fn rows_equal_their_lanes_for_every_kind_of_light() {
    use crate::scene::{Light, LightChoice, Material, NamedMaterial, Scene};
    let emitters = |count: usize| {
        let mut scene = Scene::default();
        for i in 0..count {
            let angle = i as f64;
            let radiance = Rgb::new(1.0, 0.5, i as f32);
            let material = Material::Emitter { radiance, albedo: Rgb::ZERO };
            scene.materials.push(NamedMaterial { name: String::new(), material });
            let center = DVec3::new(angle.sin(), angle.cos(), 0.1 * angle) * 1.5;
            scene.spheres.push(center, 0.1 + 0.01 * angle, i as u32, Rgb::ONE);
        }
        scene
    };
    let mut scenes: Vec<Scene> = [1, 2, 16, 17, 60].map(emitters).into();
    let dark = || {
        let mut scene = emitters(1);
        scene.materials[0].material = Material::Lambertian { color: Rgb::ONE };
        scene
    };
    let lit = |light: Light| Scene { lights: vec![light], ..dark() };
    let (position, intensity) = (DVec3::new(0.3, 2.0, -1.0), Rgb::new(1.0, 2.0, 3.0));
    scenes.push(lit(Light::Point { position, intensity, falloff: true }));
    scenes.push(lit(Light::Point { position, intensity, falloff: false }));
    let (direction, irradiance) = (DVec3::new(0.6, 0.0, 0.8), Rgb::ONE);
    scenes.push(lit(Light::Sun { direction, irradiance, angular_radius: 3.0 }));
    scenes.push(lit(Light::Sun { direction, irradiance, angular_radius: 0.0 }));
    for choice in [LightChoice::Tree, LightChoice::Power, LightChoice::Uniform] {
        for scene in &scenes {
            let mut scene = scene.clone();
            scene.settings.light_choice = choice;
            let world = World::build(&scene).expect("the scene is good");
            assert_rows_equal_lanes(&world);
        }
    }
    assert_rows_equal_lanes(&crate::world::lights::tests::world());
}
