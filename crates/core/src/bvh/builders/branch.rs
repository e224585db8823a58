//! The tree while it is binary: what builders make, leaf by leaf, and what it costs to make it wide.
//!
//! A part of `n` leaves has `n - 1` branches in a row: its root's, those of the first half and those
//! of the second. So every branch has its place before anything is known of the others, and threads
//! need not wait for each other.

use super::cut::Cut;
use super::item::{Extent, along};
use super::segment::Segment;
use super::tasks::PARALLEL;
use crate::bvh::{Bounds, DEPTH, WIDTH};
use crate::spheres::LEAF;

/// The most branches on a path. Eight parts of equal depth have at least three branches less than
/// the whole, so a tree of this depth can be made one of [`DEPTH`] wide nodes.
const HEIGHT: usize = 3 * DEPTH;

/// A part of the tree, seen from above.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top {
    pub(super) bounds: Bounds,
    /// Least cost of this part as one child of a wide node, as at most two children, and so on: the
    /// sum of half the surface areas of its nodes. 0 for a leaf.
    pub(super) forest: [f32; WIDTH - 1],
    /// Branches on the longest path.
    pub(super) height: u8,
}

/// A branch: two parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    pub(super) top: Top,
    /// Leaves of the first part.
    pub(super) first: u32,
}

impl Branch {
    pub(super) const NONE: Self =
        Self { top: Top { bounds: Bounds::EMPTY, forest: [0.0; WIDTH - 1], height: 0 }, first: 0 };
}

impl Top {
    pub(super) fn leaf(extent: &Extent) -> Self {
        Self { bounds: extent.bounds(), ..Branch::NONE.top }
    }

    /// Joins two parts.
    pub(super) fn join(a: &Self, b: &Self) -> Self {
        let bounds = a.bounds.union(&b.bounds);
        let mut forest = [bounds.half_area() as f32 + best(a, b, WIDTH).1; WIDTH - 1];
        for roots in 2..WIDTH {
            forest[roots - 1] = forest[0].min(best(a, b, roots).1);
        }
        Self { bounds, forest, height: a.height.max(b.height) + 1 }
    }
}

/// Distributes `roots` children of a wide node over two parts at least cost: returns the number for the
/// first part, and the cost (Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through
/// Compressed Wide BVHs", HPG 2017).
pub(super) fn best(a: &Top, b: &Top, roots: usize) -> (usize, f32) {
    let mut best = (1, a.forest[0] + b.forest[roots - 2]);
    for share in 2..roots {
        let cost = a.forest[share - 1] + b.forest[roots - share - 1];
        if cost < best.1 {
            best = (share, cost);
        }
    }
    best
}

/// Makes the branches over some items, which are put into the order of the leaves, and where `first`
/// come before them and `depth` branches above.
pub(super) fn grow(
    cut: &impl Cut,
    mut segment: Segment,
    branches: &mut [Branch],
    first: usize,
    depth: usize,
) -> Top {
    let leaves = segment.len().div_ceil(LEAF);
    if leaves > 1 && cut.finishes(segment.len()) && depth + leaves <= HEIGHT {
        return cut.finish(segment, branches);
    }
    let Some((root, below)) = branches.split_first_mut() else {
        let items = segment.settle();
        items.sort_unstable_by(|a, b| along(0, a, b));
        return Top::leaf(&Extent::around(items.iter().copied()));
    };
    let least_height = (leaves - 1).ilog2() as usize + 1;
    let place = if depth + 1 + least_height <= HEIGHT {
        cut.cut(&mut segment, first)
    } else {
        cut.median().cut(&mut segment, first)
    };
    let parallel = segment.len() >= PARALLEL;
    let (left, right) = segment.split_at(place);
    let (below_left, below_right) = below.split_at_mut(place / LEAF - 1);
    let left = || grow(cut, left, below_left, first, depth + 1);
    let right = || grow(cut, right, below_right, first + place, depth + 1);
    let (a, b) = if parallel { rayon::join(left, right) } else { (left(), right()) };
    *root = Branch { top: Top::join(&a, &b), first: (place / LEAF) as u32 };
    root.top
}
