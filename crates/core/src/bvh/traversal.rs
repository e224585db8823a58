//! Chooses a traversal for each ray of a batch: in a packet, with other rays in flight, or by brute
//! force.
//!
//! All traversals find the same hits, for hits are decided in one place, the
//! [`HitResolver`](super::resolver::HitResolver). Coherent rays are traced in packets (`packet`),
//! incoherent rays one by one with many of them in flight (`single`, `interleaved`). Brute force tests
//! a packet against all spheres: it is the oracle, and the fastest way where there are few spheres.

use super::interleaved;
use super::packet::{Packet, PacketStart};
use super::query::{Any, Closest, Counted, Query, Visits};
use super::ray_setup::RayStart;
use super::resolver::HitResolver;
use super::single::{DeferredRay, SingleRay};
use super::{Bvh, Tree};
use crate::lanes::{F32x4, F32x8, F32x16, Lanes, MAX_LANES, Mask, Packing, U32x16, set_bits};
use crate::ray::{CHUNK, Hits, Rays};
use std::marker::PhantomData;
use std::ops::Range;

/// Incoherent rays in flight. By million rays per second on scenes of 400 to a million spheres: 64
/// beats 32 by up to a tenth, 16 by a quarter, 8 by a third.
const RAYS_IN_FLIGHT: usize = 64;

/// Packets in flight: 8 beats 4 by some percent, and 16 is no better.
const PACKETS_IN_FLIGHT: usize = 8;

/// Up to this many spheres, all rays are tested against all spheres: a tree of two leaves saves less
/// time than the search for coherent rays takes.
const BRUTE_FORCE: usize = 10;

/// Up to this many spheres, incoherent rays are tested against all spheres: with 32 spheres that takes
/// as long as the tree does for any hit, with 8 spheres a third of the time.
const SMALL_SCENE: usize = 24;

/// Largest distance on any axis between the origins of a packet's rays and that of its middle ray, in
/// extents of a leaf. 1 is better by a tenth on scenes of a few thousand spheres, and worse by as much
/// on flat scenes of many.
const MAX_ORIGIN_OFFSET: f32 = 0.75;

/// Largest difference on any axis between the directions of a packet's rays and that of its middle ray,
/// in extents of a leaf over that of the scene. Camera rays of a million spheres break even at about
/// this.
const MAX_DIRECTION_OFFSET: f32 = 0.5;

/// A packet has at least one lane in this many active.
const MIN_ACTIVE: usize = 2;

/// The way in which rays are traced. Hits do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traversal {
    /// Every ray against every sphere.
    Brute,
    /// One ray after another.
    Single,
    /// Rays one by one, many of them in flight.
    Stream,
    /// Packets of rays with equal signs of directions; other rays one by one.
    Packet,
    /// Packets of coherent rays, and incoherent rays one by one with many in flight, or against every
    /// sphere in small scenes.
    Auto,
}

/// Number of rays in a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketWidth {
    /// One: a packet of a single ray.
    One,
    /// Four.
    Four,
    /// Eight.
    Eight,
    /// Sixteen.
    Sixteen,
}

impl PacketWidth {
    /// All widths.
    pub const ALL: [Self; 4] = [Self::One, Self::Four, Self::Eight, Self::Sixteen];
}

/// Traversal and packet width. Hits do not depend on them; the default is the fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracer {
    /// Traversal.
    pub traversal: Traversal,
    /// Rays in a packet.
    pub width: PacketWidth,
}

impl Default for Tracer {
    fn default() -> Self {
        Self { traversal: Traversal::Auto, width: PacketWidth::Sixteen }
    }
}

impl Tracer {
    /// Finds the first hit of each ray. On entry `hits.t` bounds the search, and `hits.sphere` is what
    /// is at that bound, if anything; on return both describe the hit.
    ///
    /// Returns how many decisions were made on integers.
    pub fn closest(self, tree: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        self.trace::<Closest>(tree, rays, hits)
    }

    /// Finds whether each ray hits anything nearer than `hits.t`. On entry `hits.sphere` is
    /// [`MISS`](crate::ray::MISS) for each ray that is to be traced; on return it is `MISS` where
    /// nothing is hit.
    ///
    /// Returns how many decisions were made on integers.
    pub fn occluded(self, tree: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        self.trace::<Any>(tree, rays, hits)
    }

    #[inline(never)]
    fn trace<Q: Query>(self, tree: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        match self.width {
            PacketWidth::One => trace::<f32, Q>(self.traversal, tree, rays, hits),
            PacketWidth::Four => trace::<F32x4, Q>(self.traversal, tree, rays, hits),
            PacketWidth::Eight => trace::<F32x8, Q>(self.traversal, tree, rays, hits),
            PacketWidth::Sixteen => trace::<F32x16, Q>(self.traversal, tree, rays, hits),
        }
    }
}

/// Answers a query for all rays, in packets of `L::WIDTH` rays if any; `hits` holds bounds on entry and
/// answers on return.
///
/// Returns how many decisions were made on integers.
pub fn trace<L: Lanes, Q: Query>(
    traversal: Traversal,
    tree: Tree,
    rays: &Rays,
    hits: &mut Hits,
) -> u64 {
    trace_chunks::<L, Q>(traversal, tree, rays, hits).exact
}

/// Does what [`trace`] does, and returns the visits of the rays.
pub fn count_visits<L: Lanes, Q: Query>(
    traversal: Traversal,
    tree: Tree,
    rays: &Rays,
    hits: &mut Hits,
) -> Visits {
    trace_chunks::<L, Counted<Q>>(traversal, tree, rays, hits).visits
}

/// Traces rays chunk by chunk. Returns the resolver with its counters.
#[inline(always)]
fn trace_chunks<'a, L: Lanes, Q: Query>(
    traversal: Traversal,
    Tree { bvh, spheres }: Tree<'a>,
    rays: &'a Rays,
    hits: &'a mut Hits,
) -> HitResolver<'a, Q> {
    let mut all = HitResolver::<Q>::new(spheres, rays, hits);
    let resolver = &mut all;
    for first in (0..rays.len()).step_by(CHUNK) {
        let rows = first..rays.len().min(first + CHUNK);
        resolver.hits.error[..rows.len()].fill(0.0);
        match traversal {
            Traversal::Brute => trace_brute_force::<L, Q>(resolver, rows, &[u32::MAX; CHUNK]),
            Traversal::Auto if spheres.len() <= BRUTE_FORCE => {
                trace_brute_force::<L, Q>(resolver, rows, &[u32::MAX; CHUNK]);
            }
            Traversal::Single => {
                interleaved::trace::<_, SingleRay, 1>(bvh, resolver, RayStarts::all(rows));
            }
            Traversal::Stream => trace_incoherent(bvh, resolver, RayStarts::all(rows)),
            Traversal::Packet => trace_packets::<L, Q>(bvh, f32::INFINITY, resolver, rows),
            Traversal::Auto if spheres.len() <= SMALL_SCENE => {
                trace_small_scene::<L, Q>(bvh, resolver, rows);
            }
            Traversal::Auto => trace_packets::<L, Q>(bvh, bvh.mean_leaf_extent, resolver, rows),
        }
        let brute_force = traversal == Traversal::Brute || spheres.len() <= SMALL_SCENE;
        trace_unresolved(bvh, resolver, brute_force);
        resolver.round_distances();
    }
    all
}

/// Traces coherent rays through the tree, and tests the others against every sphere.
#[inline(always)]
fn trace_small_scene<L: Lanes, Q: Query>(
    bvh: &Bvh,
    resolver: &mut HitResolver<Q>,
    rows: Range<usize>,
) {
    let rays = resolver.rays;
    let mut incoherent = [0; CHUNK];
    let others = Incoherent::Masks(incoherent.iter_mut());
    let packets = PacketStarts::<L>::new(rays, rows.clone(), bvh.mean_leaf_extent, others);
    interleaved::trace::<_, Packet<L>, PACKETS_IN_FLIGHT>(bvh, resolver, packets);
    trace_brute_force::<L, Q>(resolver, rows, &incoherent);
}

/// Tests rays against every sphere: those whose bit is set in the mask of their packet.
#[inline(always)]
fn trace_brute_force<L: Lanes, Q: Query>(
    resolver: &mut HitResolver<Q>,
    rows: Range<usize>,
    masks: &[u32; CHUNK],
) {
    for (row, mask) in rows.clone().step_by(L::WIDTH).zip(masks) {
        let lanes = lanes_from(row, L::WIDTH, rows.end) & mask;
        if lanes != 0 {
            Packet::<L>::test_all_spheres(resolver, PacketStart { row, lanes });
        }
    }
}

/// Traces coherent rays in packets, and incoherent rays one by one; `extent` is that of a leaf, which
/// tells them apart.
#[inline(always)]
fn trace_packets<L: Lanes, Q: Query>(
    bvh: &Bvh,
    extent: f32,
    resolver: &mut HitResolver<Q>,
    rows: Range<usize>,
) {
    let rays = resolver.rays;
    let mut incoherent = IncoherentRays::in_chunk(rows.start);
    let others = Incoherent::List(&mut incoherent);
    let packets = PacketStarts::<L>::new(rays, rows, extent, others);
    interleaved::trace::<_, Packet<L>, PACKETS_IN_FLIGHT>(bvh, resolver, packets);
    if !incoherent.is_empty() {
        trace_incoherent(bvh, resolver, incoherent.starts());
    }
}

/// Traces rays one by one, many of them in flight.
#[inline(always)]
fn trace_incoherent<Q: Query>(bvh: &Bvh, resolver: &mut HitResolver<Q>, rays: RayStarts) {
    if Q::ANY || !resolver.is_single_precision() {
        interleaved::trace::<_, SingleRay, RAYS_IN_FLIGHT>(bvh, resolver, rays);
    } else {
        interleaved::trace::<_, DeferredRay, RAYS_IN_FLIGHT>(bvh, resolver, rays);
    }
}

/// Traces rays again whose hits are unresolved, and decides each candidate at once: with the tree, or by
/// brute force.
#[inline(always)]
pub(super) fn trace_unresolved<Q: Query>(
    bvh: &Bvh,
    resolver: &mut HitResolver<Q>,
    brute_force: bool,
) {
    let mut unresolved = std::mem::take(&mut resolver.unresolved);
    let rays = RayStarts::Listed { first: 0, places: unresolved.iter(), few: FEW };
    if brute_force {
        rays.for_each(|ray| SingleRay::test_all_spheres(resolver, ray.row));
    } else if unresolved.len() >= RAYS_IN_FLIGHT {
        interleaved::trace::<_, SingleRay, RAYS_IN_FLIGHT>(bvh, resolver, rays);
    } else if !unresolved.is_empty() {
        interleaved::trace::<_, SingleRay, 1>(bvh, resolver, rays);
    }
    // Keeps the allocation.
    unresolved.clear();
    resolver.unresolved = unresolved;
}

/// Returns a bit for each row in `row..row + width` that is less than `end`.
#[inline(always)]
fn lanes_from(row: usize, width: usize, end: usize) -> u32 {
    u32::MAX >> (u32::BITS as usize - width.min(end - row))
}

/// Returns the lanes of the rays from `row` on that are coherent with the one in the middle; 0 if they
/// are too few for a packet.
#[inline(always)]
fn coherent_lanes<L: Lanes>(rays: &Rays, row: usize, leaf_extent: f32) -> u32 {
    let lanes = lanes_from(row, L::WIDTH, rays.len());
    let middle = row + L::WIDTH.min(rays.len() - row) / 2;
    let (origin, direction) = (rays.origin.load::<L>(row), rays.direction.load::<L>(row));
    let (at, toward) = (rays.origin.row(middle), rays.direction.row(middle));
    let close = |x: L, middle: f32, span: f32| (x - L::splat(middle)).abs().le(L::splat(span));
    let same_sign = |x: L, middle: f32| {
        if middle.is_sign_negative() { x.is_negative() } else { !x.is_negative() }
    };
    let (near, spread) = (MAX_ORIGIN_OFFSET * leaf_extent, MAX_DIRECTION_OFFSET * leaf_extent);
    let coherent = close(origin.x, at.x, near)
        & close(origin.y, at.y, near)
        & close(origin.z, at.z, near)
        & close(direction.x, toward.x, spread)
        & close(direction.y, toward.y, spread)
        & close(direction.z, toward.z, spread)
        & same_sign(direction.x, toward.x)
        & same_sign(direction.y, toward.y)
        & same_sign(direction.z, toward.z);
    let bits = coherent.bits() & lanes;
    if (bits.count_ones() as usize) * MIN_ACTIVE < L::WIDTH { 0 } else { bits }
}

/// The numbers of lanes.
const LANES: [u32; MAX_LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Set in the position of a ray that has few others of its packet beside it.
const FEW: u32 = 1 << 31;

/// Rays of a chunk that are traced one by one, in their order.
struct IncoherentRays {
    /// The chunk's first ray.
    first: usize,
    /// Positions in the chunk, and [`FEW`].
    place: [u32; CHUNK],
    count: usize,
}

impl IncoherentRays {
    /// No rays of the chunk that begins at row `first`.
    #[inline(always)]
    fn in_chunk(first: usize) -> Self {
        Self { first, place: [0; CHUNK], count: 0 }
    }

    fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Appends the rays from `row` on whose bits are set.
    #[inline(always)]
    fn push<L: Lanes>(&mut self, row: usize, lanes: u32) {
        if lanes == 0 {
            return;
        }
        let count = lanes.count_ones() as usize;
        let first = (row - self.first) as u32 | if is_few(count) { FEW } else { 0 };
        let places = &mut self.place[self.count..];
        if L::WIDTH == MAX_LANES {
            // Writes whole rows: there is room, for no more rays follow than places are left.
            let numbers = U32x16::splat(first) + U32x16::new(LANES);
            Packing::new(lanes).store_numbers(numbers, places);
        } else {
            set_bits(lanes).zip(places).for_each(|(lane, place)| *place = first + lane as u32);
        }
        self.count += count;
    }

    /// All of the rays.
    fn starts(&self) -> RayStarts<'_> {
        RayStarts::Listed { first: self.first, places: self.place[..self.count].iter(), few: 0 }
    }
}

/// Rays to be traced one by one. A single type, so that the traversal is compiled once.
enum RayStarts<'a> {
    /// All rays of some rows.
    Rows { rows: Range<usize>, few: bool },
    /// Rays at these positions from row `first` on, with [`FEW`]; `few` is added to each.
    Listed { first: usize, places: std::slice::Iter<'a, u32>, few: u32 },
}

impl RayStarts<'_> {
    /// All rays of some rows.
    fn all(rows: Range<usize>) -> Self {
        let few = is_few(rows.len());
        Self::Rows { rows, few }
    }
}

impl Iterator for RayStarts<'_> {
    type Item = RayStart;

    #[inline(always)]
    fn next(&mut self) -> Option<RayStart> {
        match self {
            Self::Rows { rows, few } => rows.next().map(|row| RayStart { row, few: *few }),
            Self::Listed { first, places, few } => places.next().map(|&place| {
                let place = place | *few;
                RayStart { row: *first + (place & !FEW) as usize, few: place & FEW != 0 }
            }),
        }
    }
}

/// Packets of the coherent rays of a chunk. Lists the other rays on the way.
struct PacketStarts<'a, L> {
    rays: &'a Rays,
    /// Rows to be divided into packets.
    rows: Range<usize>,
    /// Extent of a leaf, which tells coherent rays from incoherent ones.
    extent: f32,
    others: Incoherent<'a>,
    width: PhantomData<L>,
}

/// Destination of the incoherent rays of a chunk.
enum Incoherent<'a> {
    /// A mask for each packet.
    Masks(std::slice::IterMut<'a, u32>),
    /// Rows.
    List(&'a mut IncoherentRays),
}

impl<'a, L: Lanes> PacketStarts<'a, L> {
    fn new(rays: &'a Rays, rows: Range<usize>, extent: f32, others: Incoherent<'a>) -> Self {
        Self { rays, rows, extent, others, width: PhantomData }
    }
}

impl<L: Lanes> Iterator for PacketStarts<'_, L> {
    type Item = PacketStart;

    #[inline(always)]
    fn next(&mut self) -> Option<PacketStart> {
        while !self.rows.is_empty() {
            let row = self.rows.start;
            self.rows.start += L::WIDTH;
            let lanes = coherent_lanes::<L>(self.rays, row, self.extent);
            match &mut self.others {
                Incoherent::Masks(masks) => {
                    masks.next().into_iter().for_each(|mask| *mask = !lanes);
                }
                Incoherent::List(list) => {
                    list.push::<L>(row, !lanes & lanes_from(row, L::WIDTH, self.rows.end));
                }
            }
            if lanes != 0 {
                return Some(PacketStart { row, lanes });
            }
        }
        None
    }
}

/// Returns whether rays are set up one by one: setting up a row of lanes takes about as long as
/// eight rays.
fn is_few(count: usize) -> bool {
    2 * count < MAX_LANES
}
