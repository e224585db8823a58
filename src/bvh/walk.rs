//! Which walk takes which rays.
//!
//! All of them find the same, for hits are decided in one place, `decide`. Rays that go alike go in
//! packets (`packet`), others each on its own (`deferred`, or `single` where each hit is to be decided
//! at once), many at a time (`stream`). Brute force is a packet's test over all spheres: the oracle,
//! and where there are few, sooner done than others.

use super::decide::Decider;
use super::deferred::Deferred;
use super::others::{Others, starts};
use super::packet::Packet;
use super::ready::Start;
use super::single::Single;
use super::{Bvh, stream};
use crate::lanes::{Lanes, Mask};
use crate::ray::{CHUNK, Hits, Rays};
use crate::spheres::{LEAF, Spheres};
use std::marker::PhantomData;
use std::ops::Range;

/// Single rays on their way at once. By million rays per second on scenes of 400 to a million spheres:
/// 64 beats 32 by up to a tenth, 16 by a quarter, 8 by a third.
const RAYS: usize = 64;

/// Packets on their way at once: 8 beats 4 by some percent, and 16 is no better.
const PACKETS: usize = 8;

/// Up to so many spheres, all rays are tested against all of them, in packets: a tree of two leaves saves
/// less than it takes to look for rays that go alike.
const FEWEST: usize = 10;

/// Up to so many spheres, rays that do not go alike are tested against all of them, in packets: with 32 of
/// them that takes as long as the tree does for rays that end at any hit, with 8 a third.
const SMALL: usize = 24;

/// How far rays of a packet may start from its middle one on any axis, in sizes of a leaf. What is
/// farther costs more than it saves: 1 is better than this by a tenth on scenes of a few thousand
/// spheres and worse by as much on flat ones of many.
const NEAR: f32 = 0.75;

/// How much directions of a packet's rays may differ from its middle one's on any axis, in sizes of a
/// leaf over that of the scene. Camera rays of a million spheres break even at about this.
const SPREAD: f32 = 0.5;

/// A packet is no less than one over this full.
const FEW: usize = 2;

/// What a walk wants to know.
pub trait Query {
    /// Whether any hit ends a ray's walk.
    const ANY: bool;
    /// Whether hits are decided exactly.
    const EXACT: bool = true;
    /// Whether what is visited is counted.
    const COUNTED: bool = false;
}

/// Which sphere is hit first: leaves `t` and `sphere` of the hit.
pub struct Closest;

/// Whether anything is hit nearer than `t`: leaves some sphere, or what was there.
pub struct Any;

/// A query that takes the filter's word for hits and distances, in single precision. For benches
/// alone: what it saves is what exactness costs.
pub struct Rough<Q>(PhantomData<Q>);

impl<Q: Query> Query for Rough<Q> {
    const ANY: bool = Q::ANY;
    const EXACT: bool = false;
}

/// A query that counts what its rays visit. For benches alone: others do not even test whether to
/// count.
struct Counted<Q>(PhantomData<Q>);

impl<Q: Query> Query for Counted<Q> {
    const ANY: bool = Q::ANY;
    const EXACT: bool = Q::EXACT;
    const COUNTED: bool = true;
}

/// What rays visit. What a packet does counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visits {
    /// Nodes, the root among them.
    pub nodes: u64,
    /// Leaves.
    pub leaves: u64,
    /// Spheres that a leaf's test did not rule out.
    pub candidates: u64,
}

impl Visits {
    /// Spheres that are tested, whole leaves of them.
    pub fn spheres(&self) -> u64 {
        self.leaves * LEAF as u64
    }
}

impl Query for Closest {
    const ANY: bool = false;
}

impl Query for Any {
    const ANY: bool = true;
}

/// How rays find spheres. The answer is the same whichever it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Test every sphere.
    Brute,
    /// One ray after another.
    Single,
    /// Many rays at a time, each on its own.
    Stream,
    /// In packets where rays go alike, and one after another elsewhere.
    Packet,
    /// In packets where rays go so much alike that it pays, and many at a time elsewhere, or against every
    /// sphere where there are few.
    Auto,
}

/// Traces all rays, in packets of `L::WIDTH` if any; `hits` holds bounds on entry, answers on return.
///
/// Returns how many decisions took arithmetic without rounding.
pub fn trace<'a, L: Lanes, Q: Query>(
    method: Method,
    bvh: &'a Bvh,
    spheres: &'a Spheres,
    rays: &'a Rays,
    hits: &'a mut Hits,
) -> u64 {
    walk::<L, Q>(method, bvh, spheres, rays, hits).exact
}

/// [`trace`], to count what rays visit.
pub fn visits<'a, L: Lanes, Q: Query>(
    method: Method,
    bvh: &'a Bvh,
    spheres: &'a Spheres,
    rays: &'a Rays,
    hits: &'a mut Hits,
) -> Visits {
    walk::<L, Counted<Q>>(method, bvh, spheres, rays, hits).visits
}

/// Returns who decided, with what was counted.
#[inline(always)]
fn walk<'a, L: Lanes, Q: Query>(
    method: Method,
    bvh: &'a Bvh,
    spheres: &'a Spheres,
    rays: &'a Rays,
    hits: &'a mut Hits,
) -> Decider<'a, Q> {
    let mut all = Decider::<Q>::new(spheres, rays, hits);
    let decider = &mut all;
    for first in (0..rays.len()).step_by(CHUNK) {
        let rows = first..rays.len().min(first + CHUNK);
        decider.hits.error[..rows.len()].fill(0.0);
        match method {
            Method::Brute => test_all::<L, Q>(decider, rows, &[u32::MAX; CHUNK]),
            Method::Auto if spheres.len() <= FEWEST => {
                test_all::<L, Q>(decider, rows, &[u32::MAX; CHUNK]);
            }
            Method::Single => stream::trace::<_, Single, 1>(bvh, decider, starts(rows)),
            Method::Stream => alone(bvh, decider, starts(rows)),
            Method::Packet => together::<L, Q>(bvh, f32::INFINITY, decider, rows),
            Method::Auto if spheres.len() <= SMALL => among_few::<L, Q>(bvh, decider, rows),
            Method::Auto => together::<L, Q>(bvh, bvh.grain, decider, rows),
        }
        decide_doubtful(bvh, decider, method == Method::Brute || spheres.len() <= SMALL);
    }
    all
}

/// Traces rays that go alike through the tree, and tests others against every sphere.
#[inline(always)]
fn among_few<L: Lanes, Q: Query>(bvh: &Bvh, decider: &mut Decider<Q>, rows: Range<usize>) {
    let rays = decider.rays;
    let (mut others, mut count) = ([0_u32; CHUNK], 0);
    let packets = rows.clone().step_by(L::WIDTH).filter_map(|row| {
        let members = alike::<L>(rays, row, bvh.grain);
        others[count] = !members;
        count += 1;
        (members != 0).then_some((row, members))
    });
    stream::trace::<_, Packet<L>, PACKETS>(bvh, decider, packets);
    test_all::<L, Q>(decider, rows, &others);
}

/// Tests every sphere, for rays of which a bit is set: of each row of lanes.
#[inline(always)]
fn test_all<L: Lanes, Q: Query>(decider: &mut Decider<Q>, rows: Range<usize>, some: &[u32; CHUNK]) {
    for (row, some) in rows.clone().step_by(L::WIDTH).zip(some) {
        let lanes = lanes_from(row, L::WIDTH, rows.end) & some;
        if lanes != 0 {
            Packet::<L>::brute(decider, (row, lanes));
        }
    }
}

/// Traces rays that go alike together, as far as the size of a leaf tells, and others alone.
#[inline(always)]
fn together<L: Lanes, Q: Query>(
    bvh: &Bvh,
    grain: f32,
    decider: &mut Decider<Q>,
    rows: Range<usize>,
) {
    let rays = decider.rays;
    let mut others = Others::of_chunk(rows.start);
    let packets = rows.clone().step_by(L::WIDTH).filter_map(|row| {
        let members = alike::<L>(rays, row, grain);
        others.push::<L>(row, !members & lanes_from(row, L::WIDTH, rows.end));
        (members != 0).then_some((row, members))
    });
    stream::trace::<_, Packet<L>, PACKETS>(bvh, decider, packets);
    if !others.is_empty() {
        alone(bvh, decider, others.starts());
    }
}

/// Traces rays each on its own, many at a time.
#[inline(always)]
fn alone<Q: Query>(bvh: &Bvh, decider: &mut Decider<Q>, rays: impl Iterator<Item = Start>) {
    if Q::ANY || !decider.is_plain() {
        stream::trace::<_, Single, RAYS>(bvh, decider, rays);
    } else {
        stream::trace::<_, Deferred, RAYS>(bvh, decider, rays);
    }
}

/// Looks anew at rays of which it is not sure what they hit: with the tree or, if `brute`, without.
#[inline(always)]
fn decide_doubtful<Q: Query>(bvh: &Bvh, decider: &mut Decider<Q>, brute: bool) {
    let mut doubtful = std::mem::take(&mut decider.doubtful);
    let rows = doubtful.iter().map(|&row| row as usize);
    let one = |row| Start { row, few: true };
    if brute {
        rows.for_each(|row| Single::brute(decider, row));
    } else if doubtful.len() >= RAYS {
        stream::trace::<_, Single, RAYS>(bvh, decider, rows.map(one));
    } else if !doubtful.is_empty() {
        stream::trace::<_, Single, 1>(bvh, decider, rows.map(one));
    }
    // With its memory.
    doubtful.clear();
    decider.doubtful = doubtful;
}

/// A bit for each row in `row..row + width` that is less than `end`.
#[inline(always)]
fn lanes_from(row: usize, width: usize, end: usize) -> u32 {
    u32::MAX >> (u32::BITS as usize - width.min(end - row))
}

/// The rays of a row that go together with the one in its middle, if they are enough.
#[inline(always)]
fn alike<L: Lanes>(rays: &Rays, row: usize, grain: f32) -> u32 {
    let lanes = lanes_from(row, L::WIDTH, rays.len());
    let middle = row + L::WIDTH.min(rays.len() - row) / 2;
    let (origin, direction) = (rays.origin.load::<L>(row), rays.direction.load::<L>(row));
    let (at, toward) = (rays.origin.row(middle), rays.direction.row(middle));
    let close = |x: L, middle: f32, span: f32| (x - L::splat(middle)).abs().le(L::splat(span));
    let same = |x: L, middle: f32| {
        if middle.is_sign_negative() { x.is_negative() } else { !x.is_negative() }
    };
    let (near, spread) = (NEAR * grain, SPREAD * grain);
    let members = close(origin.x, at.x, near)
        & close(origin.y, at.y, near)
        & close(origin.z, at.z, near)
        & close(direction.x, toward.x, spread)
        & close(direction.y, toward.y, spread)
        & close(direction.z, toward.z, spread)
        & same(direction.x, toward.x)
        & same(direction.y, toward.y)
        & same(direction.z, toward.z);
    let bits = members.bits() & lanes;
    if (bits.count_ones() as usize) * FEW < L::WIDTH { 0 } else { bits }
}
