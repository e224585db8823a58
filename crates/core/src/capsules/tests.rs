//! Hits on capsules against an independent reference with 150 decimal places, and closed forms.

use super::*;
use crate::bodies::{BodyTrees, closest, occluded};
use crate::body_rows::{BodyRow, BodyRows};
use crate::bvh::builders::Builder;
use crate::fixed::{Fixed, PLACES, dot, minus, roots, vector};
use crate::random::Random;
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::spheres::Spheres;
use num_bigint::BigInt;

/// Where a line enters and leaves the union of two spheres and the cylinder between them: the least and the greatest root
/// of all three.
fn crossings(ray: &ExactRay, capsule: &Capsule) -> Option<[Fixed; 2]> {
    let (o, d) = (vector(ray.origin), vector(ray.direction));
    let ends = capsule.ends.map(vector);
    let radius2 = Fixed::new(capsule.radius).times(&Fixed::new(capsule.radius));
    let mut all: Vec<Fixed> = Vec::new();
    for end in &ends {
        let from = minus(&o, end);
        let b = Fixed::new(0.0).minus(&dot(&from, &d));
        all.extend(
            roots(&dot(&d, &d), &b, &dot(&from, &from).minus(&radius2)).into_iter().flatten(),
        );
    }
    let (axis, from) = (minus(&ends[1], &ends[0]), minus(&o, &ends[0]));
    let length2 = dot(&axis, &axis);
    let across = |v: &[Fixed; 3]| -> [Fixed; 3] {
        let along = dot(v, &axis).over(&length2);
        std::array::from_fn(|i| v[i].minus(&along.times(&axis[i])))
    };
    if length2 > Fixed::new(0.0) {
        let (from, d) = (across(&from), across(&d));
        let b = Fixed::new(0.0).minus(&dot(&from, &d));
        let crossed = roots(&dot(&d, &d), &b, &dot(&from, &from).minus(&radius2));
        all.extend(crossed.into_iter().flatten().filter(|t| {
            let at: [Fixed; 3] = std::array::from_fn(|i| {
                o[i].plus(&t.times(&vector(ray.direction)[i])).minus(&ends[0][i])
            });
            let height = dot(&at, &axis);
            !height.is_negative() && height <= length2
        }));
    }
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    Some([all.first()?.clone(), all.last()?.clone()])
}

fn reference(ray: &ExactRay, capsule: &Capsule) -> Option<f64> {
    let [enter, leave] = crossings(ray, capsule)?;
    let zero = Fixed::new(0.0);
    [enter, leave].into_iter().find(|t| *t > zero).map(|t| t.to_f64())
}

fn point(random: &mut Random) -> DVec3 {
    random.in_cube().as_vec3().as_dvec3()
}

/// A ray that is about to miss: tangent to the body or to an end, along the axis, through the crease between them, or from
/// the surface.
fn grazing(random: &mut Random, capsule: &Capsule) -> ExactRay {
    let axis = (capsule.ends[1] - capsule.ends[0]).normalize_or(DVec3::X);
    let normal = axis.cross(random.direction()).normalize();
    let along = [0.0, 1.0, random.unit()][random.index(3)];
    let on = capsule.ends[0].lerp(capsule.ends[1], along) + normal * capsule.radius;
    let around = axis.cross(normal);
    let direction = match random.index(5) {
        0 => around,
        1 => axis,
        2 => around * random.unit() + axis * random.unit(),
        3 => random.direction(),
        _ => axis + normal * 1e-6 * random.unit(),
    };
    let start = [0.0, 1e-4, 1.0, 1e5][random.index(4)];
    ExactRay {
        origin: (on - direction * start).as_vec3().as_dvec3(),
        direction: direction.as_vec3().as_dvec3(),
        origin_error: 0.0,
    }
}

fn capsule(random: &mut Random) -> Capsule {
    let start = point(random);
    let length = [1.0, 0.1, 1e-3, 0.0][random.index(4)];
    let end = (start + point(random) * length).as_vec3().as_dvec3();
    let radius = [0.3, 0.01, 1e-4][random.index(3)] as f32;
    Capsule { ends: [start, end], radius: f64::from(radius) }
}

fn item(capsule: &Capsule) -> CapsuleItem {
    let radius = capsule.radius as f32;
    CapsuleItem { ends: capsule.ends.map(DVec3::as_vec3), radius, id: 0 }
}

#[test]
fn hits_are_those_of_150_decimal_places() {
    let mut random = Random::new(11);
    let (mut hits, mut exact, mut close) = (0, 0, 0);
    for round in 0..60_000 {
        let capsule = capsule(&mut random);
        let ray = if round % 3 == 0 {
            let (origin, target) = (point(&mut random), point(&mut random));
            let direction = (target * 0.3 + capsule.ends[0] * 0.7 - origin).as_vec3().as_dvec3();
            ExactRay { origin, direction, origin_error: 0.0 }
        } else {
            grazing(&mut random, &capsule)
        };
        let (found, expected) = (intersect(&ray, &capsule), reference(&ray, &capsule));
        assert_eq!(found.is_some(), expected.is_some(), "{ray:?} {capsule:?}");
        let (Some(found), Some(expected)) = (found, expected) else { continue };
        let off = (found.root.t - expected).abs();
        assert!(off <= found.root.error + expected * 1e-16, "{found:?} {expected} {ray:?}");
        (hits, exact) = (hits + 1, exact + u32::from(found.root.exact));
        close += u32::from(round % 3 != 0);
    }
    assert!(hits > 25_000 && close > 12_000 && exact > 1_000, "{hits} {close} {exact}");
}

#[test]
fn tangents_hit_and_the_next_ray_misses() {
    let capsule = Capsule { ends: [DVec3::new(-1.0, 0.0, 0.0), DVec3::X], radius: 0.5 };
    let hit = |origin: [f64; 3], direction: [f64; 3]| {
        let ray =
            ExactRay { origin: origin.into(), direction: direction.into(), origin_error: 0.0 };
        intersect(&ray, &capsule).map(|hit| (hit.root.t, hit.part))
    };
    let up = 0.5_f64.next_up();
    // Across the body, and over it.
    assert_eq!(hit([0.25, 0.5, -3.0], [0.0, 0.0, 1.0]), Some((3.0, Part::Body)));
    assert_eq!(hit([0.25, up, -3.0], [0.0, 0.0, 1.0]), None);
    // Along the body.
    assert_eq!(hit([-3.0, 0.5, 0.0], [2.0, 0.0, 0.0]), Some((1.0, Part::End(0))));
    assert_eq!(hit([3.0, 0.5, 0.0], [-2.0, 0.0, 0.0]), Some((1.0, Part::End(1))));
    assert_eq!(hit([-3.0, up, 0.0], [2.0, 0.0, 0.0]), None);
    // The crease belongs to the body.
    assert_eq!(hit([1.0, 3.0, 0.0], [0.0, -1.0, 0.0]), Some((2.5, Part::Body)));
    // From the middle, from the surface inward and outward, and away.
    assert_eq!(hit([0.0; 3], [-1.0, 0.0, 0.0]), Some((1.5, Part::End(0))));
    assert_eq!(hit([0.0, 0.5, 0.0], [0.0, -1.0, 0.0]), Some((1.0, Part::Body)));
    assert_eq!(hit([0.0, 0.5, 0.0], [0.0, 1.0, 0.0]), None);
    assert_eq!(hit([0.0, 0.5, 0.0], [1.0, 0.0, 0.0]), Some((1.0, Part::End(1))));
    assert_eq!(hit([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [0.0; 3]), None);
    assert_eq!(hit([f64::NAN, 0.0, 0.0], [-1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]), None);
}

/// Spheres, capsules about some of them with equal radii, and rays.
fn scene(random: &mut Random, count: usize) -> (Spheres, Vec<CapsuleItem>) {
    let centers: Vec<Vec3> = (0..count).map(|_| point(random).as_vec3()).collect();
    let mut spheres = Spheres::with_capacity(count);
    for (id, &center) in centers.iter().enumerate().take(count / 2) {
        spheres.push(center, 0.04, id as u32);
    }
    let rows = (0..2 * count).map(|id| {
        let ends = [0, 1].map(|_| centers[random.index(count)]);
        let near = ends[0] + (ends[1] - ends[0]).clamp_length_max(0.3);
        let ends = if random.coin() { ends } else { [ends[0], near] };
        CapsuleItem { ends, radius: [0.04, 0.01][random.index(2)], id: id as u32 }
    });
    let rows = rows.collect();
    (spheres, rows)
}

/// The hit of a ray by brute force with the reference: the distance, and whether a sphere is hit, or the id of the capsule.
fn brute(
    ray: &ExactRay,
    spheres: &Spheres,
    rows: &[CapsuleItem],
    own: Option<u32>,
) -> Option<(Fixed, usize)> {
    let sphere = |i: usize| {
        let (center, radius) = spheres.exact(i);
        Capsule { ends: [center; 2], radius }
    };
    let capsule = |&CapsuleItem { ends, radius, .. }: &CapsuleItem| Capsule {
        ends: ends.map(Vec3::as_dvec3),
        radius: f64::from(radius),
    };
    let bodies = (0..spheres.len()).map(sphere).enumerate().chain(
        rows.iter()
            .filter(|row| Some(row.id) != own)
            .map(|row| (spheres.len() + row.id as usize, capsule(row))),
    );
    let first = |body: &Capsule| {
        crossings(ray, body).and_then(|all| all.into_iter().find(|t| *t > Fixed::new(0.0)))
    };
    let hits = bodies.filter_map(|(number, body)| Some((first(&body)?, number)));
    // Equal roots of different formulas agree to almost all places.
    let least = BigInt::from(1) << (PLACES / 4);
    hits.reduce(|a, b| if &a.0.0 - &b.0.0 > least { b } else { a })
}

#[test]
fn trees_find_the_hits_of_brute_force() {
    let mut random = Random::new(5);
    let (mut by_sphere, mut by_capsule, mut none) = (0, 0, 0);
    for (round, builder) in (0..12).zip(Builder::ALL.into_iter().cycle()) {
        let (mut spheres, rows) = scene(&mut random, 20);
        let bvh = crate::bvh::builders::build(&mut spheres, builder);
        let capsules = Capsules::build(&rows, builder);
        let mut rays = Rays::with_capacity(200);
        for _ in 0..200 {
            let toward = rows[random.index(rows.len())].ends[0].as_dvec3();
            let origin = point(&mut random) * 2.0;
            let aim = if random.coin() { toward } else { point(&mut random) };
            rays.push(origin.as_vec3(), (aim - origin).as_vec3(), MISS);
        }
        let (mut hits, mut shadows) = (Hits::with_capacity(200), Hits::with_capacity(200));
        let tree = crate::bvh::Tree { bvh: &bvh, spheres: &spheres };
        crate::bvh::Tracer::default().closest(tree, &rays, &mut hits);
        crate::bvh::Tracer::default().occluded(tree, &rays, &mut shadows);
        let bodies =
            BodyTrees { spheres: &spheres, capsules: &capsules, ellipsoids: None, cones: None };
        closest(bodies, &rays, &mut hits);
        occluded(bodies, &rays, &mut shadows);
        for row in 0..200 {
            let ray = rays.exact(row);
            let rows_of =
                BodyRows { spheres: spheres.len(), capsules: capsules.len(), ellipsoids: 0 };
            let by_id = |hit: u32| match rows_of.row(hit) {
                Some(BodyRow::Capsule(hit)) => spheres.len() + capsules.ids()[hit.capsule] as usize,
                _ => spheres.id[hit as usize] as usize,
            };
            let found = (hits.sphere[row] != MISS).then(|| (hits.t[row], by_id(hits.sphere[row])));
            let mut by_order = Spheres::with_capacity(spheres.len());
            let mut order: Vec<usize> = (0..spheres.len()).collect();
            order.sort_by_key(|&i| spheres.id[i]);
            for &i in &order {
                by_order.push(spheres.center(i), spheres.radius(i), 0);
            }
            let expected = brute(&ray, &by_order, &rows, None);
            assert_eq!(
                found.map(|f| f.1),
                expected.as_ref().map(|e| e.1),
                "round {round} row {row}"
            );
            assert_eq!(shadows.sphere[row] != MISS, expected.is_some());
            match found {
                None => none += 1,
                Some((t, number)) => {
                    let expected = expected.unwrap().0.to_f64();
                    assert!((t - expected).abs() <= t * 1e-5);
                    *(if number < spheres.len() { &mut by_sphere } else { &mut by_capsule }) += 1;
                }
            }
        }
    }
    assert!(by_sphere > 80 && by_capsule > 500 && none > 100, "{by_sphere} {by_capsule} {none}");
}

#[test]
fn the_filter_keeps_what_is_hit() {
    let mut random = Random::new(8);
    let mut kept = 0;
    for _ in 0..20_000 {
        let body = capsule(&mut random);
        let ray = grazing(&mut random, &body);
        let capsules = Capsules::build(&[item(&body)], Builder::default());
        if intersect(&ray, &body).is_none() {
            continue;
        }
        let mut rays = Rays::with_capacity(1);
        rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), MISS);
        let mut hits = Hits::with_capacity(1);
        let spheres = Spheres::default();
        closest(
            BodyTrees { spheres: &spheres, capsules: &capsules, ellipsoids: None, cones: None },
            &rays,
            &mut hits,
        );
        assert!(hits.sphere[0] < 2, "{ray:?} {body:?}");
        kept += 1;
    }
    assert!(kept > 5_000, "{kept}");
}

#[test]
fn rays_from_a_surface_do_not_hit_it() {
    let mut random = Random::new(9);
    let spheres = Spheres::default();
    for _ in 0..2000 {
        let body = capsule(&mut random);
        let capsules = Capsules::build(&[item(&body)], Builder::default());
        let normal = random.direction();
        let along = random.unit();
        let axis = body.ends[1] - body.ends[0];
        let across = normal - axis * (normal.dot(axis) / axis.length_squared().max(1e-30));
        let on = body.ends[0] + axis * along + across.normalize() * body.radius;
        for own in [0, 1] {
            let mut rays = Rays::with_capacity(1);
            rays.push(on.as_vec3(), random.direction().as_vec3(), own);
            let mut hits = Hits::with_capacity(1);
            closest(
                BodyTrees { spheres: &spheres, capsules: &capsules, ellipsoids: None, cones: None },
                &rays,
                &mut hits,
            );
            assert_eq!(hits.sphere[0], MISS);
        }
    }
}

/// From surface to surface, through the crease between cylinder and end, where double precision is in doubt.
#[test]
fn rays_leave_at_the_far_side() {
    let mut random = Random::new(15);
    let mut chords = 0;
    for _ in 0..4000 {
        let ends = [0, 1].map(|_| point(&mut random));
        let capsule = Capsule { ends, radius: 0.1 };
        let mut crease = |along: f64| {
            let normal = random.perpendicular((ends[1] - ends[0]).normalize());
            (ends[0].lerp(ends[1], along) + normal * capsule.radius, normal)
        };
        let ((on, _), (toward, normal)) = (crease(0.3), crease(1.0));
        let chord = (toward - on).length();
        let direction = (toward - on) / chord;
        if direction.dot(normal) < 0.01 {
            continue;
        }
        let ray = ExactRay { origin: on, direction, origin_error: 0.0 };
        let exit = exit_distance(&ray, &capsule);
        assert!((exit - chord).abs() < 1e-6 * chord, "{exit} {chord}");
        chords += 1;
    }
    assert!(chords > 1000, "{chords}");
}

#[test]
fn points_are_enclosed_by_the_first_capsule() {
    let mut random = Random::new(10);
    let (_, rows) = scene(&mut random, 30);
    let capsules = Capsules::build(&rows, Builder::default());
    let mut inside = 0;
    for _ in 0..5000 {
        let point = point(&mut random) * 0.7;
        let contains = |CapsuleItem { ends, radius, .. }: &&CapsuleItem| {
            let ends = ends.map(Vec3::as_dvec3);
            let axis = ends[1] - ends[0];
            let along = (point - ends[0]).dot(axis) / axis.length_squared().max(1e-300);
            let nearest = ends[0] + axis * along.clamp(0.0, 1.0);
            nearest.distance(point) < f64::from(*radius)
        };
        let expected = rows.iter().find(contains).map(|row| row.id);
        let found = capsules.enclosing(point).map(|row| capsules.ids()[row]);
        assert_eq!(found, expected);
        inside += u32::from(found.is_some());
    }
    assert!(inside > 50, "{inside}");
}
