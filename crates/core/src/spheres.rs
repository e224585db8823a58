//! Spheres in columns: centers and radii in single precision, in blocks of [`LEAF`] rows.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Spheres of a block, which is a leaf of the tree: one row of lanes for each column.
pub const LEAF: usize = 8;

/// Number of rows that are worth a task.
const TASK: usize = 1 << 12;

/// The columns of [`LEAF`] spheres side by side, so that a leaf is two lines of cache.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SphereBlock {
    /// Centers, x.
    pub x: [f32; LEAF],
    /// Centers, y.
    pub y: [f32; LEAF],
    /// Centers, z.
    pub z: [f32; LEAF],
    /// Radii, more than 0; NaN where there is no sphere, which no ray hits.
    pub radius: [f32; LEAF],
}

impl SphereBlock {
    const EMPTY: Self =
        Self { x: [0.0; LEAF], y: [0.0; LEAF], z: [0.0; LEAF], radius: [f32::NAN; LEAF] };
}

/// The spheres: row `i` is lane `i % LEAF` of block `i / LEAF`, and row `i` of the other columns.
#[derive(Clone, Debug, Default)]
pub struct Spheres {
    /// Centers and radii. The last block may have room left.
    blocks: Vec<SphereBlock>,
    /// Place in the user's order; rows are permuted when the tree is built. Of two spheres at the same
    /// distance the one with the lower id is hit.
    pub id: Vec<u32>,
    /// Exact centers and radii, if the single-precision columns cannot hold them; empty otherwise.
    pub precise: Vec<(DVec3, f64)>,
    /// True if it is known that all centers are [coarse](crate::vec3::Vec3::is_coarse).
    pub coarse: bool,
}

impl Spheres {
    /// The most spheres there can be: the last few numbers of 32 bits mean something else.
    pub const MAX: usize = (u32::MAX - 16) as usize;

    /// Returns spheres in the given order, which becomes their id.
    ///
    /// # Panics
    /// If the columns differ in length.
    pub fn from_columns(x: &[f32], y: &[f32], z: &[f32], radius: &[f32]) -> Self {
        let mut spheres = Self::with_capacity(radius.len());
        for i in 0..radius.len() {
            spheres.push(Vec3::new(x[i], y[i], z[i]), radius[i], i as u32);
        }
        spheres
    }

    /// Returns no spheres, with capacity for `count`.
    pub fn with_capacity(count: usize) -> Self {
        Self {
            blocks: Vec::with_capacity(count.div_ceil(LEAF)),
            id: Vec::with_capacity(count),
            precise: Vec::new(),
            coarse: false,
        }
    }

    /// Returns `count` spheres; `row` gives center and radius, and the id. `precise` stays empty.
    pub fn from_rows(count: usize, row: impl Fn(usize) -> ([f32; 4], u32) + Sync) -> Self {
        let block = |first: usize| {
            let mut block = SphereBlock::EMPTY;
            for lane in 0..LEAF.min(count - first * LEAF) {
                let [x, y, z, radius] = row(first * LEAF + lane).0;
                (block.x[lane], block.y[lane], block.z[lane]) = (x, y, z);
                block.radius[lane] = radius;
            }
            block
        };
        let rows = |count: usize| (0..count).into_par_iter().with_min_len(TASK);
        Self {
            blocks: rows(count.div_ceil(LEAF)).map(block).collect(),
            id: rows(count).map(|i| row(i).1).collect(),
            precise: Vec::new(),
            coarse: false,
        }
    }

    /// Returns the spheres of blocks, with the ids of their rows; `None` if a row has no sphere, or one that is not finite, or
    /// if rows are left over.
    pub fn from_blocks(blocks: Vec<SphereBlock>, id: Vec<u32>) -> Option<Self> {
        if blocks.len() != id.len().div_ceil(LEAF) {
            return None;
        }
        let spheres = Self { blocks, id, precise: Vec::new(), coarse: false };
        let is_sphere = |row: usize| {
            let radius = spheres.radius(row);
            spheres.center(row).is_finite() && radius > 0.0 && radius < f32::INFINITY
        };
        let rows = spheres.len();
        let unused = rows..spheres.blocks.len() * LEAF;
        let right =
            (0..rows).all(is_sphere) && unused.into_iter().all(|row| spheres.radius(row).is_nan());
        right.then_some(spheres)
    }

    /// Appends a sphere.
    #[inline]
    pub fn push(&mut self, center: Vec3, radius: f32, id: u32) {
        let lane = self.id.len() % LEAF;
        if lane == 0 {
            self.blocks.push(SphereBlock::EMPTY);
        }
        if let Some(block) = self.blocks.last_mut() {
            (block.x[lane], block.y[lane], block.z[lane]) = center.into();
            block.radius[lane] = radius;
        }
        self.id.push(id);
    }

    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// The blocks.
    #[inline(always)]
    pub fn blocks(&self) -> &[SphereBlock] {
        &self.blocks
    }

    /// The center of sphere `i`.
    #[inline(always)]
    pub fn center(&self, i: usize) -> Vec3 {
        let (block, lane) = (&self.blocks[i / LEAF], i % LEAF);
        Vec3::new(block.x[lane], block.y[lane], block.z[lane])
    }

    /// The radius of sphere `i`.
    #[inline(always)]
    pub fn radius(&self, i: usize) -> f32 {
        self.blocks[i / LEAF].radius[i % LEAF]
    }

    /// Center and radius of sphere `i` for the exact test.
    #[inline(always)]
    pub fn exact(&self, i: usize) -> (DVec3, f64) {
        match self.precise.get(i) {
            Some(&sphere) => sphere,
            None => (self.center(i).as_dvec3(), f64::from(self.radius(i))),
        }
    }

    /// Center and radius of sphere `i` in bits: equal for spheres that coincide, and in an order that
    /// does not depend on rows.
    pub fn key(&self, i: usize) -> ([u32; 3], u32) {
        (self.center(i).to_array().map(f32::to_bits), self.radius(i).to_bits())
    }

    /// Returns, for each of some spheres, the one that is hit in its place: of spheres that coincide, the
    /// first in the user's order. Sorted by [`Spheres::key`], without repetition; some may not be among
    /// the given rows.
    pub fn first_of_equals(&self, rows: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut firsts: Vec<_> = rows.map(|row| (self.key(row as usize), row)).collect();
        if firsts.is_empty() {
            return Vec::new();
        }
        firsts.sort_unstable();
        firsts.dedup_by_key(|first| first.0);
        for i in 0..self.len() {
            if let Ok(place) = firsts.binary_search_by_key(&self.key(i), |first| first.0)
                && self.id[i] < self.id[firsts[place].1 as usize]
            {
                firsts[place].1 = i as u32;
            }
        }
        firsts.into_iter().map(|first| first.1).collect()
    }

    /// Returns the rows of spheres that coincide with one that comes before them in the user's order, ascending.
    pub fn later_of_equals(&self) -> Vec<u32> {
        let key = |row: u32| {
            let (center, radius) = self.exact(row as usize);
            // Zeros of both signs are equal.
            [center.x, center.y, center.z, radius].map(|number| (number + 0.0).to_bits())
        };
        let hash = |row: u32| {
            let multiply = |hash: u64, word: u64| {
                (hash.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            };
            key(row).into_iter().fold(0, multiply)
        };
        let mut rows: Vec<(u64, u32)> =
            (0..self.len() as u32).into_par_iter().map(|row| (hash(row), row)).collect();
        rows.par_sort_unstable();
        let mut later = Vec::new();
        for equal in rows.chunk_by(|a, b| a.0 == b.0).filter(|rows| rows.len() > 1) {
            let mut equal: Vec<u32> = equal.iter().map(|&(_, row)| row).collect();
            equal.sort_unstable_by_key(|&row| (key(row), self.id[row as usize]));
            later.extend(
                equal.windows(2).filter(|pair| key(pair[0]) == key(pair[1])).map(|pair| pair[1]),
            );
        }
        later.sort_unstable();
        later
    }

    /// Bytes that the columns occupy.
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice())
            + size_of_val(self.id.as_slice())
            + size_of_val(self.precise.as_slice())
    }
}
