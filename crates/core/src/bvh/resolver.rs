//! Decides which candidates of the conservative test are hits, and which hit is the nearest.
//!
//! Single rays that look for any hit decide candidate by candidate ([`Decision`]).
//! Other rays keep their best candidate until they have passed the tree
//! ([`NearestHit`](super::nearest::NearestHit)), and then up to eight of them are decided in lanes: a
//! packet's at once ([`HitResolver::commit_packet`]), those of single rays as soon as eight are pending
//! ([`HitResolver::push_pending`]). Rays that can't be decided so are traced again, with each candidate
//! decided at once.

use super::decision::{Decision, Nearest};
use super::nearest::{NearestHit, RunnerUp};
use super::query::{Query, Visits};
use super::ray_setup::RaySetup;
use crate::conservative::{Chord, ConservativeRay};
use crate::exact;
use crate::intersect::{self, CLEAR, Pair, Pairs};
use crate::lanes::{
    Doubles, F64x8, Lanes, Mask, bits, bits_of, load_doubles, set_bits, store_where,
};
use crate::ray::{CHUNK, Hits, MISS, Rays};
use crate::spheres::Spheres;
use crate::vec3::Vec3;
use std::marker::PhantomData;

/// The bound of a ray that needs no more answers.
pub(super) const DONE: f32 = f32::NEG_INFINITY;

/// Rays that are decided together in lanes.
const LANES: usize = 8;

/// The state of a traversal's answers: rays, spheres, and the hits so far.
pub(super) struct HitResolver<'a, Q> {
    pub(super) spheres: &'a Spheres,
    pub(super) rays: &'a Rays,
    pub(super) hits: &'a mut Hits,
    /// Number of decisions that were made on integers.
    pub(super) exact: u64,
    /// Rays that are to be traced again, for their hits may be wrong.
    pub(super) unresolved: Vec<u32>,
    /// Rays whose distances are still to be rounded, if they are to be.
    unrounded: Vec<u32>,
    /// True if all origins and centers are [coarse](Vec3::is_coarse), and distances are to be rounded.
    coarse: bool,
    /// Rays that wait until there are enough of them to be decided in lanes.
    pending: PendingHits,
    /// The rays that start next.
    pub(super) setup: RaySetup,
    /// Visits, if they are counted.
    pub(super) visits: Visits,
    query: PhantomData<Q>,
}

impl<'a, Q: Query> HitResolver<'a, Q> {
    pub(super) fn new(spheres: &'a Spheres, rays: &'a Rays, hits: &'a mut Hits) -> Self {
        Self {
            spheres,
            rays,
            hits,
            exact: 0,
            unresolved: Vec::new(),
            unrounded: Vec::new(),
            coarse: Q::ROUNDED && spheres.coarse && rays.coarse,
            pending: PendingHits::default(),
            setup: RaySetup::NONE,
            visits: Visits::default(),
            query: PhantomData,
        }
    }

    /// Returns whether the single-precision columns hold rays and spheres exactly.
    #[inline(always)]
    pub(super) fn is_single_precision(&self) -> bool {
        self.rays.precise.is_empty() && self.spheres.precise.is_empty()
    }

    /// Returns bounds of the distance at which a ray's search ends; [`DONE`] if it needs no answer.
    #[inline(always)]
    pub(super) fn bounds(&self, row: usize) -> (f32, f32) {
        if Q::ANY && self.hits.sphere[row] != MISS {
            return (DONE, DONE);
        }
        let (t, error) = (self.hits.t[row], self.hits.error[row % CHUNK]);
        Nearest { t, error, sphere: MISS }.bounds()
    }

    /// Returns what [`HitResolver::bounds`] does, for the rays from `row` on, which have no hits yet;
    /// [`DONE`] in lanes that are not `active`.
    #[inline(always)]
    pub(super) fn search_bounds<L: Lanes>(&self, row: usize, active: L::Mask) -> (L, L) {
        let (low, high) = rounded_out(L::load_rounded(&self.hits.t[row..]));
        let searched = if Q::ANY {
            active & bits_of::<L>(&self.hits.sphere[row..]).has_bits_of(bits(MISS))
        } else {
            active
        };
        let done = L::splat(DONE);
        (L::select(searched, low, done), L::select(searched, high, done))
    }
}

/// Returns bounds of a number that was rounded to `t`, at any magnitude.
#[inline(always)]
pub(super) fn rounded_out<L: Lanes>(t: L) -> (L, L) {
    let scaled = |factor, least| t.mul_add(L::splat(factor), L::splat(least));
    (scaled(1.0 - f32::EPSILON, -f32::MIN_POSITIVE), scaled(1.0 + f32::EPSILON, f32::MIN_POSITIVE))
}

/// Candidate by candidate.
impl<Q: Query> HitResolver<'_, Q> {
    /// Tests a ray against a sphere, and stores the hit if there is one that is nearer than the ray's
    /// hit so far. Returns whether it is.
    #[inline(always)]
    pub(super) fn test_sphere(&mut self, row: usize, sphere: usize) -> bool {
        if !Q::EXACT {
            return self.accept_unverified(row, sphere);
        }
        let error = self.hits.error[row % CHUNK];
        let mut decision = Decision::<Q> {
            spheres: self.spheres,
            ray: self.rays.exact(row),
            own: self.rays.own[row],
            target: self.rays.target[row],
            nearest: Nearest { t: self.hits.t[row], error, sphere: self.hits.sphere[row] },
            exact: 0,
            query: PhantomData,
        };
        let nearer = decision.test_sphere(sphere);
        self.exact += decision.exact;
        if nearer {
            let Nearest { t, error, sphere } = decision.nearest;
            self.hits.sphere[row] = sphere;
            if !Q::ANY {
                (self.hits.t[row], self.hits.error[row % CHUNK]) = (t, error);
            }
            if Q::ROUNDED {
                self.unrounded.push(row as u32);
            }
        }
        nearer
    }

    /// Accepts a candidate of the conservative test as a hit.
    #[inline(always)]
    fn accept_unverified(&mut self, row: usize, sphere: usize) -> bool {
        let ray = ConservativeRay::new(self.rays.origin.load(row), self.rays.direction.load(row));
        let center = self.spheres.center(sphere);
        let near = Chord::<f32>::new(&ray, center.into(), self.spheres.radius(sphere)).near();
        let nearer = near >= 0.0 && near < self.bounds(row).1;
        if nearer {
            self.hits.set(row, f64::from(near), sphere as u32);
        }
        nearer
    }
}

/// Packet by packet, at the end of their traversal.
impl<Q: Query> HitResolver<'_, Q> {
    /// Stores the hits of a packet whose first ray is row `first`.
    #[inline(always)]
    pub(super) fn commit_packet<L: Lanes>(
        &mut self,
        first: usize,
        rays: &ConservativeRay<L>,
        nearest: &NearestHit<L>,
        runner_up: &RunnerUp<L>,
    ) {
        let found = nearest.found();
        if Q::ANY {
            self.store_spheres(first, found, nearest.sphere);
            let open = nearest.near.has_bits_of(L::splat(DONE))
                & !nearest.t_max.has_bits_of(L::splat(DONE));
            return self.mark_unresolved(first, open.bits());
        }
        let found = found.bits();
        if found == 0 {
            return;
        }
        if !Q::EXACT {
            return self.accept_packet_unverified(first, nearest);
        }
        if !self.is_single_precision() {
            return self.mark_unresolved(first, found);
        }
        let low = self.commit_half::<L, 0>(first, rays, nearest, runner_up);
        // Not a loop, so that lanes stay in registers and the halves do not wait for each other.
        let high = if L::WIDTH > 8 {
            self.commit_half::<L, 8>(first, rays, nearest, runner_up)
        } else {
            0
        };
        let resolved = (low | high << 8) & found;
        self.store_spheres(first, L::lanes(resolved), nearest.sphere);
        self.mark_unresolved(first, found & !resolved);
    }

    /// Stores the distances of eight lanes, from `FROM` on, where double precision decides the hit.
    /// Returns a bit for each of these lanes.
    #[inline(always)]
    fn commit_half<L: Lanes, const FROM: usize>(
        &mut self,
        first: usize,
        rays: &ConservativeRay<L>,
        nearest: &NearestHit<L>,
        runner_up: &RunnerUp<L>,
    ) -> u32 {
        let vector =
            |v: Vec3<L>| Vec3::new(v.x.doubles(FROM), v.y.doubles(FROM), v.z.doubles(FROM));
        let pairs = Pairs {
            origin: vector(rays.origin()),
            direction: vector(rays.direction()),
            // As if all origins were on surfaces, which is no less.
            origin_error: rays.origin_error().doubles(FROM),
            center: vector(runner_up.sphere.center),
            radius: runner_up.sphere.radius.doubles(FROM),
        };
        let near = nearest.near.doubles(FROM);
        // Nothing beyond `t_max` was tested.
        let other = runner_up.near.min(nearest.t_max).doubles(FROM);
        let found = nearest.found().bits() >> FROM & 0xff;
        let (resolved, t) = self.resolve(&pairs, found, near, other);
        store_where(resolved, t, &mut self.hits.t[first + FROM..]);
        resolved.bits()
    }

    /// Returns the lanes in which double precision decides that the ray hits the sphere, before `other`, and the
    /// distances. `near` is a distance before which it does not; only `wanted` lanes matter.
    #[inline(always)]
    fn resolve(
        &self,
        pairs: &Pairs<F64x8>,
        wanted: u32,
        near: F64x8,
        other: F64x8,
    ) -> (<F64x8 as Doubles>::Mask, F64x8) {
        let is_first = |t: F64x8| (t * F64x8::splat(1.0 + CLEAR)).lt(other);
        if !Q::ROUNDED {
            let (plain, t) = intersect::confirm_either(pairs);
            return (plain & is_first(t), t);
        }
        if self.coarse {
            let (certain, t) = intersect::nearest_quickly(pairs, near);
            let resolved = certain & is_first(t);
            if !resolved.bits() & wanted == 0 {
                return (resolved, t);
            }
        }
        // A copy, so that pairs stay in registers up to here.
        let pairs = *pairs;
        resolve_closely(&pairs, wanted, other)
    }

    #[inline(always)]
    fn mark_unresolved(&mut self, first: usize, lanes: u32) {
        for lane in set_bits(lanes) {
            self.unresolved.push((first + lane) as u32);
        }
    }

    #[inline(always)]
    fn store_spheres<L: Lanes>(&mut self, first: usize, mask: L::Mask, sphere: L) {
        let column = bytemuck::cast_slice_mut(&mut self.hits.sphere[first..]);
        L::select(mask, sphere, L::load(column)).store(column);
    }

    /// Accepts the candidates of the conservative test as hits.
    #[inline(always)]
    fn accept_packet_unverified<L: Lanes>(&mut self, first: usize, nearest: &NearestHit<L>) {
        self.store_spheres(first, nearest.found(), nearest.sphere);
        for half in (0..L::WIDTH).step_by(8) {
            let near = nearest.near.doubles(half);
            let nearer = F64x8::splat(0.0).lt(near) & near.lt(F64x8::splat(f64::INFINITY));
            store_where(nearer, near, &mut self.hits.t[first + half..]);
        }
    }
}

/// Does what [`HitResolver::resolve`] does, with rounded distances, where the quick way is not certain.
#[inline(never)]
fn resolve_closely(
    pairs: &Pairs<F64x8>,
    wanted: u32,
    other: F64x8,
) -> (<F64x8 as Doubles>::Mask, F64x8) {
    let (plain, about) = intersect::confirm_either(pairs);
    let resolved = plain & (about * F64x8::splat(1.0 + CLEAR)).lt(other);
    let (certain, t) = intersect::nearest_closely(pairs, about);
    let mut t = t.to_array();
    for lane in set_bits(resolved.bits() & !certain.bits() & wanted) {
        let (ray, center, radius) = pairs.lane(lane);
        t[lane] = exact::nearest_distance(&ray, center, radius).unwrap_or(about.to_array()[lane]);
    }
    (resolved, F64x8::new(t))
}

/// Distances that were decided candidate by candidate.
impl<Q: Query> HitResolver<'_, Q> {
    /// Rounds the distances of rays that were decided candidate by candidate, if they are to be rounded.
    pub(super) fn round_distances(&mut self) {
        for &row in &self.unrounded {
            let row = row as usize;
            let (center, radius) = self.spheres.exact(self.hits.sphere[row] as usize);
            let t = &mut self.hits.t[row];
            *t = intersect::nearest(&self.rays.exact(row), center, radius, *t, self.coarse);
        }
        self.unrounded.clear();
    }
}

/// Single rays and their best candidates, which are decided when there are [`LANES`] of them.
#[derive(Clone, Copy, Default)]
struct PendingHits {
    count: usize,
    ray: [Pair; LANES],
    /// Distances before which no other sphere is hit.
    runner_up: [f32; LANES],
    /// Distances before which the candidate is not hit.
    near: [f32; LANES],
}

/// Single rays, at the end of their traversal.
impl<Q: Query> HitResolver<'_, Q> {
    /// Adds a ray that has passed the tree, if it has a candidate. Nothing but the candidate is hit
    /// before `runner_up`.
    #[inline(always)]
    pub(super) fn push_pending(&mut self, row: u32, nearest: &NearestHit<f32>, runner_up: f32) {
        let sphere = nearest.sphere.to_bits();
        if !Q::EXACT {
            if sphere != MISS {
                self.hits.set(row as usize, f64::from(nearest.near), sphere);
            }
            return;
        }
        let pending = &mut self.pending;
        let place = pending.count % LANES;
        pending.ray[place] = Pair { row, sphere };
        // Nothing beyond `t_max` was tested.
        pending.runner_up[place] = runner_up.min(nearest.t_max);
        pending.near[place] = nearest.near;
        pending.count = place + usize::from(sphere != MISS);
        if pending.count == LANES {
            self.flush_pending();
        }
    }

    /// Stores the hits of the pending rays.
    #[inline(never)]
    pub(super) fn flush_pending(&mut self) {
        let count = std::mem::take(&mut self.pending.count);
        if count == 0 {
            return;
        }
        let PendingHits { mut ray, runner_up, near, .. } = self.pending;
        // Unused lanes repeat the first ray.
        let first = ray[0];
        ray[count..].fill(first);
        let (near, other) = (load_doubles(&near), load_doubles(&runner_up));
        let pairs = Pairs::gather(self.rays, self.spheres, &ray);
        let (resolved, t) = self.resolve(&pairs, (1 << count) - 1, near, other);
        let (resolved, t) = (resolved.bits(), t.to_array());
        for (lane, (ray, t)) in ray.into_iter().zip(t).enumerate().take(count) {
            if resolved >> lane & 1 == 1 {
                self.hits.set(ray.row as usize, t, ray.sphere);
            } else {
                self.unresolved.push(ray.row);
            }
        }
    }
}
