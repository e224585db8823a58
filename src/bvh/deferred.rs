//! A ray on its own, of which is decided in the end, with seven others: for the nearest hit.
//!
//! What it meets is known from eight spheres at once, in single precision, and kept as packets keep it:
//! see [`Best`]. Rays that may have a hit wait until there is a row of them.

use super::best::{Ball, Best, Candidate, Rival, likely};
use super::decide::{DONE, Decider};
use super::ready::Start;
use super::stream::Bundle;
use super::walk::Query;
use crate::filter::{Chord, FilterRay};
use crate::lanes::{F32x8, Lanes, Mask, bits, set_bits};
use crate::ray::MISS;
use crate::slabs::Slabs;
use crate::spheres::{Block, LEAF};
use crate::vec3::Vec3;

/// One ray.
#[derive(Clone, Copy)]
pub(super) struct Deferred {
    row: u32,
    /// The block of the sphere that the ray starts on, and the lanes of that block but the sphere's.
    own: (u32, u32),
    filter: FilterRay<f32>,
    best: Best<f32>,
    /// A distance before which no other is hit, nor the search ends.
    others: f32,
    /// Distances before which the spheres of the last block are not hit.
    near: [f32; LEAF],
}

impl<Q: Query> Bundle<Q> for Deferred {
    type Start = Start;

    #[inline(always)]
    fn none() -> Self {
        Self {
            row: 0,
            own: (MISS, 0),
            filter: FilterRay::IDLE,
            best: Best::of_search::<Q>((DONE, DONE)),
            others: DONE,
            near: [0.0; LEAF],
        }
    }

    #[inline(always)]
    fn begin(&mut self, decider: &mut Decider<Q>, start: Start, slabs: &mut Slabs) -> f32 {
        let (filter, bounds) = decider.begin(start, slabs);
        let row = start.row;
        let own = decider.rays.own[row];
        self.row = row as u32;
        self.own = (own / LEAF as u32, !(1 << (own % LEAF as u32)));
        self.filter = filter;
        self.best = Best::of_search::<Q>(bounds);
        self.others = bounds.0;
        bounds.1
    }

    #[inline(always)]
    fn meets(&mut self, _: &Slabs, t_far: f32, index: usize, block: &Block) -> u32 {
        let center = Vec3::new(F32x8::load(&block.x), F32x8::load(&block.y), F32x8::load(&block.z));
        let chord = Chord::new(&self.filter.splat(), center, F32x8::load(&block.radius));
        chord.near().store(&mut self.near);
        let but_own = if self.own.0 == index as u32 { self.own.1 } else { u32::MAX };
        chord.may_hit(F32x8::splat(t_far)).bits() & but_own
    }

    #[inline(always)]
    fn test(&mut self, decider: &mut Decider<Q>, first: usize, spheres: u32) {
        let target = decider.rays.target[self.row as usize];
        for lane in set_bits(spheres) {
            let (sphere, near) = (first + lane, self.near[lane]);
            let (number, counts) = (bits(sphere as u32), near <= self.best.t_max);
            if !Q::EXACT {
                self.best.believe::<Q>(counts && near >= 0.0, near, number);
            } else if near < 0.0 || target == sphere as u32 {
                self.meet_closely(decider, sphere);
            } else {
                let far = likely(near, decider.spheres.radius(sphere));
                self.best.keep(&mut self.others, counts, [near, far], number);
            }
        }
    }

    #[inline(always)]
    fn t_far(&self, _: &Decider<Q>) -> f32 {
        self.best.t_max
    }

    #[inline(always)]
    fn settle(&self, decider: &mut Decider<Q>) {
        decider.wait(self.row, &self.best, self.others);
    }

    #[inline(always)]
    fn finish(decider: &mut Decider<Q>) {
        decider.settle_waiting();
    }
}

impl Deferred {
    /// Meets a sphere that the ray may start in, or that it is aimed at.
    #[inline(never)]
    fn meet_closely<Q: Query>(&mut self, decider: &Decider<Q>, sphere: usize) {
        let (center, radius) = (decider.spheres.center(sphere), decider.spheres.radius(sphere));
        let ball = Ball::splat([center.x, center.y, center.z, radius]);
        let chord = Chord::new(&self.filter, ball.center, radius);
        let allowed = decider.rays.target[self.row as usize] != sphere as u32;
        let met = Candidate { number: bits(sphere as u32), allowed, ball, chord };
        let mut rival = Rival { ball, near: self.others };
        self.best.meet::<Q>(&mut rival, (&self.filter, &self.filter.margin()), &met);
        self.others = rival.near;
    }
}
