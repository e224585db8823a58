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
use crate::intersect::{self, FilterRay, SlabRay};
use crate::lanes::{Lanes, Mask, set_bits};
use crate::ray::{Hits, MISS, Rays};
use crate::spheres::Spheres;
use crate::vec3::Vec3;
use std::marker::PhantomData;

/// Room for the nodes still to visit: a tree over 2^32 spheres is at most 31 levels deep.
pub(super) const STACK: usize = 40;

/// What a walk wants to know.
pub trait Query {
    /// Whether any hit ends a ray's walk.
    const ANY: bool;
}

/// Which sphere is hit first: leaves `t` and `sphere` of the hit.
pub struct Closest;

/// Whether anything is hit nearer than `t`: leaves some sphere, or what was there.
pub struct Any;

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
}

/// Traces all rays in packets of `L::WIDTH`; `hits` holds bounds on entry, answers on return.
pub fn trace<L: Lanes, Q: Query>(
    method: Method,
    bvh: &Bvh,
    spheres: &Spheres,
    rays: &Rays,
    hits: &mut Hits,
) {
    for row in (0..rays.len()).step_by(L::WIDTH) {
        let mut packet = Packet::<L, Q>::new(spheres, rays, hits, row);
        match method {
            Method::Brute => packet.leaf(0, spheres.len()),
            Method::Tree => packet.walk(bvh.nodes()),
        }
    }
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
            query: PhantomData,
        };
        packet.refresh();
        packet
    }

    /// Takes the lanes' bounds from the hits.
    #[inline(always)]
    fn refresh(&mut self) {
        let mut t_max = [DONE; crate::lanes::MAX_LANES];
        let lanes = L::WIDTH.min(self.rays.len() - self.row);
        for (lane, bound) in t_max[..lanes].iter_mut().enumerate() {
            let row = self.row + lane;
            if !(Q::ANY && self.hits.sphere[row] != MISS) {
                *bound = (self.hits.t[row] as f32).next_up();
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
            let lanes = intersect::filter(
                &self.filter,
                Vec3::splat(center.x, center.y, center.z),
                L::splat(self.spheres.radius[sphere]),
                self.t_max,
            );
            let lanes = (lanes & L::splat(0.0).le(self.t_max)).bits();
            if lanes != 0 {
                self.confirm(sphere, lanes);
            }
        }
    }

    /// Decides the lanes that passed the filter, and keeps what is nearer.
    #[inline(never)]
    fn confirm(&mut self, sphere: usize, lanes: u32) {
        let center = self.spheres.center(sphere).as_dvec3();
        let radius = f64::from(self.spheres.radius[sphere]);
        for lane in set_bits(lanes) {
            let row = self.row + lane;
            if self.rays.own[row] == sphere as u32 {
                continue;
            }
            let Some(t) = intersect::confirm(&self.rays.exact(row), center, radius) else {
                continue;
            };
            let best = self.hits.t[row];
            if t < best || (!Q::ANY && t == best && self.precedes(sphere, self.hits.sphere[row])) {
                self.hits.sphere[row] = sphere as u32;
                if !Q::ANY {
                    self.hits.t[row] = t;
                }
            }
        }
        self.refresh();
    }

    /// Whether `sphere` comes before `other` in the user's scene; the ground and a miss come last.
    fn precedes(&self, sphere: usize, other: u32) -> bool {
        self.spheres.id.get(other as usize).is_none_or(|&id| self.spheres.id[sphere] < id)
    }
}

/// The bound of a lane that has no ray, or whose ray needs no more answers.
const DONE: f32 = -1.0;
