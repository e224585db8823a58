//! Single rays: eight spheres of a leaf are tested at once.
//!
//! A [`DeferredRay`] looks for the first hit, keeps its nearest candidate as packets do (see
//! [`NearestHit`]), and is decided at the end, with seven others. A [`SingleRay`] decides each candidate
//! at once: for any hit, for rays that could not be decided at the end, and for rays and spheres beyond
//! single precision.

use super::interleaved::RayGroup;
use super::nearest::{Candidate, NearestHit, RunnerUp, SphereLanes, likely_distance};
use super::query::Query;
use super::ray_setup::RayStart;
use super::resolver::{DONE, HitResolver};
use crate::conservative::{Chord, ConservativeRay};
use crate::lanes::{F32x8, Lanes, Mask, bits, set_bits};
use crate::ray::MISS;
use crate::slabs::{RaySlabs, Slabs};
use crate::spheres::{LEAF, SphereBlock, Spheres};
use crate::vec3::Vec3;

/// The sphere that a ray starts on, and never hits.
#[derive(Clone, Copy)]
struct OwnSphere {
    /// Its block.
    block: u32,
    /// The lanes of all other spheres of the block.
    others: u32,
}

impl OwnSphere {
    const NONE: Self = Self { block: MISS, others: 0 };

    #[inline(always)]
    fn new(row: u32) -> Self {
        Self { block: row / LEAF as u32, others: !(1 << (row % LEAF as u32)) }
    }

    /// Returns the lanes of a block that may be hit.
    #[inline(always)]
    fn allowed(self, block: usize) -> u32 {
        if self.block == block as u32 { self.others } else { u32::MAX }
    }
}

/// Returns the chords of a ray through the spheres of a block, their radii increased by `slack`.
#[inline(always)]
pub(super) fn chords(
    ray: &ConservativeRay<f32>,
    block: &SphereBlock,
    slack: Option<f32>,
) -> Chord<F32x8> {
    let center = Vec3::new(F32x8::load(&block.x), F32x8::load(&block.y), F32x8::load(&block.z));
    let radius = F32x8::load(&block.radius);
    let radius = slack.map_or(radius, |slack| radius + F32x8::splat(slack));
    Chord::new(&ray.splat(), center, radius)
}

/// A ray whose candidates are decided at once.
#[derive(Clone, Copy)]
pub(super) struct SingleRay {
    row: u32,
    own: OwnSphere,
    ray: ConservativeRay<f32>,
}

impl<Q: Query> RayGroup<Q> for SingleRay {
    type Start = RayStart;
    type Slabs = RaySlabs;

    #[inline(always)]
    fn idle() -> Self {
        Self { row: 0, own: OwnSphere::NONE, ray: ConservativeRay::IDLE }
    }

    #[inline(always)]
    fn start(
        &mut self,
        resolver: &mut HitResolver<Q>,
        start: RayStart,
        slabs: &mut RaySlabs,
    ) -> f32 {
        let (ray, bounds) = resolver.start_ray(start, slabs);
        let own = OwnSphere::new(resolver.rays.own[start.row]);
        *self = Self { row: start.row as u32, own, ray };
        bounds.1
    }

    #[inline(always)]
    fn test_leaf(&mut self, _: &RaySlabs, t_far: f32, index: usize, block: &SphereBlock) -> u32 {
        let chord = chords(&self.ray, block, None);
        chord.may_hit(F32x8::splat(t_far)).bits() & self.own.allowed(index)
    }

    #[inline(always)]
    fn test_spheres(&mut self, resolver: &mut HitResolver<Q>, first: usize, spheres: u32) {
        let row = self.row as usize;
        for sphere in set_bits(spheres).map(|lane| first + lane) {
            // A shadow ray that nothing stops comes to its light: so that is tested first.
            let certain = || {
                let spheres = resolver.spheres;
                let (center, radius) = (spheres.center(sphere), spheres.radius(sphere));
                certainly_hits(&self.ray, center, radius, resolver.bounds(row).0)
            };
            if Q::ANY && resolver.rays.target[row] != sphere as u32 && certain() {
                resolver.hits.sphere[row] = sphere as u32;
            } else {
                resolver.test_sphere(row, sphere);
            }
        }
    }

    #[inline(always)]
    fn t_far(&self, resolver: &HitResolver<Q>) -> f32 {
        resolver.bounds(self.row as usize).1
    }

    #[inline(always)]
    fn commit(&self, _: &mut HitResolver<Q>) {}
}

impl SingleRay {
    /// Tests the ray of a row against every sphere.
    pub(super) fn test_all_spheres<Q: Query>(resolver: &mut HitResolver<Q>, row: usize) {
        let (spheres, mut ray) = (resolver.spheres, <Self as RayGroup<Q>>::idle());
        let mut slabs = RaySlabs::IDLE;
        let mut t_far = ray.start(resolver, RayStart { row, few: true }, &mut slabs);
        for (index, block) in spheres.blocks().iter().enumerate() {
            let hit = <Self as RayGroup<Q>>::test_leaf(&mut ray, &slabs, t_far, index, block);
            ray.test_spheres(resolver, index * LEAF, hit);
            t_far = ray.t_far(resolver);
        }
    }
}

/// Returns whether single precision can tell that a ray hits a sphere before a distance.
#[inline(always)]
pub(super) fn certainly_hits(
    ray: &ConservativeRay<f32>,
    center: glam::Vec3,
    radius: f32,
    before: f32,
) -> bool {
    let chord = Chord::new(ray, center.into(), radius);
    let margin = ray.margin();
    chord.enters(ray, radius, &margin) && chord.near_at_most(radius, &margin) < before
}

/// The nearest candidate of a ray so far, and the bound of all others.
#[derive(Clone, Copy)]
pub(super) struct DeferredHit {
    pub(super) nearest: NearestHit<f32>,
    /// A distance before which no other sphere is hit, and the search does not end.
    pub(super) runner_up: f32,
}

impl DeferredHit {
    /// No candidate yet, between bounds of the distance at which the search ends.
    #[inline(always)]
    pub(super) fn new<Q: Query>(bounds: (f32, f32)) -> Self {
        Self { nearest: NearestHit::new::<Q>(bounds.0, bounds.1), runner_up: bounds.0 }
    }

    /// Tests spheres of the block that begins with sphere `first`: a bit of `lanes` for each, which is not hit before
    /// its distance in `near`. The ray never hits sphere `target`.
    #[inline(always)]
    pub(super) fn test_spheres<Q: Query>(
        &mut self,
        ray: &ConservativeRay<f32>,
        target: u32,
        spheres: &Spheres,
        first: usize,
        lanes: u32,
        near: &[f32; LEAF],
    ) {
        for lane in set_bits(lanes) {
            let (sphere, near) = (first + lane, near[lane]);
            let (number, counts) = (bits(sphere as u32), near <= self.nearest.t_max);
            if !Q::EXACT {
                self.nearest.accept_unverified::<Q>(counts && near >= 0.0, near, number);
            } else if near < 0.0 || target == sphere as u32 {
                // By value: what a call may write does not stay in registers.
                *self = self.test_sphere_closely::<Q>(*ray, target, spheres, sphere);
            } else {
                let far = likely_distance(near, spheres.radius(sphere));
                self.nearest.update_nearest(&mut self.runner_up, counts, [near, far], number);
            }
        }
    }

    /// Tests a sphere that the ray may start in, or that it is aimed at.
    #[inline(always)]
    fn test_sphere_closely<Q: Query>(
        mut self,
        ray: ConservativeRay<f32>,
        target: u32,
        spheres: &Spheres,
        sphere: usize,
    ) -> Self {
        let (center, radius) = (spheres.center(sphere), spheres.radius(sphere));
        let lanes = SphereLanes::splat([center.x, center.y, center.z, radius]);
        let chord = Chord::new(&ray, lanes.center, radius);
        let allowed = target != sphere as u32;
        let candidate = Candidate { number: bits(sphere as u32), allowed, sphere: lanes, chord };
        let mut runner_up = RunnerUp { sphere: lanes, near: self.runner_up };
        self.nearest.update::<Q>(&mut runner_up, &ray, &ray.margin(), &candidate);
        self.runner_up = runner_up.near;
        self
    }
}

/// A ray whose first hit is decided at the end.
#[derive(Clone, Copy)]
pub(super) struct DeferredRay {
    row: u32,
    own: OwnSphere,
    ray: ConservativeRay<f32>,
    hit: DeferredHit,
    /// Distances before which the spheres of the last block are not hit.
    near: [f32; LEAF],
}

impl<Q: Query> RayGroup<Q> for DeferredRay {
    type Start = RayStart;
    type Slabs = RaySlabs;

    #[inline(always)]
    fn idle() -> Self {
        Self {
            row: 0,
            own: OwnSphere::NONE,
            ray: ConservativeRay::IDLE,
            hit: DeferredHit::new::<Q>((DONE, DONE)),
            near: [0.0; LEAF],
        }
    }

    #[inline(always)]
    fn start(
        &mut self,
        resolver: &mut HitResolver<Q>,
        start: RayStart,
        slabs: &mut RaySlabs,
    ) -> f32 {
        let (ray, bounds) = resolver.start_ray(start, slabs);
        self.row = start.row as u32;
        self.own = OwnSphere::new(resolver.rays.own[start.row]);
        self.ray = ray;
        self.hit = DeferredHit::new::<Q>(bounds);
        bounds.1
    }

    #[inline(always)]
    fn test_leaf(&mut self, _: &RaySlabs, t_far: f32, index: usize, block: &SphereBlock) -> u32 {
        let chord = chords(&self.ray, block, None);
        chord.near().store(&mut self.near);
        chord.may_hit(F32x8::splat(t_far)).bits() & self.own.allowed(index)
    }

    #[inline(always)]
    fn test_spheres(&mut self, resolver: &mut HitResolver<Q>, first: usize, spheres: u32) {
        let target = resolver.rays.target[self.row as usize];
        let Self { hit, ray, near, .. } = self;
        hit.test_spheres::<Q>(ray, target, resolver.spheres, first, spheres, near);
    }

    #[inline(always)]
    fn t_far(&self, _: &HitResolver<Q>) -> f32 {
        self.hit.nearest.t_max
    }

    #[inline(always)]
    fn commit(&self, resolver: &mut HitResolver<Q>) {
        resolver.push_pending(self.row, &self.hit.nearest, self.hit.runner_up);
    }

    #[inline(always)]
    fn flush(resolver: &mut HitResolver<Q>) {
        resolver.flush_pending();
    }
}
