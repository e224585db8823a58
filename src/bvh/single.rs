//! A ray on its own: eight spheres of a leaf are tested at once.

use super::decide::Decider;
use super::ready::Start;
use super::stream::Bundle;
use super::walk::Query;
use crate::filter::{Chord, FilterRay};
use crate::lanes::{F32x8, Lanes, Mask, set_bits};
use crate::ray::MISS;
use crate::slabs::Slabs;
use crate::spheres::{Block, LEAF};
use crate::vec3::Vec3;

/// One ray.
#[derive(Clone, Copy)]
pub(super) struct Single {
    row: u32,
    /// The block of the sphere that the ray starts on, and the lanes of that block but the sphere's.
    own: (u32, u32),
    filter: FilterRay<f32>,
}

impl<Q: Query> Bundle<Q> for Single {
    type Start = Start;

    #[inline(always)]
    fn none() -> Self {
        Self { row: 0, own: (MISS, 0), filter: FilterRay::IDLE }
    }

    #[inline(always)]
    fn begin(&mut self, decider: &mut Decider<Q>, start: Start, slabs: &mut Slabs) -> f32 {
        let (filter, bounds) = decider.begin(start, slabs);
        let row = start.row;
        let own = decider.rays.own[row];
        let own = (own / LEAF as u32, !(1 << (own % LEAF as u32)));
        *self = Self { row: row as u32, own, filter };
        bounds.1
    }

    #[inline(always)]
    fn meets(&mut self, _: &Slabs, t_far: f32, index: usize, block: &Block) -> u32 {
        let center = Vec3::new(F32x8::load(&block.x), F32x8::load(&block.y), F32x8::load(&block.z));
        let chord = Chord::new(&self.filter.splat(), center, F32x8::load(&block.radius));
        let but_own = if self.own.0 == index as u32 { self.own.1 } else { u32::MAX };
        chord.may_hit(F32x8::splat(t_far)).bits() & but_own
    }

    #[inline(always)]
    fn test(&mut self, decider: &mut Decider<Q>, first: usize, spheres: u32) {
        let row = self.row as usize;
        for sphere in set_bits(spheres).map(|lane| first + lane) {
            if Q::ANY && self.is_hit_for_certain(decider, sphere) {
                decider.hits.sphere[row] = sphere as u32;
            } else {
                decider.consider(row, sphere);
            }
        }
    }

    #[inline(always)]
    fn t_far(&self, decider: &Decider<Q>) -> f32 {
        decider.bounds(self.row as usize).1
    }

    #[inline(always)]
    fn settle(&self, _: &mut Decider<Q>) {}
}

impl Single {
    /// Tests every sphere there is, for the ray of a row.
    pub(super) fn brute<Q: Query>(decider: &mut Decider<Q>, row: usize) {
        let (spheres, mut ray) = (decider.spheres, <Self as Bundle<Q>>::none());
        let mut slabs = Slabs::IDLE;
        let mut t_far = ray.begin(decider, Start { row, few: true }, &mut slabs);
        for (index, block) in spheres.blocks().iter().enumerate() {
            let met = <Self as Bundle<Q>>::meets(&mut ray, &slabs, t_far, index, block);
            ray.test(decider, index * LEAF, met);
            t_far = ray.t_far(decider);
        }
    }

    /// Whether single precision can tell that the sphere occludes the ray.
    #[inline(always)]
    fn is_hit_for_certain<Q: Query>(&self, decider: &Decider<Q>, sphere: usize) -> bool {
        let row = self.row as usize;
        // A ray that nothing stops always comes to the light that it is aimed at: first of all that.
        if decider.rays.target[row] == sphere as u32 {
            return false;
        }
        let (center, radius) = (decider.spheres.center(sphere), decider.spheres.radius(sphere));
        let chord = Chord::new(&self.filter, center.into(), radius);
        let margin = self.filter.margin();
        chord.enters(&self.filter, radius, &margin)
            && chord.near_at_most(radius, &margin) < decider.bounds(row).0
    }
}
