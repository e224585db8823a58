//! Rays among translucent bodies beside their definition: all hits of a ray, decided and sorted on integers, and their optical
//! depths added up in that order.

use glam::{DQuat, DVec3, Vec3};
use spherule_core::internals::bodies::BodyTrees;
use spherule_core::internals::body_rows::BodyKind;
use spherule_core::internals::body_tree::Shape;
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::bvh::{Bvh, Tree};
use spherule_core::internals::capsules::{Capsule, CapsuleItem, Capsules};
use spherule_core::internals::cones::{Cone, ConeItem, Cones};
use spherule_core::internals::ellipsoids::{Ellipsoid, EllipsoidItem, Ellipsoids};
use spherule_core::internals::exact::{self, Distance, Quotient};
use spherule_core::internals::random::Random;
use spherule_core::internals::ray::{ExactRay, MISS};
use spherule_core::internals::spheres::Spheres;
use spherule_core::internals::translucency::{
    AttenuatedRay, OpticalDepth, SeenBody, TranslucentBodies,
};
use spherule_core::internals::triangles::{Triangle, TriangleItem, Triangles};
use std::collections::HashMap;

const OPACITIES: [f64; 5] = [0.0, 0.1, 0.5, 0.8, 1.0];

/// A body of the oracle, in the user's order.
#[derive(Clone, Copy)]
enum Body {
    Sphere(DVec3, f64),
    Capsule(Capsule),
    Ellipsoid(Ellipsoid),
    Cone(Cone),
    Triangle(Triangle),
}

impl Body {
    /// The distance at which a ray hits it; `None` if it does not, or if it starts inside of it and it is translucent.
    fn distance(&self, ray: &ExactRay, is_opaque: bool) -> Option<Quotient> {
        fn of<S: Shape>(body: &S, ray: &ExactRay, is_opaque: bool) -> Option<Quotient> {
            if !is_opaque && body.contains(ray.origin) {
                return None;
            }
            body.exact_hit(ray).map(|(t, _)| t)
        }
        match *self {
            Self::Sphere(center, radius) => {
                if !is_opaque && exact::is_inside(ray.origin, center, radius) {
                    return None;
                }
                exact::hit(ray, center, radius).map(|_| Distance::Hit(center, radius).value(ray))
            }
            Self::Capsule(body) => of(&body, ray, is_opaque),
            Self::Ellipsoid(body) => of(&body, ray, is_opaque),
            Self::Cone(body) => of(&body, ray, is_opaque),
            Self::Triangle(body) => of(&body, ray, is_opaque),
        }
    }
}

/// Bodies on a coarse lattice, so that many coincide, touch, and are at equal distances.
struct Scene {
    bodies: Vec<Body>,
    spheres: Spheres,
    capsules: Capsules,
    ellipsoids: Ellipsoids,
    cones: Cones,
    triangles: Triangles,
}

impl Scene {
    fn new(seed: u64, builder: Builder) -> (Self, Bvh) {
        let mut random = Random::new(seed);
        let mut step = |n: u32| (random.single() * n as f32).floor();
        let mut point = || Vec3::new(step(5), step(5), step(5)) * 0.5;
        let rows: Vec<(Vec3, f32)> = (0..30).map(|i| (point(), [0.25, 0.5, 0.75][i % 3])).collect();
        let sticks: Vec<CapsuleItem> = (0..20)
            .map(|i| CapsuleItem {
                ends: [point(), point()],
                radius: [0.25, 0.125][i % 2],
                id: i as u32,
            })
            .collect();
        let items: Vec<EllipsoidItem> = (0..20)
            .map(|i| {
                let axes = [DVec3::new(0.5, 0.25, 0.25), DVec3::new(0.25, 0.5, 1.0)][i % 2];
                // Some are spheres but for rounding, and some turned by a right angle.
                let axes = if i % 5 == 0 { DVec3::splat(0.5) } else { axes };
                let turned = DQuat::from_rotation_z(f64::from(i as u32 % 3) * 0.5);
                EllipsoidItem::new(point(), axes, turned, i as u32).expect("an ellipsoid")
            })
            .collect();
        let mut cone_items = Vec::new();
        while cone_items.len() < 20 {
            // Of the lattice's points some are equal, between which there is no cone.
            let id = cone_items.len();
            let cone = ConeItem::new(point(), point(), [0.25, 0.5][id % 2], id as u32);
            cone_items.extend(cone);
        }
        let mut triangle_items = Vec::new();
        while triangle_items.len() < 20 {
            let id = triangle_items.len() as u32;
            triangle_items.extend(TriangleItem::new([point(), point(), point()], id));
        }
        let mut spheres = Spheres::with_capacity(rows.len());
        for (id, &(center, radius)) in rows.iter().enumerate() {
            spheres.push(center, radius, id as u32);
        }
        let bvh = build(&mut spheres, builder);
        let capsules = Capsules::build(&sticks, builder);
        let of_spheres =
            rows.iter().map(|&(center, r)| Body::Sphere(center.as_dvec3(), f64::from(r)));
        let of_sticks = sticks.iter().map(|item| {
            let ends = item.ends.map(Vec3::as_dvec3);
            Body::Capsule(Capsule { ends, radius: f64::from(item.radius) })
        });
        let ellipsoids = Ellipsoids::build(&items, builder);
        let mut of_items = vec![None; items.len()];
        for (row, &id) in ellipsoids.ids().iter().enumerate() {
            of_items[id as usize] = Some(Body::Ellipsoid(ellipsoids.body(row)));
        }
        let cones = Cones::build(&cone_items, builder);
        let of_cones = cone_items.iter().map(|item| {
            let row = cones.ids().iter().position(|&id| id == item.id()).expect("a cone");
            Body::Cone(cones.body(row))
        });
        let of_triangles = triangle_items.iter().map(|item| {
            let corners = item.corners().map(Vec3::as_dvec3);
            Body::Triangle(Triangle { corners })
        });
        let triangles = Triangles::build(&triangle_items, builder);
        let of_items = of_items.into_iter().flatten().chain(of_cones).chain(of_triangles);
        let bodies = of_spheres.chain(of_sticks).chain(of_items).collect();
        (Self { bodies, spheres, capsules, ellipsoids, cones, triangles }, bvh)
    }

    /// Its bodies in their trees.
    fn trees<'a>(&'a self, bvh: &'a Bvh) -> BodyTrees<'a> {
        BodyTrees {
            tree: Tree { bvh, spheres: &self.spheres },
            capsules: Some(&self.capsules),
            ellipsoids: Some(&self.ellipsoids),
            cones: Some(&self.cones),
            triangles: Some(&self.triangles),
        }
    }

    /// The kind of the body of a hit, and the body's place in the user's order.
    fn place(trees: &BodyTrees, hit: u32) -> Option<(BodyKind, usize)> {
        let (rows, row) = (trees.rows(), trees.rows().row(hit)?);
        let before = BodyKind::ALL.into_iter().take_while(|&kind| kind < row.kind);
        let before: usize = before.map(|kind| rows.count(kind)).sum();
        Some((row.kind, before + trees.id(row) as usize))
    }

    fn opacity(place: usize) -> f64 {
        OPACITIES[place * 7 % OPACITIES.len()]
    }

    /// Its bodies, with a factor on their opacities.
    fn bodies<'a>(
        &'a self,
        bvh: &'a Bvh,
        factor: f64,
    ) -> TranslucentBodies<'a, impl Fn(u32) -> OpticalDepth + 'a> {
        let bodies = self.trees(bvh);
        TranslucentBodies {
            bodies,
            depth: move |hit| {
                let (_, place) = Self::place(&bodies, hit).expect("a hit on a body");
                OpticalDepth::of_opacity(factor * Self::opacity(place))
            },
        }
    }

    /// The body at which a ray ends.
    fn oracle(&self, ray: &ExactRay, threshold: OpticalDepth) -> Option<usize> {
        let depth = |place| OpticalDepth::of_opacity(Self::opacity(place));
        let mut hits: Vec<(usize, Quotient)> = (0..self.bodies.len())
            .filter_map(|place| {
                Some((place, self.bodies[place].distance(ray, depth(place).is_opaque())?))
            })
            .collect();
        // A stable sort: of equal distances the first in the user's order stays first.
        hits.sort_by(|a, b| a.1.compare(&b.1));
        let mut sum = OpticalDepth::NONE;
        let end = |(place, _): &&(usize, Quotient)| {
            sum = sum.plus(depth(*place));
            sum >= threshold
        };
        hits.iter().find(end).map(|hit| hit.0)
    }
}

/// A ray from inside or outside, mostly between points of the lattice, so that it goes along tangents and through corners.
fn ray(random: &mut Random) -> ExactRay {
    let mut point = |scale: f32| {
        let [x, y, z] = [(); 3].map(|()| (random.single() * 9.0).floor() * 0.25);
        (Vec3::new(x, y, z) - 1.0) * scale
    };
    let origin = point(3.0) + 1.0;
    let direction = point(1.0) + 1.0 - origin;
    let direction = if direction == Vec3::ZERO { Vec3::X } else { direction };
    ExactRay { origin: origin.as_dvec3(), direction: direction.as_dvec3(), origin_error: 0.0 }
}

#[test]
fn rays_end_where_all_hits_in_their_exact_order_end_them() {
    let builders = Builder::ALL;
    let (mut ends, mut misses) = ([0; BodyKind::ALL.len()], 0);
    for seed in 0..6 {
        let (scene, bvh) = Scene::new(seed, builders[seed as usize % 3]);
        let bodies = scene.bodies(&bvh, 1.0);
        let mut random = Random::new(100 + seed);
        let mut fragments = Vec::new();
        for _ in 0..500 {
            let (ray, threshold) =
                (ray(&mut random), OpticalDepth::threshold(f64::from(random.single())));
            let known = (f64::INFINITY, MISS);
            let attenuated = AttenuatedRay { ray, ends: [MISS; 2], threshold, known };
            let (SeenBody { t, hit, .. }, _) = bodies.closest(&attenuated, &mut fragments);
            let expected = scene.oracle(&ray, threshold);
            let found = Scene::place(&bodies.bodies, hit);
            assert_eq!(found.map(|(_, place)| place), expected, "{ray:?}");
            assert_eq!(t.is_finite(), expected.is_some());
            assert_eq!(bodies.occluded(&attenuated).0, expected.is_some(), "{ray:?}");
            match found {
                Some((kind, _)) => ends[kind as usize] += 1,
                None => misses += 1,
            }
            if expected.is_some() {
                // A bound before the body leaves the ray free of it.
                let known = (t * 0.999, MISS);
                let shorter = AttenuatedRay { known, ..attenuated };
                assert_ne!(bodies.closest(&shorter, &mut fragments).0.hit, hit);
            }
        }
    }
    assert!(ends.iter().all(|&ends| ends > 100) && misses > 50, "{ends:?} {misses}");
}

#[test]
fn chosen_bodies_stand_for_the_share_of_rays_that_end_at_them() {
    const NUMBERS: u32 = 64;
    let (mut open, mut closed) = (0, 0);
    for seed in 0..3 {
        let (scene, bvh) = Scene::new(seed, Builder::ALL[seed as usize % 3]);
        let bodies = scene.bodies(&bvh, [1.0, 0.02][seed as usize % 2]);
        let (mut random, mut fragments) = (Random::new(200 + seed), Vec::new());
        for _ in 0..200 {
            let ray = ray(&mut random);
            let mut shares = HashMap::<u32, f64>::new();
            let mut passing = 0.0;
            for i in 0..NUMBERS {
                let number = (f64::from(i) + 0.5) / f64::from(NUMBERS);
                let threshold = OpticalDepth::threshold(number);
                let known = (f64::INFINITY, MISS);
                let attenuated = AttenuatedRay { ray, ends: [MISS; 2], threshold, known };
                let (ended, _) = bodies.closest(&attenuated, &mut fragments);
                let (seen, _) = bodies.choose(&attenuated, number, &mut fragments);
                assert!((0.0..=1.0).contains(&seen.coverage));
                assert_eq!(seen.hit == MISS, seen.coverage == 0.0);
                *shares.entry(ended.hit).or_default() += 1.0;
                passing += bodies.transmittance(&attenuated).0;
                passing -= if ended.hit == MISS { 1.0 } else { 0.0 };
                *shares.entry(seen.hit).or_default() -= seen.coverage;
                *shares.entry(MISS).or_default() -=
                    if seen.hit == MISS { 1.0 } else { 1.0 - seen.coverage };
                if seen.hit != MISS {
                    *(if seen.coverage < 1.0 { &mut open } else { &mut closed }) += 1;
                }
            }
            // Of numbers in equal steps each interval has its length, but for one at each end.
            assert!(f64::abs(passing) <= 1.0, "{ray:?} {passing}");
            assert!(shares.values().all(|share| share.abs() <= 2.0), "{ray:?} {shares:?}");
        }
    }
    assert!(open > 1000 && closed > 1000, "{open} {closed}");
}

#[test]
fn one_body_ends_the_share_of_rays_that_is_its_opacity() {
    for opacity in [0.0, 1e-3, 0.25, 0.5, 0.9, 1.0 - 1e-12, 1.0] {
        let depth = OpticalDepth::of_opacity(opacity);
        let count = 1 << 16;
        let ended = (0..count)
            .filter(|&i| depth >= OpticalDepth::threshold((f64::from(i) + 0.5) / f64::from(count)))
            .count();
        let share = ended as f64 / f64::from(count);
        assert!((share - opacity).abs() <= 1.0 / f64::from(count), "{opacity}: {share}");
    }
    assert!(OpticalDepth::of_opacity(1.0).is_opaque());
    assert!(OpticalDepth::NONE < OpticalDepth::threshold(0.0));
    // The largest random number ends no ray at a body that is not there, and every ray at an opaque one.
    let largest = OpticalDepth::threshold(1.0_f64.next_down());
    assert!(OpticalDepth::of_opacity(0.999) < largest && largest < OpticalDepth::OPAQUE);
    let half = OpticalDepth::of_opacity(0.5);
    assert_eq!(half.plus(half), OpticalDepth::of_opacity(0.75));
    assert_eq!(OpticalDepth::OPAQUE.after(half).plus(half), OpticalDepth::OPAQUE);
}
