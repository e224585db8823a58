//! The columns that a task works on: allocated once, used for tile after tile.

use super::bins::Bins;
use super::clock::Clock;
use super::counters::Counters;
use super::gather::Starts;
use super::onward::Onward;
use super::shadows::Shadows;
use super::skips::Skips;
use super::surface::{Surface, chord, far_end};
use crate::film::View;
use crate::lanes::{F32x16, MAX_LANES, Packing, set_bits};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::sampling::{PathRow, PathState, Sampler};
use crate::scene::Rgb;
use crate::vec3 as row;
use crate::world::World;
use glam::Vec3;
use std::mem::swap;

/// Paths that are followed together: 16 samples of each pixel of a tile. The columns of that many
/// stay in the second-level cache.
pub const BATCH: usize = 4096;

/// Rows of a column: with room for whole rows of lanes, and such that the columns do not all begin
/// in the same lines of the first-level cache.
pub(super) const ROWS: usize = BATCH + MAX_LANES;

/// How many glass spheres a path can be in at the same time.
const NESTING: usize = 16;

/// Everything that a task writes while it renders a tile.
///
/// Paths have a place, `0..BATCH`, that they keep from the camera to their end. Those that still go
/// on have a row in `rays`, `hits`, `surface` and `place`; at each bounce they get new rows, in the
/// order in which they are shaded, so that there are no gaps, and like goes with like.
pub struct Workspace {
    /// Rows: the next segment of each path.
    pub rays: Rays,
    /// Rows: what it hits.
    pub hits: Hits,
    /// Rows: where it hits.
    pub surface: Surface,
    /// Rows: which path it belongs to.
    pub place: Vec<u32>,
    /// Places: the paths.
    pub paths: Paths,
    /// Rows by what they hit.
    pub bins: Bins,
    /// The rows of the next bounce.
    pub(super) onward: Onward,
    /// Light that arrives if nothing is in between.
    pub shadows: Shadows,
    /// What the camera rays may hit.
    pub view: View,
    /// What was done.
    pub counters: Counters,
    /// How long it took.
    pub clock: Clock,
}

/// Paths, by place.
pub struct Paths {
    /// Product of the weights so far.
    pub throughput: Vec<Rgb>,
    /// Light that has been found.
    pub radiance: Vec<Rgb>,
    /// Where in its sequence of samples the path is.
    pub sample: Vec<PathState>,
    /// How the path came to where it is.
    pub arrival: Vec<Arrival>,
    /// Normal of the last surface, on the side that was lit, for what the choice of a light depends
    /// on; empty where that depends on nothing.
    pub normal: Vec<Vec3>,
    /// The glass spheres that the path is in: a fixed number of places for each path, none where it
    /// can be in one at most.
    inside: Vec<u32>,
    nesting: usize,
}

/// How a path came to its last point, which decides how the light that it finds there counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Density of the last direction by solid angle; `None` if no light sample could have found it:
    /// from the camera, a mirror or glass.
    pub pdf: Option<f32>,
    /// Whether the last surface was diffuse, where light samples alone count for lights that are
    /// not close.
    pub diffuse: bool,
    /// Whether there were only mirrors and glass since the camera.
    pub unscattered: bool,
}

impl Arrival {
    /// At the first hit.
    pub const CAMERA: Self = Self { pdf: None, diffuse: false, unscattered: true };
}

impl Workspace {
    /// Room for [`BATCH`] paths through `world`.
    pub fn new(world: &World, sampler: &Sampler, skips: Skips) -> Self {
        let nesting = if skips.glass && !world.features.nested_glass { 0 } else { NESTING };
        Self {
            rays: Rays::with_capacity(BATCH),
            hits: Hits::with_capacity(BATCH),
            surface: Surface::with_rows(ROWS),
            place: vec![MISS; ROWS],
            paths: Paths {
                throughput: vec![Rgb::ZERO; BATCH],
                radiance: vec![Rgb::ZERO; BATCH],
                sample: vec![sampler.start(0, 0, 0); BATCH],
                arrival: vec![Arrival::CAMERA; BATCH],
                normal: vec![Vec3::Z; if world.lights.by_receiver() { BATCH } else { 0 }],
                inside: vec![MISS; BATCH * nesting],
                nesting,
            },
            bins: Bins::default(),
            onward: Onward::new(),
            shadows: Shadows::new(),
            view: View::Anything,
            counters: Counters::default(),
            clock: Clock::new(),
        }
    }

    /// Number of paths that still go on.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Whether no path goes on.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Where in their sequences the paths of at most sixteen rows are; lanes without a row are like the
    /// first.
    #[inline(always)]
    pub fn samples(&self, rows: &[u32]) -> PathRow {
        let sample = |row: u32| self.paths.sample[self.place[row as usize] as usize];
        let mut samples = [sample(rows[0]); MAX_LANES];
        samples.iter_mut().zip(rows).for_each(|(lane, &row)| *lane = sample(row));
        samples
    }

    /// Begins as many paths at the camera. The caller has set their samples, and sets their rays.
    pub fn begin(&mut self, count: usize) {
        self.rays.begin(count);
        self.hits.t[..count].fill(f64::INFINITY);
        self.hits.sphere[..count].fill(MISS);
        self.place[..count].iter_mut().zip(0..).for_each(|(place, path)| *place = path);
        self.paths.throughput[..count].fill(Rgb::ONE);
        self.paths.radiance[..count].fill(Rgb::ZERO);
        self.paths.arrival[..count].fill(Arrival::CAMERA);
        let nesting = self.paths.nesting;
        self.paths.inside[..count * nesting].fill(MISS);
    }

    /// Sends the path in `row` on from the surface it has hit. `direction` goes inside the sphere
    /// if `inward`: then what it leaves through is known. Paths that are not sent on end.
    #[inline]
    pub fn go_on(&mut self, world: &World, row: usize, direction: Vec3, inward: bool) {
        let (own, next) = (self.hits.sphere[row], self.onward.rays.len());
        self.onward.rays.push(self.surface.point.row(row), direction, own);
        self.onward.place[next] = self.place[row];
        if inward && own != GROUND {
            let t = self.chord(world, row, direction);
            self.onward.hits.set(next, t, own);
            self.onward.entry.set(next, self.surface.normal.row(row));
        } else {
            self.onward.hits.set(next, f64::INFINITY, MISS);
        }
    }

    /// [`Workspace::go_on`] for the paths in `lanes`; inside of a sphere, it goes on inside.
    #[inline(always)]
    pub fn go_on_row(
        &mut self,
        world: &World,
        (starts, lanes): (&Starts, u32),
        direction: row::Vec3<F32x16>,
    ) {
        let (packing, first) = (Packing::new(lanes), self.onward.rays.len());
        let place = starts.rows.map(|row| self.place[row as usize]);
        self.onward.rays.append_packed(&packing, (starts.at.point, direction), &starts.at.own);
        packing.store_numbers(&place, &mut self.onward.place[first..]);
        self.onward.hits.t[first..first + MAX_LANES].fill(f64::INFINITY);
        self.onward.hits.sphere[first..first + MAX_LANES].fill(MISS);
        for lane in set_bits(lanes & starts.inside) {
            let (own, row) = (starts.at.own[lane], starts.rows[lane] as usize);
            if own != GROUND {
                let next = first + (lanes & ((1 << lane) - 1)).count_ones() as usize;
                let direction = self.onward.rays.direction.row(next);
                let t = self.chord(world, row, direction);
                self.onward.hits.set(next, t, own);
                self.onward.entry.set(next, self.surface.normal.row(row));
            }
        }
    }

    /// Distance from the point of a sphere that `row` has hit, or of the sphere's cap, through the
    /// inside to where `direction` leaves the sphere.
    #[inline]
    pub fn chord(&self, world: &World, row: usize, direction: Vec3) -> f64 {
        if !world.cut.is_empty() {
            return self.chord_cut(world, row, direction);
        }
        let radius = f64::from(world.spheres.radius(self.hits.sphere[row] as usize));
        chord(self.surface.normal.row(row).into(), radius, direction.as_dvec3().into())
    }

    /// The same where spheres are cut; apart, so that it is not in the way elsewhere.
    #[cold]
    fn chord_cut(&self, world: &World, row: usize, direction: Vec3) -> f64 {
        let (center, radius) = world.spheres.exact(self.hits.sphere[row] as usize);
        let direction = direction.as_dvec3();
        if world.cut.divides(center, radius) {
            return far_end(self.surface.point.row(row).as_dvec3() - center, radius, direction);
        }
        chord(self.surface.normal.row(row).into(), radius, direction.into())
    }

    /// Turns to the paths that were sent on.
    pub fn advance(&mut self) {
        let onward = &mut self.onward;
        swap(&mut self.rays, &mut onward.rays);
        swap(&mut self.hits, &mut onward.hits);
        swap(&mut self.surface.normal, &mut onward.entry);
        swap(&mut self.place, &mut onward.place);
        onward.rays.truncate(0);
    }
}

impl Paths {
    /// Whether it is known which glass spheres paths are in.
    pub fn keeps_inside(&self) -> bool {
        self.nesting > 0
    }

    /// The glass spheres that the path in `place` is in.
    #[inline]
    pub fn inside(&mut self, place: usize) -> &mut [u32] {
        &mut self.inside[place * self.nesting..(place + 1) * self.nesting]
    }
}
