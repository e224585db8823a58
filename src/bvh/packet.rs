//! Rays that go alike walk through the tree together.
//!
//! A packet of `L::WIDTH` rays is bounded on each axis, and the bounds are tested against the boxes of
//! eight children at once; so are the boxes of a leaf's spheres, and each that is left is tested
//! against all rays at once. `L = f32` is a single ray.
//!
//! Where the bounds of single precision tell which of two hits is nearer, nothing else is asked; the
//! nearest one's distance is computed in the end. Where they overlap, or cannot tell a hit from a miss,
//! [`Decider`] is asked at once.

use super::certain::Certain;
use super::decide::{DONE, Decider};
use super::stream::Bundle;
use super::walk::Query;
use crate::filter::{Chord, FilterRay};
use crate::lanes::{F32x8, Lanes, MAX_LANES, Mask, bits, bits_of, greatest_of, numbers, set_bits};
use crate::ray::{Columns3, MISS, Rays};
use crate::slabs::{MARGIN, Planes, Slabs};
use crate::spheres::{Block, LEAF, Spheres};
use crate::vec3::Vec3;

/// Some of the rays `row..row + L::WIDTH`.
#[derive(Clone, Copy)]
pub(super) struct Packet<L: Lanes> {
    row: u32,
    filter: FilterRay<L>,
    /// Of the rays' origins, as if all were on surfaces.
    origin_error: L,
    /// The bits of the spheres that the rays start on, and of those that they are aimed at.
    known: [L; 2],
    best: Best<L>,
}

/// What rays have hit so far.
#[derive(Clone, Copy)]
struct Best<L: Lanes> {
    /// Bounds of the distance of what is hit, or of the search; [`DONE`] for a lane without a ray, or
    /// done.
    t_min: L,
    t_max: L,
    /// What is hit for certain, if the hits do not know of it yet.
    certain: Certain<L>,
}

impl<Q: Query, L: Lanes> Bundle<Q> for Packet<L> {
    /// The first row, and a bit for each lane that belongs to the packet.
    type Start = (usize, u32);

    #[inline(always)]
    fn none() -> Self {
        Self {
            row: 0,
            filter: FilterRay::IDLE.splat(),
            origin_error: L::splat(0.0),
            known: [bits(MISS); 2],
            best: Best::of_search((L::splat(DONE), L::splat(DONE))),
        }
    }

    #[inline(always)]
    fn begin(
        &mut self,
        decider: &Decider<Q>,
        (row, lanes): (usize, u32),
        slabs: &mut Slabs,
    ) -> f32 {
        self.take_rays(decider, (row, lanes));
        *slabs = bounds::<L>(decider.rays, row, lanes);
        self.best.t_max.greatest()
    }

    #[inline(always)]
    fn meets(&self, slabs: &Slabs, t_far: f32, _: usize, block: &Block) -> u32 {
        slabs.enters(&boxes(block), t_far).0
    }

    #[inline(always)]
    fn test(&mut self, decider: &mut Decider<Q>, first: usize, spheres: u32) {
        // In registers: what is stored under a mask takes long to be loaded again.
        let mut best = self.best;
        for lane in set_bits(spheres) {
            best = self.better(decider, first + lane, best);
        }
        self.best = best;
    }

    #[inline(always)]
    fn t_far(&self, _: &Decider<Q>) -> f32 {
        self.best.t_max.greatest()
    }

    /// Computes the distances of what is hit for certain.
    #[inline(always)]
    fn settle(&self, decider: &mut Decider<Q>) {
        let row = self.row as usize;
        if Q::EXACT {
            decider.settle(row, &self.filter, &self.best.certain);
        } else {
            decider.believe_all(row, &self.best.certain, self.best.t_min);
        }
    }
}

impl<L: Lanes> Packet<L> {
    #[inline(always)]
    fn take_rays<Q: Query>(&mut self, decider: &Decider<Q>, (row, lanes): (usize, u32)) {
        let rays = decider.rays;
        let origin: Vec3<L> = rays.origin.load(row);
        let filter = FilterRay::new(origin, rays.direction.load(row));
        *self = Self {
            row: row as u32,
            filter,
            origin_error: filter.origin_error(),
            known: [bits_of(&rays.own[row..]), bits_of(&rays.target[row..])],
            best: Best::of_search(decider.start(row, L::lanes(lanes))),
        };
    }

    /// What the rays cut out of a sphere, and its center and radius.
    #[inline(always)]
    fn chord(&self, spheres: &Spheres, sphere: usize) -> (Chord<L>, Vec3<L>, L) {
        let (block, lane) = (&spheres.blocks()[sphere / LEAF], sphere % LEAF);
        let center = Vec3::splat(block.x[lane], block.y[lane], block.z[lane]);
        let radius = L::splat(block.radius[lane]);
        (Chord::new(&self.filter, center, radius), center, radius)
    }

    /// Tests every sphere there is, for some of the rays from a row on.
    #[inline(always)]
    pub(super) fn brute<Q: Query>(decider: &mut Decider<Q>, rows: (usize, u32)) {
        let mut packet = <Self as Bundle<Q>>::none();
        packet.take_rays(decider, rows);
        for sphere in 0..decider.spheres.len() {
            if packet.chord(decider.spheres, sphere).0.may_hit(packet.best.t_max).bits() != 0 {
                packet.test(decider, sphere, 1);
            }
        }
        packet.settle(decider);
    }

    /// What the rays have hit once they have met another sphere: the lanes whose hit is certain and
    /// nearer than what they have take it, and others that may hit it are asked about.
    #[inline(always)]
    fn better<Q: Query>(
        &self,
        decider: &mut Decider<Q>,
        sphere: usize,
        mut best: Best<L>,
    ) -> Best<L> {
        let (chord, center, radius) = self.chord(decider.spheres, sphere);
        let number = bits(sphere as u32);
        let [own, target] = self.known.map(|known| known.has_bits_of(number));
        let met = chord.may_hit(best.t_max) & !(own | target);
        let (certain, far) = chord.enters(&self.filter, radius, self.origin_error);
        let nearer = if Q::EXACT { met & certain & far.lt(best.t_min) } else { met };
        best.certain =
            Certain::select(nearer, &Certain { sphere: number, center, radius }, &best.certain);
        if Q::ANY {
            best.t_max = L::select(nearer, L::splat(DONE), best.t_max);
        } else {
            best.t_min = L::select(nearer, chord.near(), best.t_min);
            best.t_max = L::select(nearer, far, best.t_max);
        }
        let open = (met & !nearer).bits();
        if open != 0 {
            let asked = self.ask(decider, sphere, open, &{ best });
            best = asked;
        }
        best
    }

    /// Has the lanes in `open` decided.
    #[cold]
    fn ask<Q: Query>(
        &self,
        decider: &mut Decider<Q>,
        sphere: usize,
        open: u32,
        best: &Best<L>,
    ) -> Best<L> {
        let mut certain = numbers(best.certain.sphere);
        let (mut t_min, mut t_max) = ([DONE; MAX_LANES], [DONE; MAX_LANES]);
        best.t_min.store(&mut t_min);
        best.t_max.store(&mut t_max);
        for lane in set_bits(open) {
            let row = self.row as usize + lane;
            if certain[lane] != MISS {
                decider.consider(row, certain[lane] as usize);
                certain[lane] = MISS;
            }
            decider.consider(row, sphere);
            (t_min[lane], t_max[lane]) = decider.bounds(row);
        }
        let certain = Certain { sphere: bits_of(&certain), ..best.certain };
        Best { t_min: L::load(&t_min), t_max: L::load(&t_max), certain }
    }
}

impl<L: Lanes> Best<L> {
    /// Nothing yet, between bounds of the distance at which the search ends.
    #[inline(always)]
    fn of_search((t_min, t_max): (L, L)) -> Self {
        Self { t_min, t_max, certain: Certain::none() }
    }
}

/// What bounds the rays of a packet.
#[inline(always)]
fn bounds<L: Lanes>(rays: &Rays, row: usize, lanes: u32) -> Slabs {
    let first = row + lanes.trailing_zeros() as usize;
    let members = L::lanes(lanes);
    let bounds = |v: &Columns3| {
        // A lane that does not belong to the packet counts as the first that does.
        let column = |x: &[f32]| L::select(members, L::load(&x[row..]), L::splat(x[first]));
        let v = [column(&v.x), column(&v.y), column(&v.z)];
        [-greatest_of(v.map(|x| -x)), greatest_of(v)]
    };
    Slabs::between(bounds(&rays.origin), bounds(&rays.direction))
}

/// Boxes about the spheres of a block, as those of the tree are about theirs.
#[inline(always)]
pub(super) fn boxes(block: &Block) -> Planes {
    let widen = F32x8::splat(1.0 + 2.0 * f32::EPSILON);
    let radius = Lanes::mul_add(F32x8::load(&block.radius), widen, F32x8::splat(MARGIN));
    let slab = |center: &[f32; LEAF]| {
        let center = F32x8::load(center);
        let reach = Lanes::mul_add(Lanes::abs(center), F32x8::splat(f32::EPSILON), radius);
        [(center - reach).to_array(), (center + reach).to_array()]
    };
    [slab(&block.x), slab(&block.y), slab(&block.z)]
}
