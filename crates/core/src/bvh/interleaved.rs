//! Interleaved traversal: many rays, or packets of rays, pass the tree at once.
//!
//! A traversal is a chain of steps that wait for each other: for the loads, for the order of the
//! children, for the top of the stack. So several traversals take their steps in turn: all that are at a
//! node, then all that are at a leaf, then the spheres that those may hit. The steps of a turn do not
//! depend on each other, and bit masks note what each traversal visits next, without a branch that could
//! be mispredicted: so the processor overlaps them.

use super::child_order::{farthest_first, in_order};
use super::query::Query;
use super::resolver::{DONE, HitResolver};
use super::{Bvh, Child, DEPTH, Node, WIDTH};
use crate::lanes::{
    F32x8, Lanes, MAX_LANES, Mask, U32x16, least_lane, set_bits, shuffle, shuffle_numbers,
};
use crate::slabs::Slabs;
use crate::spheres::{LEAF, SphereBlock};

/// Capacity of a stack: the children still to visit, and a whole row of them after the last.
const STACK: usize = 8 + DEPTH * (WIDTH - 1) + WIDTH;

/// Rays that pass the tree together: a single ray, or a packet.
pub(super) trait RayGroup<Q: Query>: Copy {
    /// The rays that a group is made of.
    type Start;

    /// Its slabs.
    type Slabs: Slabs;

    /// Returns a group without rays.
    fn idle() -> Self;

    /// Becomes another group. Returns the distance beyond which it needs no answers, below 0 if it
    /// needs none. In place, for a group that is filled field by field should not be copied as a whole.
    fn start(
        &mut self,
        resolver: &mut HitResolver<Q>,
        start: Self::Start,
        slabs: &mut Self::Slabs,
    ) -> f32;

    /// Returns the spheres of a block that may be hit at a distance of at most `t_far`. The group passes
    /// the box of the block.
    fn test_leaf(
        &mut self,
        slabs: &Self::Slabs,
        t_far: f32,
        index: usize,
        block: &SphereBlock,
    ) -> u32;

    /// Tests spheres that may be hit: a bit for each, from sphere `first` on.
    fn test_spheres(&mut self, resolver: &mut HitResolver<Q>, first: usize, spheres: u32);

    /// Returns the distance beyond which the group needs no answers now, below 0 if it needs none.
    fn t_far(&self, resolver: &HitResolver<Q>) -> f32;

    /// Stores the hits, or keeps them pending until [`RayGroup::flush`].
    fn commit(&self, resolver: &mut HitResolver<Q>);

    /// Stores pending hits.
    #[inline(always)]
    fn flush(_: &mut HitResolver<Q>) {}
}

/// The traversal of a group.
#[derive(Clone, Copy)]
struct TraversalState<S, G> {
    slabs: S,
    group: G,
    /// The distance beyond which the group needs no answers, below 0 if it needs none.
    t_far: f32,
    /// True if `t_far` has decreased since the stack was culled.
    nearer: bool,
    /// Number of children on the stack, a sentinel included.
    top: u32,
    stack: Stack,
}

/// Children that are still to be visited, and distances before which their boxes are not entered.
#[derive(Clone, Copy)]
struct Stack {
    child: [Child; STACK],
    near: [f32; STACK],
}

/// Maximum number of traversals: there is a bit for each.
const MAX_IN_FLIGHT: usize = u64::BITS as usize;

/// The child that each traversal visits next.
struct NextVisits<const IN_FLIGHT: usize> {
    child: [Child; MAX_IN_FLIGHT],
    step: Step,
}

/// Traversals by what they visit: a bit for each.
#[derive(Clone, Copy, Default)]
struct Step {
    nodes: u64,
    leaves: u64,
    /// Traversals that have come to an end.
    ended: u64,
}

impl<const IN_FLIGHT: usize> NextVisits<IN_FLIGHT> {
    /// True if steps are computed in lanes. With few traversals lanes would wait for children that
    /// were written just before.
    const IN_LANES: bool = IN_FLIGHT >= MAX_LANES;

    fn new() -> Self {
        let ended = u64::MAX >> (MAX_IN_FLIGHT - IN_FLIGHT);
        Self { child: [Child::NONE; MAX_IN_FLIGHT], step: Step { ended, ..Step::default() } }
    }

    /// Returns what traversal `i` visits now.
    #[inline(always)]
    fn get(&self, i: usize) -> Child {
        self.child[i % MAX_IN_FLIGHT]
    }

    /// Sets what traversal `i` visits in the next step.
    #[inline(always)]
    fn set(&mut self, i: usize, child: Child) {
        self.child[i % MAX_IN_FLIGHT] = child;
        if !Self::IN_LANES {
            let [node, leaf, none] = child.kinds();
            self.step.nodes |= node << i;
            self.step.leaves |= leaf << i;
            self.step.ended |= none << i;
        }
    }

    /// Returns the next step of all traversals that are not idle.
    #[inline(always)]
    fn step(&mut self, idle: u64) -> Step {
        if !Self::IN_LANES {
            return std::mem::take(&mut self.step);
        }
        let (mut leaves, mut ended) = (0, 0);
        let rows: &[[u32; MAX_LANES]; MAX_IN_FLIGHT / MAX_LANES] = bytemuck::cast_ref(&self.child);
        for first in (0..IN_FLIGHT).step_by(MAX_LANES) {
            let [leaf, none] = Child::row_kinds(U32x16::new(rows[first / MAX_LANES]));
            leaves |= u64::from(leaf) << first;
            ended |= u64::from(none) << first;
        }
        let all = u64::MAX >> (MAX_IN_FLIGHT - IN_FLIGHT);
        Step { nodes: !(leaves | ended) & all, leaves: leaves & all, ended: ended & all & !idle }
    }
}

/// Traces groups through the tree, `IN_FLIGHT` at once: at most [`MAX_IN_FLIGHT`].
pub(super) fn trace<Q: Query, G: RayGroup<Q>, const IN_FLIGHT: usize>(
    bvh: &Bvh,
    resolver: &mut HitResolver<Q>,
    mut groups: impl Iterator<Item = G::Start>,
) {
    if bvh.is_empty() {
        return;
    }
    let mut states = [TraversalState::idle(G::idle()); IN_FLIGHT];
    let mut next = NextVisits::<IN_FLIGHT>::new();
    let mut idle = 0;
    loop {
        let step = next.step(idle);
        let mut started = 0;
        for i in set_bits(step.ended) {
            let state = &mut states[i % IN_FLIGHT];
            state.group.commit(resolver);
            if let Some(start) = groups.next() {
                state.t_far = state.group.start(resolver, start, &mut state.slabs);
                state.top = 1;
                next.set(i, Child::node(0));
                started += 1;
            } else {
                idle |= 1 << i;
            }
        }
        if step.nodes | step.leaves | started == 0 {
            return G::flush(resolver);
        }
        if Q::COUNTED {
            resolver.visits.nodes += u64::from(step.nodes.count_ones());
            resolver.visits.leaves += u64::from(step.leaves.count_ones());
        }
        for i in set_bits(step.nodes) {
            let node = &bvh.nodes()[next.get(i).index()];
            next.set(i, states[i % IN_FLIGHT].visit_node::<Q>(node));
        }
        visit_leaves(&mut states, &next, step.leaves, resolver);
        for i in set_bits(step.leaves) {
            let state = &mut states[i % IN_FLIGHT];
            if state.nearer {
                state.cull_stack::<Q>();
            }
            next.set(i, state.pop());
        }
    }
}

/// Tests the spheres of the leaves that traversals visit.
#[inline(always)]
fn visit_leaves<Q: Query, G: RayGroup<Q>, const IN_FLIGHT: usize>(
    states: &mut [TraversalState<G::Slabs, G>; IN_FLIGHT],
    next: &NextVisits<IN_FLIGHT>,
    at_leaves: u64,
    resolver: &mut HitResolver<Q>,
) {
    let mut candidates = [(0_u8, 0_u8); IN_FLIGHT];
    let mut count = 0;
    for i in set_bits(at_leaves) {
        let state = &mut states[i % IN_FLIGHT];
        let index = next.get(i).index();
        let block = &resolver.spheres.blocks()[index];
        let spheres = state.group.test_leaf(&state.slabs, state.t_far, index, block);
        candidates[count % IN_FLIGHT] = (i as u8, spheres as u8);
        count += usize::from(spheres != 0);
    }
    for &(i, spheres) in &candidates[..count.min(IN_FLIGHT)] {
        let state = &mut states[i as usize % IN_FLIGHT];
        let first = next.get(i as usize).index() * LEAF;
        if Q::COUNTED {
            resolver.visits.candidates += u64::from(spheres.count_ones());
        }
        state.group.test_spheres(resolver, first, u32::from(spheres));
        let t_far = state.group.t_far(resolver);
        state.nearer = t_far < state.t_far;
        state.t_far = t_far;
    }
}

impl<S: Slabs, G: Copy> TraversalState<S, G> {
    fn idle(group: G) -> Self {
        Self {
            slabs: S::IDLE,
            group,
            t_far: DONE,
            nearer: false,
            top: 1,
            stack: Stack { child: [Child::NONE; STACK], near: [0.0; STACK] },
        }
    }

    /// Pushes the children of a node whose boxes are entered, and returns the child that is visited next: for the first hit
    /// the one that is entered first, for any hit the first in the order of the octant.
    #[inline(always)]
    fn visit_node<Q: Query>(&mut self, node: &Node) -> Child {
        let (entered, near) = self.slabs.entered(&node.planes, self.t_far);
        let (hit, top) = (entered.bits(), self.top as usize);
        if Q::ANY {
            let order = farthest_first(self.slabs.octant(), hit);
            self.stack.put(top, bytemuck::cast_ref(&node.child), order);
            self.top += hit.count_ones();
            return self.pop();
        }
        let nearest = least_lane(near, entered);
        let rest = hit & !(1 << nearest);
        let last = self.stack.child[top - 1];
        let order = farthest_first(self.slabs.octant(), rest);
        self.stack.put(top, bytemuck::cast_ref(&node.child), order);
        shuffle(near, order).store(&mut self.stack.near[top..top + WIDTH]);
        // Without a branch: the last of the stack if nothing is entered.
        self.top = self.top + rest.count_ones() - u32::from(hit == 0);
        if hit == 0 { last } else { node.child[nearest] }
    }

    /// Pops the child that is visited next.
    #[inline(always)]
    fn pop(&mut self) -> Child {
        self.top -= 1;
        self.stack.child[self.top as usize]
    }

    /// Removes children from the stack that are beyond `t_far`: all if no more answers are needed.
    #[inline(always)]
    fn cull_stack<Q: Query>(&mut self) {
        self.nearer = false;
        if Q::ANY && self.t_far >= 0.0 {
            return;
        }
        let full = std::mem::replace(&mut self.top, 1);
        if self.t_far < 0.0 {
            return;
        }
        for first in (1..full).step_by(WIDTH) {
            let near = F32x8::load(&self.stack.near[first as usize..]);
            let mut row = [Child::NONE; WIDTH];
            row.copy_from_slice(&self.stack.child[first as usize..first as usize + WIDTH]);
            let used = !(u32::MAX << (full - first).min(WIDTH as u32));
            let kept = near.le(F32x8::splat(self.t_far)).bits() & used;
            let (order, top) = (in_order(kept), self.top as usize);
            self.stack.put(top, &bytemuck::cast(row), order);
            shuffle(near, order).store(&mut self.stack.near[top..top + WIDTH]);
            self.top += kept.count_ones();
        }
    }
}

impl Stack {
    /// Writes a permuted row of children from place `top` on.
    #[inline(always)]
    fn put(&mut self, top: usize, row: &[u32; WIDTH], order: u32) {
        let row: [Child; WIDTH] = bytemuck::cast(shuffle_numbers(row, order));
        self.child[top..top + WIDTH].copy_from_slice(&row);
    }
}
