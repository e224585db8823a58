//! Rows by what they hit.

use super::block::{Block, floats, row};
use super::carried::{Carried, CarriedRow};
use super::looks::Looks;
use super::surface::Surface;
use super::workspace::ROWS;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, Packing, U32x16, bits, first_lanes, set_bits};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::vec3::Vec3;
use crate::world::{Column, Kind, World};

/// Rows by the kind of what they hit, each bin's side by side; none of kinds that there are not.
pub struct Bins([Option<Box<Bin>>; Kind::COUNT]);

/// Rows that hit surfaces of the same kind.
pub struct Bin {
    len: usize,
    columns: Block<COLUMNS>,
    /// What the paths bring.
    pub carried: Carried,
    /// Sixteen rows to a number: whether the surface is seen from inside. Of glass, nothing.
    inside: [u16; ROWS / MAX_LANES],
}

/// Which rows of the rays they were.
const ROW: usize = 0;
/// The sphere, or the ground.
const HIT: usize = 1;
/// Where the rays go.
const DIRECTION: usize = 2;
/// The point that is hit.
const POINT: usize = 5;
/// The normal on the side that is looked at.
const FACING: usize = 8;
const COLUMNS: usize = 11;

/// What there is of each ray.
pub struct Rows<'a> {
    /// Where it starts and goes.
    pub rays: &'a Rays,
    /// What it hits.
    pub hits: &'a Hits,
    /// Where it hits.
    pub surface: &'a Surface,
    /// What its path brings.
    pub carried: &'a Carried,
}

/// Number of the bin of what escapes, which is none, after those of the kinds.
pub(super) const ESCAPED: usize = Kind::COUNT;

impl Bins {
    /// Bins for what is in a world; with room for normals of the last surfaces if `normals`.
    pub(super) fn new(world: &World, normals: bool) -> Self {
        Self(Kind::ALL.map(|kind| world.features.has(kind).then(|| Box::new(Bin::new(normals)))))
    }

    /// How many rows hit something.
    pub fn scattered(&self) -> u64 {
        self.0.iter().flatten().map(|bin| bin.len as u64).sum()
    }

    /// The rows that hit this kind, if there are any.
    pub fn of(&self, kind: Kind) -> Option<&Bin> {
        self.0[kind as usize].as_deref().filter(|bin| bin.len > 0)
    }

    /// The same to be kept apart, until they are put back.
    pub(super) fn take(&mut self, kind: Kind) -> Option<Box<Bin>> {
        self.0[kind as usize].take_if(|bin| bin.len > 0)
    }

    /// Puts back what was taken.
    pub(super) fn put(&mut self, kind: Kind, bin: Box<Bin>) {
        self.0[kind as usize] = Some(bin);
    }

    /// Sorts all rays by what they hit.
    pub(super) fn sort(&mut self, world: &World, looks: Option<&Looks>, rows: &Rows) {
        if let Some(looks) = looks {
            return self.sort_by(rows, |hits| looks.bins(hits));
        }
        let ground = world.ground.map_or(ESCAPED, |ground| ground.material.kind() as usize);
        let kinds = &world.features.spheres_by_kind;
        let mut present = (0..Kind::COUNT).filter(|&kind| kinds[kind] > 0);
        match (&world.appearance.material, present.next(), present.next()) {
            (Column::Rows(ids), _, Some(_)) if !ids.is_empty() => {
                let kind = |hit: u32| ids[(hit as usize).min(ids.len() - 1)].kind() as usize;
                self.sort_by(rows, |hits| each(hits, ground, kind));
            }
            (_, only, _) => {
                let only = only.unwrap_or(ESCAPED);
                self.sort_by(rows, |hits| each(hits, ground, |_| only));
            }
        }
    }

    /// The same; `bins` tells in which bins the rows are that hit this.
    #[inline(always)]
    fn sort_by(&mut self, rows: &Rows, bins: impl Fn(U32x16) -> U32x16) {
        self.0.iter_mut().flatten().for_each(|bin| bin.clear());
        let count = rows.rays.len();
        for start in (0..count).step_by(MAX_LANES) {
            let there = first_lanes(count - start);
            let hits = U32x16::new(*row(&rows.hits.sphere, start));
            let bins: F32x16 = bytemuck::cast(bins(hits));
            for (number, bin) in self.0.iter_mut().enumerate() {
                let Some(bin) = bin else { continue };
                let lanes = bins.has_bits_of(bits(number as u32)).bits() & there;
                if lanes != 0 {
                    bin.push(rows, (start, lanes), number);
                }
            }
        }
        self.0.iter_mut().flatten().for_each(|bin| bin.pad());
    }
}

/// In which bins rows are that hit this; `kind` tells the kinds of spheres, and anything of what is
/// none.
#[inline(always)]
fn each(hits: U32x16, ground: usize, kind: impl Fn(u32) -> usize) -> U32x16 {
    let mut bins = hits.to_array();
    for bin in &mut bins {
        let hit = *bin;
        let kind = if hit == GROUND { ground } else { kind(hit) };
        *bin = if hit == MISS { ESCAPED } else { kind } as u32;
    }
    U32x16::new(bins)
}

impl Bin {
    fn new(normals: bool) -> Self {
        Self {
            len: 0,
            columns: Block::default(),
            carried: Carried::new(normals),
            inside: [0; ROWS / MAX_LANES],
        }
    }

    /// Sixteen rows at a time: where they start, and which of them there are.
    pub fn rows(&self) -> impl Iterator<Item = (usize, u32)> + use<> {
        let len = self.len;
        (0..len).step_by(MAX_LANES).map(move |start| (start, first_lanes(len - start)))
    }

    /// Which rows of the rays they were.
    pub fn each(&self) -> impl Iterator<Item = usize> {
        (0..self.len).map(|i| self.columns.number(ROW, i) as usize)
    }

    /// Which row of the rays row `i` was.
    pub fn ray(&self, i: usize) -> usize {
        self.columns.number(ROW, i) as usize
    }

    /// What row `i` hits.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> u32 {
        self.columns.number(HIT, i)
    }

    /// Which rows of the rays sixteen were.
    #[inline(always)]
    pub fn ray_row(&self, start: usize) -> U32x16 {
        self.columns.numbers(ROW, start)
    }

    /// What sixteen rows hit.
    #[inline(always)]
    pub fn hit_row(&self, start: usize) -> U32x16 {
        self.columns.numbers(HIT, start)
    }

    /// Where the rays of sixteen rows go.
    #[inline(always)]
    pub fn direction_row(&self, start: usize) -> Vec3<F32x16> {
        self.columns.vectors(DIRECTION, start)
    }

    /// The points that sixteen rows hit.
    #[inline(always)]
    pub fn point_row(&self, start: usize) -> Vec3<F32x16> {
        self.columns.vectors(POINT, start)
    }

    /// The normals there, on the sides that are looked at.
    #[inline(always)]
    pub fn facing_row(&self, start: usize) -> Vec3<F32x16> {
        self.columns.vectors(FACING, start)
    }

    /// Which of rows `start..start + 16`, `start` being a multiple of that, are seen from inside.
    #[inline(always)]
    pub fn inside(&self, start: usize) -> u32 {
        u32::from(self.inside[start / MAX_LANES])
    }

    /// What sixteen paths bring.
    #[inline(always)]
    pub fn carried_row(&self, start: usize) -> CarriedRow {
        self.carried.load(start)
    }

    fn clear(&mut self) {
        self.inside[..self.len.div_ceil(MAX_LANES)].fill(0);
        self.len = 0;
    }

    /// Appends some of sixteen rows.
    #[inline(always)]
    fn push(&mut self, rows: &Rows, (start, lanes): (usize, u32), kind: usize) {
        let (packing, first) = (Packing::new(lanes), self.len);
        let inside = rows.surface.inside(start) & lanes;
        if inside != 0 && kind != Kind::Dielectric as usize {
            for lane in set_bits(inside) {
                let row = first + (lanes & ((1 << lane) - 1)).count_ones() as usize;
                self.inside[row / MAX_LANES] |= 1 << (row % MAX_LANES);
            }
        }
        let number = U32x16::new(std::array::from_fn(|lane| (start + lane) as u32));
        let hit = U32x16::new(*row(&rows.hits.sphere, start));
        let direction = rows.rays.direction.load(start).map(floats);
        let point = rows.surface.point.load(start).map(floats);
        let facing = rows.surface.facing.load(start).map(floats);
        let rest = rows.carried.load(start);
        self.columns.pack((ROW, first), &packing, [number, hit]);
        self.columns.pack((DIRECTION, first), &packing, [direction.x, direction.y, direction.z]);
        self.columns.pack((POINT, first), &packing, [point.x, point.y, point.z]);
        self.columns.pack((FACING, first), &packing, [facing.x, facing.y, facing.z]);
        self.carried.pack(first, &packing, &rest);
        self.len += packing.count();
    }

    /// Lets the rest of the last sixteen rows hit what is there.
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
