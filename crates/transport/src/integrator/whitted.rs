//! Whitted ray tracing: direct light with stratified shadow samples, and bounces at mirrors and glass.
//!
//! After Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980, and Cook, Porter and
//! Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984. Diffuse surfaces receive light from the lights
//! and the environment, by N samples each, and do not illuminate one another. A path does not branch:
//! its diffuse component ends, its mirror component continues with its weight; glass and rough metal
//! choose one direction at random.

use super::Job;
use super::glass;
use super::material_queues::MaterialQueue;
use super::near_misses;
use super::path_state::PathStateRow;
use super::roulette::{roulette_threshold, survival_probability};
use super::shading_row::SurfaceLanes;
use super::shadow_queue;
use super::stages;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask, U32x16, first_lanes};
use crate::ray::MISS;
use crate::sampling::{Bases, Basis, cosine_hemispheres};
use crate::scene::Rgb;
use crate::shade::{
    BroadcastParams, Bsdf, KindVisitor, Material, MaterialId, MaterialKind, mirror,
};
use crate::vec3::Vec3 as Row3;
use crate::world::{LANES, LightLanes, ReceiverRow, World};
use std::f32::consts::PI;

/// Follows all paths to their ends, with `samples` shadow samples per light and hit.
pub fn integrate(job: &Job, work: &mut Workspace, samples: u32) {
    let sky = samples_sky(job.world);
    let threshold = roulette_threshold(job.world);
    for bounce in 0.. {
        stages::intersect(job, work);
        near_misses::record(job, work, bounce);
        add_environment(job, work, bounce);
        add_emitted(job, work);
        if bounce == job.depth() {
            work.counters.cut_paths += work.queues.hit_count();
            return;
        }
        glass::scatter(job, work, bounce);
        let shade = Shade { job, bounce, samples, sky, threshold };
        job.world.materials.for_each_kind(&mut ShadeKinds { shade, work });
        if !stages::end_bounce(job, work) {
            return;
        }
    }
}

/// Returns whether a constant or gradient environment illuminates surfaces: it is one more light.
pub(super) fn samples_sky(world: &World) -> bool {
    let environment = &world.environment;
    environment.illuminates && !environment.is_black() && world.lights.sky_parts == 0
}

/// Adds environment and suns to paths that leave the scene. They have come from the camera by mirrors
/// and glass alone, so there is no MIS weight.
pub(super) fn add_environment(job: &Job, work: &mut Workspace, bounce: u32) {
    let environment = &job.world.environment;
    for row in 0..work.len() {
        let throughput = work.throughput_behind(row);
        if throughput == Rgb::ZERO {
            continue;
        }
        let direction = work.rays.direction.row(row);
        let suns: Rgb = job.world.lights.suns_toward(direction).map(|(_, radiance)| radiance).sum();
        let own = work.rays.own[row];
        let light = match environment.background {
            Some(background) if bounce == 0 => background,
            Some(background) if job.world.material(own).kind() == MaterialKind::Dielectric => {
                background + suns
            }
            _ => environment.radiance(direction) + suns,
        };
        work.paths.radiance[work.states.path(row)] += throughput * light;
    }
}

/// Adds the light of emitters to paths that hit them.
pub(super) fn add_emitted(job: &Job, work: &mut Workspace) {
    for row in work.queues.of(MaterialKind::Emitter).into_iter().flat_map(MaterialQueue::ray_rows) {
        let material = job.world.material(work.hits.sphere[row]);
        let radiance = job.world.materials.emitter[material.row()].radiance;
        work.paths.radiance[work.states.path(row)] += work.states.throughput(row) * radiance;
    }
}

/// A kernel that shades the hits of one bounce.
#[derive(Clone, Copy)]
struct Shade<'a> {
    job: &'a Job<'a>,
    bounce: u32,
    samples: u32,
    sky: bool,
    threshold: f32,
}

/// A visitor that shades all queues of a workspace.
struct ShadeKinds<'a> {
    shade: Shade<'a>,
    work: &'a mut Workspace,
}

impl KindVisitor for ShadeKinds<'_> {
    fn visit<M: Material>(&mut self, kind: MaterialKind, table: impl Fn(MaterialId) -> M) {
        let Some(queue) = self.work.queues.take(kind) else { return };
        let world = self.shade.job.world;
        for row in queue.ray_rows() {
            let hit = self.work.hits.sphere[row];
            debug_assert_ne!(hit, MISS);
            let params = table(world.material(hit)).params(world.color(hit));
            self.shade.shade::<M>(self.work, row, &params);
        }
        self.work.queues.put(kind, queue);
    }
}

/// A surface from which all of a row of shadow rays start, in every lane.
struct BroadcastSurface<M: Material> {
    row: usize,
    bsdf: M::Bsdf<F32x16>,
    bases: Bases<F32x16>,
    outgoing: Row3<F32x16>,
    surface_row: SurfaceLanes,
}

impl<M: Material> BroadcastSurface<M> {
    fn new(work: &Workspace, row: usize, params: &M::Params, local: &LocalSurface) -> Self {
        let surface_row = SurfaceLanes::broadcast(work, row, local);
        Self {
            row,
            bsdf: M::row(&BroadcastParams(*params)),
            bases: Bases::about(surface_row.at.normal),
            outgoing: Row3::from(local.outgoing).map(F32x16::splat),
            surface_row,
        }
    }
}

impl Shade<'_> {
    /// Returns the event number for samples of light `light`: each light has its own strata.
    fn event(&self, light: usize) -> u32 {
        self.bounce.wrapping_mul(0x9e37_79b9).wrapping_add(light as u32)
    }

    /// Shades the hit in a row.
    fn shade<M: Material>(&self, work: &mut Workspace, row: usize, params: &M::Params) {
        let local = LocalSurface::new(work, row);
        let base = BroadcastSurface::<M>::new(work, row, params, &local);
        if M::HAS_DIFFUSE_BASE && base.bsdf.is_delta().bits() == 0 {
            for light in 0..self.job.world.lights.len() {
                self.sample_light(work, light, &base);
            }
            if self.sky {
                self.sample_environment(work, &base);
            }
        }
        self.spawn_rays::<M>(work, params, &local, &base.surface_row);
    }

    /// Samples one light by stratified samples; one sample is enough for a light without extent.
    fn sample_light<M: Material>(
        &self,
        work: &mut Workspace,
        light: usize,
        base: &BroadcastSurface<M>,
    ) {
        let world = self.job.world;
        let count = if world.lights.is_delta(light) { 1 } else { self.samples };
        let share = work.states.throughput(base.row) / count as f32;
        let (origin, own) = (work.surface.point.row(base.row), work.hits.sphere[base.row]);
        let Some(view) = world.light_view(light, origin, own) else { return };
        let points =
            self.job.sampler.split(&work.sampler_state(base.row), self.event(light), count);
        for (first, count) in rows(count) {
            let samples = view.sample_row(points.row(first, count), count);
            self.enqueue_shadow_rays(work, base, share, &samples);
        }
    }

    /// Samples a constant or gradient environment by stratified cosine-distributed samples.
    fn sample_environment<M: Material>(&self, work: &mut Workspace, base: &BroadcastSurface<M>) {
        let share = work.states.throughput(base.row) / self.samples as f32;
        let event = self.event(self.job.world.lights.len());
        let points = self.job.sampler.split(&work.sampler_state(base.row), event, self.samples);
        for (first, count) in rows(self.samples) {
            let incoming = cosine_hemispheres(points.row(first, count));
            let direction = base.bases.to_world(incoming).normalize();
            let mut samples = LightLanes::distant(direction, Rgb::ZERO, first_lanes(count));
            let mut weight = [[0.0; LANES]; 3];
            for (lane, cosine) in incoming.z.to_array().into_iter().enumerate().take(count) {
                let radiance = self.job.world.environment.radiance(samples.sample(lane).direction);
                let light = radiance * (PI / cosine.max(f32::MIN_POSITIVE));
                (0..3).for_each(|channel| weight[channel][lane] = light[channel]);
            }
            let [r, g, b] = weight.map(F32x16::new);
            samples.weight = Row3::new(r, g, b);
            self.enqueue_shadow_rays(work, base, share, &samples);
        }
    }

    /// Enqueues the shadow rays of a row of light samples.
    #[inline(always)]
    fn enqueue_shadow_rays<M: Material>(
        &self,
        work: &mut Workspace,
        base: &BroadcastSurface<M>,
        share: Rgb,
        samples: &LightLanes,
    ) {
        let incoming = base.bases.to_local(samples.direction);
        let response = base.bsdf.eval(base.outgoing, incoming);
        let share = Row3::from(share).map(F32x16::splat);
        let light = share.times(response).times(samples.weight);
        let above = Lanes::lt(F32x16::splat(0.0), incoming.z).bits();
        shadow_queue::enqueue_shadow_rays(
            self.job,
            work,
            &base.surface_row,
            samples,
            samples.lanes & above,
            light,
        );
    }

    /// Spawns the next ray: the mirror component, or a BSDF sample of a material without a diffuse
    /// base.
    fn spawn_rays<M: Material>(
        &self,
        work: &mut Workspace,
        params: &M::Params,
        local: &LocalSurface,
        surface_row: &SurfaceLanes,
    ) {
        let bsdf: M::Bsdf<f32> = M::row(&BroadcastParams(*params));
        let outgoing = local.outgoing.into();
        let row = surface_row.rows.to_array()[0] as usize;
        let draw = self.job.sampler.scatter(&work.sampler_state(row), self.bounce);
        let (incoming, weight) = if M::HAS_DIFFUSE_BASE {
            (mirror(outgoing), bsdf.mirrored(outgoing))
        } else {
            let scatter = bsdf.sample(outgoing, draw.direction, draw.lobe);
            (scatter.incoming, scatter.weight)
        };
        let throughput = work.states.throughput(row) * Rgb::from(weight);
        let greatest = throughput.max_element();
        let survival =
            survival_probability(self.job.settings.roulette, greatest, self.bounce, self.threshold);
        if throughput == Rgb::ZERO || draw.roulette >= survival {
            return;
        }
        let splat = |v: glam::Vec3| Row3::from(v).map(F32x16::splat);
        let direction = splat(local.to_world(incoming.into()));
        let state = PathStateRow { throughput: splat(throughput / survival), ..surface_row.state };
        work.spawn_rays(self.job.world, surface_row, 1, direction, &state);
    }
}

/// Splits `count` samples into rows: the first of each row, and its length.
fn rows(count: u32) -> impl Iterator<Item = (u32, usize)> {
    (0..count).step_by(LANES).map(move |first| (first, LANES.min((count - first) as usize)))
}

impl SurfaceLanes {
    /// Broadcasts the hit of the path in `row` to all lanes.
    fn broadcast(work: &Workspace, row: usize, local: &LocalSurface) -> Self {
        let splat = |v: glam::Vec3| Row3::from(v).map(F32x16::splat);
        Self {
            rows: U32x16::splat(row as u32),
            at: ReceiverRow {
                point: splat(work.surface.point.row(row)),
                normal: splat(local.basis.normal),
                own: [work.hits.sphere[row]; LANES],
            },
            inside: if local.inside { u32::from(u16::MAX) } else { 0 },
            state: work.states.broadcast(row),
        }
    }
}

/// A surface point with its local basis.
#[derive(Clone, Copy)]
struct LocalSurface {
    /// Transform to world space and back; z is the normal on the side that the ray comes from.
    basis: Basis,
    /// Local unit vector toward the origin of the ray.
    outgoing: glam::Vec3,
    /// True if the sphere is hit from inside.
    inside: bool,
}

impl LocalSurface {
    /// Creates the basis of the hit in row `row`.
    #[inline]
    fn new(work: &Workspace, row: usize) -> Self {
        let direction = work.rays.direction.row(row);
        let normal = work.surface.normal.row(row);
        let inside = normal.dot(direction.as_dvec3()) > 0.0;
        let facing = if inside { -normal } else { normal };
        let basis = Basis::new(facing.as_vec3());
        let mut outgoing = basis.to_local(-direction);
        // At grazing angles, rounding may move the direction below the horizon.
        outgoing.z = outgoing.z.max(f32::EPSILON);
        Self { basis, outgoing, inside }
    }

    /// Transforms a sampled direction to world space, of unit length.
    #[inline]
    fn to_world(self, incoming: glam::Vec3) -> glam::Vec3 {
        self.basis.to_world(incoming).normalize()
    }
}
