//! The bounding volume hierarchy: one tree, eight wide, over the spheres' blocks.
//!
//! [`build`](build::build) makes the tree and the order of the spheres in one go; [`walk`] answers
//! which sphere a ray hits first ([`walk::Closest`]) and whether it hits any ([`walk::Any`]), with
//! rays one by one, many in flight, in packets of every lane count, or by brute force. The tree
//! knows nothing of materials, the rest of the program nothing of nodes.

mod beam;
mod best;
pub mod build;
mod decide;
mod deferred;
mod hold;
mod order;
mod others;
mod packet;
mod ready;
mod rows;
mod settle;
mod single;
mod stream;
mod waiting;
pub mod walk;

pub use beam::Beam;
pub(crate) use rows::NodeRow;

use crate::lanes::U32x16;
use crate::spheres::{LEAF, Spheres};
use glam::Vec3;

/// Children of a node: one row of lanes for each of their boxes' planes.
pub const WIDTH: usize = 8;

/// The deepest that a tree gets, counted in nodes.
pub const DEPTH: usize = 24;

/// A node: the boxes of its children in columns, and what is in them.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// By axis and side, lower first: where that plane of each child's box is, rounded outward. An
    /// inverted box, which no ray meets, where there is no child.
    planes: [[[f32; WIDTH]; 2]; 3],
    /// What is in the boxes.
    child: [Child; WIDTH],
}

/// A child: a node's index, or a block's with a bit set.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Child(u32);

impl Child {
    /// Set in blocks: there are fewer than 2^30 nodes, and fewer blocks.
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

    /// 1 for what it is: a node, a block, none.
    #[inline(always)]
    fn kinds(self) -> [u64; 3] {
        let (block, none) = (u64::from(self.0 >> 30 & 1), u64::from(self.0 >> 31));
        [1 - (block | none), block, none]
    }

    /// Which children of a row are blocks, and which are none: a bit for each.
    #[inline(always)]
    fn are(row: U32x16) -> [u32; 2] {
        [(row << 1_u32).to_bitmask(), row.to_bitmask()]
    }

    /// [`Child::NODE`] or [`Child::BLOCK`], if there is one.
    #[inline(always)]
    fn kind(self) -> u32 {
        self.0 >> 30
    }

    /// Of the node or the block.
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

    /// The children that there are.
    fn children(&self) -> impl Iterator<Item = (Child, Bounds)> {
        let there = |&i: &usize| self.child[i] != Child::NONE;
        (0..WIDTH).filter(there).map(|i| (self.child[i], self.bounds(i)))
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
    /// The box of nothing.
    pub const EMPTY: Self =
        Self { low: Vec3::splat(f32::INFINITY), high: Vec3::splat(f32::NEG_INFINITY) };

    /// The least box that holds both.
    #[inline(always)]
    pub fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half of the surface.
    fn half_area(&self) -> f64 {
        let size = (self.high - self.low).as_dvec3();
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    fn holds(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }
}

/// What a ray is expected to visit (`MacDonald` & Booth, "Heuristics for Ray Tracing Using Space
/// Subdivision", The Visual Computer 1990).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Nodes, the root among them.
    pub nodes: f64,
    /// Spheres that are tested, whole blocks of them.
    pub spheres: f64,
}

/// The tree, flattened depth first: `nodes[0]` is the root.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// How large leaves are, about: the geometric mean of the longest edges of some of their boxes.
    grain: f32,
}

impl Bvh {
    /// The nodes, root first; empty if there is no sphere.
    fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The tree of these nodes.
    fn new(nodes: Vec<Node>) -> Self {
        /// So many nodes are looked at.
        const SAMPLES: usize = 1024;
        let some = nodes.iter().step_by(nodes.len().div_ceil(SAMPLES).max(1));
        let leaves =
            some.flat_map(Node::children).filter(|(child, _)| child.kind() == Child::BLOCK);
        let edges: Vec<f32> =
            leaves.map(|(_, bounds)| (bounds.high - bounds.low).max_element().log2()).collect();
        let grain = (edges.iter().sum::<f32>() / edges.len().max(1) as f32).exp2();
        Self { nodes, grain }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no sphere.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Bytes that the tree occupies, without the spheres.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// The box of everything; `None` if there is no sphere.
    pub fn bounds(&self) -> Option<Bounds> {
        let boxes = self.nodes.first()?.children().map(|child| child.1);
        boxes.reduce(|all, bounds| all.union(&bounds))
    }

    /// What a ray costs that passes through the box of everything at random, and hits nothing.
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

    /// Checks what the walks rely on: every block is in one leaf, every box holds what is below it,
    /// and no path is longer than [`DEPTH`].
    ///
    /// # Errors
    /// Says which node is wrong, and how.
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
                    below.is_some_and(|below| below.children().all(|(_, b)| bounds.holds(&b)))
                } else {
                    let first = child.index() * LEAF;
                    let once = seen.get_mut(child.index());
                    once.is_some_and(|seen| !std::mem::replace(seen, true))
                        && (first..spheres.len().min(first + LEAF)).all(|row| {
                            let (center, radius) = (spheres.center(row), spheres.radius(row));
                            bounds.holds(&Bounds { low: center - radius, high: center + radius })
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
