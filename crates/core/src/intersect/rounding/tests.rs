//! The steps against arithmetic without rounding: what they call certain is right, and it nearly always is.

use super::*;
use crate::lanes::{F64x8, Mask};
use crate::random::{Random, direction_past};

/// A ray and a sphere that it hits, of single precision, in a tree's units.
struct Case {
    ray: ExactRay,
    center: DVec3,
    radius: f64,
    t: f64,
}

impl Case {
    /// A random ray from `away` radii, whose line passes the center at some part of the radius.
    fn new(random: &mut Random, radius: f64, away: f64, part: f64) -> Option<Self> {
        let single = |v: DVec3| v.as_vec3().as_dvec3();
        let center = single(random.in_cube() * 0.5);
        let radius = f64::from(radius as f32);
        let origin = single(center + random.direction() * (radius * away));
        let direction = direction_past(center - origin, radius * part, random);
        let direction =
            single(direction * (random.between([1.0, 2.0]) / direction.abs().max_element()));
        let ray = ExactRay { origin, direction, origin_error: 0.0 };
        let t = exact::nearest_distance(&ray, center, radius)?;
        Some(Self { ray, center, radius, t })
    }

    fn pairs(&self) -> Pairs<f64> {
        Pairs::one(&self.ray, self.center, self.radius)
    }

    fn is_coarse(&self) -> bool {
        [self.ray.origin, self.center].iter().all(|v| Vec3::<f32>::from(v.as_vec3()).is_coarse())
    }
}

/// Counts of steps.
#[derive(Debug, Default)]
struct Counts {
    all: usize,
    quick: usize,
    close: usize,
}

fn count(seed: u64, radius: [f64; 2], away: [f64; 2], part: [f64; 2]) -> Counts {
    let mut random = Random::new(seed);
    let mut counts = Counts::default();
    while counts.all < 4000 {
        let [radius, away, part] = [radius, away, part].map(|range| random.decades(range));
        let case = Case::new(&mut random, radius, away, part);
        let Some(case) = case.filter(Case::is_coarse) else { continue };
        counts.all += 1;
        let pairs = case.pairs();
        // From before the hit, with an error as that of single precision or larger.
        let before = case.t * (1.0 - random.decades([-7.0, -3.0]));
        let start = f64::from((before as f32).next_down());
        let (certain, t) = nearest_quickly(&pairs, start);
        assert!(!certain || t == case.t, "quick: {t:e}, not {:e}, {:?}", case.t, case.ray);
        counts.quick += usize::from(certain);
        // From near the hit, as accurate as plain double precision, or as far away as is allowed.
        let about = case.t * (1.0 + random.sign() * random.decades([-16.0, -5.5]));
        let (certain, t) = nearest_closely(&pairs, about);
        assert!(!certain || t == case.t, "close: {t:e}, not {:e}, {:?}", case.t, case.ray);
        counts.close += usize::from(certain);
        let all = nearest(&case.ray, case.center, case.radius, about, true);
        assert_eq!(all, case.t, "{:?}", case.ray);
    }
    counts
}

#[test]
fn certain_distances_are_the_nearest_doubles() {
    // Sizes, distances in radii, and how far from the center lines pass, in decades.
    let ordinary = count(1, [-3.0, -1.0], [0.1, 2.0], [-2.0, -0.05]);
    assert!(ordinary.quick > 3900 && ordinary.close > 3990, "{ordinary:?}");
    let inside = count(2, [-3.0, -1.0], [-2.0, -0.1], [-2.0, -0.05]);
    assert!(inside.quick > 3500 && inside.close > 3990, "{inside:?}");
    let far = count(3, [-5.0, -4.0], [4.0, 4.9], [-2.0, -0.05]);
    assert!(far.close > 3990, "{far:?}");
    let above = count(4, [-1.0, 0.0], [1e-6, 1e-4], [-2.0, -0.05]);
    assert!(above.close > 3990, "{above:?}");
    let grazing = count(5, [-3.0, -1.0], [0.1, 2.0], [-1e-3, -1e-6]);
    assert!(grazing.close > 3500, "{grazing:?}");
}

#[test]
fn lanes_round_as_single_pairs_do() {
    let mut random = Random::new(6);
    for _ in 0..500 {
        let cases: Vec<Case> = std::iter::from_fn(|| Some(Case::new(&mut random, 0.1, 4.0, 0.7)))
            .flatten()
            .take(8)
            .collect();
        let row = |f: &dyn Fn(&Case) -> f64| F64x8::new(std::array::from_fn(|i| f(&cases[i])));
        let vector = |f: &dyn Fn(&Case) -> DVec3| {
            Vec3::new(row(&|case| f(case).x), row(&|case| f(case).y), row(&|case| f(case).z))
        };
        let pairs = Pairs {
            origin: vector(&|case| case.ray.origin),
            direction: vector(&|case| case.ray.direction),
            origin_error: row(&|_| 0.0),
            center: vector(&|case| case.center),
            radius: row(&|case| case.radius),
        };
        let start = |case: &Case| f64::from((case.t as f32).next_down());
        let wide =
            [nearest_quickly(&pairs, row(&start)), nearest_closely(&pairs, row(&|case| case.t))];
        for (lane, case) in cases.iter().enumerate() {
            let single = [
                nearest_quickly(&case.pairs(), start(case)),
                nearest_closely(&case.pairs(), case.t),
            ];
            for ((certain, t), single) in wide.iter().zip(single) {
                let found = (certain.bits() >> lane & 1 == 1, t.to_array()[lane]);
                assert_eq!(found, single, "{:?}", case.ray);
            }
        }
    }
}

/// Nothing is certain about lines that miss, spheres behind, and what is not a number.
#[test]
fn steps_to_no_hit_are_not_certain() {
    let pairs = |y: f64, x: f64| {
        let ray = ExactRay {
            origin: DVec3::new(-3.0, y, 0.0),
            direction: DVec3::new(x, 0.0, 0.0),
            origin_error: 0.0,
        };
        Pairs::one(&ray, DVec3::ZERO, 0.5)
    };
    for start in [2.0, 2.5, 3.0, 3.5, 4.0, 0.0, -1.0, -2.5, f64::NAN, f64::INFINITY] {
        for (y, x) in [(0.5625, 1.0), (0.75, 1.5), (0.0, -1.0), (f64::NAN, 1.0), (0.0, 0.0)] {
            assert!(!nearest_quickly(&pairs(y, x), start).0, "{start} {y} {x}");
            assert!(!nearest_closely(&pairs(y, x), start).0, "{start} {y} {x}");
        }
    }
    let near = f64::from((2.5_f32).next_down());
    assert_eq!(nearest_quickly(&pairs(0.0, 1.0), near), (true, 2.5));
    assert_eq!(nearest_closely(&pairs(0.0, 1.0), near), (true, 2.5));
}
