//! From the binary tree to the wide one.
//!
//! A wide node is a few levels of branches, chosen so that the whole tree costs least
//! ([`branch::best`]); where it would become deeper than the walks' stacks allow, so that it is
//! shallow.

use super::branch::{self, Branch, Top};
use super::item::{Extent, Item};
use super::tasks::{PARALLEL, freeing};
use crate::bvh::{Bounds, Child, DEPTH, Node, WIDTH, child_order};
use crate::spheres::{LEAF, Spheres};
use rayon::prelude::*;
use std::ops::Deref;

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

/// The children of a node.
struct Parts<'a> {
    part: [Part<'a>; WIDTH],
    count: usize,
}

impl<'a> Parts<'a> {
    const NONE: Self = Self { part: [Part { branches: &[], block: 0 }; WIDTH], count: 0 };

    /// Appends one of at most [`WIDTH`].
    fn push(&mut self, part: Part<'a>) {
        self.part[self.count] = part;
        self.count += 1;
    }

    /// Puts two in the place of one.
    fn divide(&mut self, i: usize, [first, second]: [Part<'a>; 2]) {
        self.part.copy_within(i..self.count, i + 1);
        (self.part[i], self.part[i + 1]) = (first, second);
        self.count += 1;
    }
}

impl<'a> Deref for Parts<'a> {
    type Target = [Part<'a>];

    fn deref(&self) -> &[Part<'a>] {
        &self.part[..self.count]
    }
}

/// Nodes in a row, as one task made them.
struct Run {
    nodes: Vec<Node>,
    /// Offset to be added to their children's indices.
    base: usize,
}

/// The nodes over the spheres, root first; a single leaf has a root of its own.
pub(super) fn nodes(branches: Vec<Branch>, spheres: &Spheres) -> Vec<Node> {
    let root = Part { branches: &branches, block: 0 };
    if branches.is_empty() && spheres.is_empty() {
        return Vec::new();
    }
    if branches.is_empty() {
        return vec![over(&[root], spheres, |_| 0)];
    }
    let runs = runs(root, spheres, DEPTH);
    freeing(branches, || joined(runs))
}

/// The nodes of a part that is at most `levels` deep, in the order in which they are to be.
fn runs(part: Part, spheres: &Spheres, levels: usize) -> Vec<Run> {
    if part.branches.len() * LEAF < PARALLEL {
        // Most nodes have six children and more.
        let mut nodes = Vec::with_capacity(part.branches.len() / 5 + 1);
        emit(part, spheres, levels, &mut nodes);
        return vec![Run { nodes, base: 0 }];
    }
    let parts = children(part, levels);
    let below = |&part: &Part| match part.branches {
        [] => Vec::new(),
        _ => runs(part, spheres, levels - 1),
    };
    let below: Vec<_> = parts.par_iter().map(below).collect();
    let (mut begins, mut length) = (Vec::with_capacity(WIDTH), 1);
    let mut all = vec![Run { nodes: Vec::new(), base: 0 }];
    for runs in below {
        begins.push(length);
        let begin = length;
        for mut run in runs {
            run.base += begin;
            length += run.nodes.len();
            all.push(run);
        }
    }
    all[0].nodes.push(over(&parts, spheres, |i| begins[i]));
    all
}

/// All nodes in one row.
fn joined(mut runs: Vec<Run>) -> Vec<Node> {
    if let [only] = &mut *runs {
        return std::mem::take(&mut only.nodes);
    }
    let count: usize = runs.iter().map(|run| run.nodes.len()).sum();
    let mut nodes: Vec<_> = (0..count).into_par_iter().map(|_| Node::EMPTY).collect();
    let (mut rest, mut places) = (&mut *nodes, Vec::with_capacity(runs.len()));
    for run in &runs {
        places.push(rest.split_off_mut(..run.nodes.len()).unwrap_or_default());
    }
    places.into_par_iter().zip(runs).for_each(|(places, run)| {
        for (place, node) in places.iter_mut().zip(run.nodes) {
            *place = moved(node, run.base);
        }
    });
    nodes
}

/// Appends a node and all that is below it, at most `levels` deep.
fn emit(part: Part, spheres: &Spheres, levels: usize, nodes: &mut Vec<Node>) {
    let parts = children(part, levels);
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let mut begins = [0; WIDTH];
    for (begin, &part) in begins.iter_mut().zip(&*parts) {
        *begin = nodes.len();
        if !part.branches.is_empty() {
            emit(part, spheres, levels - 1, nodes);
        }
    }
    nodes[index] = over(&parts, spheres, |i| begins[i]);
}

/// The node over some parts, where those that are not leaves begin at certain nodes.
fn over(parts: &[Part], spheres: &Spheres, begin: impl Fn(usize) -> usize) -> Node {
    let mut boxes = [Bounds::EMPTY; WIDTH];
    for (bounds, &part) in boxes.iter_mut().zip(parts) {
        *bounds = box_of(part, spheres);
    }
    let mut node = Node::EMPTY;
    let slots = child_order::slots(&boxes[..parts.len()]);
    for (i, (part, slot)) in parts.iter().zip(slots).enumerate() {
        let child = match part {
            Part { branches: [], block } => Child::leaf(*block),
            _ => Child::node(begin(i)),
        };
        node.set(slot, child, &boxes[i]);
    }
    node
}

fn box_of(part: Part, spheres: &Spheres) -> Bounds {
    let leaf = || {
        let first = part.block * LEAF;
        let rows = first..spheres.len().min(first + LEAF);
        Extent::around(rows.map(|row| Item::of(spheres, row))).bounds()
    };
    part.branches.first().map_or_else(leaf, |root| root.top.bounds)
}

/// A node of which the first of its tree is not the first of all, but the one after `base`.
fn moved(mut node: Node, base: usize) -> Node {
    for child in &mut node.child {
        if child.kind() == 0 {
            *child = Child::node(child.index() + base);
        }
    }
    node
}

/// The children of a node that may be `levels` deep: two to [`WIDTH`].
fn children(part: Part, levels: usize) -> Parts {
    let mut parts = Parts::NONE;
    share(part, WIDTH, &mut parts);
    if parts.iter().any(|part| part.height() > 3 * (levels - 1)) {
        parts = Parts::NONE;
        parts.push(part);
        while parts.len() < WIDTH {
            let tallest = (0..parts.len()).rev().max_by_key(|&i| parts[i].height()).unwrap_or(0);
            let Some(halves) = parts[tallest].halves() else { break };
            parts.divide(tallest, halves);
        }
    }
    parts
}

/// Shares `roots` children of a wide node among the halves of a part.
fn share<'a>(part: Part<'a>, roots: usize, parts: &mut Parts<'a>) {
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
