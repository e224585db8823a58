//! Packets of coherent rays, which pass the tree together.
//!
//! A packet of `L::WIDTH` rays is bounded by intervals of origins and directions, and these are tested
//! against the boxes of eight children at once, and against the boxes of a leaf's eight spheres. Each
//! sphere that is left is tested against all rays at once. `L = f32` is a single ray.
//!
//! Hits are decided at the end, for all rays at once: see [`NearestHit`].

use super::interleaved::RayGroup;
use super::nearest::{Candidate, NearestHit, RunnerUp, SphereLanes};
use super::query::Query;
use super::resolver::{DONE, HitResolver};
use crate::conservative::{Chord, ConservativeRay, Margin};
use crate::lanes::{F32x8, Lanes, bits, bits_of, greatest_of, set_bits};
use crate::ray::{Columns3, MISS, Rays};
use crate::slabs::{MARGIN, PacketSlabs, Planes, Slabs};
use crate::spheres::{LEAF, SphereBlock, Spheres};
use crate::vec3::Vec3;

/// The rays that become a packet.
#[derive(Clone, Copy)]
pub(super) struct PacketStart {
    /// The first row.
    pub(super) row: usize,
    /// A bit for each lane that belongs to the packet.
    pub(super) lanes: u32,
}

/// Some of the rays `row..row + L::WIDTH`.
#[derive(Clone, Copy)]
pub(super) struct Packet<L: Lanes> {
    row: u32,
    ray: ConservativeRay<L>,
    /// As if all rays started on surfaces.
    margin: Margin<L>,
    /// The bits of the spheres that the rays start on, and of those that they are aimed at.
    excluded: [L; 2],
    nearest: NearestHit<L>,
    runner_up: RunnerUp<L>,
}

impl<Q: Query, L: Lanes> RayGroup<Q> for Packet<L> {
    type Start = PacketStart;
    type Slabs = PacketSlabs;

    #[inline(always)]
    fn idle() -> Self {
        Self {
            row: 0,
            ray: ConservativeRay::IDLE.splat(),
            margin: ConservativeRay::IDLE.splat().margin(),
            excluded: [bits(MISS); 2],
            nearest: NearestHit::new::<Q>(L::splat(DONE), L::splat(DONE)),
            runner_up: RunnerUp { sphere: SphereLanes::splat([0.0; 4]), near: L::splat(DONE) },
        }
    }

    #[inline(always)]
    fn start(
        &mut self,
        resolver: &mut HitResolver<Q>,
        start: PacketStart,
        slabs: &mut PacketSlabs,
    ) -> f32 {
        self.load_rays(resolver, start);
        *slabs = interval_slabs::<L>(resolver.rays, start);
        self.nearest.t_max.greatest()
    }

    #[inline(always)]
    fn test_leaf(&mut self, slabs: &PacketSlabs, t_far: f32, _: usize, block: &SphereBlock) -> u32 {
        slabs.enters(&sphere_boxes(block), t_far).0
    }

    #[inline(always)]
    fn test_spheres(&mut self, resolver: &mut HitResolver<Q>, first: usize, spheres: u32) {
        // Copies, which stay in registers: what is stored under a mask takes long to be loaded again.
        let (mut nearest, mut runner_up) = (self.nearest, self.runner_up);
        for lane in set_bits(spheres) {
            self.test_sphere::<Q>(resolver.spheres, first + lane, &mut nearest, &mut runner_up);
        }
        self.nearest = nearest;
        if Q::EXACT && !Q::ANY {
            self.runner_up = runner_up;
        }
    }

    #[inline(always)]
    fn t_far(&self, _: &HitResolver<Q>) -> f32 {
        self.nearest.t_max.greatest()
    }

    #[inline(always)]
    fn commit(&self, resolver: &mut HitResolver<Q>) {
        resolver.commit_packet(self.row as usize, &self.ray, &self.nearest, &self.runner_up);
    }
}

impl<L: Lanes> Packet<L> {
    #[inline(always)]
    fn load_rays<Q: Query>(&mut self, resolver: &HitResolver<Q>, start: PacketStart) {
        let (rays, PacketStart { row, lanes }) = (resolver.rays, start);
        let origin: Vec3<L> = rays.origin.load(row);
        let ray = ConservativeRay::new(origin, rays.direction.load(row));
        self.row = row as u32;
        self.ray = ray;
        self.margin = ray.margin();
        self.excluded = [bits_of(&rays.own[row..]), bits_of(&rays.target[row..])];
        let (t_min, t_max) = resolver.search_bounds(row, L::lanes(lanes));
        self.nearest = NearestHit::new::<Q>(t_min, t_max);
        self.runner_up.near = t_min;
    }

    /// Tests the rays of a packet against every sphere.
    #[inline(always)]
    pub(super) fn test_all_spheres<Q: Query>(resolver: &mut HitResolver<Q>, start: PacketStart) {
        let mut packet = <Self as RayGroup<Q>>::idle();
        packet.load_rays(resolver, start);
        let (mut nearest, mut runner_up) = (packet.nearest, packet.runner_up);
        for sphere in 0..resolver.spheres.len() {
            packet.test_sphere::<Q>(resolver.spheres, sphere, &mut nearest, &mut runner_up);
        }
        resolver.commit_packet(start.row, &packet.ray, &nearest, &runner_up);
    }

    /// Tests all rays against a sphere.
    #[inline(always)]
    fn test_sphere<Q: Query>(
        &self,
        spheres: &Spheres,
        sphere: usize,
        nearest: &mut NearestHit<L>,
        runner_up: &mut RunnerUp<L>,
    ) {
        let (block, lane) = (&spheres.blocks()[sphere / LEAF], sphere % LEAF);
        let lanes =
            SphereLanes::splat([block.x[lane], block.y[lane], block.z[lane], block.radius[lane]]);
        let number = bits(sphere as u32);
        let [own, target] = self.excluded.map(|excluded| excluded.has_bits_of(number));
        let chord = Chord::new(&self.ray, lanes.center, lanes.radius);
        let candidate = Candidate { number, allowed: !(own | target), sphere: lanes, chord };
        nearest.update::<Q>(runner_up, &self.ray, &self.margin, &candidate);
    }
}

/// Returns the slabs of the intervals that hold the origins and directions of a packet's rays.
#[inline(always)]
fn interval_slabs<L: Lanes>(rays: &Rays, start: PacketStart) -> PacketSlabs {
    let PacketStart { row, lanes } = start;
    let first = row + lanes.trailing_zeros() as usize;
    let active = L::lanes(lanes);
    let interval = |v: &Columns3| {
        // Inactive lanes repeat the first active one.
        let column = |x: &[f32]| L::select(active, L::load(&x[row..]), L::splat(x[first]));
        let v = [column(&v.x), column(&v.y), column(&v.z)];
        [-greatest_of(v.map(|x| -x)), greatest_of(v)]
    };
    PacketSlabs::between(interval(&rays.origin), interval(&rays.direction))
}

/// Returns the boxes of the spheres of a block, rounded outward as those of the tree are: products with
/// powers of two are exact, and where the margin is not lost, it outweighs what rounding the other
/// product takes.
#[inline(always)]
pub(super) fn sphere_boxes(block: &SphereBlock) -> Planes {
    let widen = F32x8::splat(1.0 + 2.0 * f32::EPSILON);
    let radius = Lanes::relaxed_mul_add(F32x8::load(&block.radius), widen, F32x8::splat(MARGIN));
    let slab = |center: &[f32; LEAF]| {
        let center = F32x8::load(center);
        let reach = Lanes::relaxed_mul_add(Lanes::abs(center), F32x8::splat(f32::EPSILON), radius);
        [(center - reach).to_array(), (center + reach).to_array()]
    };
    [slab(&block.x), slab(&block.y), slab(&block.z)]
}
