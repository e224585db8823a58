//! Densities of caustic samples against MIS weights of BSDF samples.

use crate::lanes::F32x16;
use crate::ray::MISS;
use crate::scene::{ConductorFresnel, Light, Material, NamedMaterial, Rgb, Scene};
use crate::vec3::Vec3;
use crate::world::caustics::selection::CausticChoice;
use crate::world::caustics::{
    CausticCasters, CausticHit, CausticPath, CausticQuery, CausticSample, CausticSource,
};
use crate::world::{LANES, Receiver, World};
use glam::DVec3;
use spherule_core::internals::random::Random;

/// Small specular spheres of every kind, two emissive spheres and a sun.
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
    scene.lights.push(Light::Sun {
        direction: DVec3::new(0.3, -0.5, 0.8).normalize(),
        irradiance: white,
        angular_radius: 5.0,
    });
    World::build(&scene).unwrap()
}

fn splat(v: glam::Vec3) -> Vec3<F32x16> {
    Vec3::splat(v.x, v.y, v.z)
}

fn first(v: Vec3<F32x16>) -> glam::Vec3 {
    v.map(|row| row.to_array()[0]).into()
}

/// Samples a caustic; the first lane has the sample.
fn sample(
    casters: &CausticCasters,
    at: &Receiver,
    choice: &CausticChoice,
    place: [f32; 2],
) -> CausticSample {
    let code = [choice.caster as u32 * CausticPath::COUNT; LANES];
    let query = CausticQuery {
        point: splat(at.point),
        pairs: casters.pair_row(&code, &[choice.emitter as u32; LANES], 1),
        path: [choice.path; LANES],
        rate: F32x16::splat(choice.rate as f32),
    };
    query.sample(place.map(F32x16::splat))
}

/// Returns the density of a caustic sample, and that which the MIS weight of a BSDF sample in the same
/// direction assumes; `None` if the path does not exist.
fn densities(
    casters: &CausticCasters,
    at: &Receiver,
    emitter: usize,
    caster: usize,
    path: CausticPath,
    place: [f32; 2],
) -> Option<[f64; 2]> {
    let rate = casters.rate(at, emitter, caster, path);
    if rate == 0.0 {
        return None;
    }
    let sample = sample(casters, at, &CausticChoice { emitter, caster, path, rate }, place);
    if sample.lanes & 1 == 0 || sample.incidence.to_array()[0] < 0.1 {
        return None;
    }
    let toward_emitter = first(sample.toward_emitter);
    let source = casters.emitters[emitter].source;
    let density = f64::from(sample.pdf.to_array()[0]);
    let mirrored = casters.mirrored_light && path == CausticPath::Reflected;
    let kept = if mirrored { 1.0 } else { f64::from(sample.kept.to_array()[0]) };
    let chance = casters.weight(&CausticHit {
        start: *at,
        toward: first(sample.toward),
        // Both densities are equal.
        pdf: (density / kept) as f32,
        sphere: casters.casters[caster].row,
        through: path != CausticPath::Reflected,
        emitter: source,
        end: match source {
            CausticSource::Sphere(_) => {
                first(sample.exit) + toward_emitter * sample.length[1][0] as f32
            }
            CausticSource::Sun(_) => toward_emitter,
        },
        toward_emitter,
        rate: None,
    });
    let ratio = (1.0 / f64::from(chance) - 1.0).sqrt();
    Some([density, density * ratio])
}

/// Returns a random receiver all around the spheres, or behind the glass, where light takes all paths.
fn receiver(world: &World, random: &mut Random) -> Receiver {
    let behind = DVec3::new(-4.0, 0.0, 2.5).normalize() + random.direction() * 0.3;
    let near = DVec3::Z * 2.5 + behind * random.between([1.0, 1.6]);
    let point = if random.coin() { random.in_cube() * 4.0 } else { near };
    let [point, normal] = [world.transform.point(point), random.direction()].map(DVec3::as_vec3);
    Receiver { point, normal, own: MISS }
}

/// Checks that the density of a caustic sample equals the density that BSDF samples assume for it.
#[test]
fn caustic_samples_and_bsdf_samples_agree_on_densities() {
    let (world, mut random) = (world(), Random::new(6));
    let casters = &world.caustic_casters;
    let (mut compared, mut apart) = ([[0; 4]; 3], 0);
    for _ in 0..10_000 {
        let at = receiver(&world, &mut random);
        for (emitter, compared) in compared.iter_mut().enumerate() {
            for caster in 0..casters.casters.len() {
                for path in CausticPath::ALL {
                    let place = [random.unit() as f32, random.unit() as f32];
                    let both = densities(casters, &at, emitter, caster, path, place);
                    let Some([sample, expected]) = both else { continue };
                    compared[path as usize] += 1;
                    let off = (sample / expected - 1.0).abs();
                    apart += i32::from(off.is_nan() || off > 0.02);
                }
            }
        }
    }
    let all: i32 = compared.iter().flatten().sum();
    let of_path = |path: usize| compared.iter().map(|each| each[path]).sum::<i32>();
    assert!((0..4).all(|path| of_path(path) > 300), "{compared:?}");
    assert!(compared.iter().all(|each| each[0].min(each[1]) > 300), "{compared:?}");
    // Where two kinds of paths nearly coincide, rounding may confuse them.
    assert!(100 * apart < all, "{apart} of {compared:?}");
}

/// Checks that choices have the rates that are computed for them.
#[test]
fn caustics_are_chosen_at_their_rates() {
    const DRAWS: u32 = 20_000;
    let (world, mut random) = (world(), Random::new(7));
    let casters = &world.caustic_casters;
    for _ in 0..50 {
        let at = receiver(&world, &mut random);
        let mut counts = std::collections::BTreeMap::new();
        for draw in 0..DRAWS {
            let draw = (f64::from(draw) + 0.5) / f64::from(DRAWS);
            for choice in (0..).map_while(|number| casters.choose(&at, draw, number)) {
                let key = (choice.emitter, choice.caster, choice.path as usize);
                let count = counts.entry(key).or_insert((0_u32, choice.rate));
                count.0 += 1;
                assert_eq!(count.1, choice.rate);
            }
        }
        for emitter in 0..casters.emitters.len() {
            for caster in 0..casters.casters.len() {
                for path in CausticPath::ALL {
                    let rate = casters.rate(&at, emitter, caster, path);
                    let key = (emitter, caster, path as usize);
                    let (count, chosen) = counts.get(&key).copied().unwrap_or_default();
                    let off = f64::from(count) / f64::from(DRAWS) - rate;
                    assert!(off.abs() < 20.0 / f64::from(DRAWS), "{key:?} {count} {rate}");
                    assert!(count == 0 || (chosen / rate - 1.0).abs() < 1e-6, "{chosen} {rate}");
                }
            }
        }
    }
}
