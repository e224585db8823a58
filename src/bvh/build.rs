//! Building the tree.
//!
//! A node's spheres are halved until there are eight parts, the parts are its children, and so on
//! down to leaves of [`LEAF`] spheres. Parts are cut at multiples of a leaf, so all leaves but one
//! are full and the spheres' order is the tree's. How a part is cut is what builders differ in
//! ([`Builder`]); all of them are functions of the spheres alone, whatever the number of threads
//! and the order of rows: equal coordinates are told apart by the sphere's id.

use super::{Bounds, Bvh, Child, Node, WIDTH, order};
use crate::slabs::MARGIN;
use crate::spheres::{LEAF, Spheres};
use glam::Vec3;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Below this many spheres a subtree is built by one task: splitting costs more than it saves.
const PARALLEL: usize = 4096;

/// So many spheres about one center are looked at for some that coincide.
const CROWD: usize = 64;

/// A sphere while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    center: [f32; 3],
    radius: f32,
    /// The sphere's place in the user's scene.
    id: u32,
}

/// Builds the tree and permutes `spheres` so that every leaf is a block.
///
/// Of spheres that coincide only the first of the user's is ever hit. Where there are crowds of them,
/// in whose boxes a walk would have to look into every leaf, the others are left out.
pub fn build(spheres: &mut Spheres) -> Bvh {
    let before = std::mem::take(spheres);
    let mut items: Vec<Item> = (0..before.len())
        .into_par_iter()
        .map(|row| Item {
            center: before.center(row).to_array(),
            radius: before.radius(row),
            id: before.id[row],
        })
        .collect();
    let (mut nodes, crowded) = tree(&mut items);
    if crowded {
        let count = items.len();
        leave_out_hidden(&mut items, &before);
        if items.len() < count {
            nodes = tree(&mut items).0;
        }
    }
    let precise = before.precise;
    let row_of = |id: u32| before.id.partition_point(|&other| other < id);
    if !precise.is_empty() {
        spheres.precise = items.iter().map(|item| precise[row_of(item.id)]).collect();
    }
    for item in &items {
        spheres.push(Vec3::from_array(item.center), item.radius, item.id);
    }
    Bvh::new(nodes)
}

/// The nodes over `items`, which are put into the order of the leaves, and whether there are crowds of
/// equal centers.
fn tree(items: &mut [Item]) -> (Vec<Node>, bool) {
    let crowded = AtomicBool::new(false);
    let mut nodes = Vec::new();
    if !items.is_empty() {
        nodes = subtree(items, 0, &crowded).0;
    }
    (nodes, crowded.into_inner())
}

/// Keeps the first of the user's spheres of all that coincide.
fn leave_out_hidden(items: &mut Vec<Item>, spheres: &Spheres) {
    let row_of = |id: u32| spheres.id.partition_point(|&other| other < id);
    let exact = |item: &Item| {
        let (center, radius) = spheres.exact(row_of(item.id));
        // Adding 0 makes -0 the same as 0.
        [center.x, center.y, center.z, radius].map(|value| (value + 0.0).to_bits())
    };
    items.par_sort_unstable_by_key(|item| (exact(item), item.id));
    items.dedup_by_key(|item| exact(item));
}

/// The subtree over `items`, whose first block will be number `block`; its nodes are numbered from 0.
fn subtree(items: &mut [Item], block: usize, crowded: &AtomicBool) -> (Vec<Node>, Bounds) {
    let leaves = items.len().div_ceil(LEAF);
    let full = full_subtree(leaves);
    let mut parts = Vec::with_capacity(WIDTH);
    cut(items, leaves.div_ceil(full), full * LEAF, crowded, &mut parts);
    let mut first = block;
    let tasks: Vec<_> = parts
        .into_iter()
        .map(|part| {
            let task = (first, part);
            first += task.1.len().div_ceil(LEAF);
            task
        })
        .collect();
    let below = |(block, part): (usize, &mut [Item])| {
        if part.len() <= LEAF {
            part.sort_unstable_by(|a, b| along(0, a, b));
            (Vec::new(), bounds(part), Child::leaf(block))
        } else {
            let (nodes, bounds) = subtree(part, block, crowded);
            (nodes, bounds, Child::node(0))
        }
    };
    let children: Vec<_> = if leaves * LEAF >= PARALLEL {
        tasks.into_par_iter().map(below).collect()
    } else {
        tasks.into_iter().map(below).collect()
    };
    join(children)
}

/// A node and what is below it.
fn join(children: Vec<(Vec<Node>, Bounds, Child)>) -> (Vec<Node>, Bounds) {
    let mut nodes = vec![Node::EMPTY];
    let mut all = Bounds::EMPTY;
    let boxes: Vec<_> = children.iter().map(|child| child.1).collect();
    let slots = order::slots(&boxes);
    for (slot, (below, bounds, child)) in slots.into_iter().zip(children) {
        let base = nodes.len();
        let child = if below.is_empty() { child } else { Child::node(base) };
        nodes[0].set(slot, child, &bounds);
        all = all.union(&bounds);
        nodes.extend(below.into_iter().map(|node| moved(node, base)));
    }
    (nodes, all)
}

/// A node whose subtree begins at `base`.
fn moved(mut node: Node, base: usize) -> Node {
    for child in &mut node.child {
        if child.kind() == Child::NODE {
            *child = Child::node(child.index() + base);
        }
    }
    node
}

/// The leaves of a child: the largest power of the width below `leaves`. Full subtrees put all empty
/// places into the root.
fn full_subtree(leaves: usize) -> usize {
    let mut full = 1;
    while full * WIDTH < leaves {
        full *= WIDTH;
    }
    full
}

/// Cuts `items` into `count` parts of `size` on the longest axis, again and again in halves.
fn cut<'a>(
    items: &'a mut [Item],
    count: usize,
    size: usize,
    crowded: &AtomicBool,
    parts: &mut Vec<&'a mut [Item]>,
) {
    if count <= 1 {
        return parts.push(items);
    }
    let (axis, extent) = longest_axis(items);
    if extent == 0.0 && items.len() >= CROWD {
        crowded.store(true, Relaxed);
    }
    let half = count / 2 * size;
    items.select_nth_unstable_by(half, |a, b| along(axis, a, b));
    let (left, right) = items.split_at_mut(half);
    cut(left, count / 2, size, crowded, parts);
    cut(right, count - count / 2, size, crowded, parts);
}

/// The order on an axis. Shells about one center are told apart by their radius.
fn along(axis: usize, a: &Item, b: &Item) -> Ordering {
    let by_center = a.center[axis].total_cmp(&b.center[axis]);
    by_center.then(a.radius.total_cmp(&b.radius)).then(a.id.cmp(&b.id))
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
fn bounds(items: &[Item]) -> Bounds {
    let mut all = Bounds::EMPTY;
    for item in items {
        let center = Vec3::from_array(item.center);
        let low = (center - item.radius - MARGIN).to_array().map(f32::next_down);
        let high = (center + item.radius + MARGIN).to_array().map(f32::next_up);
        all = all.union(&Bounds { low: low.into(), high: high.into() });
    }
    all
}
