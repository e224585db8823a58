//! Samples and rays that chance finds, held against each other.

use crate::lanes::F32x16;
use crate::scene::{ConductorFresnel, Material, NamedMaterial, Rgb, Scene};
use crate::vec3::Vec3;
use crate::world::caustics::{Casters, Found, Looking, Way};
use crate::world::{ROW, World};
use glam::DVec3;
use spherule_core::internals::random::Random;
use std::f64::consts::{FRAC_1_PI, PI};

/// Small spheres of every kind that casts light, and two lamps.
fn world() -> World {
    let mut scene = Scene::default();
    let white = Rgb::ONE;
    let emitter = Material::Emitter { radiance: white, albedo: Rgb::ZERO };
    let metal = Material::Conductor { fresnel: ConductorFresnel::Constant(white), roughness: 0.0 };
    let glass = Material::Dielectric { ior: 1.5, color: white };
    let plastic = Material::Plastic { color: white, ior: 1.4 };
    scene.materials = [emitter, metal, glass, plastic]
        .map(|material| NamedMaterial { name: String::new(), material })
        .into();
    let spheres = [
        ([4.0, 0.0, 0.0], 0.5, 0),
        ([0.0, 5.0, 1.0], 0.3, 0),
        ([0.0, 0.0, 0.0], 1.0, 1),
        ([0.0, 0.0, 2.5], 1.0, 2),
        ([0.0, 2.5, 0.0], 0.8, 3),
    ];
    for (center, radius, material) in spheres {
        scene.spheres.push(center.into(), radius, material, white);
    }
    World::build(&scene).unwrap()
}

fn splat(v: glam::Vec3) -> Vec3<F32x16> {
    Vec3::splat(v.x, v.y, v.z)
}

fn first(v: Vec3<F32x16>) -> glam::Vec3 {
    v.map(|row| row.to_array()[0]).into()
}

/// Weight of a sample of a way, and what it is by the weight that chance has in the same direction;
/// `None` if there is no such way.
fn weights(
    casters: &Casters,
    [point, normal]: [glam::Vec3; 2],
    (number, way): (usize, Way),
    place: [f32; 2],
) -> Option<[f64; 2]> {
    let pair = &casters.pairs[number];
    let probability = casters.probability(number, way, [point, normal]);
    let looking = Looking {
        point: splat(point),
        normal: splat(normal),
        pair: [pair; ROW],
        way: [way; ROW],
        probability: F32x16::splat(probability),
    };
    let sent = looking.sample(place.map(F32x16::splat));
    if probability == 0.0 || sent.lanes & 1 == 0 || sent.incidence.to_array()[0] < 0.1 {
        return None;
    }
    let (toward, onward) = (first(sent.toward), first(sent.onward));
    let chance = casters.weight(&Found {
        start: [point, normal],
        toward,
        pdf: normal.dot(toward) * FRAC_1_PI as f32,
        ball: pair.ball,
        through: way != Way::Reflected,
        lamp: pair.lamp,
        end: [first(sent.exit) + onward * sent.length[1][0] as f32, onward],
    });
    let ratio = (1.0 / f64::from(chance) - 1.0).sqrt();
    Some([f64::from(sent.weight.to_array()[0]), PI * ratio / (1.0 + ratio * ratio)])
}

/// A direction that was sampled has the density that it is said to have when it is found by chance.
#[test]
fn samples_and_rays_found_by_chance_agree_on_densities() {
    let (world, mut random) = (world(), Random::new(6));
    let (mut compared, mut apart) = ([0; 4], 0);
    for _ in 0..10_000 {
        // All about, or behind the glass, where light takes all ways.
        let behind = DVec3::new(-4.0, 0.0, 2.5).normalize() + random.direction() * 0.3;
        let near = DVec3::Z * 2.5 + behind * random.between([1.0, 1.6]);
        let point = if random.coin() { random.in_cube() * 4.0 } else { near };
        let start = [world.frame.point(point), random.direction()].map(DVec3::as_vec3);
        for number in 0..world.casters.pairs.len() {
            for way in world.casters.pairs[number].ways() {
                let place = [random.unit() as f32, random.unit() as f32];
                let both = weights(&world.casters, start, (number, *way), place);
                let Some([sample, expected]) = both else { continue };
                compared[*way as usize] += 1;
                let off = (sample / expected - 1.0).abs();
                apart += i32::from(off.is_nan() || off > 0.02);
            }
        }
    }
    assert!(compared.iter().all(|&compared| compared > 50), "{compared:?}");
    // Next to where two ways meet, rounding may tell one from the other.
    assert!(100 * apart < compared.iter().sum(), "{apart} of {compared:?}");
}
