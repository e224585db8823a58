//! Distances of queries against 120 digits: each is the nearest double, in every regime, and agrees with the
//! bound of the search.

use crate::reference::{Ray, Reference, Sphere};
use glam::{DVec3, Vec3};
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::bvh::{ClosestRounded, Traversal, Tree, trace};
use spherule_core::internals::lanes::{F32x4, F32x8, F32x16};
use spherule_core::internals::random::{Random, direction_past};
use spherule_core::internals::ray::{self, MISS, Rays};
use spherule_core::internals::spheres::Spheres;
use spherule_core::{Hits, NOTHING, RayColumns, SphereTree};
use std::cmp::Ordering;

/// Rays of a regime.
const RAYS: usize = 600;

/// Answers of columns.
struct Answers {
    t: Vec<f64>,
    sphere: Vec<u32>,
}

fn traced(tree: &SphereTree, rays: &[Ray], bounds: &[f64]) -> Answers {
    let columns: [Vec<f32>; 6] = std::array::from_fn(|i| {
        rays.iter().map(|ray| if i < 3 { ray.0[i] } else { ray.1[i - 3] }).collect()
    });
    let [x, y, z, dx, dy, dz] = columns.each_ref().map(Vec::as_slice);
    let columns = RayColumns { origin: [x, y, z], direction: [dx, dy, dz] };
    let mut answers = Answers { t: bounds.to_vec(), sphere: vec![0; rays.len()] };
    let hits = Hits { t: &mut answers.t, sphere: &mut answers.sphere, surface: None };
    tree.intersect_columns(&columns, hits).expect("columns agree");
    answers
}

/// The first hit by 120 digits; of equal ones the first sphere's.
fn first(spheres: &[Sphere], ray: Ray) -> Option<(usize, Reference)> {
    let mut best: Option<(usize, Reference)> = None;
    for (row, sphere) in spheres.iter().enumerate() {
        let Some(hit) = Reference::new(ray, *sphere) else { continue };
        if best.as_ref().is_none_or(|best| hit.is_before(&best.1)) {
            best = Some((row, hit));
        }
    }
    best
}

/// Bounds of a search around a distance: its neighbors, and up to 1e-14 away.
fn bounds_around(t: f64, random: &mut Random) -> [f64; 8] {
    let near = |random: &mut Random| t * (1.0 + random.sign() * random.decades([-17.0, -14.0]));
    let [a, b, c, d] = std::array::from_fn(|_| near(random));
    [t.next_down(), t, t.next_up(), t.next_up().next_up(), a, b, c, d]
}

/// Checks rays in a scene against the reference. Returns the number of hits.
#[track_caller]
fn check(name: &str, spheres: &[Sphere], rays: &[Ray], random: &mut Random) -> usize {
    let tree = SphereTree::from_rows(spheres).expect("few spheres");
    let answers = traced(&tree, rays, &vec![f64::INFINITY; rays.len()]);
    let (mut bounded, mut bounds, mut known) = (Vec::new(), Vec::new(), Vec::new());
    for (i, &ray) in rays.iter().enumerate() {
        let expected = first(spheres, ray);
        let found = (answers.sphere[i] != NOTHING).then_some((answers.sphere[i], answers.t[i]));
        let single = tree.intersect(ray.0, ray.1).map(|hit| (hit.sphere, hit.t));
        let Some((sphere, hit)) = expected else {
            assert_eq!((found, single), (None, None), "{name}: {ray:?} {spheres:?}");
            continue;
        };
        let nearest = hit.nearest();
        let right = Some((sphere as u32, nearest));
        let context = || format!("{name}: {ray:?} {spheres:?}");
        assert_eq!(found, right, "{}, error {:?}", context(), found.map(|x| hit.error(x.1)));
        assert_eq!(single, right, "{}, error {:?}", context(), single.map(|x| hit.error(x.1)));
        for bound in bounds_around(nearest, random) {
            let nearer = hit.compare(bound) == Ordering::Less;
            assert_eq!(tree.occluded(ray.0, ray.1, bound), nearer, "{} {bound:e}", context());
            bounded.push(ray);
            bounds.push(bound);
            known.push(nearer.then_some((sphere as u32, nearest)));
        }
    }
    let answers = traced(&tree, &bounded, &bounds);
    for (i, known) in known.iter().enumerate() {
        let found = (answers.sphere[i] != NOTHING).then_some((answers.sphere[i], answers.t[i]));
        assert_eq!(found, *known, "{name}: {:?} {:e} {spheres:?}", bounded[i], bounds[i]);
        assert!(answers.t[i] <= bounds[i], "{name}: {:?} {:e}", bounded[i], bounds[i]);
    }
    known.len() / 8
}

fn point(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

fn row(center: DVec3, radius: f64) -> Sphere {
    let [x, y, z] = point(center);
    [x, y, z, radius as f32]
}

fn center_and_radius([x, y, z, radius]: Sphere) -> (DVec3, f64) {
    (DVec3::new(x.into(), y.into(), z.into()), radius.into())
}

/// A ray from a point toward a sphere: through it, or past its limb by a part of the radius.
fn toward(origin: DVec3, sphere: Sphere, limb: Option<[f64; 2]>, random: &mut Random) -> Ray {
    let origin = origin.as_vec3().as_dvec3();
    let (center, radius) = center_and_radius(sphere);
    let aside = match limb {
        Some(decades) => 1.0 + random.sign() * random.decades(decades),
        None => random.unit(),
    };
    (point(origin), point(direction_past(center - origin, radius * aside, random)))
}

#[test]
fn ordinary_distances_are_the_nearest_doubles() {
    let mut random = Random::new(1);
    let spheres: Vec<_> =
        (0..60).map(|_| row(random.in_cube(), random.between([0.05, 0.3]))).collect();
    let rays: Vec<Ray> =
        (0..RAYS).map(|_| (point(random.in_cube()), point(random.direction()))).collect();
    assert!(check("ordinary", &spheres, &rays, &mut random) > RAYS / 2);
}

#[test]
fn distances_near_a_huge_sphere_are_the_nearest_doubles() {
    for (radius, seed) in [(1e5, 2), (1e7, 3)] {
        let mut random = Random::new(seed);
        let giant = row(DVec3::new(0.0, -radius, 0.0), radius);
        let (center, radius) = center_and_radius(giant);
        let spheres = [giant, [0.0, 1.0, 0.0, 1.0], [2.0, 0.25, -1.0, 0.25]];
        let rays: Vec<Ray> = (0..RAYS)
            .map(|i| {
                let up = (random.in_cube() * 10.0 - center).normalize();
                // On the surface but for rounding, or above it, or below.
                let height = [0.0, 1.0, -1.0][i % 3] * random.decades([-6.0, 1.0]);
                let direction = random.direction() + up * [0.0, 1.0, -1.0][i / 3 % 3];
                (point(center + up * (radius + height)), point(direction))
            })
            .collect();
        assert!(check("huge", &spheres, &rays, &mut random) > RAYS / 2);
    }
}

#[test]
fn distances_of_tangents_are_the_nearest_doubles() {
    let mut random = Random::new(4);
    let spheres: Vec<_> =
        (0..8).map(|_| row(random.in_cube(), random.between([0.05, 0.3]))).collect();
    let rays: Vec<Ray> = (0..RAYS)
        .map(|i| {
            let target = spheres[i % 8];
            let (center, radius) = center_and_radius(target);
            let origin = center + random.direction() * (radius * random.decades([0.1, 4.0]));
            toward(origin, target, Some([-9.0, -1.0]), &mut random)
        })
        .collect();
    assert!(check("tangents", &spheres, &rays, &mut random) > RAYS / 4);
    // Exact ones, and their neighbors.
    let cell = |i: usize| (i as f32 - 2.0) / 2.0;
    let lattice: Vec<Sphere> =
        (0..27).map(|i| [cell(i % 3), cell(i / 3 % 3), cell(i / 9), 0.25]).collect();
    let rays: Vec<Ray> = (0..300)
        .map(|i| {
            let (y, z) = ((i % 12) as f32 / 8.0 - 1.25, (i / 12 % 8) as f32 / 8.0 - 1.25);
            let y = [y, y.next_up(), y.next_down()][i / 96 % 3];
            ([-3.0, y, z], [0.125, 0.0, -0.0])
        })
        .collect();
    assert!(check("exact tangents", &lattice, &rays, &mut random) > 30);
}

#[test]
fn distances_of_far_spheres_are_the_nearest_doubles() {
    let mut random = Random::new(5);
    for exponent in [4, 8, 12, 16, 19, 20, 21, 24, 40, 90] {
        let far = 2_f64.powi(exponent);
        let spheres: Vec<_> =
            (0..6).map(|_| row(random.in_cube(), random.between([0.2, 0.6]))).collect();
        let rays: Vec<Ray> = (0..RAYS / 6)
            .map(|i| {
                let target = spheres[i % 6];
                let (center, _) = center_and_radius(target);
                if exponent > 24 {
                    // Farther than a direction can aim, but along an axis.
                    let mut origin = center;
                    origin[i % 3] = far;
                    return (point(origin), point(-DVec3::AXES[i % 3]));
                }
                let limb = [None, Some([-7.0, -1.0])][i % 2];
                toward(center + random.direction() * far, target, limb, &mut random)
            })
            .collect();
        check("far", &spheres, &rays, &mut random);
    }
}

#[test]
fn distances_in_long_and_short_directions_are_the_nearest_doubles() {
    let mut random = Random::new(6);
    let spheres: Vec<_> =
        (0..20).map(|_| row(random.in_cube(), random.between([0.05, 0.3]))).collect();
    let rays: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let length = random.decades([-44.0, 38.0]);
            let [x, y, z] = random.direction().to_array().map(|x| (x * length) as f32);
            (point(random.in_cube()), [x, y, z])
        })
        .filter(|ray| ray.1 != [0.0; 3])
        .collect();
    assert!(check("directions", &spheres, &rays, &mut random) > RAYS / 6);
}

#[test]
fn distances_at_any_scale_are_the_nearest_doubles() {
    let mut random = Random::new(7);
    for exponent in [-149, -140, -120, -60, 60, 100, 120] {
        let scale = 2_f64.powi(exponent);
        let spheres: Vec<_> = (0..20)
            .map(|_| row(random.in_cube() * (64.0 * scale), random.between([4.0, 19.0]) * scale))
            .collect();
        let rays: Vec<Ray> = (0..RAYS / 6)
            .map(|_| (point(random.in_cube() * (64.0 * scale)), point(random.direction())))
            .collect();
        assert!(check("scales", &spheres, &rays, &mut random) > 10);
    }
}

/// Coordinates that are nearly 0, as a rotation leaves them.
#[test]
fn distances_beside_coordinates_of_noise_are_the_nearest_doubles() {
    let mut random = Random::new(8);
    let noise = |random: &mut Random| random.sign() * random.decades([-30.0, -8.0]);
    let spheres: Vec<_> = (0..30)
        .map(|_| {
            let mut center = random.in_cube();
            center[random.index(3)] = noise(&mut random);
            row(center, random.between([0.05, 0.3]))
        })
        .collect();
    let rays: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let (mut origin, mut direction) = (random.in_cube(), random.direction());
            origin[random.index(3)] = noise(&mut random);
            direction[random.index(3)] = noise(&mut random);
            (point(origin), point(direction))
        })
        .collect();
    assert!(check("noise", &spheres, &rays, &mut random) > RAYS / 4);
}

/// Sizes that differ by any power of two within single precision.
#[test]
fn distances_between_spheres_of_any_size_are_the_nearest_doubles() {
    let mut random = Random::new(9);
    for _ in 0..60 {
        let any = |random: &mut Random| random.decades([-44.0, 38.0]);
        let sphere = |random: &mut Random| {
            let center = random.direction() * any(random);
            row(center, any(random).max(1e-44))
        };
        let spheres: Vec<_> = (0..6).map(|_| sphere(&mut random)).collect();
        let rays: Vec<Ray> = (0..12)
            .map(|i| {
                let target = spheres[i % 6];
                let (center, radius) = center_and_radius(target);
                let limb = [None, Some([-9.0, -1.0])][i % 2];
                let origin = center + random.direction() * (radius * random.decades([-1.0, 3.0]));
                let origin = origin.clamp(DVec3::splat(-3e38), DVec3::splat(3e38));
                toward(origin, target, limb, &mut random)
            })
            .collect();
        check("any size", &spheres, &rays, &mut random);
    }
}

/// A sphere of 1e38 beside ones whose coordinates are small multiples of the least number: exact tangents and
/// equal distances are common, and the scene spans 2^276.
#[test]
fn both_ends_of_the_range_in_one_scene_are_decided_exactly() {
    /// Directions and their normals, all of one length, which is an integer.
    const TANGENTS: [([f32; 3], [f32; 3], f32); 3] = [
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0),
        ([3.0, 4.0, 0.0], [-4.0, 3.0, 0.0], 5.0),
        ([2.0, 6.0, -3.0], [6.0, -3.0, -2.0], 7.0),
    ];
    let mut random = Random::new(10);
    let mut hits = 0;
    for scene in 0..80 {
        let unit = f32::from_bits(1 << (scene % 4));
        let integer =
            |random: &mut Random, most: usize| random.index(2 * most + 1) as f32 - most as f32;
        // So many digits that quotients and roots are rounded.
        let long = |random: &mut Random| {
            let factor = (2 * random.index(1 << 19) + 1) as f32;
            factor * 2_f32.powi(random.index(200) as i32 - 120)
        };
        let giant = row(random.direction() * 1e38, random.between([0.5, 2.0]) * 1e38);
        let mut spheres = vec![giant];
        let mut rays: Vec<Ray> = Vec::new();
        for i in 0..6 {
            let (direction, normal, length) = TANGENTS[i % 3];
            let center: [f32; 3] = std::array::from_fn(|_| integer(&mut random, 300));
            let multiple = 1.0 + random.index(2) as f32;
            let [x, y, z] = center.map(|x| x * unit);
            spheres.push([x, y, z, length * multiple * unit]);
            for step in [-1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] {
                let (away, factor) = (random.index(100) as f32, long(&mut random));
                let origin = std::array::from_fn(|k| {
                    let aside = if k == i / 3 { step } else { 0.0 };
                    (center[k] - direction[k] * away + normal[k] * multiple + aside) * unit
                });
                rays.push((origin, direction.map(|x| x * factor)));
            }
        }
        for i in 0..40 {
            let target = spheres[1 + i % 6];
            let origin: [f32; 3] = std::array::from_fn(|_| integer(&mut random, 400) * unit);
            let (center, radius) = center_and_radius(target);
            let limb = [None, Some([-9.0, -1.0])][i % 2];
            let aside = limb.map_or(random.unit(), |x| 1.0 + random.sign() * random.decades(x));
            let to = center - DVec3::from(origin.map(f64::from));
            let direction = direction_past(to, radius * aside, &mut random);
            let factor = long(&mut random);
            rays.push((origin, point(direction).map(|x| x * factor)));
        }
        rays.retain(|ray| ray.1 != [0.0; 3]);
        hits += check("both ends", &spheres, &rays, &mut random);
    }
    assert!(hits > 2000, "{hits}");
}

/// With the short way to round and without, one by one and in packets of every width.
#[test]
fn distances_do_not_depend_on_traversal_or_width() {
    let mut random = Random::new(11);
    let mut spheres = Spheres::with_capacity(300);
    let coarse = |v: DVec3| (v * 1024.0).round().as_vec3() / 1024.0;
    for i in 0..300 {
        spheres.push(coarse(random.in_cube()), random.between([0.01, 0.2]) as f32, i);
    }
    let bvh = build(&mut spheres, Builder::default());
    let mut rays = Rays::with_capacity(500);
    for i in 0..500 {
        // Half of them coherent.
        let origin = if i < 250 { Vec3::new(0.0, 0.0, -4.0) } else { coarse(random.in_cube()) };
        let spread = if i < 250 { 0.1 } else { 3.0 };
        let direction = random.in_cube() * spread + DVec3::Z;
        let direction = (direction / direction.abs().max_element() * 1.5).as_vec3();
        rays.push(origin, direction, MISS);
    }
    let nearest: Vec<_> = (0..rays.len())
        .map(|i| {
            let ray = (rays.origin.row(i).to_array(), rays.direction.row(i).to_array());
            let hits = (0..spheres.len()).filter_map(|row| {
                let [x, y, z] = spheres.center(row).to_array();
                Some(Reference::new(ray, [x, y, z, spheres.radius(row)])?.nearest())
            });
            hits.fold(f64::INFINITY, f64::min)
        })
        .collect();
    assert!(nearest.iter().filter(|t| t.is_finite()).count() > 250);
    let all = [
        Traversal::Brute,
        Traversal::Single,
        Traversal::Stream,
        Traversal::Packet,
        Traversal::Auto,
    ];
    for (is_coarse, traversal) in all.into_iter().flat_map(|way| [(false, way), (true, way)]) {
        spheres.coarse = is_coarse;
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        for width in [1, 4, 8, 16] {
            let mut hits = ray::Hits::with_capacity(rays.len());
            match width {
                1 => trace::<f32, ClosestRounded>(traversal, tree, &rays, &mut hits),
                4 => trace::<F32x4, ClosestRounded>(traversal, tree, &rays, &mut hits),
                8 => trace::<F32x8, ClosestRounded>(traversal, tree, &rays, &mut hits),
                _ => trace::<F32x16, ClosestRounded>(traversal, tree, &rays, &mut hits),
            };
            assert_eq!(hits.t[..rays.len()], nearest, "{traversal:?} {width} {is_coarse}");
        }
    }
}
