//! The public queries against arithmetic without rounding, on input that is nasty on purpose: any
//! scale, mixed scales, denormal numbers, duplicates, tangents, lattices, rays of any length.

use glam::DVec3;
use proptest::prelude::*;
use spherule_core::internals::exact::{self, Distance};
use spherule_core::internals::random::Random;
use spherule_core::internals::ray::ExactRay;
use spherule_core::{
    Hit, Hits, NOTHING, QueryError, RayColumns, RayRows, SphereTree, Surface, Tally,
};
use std::cmp::Ordering;

type Sphere = [f32; 4];
type Ray = ([f32; 3], [f32; 3]);

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

fn is_valid(&[x, y, z, r]: &Sphere) -> bool {
    [x, y, z, r].iter().all(|v| v.is_finite()) && r > 0.0
}

/// The definition: of all spheres the nearest that is hit, of equals the first.
fn oracle(spheres: &[Sphere], (origin, direction): Ray) -> Option<(u32, f64)> {
    let ray = ExactRay { origin: wide(origin), direction: wide(direction), origin_error: 0.0 };
    if !ray.origin.is_finite() || !ray.direction.is_finite() || ray.direction == DVec3::ZERO {
        return None;
    }
    let mut best: Option<(u32, f64, Distance)> = None;
    for (i, sphere) in spheres.iter().enumerate().filter(|(_, sphere)| is_valid(sphere)) {
        let (center, radius) = (wide([sphere[0], sphere[1], sphere[2]]), f64::from(sphere[3]));
        let Some(t) = exact::hit(&ray, center, radius) else { continue };
        let distance = Distance::Hit(center, radius);
        let nearer = |(_, _, other): &(u32, f64, Distance)| {
            exact::compare(&ray, &distance, other) == Ordering::Less
        };
        if best.as_ref().is_none_or(nearer) {
            best = Some((i as u32, t, distance));
        }
    }
    best.map(|(i, t, _)| (i, t))
}

/// Numbers on a coarse lattice, so that exact coincidences are common, or anything at all.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => (-8_i8..=8).prop_map(|i| f32::from(i) / 4.0),
        3 => -2.0_f32..2.0,
        1 => prop::num::f32::ANY,
        1 => prop_oneof![Just(0.0_f32), Just(-0.0), Just(1e-45), Just(1e-38), Just(1e30), Just(-1e19)],
    ]
}

fn radius() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => (0_i8..=8).prop_map(|i| f32::from(i) / 4.0),
        3 => 0.0_f32..1.5,
        2 => (-126_i32..100).prop_map(|e| (e as f32).exp2()),
        1 => prop::num::f32::ANY,
    ]
}

fn spheres() -> impl Strategy<Value = Vec<Sphere>> {
    let sphere = (coordinate(), coordinate(), coordinate(), radius());
    let duplicated = (prop::collection::vec(sphere, 0..40), 1_usize..3);
    duplicated.prop_map(|(rows, copies)| {
        let rows: Vec<Sphere> = rows.into_iter().map(|(x, y, z, r)| [x, y, z, r]).collect();
        rows.repeat(copies)
    })
}

fn rays() -> impl Strategy<Value = Vec<Ray>> {
    let vector = || [coordinate(), coordinate(), coordinate()];
    prop::collection::vec((vector(), vector(), -120_i32..120), 1..24).prop_map(|rays| {
        rays.into_iter()
            .map(|(origin, direction, exponent)| {
                // Half of the directions have odd lengths.
                let factor = if exponent % 2 == 0 { 1.0 } else { (exponent as f32).exp2() };
                (origin, direction.map(|d| d * factor))
            })
            .collect()
    })
}

fn columns(rays: &[Ray]) -> [Vec<f32>; 6] {
    std::array::from_fn(|i| {
        rays.iter()
            .map(|(origin, direction)| if i < 3 { origin[i] } else { direction[i - 3] })
            .collect()
    })
}

type Traced = (Vec<f64>, Vec<u32>, Vec<Surface>, Tally);

/// Traces rays in columns, and the same in rows.
fn traced(tree: &SphereTree, rays: &[Ray]) -> Traced {
    let hits = |trace: &dyn Fn(Hits) -> Result<Tally, QueryError>| -> Traced {
        let mut t = vec![f64::INFINITY; rays.len()];
        let (mut sphere, mut surface) = (vec![0; rays.len()], vec![Surface::default(); rays.len()]);
        let hits = Hits { t: &mut t, sphere: &mut sphere, surface: Some(&mut surface) };
        let tally = trace(hits).expect("columns agree");
        (t, sphere, surface, tally)
    };
    let [x, y, z, dx, dy, dz] = columns(rays);
    let columns = RayColumns { origin: [&x, &y, &z], direction: [&dx, &dy, &dz] };
    let found = hits(&|hits| tree.intersect_columns(&columns, hits));
    let (origin, direction): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
    let rows = RayRows { origin: &origin, direction: &direction };
    assert_eq!(hits(&|hits| tree.intersect_rows(&rows, hits)), found);
    found
}

/// Checks that a single call with a bound finds what a batch of one ray finds, near a distance and elsewhere.
fn check_bounds(tree: &SphereTree, (origin, direction): Ray, t: f64) {
    let ray = RayRows { origin: &[origin], direction: &[direction] };
    for bound in [0.5 * t, t.next_down(), t, t.next_up(), 1.001 * t, 1e300, 0.0, -1.0, f64::NAN] {
        let (mut t, mut sphere, mut surface) = ([bound], [0], [Surface::default()]);
        let hits = Hits { t: &mut t, sphere: &mut sphere, surface: Some(&mut surface) };
        tree.intersect_rows(&ray, hits).expect("one row of each");
        let expected = (sphere[0] != NOTHING).then_some((sphere[0], t[0], surface[0]));
        let hit = tree.intersect_within(origin, direction, bound);
        let found =
            hit.map(|Hit { sphere, t, point, normal }| (sphere, t, Surface { point, normal }));
        assert_eq!(found, expected, "{origin:?} {direction:?} {bound}");
    }
}

fn check(spheres: &[Sphere], rays: &[Ray]) {
    let tree = SphereTree::from_rows(spheres).expect("few spheres");
    let valid = spheres.iter().filter(|sphere| is_valid(sphere)).count();
    assert_eq!((tree.len(), tree.invalid_spheres()), (valid, spheres.len() - valid));
    let (t, sphere, surface, tally) = traced(&tree, rays);
    let mut invalid = 0;
    for (i, &ray) in rays.iter().enumerate() {
        let finite = ray.0.iter().chain(&ray.1).all(|v| v.is_finite());
        invalid += u64::from(!finite || ray.1 == [0.0; 3]);
        let expected = oracle(spheres, ray);
        let got = (sphere[i] != NOTHING).then_some((sphere[i], t[i]));
        assert_eq!(got.map(|hit| hit.0), expected.map(|hit| hit.0), "{ray:?} {spheres:?}");
        let single = tree.intersect(ray.0, ray.1);
        assert_eq!(single.map(|hit| (hit.sphere, hit.t)), got);
        check_bounds(&tree, ray, t[i]);
        let Some((_, expected)) = expected else {
            assert!(!tree.occluded(ray.0, ray.1, f64::INFINITY));
            continue;
        };
        // An error of 2^-53 of the coordinates shows in t, the more the shorter the chord.
        let [x, y, z, radius] = spheres[sphere[i] as usize].map(f64::from);
        let from_center = wide(ray.0) - DVec3::new(x, y, z);
        let reach = from_center.length() + radius;
        let chord =
            radius.min((from_center + wide(ray.1) * expected).dot(wide(ray.1).normalize()).abs());
        let chord = chord.max((f64::EPSILON * 8.0 * reach * radius).sqrt());
        let unit = f64::EPSILON * reach * (1.0 + radius / chord) / wide(ray.1).length();
        let bound = 8.0 * unit + 1e-15 * expected;
        assert!((t[i] - expected).abs() <= bound, "{} {expected}", t[i]);
        assert!(tree.occluded(ray.0, ray.1, f64::INFINITY));
        assert!(tree.occluded(ray.0, ray.1, expected * 1.0001 + 2.0 * bound));
        assert!(!tree.occluded(ray.0, ray.1, expected * 0.9999 - 2.0 * bound));
        let normal = DVec3::from(surface[i].normal);
        assert!((normal.length() - 1.0).abs() < 1e-12, "{normal}");
        let outward = from_center.length() > radius * (1.0 + 1e-12);
        assert!(!outward || normal.dot(wide(ray.1)) <= 1e-9 * wide(ray.1).length(), "{normal}");
    }
    assert_eq!(tally.invalid, invalid);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn queries_are_exact(spheres in spheres(), rays in rays()) {
        check(&spheres, &rays);
    }
}

/// Rays that touch a sphere or pass it by as little as single precision can say.
#[test]
fn tangents_are_decided_exactly() {
    let unit = [[0.0, 0.0, 0.0, 1.0]];
    let steps = [1.0_f32.next_down(), 1.0, 1.0_f32.next_up()];
    let rays: Vec<Ray> = steps
        .iter()
        .flat_map(|&y| [1.0, 1e-20, 1e20, 0.3].map(|d| ([-4.0, y, 0.0], [d, 0.0, 0.0])))
        .collect();
    check(&unit, &rays);
    // With a lattice of touching spheres, and rays along all its tangents.
    let cell = |i: usize| (i as f32 - 2.0) / 2.0;
    let lattice: Vec<Sphere> =
        (0..125).map(|i| [cell(i % 5), cell(i / 5 % 5), cell(i / 25), 0.25]).collect();
    let rays: Vec<Ray> = (0..400)
        .map(|i| {
            let (y, z) = ((i % 20) as f32 / 8.0 - 1.25, (i / 20) as f32 / 8.0 - 1.25);
            ([-3.0, y, z], [0.125, 0.0, -0.0])
        })
        .collect();
    check(&lattice, &rays);
}

/// A decade at a time, from denormal numbers to the largest.
#[test]
fn scale_does_not_matter() {
    for exponent in (-140..=120).step_by(5) {
        let scale = (exponent as f32).exp2();
        let spheres = [[1.0, 2.0, 3.0, 0.5], [4.0, 2.0, 3.0, 0.5], [2.0, -1.0, 0.5, 0.25]];
        let spheres = spheres.map(|sphere: Sphere| sphere.map(|v| v * scale));
        let rays: Vec<Ray> = [[-3.0, 2.2, 3.1], [1.1, 2.0, 3.0], [9.0, 2.5, 3.0], [2.0, 9.0, 0.5]]
            .into_iter()
            .flat_map(|o| [[1.0, 0.0, 0.01], [-1.0, 0.01, 0.0], [0.0, -1.0, 0.0]].map(|d| (o, d)))
            .map(|(o, d)| (o.map(|v: f32| v * scale), d))
            .collect();
        check(&spheres, &rays);
    }
}

/// Down to where squares of radii underflow beside the largest sphere.
#[test]
fn spheres_may_be_tiny_beside_others() {
    let around = [[-0.5, -0.612_941_86, 0.5], [0.1, -0.5, 2.0], [0.3, 0.4, -0.9], [1.2, 0.0, 0.0]];
    let toward = [[0.0, 0.0, -0.25], [-0.4, 0.1, -1.0], [0.0, -0.9, 0.8], [-1.0, -0.4, 0.1]];
    let rays: Vec<Ray> = around.into_iter().flat_map(|o| toward.map(|d| (o, d))).collect();
    for exponent in 20..=75 {
        let giant = [0.0, 0.0, 0.0, 1.1 * (exponent as f32).exp2()];
        check(&[[0.0, -0.5, -0.076_299_414, 0.75], giant], &rays);
    }
}

/// Origins so far away that single precision cannot even tell the spheres apart.
#[test]
fn distance_does_not_matter() {
    let spheres: Vec<Sphere> = (0..64)
        .map(|i| [(i % 8) as f32, (i / 8) as f32, (i * i % 5) as f32, 0.1 + 0.05 * (i % 7) as f32])
        .collect();
    for exponent in [10, 20, 21, 40, 100] {
        let far = (exponent as f32).exp2();
        let rays: Vec<Ray> = (0..64)
            .map(|i| {
                let (x, y) = ((i % 8) as f32, (i / 8) as f32);
                ([x, y, far], [0.0, 0.0, -1.0])
            })
            .collect();
        check(&spheres, &rays);
    }
}

/// Random spheres in the unit cube.
fn field(count: usize) -> Vec<Sphere> {
    let mut random = Random::new(7);
    let size = 0.8 * (count as f32).cbrt().recip();
    let mut sphere = || [random.single(), random.single(), random.single(), size * random.single()];
    (0..count).map(|_| sphere()).collect()
}

/// Rays in no order: from one point, toward one direction, or any; and some that are no rays, or that single
/// precision cannot hold.
fn disordered(count: usize, one_origin: bool, one_direction: bool) -> Vec<Ray> {
    let mut random = Random::new(3);
    let mut ray = |i: usize| {
        let mut vector = || [0; 3].map(|_| 2.0 * random.single() - 1.0);
        let origin = if one_origin { [0.5, 0.5, 3.0] } else { vector() };
        let target = vector();
        let direction = std::array::from_fn(|axis| 0.5 + 0.5 * target[axis] - origin[axis]);
        let direction = if one_direction { [0.3, 0.2, -1.0] } else { direction };
        match i % 61 {
            0 => ([f32::NAN, 0.0, 0.0], direction),
            1 => (origin, [0.0; 3]),
            2 => (origin, direction.map(|x| x * 1e-35)),
            3 => (origin.map(|x| x * 1e9), direction),
            _ => (origin, direction),
        }
    };
    (0..count).map(&mut ray).collect()
}

#[test]
fn the_order_of_rays_changes_no_answer() {
    // Small trees stay in the caches, so only rays that packets can be made of are sorted there.
    for (spheres, count, one_origin, one_direction) in
        [(2000, 5000, true, false), (2000, 5000, false, true), (40_000, 40_001, false, false)]
    {
        let tree = SphereTree::from_rows(&field(spheres)).expect("few spheres");
        let rays = disordered(count, one_origin, one_direction);
        let (t, sphere, surface, tally) = traced(&tree, &rays);
        assert_eq!(tally.invalid, (0..count).filter(|i| i % 61 < 2).count() as u64);
        let [x, y, z, dx, dy, dz] = columns(&rays);
        let view = RayColumns { origin: [&x, &y, &z], direction: [&dx, &dy, &dz] };
        let bounds: Vec<f64> = (0..count).map(|i| 0.1 * (1 + i % 20) as f64).collect();
        let mut occluded = vec![true; count];
        tree.occluded_columns(&view, &bounds, &mut occluded).expect("columns agree");
        let (origin, direction): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
        let view = RayRows { origin: &origin, direction: &direction };
        let mut by_rows = vec![true; count];
        tree.occluded_rows(&view, &bounds, &mut by_rows).expect("slices agree");
        assert!(occluded == by_rows);
        let mut hits = 0;
        for (i, &(origin, direction)) in rays.iter().enumerate() {
            let alone = tree.intersect(origin, direction);
            hits += usize::from(alone.is_some());
            let answer = alone.map(|hit| (hit.sphere, hit.t, hit.point, hit.normal));
            let Surface { point, normal } = surface[i];
            let found = (sphere[i] != NOTHING).then_some((sphere[i], t[i], point, normal));
            assert_eq!(found, answer, "{i}");
            assert_eq!(occluded[i], tree.occluded(origin, direction, bounds[i]), "{i}");
        }
        assert!(hits > count / 8, "{hits} of {count}");
    }
}

#[test]
fn strays_are_hit_like_other_spheres() {
    let mut random = Random::new(11);
    for size in [1e8_f32, 1e18, 1e30] {
        let mut spheres = field(60);
        // One that encloses all, one that is behind all, one that touches another from afar.
        spheres.insert(7, [0.0, 0.0, 0.0, size]);
        spheres.insert(20, [size, 0.25 * size, 0.5 * size, 0.5 * size]);
        spheres.push([-size, 0.0, 0.0, size - 0.5]);
        let at = |point: [f32; 3], random: &mut Random| point.map(|x| x + 0.1 * random.single());
        let mut rays = Vec::new();
        for i in 0..400 {
            let target = at([random.single(), random.single(), random.single()], &mut random);
            let origin = match i % 5 {
                0 => at([2.0, 2.0, 2.0], &mut random),
                1 => [3.0 * size, 0.1 * size, size],
                2 => [-0.5 * size, size, size],
                3 => [1e5, 2e4, 3e6],
                _ => at([0.2, 0.3, 0.4], &mut random),
            };
            rays.push((origin, std::array::from_fn(|axis| target[axis] - origin[axis])));
        }
        check(&spheres, &rays);
    }
}

#[test]
fn rays_come_from_anywhere() {
    let spheres = field(80);
    let mut random = Random::new(12);
    let mut rays = Vec::new();
    for i in 0..600 {
        let far = (i as f32 / 8.0).exp2();
        let origin = [0; 3].map(|_| far * (2.0 * random.single() - 1.0));
        let target = [0; 3].map(|_| random.single());
        rays.push((origin, std::array::from_fn(|axis| target[axis] - origin[axis])));
    }
    check(&spheres, &rays);
    let tree = SphereTree::from_rows(&spheres).expect("few spheres");
    let hits = |rays: &[Ray]| traced(&tree, rays).1.iter().filter(|&&id| id != NOTHING).count();
    // From farther than single precision can aim, few rays come near the spheres.
    assert!(hits(&rays[..160]) > 80, "{}", hits(&rays[..160]));
    assert!(hits(&rays[160..]) > 0);
}

#[test]
fn columns_of_different_lengths_are_refused() {
    assert!(SphereTree::from_columns(&[0.0], &[0.0], &[], &[1.0]).is_err());
    let tree = SphereTree::from_rows(&[[0.0, 0.0, 0.0, 1.0]]).expect("one sphere");
    let rays = RayColumns { origin: [&[0.0], &[0.0], &[0.0]], direction: [&[1.0], &[0.0], &[]] };
    assert!(tree.occluded_columns(&rays, &[1.0], &mut [false]).is_err());
    let rays = RayRows { origin: &[[0.0; 3]], direction: &[] };
    assert!(tree.occluded_rows(&rays, &[1.0], &mut [false]).is_err());
    let rays = RayRows { origin: &[[0.0; 3]], direction: &[[1.0; 3]] };
    assert!(tree.occluded_rows(&rays, &[1.0], &mut []).is_err());
}
