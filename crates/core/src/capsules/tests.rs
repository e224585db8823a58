//! Hits on capsules against an independent reference with 150 decimal places, and closed forms.

use super::*;
use crate::bodies::{BodyTrees, closest, occluded};
use crate::body_tree::tests::{Tested, body_tests, check_distances, grazing, point};
use crate::bvh::builders::Builder;
use crate::fixed::{Fixed, PLACES, dot, minus, roots, vector};
use crate::random::Random;
use crate::ray::{Hits, MISS, Rays};
use crate::spheres::Spheres;
use num_bigint::BigInt;

body_tests!(Capsule);

impl Tested for Capsule {
    fn item(random: &mut Random, id: u32) -> CapsuleItem {
        let start = point(random);
        let length = [1.0, 0.1, 1e-3, 0.0][random.index(4)];
        let ends = [start, start + point(random) * length].map(DVec3::as_vec3);
        CapsuleItem { ends, radius: [0.3, 0.01, 1e-4][random.index(3)], id }
    }

    fn with_id(item: CapsuleItem, id: u32) -> CapsuleItem {
        CapsuleItem { id, ..item }
    }

    fn among<'a>(tree: &'a Capsules, others: BodyTrees<'a>) -> BodyTrees<'a> {
        BodyTrees { capsules: Some(tree), ..others }
    }

    fn reference(&self, ray: &ExactRay) -> Option<Fixed> {
        let zero = Fixed::new(0.0);
        crossings(ray, self)?.into_iter().find(|t| *t > zero)
    }

    /// On the cylinder, at a crease, or on the half sphere about an end.
    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let [start, end] = self.ends;
        let axis = (end - start).normalize_or(DVec3::X);
        if random.index(3) == 0 {
            let (normal, end) = (random.direction(), random.index(2));
            let outward = normal.dot(axis) * [-1.0, 1.0][end];
            let normal = if outward < 0.0 { -normal } else { normal };
            return (self.ends[end] + normal * self.radius, normal);
        }
        let normal = axis.cross(random.direction()).normalize();
        let along = [0.0, 1.0, random.unit()][random.index(3)];
        (start.lerp(end, along) + normal * self.radius, normal)
    }

    /// Tangent, along the axis, or through the crease between cylinder and end.
    fn grazing(&self, random: &mut Random) -> ExactRay {
        let (target, normal) = self.surface(random);
        let axis = (self.ends[1] - self.ends[0]).normalize_or(DVec3::X);
        let around = normal.cross(random.direction());
        let mixed = axis.cross(normal) * random.unit() + axis * random.unit();
        let tangent = [around, axis, mixed, random.direction()][random.index(4)];
        grazing(random, target, tangent.normalize(), normal)
    }

    fn holds(&self, point: DVec3) -> bool {
        let axis = self.ends[1] - self.ends[0];
        let along = (point - self.ends[0]).dot(axis) / axis.length_squared().max(1e-300);
        (self.ends[0] + axis * along.clamp(0.0, 1.0)).distance(point) < self.radius
    }

    fn support(&self, direction: DVec3) -> f64 {
        self.ends[0].dot(direction).max(self.ends[1].dot(direction)) + self.radius
    }
}

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

#[test]
fn tangents_hit_and_the_next_ray_misses() {
    let capsule = Capsule { ends: [DVec3::new(-1.0, 0.0, 0.0), DVec3::X], radius: 0.5 };
    let up = 0.5_f64.next_up();
    let rays = [
        // Across the body, and over it.
        ([0.25, 0.5, -3.0], [0.0, 0.0, 1.0], Some((3.0, Part::Body))),
        ([0.25, up, -3.0], [0.0, 0.0, 1.0], None),
        // Along the body.
        ([-3.0, 0.5, 0.0], [2.0, 0.0, 0.0], Some((1.0, Part::End(0)))),
        ([3.0, 0.5, 0.0], [-2.0, 0.0, 0.0], Some((1.0, Part::End(1)))),
        ([-3.0, up, 0.0], [2.0, 0.0, 0.0], None),
        // The crease belongs to the body.
        ([1.0, 3.0, 0.0], [0.0, -1.0, 0.0], Some((2.5, Part::Body))),
        // From the middle, from the surface inward and outward, and away.
        ([0.0; 3], [-1.0, 0.0, 0.0], Some((1.5, Part::End(0)))),
        ([0.0, 0.5, 0.0], [0.0, -1.0, 0.0], Some((1.0, Part::Body))),
        ([0.0, 0.5, 0.0], [0.0, 1.0, 0.0], None),
        ([0.0, 0.5, 0.0], [1.0, 0.0, 0.0], Some((1.0, Part::End(1)))),
        ([3.0, 0.0, 0.0], [1.0, 0.0, 0.0], None),
    ];
    for (origin, direction, expected) in rays {
        let ray =
            ExactRay { origin: origin.into(), direction: direction.into(), origin_error: 0.0 };
        let hit = capsule.intersect(&ray);
        assert_eq!(hit.map(|hit| hit.part), expected.map(|(_, part)| part));
    }
    check_distances(&capsule, rays.map(|(o, d, expected)| (o, d, expected.map(|(t, _)| t))));
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
fn brute(ray: &ExactRay, spheres: &Spheres, rows: &[CapsuleItem]) -> Option<(Fixed, usize)> {
    let sphere = |i: usize| {
        let (center, radius) = spheres.exact(i);
        Capsule { ends: [center; 2], radius }
    };
    let capsules = rows.iter().map(Capsule::stored);
    let bodies = (0..spheres.len()).map(sphere).chain(capsules).enumerate();
    let first = |body: &Capsule| {
        crossings(ray, body).and_then(|all| all.into_iter().find(|t| *t > Fixed::new(0.0)))
    };
    let hits = bodies.filter_map(|(number, body)| Some((first(&body)?, number)));
    // Equal roots of different formulas agree to almost all places.
    let least = BigInt::from(1) << (PLACES / 4);
    hits.reduce(|a, b| if &a.0.0 - &b.0.0 > least { b } else { a })
}

#[test]
fn ends_that_coincide_are_hit_in_their_order() {
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
        let bodies = Capsule::among(&capsules, BodyTrees::of_spheres(tree));
        closest(bodies, &rays, &mut hits);
        occluded(bodies, &rays, &mut shadows);
        for row in 0..200 {
            let ray = rays.exact(row);
            let by_id = |hit: u32| {
                let row = bodies.rows().row(hit).expect("a body");
                let before = if row.kind == BodyKind::Sphere { 0 } else { spheres.len() };
                before + bodies.id(row) as usize
            };
            let found = (hits.sphere[row] != MISS).then(|| (hits.t[row], by_id(hits.sphere[row])));
            let mut by_order = Spheres::with_capacity(spheres.len());
            let mut order: Vec<usize> = (0..spheres.len()).collect();
            order.sort_by_key(|&i| spheres.id[i]);
            for &i in &order {
                by_order.push(spheres.center(i), spheres.radius(i), 0);
            }
            let expected = brute(&ray, &by_order, &rows);
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
