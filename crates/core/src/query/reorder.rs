//! The order in which rays are traced: those that start and go alike come one after another.
//!
//! Rays in no order miss the caches at every step, and no packet can be made of them. So they are sorted by a
//! coarse cell of their origins, then by direction, then by a finer cell (Moon et al., "Cache-Oblivious Ray
//! Reordering", ACM Transactions on Graphics 2010). Rays that come in some order, as those of pixels do, stay in
//! it: a sample of neighbors tells. Answers do not depend on the order.

use super::SphereTree;
use super::chunk::{ChunkRays, RayPacket, Rows};
use super::columns::RayTable;
use crate::lanes::{F32x16, Lanes, MAX_LANES, U32x16, columns_of, truncated};
use crate::radix::{DIGIT, sort_by_digits, spaced};
use std::cell::Cell;
use std::ops::Range;

/// Number of rays that are sorted together.
pub(super) const SORTED_RAYS: usize = 1 << 18;

/// Fewer rays are not worth a look.
const FEW: usize = 1 << 10;

/// A tree and spheres of no more bytes stay in the caches whatever the order of rays.
const CACHED: usize = 1 << 20;

/// Number of rays that are looked at to tell whether rays are in some order.
const SAMPLES: usize = 256;

/// Rays are in no order if neighbors are more than this part as far apart as any two rays are.
const DISORDER: f32 = 1.0 / 8.0;

/// A ray in one line of cache.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
struct Record {
    origin: [f32; 3],
    direction: [f32; 3],
    /// The distance at which its search ends.
    bound: f64,
}

/// A batch of rays, and the order in which they are traced. Kept from batch to batch for its memory.
pub(super) struct SortedRays {
    /// In the caller's order.
    records: Vec<Record>,
    /// In the order of the curve: the place on it, and below the place in `records`.
    keys: Vec<u64>,
    /// The records of a chunk in that order: gathered by a loop of their own, whose cache misses overlap.
    gathered: Vec<Record>,
    /// Memory for sorting.
    spare: Vec<u64>,
    /// The caller's row of the first record.
    first: usize,
}

/// Some sorted rays.
pub(super) struct Sorted<'a> {
    records: &'a [Record],
    keys: &'a [u64],
    first: usize,
}

thread_local! {
    /// Memory of the last call on this thread: the system takes longer to give new one than sorting does.
    static KEPT: Cell<SortedRays> = const { Cell::new(SortedRays::NONE) };
}

impl SortedRays {
    const NONE: Self = Self {
        records: Vec::new(),
        keys: Vec::new(),
        gathered: Vec::new(),
        spare: Vec::new(),
        first: 0,
    };

    /// No rays, with the memory of the last call on this thread.
    pub(super) fn taken() -> Self {
        KEPT.replace(Self::NONE)
    }

    /// Keeps the memory for the next call on this thread.
    pub(super) fn give_back(self) {
        KEPT.set(self);
    }

    /// The rays in some places of the order.
    pub(super) fn chunk(&mut self, places: Range<usize>) -> Sorted<'_> {
        let keys = &self.keys[places];
        self.gathered.clear();
        self.gathered.extend(keys.iter().map(|&key| self.records[place(key)]));
        Sorted { records: &self.gathered, keys, first: self.first }
    }
}

/// Returns the place in the caller's order.
#[inline(always)]
fn place(key: u64) -> usize {
    key as u32 as usize
}

impl ChunkRays for Sorted<'_> {
    fn len(&self) -> usize {
        self.keys.len()
    }

    #[inline(always)]
    fn row(&self, k: usize) -> usize {
        self.first + place(self.keys[k])
    }

    #[inline(always)]
    fn packet(&self, first: usize, _: &[f64]) -> RayPacket {
        const NONE: Record = Record { origin: [0.0; 3], direction: [1.0; 3], bound: f64::NAN };
        let mut records = [NONE; MAX_LANES];
        let count = MAX_LANES.min(self.records.len() - first);
        records[..count].copy_from_slice(&self.records[first..first + count]);
        let [x, y, z, dx, dy, dz, ..] = columns_of(bytemuck::cast_ref(&records));
        let bound = records.map(|record| record.bound);
        RayPacket { origin: [x, y, z], direction: [dx, dy, dz], bound }
    }
}

/// The curve on which rays have a place by where they start and where they go.
struct Curve {
    /// The least coordinates of most origins.
    low: [f32; 3],
    /// Cells of origins for one unit of length.
    cells: f32,
    /// Whether origins are so far apart that they count.
    spread_out: bool,
}

impl SphereTree {
    /// Sorts rays by the order in which they are traced fastest. Returns whether that is another than theirs.
    pub(super) fn sort_rays<T: RayTable>(
        &self,
        rows: &Rows<T>,
        bounds: &[f64],
        sorted: &mut SortedRays,
    ) -> bool {
        if rows.len() < FEW || self.bvh.len() <= 1 {
            return false;
        }
        let Some(curve) = self.curve(rows.table, rows.rows.clone()) else { return false };
        sorted.first = rows.rows.start;
        sorted.records.clear();
        sorted.keys.clear();
        for first in (0..rows.len()).step_by(MAX_LANES) {
            let packet = rows.packet(first, bounds);
            let codes = curve.codes(&packet);
            let count = MAX_LANES.min(rows.len() - first);
            let keys = codes.to_array().into_iter().zip(first as u64..);
            sorted.keys.extend(keys.take(count).map(|(code, place)| u64::from(code) << 32 | place));
            sorted.records.extend((0..count).map(|lane| {
                let (origin, direction) = rows.table.row(rows.row(first + lane));
                Record { origin, direction, bound: packet.bound[lane] }
            }));
        }
        sort_by_digits(&mut sorted.keys, &mut sorted.spare, u32::BITS, Curve::BITS.div_ceil(DIGIT));
        true
    }

    /// Returns the curve along which rays are sorted; `None` if they are in some order, or if it does not matter.
    fn curve(&self, table: &impl RayTable, rows: Range<usize>) -> Option<Curve> {
        let sampled = |k: usize| rows.start + k * (rows.len() - 1) / SAMPLES;
        // Pairs of neighbors, and of rays that have nothing to do with each other.
        let near = |k: usize| (sampled(k), sampled(k) + 1);
        let far = |k: usize| (sampled(k), sampled((k + SAMPLES / 3) % SAMPLES));
        let apart = |of: &dyn Fn(usize) -> [f32; 3], pair: &dyn Fn(usize) -> (usize, usize)| {
            let mut distances = [0.0; SAMPLES];
            for (k, distance) in distances.iter_mut().enumerate() {
                let (a, b) = pair(k);
                let (a, b) = (of(a), of(b));
                *distance = (0..3).map(|axis| (a[axis] - b[axis]).abs()).fold(0.0, f32::max);
            }
            *distances.select_nth_unstable_by(SAMPLES / 2, f32::total_cmp).1
        };
        let origin = |i: usize| table.row(i).0;
        let direction = |i: usize| on_cube(table.row(i).1);
        // The size of a leaf tells what is near, as for packets; the tree's coordinates are up to 1.
        let leaf = self.bvh.mean_leaf_extent();
        let origins = [apart(&origin, &near), apart(&origin, &far)];
        let directions = [apart(&direction, &near), apart(&direction, &far)];
        let is_disorder = |[near, far]: [f32; 2]| near > DISORDER * far;
        let spread_out = f64::from(origins[1]) * self.scale[0] > f64::from(leaf);
        let fanned_out = directions[1] > leaf;
        let pays = if spread_out {
            is_disorder(origins) && (!fanned_out || self.bytes() > CACHED)
        } else {
            fanned_out && is_disorder(directions)
        };
        if !pays {
            return None;
        }
        // Most origins: a few that are far away do not make the cells larger.
        let bounds = [0, 1, 2].map(|axis| {
            let mut values = [0.0; SAMPLES];
            (0..SAMPLES).for_each(|k| values[k] = origin(sampled(k))[axis]);
            values.sort_unstable_by(f32::total_cmp);
            [values[SAMPLES / 32], values[SAMPLES - 1 - SAMPLES / 32]]
        });
        let width = bounds.iter().map(|[low, high]| high - low).fold(f32::MIN_POSITIVE, f32::max);
        let cells = (1 << Curve::CELL) as f32 / width;
        Some(Curve { low: bounds.map(|[low, _]| low), cells, spread_out })
    }
}

impl Curve {
    /// Bits of a code.
    const BITS: u32 = 32;
    /// Bits of a cell of origins on each axis.
    const CELL: u32 = Self::COARSE + 3;
    /// The highest of these bits, which come before the direction.
    const COARSE: u32 = 4;
    /// Bits of directions on each axis, where origins count as well.
    const DIRECTION: u32 = 4;
    /// Bits of directions on each axis, where origins do not count.
    const FINE_DIRECTION: u32 = 10;

    /// The places of rays on the curve; any for one that is not finite.
    #[inline(always)]
    fn codes(&self, packet: &RayPacket) -> U32x16 {
        let [x, y, z] = packet.direction.map(Lanes::abs);
        let inverse = F32x16::splat(1.0) / Lanes::max(Lanes::max(x, y), z);
        let along = |bits: u32| {
            let half = F32x16::splat((1 << (bits - 1)) as f32);
            on_curve(packet.direction.map(|x| (x * inverse + F32x16::splat(1.0)) * half), bits)
        };
        if !self.spread_out {
            return along(Self::FINE_DIRECTION);
        }
        let cells = F32x16::splat(self.cells);
        let place = std::array::from_fn(|axis| {
            (packet.origin[axis] - F32x16::splat(self.low[axis])) * cells
        });
        let cell = on_curve(place, Self::CELL);
        // One bit of the finer cell has no room.
        let fine = 3 * (Self::CELL - Self::COARSE) - 1;
        let (coarse, finer) =
            (cell >> (fine + 1), (cell >> 1_u32) & U32x16::splat((1 << fine) - 1));
        (((coarse << (3 * Self::DIRECTION)) | along(Self::DIRECTION)) << fine) | finer
    }
}

/// The direction to where it meets the cube from -1 to 1.
fn on_cube(direction: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = direction.map(f32::abs);
    let inverse = 1.0 / x.max(y).max(z);
    direction.map(|x| x * inverse)
}

/// The places on the Morton curve of points in the cube from 0 to `2^bits`, or of the nearest in it.
#[inline(always)]
fn on_curve(point: [F32x16; 3], bits: u32) -> U32x16 {
    let last = F32x16::splat(((1 << bits) - 1) as f32);
    let [x, y, z] = point.map(|x| spaced(truncated(x.min(last))));
    (x << 2_u32) | (y << 1_u32) | z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::RayColumns;
    use crate::random::Random;

    /// Number of spheres of a tree that the caches do not hold.
    const MANY: usize = 60_000;

    fn tree(count: usize) -> SphereTree {
        let mut random = Random::new(1);
        let mut sphere = || [random.single(), random.single(), random.single(), 1e-3];
        let rows: Vec<_> = (0..count).map(|_| sphere()).collect();
        SphereTree::from_rows(&rows).expect("few spheres")
    }

    /// Six columns: of rays along a grid of 64 x 64, or in no order; from points or from one; that go apart or not.
    fn rays(shuffled: bool, one_origin: bool, one_direction: bool) -> [Vec<f32>; 6] {
        let mut random = Random::new(2);
        let mut columns = [const { Vec::new() }; 6];
        for i in 0..4096 {
            let i = if shuffled { random.index(4096) } else { i };
            let at = |x: usize| x as f32 / 64.0;
            let origin = if one_origin { [0.0, 0.0, 3.0] } else { [at(i % 64), at(i / 64), 1.0] };
            let direction =
                if one_direction { [0.1, 0.2, -1.0] } else { [at(i % 64), at(i / 64), -2.0] };
            let ray = origin.into_iter().chain(direction);
            columns.iter_mut().zip(ray).for_each(|(column, x)| column.push(x));
        }
        columns
    }

    #[test]
    fn rays_in_no_order_are_sorted_where_it_pays() {
        let (small, large) = (tree(1000), tree(MANY));
        let cases = [
            (&small, true, true, false, true),
            (&small, true, false, true, true),
            (&small, true, false, false, false),
            (&large, true, false, false, true),
            (&large, true, true, true, false),
            (&small, false, true, false, false),
            (&large, false, false, true, false),
            (&large, false, false, false, false),
        ];
        for (tree, shuffled, one_origin, one_direction, expected) in cases {
            let [x, y, z, dx, dy, dz] = rays(shuffled, one_origin, one_direction);
            let columns = RayColumns { origin: [&x, &y, &z], direction: [&dx, &dy, &dz] };
            let mut sorted = SortedRays::NONE;
            let bounds = vec![1.0; x.len()];
            let all = Rows { table: &columns, rows: 0..x.len() };
            let case = (tree.len(), shuffled, one_origin, one_direction);
            assert_eq!(tree.sort_rays(&all, &bounds, &mut sorted), expected, "{case:?}");
            if !expected {
                continue;
            }
            // Each ray once, and neighbors are near.
            let mut rows: Vec<_> = sorted.keys.iter().map(|&key| place(key)).collect();
            let apart = |pair: &[usize]| {
                (dx[pair[0]] - dx[pair[1]]).abs().max((x[pair[0]] - x[pair[1]]).abs())
            };
            let mean = rows.windows(2).map(apart).sum::<f32>() / rows.len() as f32;
            assert!(mean < 0.1, "{mean} {case:?}");
            rows.sort_unstable();
            assert!(rows.into_iter().eq(0..x.len()));
        }
    }
}
