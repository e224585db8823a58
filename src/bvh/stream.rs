//! The walk: many rays, or packets of rays, on their way through the tree at once.
//!
//! A walk is a chain of steps that wait for each other: for the loads, for the order of the
//! children, for what is on top of the stack. So some walks take turns: all that are at a node take
//! one step, then all that are at a leaf, then all spheres that those may hit are tested. The steps
//! of a turn do not depend on each other, and what comes next is noted in bit masks, without a branch
//! that could be mispredicted: so the processor overlaps them.

use super::decide::{DONE, Decider};
use super::walk::Query;
use super::{Bvh, Child, DEPTH, Node, WIDTH, order};
use crate::lanes::{F32x8, Lanes, MAX_LANES, Mask, U32x16, set_bits, shuffle, shuffle_numbers};
use crate::slabs::Slabs;
use crate::spheres::{Block, LEAF};

/// Room for the children still to visit, and for a whole row of them after the last.
const STACK: usize = 8 + DEPTH * (WIDTH - 1) + WIDTH;

/// What goes through the tree together: one ray, or a packet.
pub(super) trait Bundle<Q: Query>: Copy {
    /// What says which rays they are.
    type Start;

    /// In place of a bundle where there is none.
    fn none() -> Self;

    /// Becomes another bundle. Returns the distance beyond which it needs no answers; below 0 if it
    /// needs none. In place, for what is put together in parts should not be copied as a whole.
    fn begin(&mut self, decider: &mut Decider<Q>, start: Self::Start, slabs: &mut Slabs) -> f32;

    /// Which spheres of a block may be hit at a distance of at most `t_far`. The bundle is within
    /// the slabs.
    fn meets(&mut self, slabs: &Slabs, t_far: f32, index: usize, block: &Block) -> u32;

    /// Finds out about spheres that may be hit: a bit for each from the first on.
    fn test(&mut self, decider: &mut Decider<Q>, first: usize, spheres: u32);

    /// The distance beyond which it needs no answers now; below 0 if it needs none.
    fn t_far(&self, decider: &Decider<Q>) -> f32;

    /// Leaves all answers in the hits, or has them wait until [`Bundle::finish`].
    fn settle(&self, decider: &mut Decider<Q>);

    /// Leaves the answers that wait in the hits.
    #[inline(always)]
    fn finish(_: &mut Decider<Q>) {}
}

/// A bundle on its way.
#[derive(Clone, Copy)]
struct Flight<B> {
    slabs: Slabs,
    bundle: B,
    /// Beyond this nothing counts; below 0 nothing does.
    t_far: f32,
    /// Whether `t_far` is less than it was when the stack was filled.
    nearer: bool,
    /// How many children are on the stack, a sentinel included.
    top: u32,
    stack: Stack,
}

/// What is still to visit: children, and distances before which their boxes are not met.
#[derive(Clone, Copy)]
struct Stack {
    child: [Child; STACK],
    near: [f32; STACK],
}

/// Most flights: there is a bit for each.
const MOST: usize = u64::BITS as usize;

/// What flights visit next.
struct Next<const FLIGHTS: usize> {
    child: [Child; MOST],
    turn: Turn,
}

/// Flights by what they visit: a bit for each.
#[derive(Clone, Copy, Default)]
struct Turn {
    nodes: u64,
    leaves: u64,
    arrived: u64,
}

impl<const FLIGHTS: usize> Next<FLIGHTS> {
    /// Lanes would wait for what a few flights have just written.
    const IN_LANES: bool = FLIGHTS >= MAX_LANES;

    fn new() -> Self {
        let arrived = u64::MAX >> (MOST - FLIGHTS);
        Self { child: [Child::NONE; MOST], turn: Turn { arrived, ..Turn::default() } }
    }

    /// What the flight at a place visits now.
    #[inline(always)]
    fn at(&self, place: usize) -> Child {
        self.child[place % MOST]
    }

    /// Says what the flight at a place visits in the next turn.
    #[inline(always)]
    fn set(&mut self, place: usize, child: Child) {
        self.child[place % MOST] = child;
        if !Self::IN_LANES {
            let [node, leaf, none] = child.kinds();
            self.turn.nodes |= node << place;
            self.turn.leaves |= leaf << place;
            self.turn.arrived |= none << place;
        }
    }

    /// Begins a turn of all flights but those that are idle.
    #[inline(always)]
    fn turn(&mut self, idle: u64) -> Turn {
        if !Self::IN_LANES {
            return std::mem::take(&mut self.turn);
        }
        let (mut leaves, mut arrived) = (0, 0);
        let rows: &[[u32; MAX_LANES]; MOST / MAX_LANES] = bytemuck::cast_ref(&self.child);
        for first in (0..FLIGHTS).step_by(MAX_LANES) {
            let [leaf, none] = Child::are(U32x16::new(rows[first / MAX_LANES]));
            leaves |= u64::from(leaf) << first;
            arrived |= u64::from(none) << first;
        }
        let all = u64::MAX >> (MOST - FLIGHTS);
        Turn {
            nodes: !(leaves | arrived) & all,
            leaves: leaves & all,
            arrived: arrived & all & !idle,
        }
    }
}

/// Sends bundles on their way, `FLIGHTS` at once: at most [`MOST`].
pub(super) fn trace<Q: Query, B: Bundle<Q>, const FLIGHTS: usize>(
    bvh: &Bvh,
    decider: &mut Decider<Q>,
    mut bundles: impl Iterator<Item = B::Start>,
) {
    if bvh.is_empty() {
        return;
    }
    let mut flights = [Flight::idle(B::none()); FLIGHTS];
    let mut next = Next::<FLIGHTS>::new();
    let mut idle = 0;
    loop {
        let now = next.turn(idle);
        let mut begun = 0;
        for place in set_bits(now.arrived) {
            let flight = &mut flights[place % FLIGHTS];
            flight.bundle.settle(decider);
            if let Some(start) = bundles.next() {
                flight.t_far = flight.bundle.begin(decider, start, &mut flight.slabs);
                flight.top = 1;
                next.set(place, Child::node(0));
                begun += 1;
            } else {
                idle |= 1 << place;
            }
        }
        if now.nodes | now.leaves | begun == 0 {
            return B::finish(decider);
        }
        if Q::COUNTED {
            decider.visits.nodes += u64::from(now.nodes.count_ones());
            decider.visits.leaves += u64::from(now.leaves.count_ones());
        }
        for place in set_bits(now.nodes) {
            let node = &bvh.nodes()[next.at(place).index()];
            next.set(place, flights[place % FLIGHTS].step::<Q>(node));
        }
        visit_leaves(&mut flights, &next, now.leaves, decider);
        for place in set_bits(now.leaves) {
            let flight = &mut flights[place % FLIGHTS];
            if flight.nearer {
                flight.forget::<Q>();
            }
            next.set(place, flight.pop());
        }
    }
}

/// Tests the spheres of the blocks that flights are at.
#[inline(always)]
fn visit_leaves<Q: Query, B: Bundle<Q>, const FLIGHTS: usize>(
    flights: &mut [Flight<B>; FLIGHTS],
    at: &Next<FLIGHTS>,
    places: u64,
    decider: &mut Decider<Q>,
) {
    let mut candidates = [(0_u8, 0_u8); FLIGHTS];
    let mut count = 0;
    for place in set_bits(places) {
        let flight = &mut flights[place % FLIGHTS];
        let index = at.at(place).index();
        let block = &decider.spheres.blocks()[index];
        let met = flight.bundle.meets(&flight.slabs, flight.t_far, index, block);
        candidates[count % FLIGHTS] = (place as u8, met as u8);
        count += usize::from(met != 0);
    }
    for &(place, met) in &candidates[..count.min(FLIGHTS)] {
        let flight = &mut flights[place as usize % FLIGHTS];
        let first = at.at(place as usize).index() * LEAF;
        if Q::COUNTED {
            decider.visits.candidates += u64::from(met.count_ones());
        }
        flight.bundle.test(decider, first, u32::from(met));
        let t_far = flight.bundle.t_far(decider);
        flight.nearer = t_far < flight.t_far;
        flight.t_far = t_far;
    }
}

impl<B: Copy> Flight<B> {
    fn idle(bundle: B) -> Self {
        Self {
            slabs: Slabs::IDLE,
            bundle,
            t_far: DONE,
            nearer: false,
            top: 1,
            stack: Stack { child: [Child::NONE; STACK], near: [0.0; STACK] },
        }
    }

    /// Visits a node: what may be met goes on the stack, the nearest last, and is taken from there.
    #[inline(always)]
    fn step<Q: Query>(&mut self, node: &Node) -> Child {
        let (hit, near) = self.slabs.enters(&node.planes, self.t_far);
        let order = order::farthest_first(self.slabs.octant, hit);
        self.stack.put(self.top as usize, bytemuck::cast_ref(&node.child), order);
        if !Q::ANY {
            let top = self.top as usize;
            shuffle(near, order).store(&mut self.stack.near[top..top + WIDTH]);
        }
        self.top += hit.count_ones();
        self.pop()
    }

    /// Takes what is visited next off the stack.
    #[inline(always)]
    fn pop(&mut self) -> Child {
        self.top -= 1;
        self.stack.child[self.top as usize]
    }

    /// Takes what is too far off the stack: all of it if no more answers are needed.
    #[inline(always)]
    fn forget<Q: Query>(&mut self) {
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
            let there = !(u32::MAX << (full - first).min(WIDTH as u32));
            let kept = near.le(F32x8::splat(self.t_far)).bits() & there;
            let (order, top) = (order::in_order(kept), self.top as usize);
            self.stack.put(top, &bytemuck::cast(row), order);
            shuffle(near, order).store(&mut self.stack.near[top..top + WIDTH]);
            self.top += kept.count_ones();
        }
    }
}

impl Stack {
    #[inline(always)]
    fn put(&mut self, top: usize, row: &[u32; WIDTH], order: u32) {
        let row: [Child; WIDTH] = bytemuck::cast(shuffle_numbers(row, order));
        self.child[top..top + WIDTH].copy_from_slice(&row);
    }
}
