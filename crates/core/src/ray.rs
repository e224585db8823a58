//! Rays and hits in columns: row `i` of every column belongs to ray `i`.

use crate::lanes::{Doubles, F32x16, F64x8, Lanes, MAX_LANES, Packing, U32x16, store_rounded};
use crate::vec3::Vec3;
use glam::{DVec3, Vec3 as Point};

/// The row of [`Hits::sphere`] of a ray that hits nothing.
pub const MISS: u32 = u32::MAX;

/// The row of [`Hits::sphere`] of a ray that hits the ground plane.
pub const GROUND: u32 = u32::MAX - 1;

/// Rays in world space. Directions have length 1 up to rounding.
#[derive(Clone, Debug, Default)]
pub struct Rays {
    /// Origins.
    pub origin: Columns3,
    /// Directions.
    pub direction: Columns3,
    /// The surface that the ray starts on: a sphere's row, [`GROUND`], or [`MISS`] for the camera. It is
    /// never hit: a convex body does not hide itself from outside, and the exit of a ray that goes inside
    /// is known before the ray is traced.
    pub own: Vec<u32>,
    /// The light that a shadow ray is aimed at, which does not occlude itself; else [`MISS`].
    pub target: Vec<u32>,
    /// Exact rays, if the single-precision columns cannot hold them; empty otherwise.
    pub precise: Vec<ExactRay>,
    /// True if it is known that all origins are [coarse](Vec3::is_coarse).
    pub coarse: bool,
    len: usize,
}

/// Three columns of coordinates, with room for a whole packet after the last row.
#[derive(Clone, Debug, Default)]
pub struct Columns3 {
    /// Along the first axis.
    pub x: Vec<f32>,
    /// Along the second axis.
    pub y: Vec<f32>,
    /// Along the third axis.
    pub z: Vec<f32>,
}

/// Number of rays that are sorted into packets together.
pub const CHUNK: usize = 4096;

/// Hits of rays: on entry the bounds of the search, on return the answers.
#[derive(Clone, Debug, Default)]
pub struct Hits {
    /// Distance in units of the direction's length. On entry, hits beyond it do not count.
    pub t: Vec<f64>,
    /// The sphere's row, [`GROUND`] or [`MISS`].
    pub sphere: Vec<u32>,
    /// Bounds of the distances' errors, 0 for a given number; only of the chunk of rays that is being
    /// traced.
    pub error: Vec<f64>,
}

impl Columns3 {
    /// Returns columns of `rows` zeros.
    pub fn with_rows(rows: usize) -> Self {
        let column = || vec![0.0; rows];
        Self { x: column(), y: column(), z: column() }
    }

    /// Row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> Point {
        Point::new(self.x[i], self.y[i], self.z[i])
    }

    /// Writes row `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, p: Point) {
        (self.x[i], self.y[i], self.z[i]) = (p.x, p.y, p.z);
    }

    /// Writes rows `i..i + 8`, rounded.
    #[inline(always)]
    pub fn set_row(&mut self, i: usize, p: Vec3<F64x8>) {
        store_rounded(p.x, &mut self.x[i..]);
        store_rounded(p.y, &mut self.y[i..]);
        store_rounded(p.z, &mut self.z[i..]);
    }

    /// Writes some of sixteen lanes to rows from `i` on, and anything to those up to sixteen.
    #[inline(always)]
    pub fn pack(&mut self, i: usize, packing: &Packing, p: Vec3<F32x16>) {
        packing.store(p.x, &mut self.x[i..]);
        packing.store(p.y, &mut self.y[i..]);
        packing.store(p.z, &mut self.z[i..]);
    }

    /// Rows `i..i + L::WIDTH`.
    #[inline(always)]
    pub fn load<L: Lanes>(&self, i: usize) -> Vec3<L> {
        Vec3::new(L::load(&self.x[i..]), L::load(&self.y[i..]), L::load(&self.z[i..]))
    }
}

impl Rays {
    /// Returns no rays, with capacity for `capacity`.
    pub fn with_capacity(capacity: usize) -> Self {
        let rows = capacity.next_multiple_of(MAX_LANES) + MAX_LANES;
        Self {
            origin: Columns3::with_rows(rows),
            direction: Columns3::with_rows(rows),
            own: vec![MISS; rows],
            target: vec![MISS; rows],
            precise: Vec::new(),
            coarse: false,
            len: 0,
        }
    }

    /// Replaces all rays by `count` rays that start in empty space; the caller writes their origins and
    /// directions, and keeps to the capacity.
    pub fn begin(&mut self, count: usize) {
        self.len = count;
        self.own[..count].fill(MISS);
        self.target[..count].fill(MISS);
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes the rays from `len` on.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }

    /// Appends a ray. The caller keeps to the capacity.
    #[inline(always)]
    pub fn push(&mut self, origin: Point, direction: Point, own: u32) {
        let row = self.len;
        self.len += 1;
        self.set(row, origin, direction, own);
    }

    /// Appends the first `count` lanes, which start in empty space. The caller keeps to the capacity.
    #[inline(always)]
    pub fn append<L: Lanes>(&mut self, count: usize, origin: &[L; 3], direction: &[L; 3]) {
        let row = self.len;
        for (columns, lanes) in [(&mut self.origin, origin), (&mut self.direction, direction)] {
            for (column, lanes) in
                [&mut columns.x, &mut columns.y, &mut columns.z].into_iter().zip(lanes)
            {
                lanes.store(&mut column[row..]);
            }
        }
        self.own[row..row + L::WIDTH].fill(MISS);
        self.target[row..row + L::WIDTH].fill(MISS);
        self.len += count;
    }

    /// Appends some of sixteen rays that start on surfaces. The caller keeps to the capacity, and
    /// writes what they are aimed at, if rays are.
    #[inline(always)]
    pub fn append_packed(
        &mut self,
        packing: &Packing,
        (origin, direction): (Vec3<F32x16>, Vec3<F32x16>),
        own: &[u32; MAX_LANES],
    ) {
        let row = self.len;
        self.origin.pack(row, packing, origin);
        self.direction.pack(row, packing, direction);
        packing.store_numbers(U32x16::new(*own), &mut self.own[row..]);
        self.len += packing.count();
    }

    /// Writes row `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, origin: Point, direction: Point, own: u32) {
        self.origin.set(i, origin);
        self.direction.set(i, direction);
        self.own[i] = own;
        self.target[i] = MISS;
    }

    /// Copies row `from` over row `to`.
    #[inline(always)]
    pub fn copy_row(&mut self, from: usize, to: usize) {
        self.set(to, self.origin.row(from), self.direction.row(from), self.own[from]);
    }

    /// Returns ray `i` for the exact test.
    #[inline(always)]
    pub fn exact(&self, i: usize) -> ExactRay {
        match self.precise.get(i) {
            Some(ray) => *ray,
            None => ExactRay::new(self.origin.row(i), self.direction.row(i), self.own[i] != MISS),
        }
    }
}

impl Hits {
    /// Returns misses, with capacity for `capacity`.
    pub fn with_capacity(capacity: usize) -> Self {
        let rows = capacity.next_multiple_of(MAX_LANES) + MAX_LANES;
        Self {
            t: vec![f64::INFINITY; rows],
            sphere: vec![MISS; rows],
            error: vec![0.0; rows.min(CHUNK + MAX_LANES)],
        }
    }

    /// Writes row `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, t: f64, sphere: u32) {
        (self.t[i], self.sphere[i]) = (t, sphere);
    }
}

/// A ray for the exact test: the stored single-precision numbers, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct ExactRay {
    /// The origin.
    pub origin: DVec3,
    /// The direction, of any length.
    pub direction: DVec3,
    /// A bound of the distance between the origin and the point that was rounded to it, in single
    /// precision; 0 for an exact origin.
    pub origin_error: f64,
}

/// Returns a bound of the distance by which rounding to single precision moved points.
#[inline(always)]
pub fn rounding<D: Doubles>(point: Vec3<D>) -> D {
    // Rounding moves a coordinate by at most 2^-24 of itself; twice that is the band.
    let Vec3 { x, y, z } = point.map(D::abs);
    D::splat(f64::from(f32::EPSILON)) * (x + y + z)
}

impl ExactRay {
    /// `on_surface`: the origin is a point of a surface, rounded to single precision.
    #[inline(always)]
    pub fn new(origin: Point, direction: Point, on_surface: bool) -> Self {
        let origin = origin.as_dvec3();
        let origin_error = if on_surface { rounding(origin.into()) } else { 0.0 };
        Self { origin, direction: direction.as_dvec3(), origin_error }
    }

    /// The point at distance `t`, seen from `center`. Taking the difference first loses nothing where
    /// both are far from the coordinates' origin.
    pub fn at_from(&self, center: DVec3, t: f64) -> DVec3 {
        (self.origin - center) + self.direction * t
    }

    /// The point at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
