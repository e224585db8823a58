//! The shadow queue: rays waiting for an occlusion test.

use super::Job;
use super::clock::Stage;
use super::columns::row;
use super::shading_row::SurfaceLanes;
use super::workspace::Workspace;
use crate::lanes::{
    F32x16, Lanes, MAX_LANES, Mask, Packing, U32x16, bits, bits_of, first_lanes, set_bits,
};
use crate::ray::{Columns3, ExactRay, GROUND, Hits, MISS, Rays};
use crate::trace;
use crate::vec3::Vec3;
use crate::world::{LANES, LightLanes, LightSample, ReceiverRow, World};
use glam::Vec3 as Point;

/// Capacity of a queue.
pub const SHADOW_QUEUE_SIZE: usize = 4096;

/// Shadow rays, in columns, with the light that they carry.
pub struct ShadowQueue {
    /// Rays from surfaces toward lights.
    pub rays: Rays,
    /// Bounds on entry, occlusion on return.
    pub hits: Hits,
    /// Paths that receive the light.
    pub path: Vec<u32>,
    /// Light that arrives if the ray is not occluded.
    pub light: Columns3,
    /// The part of the light that translucent bodies let pass; empty if there are none.
    transmittance: Vec<f32>,
}

impl ShadowQueue {
    /// Creates an empty queue with room for [`SHADOW_QUEUE_SIZE`] rays, among translucent bodies or not.
    pub fn new(translucent: bool) -> Self {
        Self {
            rays: Rays::with_capacity(SHADOW_QUEUE_SIZE),
            hits: Hits::with_capacity(SHADOW_QUEUE_SIZE),
            path: vec![0; SHADOW_QUEUE_SIZE + LANES],
            light: Columns3::with_rows(SHADOW_QUEUE_SIZE + LANES),
            transmittance: vec![1.0; if translucent { SHADOW_QUEUE_SIZE + LANES } else { 0 }],
        }
    }

    /// Returns whether there is room for `count` more rays.
    #[inline]
    pub fn has_room(&self, count: usize) -> bool {
        self.rays.len() + count <= SHADOW_QUEUE_SIZE
    }

    /// Appends the shadow rays in `lanes` of a row of light samples, for these paths and with this
    /// light. There must be room for a whole row.
    #[inline(always)]
    fn push_row(
        &mut self,
        from: &ReceiverRow,
        samples: &LightLanes,
        lanes: u32,
        path: U32x16,
        light: Vec3<F32x16>,
    ) {
        let (packing, first) = (Packing::new(lanes), self.rays.len());
        self.rays.append_packed(&packing, (from.point, samples.direction), &from.own);
        packing.store_numbers(U32x16::new(samples.target), &mut self.rays.target[first..]);
        packing.store_numbers(path, &mut self.path[first..]);
        packing.store_doubles(&samples.t, &mut self.hits.t[first..]);
        self.hits.sphere[first..first + LANES].fill(MISS);
        self.light.pack(first, &packing, light);
    }

    /// Appends a ray. There must be room for it.
    pub(super) fn push(&mut self, next: &ShadowRay) {
        let row = self.rays.len();
        self.rays.push(next.start.0, next.direction, next.start.1);
        self.rays.target[row] = next.end.1;
        self.hits.set(row, next.end.0, MISS);
        self.path[row] = next.path;
        self.light.set(row, next.light);
    }
}

/// A single shadow ray.
#[derive(Clone, Copy)]
pub(super) struct ShadowRay {
    /// Origin, and the sphere that it lies on.
    pub(super) start: (Point, u32),
    /// Direction.
    pub(super) direction: Point,
    /// Distance of the light, and the row of its sphere.
    pub(super) end: (f64, u32),
    /// Path that receives the light.
    pub(super) path: u32,
    /// Light that arrives if the ray is not occluded.
    pub(super) light: Point,
}

/// Enqueues the shadow rays in `lanes` of light samples, with the light that arrives if they are not
/// occluded. Traces the queue first if it is full.
#[inline(never)]
pub fn enqueue_shadow_rays(
    job: &Job,
    work: &mut Workspace,
    surface_row: &SurfaceLanes,
    samples: &LightLanes,
    lanes: u32,
    light: Vec3<F32x16>,
) {
    let lit = Lanes::lt(F32x16::splat(0.0), light.max_element()).bits();
    let hidden = set_bits(lanes & lit & surface_row.inside).filter(|&lane| {
        let row = surface_row.rows.to_array()[lane] as usize;
        self_occludes(job.world, work, row, &samples.sample(lane))
    });
    let lanes = hidden.fold(lanes & lit, |lanes, lane| lanes & !(1 << lane));
    if !work.shadow_queue.has_room(LANES) {
        trace_shadow_rays(job, work);
    }
    work.shadow_queue.push_row(&surface_row.at, samples, lanes, surface_row.state.path, light);
}

/// Returns whether a sphere occludes a light as seen from a point of its inside: the light is behind
/// its far side, or behind its cap.
fn self_occludes(world: &World, work: &Workspace, row: usize, sample: &LightSample) -> bool {
    let own = work.hits.sphere[row];
    own != GROUND
        && (work.chord_length(world, row, sample.direction) < sample.t
            || (!world.cut.is_empty() && cap_occludes(world, work, row, sample)))
}

/// Returns whether the ray to a light from the inside of a sphere crosses a flat cut.
#[cold]
fn cap_occludes(world: &World, work: &Workspace, row: usize, sample: &LightSample) -> bool {
    let ray = ExactRay::new(work.surface.point.row(row), sample.direction, true);
    world.cut.clip(&ray, work.hits.sphere[row]).to < sample.t
}

/// Traces the shadow rays, and adds the light of those that are not occluded to their paths.
pub fn trace_shadow_rays(job: &Job, work: &mut Workspace) {
    work.clock.end(Stage::Shade);
    let shadows = &mut work.shadow_queue;
    let ShadowQueue { rays, hits, transmittance, .. } = shadows;
    work.counters.exact_decisions += if transmittance.is_empty() {
        test_occlusion(job, rays, hits)
    } else {
        transmittance.fill(1.0);
        trace::attenuated(job.tracer, job.world, rays, hits, transmittance)
    };
    for first in (0..shadows.rays.len()).step_by(MAX_LANES) {
        let there = first_lanes(shadows.rays.len() - first);
        let hits: F32x16 = bits_of(&shadows.hits.sphere[first..]);
        let lit = hits.has_bits_of(bits(MISS)).bits() & there;
        let path = U32x16::new(*row(&shadows.path, first));
        let mut light = shadows.light.load(first);
        if !shadows.transmittance.is_empty() {
            light = light * F32x16::new(*row(&shadows.transmittance, first));
        }
        work.paths.add(path, light, lit);
    }
    work.counters.shadow_rays += shadows.rays.len() as u64;
    work.probes.count_rays(shadows.path[..shadows.rays.len()].iter().copied());
    shadows.rays.truncate(0);
    work.clock.end(Stage::Shadow);
}

/// Tests which shadow rays are occluded; returns the number of exact decisions.
pub(super) fn test_occlusion(job: &Job, rays: &Rays, hits: &mut Hits) -> u64 {
    if let Some(ground) = job.unreachable_ground() {
        trace::occlude_by_ground(&ground, rays, hits);
    }
    if job.elisions.nearest_occluder {
        trace::occluded(job.tracer, job.world, rays, hits)
    } else {
        trace::closest(job.tracer, job.world, rays, hits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;

    #[test]
    fn pushing_a_row_pushes_its_lanes() {
        let lanes: [f32; LANES] = std::array::from_fn(|lane| lane as f32);
        let [x, y, z] = [1.0, 2.0, 3.0].map(|factor| F32x16::new(lanes) * F32x16::splat(factor));
        let direction = Vec3::new(x, y, z);
        let numbers: [u32; LANES] = std::array::from_fn(|lane| 7 + lane as u32);
        let mut samples = LightLanes::distant(direction, Rgb::ONE, u32::from(u16::MAX));
        (samples.t, samples.target) = (lanes.map(f64::from), numbers);
        let point = direction.map(|x| x + F32x16::splat(0.1));
        let from = ReceiverRow { point, normal: direction, own: numbers.map(|x| 2 * x) };
        let light = direction * F32x16::splat(0.5);
        for bits in [0, 1, 0xffff, 0xff, 0xa5a5, 0x8000, 0xfffe] {
            let mut shadows = ShadowQueue::new(false);
            for _ in 0..3 {
                shadows.push_row(&from, &samples, bits, U32x16::new(numbers), light);
            }
            let each = [(); 3].into_iter().flat_map(|()| set_bits(bits));
            assert_eq!(shadows.rays.len(), 3 * u32::count_ones(bits) as usize);
            for (row, lane) in each.enumerate() {
                let (rays, sample) = (&shadows.rays, samples.sample(lane));
                let start = (rays.origin.row(row), rays.own[row]);
                let end = (rays.direction.row(row), rays.target[row], shadows.hits.t[row]);
                assert_eq!(start, (from.receiver(lane).point, from.own[lane]));
                assert_eq!(end, (sample.direction, sample.target, sample.t));
                assert_eq!((shadows.hits.sphere[row], shadows.path[row]), (MISS, numbers[lane]));
                assert_eq!(shadows.light.row(row), 0.5 * sample.direction);
            }
        }
    }
}
