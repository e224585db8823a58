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
    /// The bits of the spheres that the rays start on, and of those that they are aimed at.
    known: [L; 2],
    /// Bounds of the distance of what is hit so far, or of the search; [`DONE`] for a lane without a
    /// ray, or done.
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
            known: [bits(MISS); 2],
            t_min: L::splat(DONE),
            t_max: L::splat(DONE),
            certain: Certain::none(),
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
        self.t_max.greatest()
    }

    #[inline(always)]
    fn meets(&self, slabs: &Slabs, t_far: f32, _: usize, block: &Block) -> u32 {
        slabs.enters(&boxes(block), t_far).0
    }

    #[inline(always)]
    fn test(&mut self, decider: &mut Decider<Q>, sphere: usize) {
        let (chord, center, radius) = self.chord(decider.spheres, sphere);
        let met = chord.may_hit(self.t_max);
        let number = bits(sphere as u32);
        let [own, target] = self.known.map(|known| known.has_bits_of(number));
        let candidate = Certain { sphere: number, center, radius };
        self.take(decider, &candidate, (met & !(own | target), &chord));
    }

    #[inline(always)]
    fn t_far(&self, _: &Decider<Q>) -> f32 {
        self.t_max.greatest()
    }

    /// Computes the distances of what is hit for certain.
    #[inline(always)]
    fn settle(&self, decider: &mut Decider<Q>) {
        let row = self.row as usize;
        if Q::EXACT {
            decider.settle(row, &self.filter, &self.certain);
        } else {
            decider.believe_all(row, &self.certain, self.t_min);
        }
    }
}

impl<L: Lanes> Packet<L> {
    #[inline(always)]
    fn take_rays<Q: Query>(&mut self, decider: &Decider<Q>, (row, lanes): (usize, u32)) {
        let rays = decider.rays;
        let origin: Vec3<L> = rays.origin.load(row);
        let (t_min, t_max) = decider.start(row, L::lanes(lanes));
        *self = Self {
            row: row as u32,
            filter: FilterRay::new(origin, rays.direction.load(row)),
            known: [bits_of(&rays.own[row..]), bits_of(&rays.target[row..])],
            t_min,
            t_max,
            certain: Certain::none(),
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
            if packet.chord(decider.spheres, sphere).0.may_hit(packet.t_max).bits() != 0 {
                packet.test(decider, sphere);
            }
        }
        packet.settle(decider);
    }

    /// Takes the lanes whose hit is certain and nearer than what they have, asks about the others.
    #[inline(always)]
    fn take<Q: Query>(
        &mut self,
        decider: &mut Decider<Q>,
        candidate: &Certain<L>,
        (met, chord): (L::Mask, &Chord<L>),
    ) {
        let near = chord.near();
        let origin_error = self.filter.origin_error();
        let (certain, far) = chord.enters(&self.filter, candidate.radius, origin_error);
        let nearer = if Q::EXACT { met & certain & far.lt(self.t_min) } else { met };
        self.certain = Certain::select(nearer, candidate, &self.certain);
        if Q::ANY {
            self.t_max = L::select(nearer, L::splat(DONE), self.t_max);
        } else {
            self.t_min = L::select(nearer, near, self.t_min);
            self.t_max = L::select(nearer, far, self.t_max);
        }
        let open = met & !nearer;
        if open.bits() != 0 {
            self.ask(decider, candidate.sphere, open.bits());
        }
    }

    /// Has the lanes in `open` decided.
    #[cold]
    fn ask<Q: Query>(&mut self, decider: &mut Decider<Q>, sphere: L, open: u32) {
        let (sphere, mut certain) = (numbers(sphere)[0], numbers(self.certain.sphere));
        let (mut t_min, mut t_max) = ([DONE; MAX_LANES], [DONE; MAX_LANES]);
        self.t_min.store(&mut t_min);
        self.t_max.store(&mut t_max);
        for lane in set_bits(open) {
            let row = self.row as usize + lane;
            if certain[lane] != MISS {
                decider.consider(row, certain[lane] as usize);
                certain[lane] = MISS;
            }
            decider.consider(row, sphere as usize);
            (t_min[lane], t_max[lane]) = decider.bounds(row);
        }
        self.certain.sphere = bits_of(&certain);
        (self.t_min, self.t_max) = (L::load(&t_min), L::load(&t_max));
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
