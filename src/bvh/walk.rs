//! One walk for every lane count, every query, with the tree or without.
//!
//! A packet of `L::WIDTH` rays goes through the tree together: a node is opened if any of its rays
//! may meet the box, and each ray keeps its own bound. `L = f32` is the scalar walk. Brute force is
//! the same leaf test over all spheres: the oracle.
//!
//! What is hit is decided by [`intersect::confirm`] alone, and equal distances go to the sphere
//! that comes first in the user's scene. Node order, packets and bounds only decide how soon the
//! answer is found, never which it is.

use super::{Bvh, Content, Node};
use crate::exact::{self, Distance};
use crate::intersect::{self, FilterRay, Root, SlabRay};
use crate::lanes::{Lanes, MAX_LANES, Mask, set_bits};
use crate::ray::{ExactRay, Hits, MISS, Rays};
use crate::spheres::Spheres;
use crate::vec3::Vec3;
use glam::DVec3;
use std::cmp::Ordering;
use std::marker::PhantomData;

/// Room for the nodes still to visit: a tree over 2^32 spheres is at most 31 levels deep.
pub(super) const STACK: usize = 40;

/// What a walk wants to know.
pub trait Query {
    /// Whether any hit ends a ray's walk.
    const ANY: bool;
    /// Whether hits are decided exactly.
    const EXACT: bool = true;
}

/// Which sphere is hit first: leaves `t` and `sphere` of the hit.
pub struct Closest;

/// Whether anything is hit nearer than `t`: leaves some sphere, or what was there.
pub struct Any;

/// A query that takes the filter's word for hits and distances, in single precision. For benches
/// alone: what it saves is what exactness costs.
pub struct Rough<Q>(PhantomData<Q>);

impl<Q: Query> Query for Rough<Q> {
    const ANY: bool = Q::ANY;
    const EXACT: bool = false;
}

impl Query for Closest {
    const ANY: bool = false;
}

impl Query for Any {
    const ANY: bool = true;
}

/// How rays find spheres. The answer is the same whichever it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Test every sphere.
    Brute,
    /// Walk the tree.
    Tree,
    /// Walk the tree, in packets where all rays go into one octant and one by one elsewhere: for rays
    /// that have been scattered, in a tree that is larger than what a packet would visit anyway.
    Mixed,
}

/// Traces all rays in packets of `L::WIDTH`; `hits` holds bounds on entry, answers on return.
///
/// Returns how many decisions took arithmetic without rounding.
pub fn trace<L: Lanes, Q: Query>(
    method: Method,
    bvh: &Bvh,
    spheres: &Spheres,
    rays: &Rays,
    hits: &mut Hits,
) -> u64 {
    let mut exact = 0;
    for row in (0..rays.len()).step_by(L::WIDTH) {
        if method == Method::Mixed && !go_alike::<L>(rays, row) {
            for single in row..rays.len().min(row + L::WIDTH) {
                let mut ray = Packet::<f32, Q>::new(spheres, rays, hits, single);
                ray.walk(bvh.nodes());
                exact += ray.exact;
            }
            continue;
        }
        let mut packet = Packet::<L, Q>::new(spheres, rays, hits, row);
        match method {
            Method::Brute => packet.leaf(0, spheres.len()),
            Method::Tree | Method::Mixed => packet.walk(bvh.nodes()),
        }
        exact += packet.exact;
    }
    exact
}

/// Whether the rays of a packet all go into one octant.
#[inline(always)]
fn go_alike<L: Lanes>(rays: &Rays, row: usize) -> bool {
    let lanes = L::WIDTH.min(rays.len() - row);
    let all = u32::MAX >> (u32::BITS as usize - lanes);
    let direction = rays.direction.load::<L>(row);
    [direction.x, direction.y, direction.z].iter().all(|axis| {
        let negative = axis.is_negative().bits() & all;
        negative == 0 || negative == all
    })
}

/// Rays `row..row + L::WIDTH` on their way through the tree.
struct Packet<'a, L: Lanes, Q> {
    spheres: &'a Spheres,
    rays: &'a Rays,
    hits: &'a mut Hits,
    row: usize,
    filter: FilterRay<L>,
    slab: SlabRay<L>,
    /// Upper bounds of the distances that still count, rounded up; below 0 for a lane that is done.
    t_max: L,
    /// By how much each lane's distance may be off.
    error: [f64; MAX_LANES],
    /// How often arithmetic without rounding was needed.
    exact: u64,
    query: PhantomData<Q>,
}

impl<'a, L: Lanes, Q: Query> Packet<'a, L, Q> {
    #[inline(always)]
    fn new(spheres: &'a Spheres, rays: &'a Rays, hits: &'a mut Hits, row: usize) -> Self {
        let origin = rays.origin.load::<L>(row);
        let direction = rays.direction.load::<L>(row);
        let mut packet = Self {
            spheres,
            rays,
            hits,
            row,
            filter: FilterRay::new(origin, direction),
            slab: SlabRay::new(origin, direction),
            t_max: L::splat(0.0),
            error: [0.0; MAX_LANES],
            exact: 0,
            query: PhantomData,
        };
        packet.refresh();
        packet
    }

    /// Takes the lanes' bounds from the hits.
    #[inline(always)]
    fn refresh(&mut self) {
        let mut t_max = [DONE; MAX_LANES];
        let lanes = L::WIDTH.min(self.rays.len() - self.row);
        for (lane, bound) in t_max[..lanes].iter_mut().enumerate() {
            let row = self.row + lane;
            if !(Q::ANY && self.hits.sphere[row] != MISS) {
                *bound = ((self.hits.t[row] + self.error[lane]) as f32).next_up();
            }
        }
        self.t_max = L::load(&t_max);
    }

    /// Whether no lane is left.
    #[inline(always)]
    fn done(&self) -> bool {
        L::splat(0.0).le(self.t_max).bits() == 0
    }

    #[inline(always)]
    fn walk(&mut self, nodes: &[Node]) {
        if nodes.is_empty() || self.done() {
            return;
        }
        // The nearer child by the direction of the first ray; for a packet of like rays, of all.
        let flip = self.rays.direction.row(self.row).to_array().map(|d| d < 0.0);
        let mut stack = [0_u32; STACK];
        let mut top = 0;
        let mut index = 0_u32;
        loop {
            let node = &nodes[index as usize];
            if self.slab.enters(node.low, node.high, self.t_max).bits() != 0 {
                match node.content() {
                    Content::Split { axis } => {
                        let (near, far) = if flip[axis as usize] {
                            (node.first, index + 1)
                        } else {
                            (index + 1, node.first)
                        };
                        stack[top] = far;
                        top += 1;
                        index = near;
                        continue;
                    }
                    Content::Spheres { count } => {
                        self.leaf(node.first as usize, count as usize);
                        if Q::ANY && self.done() {
                            return;
                        }
                    }
                }
            }
            if top == 0 {
                return;
            }
            top -= 1;
            index = stack[top];
        }
    }

    /// Tests spheres `first..first + count`.
    #[inline(always)]
    fn leaf(&mut self, first: usize, count: usize) {
        for sphere in first..first + count {
            let center = self.spheres.center(sphere);
            let (lanes, near) = intersect::filter(
                &self.filter,
                Vec3::splat(center.x, center.y, center.z),
                L::splat(self.spheres.radius[sphere]),
                self.t_max,
            );
            let lanes = (lanes & L::splat(0.0).le(self.t_max)).bits();
            if lanes != 0 {
                if Q::EXACT {
                    self.confirm(sphere, lanes);
                } else {
                    self.believe(sphere, lanes, near);
                }
            }
        }
    }

    /// Decides the lanes that passed the filter, and keeps what is nearer.
    #[inline(never)]
    fn confirm(&mut self, sphere: usize, lanes: u32) {
        let (center, radius) = self.spheres.exact(sphere);
        for lane in set_bits(lanes) {
            let row = self.row + lane;
            if self.is(sphere, self.rays.own[row]) || self.is(sphere, self.rays.target[row]) {
                continue;
            }
            let ray = self.rays.exact(row);
            let inside = || self.starts_within(&ray, row, center, radius);
            let Some(root) = intersect::confirm(&ray, center, radius, inside) else { continue };
            self.exact += u64::from(root.exact);
            if self.is_nearer(&ray, sphere, &root, lane) {
                self.hits.sphere[row] = sphere as u32;
                if !Q::ANY {
                    self.hits.t[row] = root.t;
                    self.error[lane] = root.error;
                }
            }
        }
        self.refresh();
    }

    /// Takes the lanes that passed the filter for hits.
    #[inline(never)]
    fn believe(&mut self, sphere: usize, lanes: u32, near: L) {
        let mut distances = [0.0; MAX_LANES];
        near.store(&mut distances);
        for lane in set_bits(lanes) {
            let (row, t) = (self.row + lane, f64::from(distances[lane]));
            if self.rays.own[row] != sphere as u32 && t >= 0.0 && t < self.hits.t[row] {
                self.hits.set(row, t, sphere as u32);
            }
        }
        self.refresh();
    }

    /// Whether `sphere` is sphere `known` of the ray, or coincides with it. What coincides comes later
    /// in the scene, or it would be known in its stead.
    #[inline(always)]
    fn is(&self, sphere: usize, known: u32) -> bool {
        known == sphere as u32
            || ((known as usize) < self.spheres.len()
                && self.spheres.exact(known as usize) == self.spheres.exact(sphere))
    }

    /// Whether a ray that starts on the surface of this sphere, as far as rounding tells, starts on one
    /// that touches it from within.
    fn starts_within(&self, ray: &ExactRay, row: usize, center: DVec3, radius: f64) -> bool {
        let own = self.rays.own[row] as usize;
        if own >= self.spheres.len() {
            return false;
        }
        let (own_center, own_radius) = self.spheres.exact(own);
        own_radius < radius && (ray.origin - own_center).dot(ray.origin - center) > 0.0
    }

    /// Whether a hit replaces what its lane has so far.
    #[inline(always)]
    fn is_nearer(&mut self, ray: &ExactRay, sphere: usize, root: &Root, lane: usize) -> bool {
        let row = self.row + lane;
        let (best, error) = (self.hits.t[row], self.error[lane]);
        if root.t + root.error < best - error {
            return true;
        }
        if root.t - root.error > best + error {
            return false;
        }
        match self.compare(ray, sphere, root, lane) {
            Ordering::Less => true,
            Ordering::Equal => !Q::ANY && self.precedes(sphere, self.hits.sphere[row]),
            Ordering::Greater => false,
        }
    }

    /// Compares distances that are closer than their errors: by closer bounds, then without
    /// rounding.
    #[cold]
    fn compare(&mut self, ray: &ExactRay, sphere: usize, root: &Root, lane: usize) -> Ordering {
        let row = self.row + lane;
        let (best, other) = (self.hits.t[row], self.hits.sphere[row] as usize);
        let twins = || self.spheres.exact(sphere) == self.spheres.exact(other);
        if self.error[lane] != 0.0 && twins() {
            return Ordering::Equal;
        }
        let first = self.candidate(ray, sphere, root.t, root.error);
        let second = self.candidate(ray, other, best, self.error[lane]);
        let gap = first.0.t - second.0.t;
        if gap.abs() > first.0.error + second.0.error {
            return gap.total_cmp(&0.0);
        }
        self.exact += 1;
        exact::compare(ray, &first.1, &second.1)
    }

    /// A distance with its closest bound, and what it is. An error of 0 says that it is no hit, or
    /// by definition so.
    fn candidate(&self, ray: &ExactRay, sphere: usize, t: f64, error: f64) -> (Root, Distance) {
        let number = Root { t, error: 0.0, exact: false };
        if error == 0.0 {
            return (number, Distance::Number(t));
        }
        let (center, radius) = self.spheres.exact(sphere);
        let root = intersect::confirm_closely(ray, center, radius, || false);
        (root.unwrap_or(number), Distance::Hit(center, radius))
    }

    /// Whether `sphere` comes before `other` in the user's scene; the ground comes last, and a bound is
    /// no hit.
    fn precedes(&self, sphere: usize, other: u32) -> bool {
        other != MISS
            && self.spheres.id.get(other as usize).is_none_or(|&id| self.spheres.id[sphere] < id)
    }
}

/// The bound of a lane that has no ray, or whose ray needs no more answers.
const DONE: f32 = -1.0;
