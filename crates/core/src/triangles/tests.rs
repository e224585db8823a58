//! Hits on triangles against an independent reference with 150 decimal places, closed meshes without gaps, and closed forms.

use super::*;
use crate::bodies::{BodyTrees, closest};
use crate::body_tree::tests::{
    Tested, body_tests, check_distances, check_hit, grazing, point, ray,
};
use crate::bvh::builders::Builder;
use crate::bvh::{Bvh, Tree};
use crate::fixed::{Fixed, Vector, minus, vector};
use crate::random::Random;
use crate::ray::{Hits, MISS, Rays};
use crate::spheres::Spheres;
use std::collections::{HashMap, HashSet};

body_tests!(Triangle);

impl Tested for Triangle {
    /// Wide or thin, in any plane or in one across an axis.
    fn item(random: &mut Random, id: u32) -> TriangleItem {
        loop {
            let corner = point(random);
            let side = |random: &mut Random| {
                random.direction() * [0.3, 0.03, 3e-4][random.index(3)] * (0.5 + random.unit())
            };
            let (first, second) = (side(random), side(random));
            let second = [second, second, second, first * 0.4 + second * 1e-4][random.index(4)];
            let mut corners = [corner, corner + first, corner + second];
            if random.index(4) == 0 {
                let axis = random.index(3);
                for other in &mut corners {
                    other[axis] = corner[axis];
                }
            }
            if let Ok(item) = TriangleItem::new(corners.map(DVec3::as_vec3), id) {
                return item;
            }
        }
    }

    fn with_id(item: TriangleItem, id: u32) -> TriangleItem {
        TriangleItem { id, ..item }
    }

    fn among<'a>(tree: &'a Triangles, others: BodyTrees<'a>) -> BodyTrees<'a> {
        BodyTrees { triangles: Some(tree), ..others }
    }

    /// By Cramer's rule for the distance and two barycentric coordinates; in the plane, by the points where the line crosses edges in a projection.
    fn reference(&self, ray: &ExactRay) -> Option<Fixed> {
        let zero = Fixed::new(0.0);
        let (origin, d) = (vector(ray.origin), vector(ray.direction));
        let corners = self.corners.map(vector);
        let [e1, e2] = [1, 2].map(|i| minus(&corners[i], &corners[0]));
        let from = minus(&origin, &corners[0]);
        // from + t d = b e1 + c e2.
        let back = minus(&vector(DVec3::ZERO), &d);
        let divisor = determinant(&e1, &e2, &back);
        if divisor != zero {
            let [b, c, t] = [
                determinant(&from, &e2, &back),
                determinant(&e1, &from, &back),
                determinant(&e1, &e2, &from),
            ]
            .map(|x| if divisor < zero { zero.minus(&x) } else { x });
            let size = if divisor < zero { zero.minus(&divisor) } else { divisor };
            let is_inside = b >= zero && c >= zero && b.plus(&c) <= size;
            return (is_inside && t > zero).then(|| t.over(&size));
        }
        if determinant(&e1, &e2, &from) != zero {
            return None;
        }
        // A plane of coordinates in which the triangle has an area.
        let [i, j] = [[0, 1], [1, 2], [2, 0]]
            .into_iter()
            .find(|&[i, j]| e1[i].times(&e2[j]) != e1[j].times(&e2[i]))?;
        let across = |a: &Vector, b: &Vector| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
        let mut all = Vec::new();
        for k in 0..3 {
            let edge = minus(&corners[(k + 1) % 3], &corners[k]);
            let to_start = minus(&corners[k], &origin);
            let divisor = across(&d, &edge);
            let (t, s) = (across(&to_start, &edge), across(&to_start, &d));
            if divisor == zero {
                continue;
            }
            let turn = |x: Fixed| if divisor < zero { zero.minus(&x) } else { x };
            let (s, size) = (turn(s), turn(divisor.clone()));
            if s >= zero && s <= size {
                all.push(turn(t).over(&size));
            }
        }
        let extreme =
            |less: bool| all.iter().cloned().reduce(|a, b| if (b < a) == less { b } else { a });
        [extreme(true)?, extreme(false)?].into_iter().find(|t| *t > zero)
    }

    /// Within, on an edge or at a corner.
    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let [corner, first, second] = self.corners;
        let (b, c) = (random.unit(), random.unit());
        let (b, c) = if b + c > 1.0 { (1.0 - b, 1.0 - c) } else { (b, c) };
        let (b, c) = [(b, c), (b, c), (b, c), (b, 0.0), (b, 1.0 - b), (0.0, 1.0)][random.index(6)];
        (corner + (first - corner) * b + (second - corner) * c, self.normal())
    }

    fn grazing(&self, random: &mut Random) -> ExactRay {
        let (target, normal) = self.surface(random);
        let tangent = normal.cross(random.direction()).normalize();
        let across = [tangent, random.direction(), random.direction()][random.index(3)];
        grazing(random, target, across, normal)
    }

    fn holds(&self, _: DVec3) -> bool {
        false
    }

    fn support(&self, direction: DVec3) -> f64 {
        self.corners.into_iter().map(|corner| corner.dot(direction)).fold(f64::MIN, f64::max)
    }
}

fn determinant(a: &Vector, b: &Vector, c: &Vector) -> Fixed {
    let minor = |i: usize, j: usize| b[i].times(&c[j]).minus(&b[j].times(&c[i]));
    let [x, y, z] = [minor(1, 2), minor(2, 0), minor(0, 1)];
    a[0].times(&x).plus(&a[1].times(&y)).plus(&a[2].times(&z))
}

fn triangle(corners: [[f64; 3]; 3]) -> Triangle {
    Triangle { corners: corners.map(DVec3::from) }
}

/// Triangles and rays on a lattice, of which many meet edges and corners, or are in the plane of the triangle.
#[test]
fn hits_are_right_where_everything_touches() {
    let mut random = Random::new(33);
    let (mut hits, mut misses, mut exact, mut in_plane) = (0, 0, 0, 0);
    let lattice = |random: &mut Random| -> Vec3 {
        Vec3::from([(); 3].map(|()| random.index(7) as f32 - 3.0))
    };
    while hits < 12_000 {
        let corners = [(); 3].map(|()| lattice(&mut random));
        let Ok(item) = TriangleItem::new(corners, 0) else { continue };
        let body = Triangle::stored(&item);
        let origin = lattice(&mut random).as_dvec3();
        let towards = [corners[0], corners[1].midpoint(corners[2]), lattice(&mut random)];
        let direction = towards[random.index(3)].as_dvec3() - origin;
        let ray = ExactRay { origin, direction, origin_error: 0.0 };
        let found = check_hit(&body, &ray);
        match found {
            Some(by_integers) => (hits, exact) = (hits + 1, exact + u32::from(by_integers)),
            None => misses += 1,
        }
        let normal = body.area_normal();
        let is_in_plane =
            (origin - body.corners[0]).dot(normal) == 0.0 && direction.dot(normal) == 0.0;
        in_plane += u32::from(is_in_plane && found.is_some());
    }
    assert!(misses > 3_000 && exact > 1_000 && in_plane > 300, "{misses} {exact} {in_plane}");
}

#[test]
fn touching_rays_hit_and_the_next_ray_misses() {
    let body = triangle([[0.0; 3], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
    let below = (-f64::MIN_POSITIVE, -f64::EPSILON);
    let rays = [
        // Within, from both sides; on edges, at corners and beside them.
        ([1.0, 1.0, -5.0], [0.0, 0.0, 1.0], Some(5.0)),
        ([1.0, 1.0, 5.0], [0.0, 0.0, -2.0], Some(2.5)),
        ([1.0, 0.0, -5.0], [0.0, 0.0, 1.0], Some(5.0)),
        ([1.0, below.0, -5.0], [0.0, 0.0, 1.0], None),
        ([2.0, 1.5, -5.0], [0.0, 0.0, 1.0], Some(5.0)),
        ([2.0_f64.next_up(), 1.5, -5.0], [0.0, 0.0, 1.0], None),
        ([0.0, 3.0, -5.0], [0.0, 0.0, 1.0], Some(5.0)),
        ([0.0, 3.0_f64.next_up(), -5.0], [0.0, 0.0, 1.0], None),
        ([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], Some(5.0)),
        ([below.0, 0.0, -5.0], [0.0, 0.0, 1.0], None),
        // Behind, on it, and away from it.
        ([1.0, 1.0, 5.0], [0.0, 0.0, 1.0], None),
        ([1.0, 1.0, 0.0], [0.0, 0.0, 1.0], None),
        ([1.0, 1.0, 0.0], [1.0, 2.0, -1.0], None),
        ([1.0, 1.0, below.0], [0.0, 0.0, 1.0], Some(f64::MIN_POSITIVE)),
        // In the plane: from outside, from an edge, from within, from a corner; along an edge; past a corner; away.
        ([-2.0, 1.0, 0.0], [1.0, 0.0, 0.0], Some(2.0)),
        ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], Some(8.0 / 3.0)),
        ([1.0, 1.0, 0.0], [1.0, 0.0, 0.0], Some(5.0 / 3.0)),
        ([1.0, 1.0, 0.0], [-2.0, 0.0, 0.0], Some(0.5)),
        ([0.0; 3], [1.0, 0.0, 0.0], Some(4.0)),
        ([0.0; 3], [-1.0, 0.0, 0.0], None),
        ([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], None),
        ([-1.0, 0.0, 0.0], [2.0, 0.0, 0.0], Some(0.5)),
        ([2.0, 0.0, 0.0], [1.0, 0.0, 0.0], Some(2.0)),
        ([-1.0, 4.0, 0.0], [1.0, -1.0, 0.0], Some(1.0)),
        ([-1.0, 3.0, 0.0], [1.0, 0.0, 0.0], Some(1.0)),
        ([-1.0, 3.0_f64.next_up(), 0.0], [1.0, 0.0, 0.0], None),
        ([5.0, 1.0, 0.0], [1.0, 0.0, 0.0], None),
        ([5.0, 1.0, 0.0], [-1.0, 0.0, 0.0], Some(7.0 / 3.0)),
        // Parallel to the plane, and all but.
        ([-2.0, 1.0, below.0], [1.0, 0.0, 0.0], None),
        ([-2.0, 1.0, below.1], [2.5, 0.0, f64::EPSILON], Some(1.0)),
    ];
    check_distances(&body, rays);
}

#[test]
fn thin_and_tiny_and_far_triangles_are_hit_as_they_are() {
    let mut random = Random::new(34);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..20_000 {
        let (scale, thin) = [(1.0, 1e-6), (1e-12, 1.0), (1e-12, 1e-6), (1.0, 1e-7)][round % 4];
        let mut corner = || random.in_cube() * scale;
        let [first, second, off] = [corner(), corner(), corner()];
        let third = first + (second - first) * 0.3 + off * thin;
        let corners = [first, second, third].map(DVec3::as_vec3);
        let Ok(item) = TriangleItem::new(corners, 0) else { continue };
        let body = Triangle::stored(&item);
        let (target, normal) = body.surface(&mut random);
        assert!(normal.is_normalized());
        // The next numbers of single precision off a thin triangle are beside it.
        let direction = random.direction().as_vec3().as_dvec3();
        let start = [1e-12, 1.0, 1e5][random.index(3)];
        for origin in
            [target - direction * start, (target - direction * start).as_vec3().as_dvec3()]
        {
            let rounded = ExactRay { origin, direction, origin_error: 0.0 };
            match check_hit(&body, &rounded) {
                Some(_) => hits += 1,
                None => misses += 1,
            }
        }
        let aimed = ray(target * 0.5 + random.in_cube(), random.direction());
        misses += u32::from(check_hit(&body, &aimed).is_none());
    }
    assert!(hits > 5_000 && misses > 5_000, "{hits} {misses}");
}

/// A closed mesh about the origin: the faces of an octahedron, each in 4^5 parts, on the unit sphere, with coordinates that are multiples of a step.
struct Mesh {
    corners: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
}

impl Mesh {
    fn new(random: &mut Random, step: f64) -> Self {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut corners: Vec<DVec3> = axes.into_iter().flat_map(|axis| [axis, -axis]).collect();
        let mut faces = Vec::new();
        for [x, y, z] in (0..8).map(|i| [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2)]) {
            faces.push([x, y, z]);
        }
        for _ in 0..4 {
            let mut middles = HashMap::new();
            faces = faces
                .iter()
                .flat_map(|&[a, b, c]| {
                    let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[a, b]| {
                        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                            corners.push(corners[a].midpoint(corners[b]).normalize());
                            corners.len() - 1
                        })
                    });
                    [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
                })
                .collect();
        }
        // Faces in any order, from any corner, and either way round.
        for i in (1..faces.len()).rev() {
            faces.swap(i, random.index(i + 1));
            faces[i].rotate_left(random.index(3));
            if random.coin() {
                faces[i].swap(0, 1);
            }
        }
        let coarse = |x: f64| if step > 0.0 { (x / step).round() * step } else { x };
        Self { corners: corners.into_iter().map(|v| v.map(coarse).as_vec3()).collect(), faces }
    }

    fn tree(&self, builder: Builder) -> Triangles {
        let items = self.faces.iter().zip(0..).map(|(face, id)| {
            TriangleItem::new(face.map(|corner| self.corners[corner]), id).expect("a face")
        });
        Triangles::build(&items.collect::<Vec<_>>(), builder)
    }

    /// All edges, each once, with the faces that share it.
    fn edges(&self) -> Vec<([usize; 2], Vec<u32>)> {
        let mut edges = HashMap::<_, Vec<u32>>::new();
        for (face, id) in self.faces.iter().zip(0..) {
            for i in 0..3 {
                let (a, b) = (face[i], face[(i + 1) % 3]);
                edges.entry([a.min(b), a.max(b)]).or_default().push(id);
            }
        }
        let mut edges: Vec<_> = edges.into_iter().collect();
        edges.sort_unstable();
        edges
    }

    /// The faces that have a corner.
    fn around(&self, corner: usize) -> Vec<u32> {
        let faces = self.faces.iter().zip(0..);
        faces.filter(|(face, _)| face.contains(&corner)).map(|(_, id)| id).collect()
    }
}

/// The distances and ids of the first hits.
fn trace(tree: &Triangles, rays: &Rays) -> Vec<Option<(f64, u32)>> {
    let (bvh, spheres) = (Bvh::default(), Spheres::default());
    let of_spheres = BodyTrees::of_spheres(Tree { bvh: &bvh, spheres: &spheres });
    let bodies = BodyTrees { triangles: Some(tree), ..of_spheres };
    let mut hits = Hits::with_capacity(rays.len());
    hits.t[..rays.len()].fill(f64::INFINITY);
    hits.sphere[..rays.len()].fill(MISS);
    closest(bodies, rays, &mut hits);
    let found = |row: usize| {
        let body = bodies.rows().row(hits.sphere[row])?;
        Some((hits.t[row], bodies.id(body)))
    };
    (0..rays.len()).map(found).collect()
}

#[test]
fn rays_through_shared_edges_and_corners_hit_the_first_face_that_has_them() {
    let mut random = Random::new(35);
    // All points on edges and all origins are multiples of small powers of two.
    let mesh = Mesh::new(&mut random, 1.0 / 4096.0);
    let (mut through, mut expected) = (Vec::new(), Vec::new());
    let from = |random: &mut Random| (random.in_cube() * 100.0).round() / 512.0;
    for (ends, faces) in mesh.edges() {
        assert_eq!(faces.len(), 2);
        let [start, end] = ends.map(|corner| mesh.corners[corner].as_dvec3());
        for quarters in 1..4 {
            let on = start + (end - start) * (f64::from(quarters) * 0.25);
            let origin = from(&mut random);
            through.push((origin, on - origin));
            expected.push(faces.clone());
            // From outside, and toward the middle but for a little.
            let origin = on * 2.0 + from(&mut random) * 0.25;
            through.push((origin, on - origin));
            expected.push(faces.clone());
        }
    }
    for corner in 0..mesh.corners.len() {
        let origin = from(&mut random);
        through.push((origin, mesh.corners[corner].as_dvec3() - origin));
        expected.push(mesh.around(corner));
    }
    let mut rays = Rays::with_capacity(through.len());
    for &(origin, direction) in &through {
        assert_eq!(
            (origin.as_vec3().as_dvec3(), direction.as_vec3().as_dvec3()),
            (origin, direction)
        );
        rays.push(origin.as_vec3(), direction.as_vec3(), MISS);
    }
    for builder in Builder::ALL {
        let tree = mesh.tree(builder);
        for ((found, faces), ray) in trace(&tree, &rays).into_iter().zip(&expected).zip(&through) {
            assert_eq!(found, faces.iter().min().map(|&id| (1.0, id)), "{ray:?} {faces:?}");
        }
    }
    assert!(rays.len() > 18_000, "{}", rays.len());
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random::new(36);
    let mesh = Mesh::new(&mut random, 0.0);
    let tree = mesh.tree(Builder::default());
    let edges = mesh.edges();
    let mut rays = Rays::with_capacity(40_000);
    let mut nearest = Vec::new();
    for round in 0..40_000 {
        let (ends, faces) = &edges[random.index(edges.len())];
        let [start, end] = ends.map(|corner| mesh.corners[corner].as_dvec3());
        let along = if round % 4 == 0 { 0.0 } else { random.unit() };
        // About all rays pass the edge more closely than single precision can tell.
        let origin = (random.in_cube() * 0.4).as_vec3();
        let direction = (start + (end - start) * along - origin.as_dvec3()).as_vec3();
        rays.push(origin, direction, MISS);
        let near: HashSet<u32> = if along > 0.0 {
            faces.iter().copied().collect()
        } else {
            mesh.around(ends[0]).into_iter().collect()
        };
        nearest.push(near);
    }
    let mut beside = 0;
    for (row, (found, near)) in trace(&tree, &rays).into_iter().zip(nearest).enumerate() {
        let (t, id) = found.unwrap_or_else(|| panic!("{:?} leaves", rays.exact(row)));
        assert!((t - 1.0).abs() < 1e-4);
        beside += u32::from(!near.contains(&id));
    }
    // Near a corner rounding leads to faces beside it.
    assert!(beside < 400, "{beside}");
}

#[test]
fn rays_from_a_triangle_do_not_hit_it_and_those_from_beside_it_do() {
    let mut random = Random::new(37);
    let (mut on, mut beside) = (0, 0);
    for _ in 0..20_000 {
        let body = Triangle::stored(&Triangle::item(&mut random, 0));
        let (point, normal) = body.surface(&mut random);
        let rounded = point.as_vec3();
        let direction = random.direction().as_vec3();
        let from = ExactRay::new(rounded, direction, true);
        assert_eq!(body.intersect(&from), None, "{from:?} {body:?}");
        on += 1;
        // From well off the plane, straight at the point.
        let above = (point + normal * 1e-5).as_vec3();
        let back = ExactRay::new(above, (point - above.as_dvec3()).as_vec3(), true);
        let exact = ExactRay { origin_error: 0.0, ..back };
        assert_eq!(body.intersect(&back), body.intersect(&exact), "{back:?} {body:?}");
        // In the plane, beyond a corner: as far from the triangle as the corners are from each other.
        let [first, second, third] = body.corners;
        let beyond =
            ExactRay::new((first * 2.0 - second.midpoint(third)).as_vec3(), direction, true);
        let toward = second.midpoint(third) - beyond.origin;
        let back = ExactRay { direction: toward, ..beyond };
        let exact = ExactRay { origin_error: 0.0, ..back };
        assert_eq!(body.intersect(&back), body.intersect(&exact), "{back:?} {body:?}");
        beside += u32::from(body.intersect(&exact).is_some());
    }
    assert!(on > 10_000 && beside > 100, "{on} {beside}");
}

#[test]
fn normals_are_against_the_ray_and_points_in_the_plane() {
    let mut random = Random::new(38);
    for _ in 0..5_000 {
        let body = Triangle::stored(&Triangle::item(&mut random, 0));
        let ray = body.grazing(&mut random);
        let Some(hit) = body.intersect(&ray) else { continue };
        let (point, normal) = body.surface_at(&ray, hit.root.t);
        assert!(normal.is_normalized() && normal.dot(ray.direction) <= 0.0);
        assert_eq!(normal.dot(body.normal_at(point)).abs().round(), 1.0);
        let [first, second, third] = body.corners;
        assert!((point - first).dot(normal).abs() < 1e-15);
        for edge in [second - first, third - first] {
            assert!(edge.dot(normal).abs() < 1e-9 * edge.length());
        }
        let is_near = body.is_near(point, 1e-9);
        assert!(is_near, "{point} {body:?}");
    }
    // Counterclockwise, seen from above.
    let body = triangle([[0.0; 3], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
    assert_eq!(body.normal(), DVec3::Z);
    // Differences of numbers that no double holds, and the least triangle there is.
    let body = triangle([
        [-1.0, 0.0, 0.0],
        [2.0_f64.powi(-120), 0.0, 0.0],
        [1.0, 0.0, 2.0_f64.powi(-140)],
    ]);
    assert_eq!(body.normal(), DVec3::NEG_Y);
    let least = f64::from(f32::from_bits(1));
    assert_eq!(triangle([[0.0; 3], [least, 0.0, 0.0], [0.0, least, 0.0]]).normal(), DVec3::Z);
}

#[test]
fn bad_triangles_are_refused() {
    let make = |corners: [[f32; 3]; 3]| TriangleItem::new(corners.map(Vec3::from), 0).map(|_| ());
    for x in [f32::NAN, f32::INFINITY] {
        assert_eq!(make([[0.0; 3], [1.0, x, 0.0], [0.0, 1.0, 0.0]]), Err(BadTriangle::Corner));
    }
    let third = [1.0, 1.0, 1.0];
    assert_eq!(make([[0.1, 0.2, 0.3], [0.1, 0.2, 0.3], third]), Err(BadTriangle::Line));
    assert_eq!(make([third, [0.1, 0.2, 0.3], [0.1, 0.2, 0.3]]), Err(BadTriangle::Line));
    assert_eq!(make([[-1.0; 3], [0.3; 3], [0.7; 3]]), Err(BadTriangle::Line));
    // Off a line by what double precision cannot tell, and as small as can be.
    let least = f32::from_bits(1);
    assert_eq!(make([[-1.0; 3], [0.3; 3], [0.7, 0.7, 0.7_f32.next_up()]]), Ok(()));
    assert_eq!(make([[-1.0, 0.0, 0.0], [0.0, least, 0.0], [1.0, 0.0, 0.0]]), Ok(()));
    assert_eq!(make([[0.0; 3], [least, 0.0, 0.0], [0.0, least, 0.0]]), Ok(()));
}
