//! The bounding volume hierarchy: one flattened binary tree over the spheres' columns.
//!
//! [`build`](build::build) makes the tree and the order of the spheres in one go; [`walk`] answers
//! which sphere a ray hits first ([`walk::Closest`]) and whether it hits any ([`walk::Any`]), for
//! every lane count, with the tree or by brute force. The tree knows nothing of materials, the rest
//! of the program nothing of nodes.

pub mod build;
pub mod walk;

use crate::spheres::Spheres;

/// A node: a box and either two children or a slice of the spheres' columns.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Node {
    /// Lower corner, rounded down.
    pub low: [f32; 3],
    /// Upper corner, rounded up.
    pub high: [f32; 3],
    /// Leaf: the first sphere's row. Inner node: the second child; the first one follows its
    /// parent.
    pub first: u32,
    /// Leaf: the number of spheres. Inner node: [`Node::INNER`] plus the axis of the split.
    kind: u32,
}

impl Node {
    /// Marks an inner node: no leaf has as many spheres.
    const INNER: u32 = u32::MAX - 2;

    /// The spheres of a leaf, or the axis on which an inner node is split.
    #[inline(always)]
    fn content(&self) -> Content {
        if self.kind >= Self::INNER {
            Content::Split { axis: self.kind - Self::INNER }
        } else {
            Content::Spheres { count: self.kind }
        }
    }
}

/// What is in a [`Node`].
enum Content {
    Split { axis: u32 },
    Spheres { count: u32 },
}

/// The tree, flattened depth first: `nodes[0]` is the root; a node's first child follows it.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
}

impl Bvh {
    /// The nodes, root first; empty if there is no sphere.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Bytes that the tree occupies, without the spheres.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }

    /// Checks what the walks rely on: every row is in one leaf, every box holds its children's and
    /// its spheres', and no path is longer than the walks' stack.
    ///
    /// # Errors
    /// Says which node is wrong, and how.
    pub fn validate(&self, spheres: &Spheres) -> Result<(), String> {
        let mut next_row = 0;
        let mut next_node = 0;
        let mut open = vec![(0_usize, 0_usize)];
        if self.nodes.is_empty() {
            open.clear();
        }
        while let Some((index, depth)) = open.pop() {
            let node = &self.nodes[index];
            if index != next_node || depth > walk::STACK {
                return Err(format!("node {index} is out of order or too deep, at {depth}"));
            }
            next_node += 1;
            let holds = |low: [f32; 3], high: [f32; 3]| {
                (0..3).all(|axis| node.low[axis] <= low[axis] && node.high[axis] >= high[axis])
            };
            let sound = match node.content() {
                Content::Split { .. } => {
                    let children = [node.first as usize, index + 1];
                    open.extend(children.map(|child| (child, depth + 1)));
                    children.iter().all(|&child| {
                        self.nodes.get(child).is_some_and(|child| holds(child.low, child.high))
                    })
                }
                Content::Spheres { count } => {
                    let rows = node.first as usize..(node.first + count) as usize;
                    let in_order = rows.start == next_row && rows.end <= spheres.len();
                    next_row = rows.end;
                    in_order
                        && rows.clone().all(|row| {
                            let (center, radius) = (spheres.center(row), spheres.radius[row]);
                            holds((center - radius).to_array(), (center + radius).to_array())
                        })
                }
            };
            if !sound {
                return Err(format!("node {index} does not hold what is below it"));
            }
        }
        if next_row == spheres.len() && next_node == self.nodes.len() {
            return Ok(());
        }
        Err(format!("{next_row} of {} spheres are in leaves", spheres.len()))
    }

    /// The box of everything: its lower and its upper corner. `None` if there is no sphere.
    pub fn bounds(&self) -> Option<([f32; 3], [f32; 3])> {
        self.nodes.first().map(|root| (root.low, root.high))
    }
}
