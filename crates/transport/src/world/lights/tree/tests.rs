//! Probabilities against frequencies and closed forms.

use super::*;
use crate::ray::MISS;
use crate::sampling::statistics::{assert_chi_squared, random_pairs};
use crate::world::lights::sampler::LightSampler;
use crate::world::lights::tests::world;

/// Random numbers with more digits than single precision has.
fn draws(count: u64, seed: u64) -> impl Iterator<Item = f64> {
    random_pairs(count, seed).map(|[u, v]| f64::from(u) + f64::from(v) / f64::from(1 << 24))
}

fn emitter(center: DVec3, radius: f64, power: f64) -> LightBounds {
    LightBounds { center, radius, power, hollow: true, ..LightBounds::default() }
}

/// Returns emitters of very different size and power in a cube of edge 2.
fn emitters(count: u64) -> Vec<LightBounds> {
    let numbers: Vec<[f64; 2]> =
        random_pairs(3 * count, 5).map(|pair| pair.map(f64::from)).collect();
    let emitter = |u: &[[f64; 2]]| {
        let center = DVec3::new(u[0][0], u[0][1], u[1][0]) * 2.0 - 1.0;
        emitter(center, 1e-3 + 0.02 * u[1][1].powi(4), 1e-3_f64.powf(u[2][0]))
    };
    numbers.chunks_exact(3).map(emitter).collect()
}

fn receivers() -> impl Iterator<Item = Receiver> {
    let places = [[0.0; 3], [0.3, -0.2, 0.9], [1.0, 1.0, -1.0], [40.0, 0.0, 3.0], [1e9, 0.0, 0.0]];
    let normals = [Vec3::X, Vec3::NEG_Z, Vec3::new(0.48, -0.6, 0.64)];
    let all = places.into_iter().flat_map(move |place| normals.map(|normal| (place, normal)));
    all.map(|(place, normal)| Receiver { point: Vec3::from(place), normal, own: MISS })
}

/// Checks that probabilities sum to 1, agree with those that choices return, and with frequencies.
fn check(tree: &Tree, at: &Receiver) {
    let lights = tree.leaf.len();
    let of = |light| f64::from(tree.probability::<OneSided>(at, light));
    let probabilities: Vec<f64> = (0..lights).map(of).collect();
    let sum: f64 = probabilities.iter().sum();
    assert!((sum - 1.0).abs() < 1e-5, "{at:?}: {sum}");
    let mut observed = vec![0_u64; lights];
    for draw in draws(30_000, 1).chain([0.0, 1.0 - f64::EPSILON]) {
        let (light, probability, _) = tree.choose::<OneSided>(at, draw);
        assert!(probability > 0.0 && (f64::from(probability) / of(light) - 1.0).abs() < 1e-6);
        observed[light] += 1;
    }
    assert_chi_squared(&observed, &probabilities);
}

#[test]
fn lights_are_chosen_by_their_probability() {
    for count in [1, 2, 3, 16, 17, 40, 3000] {
        let tree = Tree::new(&emitters(count)).expect("emitters shine");
        receivers().for_each(|at| check(&tree, &at));
    }
}

#[test]
fn lights_of_every_kind_are_chosen_by_their_probability() {
    let world = world();
    let LightSampler::Tree(tree) = &world.lights.sampler else { panic!("there are lights") };
    receivers().for_each(|at| check(tree, &at));
    // Receivers next to, on and inside of emitters.
    for row in &world.lights.emitters {
        let (center, radius) = world.spheres.exact(*row as usize);
        for part in [0.0, 0.5, 1.0, 1.000_001, 1.1] {
            let point = (center + DVec3::X * (radius * part)).as_vec3();
            check(tree, &Receiver { point, normal: Vec3::X, own: *row });
            check(tree, &Receiver { point, normal: Vec3::NEG_X, own: MISS });
        }
    }
}

/// Above the horizon, the estimate is power over squared distance times the cosine, exactly.
#[test]
fn few_lights_are_chosen_by_their_contribution() {
    let places = [[0.3, 0.4, 0.5], [0.0, 0.0, 2.0], [-0.9, 0.1, 0.2], [5.0, -3.0, 1.0]];
    let lights: Vec<LightBounds> =
        places.into_iter().zip(1..).map(|(at, i)| emitter(at.into(), 0.01, f64::from(i))).collect();
    let sun = LightBounds {
        center: DVec3::new(0.6, 0.0, 0.8) * FAR,
        steady: 0.7,
        ..LightBounds::default()
    };
    let tree = Tree::new(&[&lights[..], &[sun]].concat()).expect("all shine");
    let at = Receiver { point: Vec3::ZERO, normal: Vec3::Z, own: MISS };
    let irradiance =
        |light: &LightBounds| light.power * light.center.z / light.center.length().powi(3);
    let given: Vec<f64> = lights.iter().map(irradiance).chain([0.7 * 0.8]).collect();
    let total: f64 = given.iter().sum();
    for (light, given) in given.into_iter().enumerate() {
        let probability = f64::from(tree.probability::<OneSided>(&at, light));
        assert!((probability - given / total).abs() < 1e-6, "{light}: {probability}");
    }
}

#[test]
fn thousands_of_lights_are_chosen_by_their_contribution() {
    let mut lights = emitters(5000);
    let point = Vec3::new(0.1, 0.2, 0.3);
    lights.push(emitter(DVec3::new(0.1, 0.2, 0.31), 0.005, 1.0));
    let tree = Tree::new(&lights).expect("all shine");
    let facing =
        |normal| tree.probability::<OneSided>(&Receiver { point, normal, own: MISS }, 5000);
    // It is seen among 300 others at first.
    assert!(facing(Vec3::Z) > 0.05, "{}", facing(Vec3::Z));
    assert!(facing(Vec3::NEG_Z) > 0.0);
}

#[test]
fn luminous_lights_only_are_chosen() {
    let dark = [0.0, -1.0, f64::NAN, f64::INFINITY];
    let emitters = |powers: &[f64]| -> Vec<LightBounds> {
        powers.iter().map(|&power| emitter(DVec3::ONE, 0.1, power)).collect()
    };
    assert!(Tree::new(&[]).is_none() && Tree::new(&emitters(&dark)).is_none());
    let tree = Tree::new(&emitters(&[0.0, 1.0, f64::NAN, 1e-300, 1e300])).expect("three shine");
    for at in receivers() {
        let chances = [0, 1, 2, 3, 4].map(|light| tree.probability::<OneSided>(&at, light));
        assert!(chances[0] == 0.0 && chances[2] == 0.0, "{chances:?}");
        assert!(chances[3] > 0.0 && chances[1] > 0.0 && chances[4] > 0.99, "{chances:?}");
        assert_eq!(tree.choose::<OneSided>(&at, 1.0 - f64::EPSILON).0, 4);
    }
}

#[test]
fn coincident_lights_have_equal_probabilities() {
    let tree = Tree::new(&vec![emitter(DVec3::X, 0.01, 1.0); 1000]).expect("all shine");
    for at in receivers() {
        for light in 0..1000 {
            let probability = tree.probability::<OneSided>(&at, light);
            assert!((2e-4..5e-3).contains(&probability), "{light}: {probability}");
        }
    }
}

/// Light samples find nothing from inside of an emissive sphere: other lights get all the probability.
#[test]
fn an_enclosing_emitter_is_not_chosen() {
    let around = emitter(DVec3::ZERO, 10.0, 1e6);
    let tree = Tree::new(&[around, emitter(DVec3::Z, 0.1, 1e-3)]).expect("both shine");
    let at = Receiver { point: Vec3::ZERO, normal: Vec3::Z, own: MISS };
    assert_eq!(
        (tree.probability::<OneSided>(&at, 0), tree.probability::<OneSided>(&at, 1)),
        (0.0, 1.0)
    );
}

#[test]
fn the_columns_are_compact() {
    for count in [17, 300, 5000, 100_000] {
        let tree = Tree::new(&emitters(count)).expect("emitters shine");
        let nodes = tree.child.len() as f64;
        assert!(nodes < 1.4 * count as f64, "{count}: {nodes}");
    }
}
