//! Traces rays among bodies of all kinds, after they were traced among spheres.

use crate::body_rows::{BodyKind, BodyRow, BodyRows};
use crate::body_tree::{Body, BodyHit, BodyTree, FilterRay, Part, Shape, Sphere};
use crate::bounded::COARSE;
use crate::bvh::{Beam, SMALL_STACK, STACK, Search, Tree, walk};
use crate::capsules::Capsules;
use crate::cones::Cones;
use crate::ellipsoids::Ellipsoids;
use crate::exact::{Distance, Quotient};
use crate::intersect::{CLEAR, Root};
use crate::lanes::set_bits;
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::slabs::RaySlabs;
use crate::spheres::LEAF;
use crate::triangles::Triangles;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// The bodies of a scene, whose hits are numbered as [`BodyRows`] says. Of a kind of which there are none, the tree may be `None`.
#[derive(Clone, Copy, Debug)]
pub struct BodyTrees<'a> {
    /// Spheres and their tree.
    pub tree: Tree<'a>,
    /// Capsules.
    pub capsules: Option<&'a Capsules>,
    /// Ellipsoids.
    pub ellipsoids: Option<&'a Ellipsoids>,
    /// Cones.
    pub cones: Option<&'a Cones>,
    /// Triangles.
    pub triangles: Option<&'a Triangles>,
}

/// Evaluates an expression of the tree of a kind, whatever its type: the one place where kinds are told apart. `None` for spheres, and
/// where there is no tree.
macro_rules! with_tree {
    ($bodies:expr, $kind:expr, |$tree:ident| $value:expr) => {
        match $kind {
            BodyKind::Sphere => None,
            BodyKind::Capsule => $bodies.capsules.map(|$tree| $value),
            BodyKind::Ellipsoid => $bodies.ellipsoids.map(|$tree| $value),
            BodyKind::Cone => $bodies.cones.map(|$tree| $value),
            BodyKind::Triangle => $bodies.triangles.map(|$tree| $value),
        }
    };
}
pub(crate) use with_tree;

/// Evaluates an expression of a body, whatever its kind.
macro_rules! with_body {
    ($bodies:expr, $row:expr, |$body:ident| $value:expr) => {{
        let (bodies, BodyRow { kind, row, .. }) = (&$bodies, $row);
        if kind == BodyKind::Sphere {
            let $body = bodies.sphere(row);
            Some($value)
        } else {
            with_tree!(bodies, kind, |tree| {
                let $body = tree.body(row);
                $value
            })
        }
    }};
}

impl<'a> BodyTrees<'a> {
    /// Spheres, and no other bodies.
    pub fn of_spheres(tree: Tree<'a>) -> Self {
        Self { tree, capsules: None, ellipsoids: None, cones: None, triangles: None }
    }

    /// The numbers of hits.
    #[inline(always)]
    pub fn rows(&self) -> BodyRows {
        BodyRows(BodyKind::ALL.map(|kind| match kind {
            BodyKind::Sphere => self.tree.spheres.len(),
            _ => with_tree!(self, kind, |tree| tree.len()).unwrap_or(0),
        }))
    }

    /// The kinds other than spheres of which there are bodies.
    #[inline(always)]
    pub fn other_kinds(self) -> impl Iterator<Item = BodyKind> {
        BodyKind::ALL.into_iter().filter(move |&kind| !self.ids(kind).is_empty())
    }

    /// Places in the user's order of the bodies of a kind that is not that of spheres, by row.
    #[inline(always)]
    pub fn ids(&self, kind: BodyKind) -> &'a [u32] {
        with_tree!(self, kind, |tree| tree.ids()).unwrap_or_default()
    }

    /// Returns whether any ray in a beam may hit a body: never false if one does.
    pub fn may_be_hit(&self, beam: &Beam) -> bool {
        let other = |kind| with_tree!(self, kind, |tree| tree.may_be_hit(beam)) == Some(true);
        self.tree.bvh.may_be_hit(self.tree.spheres, beam) || BodyKind::ALL.into_iter().any(other)
    }

    /// Spheres that stand for a body where only what surrounds it counts.
    pub fn around(&self, row: BodyRow) -> impl Iterator<Item = Sphere> {
        (0..row.kind.hits()).map(move |half| self.like_sphere(BodyRow { half, ..row }))
    }

    /// The place of a body among those of its kind in the user's order.
    pub fn id(&self, BodyRow { kind, row, .. }: BodyRow) -> u32 {
        with_tree!(self, kind, |tree| tree.ids()[row]).unwrap_or_else(|| self.tree.spheres.id[row])
    }

    /// Returns the hit on the cap of the body that contains a point; `None` if none does.
    pub fn enclosing(&self, point: Vec3) -> Option<u32> {
        let others = |kind| {
            with_tree!(self, kind, |tree| {
                tree.enclosing(point.as_dvec3()).map(|row| self.cap(tree, row, point))
            })?
        };
        let sphere = self.tree.bvh.enclosing_sphere(self.tree.spheres, point);
        sphere.or_else(|| BodyKind::ALL.into_iter().find_map(others))
    }

    /// Returns the hits on the caps of all bodies that contain a point, in their order on the cut: the first is that of
    /// [`BodyTrees::enclosing`].
    pub fn all_enclosing(self, point: Vec3) -> impl Iterator<Item = u32> {
        let others = move |kind| {
            with_tree!(self, kind, |tree| {
                let rows = tree.all_enclosing(point.as_dvec3()).into_iter();
                rows.map(|row| self.cap(tree, row, point)).collect::<Vec<_>>()
            })
        };
        let spheres = self.tree.bvh.enclosing_spheres(self.tree.spheres, point);
        spheres.into_iter().chain(BodyKind::ALL.into_iter().filter_map(others).flatten())
    }

    /// The hit on the cap of a body at a point.
    fn cap<S: Shape>(&self, tree: &BodyTree<S>, row: usize, point: Vec3) -> u32 {
        let origin = point.as_dvec3();
        let ray = ExactRay { origin, direction: DVec3::ZERO, origin_error: 0.0 };
        self.rows().hit(row_at(tree, row, &ray, 0.0))
    }

    /// Returns the point of the surface where a ray hits a body, rounded, and the unit normal there; `None` for a sphere.
    pub fn surface_at(&self, row: BodyRow, ray: &ExactRay, t: f64) -> Option<(Vec3, DVec3)> {
        with_tree!(self, row.kind, |tree| rounded_surface(&tree.body(row.row), ray, t))
    }

    /// Returns the outward unit normal at a point of a body's surface, or of a surface without inside that on the side of a direction; `None`
    /// for a sphere.
    pub fn normal_at(&self, row: BodyRow, point: DVec3, toward: DVec3) -> Option<DVec3> {
        with_tree!(self, row.kind, |tree| normal_toward(&tree.body(row.row), point, toward))
    }

    /// Returns the distance at which a ray that starts on or in a body leaves it; `None` for a sphere.
    pub fn exit_distance(&self, row: BodyRow, ray: &ExactRay) -> Option<f64> {
        with_tree!(self, row.kind, |tree| tree.body(row.row).exit_distance(ray))
    }

    /// Returns a sphere that stands for a body where only its place and size count.
    pub fn like_sphere(&self, row: BodyRow) -> Sphere {
        let other = with_tree!(self, row.kind, |tree| tree.body(row.row).like_sphere(row.half));
        other.unwrap_or_else(|| self.sphere(row.row))
    }

    /// A row of the spheres.
    pub(crate) fn sphere(&self, row: usize) -> Sphere {
        let (center, radius) = self.tree.spheres.exact(row);
        Sphere { center, radius }
    }

    /// Decides where a ray hits a body, with a close bound.
    pub(crate) fn decide(&self, ray: &ExactRay, row: BodyRow) -> Option<BodyHit> {
        with_body!(self, row, |body| body.hit(ray))?
    }

    /// The distance of a hit without rounding. One without error is a given number: a bound, or 0 where the ray starts on a
    /// body.
    pub(crate) fn distance(&self, ray: &ExactRay, root: &Root, row: Option<BodyRow>) -> Quotient {
        let body = row.filter(|_| root.error != 0.0);
        let distance = body.and_then(|row| with_body!(self, row, |body| body.distance(ray)));
        distance.unwrap_or_else(|| Distance::Number(root.t).value(ray))
    }

    /// The sphere whose surface a part of a body's surface is. In molecules drawn with sticks the ends of these coincide with
    /// atoms and with each other.
    pub(crate) fn sphere_of(&self, row: BodyRow, part: Part) -> Option<Sphere> {
        with_body!(self, row, |body| body.sphere_of(part))?
    }
}

/// The point and the normal where a ray hits a body. That of a surface without inside is rounded to the side of the normal: rays that leave it
/// there do not hit what continues the surface.
fn rounded_surface<S: Shape>(body: &S, ray: &ExactRay, t: f64) -> (Vec3, DVec3) {
    let (point, normal) = body.surface_at(ray, t);
    let rounded = point.as_vec3();
    if S::HAS_INSIDE {
        return (rounded, normal);
    }
    let beside = |axis: usize| {
        let (own, side) = (rounded[axis], normal[axis]);
        let off = f64::from(own) - point[axis];
        match off * side {
            0.0.. => own,
            _ if side > 0.0 => own.next_up(),
            _ => own.next_down(),
        }
    };
    (Vec3::from([0, 1, 2].map(beside)), normal)
}

fn normal_toward<S: Shape>(body: &S, point: DVec3, toward: DVec3) -> DVec3 {
    let normal = body.normal_at(point);
    if !S::HAS_INSIDE && normal.dot(toward) < 0.0 { -normal } else { normal }
}

/// The body of a hit on a row of a kind.
pub(crate) fn row_at<S: Shape>(tree: &BodyTree<S>, row: usize, ray: &ExactRay, t: f64) -> BodyRow {
    let half = if S::KIND.hits() > 1 { tree.body(row).half_at(ray, t) } else { 0 };
    BodyRow { kind: S::KIND, row, half }
}

/// Replaces each hit by one on a body that is no sphere if that is nearer. On entry hits are those of the spheres and the ground, or
/// [`MISS`] with a bound; see [`BodyTrees`] for the hits on return. Of bodies at equal distances spheres come first, then
/// capsules, ellipsoids, cones and triangles.
///
/// Returns how many decisions were made on integers.
pub fn closest(bodies: BodyTrees, rays: &Rays, hits: &mut Hits) -> u64 {
    trace::<false>(bodies, rays, hits)
}

/// Finds whether each ray that has no hit yet hits a body that is no sphere nearer than `hits.t`.
///
/// Returns how many decisions were made on integers.
pub fn occluded(bodies: BodyTrees, rays: &Rays, hits: &mut Hits) -> u64 {
    trace::<true>(bodies, rays, hits)
}

fn trace<const ANY: bool>(bodies: BodyTrees, rays: &Rays, hits: &mut Hits) -> u64 {
    let mut exact = 0;
    for kind in BodyKind::ALL {
        let found = with_tree!(bodies, kind, |tree| if tree.is_empty() {
            0
        } else {
            trace_kind::<_, ANY>(bodies, tree, rays, hits)
        });
        exact += found.unwrap_or(0);
    }
    exact
}

/// Traces rays among bodies of one kind, after they were traced among those before it.
fn trace_kind<S: Shape, const ANY: bool>(
    bodies: BodyTrees,
    tree: &BodyTree<S>,
    rays: &Rays,
    hits: &mut Hits,
) -> u64 {
    let (rows, mut exact) = (bodies.rows(), 0);
    for row in 0..rays.len() {
        let (t, known) = (hits.t[row], hits.sphere[row]);
        if ANY && known != MISS {
            continue;
        }
        let (ray, own) = (rays.exact(row), rows.row(rays.own[row]));
        let body = match rows.row(known) {
            Some(body) => Known::Body(body, Part::Body),
            None if known == MISS => Known::Nothing,
            None => Known::Ground,
        };
        let nearest = match body {
            Known::Body(BodyRow { kind: BodyKind::Sphere, .. }, _) => {
                Nearest { t, error: t * CLEAR, body }
            }
            // The exit of a ray that is inside a body: a given number.
            Known::Body(body, _) if own.is_some_and(|own| is_same(body, own)) => {
                Nearest { t, error: 0.0, body: Known::Nothing }
            }
            Known::Body(..) => Nearest { t, error: (t * COARSE).max(f64::MIN_POSITIVE), body },
            Known::Nothing | Known::Ground => Nearest { t, error: 0.0, body },
        };
        let (origin, direction) = (rays.origin.row(row), rays.direction.row(row));
        let mut search = RaySearch::<S, ANY> {
            bodies,
            tree,
            filter: FilterRay::new(origin, direction),
            ray: &ray,
            own: own.filter(|own| own.kind == S::KIND).map(|own| own.row),
            nearest,
            found: None,
            t_far: nearest.far(),
            exact: 0,
        };
        let ((blocks, bvh), slabs) = (tree.parts(), RaySlabs::new(origin, direction));
        if walk::<_, SMALL_STACK>(bvh, blocks, &slabs, &mut search).is_none() {
            walk::<_, STACK>(bvh, blocks, &slabs, &mut search);
        }
        exact += search.exact;
        if let Some(found) = search.found {
            let t = search.nearest.t;
            hits.set(row, t, rows.hit(row_at(tree, found, &ray, t)));
        }
    }
    exact
}

/// Returns whether two hits are on the same body.
fn is_same(a: BodyRow, b: BodyRow) -> bool {
    (a.kind, a.row) == (b.kind, b.row)
}

/// The nearest hit so far, or the distance at which the search ends.
#[derive(Clone, Copy)]
struct Nearest {
    t: f64,
    /// The true distance is no farther from `t` than this; 0 if `t` is a given number.
    error: f64,
    body: Known,
}

/// The body that is known to be at a distance along a ray, if any.
#[derive(Clone, Copy)]
enum Known {
    Nothing,
    Ground,
    /// A body, and the part of its surface that is hit; any part of one that other kinds are compared with.
    Body(BodyRow, Part),
}

impl Nearest {
    /// A distance beyond which nothing counts.
    #[inline(always)]
    fn far(&self) -> f32 {
        ((self.t + self.error) as f32).next_up()
    }
}

/// A search for the hit of one ray.
struct RaySearch<'a, S: Shape, const ANY: bool> {
    bodies: BodyTrees<'a>,
    tree: &'a BodyTree<S>,
    filter: FilterRay,
    ray: &'a ExactRay,
    /// The row that the ray starts on: it is convex or flat, and never hit from outside.
    own: Option<usize>,
    nearest: Nearest,
    /// The row that is hit.
    found: Option<usize>,
    t_far: f32,
    exact: u64,
}

impl<S: Shape, const ANY: bool> Search for RaySearch<'_, S, ANY> {
    const ANY: bool = ANY;
    type Block = S::Block;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.t_far
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &S::Block) -> bool {
        let (lanes, near) = S::may_hit(&self.filter, block, self.t_far);
        if lanes == 0 {
            return false;
        }
        let near = near.to_array();
        for lane in set_bits(lanes) {
            if near[lane] > self.t_far {
                continue;
            }
            if self.test(index * LEAF + lane) && ANY {
                return true;
            }
        }
        false
    }
}

impl<S: Shape, const ANY: bool> RaySearch<'_, S, ANY> {
    /// Tests the ray against a body, and keeps the hit if it is nearer than the one so far. Returns whether it is.
    #[inline(never)]
    fn test(&mut self, row: usize) -> bool {
        if self.own == Some(row) {
            return false;
        }
        let body = self.tree.body(row);
        let Some(hit) = body.intersect(self.ray) else { return false };
        self.exact += u64::from(hit.root.exact);
        let nearer = self.is_nearer(&hit, &body, row);
        if nearer {
            let BodyHit { root: Root { t, error, .. }, part } = hit;
            let known = Known::Body(BodyRow::new(S::KIND, row), part);
            self.nearest = Nearest { t, error, body: known };
            self.found = Some(row);
            self.t_far = self.nearest.far();
        }
        nearer
    }

    #[inline(always)]
    fn is_nearer(&mut self, hit: &BodyHit, body: &S, row: usize) -> bool {
        let (Root { t, error, .. }, nearest) = (hit.root, self.nearest);
        if t + error < nearest.t - nearest.error {
            return true;
        }
        if t - error > nearest.t + nearest.error {
            return false;
        }
        match self.compare(hit, body) {
            Ordering::Less => true,
            Ordering::Equal => !ANY && self.precedes(row),
            Ordering::Greater => false,
        }
    }

    /// Compares distances that are closer than their errors.
    #[cold]
    fn compare(&mut self, hit: &BodyHit, body: &S) -> Ordering {
        let Nearest { t, error, body: nearest } = self.nearest;
        let number = Root { t, error: 0.0, exact: false };
        let (mut known, mut nearest_row) = (number, None);
        if let Known::Body(row, part) = nearest {
            if self.coincides(hit, body, row, part) {
                return Ordering::Equal;
            }
            nearest_row = Some(row);
            if error != 0.0 {
                known = self.bodies.decide(self.ray, row).map_or(number, |hit| hit.root);
            }
        }
        let gap = hit.root.t - known.t;
        if gap.abs() > hit.root.error + known.error {
            return gap.total_cmp(&0.0);
        }
        self.exact += 1;
        let own = if hit.root.error == 0.0 {
            Distance::Number(hit.root.t).value(self.ray)
        } else {
            Body::distance(body, self.ray)
        };
        own.compare(&self.bodies.distance(self.ray, &known, nearest_row))
    }

    /// Returns whether the part of the surface is also that of the nearest hit: the body may be there twice, and of molecules drawn
    /// with sticks, ends coincide with atoms and with ends of other sticks.
    fn coincides(&self, hit: &BodyHit, body: &S, nearest: BodyRow, part: Part) -> bool {
        if nearest.kind == S::KIND && self.tree.body(nearest.row) == *body {
            return true;
        }
        let sphere = body.end_sphere(hit.part);
        sphere.is_some() && self.bodies.sphere_of(nearest, part) == sphere
    }

    /// Returns whether a body comes before the nearest hit, which is at the same distance: kinds come in their order, the
    /// ground last, and a bound is no hit.
    fn precedes(&self, row: usize) -> bool {
        let id = self.tree.ids();
        match self.nearest.body {
            Known::Ground => true,
            Known::Body(nearest, _) => nearest.kind == S::KIND && id[row] < id[nearest.row],
            Known::Nothing => false,
        }
    }
}
