//! From the binary tree to the wide one.
//!
//! A wide node is a few levels of branches, chosen so that the whole tree costs least
//! ([`branch::best`]); where it would become deeper than the walks' stacks allow, so that it is
//! shallow.

use super::PARALLEL;
use super::branch::{self, Branch, Top};
use super::item::{Item, bounds};
use crate::bvh::{Bounds, Child, DEPTH, Node, WIDTH, order};
use crate::spheres::LEAF;
use rayon::prelude::*;

/// A part of the binary tree.
#[derive(Clone, Copy)]
struct Part<'a> {
    /// None for a leaf.
    branches: &'a [Branch],
    /// Number of its first block.
    block: usize,
}

impl<'a> Part<'a> {
    fn halves(self) -> Option<[Self; 2]> {
        let (root, rest) = self.branches.split_first()?;
        let (left, right) = rest.split_at(root.first as usize - 1);
        let block = self.block + root.first as usize;
        Some([Self { branches: left, block: self.block }, Self { branches: right, block }])
    }

    fn top(self) -> &'a Top {
        const LEAF: &Top = &Branch::NONE.top;
        self.branches.first().map_or(LEAF, |root| &root.top)
    }

    fn height(self) -> usize {
        self.top().height as usize
    }
}

/// The nodes over `items`, root first; a single leaf has a root of its own.
pub(super) fn nodes(branches: &[Branch], items: &[Item]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(branches.len().div_ceil(WIDTH - 1) * 3 / 2 + 1);
    let root = Part { branches, block: 0 };
    if branches.is_empty() {
        nodes.push(node(&[(root, bounds(items.iter()))], |_| Child::leaf(0)));
    } else {
        emit(root, items, DEPTH, &mut nodes);
    }
    nodes
}

/// Appends a node and all that is below it, at most `levels` deep.
fn emit(part: Part, items: &[Item], levels: usize, nodes: &mut Vec<Node>) {
    let parts = children(part, levels);
    let boxed: Vec<_> = parts.iter().map(|&part| (part, box_of(part, items))).collect();
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let below = if part.branches.len() * LEAF >= PARALLEL {
        emit_in_parallel(&parts, items, levels - 1, nodes)
    } else {
        parts.iter().map(|&part| emit_below(part, items, levels - 1, nodes)).collect()
    };
    nodes[index] = node(&boxed, |i| match parts[i] {
        Part { branches: [], block } => Child::leaf(block),
        _ => Child::node(below[i]),
    });
}

/// Appends a part unless it is a leaf; returns where it begins.
fn emit_below(part: Part, items: &[Item], levels: usize, nodes: &mut Vec<Node>) -> usize {
    let base = nodes.len();
    if !part.branches.is_empty() {
        emit(part, items, levels, nodes);
    }
    base
}

fn emit_in_parallel(
    parts: &[Part],
    items: &[Item],
    levels: usize,
    nodes: &mut Vec<Node>,
) -> Vec<usize> {
    let subtree = |&part: &Part| {
        let mut nodes = Vec::new();
        emit_below(part, items, levels, &mut nodes);
        nodes
    };
    let subtrees: Vec<_> = parts.par_iter().map(subtree).collect();
    let append = |subtree: Vec<Node>| {
        let base = nodes.len();
        nodes.extend(subtree.into_iter().map(|node| moved(node, base)));
        base
    };
    subtrees.into_iter().map(append).collect()
}

fn box_of(part: Part, items: &[Item]) -> Bounds {
    let leaf = || {
        let first = part.block * LEAF;
        bounds(items[first..items.len().min(first + LEAF)].iter())
    };
    part.branches.first().map_or_else(leaf, |root| root.top.bounds)
}

/// A node of some children.
fn node(boxed: &[(Part, Bounds)], child: impl Fn(usize) -> Child) -> Node {
    let mut node = Node::EMPTY;
    let boxes: Vec<_> = boxed.iter().map(|part| part.1).collect();
    for (i, slot) in order::slots(&boxes).into_iter().take(boxes.len()).enumerate() {
        node.set(slot, child(i), &boxes[i]);
    }
    node
}

/// A node whose subtree begins at `base`.
fn moved(mut node: Node, base: usize) -> Node {
    for child in &mut node.child {
        if child.kind() == 0 {
            *child = Child::node(child.index() + base);
        }
    }
    node
}

/// The children of a node that may be `levels` deep: two to [`WIDTH`].
fn children(part: Part, levels: usize) -> Vec<Part> {
    let mut parts = Vec::with_capacity(WIDTH);
    share(part, WIDTH, &mut parts);
    if parts.iter().any(|part| part.height() > 3 * (levels - 1)) {
        parts = vec![part];
        while parts.len() < WIDTH {
            let tallest = (0..parts.len()).rev().max_by_key(|&i| parts[i].height()).unwrap_or(0);
            let Some(halves) = parts[tallest].halves() else { break };
            parts.splice(tallest..=tallest, halves);
        }
    }
    parts
}

/// Shares `roots` children of a wide node among the halves of a part.
fn share<'a>(part: Part<'a>, roots: usize, parts: &mut Vec<Part<'a>>) {
    let Some([left, right]) = part.halves().filter(|_| roots > 1) else {
        return parts.push(part);
    };
    let (first, cost) = branch::best(left.top(), right.top(), roots);
    if roots < WIDTH && part.top().forest[0] <= cost {
        return parts.push(part);
    }
    share(left, first, parts);
    share(right, roots - first, parts);
}
