//! Hits on ellipsoids against an independent reference with 150 decimal places, and closed forms.

use super::*;
use crate::bodies::{BodyTrees, closest, occluded};
use crate::body_rows::{BodyRow, BodyRows};
use crate::bvh::builders::Builder;
use crate::capsules::{CapsuleItem, Capsules};
use crate::exact::{self, Distance};
use crate::fixed::{Fixed, dot, minus, roots, vector};
use crate::intersect::confirm;
use crate::random::Random;
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::spheres::Spheres;
use glam::DMat3;
use std::cmp::Ordering;

/// The hit by the roots of a quadratic without rounding that matters.
fn reference(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Option<Fixed> {
    let rows = ellipsoid.to_unit.map(vector);
    let to_unit = |v: &[Fixed; 3]| -> [Fixed; 3] { std::array::from_fn(|i| dot(&rows[i], v)) };
    let y = to_unit(&minus(&vector(ray.origin), &vector(ellipsoid.center)));
    let w = to_unit(&vector(ray.direction));
    let (zero, one) = (Fixed::new(0.0), Fixed::new(1.0));
    let b = zero.minus(&dot(&y, &w));
    let roots = roots(&dot(&w, &w), &b, &dot(&y, &y).minus(&one))?;
    roots.into_iter().find(|t| *t > zero)
}

fn point(random: &mut Random) -> DVec3 {
    random.in_cube().as_vec3().as_dvec3()
}

fn item(random: &mut Random, id: u32) -> EllipsoidItem {
    let axis = |random: &mut Random| [0.3, 0.03, 3e-4][random.index(3)] * (0.5 + random.unit());
    let semi_axes = DVec3::new(axis(random), axis(random), axis(random));
    let orientation = DQuat::from_axis_angle(random.direction(), random.unit() * 6.0);
    EllipsoidItem::new(point(random).as_vec3(), semi_axes, orientation, id).expect("a valid one")
}

fn stored(item: &EllipsoidItem) -> Ellipsoid {
    Ellipsoid { center: item.center.as_dvec3(), to_unit: item.to_unit.map(Vec3::as_dvec3) }
}

fn from_unit(ellipsoid: &Ellipsoid) -> DMat3 {
    let [x, y, z] = ellipsoid.to_unit;
    DMat3::from_cols(x, y, z).transpose().inverse()
}

/// A ray that is about tangent, or starts at the surface.
fn grazing(random: &mut Random, ellipsoid: &Ellipsoid) -> ExactRay {
    let inverse = from_unit(ellipsoid);
    let normal = random.direction();
    let tangent = normal.cross(random.direction()).normalize();
    let tilt = [0.0, 0.0, 1e-7, 0.3][random.index(4)] * random.unit();
    let direction = (inverse * (tangent - normal * tilt)).normalize();
    let start = [0.0, 1e-4, 1.0, 1e5][random.index(4)];
    let origin = ellipsoid.center + inverse * normal - direction * start;
    ExactRay {
        origin: origin.as_vec3().as_dvec3(),
        direction: direction.as_vec3().as_dvec3(),
        origin_error: 0.0,
    }
}

#[test]
fn hits_are_those_of_150_decimal_places() {
    let mut random = Random::new(21);
    let (mut hits, mut misses, mut exact) = (0, 0, 0);
    for round in 0..40_000 {
        let body = stored(&item(&mut random, 0));
        let ray = if round % 3 == 0 {
            let origin = point(&mut random);
            let target = body.center + from_unit(&body) * point(&mut random);
            let direction = (target - origin).as_vec3().as_dvec3();
            ExactRay { origin, direction, origin_error: 0.0 }
        } else {
            grazing(&mut random, &body)
        };
        let (found, expected) = (intersect(&ray, &body), reference(&ray, &body));
        assert_eq!(found.is_some(), expected.is_some(), "{ray:?} {body:?}");
        let (Some(found), Some(expected)) = (found, expected) else {
            misses += 1;
            continue;
        };
        let expected = expected.to_f64();
        let off = (found.t - expected).abs();
        assert!(off <= found.error + expected * 1e-16, "{found:?} {expected} {ray:?} {body:?}");
        (hits, exact) = (hits + 1, exact + u32::from(found.exact));
    }
    assert!(hits > 15_000 && misses > 5_000 && exact > 1_000, "{hits} {misses} {exact}");
}

#[test]
fn tangents_hit_and_the_next_ray_misses() {
    let axes = DVec3::new(2.0, 1.0, 0.5);
    let body = stored(&EllipsoidItem::new(Vec3::ZERO, axes, DQuat::IDENTITY, 0).unwrap());
    let hit = |origin: [f64; 3], direction: [f64; 3]| {
        let ray =
            ExactRay { origin: origin.into(), direction: direction.into(), origin_error: 0.0 };
        intersect(&ray, &body).map(|root| root.t)
    };
    assert_eq!(hit([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(1.0));
    assert_eq!(hit([-3.0, 0.0, 0.5], [1.0, 0.0, 0.0]), Some(3.0));
    assert_eq!(hit([-3.0, 0.0, 0.5_f64.next_up()], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([2.0, -4.0, 0.0], [0.0, 2.0, 0.0]), Some(2.0));
    assert_eq!(hit([2.0_f64.next_up(), -4.0, 0.0], [0.0, 2.0, 0.0]), None);
    // From the middle, from the surface inward and outward, and away.
    assert_eq!(hit([0.0; 3], [0.0, 0.0, -1.0]), Some(0.5));
    assert_eq!(hit([0.0, 0.0, 0.5], [0.0, 0.0, -1.0]), Some(1.0));
    assert_eq!(hit([0.0, 0.0, 0.5], [0.0, 0.0, 1.0]), None);
    assert_eq!(hit([0.0, 0.0, 0.5], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [0.0; 3]), None);
    assert_eq!(hit([f64::NAN, 0.0, 0.0], [-1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]), None);
}

#[test]
fn equal_axes_are_a_sphere() {
    let mut random = Random::new(22);
    let mut hits = 0;
    for _ in 0..2000 {
        let center = point(&mut random);
        let orientation = [DQuat::IDENTITY, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)];
        let orientation = orientation[random.index(2)];
        let item =
            EllipsoidItem::new(center.as_vec3(), DVec3::splat(0.25), orientation, 0).unwrap();
        let body = stored(&item);
        let ray = grazing(&mut random, &body);
        let (found, sphere) = (intersect(&ray, &body), confirm(&ray, center, 0.25, || false));
        assert_eq!(found.is_some(), sphere.is_some());
        if found.is_some() {
            let distances = (Distance::Ellipsoid(body), Distance::Hit(center, 0.25));
            assert_eq!(exact::compare(&ray, &distances.0, &distances.1), Ordering::Equal);
            hits += 1;
        }
    }
    assert!(hits > 500 && hits < 1900, "{hits}");
}

#[test]
fn boxes_hold_their_ellipsoids_closely() {
    let mut random = Random::new(23);
    for _ in 0..2000 {
        let item = item(&mut random, 0);
        let body = stored(&item);
        let [low, high] = body.extent();
        let inverse = from_unit(&body);
        for axis in 0..3 {
            // The farthest point of an axis is where the normal points along it.
            let farthest = inverse * inverse.row(axis).normalize();
            let half = (high[axis] - low[axis]) * 0.5;
            assert!((half - farthest[axis]).abs() <= 1e-6 * half, "{half} {farthest}");
            assert!(f64::from(item.reach) >= farthest.length());
        }
    }
}

#[test]
fn bad_axes_are_refused() {
    let make = |x: f64| {
        EllipsoidItem::new(Vec3::ZERO, DVec3::new(x, 1.0, 1.0), DQuat::IDENTITY, 0).map(|_| ())
    };
    for x in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        assert_eq!(make(x), Err(BadEllipsoid::Axis), "{x}");
    }
    assert_eq!(make(1.0 / EllipsoidItem::MAX_RATIO), Ok(()));
    assert_eq!(make(0.9 / EllipsoidItem::MAX_RATIO), Err(BadEllipsoid::Ratio));
}

/// Among ellipsoids, two of which are equal, and in half of the rounds spheres and capsules.
#[test]
fn trees_find_the_hits_of_brute_force() {
    let mut random = Random::new(24);
    let mut counts = [0; 3];
    for (round, builder) in (0..12).zip(Builder::ALL.into_iter().cycle()) {
        let mut items: Vec<_> = (0..30).map(|id| item(&mut random, id)).collect();
        // The same body twice: the first is hit.
        items.push(EllipsoidItem { id: 30, ..items[4] });
        let mut spheres = Spheres::with_capacity(8);
        let mut capsules = Vec::new();
        if round % 2 == 0 {
            (0..8).for_each(|id| spheres.push(point(&mut random).as_vec3(), 0.1, id));
            capsules = (0..8)
                .map(|id| {
                    let ends = [0, 1].map(|_| point(&mut random).as_vec3());
                    CapsuleItem { ends, radius: 0.05, id }
                })
                .collect();
        }
        let bvh = crate::bvh::builders::build(&mut spheres, builder);
        let capsules = Capsules::build(&capsules, builder);
        let ellipsoids = Ellipsoids::build(&items, builder);
        let mut rays = Rays::with_capacity(300);
        for _ in 0..300 {
            let near = stored(&items[random.index(items.len())]);
            if random.coin() {
                let ray = grazing(&mut random, &near);
                rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), MISS);
            } else {
                let origin = point(&mut random) * 2.0;
                rays.push(origin.as_vec3(), (near.center - origin).as_vec3(), MISS);
            }
        }
        let (mut hits, mut shadows) = (Hits::with_capacity(300), Hits::with_capacity(300));
        let tree = crate::bvh::Tree { bvh: &bvh, spheres: &spheres };
        crate::bvh::Tracer::default().closest(tree, &rays, &mut hits);
        crate::bvh::Tracer::default().occluded(tree, &rays, &mut shadows);
        // The hits among spheres and capsules are tested elsewhere.
        let mut rest = hits.clone();
        let bodies = BodyTrees {
            spheres: &spheres,
            capsules: &capsules,
            ellipsoids: Some(&ellipsoids),
            cones: None,
        };
        closest(BodyTrees { ellipsoids: None, ..bodies }, &rays, &mut rest);
        closest(bodies, &rays, &mut hits);
        occluded(bodies, &rays, &mut shadows);
        for row in 0..300 {
            let ray = rays.exact(row);
            let first = items
                .iter()
                .filter_map(|item| Some((reference(&ray, &stored(item))?, item.id)))
                .reduce(|a, b| if b.0 < a.0 { b } else { a });
            let other = (rest.sphere[row] != MISS).then_some(rest.t[row]);
            let first = first.filter(|(t, _)| other.is_none_or(|other| t.to_f64() < other));
            assert_eq!(shadows.sphere[row] != MISS, first.is_some() || other.is_some());
            if let Some((t, id)) = first {
                let rows = BodyRows {
                    spheres: spheres.len(),
                    capsules: capsules.len(),
                    ellipsoids: ellipsoids.len(),
                };
                let Some(BodyRow::Ellipsoid(found)) = rows.row(hits.sphere[row]) else {
                    panic!("round {round} row {row}: {}", hits.sphere[row]);
                };
                assert_eq!(ellipsoids.ids()[found], id);
                assert!((hits.t[row] - t.to_f64()).abs() <= t.to_f64() * 1e-8);
                counts[0] += 1;
            } else {
                assert_eq!((hits.t[row], hits.sphere[row]), (rest.t[row], rest.sphere[row]));
                counts[if other.is_some() { 1 } else { 2 }] += 1;
            }
        }
    }
    assert!(counts[0] > 1000 && counts[1] > 50 && counts[2] > 100, "{counts:?}");
}

#[test]
fn the_filter_keeps_what_is_hit() {
    let mut random = Random::new(25);
    let (mut kept, spheres, capsules) = (0, Spheres::default(), Capsules::default());
    for _ in 0..20_000 {
        let item = item(&mut random, 0);
        let ray = grazing(&mut random, &stored(&item));
        if intersect(&ray, &stored(&item)).is_none() {
            continue;
        }
        let ellipsoids = Ellipsoids::build(&[item], Builder::default());
        let mut rays = Rays::with_capacity(1);
        rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), MISS);
        let mut hits = Hits::with_capacity(1);
        let bodies = BodyTrees {
            spheres: &spheres,
            capsules: &capsules,
            ellipsoids: Some(&ellipsoids),
            cones: None,
        };
        closest(bodies, &rays, &mut hits);
        assert_eq!(hits.sphere[0], 0, "{ray:?} {item:?}");
        kept += 1;
    }
    assert!(kept > 5_000, "{kept}");
}

#[test]
fn rays_from_a_surface_do_not_hit_it_and_leave_at_its_far_side() {
    let mut random = Random::new(26);
    let (spheres, capsules) = (Spheres::default(), Capsules::default());
    for _ in 0..2000 {
        let item = item(&mut random, 0);
        let body = stored(&item);
        let ellipsoids = Ellipsoids::build(&[item], Builder::default());
        let [on, toward] = [0, 1].map(|_| from_unit(&body) * random.direction());
        let mut rays = Rays::with_capacity(1);
        rays.push((body.center + on).as_vec3(), (toward - on).normalize().as_vec3(), 0);
        let mut hits = Hits::with_capacity(1);
        let bodies = BodyTrees {
            spheres: &spheres,
            capsules: &capsules,
            ellipsoids: Some(&ellipsoids),
            cones: None,
        };
        closest(bodies, &rays, &mut hits);
        assert_eq!(hits.sphere[0], MISS);
        let exact = ExactRay {
            origin: body.center + on,
            direction: (toward - on).normalize(),
            origin_error: 0.0,
        };
        let (exit, chord) = (exit_distance(&exact, &body), (toward - on).length());
        assert!((exit - chord).abs() <= 1e-6 * chord.max(1e-3), "{exit} {chord}");
        let normal = body.normal(toward);
        let tangent = from_unit(&body) * body.to_unit(toward).cross(random.direction());
        assert!(normal.dot(tangent.normalize()).abs() < 1e-6 && normal.dot(toward) > 0.0);
    }
}

#[test]
fn points_are_enclosed_by_the_first_ellipsoid() {
    let mut random = Random::new(27);
    let items: Vec<_> = (0..40).map(|id| item(&mut random, id)).collect();
    let ellipsoids = Ellipsoids::build(&items, Builder::default());
    let mut inside = 0;
    for round in 0..4000 {
        let body = stored(&items[round % 40]);
        let point = body.center + from_unit(&body) * random.in_cube() * 0.9;
        let contains = |item: &&EllipsoidItem| {
            let body = stored(item);
            (from_unit(&body).inverse() * (point - body.center)).length() < 1.0
        };
        let expected = items.iter().find(contains).map(EllipsoidItem::id);
        let found = ellipsoids.enclosing(point).map(|row| ellipsoids.ids()[row]);
        assert_eq!(found, expected);
        inside += u32::from(found.is_some());
    }
    assert!(inside > 1000, "{inside}");
}
