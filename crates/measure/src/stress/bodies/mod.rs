//! Stress tests of bodies other than spheres.
//!
//! Rays graze bodies, pass through edges and ends, start on surfaces, within, and 100,000 units away, or all numbers are small
//! integers, so that many rays touch exactly.

mod reference;

use self::reference::{Body, first_hit, is_less, to_double};
use glam::{DQuat, DVec3};
use rayon::prelude::*;
use serde::Serialize;
use spherule_core::internals::bodies::{BodyTrees, closest, occluded};
use spherule_core::internals::body_tree::{BodyTree, Shape};
use spherule_core::internals::bvh::builders::Builder;
use spherule_core::internals::bvh::{Bvh, Tree};
use spherule_core::internals::capsules::{Capsule, CapsuleItem, Capsules};
use spherule_core::internals::cones::{Cone, ConeItem};
use spherule_core::internals::ellipsoids::{Ellipsoid, EllipsoidItem};
use spherule_core::internals::random::Random;
use spherule_core::internals::ray::{ExactRay, Hits, MISS, Rays};
use spherule_core::internals::spheres::Spheres;
use spherule_core::internals::triangles::{Triangle, TriangleItem};
use spherule_render::sampling::{mix, stream};

/// Number of bodies of a scene.
const BODIES: u32 = 3;

/// Number of rays of a scene.
const RAYS: u64 = 32;

/// The largest relative error of distances: double precision decides where it knows them to 2^-30.
const DISTANCE: f64 = 1.0 / (1_u64 << 29) as f64;

/// The results for one kind of body.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct BodyReport {
    /// Name of the kind.
    pub name: &'static str,
    /// Number of rays.
    pub rays: u64,
    /// Number of rays that hit.
    pub hits: u64,
    /// Number of decisions for which Spherule needed exact arithmetic.
    pub exact: u64,
    /// Number of rays with a false hit or a false miss, or other answers to both queries.
    pub wrong_hits: u64,
    /// Number of rays with a hit of the wrong body.
    pub wrong_bodies: u64,
    /// Number of rays whose distance is off by more than 2^-29 of itself.
    pub wrong_distances: u64,
}

impl BodyReport {
    /// Returns the number of wrong answers of all kinds.
    pub fn wrong(&self) -> u64 {
        self.wrong_hits + self.wrong_bodies + self.wrong_distances
    }

    fn add(mut self, other: &Self) -> Self {
        self.rays += other.rays;
        self.hits += other.hits;
        self.exact += other.exact;
        self.wrong_hits += other.wrong_hits;
        self.wrong_bodies += other.wrong_bodies;
        self.wrong_distances += other.wrong_distances;
        self
    }
}

/// Tests each kind of body with this many rays.
pub(super) fn run(rays: u64, seed: u64) -> Vec<BodyReport> {
    vec![
        run_kind::<Capsule>(rays, seed),
        run_kind::<Ellipsoid>(rays, seed),
        run_kind::<Cone>(rays, seed),
        run_kind::<Triangle>(rays, seed),
    ]
}

fn run_kind<K: Kind>(rays: u64, seed: u64) -> BodyReport {
    let name = K::NAME.bytes().fold(mix(seed), |key, byte| stream(key, u64::from(byte)));
    let scene = |number: u64| {
        let count = RAYS.min(rays - number * RAYS);
        run_scene::<K>(count as usize, &mut Random::new(stream(name, number)))
    };
    let none = || BodyReport { name: K::NAME, ..BodyReport::default() };
    (0..rays.div_ceil(RAYS)).into_par_iter().map(scene).reduce(none, |a, b| a.add(&b))
}

/// A kind of body.
trait Kind: Shape {
    /// Its name, in the plural.
    const NAME: &'static str;

    /// A random body; on a lattice, where many rays touch, its numbers are small integers.
    fn item(id: u32, on_lattice: bool, random: &mut Random) -> Self::Item;

    /// A point of the surface or near it, and about the normal there.
    fn surface(&self, random: &mut Random) -> (DVec3, DVec3);

    /// A point at which something is special: an end, an apex, a center.
    fn corner(&self, random: &mut Random) -> DVec3;

    fn body(self) -> Body;

    fn trees<'a>(none: BodyTrees<'a>, tree: &'a BodyTree<Self>) -> BodyTrees<'a>;
}

/// A coordinate or a size: of one of some magnitudes.
fn size(random: &mut Random) -> f64 {
    [0.3, 0.03, 3e-4][random.index(3)] * random.between([0.5, 1.5])
}

fn integers(random: &mut Random) -> DVec3 {
    DVec3::from([(); 3].map(|()| random.index(9) as f64 - 4.0)) * 0.25
}

fn place(on_lattice: bool, random: &mut Random) -> DVec3 {
    if on_lattice { integers(random) } else { random.in_cube() }
}

/// Another place than a given one.
fn other_place(than: DVec3, on_lattice: bool, random: &mut Random) -> DVec3 {
    loop {
        let other =
            if on_lattice { integers(random) } else { than + random.direction() * size(random) };
        if other.as_vec3() != than.as_vec3() {
            return other;
        }
    }
}

impl Kind for Capsule {
    const NAME: &'static str = "sticks";

    fn item(id: u32, on_lattice: bool, random: &mut Random) -> CapsuleItem {
        let start = place(on_lattice, random);
        let end = other_place(start, on_lattice, random);
        let radius = if on_lattice { 0.25 * (1.0 + random.index(3) as f64) } else { size(random) };
        CapsuleItem { ends: [start.as_vec3(), end.as_vec3()], radius: radius as f32, id }
    }

    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let [start, end] = self.ends;
        if random.coin() {
            let normal = random.perpendicular((end - start).normalize());
            let along = [0.0, 1.0, random.unit()][random.index(3)];
            return (start.lerp(end, along) + normal * self.radius, normal);
        }
        let normal = random.direction();
        (self.ends[random.index(2)] + normal * self.radius, normal)
    }

    fn corner(&self, random: &mut Random) -> DVec3 {
        self.ends[random.index(2)]
    }

    fn body(self) -> Body {
        Body::Capsule(self)
    }

    fn trees<'a>(none: BodyTrees<'a>, tree: &'a Capsules) -> BodyTrees<'a> {
        BodyTrees { capsules: Some(tree), ..none }
    }
}

impl Kind for Ellipsoid {
    const NAME: &'static str = "ellipsoids";

    fn item(id: u32, on_lattice: bool, random: &mut Random) -> EllipsoidItem {
        let center = place(on_lattice, random).as_vec3();
        let (semi_axes, turned) = if on_lattice {
            let axes = [(); 3].map(|()| [0.25, 0.5, 1.0][random.index(3)]);
            (DVec3::from(axes), DQuat::IDENTITY)
        } else {
            let axes = [(); 3].map(|()| size(random));
            let (x, y) = (random.direction(), random.direction());
            (DVec3::from(axes), DQuat::from_rotation_arc(x, y))
        };
        // These axes are in range, so a sphere is never used.
        EllipsoidItem::new(center, semi_axes, turned, id)
            .or_else(|_| EllipsoidItem::new(center, DVec3::ONE, DQuat::IDENTITY, id))
            .expect("axes in range")
    }

    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let unit = random.direction();
        let [x, y, z] = self.to_unit;
        let from_unit = glam::DMat3::from_cols(x, y, z).transpose().inverse();
        let from_center = from_unit * unit;
        (self.center + from_center, self.normal(from_center))
    }

    fn corner(&self, _: &mut Random) -> DVec3 {
        self.center
    }

    fn body(self) -> Body {
        Body::Ellipsoid(self)
    }

    fn trees<'a>(none: BodyTrees<'a>, tree: &'a BodyTree<Self>) -> BodyTrees<'a> {
        BodyTrees { ellipsoids: Some(tree), ..none }
    }
}

impl Kind for Cone {
    const NAME: &'static str = "cones";

    fn item(id: u32, on_lattice: bool, random: &mut Random) -> ConeItem {
        loop {
            let apex = place(on_lattice, random);
            let base = other_place(apex, on_lattice, random);
            let radius =
                if on_lattice { 0.25 * (1.0 + random.index(3) as f64) } else { size(random) };
            if let Ok(item) = ConeItem::new(apex.as_vec3(), base.as_vec3(), radius as f32, id) {
                return item;
            }
        }
    }

    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let axis = self.base - self.apex;
        let across = random.perpendicular(axis.normalize()) * self.radius;
        if random.index(3) == 0 {
            return (self.base + across * random.unit(), axis.normalize());
        }
        let normal = across.normalize() * axis.length() - axis.normalize() * self.radius;
        let along = [0.0, 1.0, random.unit()][random.index(3)];
        (self.apex + (axis + across) * along, normal.normalize())
    }

    fn corner(&self, random: &mut Random) -> DVec3 {
        let rim = random.perpendicular((self.base - self.apex).normalize()) * self.radius;
        [self.apex, self.base, self.base + rim][random.index(3)]
    }

    fn body(self) -> Body {
        Body::Cone(self)
    }

    fn trees<'a>(none: BodyTrees<'a>, tree: &'a BodyTree<Self>) -> BodyTrees<'a> {
        BodyTrees { cones: Some(tree), ..none }
    }
}

impl Kind for Triangle {
    const NAME: &'static str = "triangles";

    fn item(id: u32, on_lattice: bool, random: &mut Random) -> TriangleItem {
        loop {
            let first = place(on_lattice, random);
            let corners = [(); 2].map(|()| other_place(first, on_lattice, random).as_vec3());
            if let Ok(item) = TriangleItem::new([first.as_vec3(), corners[0], corners[1]], id) {
                return item;
            }
        }
    }

    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let [a, b, c] = self.corners;
        let [mut u, mut v] = [random.unit(), random.unit()];
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let on_edge = [0.0, v][random.index(2)];
        (a + (b - a) * u + (c - a) * on_edge, self.normal())
    }

    fn corner(&self, random: &mut Random) -> DVec3 {
        self.corners[random.index(3)]
    }

    fn body(self) -> Body {
        Body::Triangle(self)
    }

    fn trees<'a>(none: BodyTrees<'a>, tree: &'a BodyTree<Self>) -> BodyTrees<'a> {
        BodyTrees { triangles: Some(tree), ..none }
    }
}

/// Returns origin and direction of a ray at a body.
fn ray<K: Kind>(body: &K, on_lattice: bool, random: &mut Random) -> (DVec3, DVec3) {
    if on_lattice {
        let origin = integers(random) * 2.0;
        let toward = if random.coin() { integers(random) } else { body.corner(random) };
        let direction = toward - origin;
        return (origin, if direction == DVec3::ZERO { DVec3::X } else { direction });
    }
    let (point, normal) = body.surface(random);
    if random.index(3) == 0 {
        let origin = random.in_cube();
        let toward = if random.coin() { point } else { body.corner(random) };
        return (origin, toward - origin);
    }
    let tangent = random.perpendicular(normal);
    let tilt = [0.0, 0.0, 1e-7, -1e-7, 0.3][random.index(5)] * random.unit();
    let direction = (tangent - normal * tilt).normalize();
    let start = [0.0, 1e-4, 1.0, 1e5][random.index(4)];
    (point - direction * start, direction)
}

fn run_scene<K: Kind>(count: usize, random: &mut Random) -> BodyReport {
    let on_lattice = random.index(4) == 0;
    let items: Vec<K::Item> = (0..BODIES).map(|id| K::item(id, on_lattice, random)).collect();
    let tree = BodyTree::<K>::build(&items, Builder::default());
    // In the order of their ids.
    let mut bodies: Vec<(u32, Body)> =
        tree.ids().iter().enumerate().map(|(row, &id)| (id, tree.body(row).body())).collect();
    bodies.sort_unstable_by_key(|(id, _)| *id);
    let mut rays = Rays::with_capacity(count);
    for _ in 0..count {
        let near = tree.body(random.index(tree.len()));
        let (origin, direction) = ray(&near, on_lattice, random);
        let direction = direction.as_vec3();
        let direction = if direction == glam::Vec3::ZERO { glam::Vec3::X } else { direction };
        rays.push(origin.as_vec3(), direction, MISS);
    }
    let (bvh, spheres) = (Bvh::default(), Spheres::default());
    let none = BodyTrees::of_spheres(Tree { bvh: &bvh, spheres: &spheres });
    let trees = K::trees(none, &tree);
    let (mut hits, mut any) = (Hits::with_capacity(count), Hits::with_capacity(count));
    let exact = closest(trees, &rays, &mut hits) + occluded(trees, &rays, &mut any);
    let mut report =
        BodyReport { name: K::NAME, rays: count as u64, exact, ..BodyReport::default() };
    for row in 0..count {
        let ray: ExactRay = rays.exact(row);
        let expected = bodies
            .iter()
            .filter_map(|(id, body)| Some((first_hit(&ray, body)?, *id)))
            .reduce(|a, b| if is_less(&b.0, &a.0) { b } else { a });
        let (found, occluded) = (hits.sphere[row], any.sphere[row] != MISS);
        report.hits += u64::from(expected.is_some());
        match expected {
            None => report.wrong_hits += u64::from(found != MISS || occluded),
            Some(_) if found == MISS || !occluded => report.wrong_hits += 1,
            Some((t, id)) => {
                report.wrong_bodies += u64::from(tree.ids()[found as usize / K::KIND.hits()] != id);
                let t = to_double(&t);
                report.wrong_distances += u64::from((hits.t[row] - t).abs() > DISTANCE * t);
            }
        }
    }
    report
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_answer_is_wrong_and_all_kinds_of_rays_occur() {
        for report in run(6400, 3) {
            assert_eq!((report.wrong(), report.rays), (0, 6400), "{report:?}");
            assert!(report.hits > 2000 && report.hits < 6000, "{report:?}");
            assert!(report.exact > 300, "{report:?}");
        }
    }

    #[test]
    fn results_depend_on_seeds_and_not_on_threads() {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| run(700, 5))
        };
        assert_eq!(with(1), with(3));
        assert_ne!(with(1), run(700, 6));
    }
}
