//! Surface interactions: points and normals of hits, and chords through spheres.

use super::columns::BATCH_PATHS;
use crate::lanes::{Doubles, F64x8, MAX_LANES, Mask, U32x16, load_doubles, look_up, widen};
use crate::ray::{Columns3, GROUND, Hits, MISS, Rays};
use crate::spheres::{LEAF, Spheres};
use crate::vec3::Vec3;
use crate::world::{Ground, World};
use glam::DVec3;

/// Rows that are computed at once.
pub(super) const LANES: usize = 8;

/// A mask of all lanes of a row.
const ALL: u32 = (1 << LANES) - 1;

/// Points and normals of hits, in columns.
pub struct SurfaceColumns {
    /// Points, rounded to single precision.
    pub point: Columns3,
    /// Outward unit normals.
    pub normal: Normals,
    /// Normals on the sides that the rays come from, rounded.
    pub facing: Columns3,
    /// One bit per row, set if the surface is hit from inside.
    inside: Vec<u8>,
}

/// Unit vectors in columns of double precision.
pub struct Normals {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl SurfaceColumns {
    pub(super) fn with_rows(rows: usize) -> Self {
        Self {
            point: Columns3::with_rows(rows),
            normal: Normals::with_rows(rows),
            facing: Columns3::with_rows(rows),
            inside: vec![0; rows.next_multiple_of(MAX_LANES) / LANES],
        }
    }

    /// Returns a mask of the rows `first..first + 16` that are hit from inside; `first` is a multiple
    /// of 16.
    #[inline(always)]
    pub(super) fn inside(&self, first: usize) -> u32 {
        let halves = &self.inside[first / LANES..][..MAX_LANES / LANES];
        u32::from(halves[0]) | u32::from(halves[1]) << LANES
    }

    /// Flips the side from which a row is hit.
    #[cfg(test)]
    pub(super) fn flip_inside(&mut self, row: usize) {
        self.inside[row / LANES] ^= 1 << (row % LANES);
    }

    /// Computes the points and outward normals of all hits in double precision, from the surfaces
    /// themselves: points are no farther off the surfaces than rounding moves them.
    pub(super) fn compute(&mut self, world: &World, rays: &Rays, hits: &Hits) {
        let spheres = &world.spheres;
        match SmallSphereTable::new(spheres) {
            Some(table) => self.compute_rows(world, rays, hits, |hits| table.gather(hits)),
            None => self.compute_rows(world, rays, hits, |hits| gather_spheres(spheres, hits)),
        }
        if world.has_other_bodies() {
            (0..rays.len()).for_each(|row| self.compute_other_body(world, rays, hits, row));
        }
        if !world.cut.is_empty() {
            (0..rays.len()).for_each(|row| self.compute_cut_sphere(world, rays, hits, row));
        }
        if !world.cut.is_empty() || world.has_other_bodies() {
            for first in (0..rays.len()).step_by(LANES) {
                let normal = self.normal.load(first);
                self.set_facing(first, normal, load(&rays.direction, first));
            }
        }
    }

    /// Computes points and normals where no sphere is cut; `gather` returns centers and radii.
    #[inline(always)]
    fn compute_rows(
        &mut self,
        world: &World,
        rays: &Rays,
        hits: &Hits,
        gather: impl Fn(&[u32; LANES]) -> (Vec3<F64x8>, F64x8),
    ) {
        for first in (0..rays.len()).step_by(LANES) {
            let row = hits.sphere[first..].first_chunk().expect("columns hold whole rows");
            // Rays of a row often all miss: samples of a pixel are neighbors.
            if *row != [MISS; LANES] {
                let (center, radius) = gather(row);
                self.compute_row(world, rays, hits, first, center, radius);
            }
        }
    }

    /// Computes points and normals of eight rows, on spheres with these centers and radii; lanes
    /// without a hit get arbitrary values.
    #[inline(always)]
    fn compute_row(
        &mut self,
        world: &World,
        rays: &Rays,
        hits: &Hits,
        first: usize,
        center: Vec3<F64x8>,
        radius: F64x8,
    ) {
        let hit = numbers(&hits.sphere[first..]);
        let missed = equal(hit, F64x8::splat(f64::from(MISS)));
        let grounded = equal(hit, F64x8::splat(f64::from(GROUND)));
        let (origin, direction) = (load(&rays.origin, first), load(&rays.direction, first));
        let t = row(&hits.t[first..]);
        let mut toward = (origin - center) + direction * t;
        let through = equal(hit, numbers(&rays.own[first..])) & !missed;
        if through.bits() != 0 {
            let exit = chord_exit(self.normal.load(first), direction);
            toward = Vec3::select(through, exit, toward);
        }
        let scale = toward.inverse_length();
        let mut normal = toward * scale;
        // The normal of a sphere that is smaller than rounding is against the ray: nothing else is known.
        let known = scale.lt(F64x8::splat(f64::INFINITY)) & F64x8::splat(0.0).lt(scale);
        if (known | missed | grounded).bits() != ALL {
            normal = Vec3::select(known, normal, -(direction * direction.inverse_length()));
        }
        let mut point = center + normal * radius;
        if let Some(ground) = &world.ground
            && grounded.bits() != 0
        {
            let (projected, up) = project_to_ground(ground, origin + direction * t);
            point = Vec3::select(grounded, projected, point);
            normal = Vec3::select(grounded, up, normal);
        }
        self.point.set_row(first, point);
        self.normal.set_row(first, normal);
        self.set_facing(first, normal, direction);
    }

    /// Computes the point and the normal of a hit on a body that is no sphere.
    fn compute_other_body(&mut self, world: &World, rays: &Rays, hits: &Hits, row: usize) {
        let (ray, t) = (rays.exact(row), hits.t[row]);
        let Some(body) = world.body(hits.sphere[row]) else { return };
        let Some((point, normal)) = world.trees().surface_at(body, &ray, t) else { return };
        self.point.set(row, point);
        self.normal.set(row, normal);
    }

    /// Corrects the hits on spheres that are cut: points of caps, and exits from spheres entered by a cap.
    #[cold]
    fn compute_cut_sphere(&mut self, world: &World, rays: &Rays, hits: &Hits, row: usize) {
        let hit = hits.sphere[row];
        if hit == GROUND || hit == MISS {
            return;
        }
        let (ray, own, t) = (rays.exact(row), rays.own[row], hits.t[row]);
        if let Some(normal) = world.cut.cap(&ray, own, t) {
            self.point.set(row, ray.at(t).as_vec3());
            self.normal.set(row, normal);
            return;
        }
        if hit as usize >= world.spheres.len() {
            return;
        }
        let (center, radius) = world.spheres.exact(hit as usize);
        if own == hit && world.cut.divides(center, radius) {
            let normal = exit_normal(ray.at_from(center, t), ray.direction.normalize());
            self.point.set(row, (center + normal * radius).as_vec3());
            self.normal.set(row, normal);
        }
    }

    /// Sets the normals of rows `first..first + 8` on the sides that their rays, of these directions,
    /// come from.
    #[inline(always)]
    fn set_facing(&mut self, first: usize, normal: Vec3<F64x8>, direction: Vec3<F64x8>) {
        let inside = F64x8::splat(0.0).lt(normal.dot_unfused(direction));
        self.facing.set_row(first, Vec3::select(inside, -normal, normal));
        self.inside[first / LANES] = inside.bits() as u8;
    }
}

impl Normals {
    pub(super) fn with_rows(rows: usize) -> Self {
        let column = || vec![0.0; rows];
        Self { x: column(), y: column(), z: column() }
    }

    /// Returns row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> DVec3 {
        DVec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Writes row `i`.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, normal: DVec3) {
        (self.x[i], self.y[i], self.z[i]) = normal.into();
    }

    /// Gathers sixteen rows.
    #[inline(always)]
    pub(super) fn pick(&self, rows: &[u32; MAX_LANES]) -> [[f64; MAX_LANES]; 3] {
        [pick(&self.x, rows), pick(&self.y, rows), pick(&self.z, rows)]
    }

    /// Writes rows `i..i + 16`.
    #[inline(always)]
    pub(super) fn copy(&mut self, i: usize, [x, y, z]: &[[f64; MAX_LANES]; 3]) {
        self.x[i..i + MAX_LANES].copy_from_slice(x);
        self.y[i..i + MAX_LANES].copy_from_slice(y);
        self.z[i..i + MAX_LANES].copy_from_slice(z);
    }

    /// Returns rows `i..i + 8`.
    #[inline(always)]
    fn load(&self, i: usize) -> Vec3<F64x8> {
        Vec3::new(row(&self.x[i..]), row(&self.y[i..]), row(&self.z[i..]))
    }

    /// Writes rows `i..i + 8`.
    #[inline(always)]
    pub(super) fn set_row(&mut self, i: usize, normal: Vec3<F64x8>) {
        self.x[i..i + LANES].copy_from_slice(&normal.x.to_array());
        self.y[i..i + LANES].copy_from_slice(&normal.y.to_array());
        self.z[i..i + LANES].copy_from_slice(&normal.z.to_array());
    }
}

/// Gathers rows of a column.
#[inline(always)]
fn pick(column: &[f64], rows: &[u32; MAX_LANES]) -> [f64; MAX_LANES] {
    let column: &[f64; BATCH_PATHS] = column.first_chunk().expect("columns hold a batch");
    let mut lanes = [0.0; MAX_LANES];
    for (lane, &row) in lanes.iter_mut().zip(rows) {
        // Rows are always less than `BATCH_PATHS`; the remainder makes the bounds check unnecessary.
        *lane = column[row as usize % BATCH_PATHS];
    }
    lanes
}

#[inline(always)]
fn row(column: &[f64]) -> F64x8 {
    F64x8::new(*column.first_chunk().expect("columns hold whole rows"))
}

/// Returns rows `i..i + 8` of columns of single precision.
#[inline(always)]
fn load(columns: &Columns3, i: usize) -> Vec3<F64x8> {
    let column = |column: &[f32]| load_doubles(&column[i..]);
    Vec3::new(column(&columns.x), column(&columns.y), column(&columns.z))
}

/// Converts 32-bit integers, which double precision holds exactly.
#[inline(always)]
fn numbers(column: &[u32]) -> F64x8 {
    let row: &[u32; LANES] = column.first_chunk().expect("columns hold whole rows");
    F64x8::new(row.map(f64::from))
}

/// Returns the lanes in which two whole numbers are equal.
#[inline(always)]
fn equal(a: F64x8, b: F64x8) -> <F64x8 as Doubles>::Mask {
    (a - b).abs().lt(F64x8::splat(0.5))
}

/// Projects a point to the ground; returns the projection and the ground's normal.
#[inline(always)]
fn project_to_ground(ground: &Ground, point: Vec3<F64x8>) -> (Vec3<F64x8>, Vec3<F64x8>) {
    let up = Vec3::from(ground.normal).map(F64x8::splat);
    let off = up.dot_unfused(point) - F64x8::splat(ground.height);
    (point - up * off, up)
}

/// Returns where chords leave spheres, from the points of entry: their mirror images in the plane
/// across the middle of the chord. It does not use the origin, which was rounded.
#[inline(always)]
fn chord_exit(entry: Vec3<F64x8>, direction: Vec3<F64x8>) -> Vec3<F64x8> {
    let length2 = direction.dot_unfused(direction);
    entry - direction * (F64x8::splat(2.0) * entry.dot_unfused(direction) / length2)
}

/// Returns the outward unit normal where a ray leaves a sphere, from the point relative to the center
/// and the unit direction. Rounding may move the origin of a grazing ray out of the sphere: the ray
/// leaves the sphere all the same.
fn exit_normal(toward: DVec3, direction: DVec3) -> DVec3 {
    let least = toward.length() * f64::from(f32::EPSILON);
    let outward = (least - toward.dot(direction)).max(0.0);
    (toward + direction * outward).normalize_or(direction)
}

/// Returns the length of a chord: the distance from a point of a sphere, with outward unit `normal`,
/// through the inside to where `direction` leaves.
#[inline(always)]
pub fn chord_length<D: Doubles>(normal: Vec3<D>, radius: D, direction: Vec3<D>) -> D {
    let length2 = direction.dot_unfused(direction);
    let t = D::splat(-2.0) * radius * normal.dot_unfused(direction) / length2;
    D::select(D::splat(0.0).lt(t), t, D::splat(0.0))
}

/// Returns the distance from a point inside a sphere, `offset` from the center, to where `direction`
/// leaves.
pub(super) fn exit_distance(offset: DVec3, radius: f64, direction: DVec3) -> f64 {
    let (a, b) = (direction.length_squared(), -offset.dot(direction));
    let outside = offset.length_squared() - radius * radius;
    ((b + (b * b - a * outside).max(0.0).sqrt()) / a).max(0.0)
}

/// Gathers centers and radii of the spheres of a row of hits; lanes without a sphere get those of any.
#[inline(always)]
fn gather_spheres(spheres: &Spheres, hits: &[u32; LANES]) -> (Vec3<F64x8>, F64x8) {
    let blocks = spheres.blocks();
    let mut columns = [[0.0; LANES]; 4];
    for (lane, &hit) in hits.iter().enumerate() {
        let (block, slot) = (hit as usize / LEAF, hit as usize % LEAF);
        let block = &blocks[block.min(blocks.len() - 1)];
        columns[0][lane] = block.x[slot];
        columns[1][lane] = block.y[slot];
        columns[2][lane] = block.z[slot];
        columns[3][lane] = block.radius[slot];
    }
    let [x, y, z, radius] = columns.each_ref().map(|column| load_doubles(column));
    (Vec3::new(x, y, z), radius)
}

/// The spheres of a world that has at most 16 of them, in registers.
struct SmallSphereTable([U32x16; 4]);

impl SmallSphereTable {
    /// Creates a table; `None` if there are too many spheres. The world may have no sphere at all.
    fn new(spheres: &Spheres) -> Option<Self> {
        let mut columns = [[0.0_f32; 2 * LEAF]; 4];
        let blocks = spheres.blocks();
        if blocks.len() > 2 {
            return None;
        }
        for (i, block) in blocks.iter().enumerate() {
            let rows = [&block.x, &block.y, &block.z, &block.radius];
            for (column, row) in columns.iter_mut().zip(rows) {
                column[i * LEAF..][..LEAF].copy_from_slice(row);
            }
        }
        Some(Self(columns.map(bytemuck::cast)))
    }

    /// Returns what [`gather_spheres`] does, by table lookup.
    #[inline(always)]
    fn gather(&self, hits: &[u32; LANES]) -> (Vec3<F64x8>, F64x8) {
        let mut places = [0; 2 * LANES];
        places[..LANES].copy_from_slice(hits);
        let places = U32x16::new(places);
        let pick = |column: U32x16| widen(bytemuck::cast(look_up(column, places)))[0];
        let [x, y, z, radius] = &self.0;
        (Vec3::new(pick(*x), pick(*y), pick(*z)), pick(*radius))
    }
}
