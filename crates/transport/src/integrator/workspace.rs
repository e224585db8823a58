//! The workspace of a task: its columns, allocated once and reused for each tile.

use super::Job;
use super::caustics::Caustics;
use super::clock::Clock;
use super::columns::{BATCH_PATHS, ROWS};
use super::counters::Counters;
use super::elisions::Elisions;
use super::features::FeatureBatch;
use super::material_queues::{ESCAPED, HitColumns, MaterialQueues};
use super::material_table::MaterialTable;
use super::near_misses::NearMisses;
use super::next_rays::{NextRays, RayRow};
use super::path_state::{PathStateRow, PathStates};
use super::probe_batch::ProbeBatch;
use super::seen_lights::SeenLights;
use super::shading_row::SurfaceLanes;
use super::shadow_queue::ShadowQueue;
use super::surface::{SurfaceColumns, chord_length, exit_distance};
use crate::film::{Region, View};
use crate::lanes::{F32x16, MAX_LANES, Packing, U32x16, set_bits};
use crate::ray::{ExactRay, GROUND, Hits, MISS, Rays};
use crate::sampling::{SampleRow, Sampler, SamplerRow, SamplerState, SamplerStates, StartRow};
use crate::scene::Rgb;
use crate::trace::{self, Chosen};
use crate::vec3 as row;
use crate::world::World;
use glam::Vec3;
use std::mem::swap;
use std::ops::Range;

/// Capacity of a path's interior list.
const MAX_NESTING: usize = 16;

/// Everything that a task writes while it renders a tile.
///
/// Paths have an index, `0..BATCH_PATHS`, from the camera to their end. Those that are alive have a row in
/// `rays`, `hits`, `surface` and `states`. Each bounce writes new rows, in the order of shading,
/// without gaps (compaction), so that neighbors hit the same kind of material.
pub struct Workspace {
    /// By row: the current ray of each path.
    pub rays: Rays,
    /// By row: the hit of the ray.
    pub hits: Hits,
    /// By row: the surface point of the hit.
    pub surface: SurfaceColumns,
    /// By row: the path state.
    pub states: PathStates,
    /// By path: radiance and sampler states.
    pub paths: Paths,
    /// By row: numbers from 0 up to 1 by which camera rays choose translucent bodies; empty if there are none.
    pub thresholds: Vec<f32>,
    /// By row: the part of a camera ray's light that its hit stands for, if it hits anything; the rest comes from behind
    /// translucent bodies. Empty if there are none.
    coverage: Vec<f32>,
    /// By row: the mean albedo of all bodies on a camera ray, less that of its hit, if colors are composited. Otherwise empty.
    missing_albedo: Vec<Rgb>,
    /// Hits by kind of material.
    pub queues: MaterialQueues,
    /// Materials of the spheres, if there are few.
    pub material_table: Option<MaterialTable>,
    /// Rays of the next bounce.
    pub(super) next_rays: NextRays,
    /// Shadow rays of light samples.
    pub shadow_queue: ShadowQueue,
    /// Caustic queries and their rays.
    pub(super) caustics: Caustics,
    /// Lights that the camera sees.
    pub(super) seen_lights: SeenLights,
    /// Features of the camera rays, if they are recorded.
    pub features: FeatureBatch,
    /// The probes whose paths these are, if any.
    pub probes: ProbeBatch,
    /// Near misses of probes.
    pub near_misses: NearMisses,
    /// View of the camera rays: anything, or only background.
    pub view: View,
    /// Counts of work.
    pub counters: Counters,
    /// Times of the stages.
    pub clock: Clock,
}

/// Radiance and sampler states, by path.
pub struct Paths {
    /// Radiance found so far.
    pub radiance: Vec<Rgb>,
    /// Sampler states, without the place in the sequence, which is part of the path state.
    pub sampler_states: SamplerStates,
    /// Interior lists: the glass spheres that contain the path, of fixed capacity; none if paths can be
    /// in at most one.
    interiors: Vec<u32>,
    nesting: usize,
}

impl Workspace {
    /// Allocates room for [`BATCH_PATHS`] paths through `world`.
    pub fn new(world: &World, elisions: Elisions) -> Self {
        let normals = world.lights.by_receiver();
        let translucent = if world.features.translucent { ROWS } else { 0 };
        let nesting = if elisions.glass && !world.features.nested_glass { 0 } else { MAX_NESTING };
        Self {
            rays: Rays::with_capacity(BATCH_PATHS),
            hits: Hits::with_capacity(BATCH_PATHS),
            surface: SurfaceColumns::with_rows(ROWS),
            states: PathStates::new(normals),
            paths: Paths {
                radiance: vec![Rgb::ZERO; BATCH_PATHS],
                sampler_states: SamplerStates::with_paths(BATCH_PATHS),
                interiors: vec![MISS; BATCH_PATHS * nesting],
                nesting,
            },
            thresholds: vec![0.0; translucent],
            coverage: vec![0.0; translucent],
            missing_albedo: Vec::new(),
            queues: MaterialQueues::new(world, normals),
            material_table: MaterialTable::new(world, ESCAPED),
            next_rays: NextRays::new(normals),
            shadow_queue: ShadowQueue::new(world.features.translucent),
            caustics: Caustics::new(world),
            seen_lights: SeenLights::default(),
            features: FeatureBatch::default(),
            probes: ProbeBatch::default(),
            near_misses: NearMisses::default(),
            view: View::Anything,
            counters: Counters::default(),
            clock: Clock::new(),
        }
    }

    /// Returns the number of paths that are alive.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Returns whether no path is alive.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Prepares for paths of pixels of some regions.
    pub fn begin(&mut self, job: &Job, regions: impl Iterator<Item = Region>) {
        self.seen_lights.begin(job, regions);
    }

    /// Starts whole rows of samples, from `first` on, of the pixel in column `x` and row `y`; stores the
    /// pixel's coordinates as origins of rays `rows`.
    pub(super) fn start_pixel(
        &mut self,
        sampler: &Sampler,
        x: u32,
        y: u32,
        first: u32,
        rows: Range<usize>,
    ) {
        for (row, first) in rows.clone().step_by(MAX_LANES).zip((first..).step_by(MAX_LANES)) {
            self.set_start(row, &sampler.start_row(x, y, first));
        }
        self.rays.origin.x[rows.clone()].fill(x as f32);
        self.rays.origin.y[rows].fill(y as f32);
    }

    /// Starts a row of samples of any pixels, and stores the pixels' coordinates as origins of rays.
    pub(super) fn start_samples(&mut self, sampler: &Sampler, samples: &SampleRow, row: usize) {
        self.set_start(row, &sampler.start_samples(samples));
        let rows = row..row + MAX_LANES;
        self.rays.origin.x[rows.clone()].copy_from_slice(&samples.x.map(|x| x as f32));
        self.rays.origin.y[rows].copy_from_slice(&samples.y.map(|y| y as f32));
    }

    fn set_start(&mut self, row: usize, start: &StartRow) {
        self.paths.sampler_states.set_row(row, start);
        self.states.set_sequence(row, &start.positions);
    }

    /// Starts `count` paths, whose samples have been started. The caller sets their rays.
    pub(super) fn start_paths(&mut self, count: usize) {
        self.rays.begin(count);
        self.hits.t[..count].fill(f64::INFINITY);
        self.hits.sphere[..count].fill(MISS);
        self.coverage.fill(1.0);
        self.missing_albedo.fill(Rgb::ZERO);
        self.paths.radiance[..count].fill(Rgb::ZERO);
        let nesting = self.paths.nesting;
        self.paths.interiors[..count * nesting].fill(MISS);
    }

    /// Returns the sampler state of the path in a row.
    pub(super) fn sampler_state(&self, row: usize) -> SamplerState {
        self.paths.sampler_states.state(self.states.path(row), self.states.sequence_place(row))
    }

    /// Finds the hits of camera rays. Returns the number of decisions made by exact integer arithmetic.
    pub(super) fn trace_camera_rays(&mut self, job: &Job) -> u64 {
        let Self { rays, hits, states, thresholds, coverage, missing_albedo, .. } = self;
        let chosen = Chosen { numbers: thresholds, coverage, missing_albedo };
        let exact = trace::closest_from_camera(job.tracer, job.world, rays, hits, chosen);
        for (row, &coverage) in coverage.iter().enumerate().take(rays.len()) {
            if hits.sphere[row] != MISS && coverage < 1.0 {
                states.set_throughput(row, coverage);
            }
        }
        exact
    }

    /// Lets camera rays find the colors of all translucent bodies on their way, not only of the one that they choose.
    pub(super) fn composite_colors(&mut self) {
        self.missing_albedo.resize(self.coverage.len(), Rgb::ZERO);
    }

    /// Adds the composited colors of camera rays, with this light, to paths that have got that of their hit alone.
    pub(super) fn add_missing_colors(&mut self, light: Rgb) {
        for (row, &missing) in self.missing_albedo.iter().enumerate().take(self.rays.len()) {
            let radiance = &mut self.paths.radiance[self.states.path(row)];
            // Where all surfaces have this light, it is less than 0 by rounding alone.
            *radiance = (*radiance + missing * light).max(Rgb::ZERO);
        }
    }

    /// Returns the part of the light of a camera ray that its hit stands for; 0 if it hits nothing.
    #[inline]
    pub fn coverage(&self, row: usize) -> f32 {
        if self.hits.sphere[row] == MISS {
            return 0.0;
        }
        self.coverage.get(row).copied().unwrap_or(1.0)
    }

    /// Records the features of camera rays, if they are wanted.
    pub(super) fn record_features(&mut self, world: &World) {
        let Self { rays, hits, surface, coverage, .. } = self;
        self.features.record(world, &hits.sphere[..rays.len()], &surface.facing, coverage);
    }

    /// Returns the throughput of what is behind all bodies on the ray in a row: 0 if the ray ends before.
    #[inline]
    pub(super) fn throughput_behind(&self, row: usize) -> Rgb {
        if self.hits.sphere[row] == MISS {
            return self.states.throughput(row);
        }
        let from_camera = self.rays.own[row] == MISS;
        Rgb::splat(if from_camera { 1.0 - self.coverage(row) } else { 0.0 })
    }

    /// Fills the material queues.
    pub(super) fn sort(&mut self, world: &World) {
        let Self { rays, hits, surface, states, .. } = self;
        self.queues.sort(
            world,
            self.material_table.as_ref(),
            &HitColumns { rays, hits, surface, states },
        );
    }

    /// Spawns the next rays of the paths in `lanes`, with these states. Rays inside of a sphere start
    /// with their exit as a hit. Paths that are not in `lanes` end.
    #[inline(never)]
    pub(super) fn spawn_rays(
        &mut self,
        world: &World,
        surface_row: &SurfaceLanes,
        lanes: u32,
        direction: row::Vec3<F32x16>,
        state: &PathStateRow,
    ) {
        let (origin, own) = (surface_row.at.point, &surface_row.at.own);
        let ray_row = RayRow { origin, direction, own, state };
        let first = self.next_rays.push(&Packing::new(lanes), &ray_row);
        for lane in set_bits(lanes & surface_row.inside) {
            let (own, row) = (surface_row.at.own[lane], surface_row.rows.to_array()[lane] as usize);
            if own != GROUND {
                let next = first + (lanes & ((1 << lane) - 1)).count_ones() as usize;
                let direction = self.next_rays.rays.direction.row(next);
                let t = self.chord_length(world, row, direction);
                self.next_rays.hits.set(next, t, own);
                self.next_rays.entry.set(next, self.surface.normal.row(row));
            }
        }
    }

    /// Returns the distance from the point of a sphere that `row` has hit, or of the sphere's cap,
    /// through the inside to where `direction` leaves the sphere.
    #[inline]
    pub fn chord_length(&self, world: &World, row: usize, direction: Vec3) -> f64 {
        if !world.cut.is_empty() || world.has_other_bodies() {
            return self.chord_length_cut(world, row, direction);
        }
        let radius = f64::from(world.spheres.radius(self.hits.sphere[row] as usize));
        chord_length(self.surface.normal.row(row).into(), radius, direction.as_dvec3().into())
    }

    /// Returns the chord's length where spheres are cut or where there are other bodies; a separate function, out of the way of the
    /// usual case.
    #[cold]
    fn chord_length_cut(&self, world: &World, row: usize, direction: Vec3) -> f64 {
        let direction = direction.as_dvec3();
        let origin = self.surface.point.row(row).as_dvec3();
        let ray = ExactRay { origin, direction, origin_error: 0.0 };
        let body = world.body(self.hits.sphere[row]);
        if let Some(exit) = body.and_then(|body| world.trees().exit_distance(body, &ray)) {
            return exit;
        }
        let (center, radius) = world.spheres.exact(self.hits.sphere[row] as usize);
        if world.cut.divides(center, radius) {
            return exit_distance(
                self.surface.point.row(row).as_dvec3() - center,
                radius,
                direction,
            );
        }
        chord_length(self.surface.normal.row(row).into(), radius, direction.into())
    }

    /// Makes the next rays the current ones.
    pub fn advance(&mut self) {
        let next_rays = &mut self.next_rays;
        swap(&mut self.rays, &mut next_rays.rays);
        swap(&mut self.hits, &mut next_rays.hits);
        swap(&mut self.surface.normal, &mut next_rays.entry);
        swap(&mut self.states, &mut next_rays.states);
        next_rays.rays.truncate(0);
    }
}

impl Paths {
    /// Returns the sampler states of a row of paths.
    #[inline(always)]
    pub fn sampler_row(&self, state: &PathStateRow) -> SamplerRow<'_> {
        SamplerRow::new(state.sequence, state.path, &self.sampler_states)
    }

    /// Adds light to the paths in `lanes`.
    #[inline(always)]
    pub fn add(&mut self, path: U32x16, light: row::Vec3<F32x16>, lanes: u32) {
        let path = path.to_array();
        let row::Vec3 { x, y, z } = light.map(F32x16::to_array);
        for lane in set_bits(lanes) {
            self.radiance[path[lane] as usize] += Rgb::new(x[lane], y[lane], z[lane]);
        }
    }

    /// Returns whether paths have interior lists.
    pub fn tracks_interiors(&self) -> bool {
        self.nesting > 0
    }

    /// Returns the interior list of a path.
    #[inline]
    pub fn interior_list(&mut self, path: usize) -> &mut [u32] {
        &mut self.interiors[path * self.nesting..(path + 1) * self.nesting]
    }
}
