//! Every traversal gives the answer of the exact test over all spheres, to the bit: any lane count, with
//! the tree or without, closest or any hit, on scenes that are nasty on purpose.

use glam::{DVec3, Vec3};
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::bvh::{PacketWidth, Tracer, Traversal, Tree};
use spherule_core::internals::exact::{self, Distance};
use spherule_core::internals::intersect::{self, Root};
use spherule_core::internals::random::Random;
use spherule_core::internals::ray::{Hits, MISS, Rays};
use spherule_core::internals::spheres::Spheres;
use std::cmp::Ordering;

/// Random numbers of a test.
struct Numbers(Random);

impl Numbers {
    fn new(seed: u64) -> Self {
        Self(Random::new(seed))
    }
    fn unit(&mut self) -> f32 {
        self.0.single()
    }
    fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
    fn direction(&mut self) -> Vec3 {
        self.0.direction().as_vec3()
    }
    fn power(&mut self, low: f32, high: f32) -> f32 {
        (low + (high - low) * self.unit()).exp2()
    }
}

fn spheres(rows: impl IntoIterator<Item = (Vec3, f32)>) -> Spheres {
    let rows: Vec<_> = rows.into_iter().collect();
    let column = |f: fn(&(Vec3, f32)) -> f32| rows.iter().map(f).collect::<Vec<_>>();
    let [x, y, z] = [column(|s| s.0.x), column(|s| s.0.y), column(|s| s.0.z)];
    Spheres::from_columns(&x, &y, &z, &column(|s| s.1))
}

/// Scenes with what breaks tracers; the largest coordinate is about 1, as in every world.
fn scenes() -> Vec<(&'static str, Spheres)> {
    let n = &mut Numbers::new(1);
    let mut scenes = vec![
        ("none", spheres([])),
        ("one", spheres([(Vec3::new(0.1, 0.2, 0.3), 0.4)])),
        ("nine", spheres((0..9).map(|_| (n.point() * 0.7, 0.2)))),
        ("random", spheres((0..900).map(|_| (n.point(), 0.02 + 0.05 * n.unit())))),
        ("tiny", spheres((0..900).map(|_| (n.point(), n.power(-40.0, -4.0))))),
        ("twins", spheres((0..600).map(|i| (Vec3::splat((i % 40) as f32 / 40.0), 0.05)))),
        ("equal", spheres((0..500).map(|_| (Vec3::splat(0.25), 0.5)))),
        ("shells", spheres((0..500).map(|i| (Vec3::ZERO, 0.5 + 4e-5 * i as f32)))),
        ("line", spheres((0..500).map(|i| (Vec3::new(i as f32 / 500.0, 0.0, 0.0), 0.01)))),
        ("lattice", {
            let cell = |i: i32| (i as f32 - 4.0) / 8.0;
            spheres(
                (0..729).map(|i| (Vec3::new(cell(i % 9), cell(i / 9 % 9), cell(i / 81)), 0.0625)),
            )
        }),
    ];
    let dust = (0..700).map(|_| (n.point() * 1e-6, 1e-8 * (1.0 + n.unit())));
    let giant = [(Vec3::new(0.0, -0.5, 0.0), 0.5)];
    scenes.push(("giant and dust", spheres(dust.chain(giant).collect::<Vec<_>>())));
    scenes
}

/// Rays of every kind that a scene can meet; `bound` of each is where its search ends.
fn rays(spheres: &Spheres, count: usize) -> (Rays, Vec<f64>) {
    let n = &mut Numbers::new(77);
    let mut rays = Rays::with_capacity(count);
    let mut bounds = Vec::new();
    for i in 0..count {
        let some = |n: &mut Numbers| (n.unit() * spheres.len() as f32) as usize;
        let (origin, direction, own) = match i % 7 {
            _ if spheres.is_empty() => (n.point(), n.direction(), MISS),
            // From outside, at random and at a sphere's limb.
            0 => (n.direction() * 2.0, n.direction(), MISS),
            1 | 2 => {
                let target = some(n);
                let origin = n.direction() * n.power(-1.0, 6.0);
                let to_center = spheres.center(target) - origin;
                let side = to_center.cross(n.direction()).normalize_or(Vec3::X);
                let limb = if i % 7 == 1 { n.unit() } else { 1.0 + n.signed() * 1e-6 };
                let aim = to_center + side * (spheres.radius(target) * limb);
                (origin, aim.normalize_or(Vec3::Y), MISS)
            }
            // Along an axis, through centers and tangent.
            3 => {
                let target = some(n);
                let shift = if n.unit() < 0.5 { 0.0 } else { spheres.radius(target) };
                let center = spheres.center(target);
                let along =
                    [Vec3::X, Vec3::NEG_Y, Vec3::new(-0.0, 0.0, 1.0)][(n.unit() * 3.0) as usize];
                (
                    center - along * 2.0 + Vec3::new(along.y.abs(), along.z.abs(), along.x) * shift,
                    along,
                    MISS,
                )
            }
            // From inside.
            4 => (spheres.center(some(n)), n.direction(), MISS),
            // From a surface outward, with and without its id.
            _ => {
                let from = some(n);
                let normal = n.direction();
                let mut direction = n.direction();
                direction *= direction.dot(normal).signum();
                let own = if i % 7 == 5 { from as u32 } else { MISS - 1 };
                (spheres.center(from) + normal * spheres.radius(from), direction, own)
            }
        };
        rays.push(origin, direction, own);
        bounds.push(if n.unit() < 0.3 { f64::from(n.power(-8.0, 3.0)) } else { f64::INFINITY });
    }
    (rays, bounds)
}

fn fresh(bounds: &[f64]) -> Hits {
    let mut hits = Hits::with_capacity(bounds.len());
    hits.t[..bounds.len()].copy_from_slice(bounds);
    hits
}

/// The definition: the nearest of all spheres, of equals the first of the scene; in arithmetic that
/// does not round, but for rays whose origin was.
fn oracle(spheres: &Spheres, rays: &Rays, row: usize, bound: f64) -> (f64, u32) {
    let ray = rays.exact(row);
    let own = rays.own[row] as usize;
    let distance = |sphere: u32, root: &Root| {
        let (center, radius) = spheres.exact(sphere as usize);
        if root.error == 0.0 { Distance::Number(root.t) } else { Distance::Hit(center, radius) }
    };
    let within = |center: DVec3, radius: f64| {
        let touching = |(own_center, own_radius): (DVec3, f64)| {
            own_radius < radius && (ray.origin - own_center).dot(ray.origin - center) > 0.0
        };
        own < spheres.len() && touching(spheres.exact(own))
    };
    let mut best = (Distance::Number(bound), bound, MISS);
    for sphere in 0..spheres.len() as u32 {
        let (center, radius) = spheres.exact(sphere as usize);
        if own == sphere as usize || (own < spheres.len() && spheres.exact(own) == (center, radius))
        {
            continue;
        }
        let Some(root) = intersect::confirm(&ray, center, radius, || within(center, radius)) else {
            assert!(rays.own[row] != MISS || exact::hit(&ray, center, radius).is_none());
            continue;
        };
        if rays.own[row] == MISS {
            let t = exact::hit(&ray, center, radius).expect("confirmed");
            assert!((t - root.t).abs() <= root.error + 1e-15 * t, "{t} {root:?}");
        }
        let nearer = if bound.is_infinite() && best.2 == MISS {
            Ordering::Less
        } else {
            exact::compare(&ray, &distance(sphere, &root), &best.0)
        };
        let first =
            |other: u32| other != MISS && spheres.id[sphere as usize] < spheres.id[other as usize];
        if nearer.is_lt() || (nearer.is_eq() && first(best.2)) {
            best = (distance(sphere, &root), root.t, sphere);
        }
    }
    (best.1, best.2)
}

const TRAVERSALS: [Traversal; 5] =
    [Traversal::Brute, Traversal::Single, Traversal::Stream, Traversal::Packet, Traversal::Auto];

fn agree(name: &str, widths: &[PacketWidth], tree: Tree, rays: &Rays, bounds: &[f64]) {
    let expected: Vec<_> =
        (0..rays.len()).map(|row| oracle(tree.spheres, rays, row, bounds[row])).collect();
    let tracers =
        widths.iter().flat_map(|&width| TRAVERSALS.map(|traversal| Tracer { traversal, width }));
    for tracer in tracers {
        let what = |row| format!("{name}, {tracer:?}, ray {row}");
        let mut hits = fresh(bounds);
        tracer.closest(tree, rays, &mut hits);
        for (row, &(t, sphere)) in expected.iter().enumerate() {
            assert_eq!(
                (hits.t[row].to_bits(), hits.sphere[row]),
                (t.to_bits(), sphere),
                "{}",
                what(row)
            );
        }
        let mut hits = fresh(bounds);
        tracer.occluded(tree, rays, &mut hits);
        for (row, &(_, sphere)) in expected.iter().enumerate() {
            assert_eq!(hits.sphere[row] != MISS, sphere != MISS, "any hit: {}", what(row));
        }
    }
}

#[test]
fn every_traversal_is_exact() {
    for (name, mut spheres) in scenes() {
        let bvh = build(&mut spheres, Builder::default());
        // Not a multiple of any width.
        let (rays, bounds) = rays(&spheres, 243);
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        agree(name, &PacketWidth::ALL, tree, &rays, &bounds);
    }
}

#[test]
fn every_tree_is_exact() {
    for (name, spheres) in scenes() {
        for builder in Builder::ALL.into_iter().filter(|&builder| builder != Builder::default()) {
            let mut spheres = spheres.clone();
            let bvh = build(&mut spheres, builder);
            let (rays, bounds) = rays(&spheres, 107);
            let (name, tree) =
                (format!("{name}, {builder:?}"), Tree { bvh: &bvh, spheres: &spheres });
            agree(&name, &[PacketWidth::Eight], tree, &rays, &bounds);
        }
    }
}

#[test]
fn outward_rays_never_hit_their_own_sphere_and_inward_ones_never_miss_its_far_side() {
    let n = &mut Numbers::new(5);
    for _ in 0..20_000 {
        let (center, radius) = (n.point(), n.power(-20.0, 0.0));
        let (normal, direction) = (n.direction(), n.direction());
        let mut rays = Rays::with_capacity(1);
        // No id: the band around the surface alone decides.
        let point = center.as_dvec3() + normal.as_dvec3().normalize() * f64::from(radius);
        rays.push(point.as_vec3(), direction, MISS - 1);
        let t = intersect::confirm(&rays.exact(0), center.as_dvec3(), f64::from(radius), || true);
        let cosine = normal.dot(direction);
        // Within the rounding of the origin the side is not known, nor whether a tangent ray
        // touches.
        if cosine.abs() > (1e-6 / radius).sqrt() {
            assert_eq!(t.is_some(), cosine < 0.0, "{center} {radius} {cosine}");
        }
    }
}
