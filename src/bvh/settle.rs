//! Whether what rays have found is right: once for each ray, in double precision, in lanes.

use super::best::Best;
use super::decide::{DONE, Decider};
use super::walk::Query;
use crate::filter::FilterRay;
use crate::intersect::{self, CLEAR, Pairs};
use crate::lanes::{
    Doubles, F64x8, Lanes, MAX_LANES, Mask, WideMask, bits, numbers, set_bits, store_where,
};
use crate::spheres::{LEAF, Spheres};
use crate::vec3::Vec3;

/// Spheres in a row.
#[derive(Clone, Copy)]
struct Balls<L> {
    center: Vec3<L>,
    radius: L,
}

impl<L: Lanes> Balls<L> {
    /// Those with these numbers, which are about the same in all lanes; of no size where there is none.
    #[inline(always)]
    fn few(spheres: &Spheres, number: L, there: u32) -> Self {
        let nothing = L::splat(f32::NAN);
        let mut all = Self { center: Vec3::new(nothing, nothing, nothing), radius: nothing };
        let (rows, mut left) = (numbers(number), there);
        while left != 0 {
            let row = rows[left.trailing_zeros() as usize % MAX_LANES];
            let same = number.has_bits_of(bits(row));
            let (block, lane) = (&spheres.blocks()[row as usize / LEAF], row as usize % LEAF);
            let select = |x: f32, rest: L| L::select(same, L::splat(x), rest);
            all = Self {
                center: Vec3::new(
                    select(block.x[lane], all.center.x),
                    select(block.y[lane], all.center.y),
                    select(block.z[lane], all.center.z),
                ),
                radius: select(block.radius[lane], all.radius),
            };
            left &= !same.bits();
        }
        all
    }
}

impl<Q: Query> Decider<'_, Q> {
    /// Leaves what the rays `first..` of a packet have found in the hits.
    #[inline(always)]
    pub(super) fn settle<L: Lanes>(&mut self, first: usize, rays: &FilterRay<L>, best: &Best<L>) {
        let there = best.there();
        if Q::ANY {
            self.keep_spheres(first, there, best.sphere);
            let open =
                best.other.has_bits_of(L::splat(DONE)) & !best.t_max.has_bits_of(L::splat(DONE));
            return self.doubt(first, open.bits());
        }
        let there = there.bits();
        if there == 0 {
            return;
        }
        if !Q::EXACT {
            return self.believe_all(first, best);
        }
        if self.trusted(there) == 0 {
            return self.doubt(first, there);
        }
        let balls = Balls::few(self.spheres, best.sphere, there);
        let mut plain = 0;
        for half in (0..L::WIDTH).step_by(8) {
            let vector =
                |v: Vec3<L>| Vec3::new(v.x.doubles(half), v.y.doubles(half), v.z.doubles(half));
            let pairs = Pairs {
                origin: vector(rays.origin()),
                direction: vector(rays.direction()),
                // As if all were on surfaces: no less.
                origin_error: rays.origin_error().doubles(half),
                center: vector(balls.center),
                radius: balls.radius.doubles(half),
            };
            let (nearest, t) = confirm(&pairs, best.other.doubles(half));
            store_where(nearest, t, &mut self.hits.t[first + half..]);
            plain |= nearest.bits() << half;
        }
        let plain = plain & there;
        self.keep_spheres(first, L::lanes(plain), best.sphere);
        self.doubt(first, there & !plain);
    }

    /// Nothing where rays or spheres are not what their columns hold.
    #[inline(always)]
    fn trusted(&self, lanes: u32) -> u32 {
        if self.rays.precise.is_empty() && self.spheres.precise.is_empty() { lanes } else { 0 }
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

/// The pairs whose hit double precision is sure of, and that nothing else can be nearer than, and the
/// distances.
#[inline(always)]
fn confirm(pairs: &Pairs<F64x8>, other: F64x8) -> (WideMask<F64x8>, F64x8) {
    let (plain, t) = intersect::confirm_either(pairs);
    (plain & (t * F64x8::splat(1.0 + CLEAR)).lt(other), t)
}
