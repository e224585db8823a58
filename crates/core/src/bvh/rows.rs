//! Trees as rows of numbers, for files and for other processors.

use super::{Bvh, Child, DEPTH, Node, WIDTH};
use bytemuck::{Pod, Zeroable};

/// A node without the room that aligns it: planes by axis, by side, lower first, and by child; then, for each child,
/// the index of its node, or that of its block with bit 30 set, or bit 31 alone where there is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NodeRow {
    planes: [[[f32; WIDTH]; 2]; 3],
    child: [Child; WIDTH],
}

impl Bvh {
    /// The nodes, root first.
    pub fn rows(&self) -> impl Iterator<Item = NodeRow> {
        self.nodes.iter().map(|&Node { planes, child }| NodeRow { planes, child })
    }

    /// Builds the tree of these rows over `blocks` blocks. Returns `None` if they are not a tree, so
    /// that a traversal would never end or access missing nodes and blocks. Does not check that boxes
    /// contain what is below them.
    pub fn from_rows(rows: &[NodeRow], blocks: usize) -> Option<Self> {
        let nodes = rows.iter().map(|&NodeRow { planes, child }| Node { planes, child });
        let nodes: Vec<Node> = nodes.collect();
        is_tree(&nodes, blocks).then(|| Self::new(nodes))
    }
}

/// Returns whether every node but the first is the child of one that comes before it, every block
/// is in one leaf, and no path is longer than [`DEPTH`].
fn is_tree(nodes: &[Node], blocks: usize) -> bool {
    // 0 is for nodes that are nobody's child so far.
    let mut depth = vec![0_usize; nodes.len()];
    let mut found = vec![false; blocks];
    depth.iter_mut().take(1).for_each(|root| *root = 1);
    for (index, node) in nodes.iter().enumerate() {
        let here = depth[index];
        if here == 0 || here > DEPTH {
            return false;
        }
        for child in node.child.iter().filter(|&&child| child != Child::NONE) {
            let free = match child.kind() {
                Child::NODE if child.index() > index => depth
                    .get_mut(child.index())
                    .is_some_and(|own| std::mem::replace(own, here + 1) == 0),
                Child::BLOCK => found
                    .get_mut(child.index())
                    .is_some_and(|found| !std::mem::replace(found, true)),
                _ => false,
            };
            if !free {
                return false;
            }
        }
    }
    found.iter().all(|&found| found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::builders::{Builder, build};
    use crate::random::Random;
    use crate::spheres::Spheres;

    /// A tree of a few dozen nodes, and its number of blocks.
    fn tree() -> (Bvh, usize) {
        let mut random = Random::new(1);
        let mut spheres = Spheres::with_capacity(500);
        for id in 0..500 {
            spheres.push(random.in_cube().as_vec3(), 0.05, id);
        }
        let bvh = build(&mut spheres, Builder::default());
        (bvh, spheres.blocks().len())
    }

    #[test]
    fn rows_make_the_same_tree() {
        let (bvh, blocks) = tree();
        let rows: Vec<NodeRow> = bvh.rows().collect();
        assert_eq!(Bvh::from_rows(&rows, blocks), Some(bvh));
        assert!(Bvh::from_rows(&[], 0).is_some_and(|bvh| bvh.is_empty()));
    }

    #[test]
    fn every_child_has_one_parent_before_it() {
        let (bvh, blocks) = tree();
        let rows: Vec<NodeRow> = bvh.rows().collect();
        let (mut changed, mut refused) = (0, 0);
        for index in 0..rows.len() {
            for slot in 0..WIDTH {
                for other in [0, index as u32, rows.len() as u32, 1 << 30, 3 << 30, u32::MAX] {
                    let mut rows = rows.clone();
                    if rows[index].child[slot] == Child(other) {
                        continue;
                    }
                    rows[index].child[slot] = Child(other);
                    changed += 1;
                    refused += u32::from(Bvh::from_rows(&rows, blocks).is_none());
                }
            }
        }
        assert!(changed > 100, "{changed}");
        assert_eq!(refused, changed);
        assert_eq!(Bvh::from_rows(&rows, blocks + 1), None);
        assert_eq!(Bvh::from_rows(&rows, blocks - 1), None);
    }
}
