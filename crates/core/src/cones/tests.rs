//! Hits on cones against an independent reference with 150 decimal places, and closed forms.

use super::*;
use crate::bodies::{BodyTrees, closest, occluded};
use crate::body_rows::{BodyRow, BodyRows};
use crate::bvh::builders::Builder;
use crate::capsules::{CapsuleItem, Capsules};
use crate::ellipsoids::{EllipsoidItem, Ellipsoids};
use crate::fixed::{Fixed, Vector, dot, minus, vector};
use crate::random::Random;
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::spheres::Spheres;
use glam::DQuat;
use num_bigint::BigInt;

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

/// What the reference takes for 0: more than its own rounding, and less than anything else.
fn nothing() -> Fixed {
    Fixed(BigInt::from(1) << 112)
}

/// The hit: all points where the line crosses the side, the base or the apex, of which the first and the last bound the cone.
fn reference(ray: &ExactRay, cone: &Cone) -> Option<Fixed> {
    let (zero, two) = (Fixed::new(0.0), Fixed::new(2.0));
    let none = nothing();
    let is_zero = |x: &Fixed| *x <= none && *x >= zero.minus(&none);
    let (d, apex) = (vector(ray.direction), vector(cone.apex));
    let (from, axis) = (minus(&vector(ray.origin), &apex), minus(&vector(cone.base), &apex));
    let radius2 = Fixed::new(cone.radius).times(&Fixed::new(cone.radius));
    let height2 = dot(&axis, &axis);
    let at = |t: &Fixed| -> Vector { std::array::from_fn(|i| from[i].plus(&d[i].times(t))) };
    // |P x v|^2 v.v = r^2 (P.v)^2 on the side.
    let form = |a: &Vector, b: &Vector| {
        let across = dot(&cross(a, &axis), &cross(b, &axis)).times(&height2);
        across.minus(&radius2.times(&dot(a, &axis)).times(&dot(b, &axis)))
    };
    let (a, b, c) = (form(&d, &d), form(&d, &from), form(&from, &from));
    let mut side = Vec::new();
    if !is_zero(&a) {
        let discriminant = b.times(&b).minus(&a.times(&c));
        if discriminant >= zero.minus(&none) {
            let root = if discriminant < zero { zero.clone() } else { discriminant.root() };
            for root in [root.clone(), zero.minus(&root)] {
                side.push(root.minus(&b).over(&a));
            }
        }
    } else if !is_zero(&b) {
        side.push(zero.minus(&c).over(&two.times(&b)));
    }
    side.retain(|t| {
        let along = dot(&at(t), &axis);
        along >= zero.minus(&none) && along <= height2.plus(&none)
    });
    let mut all = side;
    let slope = dot(&d, &axis);
    if !is_zero(&slope) {
        let t = height2.minus(&dot(&from, &axis)).over(&slope);
        let off = minus(&at(&t), &axis);
        if dot(&off, &off) <= radius2.plus(&none) {
            all.push(t);
        }
    }
    let (moment, length2) = (cross(&d, &from), dot(&d, &d));
    if is_zero(&dot(&moment, &moment)) && !is_zero(&length2) {
        all.push(zero.minus(&dot(&from, &d)).over(&length2));
    }
    let extreme =
        |less: bool| all.iter().cloned().reduce(|a, b| if (b < a) == less { b } else { a });
    [extreme(true)?, extreme(false)?].into_iter().find(|t| *t > none)
}

fn point(random: &mut Random) -> DVec3 {
    random.in_cube().as_vec3().as_dvec3()
}

fn item(random: &mut Random, id: u32) -> ConeItem {
    let size = |random: &mut Random| [0.3, 0.03, 3e-4][random.index(3)] * (0.5 + random.unit());
    let (apex, height) = (point(random), size(random));
    let base = apex + random.direction() * height;
    ConeItem::new(apex.as_vec3(), base.as_vec3(), size(random) as f32, id).expect("a valid one")
}

fn stored(item: &ConeItem) -> Cone {
    let (apex, base) = (item.apex.as_dvec3(), item.base.as_dvec3());
    Cone { apex, base, radius: f64::from(item.radius) }
}

/// A point of the surface, on the side, on the base, at the rim or at the apex, and its outward normal there.
fn on_surface(random: &mut Random, cone: &Cone) -> (DVec3, DVec3) {
    let axis = cone.base - cone.apex;
    let across = axis.cross(random.direction()).normalize() * cone.radius;
    let along = [0.0, 1.0, random.unit(), random.unit()][random.index(4)];
    if random.index(3) == 0 {
        return (cone.base + across * random.unit(), axis.normalize());
    }
    let normal = across.normalize() * axis.length() - axis.normalize() * cone.radius;
    (cone.apex + (axis + across) * along, normal.normalize())
}

/// A ray that about touches a face, an edge or the apex, or starts there.
fn grazing(random: &mut Random, cone: &Cone) -> ExactRay {
    let (target, normal) = on_surface(random, cone);
    let generator = target - cone.apex;
    let around = normal.cross(random.direction());
    let tangent = [around, around, generator + around * 1e-7, generator][random.index(4)];
    let tangent = if tangent.length() > 1e-9 { tangent.normalize() } else { around.normalize() };
    let tilt = [0.0, 0.0, 1e-7, 0.3, -1e-7][random.index(5)] * random.unit();
    let direction = (tangent - normal * tilt).normalize();
    let start = [0.0, 1e-4, 1.0, 1e5][random.index(4)];
    ExactRay {
        origin: (target - direction * start).as_vec3().as_dvec3(),
        direction: direction.as_vec3().as_dvec3(),
        origin_error: 0.0,
    }
}

#[test]
fn hits_are_those_of_150_decimal_places() {
    let mut random = Random::new(31);
    let (mut hits, mut misses, mut exact) = (0, 0, 0);
    for round in 0..40_000 {
        let body = stored(&item(&mut random, 0));
        let ray = match round % 3 {
            0 => {
                let origin = point(&mut random);
                let direction = (on_surface(&mut random, &body).0 - origin).as_vec3().as_dvec3();
                ExactRay { origin, direction, origin_error: 0.0 }
            }
            _ => grazing(&mut random, &body),
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

/// Cones and rays on a lattice, of which many touch at the apex, at the rim, along the base or along the side.
#[test]
fn hits_are_right_where_everything_touches() {
    let mut random = Random::new(32);
    let (mut hits, mut misses, mut exact) = (0, 0, 0);
    let lattice = |random: &mut Random| -> DVec3 {
        DVec3::from([(); 3].map(|()| f64::from(random.index(9) as u32) - 4.0))
    };
    while hits < 12_000 {
        let (apex, base) = (lattice(&mut random), lattice(&mut random));
        if apex == base {
            continue;
        }
        let cone = Cone { apex, base, radius: f64::from(1 + random.index(4) as u32) };
        let origin = lattice(&mut random);
        let towards = [apex, base, lattice(&mut random)][random.index(3)];
        let ray = ExactRay { origin, direction: towards - origin, origin_error: 0.0 };
        let (found, expected) = (intersect(&ray, &cone), reference(&ray, &cone));
        assert_eq!(found.is_some(), expected.is_some(), "{ray:?} {cone:?}");
        let (Some(found), Some(expected)) = (found, expected) else {
            misses += 1;
            continue;
        };
        let expected = expected.to_f64();
        let off = (found.t - expected).abs();
        assert!(off <= found.error + expected * 1e-16, "{found:?} {expected} {ray:?} {cone:?}");
        (hits, exact) = (hits + 1, exact + u32::from(found.exact));
    }
    assert!(misses > 3_000 && exact > 1_000, "{misses} {exact}");
}

#[test]
fn touching_rays_hit_and_the_next_ray_misses() {
    // A rim of radius 3 about the origin, and an apex at a height of 4: lines of the side have a length of 5.
    let cone = Cone { apex: DVec3::Z * 4.0, base: DVec3::ZERO, radius: 3.0 };
    let hit = |origin: [f64; 3], direction: [f64; 3]| {
        let ray =
            ExactRay { origin: origin.into(), direction: direction.into(), origin_error: 0.0 };
        intersect(&ray, &cone).map(|root| root.t)
    };
    let above = 4.0_f64.next_up();
    // The base, the side, the apex, the rim.
    assert_eq!(hit([1.0, 1.0, -5.0], [0.0, 0.0, 1.0]), Some(5.0));
    assert_eq!(hit([-5.0, 0.0, 2.0], [1.0, 0.0, 0.0]), Some(3.5));
    assert_eq!(hit([-5.0, 0.0, 4.0], [1.0, 0.0, 0.0]), Some(5.0));
    assert_eq!(hit([-5.0, 0.0, above], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, -2.0, 0.0], [0.0, 1.0, 0.0]), Some(2.0));
    assert_eq!(hit([3.0_f64.next_up(), -2.0, 0.0], [0.0, 1.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, -2.0], [0.0, 0.0, 1.0]), Some(2.0));
    assert_eq!(hit([3.0_f64.next_up(), 0.0, -2.0], [0.0, 0.0, 1.0]), None);
    // In the plane of the base, and below it.
    assert_eq!(hit([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(2.0));
    assert_eq!(hit([-5.0, 0.0, -f64::MIN_POSITIVE], [1.0, 0.0, 0.0]), None);
    // Along the side from beyond the apex, beside it, and within, parallel to it.
    assert_eq!(hit([-3.0, 0.0, 8.0], [3.0, 0.0, -4.0]), Some(1.0));
    assert_eq!(hit([(-3.0_f64).next_up(), 0.0, 8.0], [3.0, 0.0, -4.0]), None);
    assert_eq!(hit([-4.0, 0.0, 8.0], [3.0, 0.0, -4.0]), Some(7.0 / 6.0));
    // From within, from the base inward and outward, from the apex.
    assert_eq!(hit([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]), Some(3.0));
    assert_eq!(hit([0.0; 3], [0.0, 0.0, 1.0]), Some(4.0));
    assert_eq!(hit([0.0; 3], [0.0, 0.0, -1.0]), None);
    assert_eq!(hit([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(2.0));
    assert_eq!(hit([0.0, 0.0, 4.0], [0.0, 0.0, -1.0]), Some(4.0));
    assert_eq!(hit([0.0, 0.0, 4.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([0.0, 0.0, 4.0], [3.0, 0.0, -4.0]), Some(1.0));
    // The other half of the double cone is not there.
    assert_eq!(hit([-5.0, 0.0, 5.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([0.0, 0.0, 5.0], [0.0, 0.0, 1.0]), None);
    assert_eq!(hit([1.0, 0.0, 9.0], [0.0, 0.0, 1.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [0.0; 3]), None);
    assert_eq!(hit([f64::NAN, 0.0, 0.0], [-1.0, 0.0, 0.0]), None);
    assert_eq!(hit([3.0, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]), None);
}

#[test]
fn boxes_hold_their_cones_closely() {
    let mut random = Random::new(33);
    for _ in 0..2000 {
        let body = stored(&item(&mut random, 0));
        let [low, high] = body.extent();
        let axis = body.base - body.apex;
        for direction in [DVec3::X, DVec3::Y, DVec3::Z] {
            let rim =
                (direction - axis * (direction.dot(axis) / axis.length_squared())).normalize();
            let ends = [body.apex, body.base + rim * body.radius, body.base - rim * body.radius];
            let along = ends.map(|end| end.dot(direction));
            let most = along.into_iter().fold(f64::MIN, f64::max);
            let least = along.into_iter().fold(f64::MAX, f64::min);
            assert!((most - high.dot(direction)).abs() <= 1e-9);
            assert!((least - low.dot(direction)).abs() <= 1e-9);
        }
    }
}

#[test]
fn bad_cones_are_refused() {
    let make = |height: f32, radius: f32| {
        ConeItem::new(Vec3::ZERO, Vec3::X * height, radius, 0).map(|_| ())
    };
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30] {
        assert_eq!(make(1.0, radius), Err(BadCone::Radius), "{radius}");
    }
    for height in [0.0, f32::NAN, f32::INFINITY, 1e-30] {
        assert_eq!(make(height, 1.0), Err(BadCone::Height), "{height}");
    }
    let most = ConeItem::MAX_RATIO as f32;
    assert_eq!((make(1.0, 1.0 / most), make(1.0 / most, 1.0)), (Ok(()), Ok(())));
    assert_eq!(make(1.0, 0.9 / most), Err(BadCone::Ratio));
    assert_eq!(make(0.9 / most, 1.0), Err(BadCone::Ratio));
}

/// Among cones, two of which are equal, and in half of the rounds bodies of all other kinds.
#[test]
fn trees_find_the_hits_of_brute_force() {
    let mut random = Random::new(34);
    let mut counts = [0; 3];
    for (round, builder) in (0..12).zip(Builder::ALL.into_iter().cycle()) {
        let mut items: Vec<_> = (0..30).map(|id| item(&mut random, id)).collect();
        // The same body twice: the first is hit.
        items.push(ConeItem { id: 30, ..items[4] });
        let mut spheres = Spheres::with_capacity(8);
        let (mut capsules, mut ellipsoids) = (Vec::new(), Vec::new());
        if round % 2 == 0 {
            for id in 0..8 {
                spheres.push(point(&mut random).as_vec3(), 0.1, id);
                let ends = [0, 1].map(|_| point(&mut random).as_vec3());
                capsules.push(CapsuleItem { ends, radius: 0.05, id });
                let (center, axes) = (point(&mut random).as_vec3(), DVec3::new(0.1, 0.2, 0.3));
                let item = EllipsoidItem::new(center, axes, DQuat::IDENTITY, id);
                ellipsoids.push(item.expect("a valid one"));
            }
        }
        let bvh = crate::bvh::builders::build(&mut spheres, builder);
        let capsules = Capsules::build(&capsules, builder);
        let ellipsoids = Ellipsoids::build(&ellipsoids, builder);
        let cones = Cones::build(&items, builder);
        let mut rays = Rays::with_capacity(300);
        for _ in 0..300 {
            let near = stored(&items[random.index(items.len())]);
            if random.coin() {
                let ray = grazing(&mut random, &near);
                rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), MISS);
            } else {
                let origin = point(&mut random) * 2.0;
                let target = on_surface(&mut random, &near).0;
                rays.push(origin.as_vec3(), (target - origin).as_vec3(), MISS);
            }
        }
        let (mut hits, mut shadows) = (Hits::with_capacity(300), Hits::with_capacity(300));
        let tree = crate::bvh::Tree { bvh: &bvh, spheres: &spheres };
        crate::bvh::Tracer::default().closest(tree, &rays, &mut hits);
        crate::bvh::Tracer::default().occluded(tree, &rays, &mut shadows);
        // The hits among other bodies are tested elsewhere.
        let mut rest = hits.clone();
        let bodies = BodyTrees {
            spheres: &spheres,
            capsules: &capsules,
            ellipsoids: Some(&ellipsoids),
            cones: Some(&cones),
        };
        closest(BodyTrees { cones: None, ..bodies }, &rays, &mut rest);
        closest(bodies, &rays, &mut hits);
        occluded(bodies, &rays, &mut shadows);
        let rows = BodyRows {
            spheres: spheres.len(),
            capsules: capsules.len(),
            ellipsoids: ellipsoids.len(),
        };
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
                let Some(BodyRow::Cone(found)) = rows.row(hits.sphere[row]) else {
                    panic!("round {round} row {row}: {}", hits.sphere[row]);
                };
                assert_eq!(cones.ids()[found], id);
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

/// The first hit on a single cone by its tree.
fn hit_of_tree(item: ConeItem, ray: &ExactRay, own: u32) -> u32 {
    let cones = Cones::build(&[item], Builder::default());
    let mut rays = Rays::with_capacity(1);
    rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), own);
    let mut hits = Hits::with_capacity(1);
    let (spheres, capsules) = (Spheres::default(), Capsules::default());
    let bodies =
        BodyTrees { spheres: &spheres, capsules: &capsules, ellipsoids: None, cones: Some(&cones) };
    closest(bodies, &rays, &mut hits);
    hits.sphere[0]
}

#[test]
fn the_filter_keeps_what_is_hit() {
    let mut random = Random::new(35);
    let mut kept = 0;
    for _ in 0..20_000 {
        let item = item(&mut random, 0);
        let ray = grazing(&mut random, &stored(&item));
        if intersect(&ray, &stored(&item)).is_none() {
            continue;
        }
        assert_eq!(hit_of_tree(item, &ray, MISS), 0, "{ray:?} {item:?}");
        kept += 1;
    }
    assert!(kept > 5_000, "{kept}");
}

#[test]
fn rays_from_a_surface_do_not_hit_it_and_leave_at_its_far_side() {
    let mut random = Random::new(36);
    let mut chords = 0;
    for _ in 0..2000 {
        let item = item(&mut random, 0);
        let body = stored(&item);
        let [(on, outward), (toward, normal)] = [0, 1].map(|_| on_surface(&mut random, &body));
        let chord = (toward - on).length();
        if chord < 1e-5 {
            continue;
        }
        let direction = (toward - on) / chord;
        let ray = ExactRay { origin: on, direction, origin_error: 0.0 };
        assert_eq!(hit_of_tree(item, &ray, 0), MISS);
        // Rounding decides where a ray along a face leaves it.
        let slope = direction.dot((body.base - body.apex).normalize());
        let enters_and_leaves = direction.dot(normal).min(-direction.dot(outward)) > 0.01;
        if enters_and_leaves && slope.abs() > 0.01 {
            let exit = exit_distance(&ray, &body);
            assert!(
                (exit - chord).abs() <= 1e-6 * chord.max(1e-3),
                "{exit} {chord} {ray:?} {body:?} {toward}"
            );
            let found = body.normal(toward - body.apex);
            assert!(found.is_normalized() && (found.dot(normal) > 0.999 || is_edge(&body, toward)));
            chords += 1;
        }
    }
    assert!(chords > 500, "{chords}");
}

/// Returns whether a point of the surface is at the apex or at the rim, but for rounding.
fn is_edge(cone: &Cone, point: DVec3) -> bool {
    let from = point - cone.apex;
    let [side, base] = cone.distances(from);
    side.max(base).abs() < 1e-6 && (side.min(base) > -1e-6 || from.length() < 1e-6)
}

#[test]
fn points_are_enclosed_by_the_first_cone() {
    let mut random = Random::new(37);
    let items: Vec<_> = (0..40).map(|id| item(&mut random, id)).collect();
    let cones = Cones::build(&items, Builder::default());
    let mut inside = 0;
    for round in 0..4000 {
        let body = stored(&items[round % 40]);
        let surface = on_surface(&mut random, &body).0;
        let center = body.apex + (body.base - body.apex) * 0.75;
        let point = center + (surface - center) * (1.1 * random.unit());
        let contains = |item: &&ConeItem| {
            let body = stored(item);
            let axis = body.base - body.apex;
            let along = (point - body.apex).dot(axis) / axis.length_squared();
            let across = (point - body.apex - axis * along).length();
            along > 0.0 && along < 1.0 && across < along * body.radius
        };
        let expected = items.iter().find(contains).map(ConeItem::id);
        let found = cones.enclosing(point).map(|row| cones.ids()[row]);
        assert_eq!(found, expected);
        inside += u32::from(found.is_some());
    }
    assert!(inside > 1000, "{inside}");
}
