//! Rays that go alike walk through the tree together.
//!
//! A packet of `L::WIDTH` rays is bounded on each axis, and the bounds are tested against the boxes of
//! eight children at once; so are the boxes of a leaf's spheres, and each that is left is tested
//! against all rays at once. `L = f32` is a single ray.
//!
//! What is hit is decided in the end, for all rays at once: see [`Best`].

use super::best::{Ball, Best, Candidate, Rival};
use super::decide::{DONE, Decider};
use super::stream::Bundle;
use super::walk::Query;
use crate::filter::{Chord, FilterRay, Margin};
use crate::lanes::{F32x8, Lanes, bits, bits_of, greatest_of, set_bits};
use crate::ray::{Columns3, MISS, Rays};
use crate::slabs::{MARGIN, Planes, Slabs};
use crate::spheres::{Block, LEAF, Spheres};
use crate::vec3::Vec3;

/// Some of the rays `row..row + L::WIDTH`.
#[derive(Clone, Copy)]
pub(super) struct Packet<L: Lanes> {
    row: u32,
    filter: FilterRay<L>,
    /// As if all rays started on surfaces.
    margin: Margin<L>,
    /// The bits of the spheres that the rays start on, and of those that they are aimed at.
    known: [L; 2],
    best: Best<L>,
    rival: Rival<L>,
}

impl<Q: Query, L: Lanes> Bundle<Q> for Packet<L> {
    /// The first row, and a bit for each lane that belongs to the packet.
    type Start = (usize, u32);

    #[inline(always)]
    fn none() -> Self {
        Self {
            row: 0,
            filter: FilterRay::IDLE.splat(),
            margin: FilterRay::IDLE.splat().margin(),
            known: [bits(MISS); 2],
            best: Best::of_search::<Q>((L::splat(DONE), L::splat(DONE))),
            rival: Rival { ball: Ball::splat([0.0; 4]), near: L::splat(DONE) },
        }
    }

    #[inline(always)]
    fn begin(
        &mut self,
        decider: &mut Decider<Q>,
        (row, lanes): (usize, u32),
        slabs: &mut Slabs,
    ) -> f32 {
        self.take_rays(decider, (row, lanes));
        *slabs = bounds::<L>(decider.rays, row, lanes);
        self.best.t_max.greatest()
    }

    #[inline(always)]
    fn meets(&mut self, slabs: &Slabs, t_far: f32, _: usize, block: &Block) -> u32 {
        slabs.enters(&boxes(block), t_far).0
    }

    #[inline(always)]
    fn test(&mut self, decider: &mut Decider<Q>, first: usize, spheres: u32) {
        // In registers: what is stored under a mask takes long to be loaded again.
        let (mut best, mut rival) = (self.best, self.rival);
        for lane in set_bits(spheres) {
            self.meet::<Q>(decider.spheres, first + lane, (&mut best, &mut rival));
        }
        self.best = best;
        if Q::EXACT && !Q::ANY {
            self.rival = rival;
        }
    }

    #[inline(always)]
    fn t_far(&self, _: &Decider<Q>) -> f32 {
        self.best.t_max.greatest()
    }

    #[inline(always)]
    fn settle(&self, decider: &mut Decider<Q>) {
        decider.settle(self.row as usize, &self.filter, (&self.best, &self.rival));
    }
}

impl<L: Lanes> Packet<L> {
    #[inline(always)]
    fn take_rays<Q: Query>(&mut self, decider: &Decider<Q>, (row, lanes): (usize, u32)) {
        let rays = decider.rays;
        let origin: Vec3<L> = rays.origin.load(row);
        let filter = FilterRay::new(origin, rays.direction.load(row));
        self.row = row as u32;
        self.filter = filter;
        self.margin = filter.margin();
        self.known = [bits_of(&rays.own[row..]), bits_of(&rays.target[row..])];
        let bounds = decider.start(row, L::lanes(lanes));
        self.best = Best::of_search::<Q>(bounds);
        self.rival.near = bounds.0;
    }

    /// Tests every sphere there is, for some of the rays from a row on.
    #[inline(always)]
    pub(super) fn brute<Q: Query>(decider: &mut Decider<Q>, rows: (usize, u32)) {
        let mut packet = <Self as Bundle<Q>>::none();
        packet.take_rays(decider, rows);
        let (mut best, mut rival) = (packet.best, packet.rival);
        for sphere in 0..decider.spheres.len() {
            packet.meet::<Q>(decider.spheres, sphere, (&mut best, &mut rival));
        }
        decider.settle(rows.0, &packet.filter, (&best, &rival));
    }

    /// What the rays know once they have met another sphere.
    #[inline(always)]
    fn meet<Q: Query>(
        &self,
        spheres: &Spheres,
        sphere: usize,
        (best, rival): (&mut Best<L>, &mut Rival<L>),
    ) {
        let (block, lane) = (&spheres.blocks()[sphere / LEAF], sphere % LEAF);
        let ball = Ball::splat([block.x[lane], block.y[lane], block.z[lane], block.radius[lane]]);
        let number = bits(sphere as u32);
        let [own, target] = self.known.map(|known| known.has_bits_of(number));
        let chord = Chord::new(&self.filter, ball.center, ball.radius);
        let met = Candidate { number, allowed: !(own | target), ball, chord };
        best.meet::<Q>(rival, (&self.filter, &self.margin), &met);
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
