//! The bounding volume hierarchy: one tree, eight wide, whose leaves are blocks of eight spheres.
//!
//! [`build`](builders::build) makes the tree and puts the spheres in its order. A [`Tracer`] finds the
//! first hit of each ray ([`Closest`]), or whether it hits anything ([`Any`]). The tree knows nothing of
//! materials, and the rest of the program nothing of nodes.

mod beam;
pub mod builders;
mod child_order;
mod decision;
mod enclosing;
mod found;
mod interleaved;
mod intersections;
mod nearest;
mod one_ray;
mod packet;
mod plain_ray;
mod query;
mod ray_setup;
mod resolver;
mod rows;
mod single;
mod traversal;

pub use beam::Beam;
pub use found::{UNKNOWN, decide_found};
pub(crate) use intersections::{Intersection, for_each_intersection};
pub use one_ray::{OneHit, trace_far, trace_one};
pub(crate) use one_ray::{SMALL_STACK, STACK, Search, walk};
pub use plain_ray::{PlainAnswer, PlainHit, PlainRay};
pub use query::{Any, Closest, ClosestRounded, Query, Unverified, Visits};
pub use rows::NodeRow;
pub use traversal::{PacketWidth, Tracer, Traversal, count_visits, trace};

use crate::elementary;
use crate::lanes::U32x16;
use crate::spheres::{LEAF, Spheres};
use glam::Vec3;

/// Number of children of a node: a row of lanes holds one plane of each of their boxes.
pub const WIDTH: usize = 8;

/// Maximum depth of a tree, in nodes.
pub const DEPTH: usize = 24;

/// A node: the boxes of its children in columns, and the children.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Planes of the children's boxes by axis and side, lower first, rounded outward. Where there is no
    /// child, an inverted box, which no ray enters.
    planes: [[[f32; WIDTH]; 2]; 3],
    /// The children.
    child: [Child; WIDTH],
}

/// A child: the index of a node, or that of a block with a bit set.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Child(u32);

impl Child {
    /// The bit that is set in blocks: there are fewer than 2^30 nodes, and fewer blocks.
    const LEAF: u32 = 1 << 30;
    /// No child.
    const NONE: Self = Self(1 << 31);
    /// The kind of a node.
    const NODE: u32 = 0;
    /// The kind of a block.
    const BLOCK: u32 = 1;

    fn node(index: usize) -> Self {
        Self(index as u32)
    }

    fn leaf(block: usize) -> Self {
        Self(block as u32 | Self::LEAF)
    }

    /// Returns three numbers of which one is 1: node, block, none.
    #[inline(always)]
    fn kinds(self) -> [u64; 3] {
        let (block, none) = (u64::from(self.0 >> 30 & 1), u64::from(self.0 >> 31));
        [1 - (block | none), block, none]
    }

    /// Returns a bit for each child of a row that is a block, and one for each that is none.
    #[inline(always)]
    fn row_kinds(row: U32x16) -> [u32; 2] {
        [(row << 1_u32).to_bitmask(), row.to_bitmask()]
    }

    /// [`Child::NODE`] or [`Child::BLOCK`]; unspecified for [`Child::NONE`].
    #[inline(always)]
    fn kind(self) -> u32 {
        self.0 >> 30
    }

    /// The index of the node or the block.
    #[inline(always)]
    fn index(self) -> usize {
        (self.0 & (Self::LEAF - 1)) as usize
    }
}

impl Node {
    const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        child: [Child::NONE; WIDTH],
    };

    /// The box of child `i`.
    fn bounds(&self, i: usize) -> Bounds {
        let corner = |side: usize| Vec3::from_array(self.planes.map(|axis| axis[side][i]));
        Bounds { low: corner(0), high: corner(1) }
    }

    fn set(&mut self, i: usize, child: Child, bounds: &Bounds) {
        self.child[i] = child;
        for axis in 0..3 {
            self.planes[axis][0][i] = bounds.low[axis];
            self.planes[axis][1][i] = bounds.high[axis];
        }
    }

    /// The children, without unused slots.
    fn children(&self) -> impl Iterator<Item = (Child, Bounds)> {
        let used = |&i: &usize| self.child[i] != Child::NONE;
        (0..WIDTH).filter(used).map(|i| (self.child[i], self.bounds(i)))
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub low: Vec3,
    /// Upper corner.
    pub high: Vec3,
}

impl Bounds {
    /// The empty box.
    pub const EMPTY: Self =
        Self { low: Vec3::splat(f32::INFINITY), high: Vec3::splat(f32::NEG_INFINITY) };

    /// Returns the smallest box that contains both.
    #[inline(always)]
    pub fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Returns half of the surface area.
    fn half_area(&self) -> f64 {
        let size = (self.high - self.low).as_dvec3();
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    fn contains(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }
}

/// Spheres, and the tree over them.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    /// The tree.
    pub bvh: &'a Bvh,
    /// The spheres, in its order.
    pub spheres: &'a Spheres,
}

/// The number of visits that a ray is expected to make (`MacDonald` & Booth, "Heuristics for Ray Tracing Using Space
/// Subdivision", The Visual Computer 1990).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Nodes, the root among them.
    pub nodes: f64,
    /// Spheres that are tested, whole blocks of them.
    pub spheres: f64,
}

/// The tree over all spheres, flattened depth first: `nodes[0]` is the root.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// The geometric mean of the longest edges of some leaves' boxes.
    mean_leaf_extent: f32,
}

impl Bvh {
    /// The nodes, root first; empty if there is no sphere.
    fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns the tree of these nodes.
    fn new(nodes: Vec<Node>) -> Self {
        /// Number of nodes whose leaves are measured.
        const SAMPLES: usize = 1024;
        let some = nodes.iter().step_by(nodes.len().div_ceil(SAMPLES).max(1));
        let leaves =
            some.flat_map(Node::children).filter(|(child, _)| child.kind() == Child::BLOCK);
        let edges: Vec<f32> = leaves
            .map(|(_, bounds)| (bounds.high - bounds.low).max_element())
            .map(elementary::log2f)
            .collect();
        let mean_leaf_extent =
            elementary::exp2f(edges.iter().sum::<f32>() / edges.len().max(1) as f32);
        Self { nodes, mean_leaf_extent }
    }

    /// The same tree with the smallest boxes that hold those of its leaves, which `leaf` returns by block.
    pub(crate) fn refitted(mut self, leaf: impl Fn(usize) -> Bounds) -> Self {
        // Children come after their parents.
        for index in (0..self.nodes.len()).rev() {
            for i in 0..WIDTH {
                let child = self.nodes[index].child[i];
                if child == Child::NONE {
                    continue;
                }
                let bounds = if child.kind() == Child::BLOCK {
                    leaf(child.index())
                } else {
                    let below = self.nodes[child.index()].children();
                    below.fold(Bounds::EMPTY, |all, (_, bounds)| all.union(&bounds))
                };
                self.nodes[index].set(i, child, &bounds);
            }
        }
        Self::new(self.nodes)
    }

    /// The geometric mean of the longest edges of some leaves' boxes.
    pub fn mean_leaf_extent(&self) -> f32 {
        self.mean_leaf_extent
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns whether there is no sphere.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Bytes that the tree occupies, without the spheres.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Returns the box of all spheres; `None` if there is none.
    pub fn bounds(&self) -> Option<Bounds> {
        let boxes = self.nodes.first()?.children().map(|child| child.1);
        boxes.reduce(|all, bounds| all.union(&bounds))
    }

    /// Returns the expected cost of a random ray that enters the box of all spheres, and hits nothing.
    pub fn cost(&self) -> Cost {
        let mut cost = Cost { nodes: 1.0, spheres: 0.0 };
        let Some(all) = self.bounds() else { return Cost { nodes: 0.0, spheres: 0.0 } };
        let whole = all.half_area();
        for (child, bounds) in self.nodes.iter().flat_map(Node::children) {
            let probability = bounds.half_area() / whole;
            let of_kind = if child.kind() == 0 { &mut cost.nodes } else { &mut cost.spheres };
            *of_kind += probability * if child.kind() == 0 { 1.0 } else { LEAF as f64 };
        }
        cost
    }

    /// Checks the invariants that traversal relies on: every block is in one leaf, every box contains
    /// the spheres below it, and no path is longer than [`DEPTH`].
    ///
    /// # Errors
    /// Names the node that breaks one, and how.
    pub fn validate(&self, spheres: &Spheres) -> Result<(), String> {
        let mut seen = vec![false; spheres.blocks().len()];
        let mut open = vec![(0_usize, 1_usize)];
        if self.nodes.is_empty() {
            open.clear();
        }
        let mut visited = 0;
        while let Some((index, depth)) = open.pop() {
            visited += 1;
            let node = self.nodes.get(index).ok_or(format!("there is no node {index}"))?;
            if depth > DEPTH || visited > self.nodes.len() {
                return Err(format!("node {index} is too deep, at {depth}, or not the only one"));
            }
            for (child, bounds) in node.children() {
                let inside = if child.kind() == Child::NODE {
                    open.push((child.index(), depth + 1));
                    let below = self.nodes.get(child.index());
                    below.is_some_and(|below| below.children().all(|(_, b)| bounds.contains(&b)))
                } else {
                    let first = child.index() * LEAF;
                    let once = seen.get_mut(child.index());
                    once.is_some_and(|seen| !std::mem::replace(seen, true))
                        && (first..spheres.len().min(first + LEAF)).all(|row| {
                            let (center, radius) = (spheres.center(row), spheres.radius(row));
                            bounds.contains(&Bounds { low: center - radius, high: center + radius })
                        })
                };
                if !inside {
                    return Err(format!("node {index} does not hold what is below it"));
                }
            }
        }
        if seen.iter().all(|&seen| seen) && visited == self.nodes.len() {
            return Ok(());
        }
        Err(format!("{visited} of {} nodes are in the tree, or a block is not", self.nodes.len()))
    }
}
