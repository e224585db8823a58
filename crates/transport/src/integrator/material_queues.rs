//! Material queues: hits sorted by kind of material, so that a kernel shades hits of one kind.

use super::columns::{LaneRows, ROWS, WordColumns, float_bits, row};
use super::material_table::MaterialTable;
use super::path_state::{PathStateRow, PathStates};
use super::surface::SurfaceColumns;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, Packing, U32x16, bits, first_lanes, set_bits};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::shade::MaterialKind;
use crate::vec3::Vec3;
use crate::world::{Column, World};

/// Hits by kind of material, one queue per kind; `None` for kinds that the world does not have.
pub struct MaterialQueues([Option<Box<MaterialQueue>>; MaterialKind::COUNT]);

/// Hits on surfaces of one kind of material, in columns.
pub struct MaterialQueue {
    len: usize,
    columns: WordColumns<COLUMNS>,
    /// States of the paths.
    pub states: PathStates,
    /// One bit per row, set if the surface is hit from inside.
    inside: [u16; ROWS / MAX_LANES],
}

/// Row of the ray.
const ROW: usize = 0;
/// Row of the sphere, or [`GROUND`].
const HIT: usize = 1;
/// Direction of the ray.
const DIRECTION: usize = 2;
/// Point of the hit.
const POINT: usize = 5;
/// Normal on the side that the ray comes from.
const FACING: usize = 8;
const COLUMNS: usize = 11;

/// The columns of a bounce, from which queues are filled.
pub struct HitColumns<'a> {
    /// Origins and directions.
    pub rays: &'a Rays,
    /// Hits of the rays.
    pub hits: &'a Hits,
    /// Points and normals of the hits.
    pub surface: &'a SurfaceColumns,
    /// States of the paths.
    pub states: &'a PathStates,
}

/// Queue number of rays that hit nothing, after those of the kinds; such a queue does not exist.
pub(super) const ESCAPED: usize = MaterialKind::COUNT;

impl MaterialQueues {
    /// Creates queues for the materials of a world, with columns for normals of the last surfaces if
    /// `normals`.
    pub(super) fn new(world: &World, normals: bool) -> Self {
        Self(
            MaterialKind::ALL.map(|kind| {
                world.features.has(kind).then(|| Box::new(MaterialQueue::new(normals)))
            }),
        )
    }

    /// Returns the number of rays that hit something.
    pub fn hit_count(&self) -> u64 {
        self.0.iter().flatten().map(|queue| queue.len as u64).sum()
    }

    /// Returns the queue of a kind, `None` if it is empty.
    pub fn of(&self, kind: MaterialKind) -> Option<&MaterialQueue> {
        self.0[kind as usize].as_deref().filter(|queue| queue.len > 0)
    }

    /// Takes a queue out, so that the workspace can be written while it is read; `None` if it is empty.
    pub(super) fn take(&mut self, kind: MaterialKind) -> Option<Box<MaterialQueue>> {
        self.0[kind as usize].take_if(|queue| queue.len > 0)
    }

    /// Puts back a queue that was taken.
    pub(super) fn put(&mut self, kind: MaterialKind, queue: Box<MaterialQueue>) {
        self.0[kind as usize] = Some(queue);
    }

    /// Sorts all rays into queues by what they hit.
    pub(super) fn sort(
        &mut self,
        world: &World,
        table: Option<&MaterialTable>,
        columns: &HitColumns,
    ) {
        if let Some(table) = table {
            return self.sort_by(columns, |hits| table.queues_of(hits));
        }
        let ground = world.ground.map_or(ESCAPED, |ground| ground.material.kind() as usize);
        let bodies = |kind: &MaterialKind| world.features.bodies_of(*kind) > 0;
        let mut present = MaterialKind::ALL.into_iter().filter(bodies);
        match (&world.appearance.material, present.next(), present.next()) {
            (Column::Rows(ids), _, Some(_)) if !ids.is_empty() => {
                let kind = |hit: u32| ids[(hit as usize).min(ids.len() - 1)].kind() as usize;
                self.sort_by(columns, |hits| queue_numbers(hits, ground, kind));
            }
            (_, only, _) => {
                let only = only.map_or(ESCAPED, |kind| kind as usize);
                self.sort_by(columns, |hits| queue_numbers(hits, ground, |_| only));
            }
        }
    }

    /// Sorts all rays into queues; `queue_of` returns the queue numbers of a row of hits.
    #[inline(always)]
    fn sort_by(&mut self, columns: &HitColumns, queue_of: impl Fn(U32x16) -> U32x16) {
        self.0.iter_mut().flatten().for_each(|queue| queue.clear());
        let count = columns.rays.len();
        for first in (0..count).step_by(MAX_LANES) {
            let there = first_lanes(count - first);
            let hits = U32x16::new(*row(&columns.hits.sphere, first));
            let queues: F32x16 = bytemuck::cast(queue_of(hits));
            for (number, queue) in self.0.iter_mut().enumerate() {
                let Some(queue) = queue else { continue };
                let lanes = queues.has_bits_of(bits(number as u32)).bits() & there;
                if lanes != 0 {
                    queue.push(columns, LaneRows { first, lanes });
                }
            }
        }
        self.0.iter_mut().flatten().for_each(|queue| queue.pad());
    }
}

/// Moves the bits of lanes together, as [`Packing`] moves the lanes.
#[inline(always)]
fn pack_bits(bits: u32, lanes: u32) -> u32 {
    if lanes & (lanes + 1) == 0 {
        return bits;
    }
    let place = |lane: usize| (lanes & ((1 << lane) - 1)).count_ones();
    set_bits(bits).fold(0, |packed, lane| packed | 1 << place(lane))
}

/// Returns the queue numbers of a row of hits. `kind` returns the kind of a body, and anything for
/// other rows.
#[inline(always)]
fn queue_numbers(hits: U32x16, ground: usize, kind: impl Fn(u32) -> usize) -> U32x16 {
    let mut queues = hits.to_array();
    for queue in &mut queues {
        let hit = *queue;
        let kind = if hit == GROUND { ground } else { kind(hit) };
        *queue = if hit == MISS { ESCAPED } else { kind } as u32;
    }
    U32x16::new(queues)
}

impl MaterialQueue {
    fn new(normals: bool) -> Self {
        Self {
            len: 0,
            columns: WordColumns::default(),
            states: PathStates::new(normals),
            inside: [0; ROWS / MAX_LANES],
        }
    }

    /// Iterates over the hits, sixteen at a time, with the lanes that are valid.
    pub fn rows(&self) -> impl Iterator<Item = LaneRows> + use<> {
        let len = self.len;
        let starts = (0..len).step_by(MAX_LANES);
        starts.map(move |first| LaneRows { first, lanes: first_lanes(len - first) })
    }

    /// Iterates over the rows of the rays.
    pub fn ray_rows(&self) -> impl Iterator<Item = usize> {
        (0..self.len).map(|i| self.columns.word(ROW, i) as usize)
    }

    /// Returns the row of ray `i`.
    pub fn ray(&self, i: usize) -> usize {
        self.columns.word(ROW, i) as usize
    }

    /// Returns the sphere of hit `i`, or [`GROUND`].
    #[inline(always)]
    pub fn hit(&self, i: usize) -> u32 {
        self.columns.word(HIT, i)
    }

    /// Returns the rows of sixteen rays.
    #[inline(always)]
    pub fn ray_row(&self, start: usize) -> U32x16 {
        self.columns.words(ROW, start)
    }

    /// Returns the spheres of sixteen hits.
    #[inline(always)]
    pub fn hit_row(&self, start: usize) -> U32x16 {
        self.columns.words(HIT, start)
    }

    /// Returns the directions of sixteen rays.
    #[inline(always)]
    pub fn direction_row(&self, start: usize) -> Vec3<F32x16> {
        self.columns.vectors(DIRECTION, start)
    }

    /// Returns the points of sixteen hits.
    #[inline(always)]
    pub fn point_row(&self, start: usize) -> Vec3<F32x16> {
        self.columns.vectors(POINT, start)
    }

    /// Returns the normals of sixteen hits, on the sides that the rays come from.
    #[inline(always)]
    pub fn facing_row(&self, start: usize) -> Vec3<F32x16> {
        self.columns.vectors(FACING, start)
    }

    /// Returns a mask of the hits `start..start + 16` that are seen from inside; `start` is a multiple
    /// of 16.
    #[inline(always)]
    pub fn inside(&self, start: usize) -> u32 {
        u32::from(self.inside[start / MAX_LANES])
    }

    /// Returns the states of sixteen paths.
    #[inline(always)]
    pub fn state_row(&self, start: usize) -> PathStateRow {
        self.states.load(start)
    }

    fn clear(&mut self) {
        self.inside[..self.len.div_ceil(MAX_LANES)].fill(0);
        self.len = 0;
    }

    /// Appends some of sixteen rows.
    #[inline(always)]
    fn push(&mut self, columns: &HitColumns, rows: LaneRows) {
        let LaneRows { first: start, lanes } = rows;
        let (packing, first) = (Packing::new(lanes), self.len);
        let inside = columns.surface.inside(start) & lanes;
        if inside != 0 {
            self.set_inside(first, pack_bits(inside, lanes));
        }
        let number = U32x16::new(std::array::from_fn(|lane| (start + lane) as u32));
        let hit = U32x16::new(*row(&columns.hits.sphere, start));
        let direction = columns.rays.direction.load(start).map(float_bits);
        let point = columns.surface.point.load(start).map(float_bits);
        let facing = columns.surface.facing.load(start).map(float_bits);
        let rest = columns.states.load(start);
        self.columns.pack(ROW, first, &packing, [number, hit]);
        self.columns.pack(DIRECTION, first, &packing, [direction.x, direction.y, direction.z]);
        self.columns.pack(POINT, first, &packing, [point.x, point.y, point.z]);
        self.columns.pack(FACING, first, &packing, [facing.x, facing.y, facing.z]);
        self.states.pack(first, &packing, &rest);
        self.len += packing.count();
    }

    /// Marks hits from `first` on, at most sixteen, that are seen from inside.
    fn set_inside(&mut self, first: usize, inside: u32) {
        let bits = inside << (first % MAX_LANES);
        self.inside[first / MAX_LANES] |= bits as u16;
        if let Some(next) = self.inside.get_mut(first / MAX_LANES + 1) {
            *next |= (bits >> MAX_LANES) as u16;
        }
    }

    /// Pads the last row of sixteen with copies of the last hit's sphere, so that kernels read valid
    /// rows.
    fn pad(&mut self) {
        if let Some(last) = self.len.checked_sub(1) {
            let hit = self.hit(last);
            for row in self.len..self.len.next_multiple_of(MAX_LANES) {
                self.columns.set(HIT, row, hit);
            }
        }
    }
}

#[cfg(test)]
mod tests;
