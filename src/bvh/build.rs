//! Building the tree: spheres sorted on the longest axis of their centers, halved, and so on down
//! to leaves: the paper's.
//!
//! Only the halves matter, not the order within them, so each step selects the median in linear
//! time instead of sorting. Equal coordinates are told apart by the sphere's id: the tree is a
//! function of the spheres alone, whatever the number of threads and the order of rows, and no
//! input, however degenerate, makes it deeper than `log2(n)`. Halves are cut at multiples of
//! [`LEAF`], so leaves are full and the nodes of a subtree are `2 leaves - 1`: both halves write to
//! slices known in advance, in parallel.

use super::{Bvh, Node};
use crate::spheres::Spheres;
use bytemuck::Zeroable;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Spheres per leaf (`cargo bench --bench walk`: 4 beats 2 and 8 for packets and single rays).
pub const LEAF: usize = 4;

/// Below this many spheres a subtree is built by one task: splitting costs more than it saves.
const PARALLEL: usize = 4096;

/// So many spheres about one center are looked at for some that coincide.
const CROWD: usize = 64;

/// Every box is wider than its spheres by this, a part of the largest coordinate, which is about 1. So
/// no ray touches a sphere where it enters a box, and a direction whose reciprocal is not finite does
/// no harm: it takes such a ray longer than any scene is wide to cross the margin.
const MARGIN: f32 = 1.0 / (1_u64 << 56) as f32;

/// A sphere while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    center: [f32; 3],
    radius: f32,
    /// The sphere's row in the columns as they were.
    row: u32,
    /// The sphere's place in the user's scene.
    id: u32,
}

/// Builds the tree and permutes `spheres` so that every leaf is a slice of rows.
///
/// Of spheres that coincide only the first of the user's is ever hit. Where there are crowds of them,
/// in whose boxes a walk would have to look into every leaf, the others are left out.
pub fn build(spheres: &mut Spheres) -> Bvh {
    let mut items: Vec<Item> = (0..spheres.len())
        .map(|row| Item {
            center: spheres.center(row).to_array(),
            radius: spheres.radius[row],
            row: row as u32,
            id: spheres.id[row],
        })
        .collect();
    let (mut nodes, crowded) = tree(&mut items);
    if crowded {
        let before = items.len();
        leave_out_hidden(&mut items, spheres);
        if items.len() < before {
            nodes = tree(&mut items).0;
        }
    }
    let order: Vec<u32> = items.into_iter().map(|item| item.row).collect();
    spheres.permute(&order);
    Bvh { nodes }
}

/// The nodes over `items`, which are put into the order of the leaves, and whether there are crowds of
/// equal centers.
fn tree(items: &mut [Item]) -> (Vec<Node>, bool) {
    let crowded = AtomicBool::new(false);
    let mut nodes = Vec::new();
    if !items.is_empty() {
        nodes.resize(2 * items.len().div_ceil(LEAF) - 1, Node::zeroed());
        subtree(items, &mut nodes, (0, 0), &crowded);
    }
    (nodes, crowded.into_inner())
}

/// Keeps the first of the user's spheres of all that coincide.
fn leave_out_hidden(items: &mut Vec<Item>, spheres: &Spheres) {
    let exact = |item: &Item| {
        let (center, radius) = spheres.exact(item.row as usize);
        // Adding 0 makes -0 the same as 0.
        [center.x, center.y, center.z, radius].map(|value| (value + 0.0).to_bits())
    };
    items.par_sort_unstable_by_key(|item| (exact(item), item.id));
    items.dedup_by_key(|item| exact(item));
}

/// Builds the subtree over `items` into `nodes`, whose first one is number `node` of the whole
/// tree; `items[0]` will be row `first`.
fn subtree(
    items: &mut [Item],
    nodes: &mut [Node],
    (node, first): (usize, usize),
    crowded: &AtomicBool,
) {
    if items.len() <= LEAF {
        let (low, high) = bounds(items);
        nodes[0] = Node { low, high, first: first as u32, kind: items.len() as u32 };
        return;
    }
    let (axis, extent) = longest_axis(items);
    if extent == 0.0 && items.len() >= CROWD {
        crowded.store(true, Ordering::Relaxed);
    }
    let half = (items.len().div_ceil(LEAF) / 2) * LEAF;
    // Shells about one center are told apart by their radius.
    items.select_nth_unstable_by(half, |a, b| {
        let by_center = a.center[axis].total_cmp(&b.center[axis]);
        by_center.then(a.radius.total_cmp(&b.radius)).then(a.id.cmp(&b.id))
    });
    let (left_items, right_items) = items.split_at_mut(half);
    let (parent, below) = nodes.split_at_mut(1);
    let left_count = 2 * (half / LEAF) - 1;
    let (left_nodes, right_nodes) = below.split_at_mut(left_count);
    let second = node + 1 + left_count;
    let parallel = left_items.len() >= PARALLEL;
    let mut left = || subtree(left_items, left_nodes, (node + 1, first), crowded);
    let mut right = || subtree(right_items, right_nodes, (second, first + half), crowded);
    if parallel {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
    let (a, b) = (&left_nodes[0], &right_nodes[0]);
    parent[0] = Node {
        low: std::array::from_fn(|i| a.low[i].min(b.low[i])),
        high: std::array::from_fn(|i| a.high[i].max(b.high[i])),
        first: second as u32,
        kind: Node::INNER + axis as u32,
    };
}

/// The axis on which the centers are spread widest, the first one of equals, and how widely.
fn longest_axis(items: &[Item]) -> (usize, f32) {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for item in items {
        for axis in 0..3 {
            low[axis] = low[axis].min(item.center[axis]);
            high[axis] = high[axis].max(item.center[axis]);
        }
    }
    let extent: [f32; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
    let wider = usize::from(extent[1] > extent[0]);
    let widest = if extent[2] > extent[wider] { 2 } else { wider };
    (widest, extent[widest])
}

/// A box that holds the spheres for certain: rounding the difference may fall on the inner side of
/// the true bound, the next number cannot.
fn bounds(items: &[Item]) -> ([f32; 3], [f32; 3]) {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for item in items {
        for axis in 0..3 {
            low[axis] = low[axis].min((item.center[axis] - item.radius - MARGIN).next_down());
            high[axis] = high[axis].max((item.center[axis] + item.radius + MARGIN).next_up());
        }
    }
    (low, high)
}
