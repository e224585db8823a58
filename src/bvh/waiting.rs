//! Rays that wait until there is a row of them, to be decided in lanes.

use super::best::Best;
use super::decide::Decider;
use super::walk::Query;
use crate::intersect::{self, CLEAR, Pairs};
use crate::lanes::{Doubles, F64x8, Mask, load_doubles};
use crate::ray::{MISS, rounding};
use crate::spheres::LEAF;
use crate::vec3::Vec3;

/// Rays in a row.
const ROW: usize = 8;

/// Rays and what they may hit.
#[derive(Clone, Copy, Default)]
pub(super) struct Waiting {
    count: usize,
    ray: [Ray; ROW],
    /// Distances before which nothing else is hit.
    others: [f32; ROW],
}

/// A ray's row, and its sphere's.
#[derive(Clone, Copy, Default)]
struct Ray {
    row: u32,
    sphere: u32,
}

impl<Q: Query> Decider<'_, Q> {
    /// Has a ray wait, if it may hit anything.
    #[inline(always)]
    pub(super) fn wait(&mut self, row: u32, best: &Best<f32>, others: f32) {
        let sphere = best.sphere.to_bits();
        if !Q::EXACT {
            if sphere != MISS {
                self.hits.set(row as usize, f64::from(best.near), sphere);
            }
            return;
        }
        let waiting = &mut self.waiting;
        let place = waiting.count % ROW;
        waiting.ray[place] = Ray { row, sphere };
        // Nothing beyond `t_max` was looked at.
        waiting.others[place] = others.min(best.t_max);
        waiting.count = place + usize::from(sphere != MISS);
        if waiting.count == ROW {
            self.settle_waiting();
        }
    }

    /// Leaves what the rays that wait have found in the hits.
    #[inline(never)]
    pub(super) fn settle_waiting(&mut self) {
        let count = std::mem::take(&mut self.waiting.count);
        if count == 0 {
            return;
        }
        let Waiting { mut ray, others, .. } = self.waiting;
        // What is left of a row is as the first of it.
        let first = ray[0];
        ray[count..].fill(first);
        let (plain, t) = intersect::confirm_either(&self.pairs(&ray));
        let nearest = plain & (t * F64x8::splat(1.0 + CLEAR)).lt(load_doubles(&others));
        let (nearest, t) = (nearest.bits(), t.to_array());
        for (lane, (ray, t)) in ray.into_iter().zip(t).enumerate().take(count) {
            if nearest >> lane & 1 == 1 {
                self.hits.set(ray.row as usize, t, ray.sphere);
            } else {
                self.doubtful.push(ray.row);
            }
        }
    }

    /// The rays and their spheres, in lanes.
    #[inline(always)]
    fn pairs(&self, rays: &[Ray; ROW]) -> Pairs<F64x8> {
        let mut columns = [[0.0; ROW]; 10];
        for (lane, ray) in rays.iter().enumerate() {
            let (row, sphere) = (ray.row as usize, ray.sphere as usize);
            let (origin, direction) = (self.rays.origin.row(row), self.rays.direction.row(row));
            let (block, place) = (&self.spheres.blocks()[sphere / LEAF], sphere % LEAF);
            let ball = [block.x[place], block.y[place], block.z[place], block.radius[place]];
            let ray = origin.to_array().into_iter().chain(direction.to_array());
            for (column, x) in columns.iter_mut().zip(ray.chain(ball)) {
                column[lane] = x;
            }
        }
        let row = |i: usize| load_doubles(&columns[i]);
        let vector = |i: usize| Vec3::new(row(i), row(i + 1), row(i + 2));
        let (origin, direction, center, radius) = (vector(0), vector(3), vector(6), row(9));
        // As if all were on surfaces: no less.
        Pairs { origin, direction, origin_error: rounding(origin), center, radius }
    }
}
