//! Whether what rays have found is right: once for each ray, in double precision, in lanes.

use super::best::{Best, Rival};
use super::decide::{DONE, Decider};
use super::walk::Query;
use crate::filter::FilterRay;
use crate::intersect::{self, CLEAR, Pairs};
use crate::lanes::{Doubles, F64x8, Lanes, Mask, set_bits, store_where};
use crate::vec3::Vec3;

impl<Q: Query> Decider<'_, Q> {
    /// Leaves what the rays `first..` of a packet have found in the hits.
    #[inline(always)]
    pub(super) fn settle<L: Lanes>(
        &mut self,
        first: usize,
        rays: &FilterRay<L>,
        (best, rival): (&Best<L>, &Rival<L>),
    ) {
        let there = best.there();
        if Q::ANY {
            self.keep_spheres(first, there, best.sphere);
            let open =
                best.near.has_bits_of(L::splat(DONE)) & !best.t_max.has_bits_of(L::splat(DONE));
            return self.doubt(first, open.bits());
        }
        let there = there.bits();
        if there == 0 {
            return;
        }
        if !Q::EXACT {
            return self.believe_all(first, best);
        }
        if !self.is_plain() {
            return self.doubt(first, there);
        }
        let low = self.settle_half::<L, 0>(first, rays, (best, rival));
        // Written out, so that lanes stay in registers and the halves do not wait for each other.
        let high =
            if L::WIDTH > 8 { self.settle_half::<L, 8>(first, rays, (best, rival)) } else { 0 };
        let plain = (low | high << 8) & there;
        self.keep_spheres(first, L::lanes(plain), best.sphere);
        self.doubt(first, there & !plain);
    }

    /// Leaves the distances of eight lanes, from `FROM` on, in the hits where double precision is sure
    /// of them: a bit for each.
    #[inline(always)]
    fn settle_half<L: Lanes, const FROM: usize>(
        &mut self,
        first: usize,
        rays: &FilterRay<L>,
        (best, rival): (&Best<L>, &Rival<L>),
    ) -> u32 {
        let vector =
            |v: Vec3<L>| Vec3::new(v.x.doubles(FROM), v.y.doubles(FROM), v.z.doubles(FROM));
        let pairs = Pairs {
            origin: vector(rays.origin()),
            direction: vector(rays.direction()),
            // As if all were on surfaces: no less.
            origin_error: rays.origin_error().doubles(FROM),
            center: vector(rival.ball.center),
            radius: rival.ball.radius.doubles(FROM),
        };
        let (plain, t) = intersect::confirm_either(&pairs);
        // Nothing beyond `t_max` was looked at.
        let other = rival.near.min(best.t_max).doubles(FROM);
        let nearest = plain & (t * F64x8::splat(1.0 + CLEAR)).lt(other);
        store_where(nearest, t, &mut self.hits.t[first + FROM..]);
        nearest.bits()
    }

    /// Whether rays and spheres are what their columns hold.
    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.rays.precise.is_empty() && self.spheres.precise.is_empty()
    }

    /// Has rays looked at anew.
    #[inline(always)]
    fn doubt(&mut self, first: usize, lanes: u32) {
        for lane in set_bits(lanes) {
            self.doubtful.push((first + lane) as u32);
        }
    }

    #[inline(always)]
    fn keep_spheres<L: Lanes>(&mut self, first: usize, mask: L::Mask, sphere: L) {
        let column = bytemuck::cast_slice_mut(&mut self.hits.sphere[first..]);
        L::select(mask, sphere, L::load(column)).store(column);
    }

    /// Takes the filter's word.
    #[inline(always)]
    fn believe_all<L: Lanes>(&mut self, first: usize, best: &Best<L>) {
        let there = best.there();
        self.keep_spheres(first, there, best.sphere);
        for half in (0..L::WIDTH).step_by(8) {
            let near = best.near.doubles(half);
            let nearer = F64x8::splat(0.0).lt(near) & near.lt(F64x8::splat(f64::INFINITY));
            store_where(nearer, near, &mut self.hits.t[first + half..]);
        }
    }
}
