//! Traces rays among capsules, after they were traced among spheres.

use super::filter::FilterRay;
use super::{CapsuleBlock, CapsuleHit, CapsuleRow, Capsules, Part, intersect};
use crate::bvh::{SMALL_STACK, STACK, Search, walk};
use crate::exact::{self, Distance};
use crate::intersect::{CLEAR, Root, confirm_closely};
use crate::lanes::set_bits;
use crate::ray::{ExactRay, GROUND, Hits, MISS, Rays};
use crate::slabs::RaySlabs;
use crate::spheres::{LEAF, Spheres};
use glam::DVec3;
use std::cmp::Ordering;

/// The bodies of a scene.
#[derive(Clone, Copy, Debug)]
pub struct BodyTrees<'a> {
    /// Spheres, whose hits are known.
    pub spheres: &'a Spheres,
    /// Capsules.
    pub capsules: &'a Capsules,
}

/// Replaces each hit by one on a capsule if that is nearer. On entry hits are those of the spheres and the ground, or
/// [`MISS`] with a bound; see [`CapsuleRow`] for the hits on return. Of bodies at equal distances spheres come first.
///
/// Returns how many decisions were made on integers.
pub fn closest(bodies: BodyTrees, rays: &Rays, hits: &mut Hits) -> u64 {
    trace::<false>(bodies, rays, hits)
}

/// Finds whether each ray that has no hit yet hits a capsule nearer than `hits.t`.
///
/// Returns how many decisions were made on integers.
pub fn occluded(bodies: BodyTrees, rays: &Rays, hits: &mut Hits) -> u64 {
    trace::<true>(bodies, rays, hits)
}

/// Returns the capsule that contains a point, not on its surface; of several the first in the user's order. Decided in double
/// precision: a point that is on a surface but for rounding may be called either.
pub fn enclosing_capsule(capsules: &Capsules, point: DVec3) -> Option<usize> {
    let mut found: Option<usize> = None;
    for_each_around(capsules, point, |row| {
        if found.is_none_or(|known| capsules.id[row] < capsules.id[known]) {
            found = Some(row);
        }
    });
    found
}

/// Returns all capsules that contain a point, in the user's order.
pub fn enclosing_capsules(capsules: &Capsules, point: DVec3) -> Vec<usize> {
    let mut found = Vec::new();
    for_each_around(capsules, point, |row| found.push(row));
    found.sort_unstable_by_key(|&row| capsules.id[row]);
    found
}

/// Calls a function with each capsule that contains a point.
fn for_each_around(capsules: &Capsules, point: DVec3, mut visit: impl FnMut(usize)) {
    capsules.bvh.for_each_block_at(point.as_vec3(), |block| {
        let rows = block * LEAF..capsules.len().min((block + 1) * LEAF);
        rows.filter(|&row| capsules.capsule(row).contains(point)).for_each(&mut visit);
    });
}

fn trace<const ANY: bool>(bodies: BodyTrees, rays: &Rays, hits: &mut Hits) -> u64 {
    let BodyTrees { spheres, capsules } = bodies;
    let mut exact = 0;
    for row in 0..rays.len() {
        let (t, known) = (hits.t[row], hits.sphere[row]);
        if ANY && known != MISS {
            continue;
        }
        let ray = rays.exact(row);
        let nearest = match known {
            MISS => Nearest { t, error: 0.0, body: Body::Nothing },
            GROUND => Nearest { t, error: 0.0, body: Body::Ground },
            sphere if (sphere as usize) < spheres.len() => {
                Nearest { t, error: t * CLEAR, body: Body::Sphere(sphere as usize) }
            }
            // The exit of a ray that is inside a capsule: a given number.
            _ => Nearest { t, error: 0.0, body: Body::Nothing },
        };
        let (origin, direction) = (rays.origin.row(row), rays.direction.row(row));
        let mut search = RaySearch::<ANY> {
            bodies,
            filter: FilterRay::new(origin, direction),
            ray: &ray,
            own: CapsuleRow::of_hit(rays.own[row], spheres.len()).map(|own| own.capsule),
            nearest,
            t_far: nearest.far(),
            exact: 0,
        };
        let (blocks, slabs) = (&*capsules.blocks, RaySlabs::new(origin, direction));
        if walk::<_, SMALL_STACK>(&capsules.bvh, blocks, &slabs, &mut search).is_none() {
            walk::<_, STACK>(&capsules.bvh, blocks, &slabs, &mut search);
        }
        exact += search.exact;
        if let Nearest { t, body: Body::Capsule(capsule, _), .. } = search.nearest {
            hits.set(row, t, capsules.row_at(capsule, &ray, t).hit(spheres.len()));
        }
    }
    exact
}

/// The nearest hit so far, or the distance at which the search ends.
#[derive(Clone, Copy)]
struct Nearest {
    t: f64,
    /// The true distance is no farther from `t` than this; 0 if `t` is a given number.
    error: f64,
    body: Body,
}

#[derive(Clone, Copy)]
enum Body {
    Nothing,
    Ground,
    Sphere(usize),
    Capsule(usize, Part),
}

impl Nearest {
    /// A distance beyond which nothing counts.
    #[inline(always)]
    fn far(&self) -> f32 {
        ((self.t + self.error) as f32).next_up()
    }
}

/// A search for the hit of one ray.
struct RaySearch<'a, const ANY: bool> {
    bodies: BodyTrees<'a>,
    filter: FilterRay,
    ray: &'a ExactRay,
    /// The capsule that the ray starts on: it is convex, and never hit from outside.
    own: Option<usize>,
    nearest: Nearest,
    t_far: f32,
    exact: u64,
}

impl<const ANY: bool> Search for RaySearch<'_, ANY> {
    const ANY: bool = ANY;
    type Block = CapsuleBlock;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.t_far
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &CapsuleBlock) -> bool {
        let (lanes, near) = self.filter.may_hit(block, self.t_far);
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

impl<const ANY: bool> RaySearch<'_, ANY> {
    /// Tests the ray against a capsule, and keeps the hit if it is nearer than the one so far. Returns whether it is.
    #[inline(never)]
    fn test(&mut self, row: usize) -> bool {
        if self.own == Some(row) {
            return false;
        }
        let Some(hit) = intersect(self.ray, &self.bodies.capsules.capsule(row)) else {
            return false;
        };
        self.exact += u64::from(hit.root.exact);
        let nearer = self.is_nearer(row, &hit);
        if nearer {
            let Root { t, error, .. } = hit.root;
            self.nearest = Nearest { t, error, body: Body::Capsule(row, hit.part) };
            self.t_far = self.nearest.far();
        }
        nearer
    }

    #[inline(always)]
    fn is_nearer(&mut self, row: usize, hit: &CapsuleHit) -> bool {
        let (Root { t, error, .. }, nearest) = (hit.root, self.nearest);
        if t + error < nearest.t - nearest.error {
            return true;
        }
        if t - error > nearest.t + nearest.error {
            return false;
        }
        match self.compare(row, hit) {
            Ordering::Less => true,
            Ordering::Equal => !ANY && self.precedes(row),
            Ordering::Greater => false,
        }
    }

    /// Compares distances that are closer than their errors.
    #[cold]
    fn compare(&mut self, row: usize, hit: &CapsuleHit) -> Ordering {
        if self.coincides(row, hit.part) {
            return Ordering::Equal;
        }
        let Nearest { t, error, body } = self.nearest;
        let number = (Root { t, error: 0.0, exact: false }, Distance::Number(t));
        let known = match body {
            _ if error == 0.0 => number,
            Body::Nothing | Body::Ground => number,
            Body::Capsule(other, _) => {
                let capsule = self.bodies.capsules.capsule(other);
                (Root { t, error, exact: false }, Distance::Capsule(capsule))
            }
            Body::Sphere(sphere) => {
                let (center, radius) = self.bodies.spheres.exact(sphere);
                match confirm_closely(self.ray, center, radius, || false) {
                    Some(root) if root.error > 0.0 => (root, Distance::Hit(center, radius)),
                    // The sphere is hit at once, where the ray starts.
                    _ => number,
                }
            }
        };
        let gap = hit.root.t - known.0.t;
        if gap.abs() > hit.root.error + known.0.error {
            return gap.total_cmp(&0.0);
        }
        let own = if hit.root.error == 0.0 {
            Distance::Number(hit.root.t)
        } else {
            Distance::Capsule(self.bodies.capsules.capsule(row))
        };
        self.exact += 1;
        exact::compare(self.ray, &own, &known.1)
    }

    /// Returns whether the part of the surface is also that of the nearest hit: of molecules drawn with sticks, ends
    /// coincide with atoms and with ends of other sticks.
    fn coincides(&self, row: usize, part: Part) -> bool {
        let BodyTrees { spheres, capsules } = self.bodies;
        let capsule = capsules.capsule(row);
        match (part, self.nearest.body) {
            (_, Body::Capsule(other, _)) if capsules.capsule(other) == capsule => true,
            (Part::End(end), Body::Capsule(other, Part::End(other_end))) => {
                let other = capsules.capsule(other);
                (capsule.ends[end], capsule.radius) == (other.ends[other_end], other.radius)
            }
            (Part::End(end), Body::Sphere(sphere)) => {
                (capsule.ends[end], capsule.radius) == spheres.exact(sphere)
            }
            _ => false,
        }
    }

    /// Returns whether a capsule comes before the nearest hit, which is at the same distance: spheres come first, the ground
    /// last, and a bound is no hit.
    fn precedes(&self, row: usize) -> bool {
        let id = &self.bodies.capsules.id;
        match self.nearest.body {
            Body::Nothing | Body::Sphere(_) => false,
            Body::Ground => true,
            Body::Capsule(other, _) => id[row] < id[other],
        }
    }
}
