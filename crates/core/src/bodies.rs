//! Traces rays among bodies of all kinds, after they were traced among spheres.

use crate::body_rows::{BodyRow, BodyRows};
use crate::body_tree::{BodyTree, FilterRay, Shape};
use crate::bounded::COARSE;
use crate::bvh::{SMALL_STACK, STACK, Search, walk};
use crate::capsules::{self, Capsule, CapsuleRow, Capsules, Part};
use crate::cones::{self, Cone, Cones};
use crate::ellipsoids::{self, Ellipsoid, Ellipsoids};
use crate::exact::{self, Distance};
use crate::intersect::{CLEAR, Root, confirm_closely};
use crate::lanes::set_bits;
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::slabs::RaySlabs;
use crate::spheres::{LEAF, Spheres};
use std::cmp::Ordering;

/// The bodies of a scene, whose hits are numbered as [`BodyRows`] says.
#[derive(Clone, Copy, Debug)]
pub struct BodyTrees<'a> {
    /// Spheres, whose hits are known.
    pub spheres: &'a Spheres,
    /// Capsules.
    pub capsules: &'a Capsules,
    /// Ellipsoids; `None` if there are none.
    pub ellipsoids: Option<&'a Ellipsoids>,
    /// Cones; `None` if there are none.
    pub cones: Option<&'a Cones>,
}

impl BodyTrees<'_> {
    /// The numbers of hits.
    #[inline(always)]
    fn rows(&self) -> BodyRows {
        BodyRows {
            spheres: self.spheres.len(),
            capsules: self.capsules.len(),
            ellipsoids: self.ellipsoids.map_or(0, Ellipsoids::len),
        }
    }

    /// The body of a hit.
    #[inline(always)]
    fn body_of(&self, hit: u32) -> Body {
        match self.rows().row(hit) {
            Some(BodyRow::Sphere(row)) => Body::Sphere(row),
            Some(BodyRow::Capsule(row)) => Body::Capsule(row.capsule, Part::Body),
            Some(BodyRow::Ellipsoid(row)) => Body::Ellipsoid(row),
            Some(BodyRow::Cone(row)) => Body::Cone(row),
            None if hit == MISS => Body::Nothing,
            None => Body::Ground,
        }
    }
}

/// Replaces each hit by one on a body that is no sphere if that is nearer. On entry hits are those of the spheres and the ground, or
/// [`MISS`] with a bound; see [`BodyTrees`] for the hits on return. Of bodies at equal distances spheres come first, then
/// capsules, ellipsoids and cones.
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
    if !bodies.capsules.is_empty() {
        exact += trace_kind::<Capsule, ANY>(bodies, bodies.capsules, rays, hits);
    }
    if let Some(ellipsoids) = bodies.ellipsoids {
        exact += trace_kind::<Ellipsoid, ANY>(bodies, ellipsoids, rays, hits);
    }
    if let Some(cones) = bodies.cones {
        exact += trace_kind::<Cone, ANY>(bodies, cones, rays, hits);
    }
    exact
}

/// Traces rays among bodies of one kind, after they were traced among those before it.
fn trace_kind<K: Kind, const ANY: bool>(
    bodies: BodyTrees,
    tree: &BodyTree<K>,
    rays: &Rays,
    hits: &mut Hits,
) -> u64 {
    let mut exact = 0;
    for row in 0..rays.len() {
        let (t, known) = (hits.t[row], hits.sphere[row]);
        if ANY && known != MISS {
            continue;
        }
        let (ray, own) = (rays.exact(row), bodies.body_of(rays.own[row]));
        let body = bodies.body_of(known);
        let nearest = match body {
            Body::Nothing | Body::Ground => Nearest { t, error: 0.0, body },
            Body::Sphere(_) => Nearest { t, error: t * CLEAR, body },
            // The exit of a ray that is inside a body: a given number.
            _ if body.is(own) => Nearest { t, error: 0.0, body: Body::Nothing },
            Body::Capsule(..) | Body::Ellipsoid(_) | Body::Cone(_) => {
                Nearest { t, error: (t * COARSE).max(f64::MIN_POSITIVE), body }
            }
        };
        let (origin, direction) = (rays.origin.row(row), rays.direction.row(row));
        let mut search = RaySearch::<K, ANY> {
            bodies,
            tree,
            filter: FilterRay::new(origin, direction),
            ray: &ray,
            own,
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
            hits.set(row, t, K::hit(&bodies, found, &ray, t));
        }
    }
    exact
}

/// A kind of body that rays are traced among.
trait Kind: Shape {
    /// Decides whether and where a ray hits a body, which is row `row` of its kind.
    fn decide(&self, ray: &ExactRay, row: usize) -> Option<(Root, Body)>;

    /// Row `row` of the kind.
    fn row(row: usize) -> Body;

    /// The number of a hit on a row of the kind.
    fn hit(bodies: &BodyTrees, row: usize, ray: &ExactRay, t: f64) -> u32;
}

impl Kind for Capsule {
    #[inline(always)]
    fn decide(&self, ray: &ExactRay, row: usize) -> Option<(Root, Body)> {
        let hit = capsules::intersect(ray, self)?;
        Some((hit.root, Body::Capsule(row, hit.part)))
    }

    #[inline(always)]
    fn row(row: usize) -> Body {
        Body::Capsule(row, Part::Body)
    }

    #[inline(always)]
    fn hit(bodies: &BodyTrees, row: usize, ray: &ExactRay, t: f64) -> u32 {
        let row = CapsuleRow::at(bodies.capsules, row, ray, t);
        bodies.rows().hit(BodyRow::Capsule(row))
    }
}

impl Kind for Ellipsoid {
    #[inline(always)]
    fn decide(&self, ray: &ExactRay, row: usize) -> Option<(Root, Body)> {
        ellipsoids::intersect(ray, self).map(|root| (root, Body::Ellipsoid(row)))
    }

    #[inline(always)]
    fn row(row: usize) -> Body {
        Body::Ellipsoid(row)
    }

    #[inline(always)]
    fn hit(bodies: &BodyTrees, row: usize, _: &ExactRay, _: f64) -> u32 {
        bodies.rows().hit(BodyRow::Ellipsoid(row))
    }
}

impl Kind for Cone {
    #[inline(always)]
    fn decide(&self, ray: &ExactRay, row: usize) -> Option<(Root, Body)> {
        cones::intersect(ray, self).map(|root| (root, Body::Cone(row)))
    }

    #[inline(always)]
    fn row(row: usize) -> Body {
        Body::Cone(row)
    }

    #[inline(always)]
    fn hit(bodies: &BodyTrees, row: usize, _: &ExactRay, _: f64) -> u32 {
        bodies.rows().hit(BodyRow::Cone(row))
    }
}

/// The nearest hit so far, or the distance at which the search ends.
#[derive(Clone, Copy)]
struct Nearest {
    t: f64,
    /// The true distance is no farther from `t` than this; 0 if `t` is a given number.
    error: f64,
    body: Body,
}

/// A body, or none.
#[derive(Clone, Copy)]
enum Body {
    Nothing,
    Ground,
    Sphere(usize),
    /// With the part of its surface that is hit.
    Capsule(usize, Part),
    Ellipsoid(usize),
    Cone(usize),
}

impl Body {
    /// Returns whether both are the same body, which is no sphere.
    #[inline(always)]
    fn is(self, other: Self) -> bool {
        match (self, other) {
            (Self::Capsule(row, _), Self::Capsule(other, _))
            | (Self::Ellipsoid(row), Self::Ellipsoid(other))
            | (Self::Cone(row), Self::Cone(other)) => row == other,
            _ => false,
        }
    }
}

impl Nearest {
    /// A distance beyond which nothing counts.
    #[inline(always)]
    fn far(&self) -> f32 {
        ((self.t + self.error) as f32).next_up()
    }
}

/// A search for the hit of one ray.
struct RaySearch<'a, K: Kind, const ANY: bool> {
    bodies: BodyTrees<'a>,
    tree: &'a BodyTree<K>,
    filter: FilterRay,
    ray: &'a ExactRay,
    /// The body that the ray starts on: it is convex, and never hit from outside.
    own: Body,
    nearest: Nearest,
    /// The row that is hit.
    found: Option<usize>,
    t_far: f32,
    exact: u64,
}

impl<K: Kind, const ANY: bool> Search for RaySearch<'_, K, ANY> {
    const ANY: bool = ANY;
    type Block = K::Block;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.t_far
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &K::Block) -> bool {
        let (lanes, near) = K::may_hit(&self.filter, block, self.t_far);
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

impl<K: Kind, const ANY: bool> RaySearch<'_, K, ANY> {
    /// Tests the ray against a body, and keeps the hit if it is nearer than the one so far. Returns whether it is.
    #[inline(never)]
    fn test(&mut self, row: usize) -> bool {
        if self.own.is(K::row(row)) {
            return false;
        }
        let Some((root, body)) = self.tree.body(row).decide(self.ray, row) else { return false };
        self.exact += u64::from(root.exact);
        let nearer = self.is_nearer(&root, body);
        if nearer {
            self.nearest = Nearest { t: root.t, error: root.error, body };
            self.found = Some(row);
            self.t_far = self.nearest.far();
        }
        nearer
    }

    #[inline(always)]
    fn is_nearer(&mut self, root: &Root, body: Body) -> bool {
        let (Root { t, error, .. }, nearest) = (*root, self.nearest);
        if t + error < nearest.t - nearest.error {
            return true;
        }
        if t - error > nearest.t + nearest.error {
            return false;
        }
        match self.compare(root, body) {
            Ordering::Less => true,
            Ordering::Equal => !ANY && self.precedes(body),
            Ordering::Greater => false,
        }
    }

    /// Compares distances that are closer than their errors.
    #[cold]
    fn compare(&mut self, root: &Root, body: Body) -> Ordering {
        if self.coincides(body) {
            return Ordering::Equal;
        }
        let Nearest { t, error, body: nearest } = self.nearest;
        let number = Root { t, error: 0.0, exact: false };
        let known = if error == 0.0 { number } else { self.decide(nearest).unwrap_or(number) };
        let gap = root.t - known.t;
        if gap.abs() > root.error + known.error {
            return gap.total_cmp(&0.0);
        }
        self.exact += 1;
        let (own, known) = (self.distance(root, body), self.distance(&known, nearest));
        exact::compare(self.ray, &own, &known)
    }

    /// Decides where the ray hits the nearest body so far, with a close bound.
    fn decide(&self, body: Body) -> Option<Root> {
        let BodyTrees { spheres, capsules, ellipsoids, cones } = self.bodies;
        match body {
            Body::Nothing | Body::Ground => None,
            Body::Sphere(row) => {
                let (center, radius) = spheres.exact(row);
                confirm_closely(self.ray, center, radius, || false)
            }
            Body::Capsule(row, _) => capsules.body(row).decide(self.ray, row).map(|hit| hit.0),
            Body::Ellipsoid(row) => ellipsoids?.body(row).decide(self.ray, row).map(|hit| hit.0),
            Body::Cone(row) => cones?.body(row).decide(self.ray, row).map(|hit| hit.0),
        }
    }

    /// The distance of a hit without rounding. One without error is a given number: a bound, or 0 where the ray starts on a
    /// body.
    fn distance(&self, root: &Root, body: Body) -> Distance {
        let BodyTrees { spheres, capsules, ellipsoids, cones } = self.bodies;
        let distance = match body {
            _ if root.error == 0.0 => None,
            Body::Sphere(row) => {
                let (center, radius) = spheres.exact(row);
                Some(Distance::Hit(center, radius))
            }
            Body::Capsule(row, _) => Some(Distance::Capsule(capsules.body(row))),
            Body::Ellipsoid(row) => ellipsoids.map(|all| Distance::Ellipsoid(all.body(row))),
            Body::Cone(row) => cones.map(|all| Distance::Cone(all.body(row))),
            Body::Nothing | Body::Ground => None,
        };
        distance.unwrap_or(Distance::Number(root.t))
    }

    /// Returns whether the part of the surface is also that of the nearest hit: of molecules drawn with sticks, ends
    /// coincide with atoms and with ends of other sticks.
    fn coincides(&self, body: Body) -> bool {
        let BodyTrees { spheres, capsules, ellipsoids, cones } = self.bodies;
        match (body, self.nearest.body) {
            (Body::Capsule(row, part), Body::Capsule(other, other_part)) => {
                let (capsule, other) = (capsules.body(row), capsules.body(other));
                capsule == other
                    || matches!((part, other_part), (Part::End(end), Part::End(other_end))
                        if (capsule.ends[end], capsule.radius) == (other.ends[other_end], other.radius))
            }
            (Body::Capsule(row, Part::End(end)), Body::Sphere(sphere)) => {
                let capsule = capsules.body(row);
                (capsule.ends[end], capsule.radius) == spheres.exact(sphere)
            }
            (Body::Ellipsoid(row), Body::Ellipsoid(other)) => {
                ellipsoids.is_some_and(|all| all.body(row) == all.body(other))
            }
            (Body::Cone(row), Body::Cone(other)) => {
                cones.is_some_and(|all| all.body(row) == all.body(other))
            }
            _ => false,
        }
    }

    /// Returns whether a body comes before the nearest hit, which is at the same distance: spheres come first, then capsules,
    /// ellipsoids and cones, the ground last, and a bound is no hit.
    fn precedes(&self, body: Body) -> bool {
        let id = self.tree.ids();
        match (body, self.nearest.body) {
            (_, Body::Ground) => true,
            (Body::Capsule(row, _), Body::Capsule(other, _))
            | (Body::Ellipsoid(row), Body::Ellipsoid(other))
            | (Body::Cone(row), Body::Cone(other)) => id[row] < id[other],
            _ => false,
        }
    }
}
