//! Properties of bodies of every kind, against independent references: [`body_tests`] tests a kind.

use super::{BodyTree, Shape};
use crate::bodies::{BodyTrees, closest, occluded};
use crate::body_rows::{BodyKind, BodyRow};
use crate::bvh::builders::{Builder, build};
use crate::bvh::{Bvh, Tracer, Tree};
use crate::capsules::Capsule;
use crate::cones::Cone;
use crate::ellipsoids::Ellipsoid;
use crate::fixed::Fixed;
use crate::random::Random;
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::spheres::Spheres;
use crate::triangles::Triangle;
use glam::DVec3;

/// A kind of body, with an oracle for each of its answers.
pub(crate) trait Tested: Shape {
    /// A random body: of several magnitudes, about the origin.
    fn item(random: &mut Random, id: u32) -> Self::Item;

    /// The same body at another place in the user's order.
    fn with_id(item: Self::Item, id: u32) -> Self::Item;

    /// These trees, and one of this kind.
    fn among<'a>(tree: &'a BodyTree<Self>, others: BodyTrees<'a>) -> BodyTrees<'a>;

    /// The distance of the hit, with 150 decimal places.
    fn reference(&self, ray: &ExactRay) -> Option<Fixed>;

    /// A point of the surface, at edges and ends too, and its outward normal there.
    fn surface(&self, random: &mut Random) -> (DVec3, DVec3);

    /// A ray that about touches the body, or starts at its surface.
    fn grazing(&self, random: &mut Random) -> ExactRay;

    /// Returns whether a point is inside, by the definition.
    fn holds(&self, point: DVec3) -> bool;

    /// The largest coordinate along a unit vector.
    fn support(&self, direction: DVec3) -> f64;

    /// Returns whether a point of the surface is at an edge, where there is no normal.
    fn is_edge(&self, _: DVec3) -> bool {
        false
    }

    /// Returns whether a ray that leaves the body does so at one point but for rounding.
    fn leaves_clearly(&self, _: DVec3) -> bool {
        true
    }

    /// The body as its tree stores it.
    fn stored(item: &Self::Item) -> Self {
        let mut block = Self::EMPTY;
        Self::store(item, &mut block, 0);
        Self::load(&block, 0)
    }
}

/// A point that single precision holds.
pub(crate) fn point(random: &mut Random) -> DVec3 {
    random.in_cube().as_vec3().as_dvec3()
}

/// A ray that single precision holds.
pub(crate) fn ray(origin: DVec3, direction: DVec3) -> ExactRay {
    let [origin, direction] = [origin, direction].map(|v| v.as_vec3().as_dvec3());
    ExactRay { origin, direction, origin_error: 0.0 }
}

/// A ray that touches a point of the surface but for a small tilt, from there, from near, or from far away.
pub(crate) fn grazing(
    random: &mut Random,
    target: DVec3,
    tangent: DVec3,
    normal: DVec3,
) -> ExactRay {
    let tilt = [0.0, 0.0, 1e-7, 0.3, -1e-7][random.index(5)] * random.unit();
    let direction = (tangent - normal * tilt).normalize();
    let start = [0.0, 1e-4, 1.0, 1e5][random.index(4)];
    ray(target - direction * start, direction)
}

/// Rays with closed forms of their distances: each is an origin, a direction, and the distance.
pub(crate) fn check_distances<S: Shape>(
    body: &S,
    rays: impl IntoIterator<Item = ([f64; 3], [f64; 3], Option<f64>)>,
) {
    let infinite = [
        ([3.0, 0.0, 0.0], [0.0; 3], None),
        ([f64::NAN, 0.0, 0.0], [-1.0, 0.0, 0.0], None),
        ([3.0, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0], None),
    ];
    for (origin, direction, expected) in rays.into_iter().chain(infinite) {
        let ray =
            ExactRay { origin: origin.into(), direction: direction.into(), origin_error: 0.0 };
        assert_eq!(body.intersect(&ray).map(|hit| hit.root.t), expected, "{ray:?}");
    }
}

fn item<S: Tested>(random: &mut Random, id: u32) -> (S::Item, S) {
    let item = S::item(random, id);
    (item, S::stored(&item))
}

/// A ray from anywhere to the surface.
fn aimed<S: Tested>(random: &mut Random, body: &S) -> ExactRay {
    let origin = point(random);
    ray(origin, body.surface(random).0 - origin)
}

/// Compares a hit with the reference. Returns whether there is one, and whether it took integers to decide.
pub(crate) fn check_hit<S: Tested>(body: &S, ray: &ExactRay) -> Option<bool> {
    let (found, expected) = (body.intersect(ray).map(|hit| hit.root), body.reference(ray));
    assert_eq!(found.is_some(), expected.is_some(), "{ray:?} {body:?}");
    let (found, expected) = (found?, expected?.to_f64());
    let off = (found.t - expected).abs();
    assert!(off <= found.error + expected * 1e-16, "{found:?} {expected} {ray:?} {body:?}");
    Some(found.exact)
}

pub(crate) fn hits_are_those_of_150_decimal_places<S: Tested>() {
    let mut random = Random::new(21);
    let (mut hits, mut misses, mut exact) = (0, 0, 0);
    for round in 0..40_000 {
        let body = item::<S>(&mut random, 0).1;
        let ray = match round % 3 {
            0 => aimed(&mut random, &body),
            _ => body.grazing(&mut random),
        };
        match check_hit(&body, &ray) {
            Some(by_integers) => (hits, exact) = (hits + 1, exact + u32::from(by_integers)),
            None => misses += 1,
        }
    }
    assert!(hits > 15_000 && misses > 5_000 && exact > 600, "{hits} {misses} {exact}");
}

/// Returns the first hits and whether there is any, of rays among bodies.
fn trace(bodies: BodyTrees, rays: &Rays) -> (Hits, Vec<bool>) {
    let count = rays.len();
    let (mut hits, mut shadows) = (Hits::with_capacity(count), Hits::with_capacity(count));
    Tracer::default().closest(bodies.tree, rays, &mut hits);
    Tracer::default().occluded(bodies.tree, rays, &mut shadows);
    closest(bodies, rays, &mut hits);
    occluded(bodies, rays, &mut shadows);
    let is_hit = shadows.sphere[..count].iter().map(|&hit| hit != MISS).collect();
    (hits, is_hit)
}

/// The body that a single ray among bodies of one kind hits first; it starts on the body of a hit.
fn hit_of_tree<S: Tested>(item: S::Item, ray: &ExactRay, own: u32) -> Option<BodyRow> {
    let tree = BodyTree::<S>::build(&[item], Builder::default());
    let mut rays = Rays::with_capacity(1);
    rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), own);
    let (bvh, spheres) = (Bvh::default(), Spheres::default());
    let bodies = S::among(&tree, BodyTrees::of_spheres(Tree { bvh: &bvh, spheres: &spheres }));
    let (mut hits, rows) = (Hits::with_capacity(1), bodies.rows());
    closest(bodies, &rays, &mut hits);
    rows.row(hits.sphere[0])
}

/// Among bodies of one kind, two of which are equal, and in half of the rounds bodies of all other kinds.
pub(crate) fn trees_find_the_hits_of_brute_force<S: Tested>() {
    let mut random = Random::new(24);
    let mut counts = [0; 3];
    for (round, builder) in (0..12).zip(Builder::ALL.into_iter().cycle()) {
        let mut items: Vec<_> = (0..30).map(|id| S::item(&mut random, id)).collect();
        // The same body twice: the first is hit.
        items.push(S::with_id(items[4], 30));
        let tree = BodyTree::<S>::build(&items, builder);
        let count = if round % 2 == 0 { 4 } else { 0 };
        let mut spheres = Spheres::with_capacity(8);
        (0..count).for_each(|id| spheres.push(point(&mut random).as_vec3(), 0.1, id));
        let bvh = build(&mut spheres, builder);
        let capsules = random_tree::<Capsule>(&mut random, count, builder);
        let ellipsoids = random_tree::<Ellipsoid>(&mut random, count, builder);
        let cones = random_tree::<Cone>(&mut random, count, builder);
        let triangles = random_tree::<Triangle>(&mut random, count, builder);
        let others = BodyTrees {
            tree: Tree { bvh: &bvh, spheres: &spheres },
            capsules: (S::KIND != BodyKind::Capsule).then_some(&capsules),
            ellipsoids: (S::KIND != BodyKind::Ellipsoid).then_some(&ellipsoids),
            cones: (S::KIND != BodyKind::Cone).then_some(&cones),
            triangles: (S::KIND != BodyKind::Triangle).then_some(&triangles),
        };
        let all = S::among(&tree, others);
        let mut rays = Rays::with_capacity(300);
        for _ in 0..300 {
            let near = S::stored(&items[random.index(items.len())]);
            let ray = if random.coin() {
                near.grazing(&mut random)
            } else {
                let origin = point(&mut random) * 2.0;
                ray(origin, near.surface(&mut random).0 - origin)
            };
            rays.push(ray.origin.as_vec3(), ray.direction.as_vec3(), MISS);
        }
        // The hits among other bodies are tested with their kinds.
        let ((hits, is_hit), (rest, _)) = (trace(all, &rays), trace(others, &rays));
        for (row, is_hit) in is_hit.into_iter().enumerate() {
            let ray = rays.exact(row);
            let first = items
                .iter()
                .zip(0..)
                .filter_map(|(item, id)| Some((S::stored(item).reference(&ray)?, id)))
                .reduce(|a, b| if b.0 < a.0 { b } else { a });
            let (found, other) = (hits.sphere[row], rest.sphere[row]);
            let (found, other) = (all.rows().row(found), others.rows().row(other));
            let nearest = |(t, _): &(Fixed, u32)| other.is_none() || t.to_f64() < rest.t[row];
            let first = first.filter(nearest);
            assert_eq!(is_hit, first.is_some() || other.is_some());
            if let Some((t, id)) = first {
                let found = found.expect("a hit");
                assert_eq!((found.kind, all.id(found)), (S::KIND, id), "round {round} row {row}");
                assert!((hits.t[row] - t.to_f64()).abs() <= t.to_f64() * 1e-8);
                counts[0] += 1;
            } else {
                assert_eq!((found, hits.t[row]), (other, rest.t[row]));
                counts[if other.is_some() { 1 } else { 2 }] += 1;
            }
        }
    }
    assert!(counts[0] > 1000 && counts[1] > 50 && counts[2] > 100, "{counts:?}");
}

fn random_tree<S: Tested>(random: &mut Random, count: u32, builder: Builder) -> BodyTree<S> {
    let items: Vec<_> = (0..count).map(|id| S::item(random, id)).collect();
    BodyTree::build(&items, builder)
}

pub(crate) fn the_filter_keeps_what_is_hit<S: Tested>() {
    let mut random = Random::new(25);
    let mut kept = 0;
    for _ in 0..20_000 {
        let (item, body) = item::<S>(&mut random, 0);
        let ray = body.grazing(&mut random);
        if body.intersect(&ray).is_some() {
            let found = hit_of_tree::<S>(item, &ray, MISS);
            assert_eq!(found.map(|found| found.row), Some(0), "{ray:?} {body:?}");
            kept += 1;
        }
    }
    assert!(kept > 5_000, "{kept}");
}

pub(crate) fn rays_from_a_surface_do_not_hit_it_and_leave_at_its_far_side<S: Tested>() {
    let mut random = Random::new(26);
    let mut chords = 0;
    for _ in 0..2000 {
        let (item, body) = item::<S>(&mut random, 0);
        let [(on, outward), (toward, normal)] = [0, 1].map(|_| body.surface(&mut random));
        let chord = (toward - on).length();
        if chord < 1e-5 {
            continue;
        }
        let direction = (toward - on) / chord;
        let ray = ExactRay { origin: on, direction, origin_error: 0.0 };
        for own in 0..S::KIND.hits() as u32 {
            assert_eq!(hit_of_tree::<S>(item, &ray, own), None);
        }
        // Rounding decides where a ray along a face leaves it.
        let enters_and_leaves = direction.dot(normal).min(-direction.dot(outward)) > 0.01;
        if !S::HAS_INSIDE || (enters_and_leaves && body.leaves_clearly(direction)) {
            let exit = body.exit_distance(&ray);
            let off = (exit - if S::HAS_INSIDE { chord } else { 0.0 }).abs();
            assert!(off <= 1e-6 * chord.max(1e-3), "{exit} {chord} {ray:?} {body:?} {toward}");
            let found = body.normal_at(toward);
            assert!(found.is_normalized() && (found.dot(normal) > 0.999 || body.is_edge(toward)));
            chords += 1;
        }
    }
    assert!(chords > 500, "{chords}");
}

pub(crate) fn points_are_enclosed_by_the_first_body<S: Tested>() {
    let mut random = Random::new(27);
    let items: Vec<_> = (0..40).map(|id| S::item(&mut random, id)).collect();
    let tree = BodyTree::<S>::build(&items, Builder::default());
    let mut inside = 0;
    for round in 0..4000 {
        let body = S::stored(&items[round % 40]);
        // Between the middle and the surface, or a little beyond.
        let [low, high] = body.extent();
        let (middle, surface) = (low.midpoint(high), body.surface(&mut random).0);
        let point = middle + (surface - middle) * (1.1 * random.unit());
        // Rounding decides on a face, where the middle of a flat body may be.
        let point = point + random.direction() * 1e-6;
        let holds = |item: &S::Item| S::stored(item).holds(point);
        let expected = (0..40).filter(|&id| holds(&items[id as usize]));
        let expected: Vec<u32> = expected.collect();
        let found = tree.all_enclosing(point).into_iter().map(|row| tree.ids()[row]);
        assert_eq!(found.collect::<Vec<_>>(), expected);
        let first = tree.enclosing(point).map(|row| tree.ids()[row]);
        assert_eq!(first, expected.first().copied());
        inside += u32::from(first.is_some());
    }
    assert!(inside > 1000 || !S::HAS_INSIDE, "{inside}");
}

pub(crate) fn boxes_hold_their_bodies_closely<S: Tested>() {
    let mut random = Random::new(23);
    for _ in 0..2000 {
        let (item, body) = item::<S>(&mut random, 0);
        let ([low, high], (center, reach, _)) = (body.extent(), S::around(&item));
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let (least, most) = (-body.support(-axis), body.support(axis));
            let slack = 1e-6 * (most - least) + 1e-15;
            assert!((most - high.dot(axis)).abs() <= slack, "{body:?}");
            assert!((least - low.dot(axis)).abs() <= slack, "{body:?}");
            let (middle, reach) = (center.as_dvec3().dot(axis), f64::from(reach) * (1.0 + 1e-6));
            assert!(middle - reach <= least + 1e-6 && most <= middle + reach + 1e-6, "{body:?}");
        }
    }
}

/// Tests a kind of body.
macro_rules! body_tests {
    ($kind:ty: $($test:ident)*) => {
        $(
            #[test]
            fn $test() {
                $crate::body_tree::tests::$test::<$kind>();
            }
        )*
    };
    ($kind:ty) => {
        $crate::body_tree::tests::body_tests! {
            $kind: hits_are_those_of_150_decimal_places
            trees_find_the_hits_of_brute_force
            the_filter_keeps_what_is_hit
            rays_from_a_surface_do_not_hit_it_and_leave_at_its_far_side
            points_are_enclosed_by_the_first_body
            boxes_hold_their_bodies_closely
        }
    };
}
pub(crate) use body_tests;
