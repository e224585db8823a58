//! Densities of caustic samples against MIS weights of BSDF samples.

use crate::lanes::F32x16;
use crate::scene::{ConductorFresnel, Material, NamedMaterial, Rgb, Scene};
use crate::vec3::Vec3;
use crate::world::caustics::{CausticCasters, CausticHit, CausticPath, CausticQuery};
use crate::world::{ROW, World};
use glam::DVec3;
use spherule_core::internals::random::Random;
use std::f64::consts::{FRAC_1_PI, PI};

/// Small specular spheres of every kind, and two emitters.
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

/// Returns the weight of a caustic sample, and the weight expected from the MIS weight of a BSDF sample
/// in the same direction; `None` if the path does not exist.
fn weights(
    caustic_casters: &CausticCasters,
    [point, normal]: [glam::Vec3; 2],
    (number, path): (usize, CausticPath),
    place: [f32; 2],
) -> Option<[f64; 2]> {
    let pair = &caustic_casters.pairs[number];
    let probability = caustic_casters.probability(number, path, [point, normal]);
    let query = CausticQuery {
        point: splat(point),
        normal: splat(normal),
        pair: [pair; ROW],
        path: [path; ROW],
        probability: F32x16::splat(probability),
    };
    let sample = query.sample(place.map(F32x16::splat));
    if probability == 0.0 || sample.lanes & 1 == 0 || sample.incidence.to_array()[0] < 0.1 {
        return None;
    }
    let (toward, toward_emitter) = (first(sample.toward), first(sample.toward_emitter));
    let chance = caustic_casters.weight(&CausticHit {
        start: [point, normal],
        toward,
        pdf: normal.dot(toward) * FRAC_1_PI as f32,
        sphere: pair.sphere,
        through: path != CausticPath::Reflected,
        emitter: pair.emitter,
        end: [first(sample.exit) + toward_emitter * sample.length[1][0] as f32, toward_emitter],
    });
    let ratio = (1.0 / f64::from(chance) - 1.0).sqrt();
    Some([f64::from(sample.weight.to_array()[0]), PI * ratio / (1.0 + ratio * ratio)])
}

/// Checks that the density of a caustic sample equals the density that BSDF samples assume for it.
#[test]
fn caustic_samples_and_bsdf_samples_agree_on_densities() {
    let (world, mut random) = (world(), Random::new(6));
    let (mut compared, mut apart) = ([0; 4], 0);
    for _ in 0..10_000 {
        // Points all around, or behind the glass, where light takes all paths.
        let behind = DVec3::new(-4.0, 0.0, 2.5).normalize() + random.direction() * 0.3;
        let near = DVec3::Z * 2.5 + behind * random.between([1.0, 1.6]);
        let point = if random.coin() { random.in_cube() * 4.0 } else { near };
        let start = [world.transform.point(point), random.direction()].map(DVec3::as_vec3);
        for number in 0..world.caustic_casters.pairs.len() {
            for path in world.caustic_casters.pairs[number].paths() {
                let place = [random.unit() as f32, random.unit() as f32];
                let both = weights(&world.caustic_casters, start, (number, *path), place);
                let Some([sample, expected]) = both else { continue };
                compared[*path as usize] += 1;
                let off = (sample / expected - 1.0).abs();
                apart += i32::from(off.is_nan() || off > 0.02);
            }
        }
    }
    assert!(compared.iter().all(|&compared| compared > 50), "{compared:?}");
    // Where two kinds of paths nearly coincide, rounding may confuse them.
    assert!(100 * apart < compared.iter().sum(), "{apart} of {compared:?}");
}
