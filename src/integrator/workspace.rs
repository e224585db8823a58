//! The columns that a task works on: allocated once, used for tile after tile.

use super::bins::{Bins, ESCAPED, Rows};
use super::carried::{Carried, CarriedRow};
use super::caustics::Caustics;
use super::clock::Clock;
use super::counters::Counters;
use super::gather::Starts;
use super::looks::Looks;
use super::onward::{Onward, Segments};
use super::shadows::Shadows;
use super::skips::Skips;
use super::surface::{Surface, chord, far_end};
use crate::film::View;
use crate::lanes::{F32x16, MAX_LANES, Packing, U32x16, set_bits};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::sampling::{PathRow, PathState, PathStates, Sampler};
use crate::scene::Rgb;
use crate::vec3 as row;
use crate::world::World;
use glam::Vec3;
use std::mem::swap;
use std::ops::Range;

/// Paths that are followed together: 16 samples of each pixel of a tile. Of fewer, more rows of
/// lanes are half empty when most have ended: with 1024, scenes of a few spheres take 5 % longer,
/// with 512 12 %.
pub const BATCH: usize = 4096;

/// Rows of a column: with room for whole rows of lanes, and such that the columns do not all begin
/// in the same lines of the first-level cache.
pub(super) const ROWS: usize = BATCH + MAX_LANES;

/// How many glass spheres a path can be in at the same time.
const NESTING: usize = 16;

/// Everything that a task writes while it renders a tile.
///
/// Paths have a place, `0..BATCH`, that they keep from the camera to their end. Those that still go
/// on have a row in `rays`, `hits`, `surface` and `carried`; at each bounce they get new rows, in
/// the order in which they are shaded, so that there are no gaps, and like goes with like.
pub struct Workspace {
    /// Rows: the next segment of each path.
    pub rays: Rays,
    /// Rows: what it hits.
    pub hits: Hits,
    /// Rows: where it hits.
    pub surface: Surface,
    /// Rows: what its path takes along.
    pub carried: Carried,
    /// Places: the paths.
    pub paths: Paths,
    /// Rows by what they hit.
    pub bins: Bins,
    /// What the surfaces are made of, if there are few spheres.
    pub looks: Option<Looks>,
    /// The rows of the next bounce.
    pub(super) onward: Onward,
    /// Light that arrives if nothing is in between.
    pub shadows: Shadows,
    /// Who looks for light by way of balls.
    pub(super) caustics: Caustics,
    /// What the camera rays may hit.
    pub view: View,
    /// What was done.
    pub counters: Counters,
    /// How long it took.
    pub clock: Clock,
}

/// Paths, by place.
pub struct Paths {
    /// Light that has been found.
    pub radiance: Vec<Rgb>,
    /// Where in its sequence of samples the path is, with what it carries.
    pub states: PathStates,
    /// The glass spheres that the path is in: a fixed number of places for each path, none where it
    /// can be in one at most.
    inside: Vec<u32>,
    nesting: usize,
}

impl Workspace {
    /// Room for [`BATCH`] paths through `world`.
    pub fn new(world: &World, skips: Skips) -> Self {
        let normals = world.lights.by_receiver();
        let nesting = if skips.glass && !world.features.nested_glass { 0 } else { NESTING };
        Self {
            rays: Rays::with_capacity(BATCH),
            hits: Hits::with_capacity(BATCH),
            surface: Surface::with_rows(ROWS),
            carried: Carried::new(normals),
            paths: Paths {
                radiance: vec![Rgb::ZERO; BATCH],
                states: PathStates::with_paths(BATCH),
                inside: vec![MISS; BATCH * nesting],
                nesting,
            },
            bins: Bins::new(world, normals),
            looks: Looks::of(world, ESCAPED),
            onward: Onward::new(normals),
            shadows: Shadows::new(),
            caustics: Caustics::new(world),
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

    /// Gives rows the samples of the pixel in column `x` and row `y` from `first` on; where their
    /// rays start, column and row are left.
    pub(super) fn start(
        &mut self,
        sampler: &Sampler,
        (x, y, first): (u32, u32, u32),
        rows: Range<usize>,
    ) {
        for (row, first) in rows.clone().step_by(MAX_LANES).zip((first..).step_by(MAX_LANES)) {
            if rows.end - row >= MAX_LANES {
                let start = sampler.start_row(x, y, first);
                self.paths.states.set_row(row, &start);
                self.carried.start(row, &start.places);
                continue;
            }
            for (row, sample) in (row..rows.end).zip(first..) {
                let start = sampler.start(x, y, sample);
                self.paths.states.set(row, &start);
                self.carried.start_one(row, start.sobol());
            }
        }
        self.rays.origin.x[rows.clone()].fill(x as f32);
        self.rays.origin.y[rows].fill(y as f32);
    }

    /// Begins as many paths at the camera, which have been given their samples. The caller sets
    /// their rays.
    pub(super) fn begin(&mut self, count: usize) {
        self.rays.begin(count);
        self.hits.t[..count].fill(f64::INFINITY);
        self.hits.sphere[..count].fill(MISS);
        self.paths.radiance[..count].fill(Rgb::ZERO);
        let nesting = self.paths.nesting;
        self.paths.inside[..count * nesting].fill(MISS);
    }

    /// The state of the path in a row.
    pub(super) fn state(&self, row: usize) -> PathState {
        self.paths.states.state(self.carried.place(row), self.carried.number(row))
    }

    /// Sorts the rows by what they hit.
    pub(super) fn sort(&mut self, world: &World) {
        let Self { rays, hits, surface, carried, .. } = self;
        self.bins.sort(world, self.looks.as_ref(), &Rows { rays, hits, surface, carried });
    }

    /// Sends the paths in `lanes` on from the surfaces that they have hit, with what they take
    /// along: those inside of a sphere go on inside, and what they leave through is known. Paths
    /// that are not sent on end.
    #[inline(always)]
    pub(super) fn go_on(
        &mut self,
        world: &World,
        (starts, lanes): (&Starts, u32),
        direction: row::Vec3<F32x16>,
        carried: &CarriedRow,
    ) {
        let (origin, own) = (starts.at.point, &starts.at.own);
        let segments = Segments { origin, direction, own, carried };
        let first = self.onward.append(&Packing::new(lanes), &segments);
        for lane in set_bits(lanes & starts.inside) {
            let (own, row) = (starts.at.own[lane], starts.rows.to_array()[lane] as usize);
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
        swap(&mut self.carried, &mut onward.carried);
        onward.rays.truncate(0);
    }
}

impl Paths {
    /// Where in their sequences of samples a row of paths is.
    #[inline(always)]
    pub fn numbers(&self, carried: &CarriedRow) -> PathRow<'_> {
        PathRow::new(carried.numbers, carried.place, &self.states)
    }

    /// Gives light to the paths in `lanes`.
    #[inline(always)]
    pub fn add(&mut self, place: U32x16, light: row::Vec3<F32x16>, lanes: u32) {
        let place = place.to_array();
        let row::Vec3 { x, y, z } = light.map(F32x16::to_array);
        for lane in set_bits(lanes) {
            self.radiance[place[lane] as usize] += Rgb::new(x[lane], y[lane], z[lane]);
        }
    }

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
