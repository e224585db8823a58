//! Where rays hit: points and normals, and how far it is through spheres from there.

use super::struck::{Few, struck};
use super::workspace::{BATCH, Workspace};
use crate::lanes::{Doubles, F64x8, MAX_LANES, Mask, load_doubles};
use crate::ray::{Columns3, GROUND, MISS};
use crate::vec3::Vec3;
use crate::world::{Ground, World};
use glam::DVec3;

/// Rows that are solved for together.
pub(super) const ROW: usize = 8;

/// All lanes of a row.
const ALL: u32 = (1 << ROW) - 1;

/// Where rays hit.
pub struct Surface {
    /// The point, rounded to single precision.
    pub point: Columns3,
    /// The outward unit normal.
    pub normal: Normals,
    /// The normal on the side that is looked at, rounded.
    pub facing: Columns3,
    /// Eight rows to a byte: whether the surface is seen from inside.
    inside: Vec<u8>,
}

/// Unit vectors in columns of double precision.
pub struct Normals {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl Surface {
    pub(super) fn with_rows(rows: usize) -> Self {
        Self {
            point: Columns3::with_rows(rows),
            normal: Normals::with_rows(rows),
            facing: Columns3::with_rows(rows),
            inside: vec![0; rows.next_multiple_of(MAX_LANES) / ROW],
        }
    }

    /// Which of rows `first..first + 16`, `first` being a multiple of that, are seen from inside.
    #[inline(always)]
    pub(super) fn inside(&self, first: usize) -> u32 {
        let halves = &self.inside[first / ROW..][..MAX_LANES / ROW];
        u32::from(halves[0]) | u32::from(halves[1]) << ROW
    }

    /// Lets a row be seen from the other side.
    #[cfg(test)]
    pub(super) fn turn(&mut self, row: usize) {
        self.inside[row / ROW] ^= 1 << (row % ROW);
    }

    /// Turns the normals of rows `first..first + 8`, of rays of these directions, to where they are
    /// looked at from.
    #[inline(always)]
    fn face(&mut self, first: usize, normal: Vec3<F64x8>, direction: Vec3<F64x8>) {
        let inside = F64x8::splat(0.0).lt(normal.dot_unfused(direction));
        self.facing.set_row(first, Vec3::select(inside, -normal, normal));
        self.inside[first / ROW] = inside.bits() as u8;
    }
}

impl Normals {
    pub(super) fn with_rows(rows: usize) -> Self {
        let column = || vec![0.0; rows];
        Self { x: column(), y: column(), z: column() }
    }

    /// Row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> DVec3 {
        DVec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Writes row `i`.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, normal: DVec3) {
        (self.x[i], self.y[i], self.z[i]) = normal.into();
    }

    /// Some rows, wherever they are.
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

    /// Rows `i..i + 8`.
    #[inline(always)]
    fn load(&self, i: usize) -> Vec3<F64x8> {
        Vec3::new(row(&self.x[i..]), row(&self.y[i..]), row(&self.z[i..]))
    }

    /// Writes rows `i..i + 8`.
    #[inline(always)]
    pub(super) fn set_row(&mut self, i: usize, normal: Vec3<F64x8>) {
        self.x[i..i + ROW].copy_from_slice(&normal.x.to_array());
        self.y[i..i + ROW].copy_from_slice(&normal.y.to_array());
        self.z[i..i + ROW].copy_from_slice(&normal.z.to_array());
    }
}

/// What a column has in some rows.
#[inline(always)]
fn pick(column: &[f64], rows: &[u32; MAX_LANES]) -> [f64; MAX_LANES] {
    let column: &[f64; BATCH] = column.first_chunk().expect("columns hold a batch");
    let mut lanes = [0.0; MAX_LANES];
    for (lane, &row) in lanes.iter_mut().zip(rows) {
        // Rows are less than that, which saves a check of each.
        *lane = column[row as usize % BATCH];
    }
    lanes
}

#[inline(always)]
fn row(column: &[f64]) -> F64x8 {
    F64x8::new(*column.first_chunk().expect("columns hold whole rows"))
}

/// Rows `i..i + 8` of columns of single precision.
#[inline(always)]
fn load(columns: &Columns3, i: usize) -> Vec3<F64x8> {
    let column = |column: &[f32]| load_doubles(&column[i..]);
    Vec3::new(column(&columns.x), column(&columns.y), column(&columns.z))
}

/// Numbers of 32 bits, which double precision holds exactly.
#[inline(always)]
fn numbers(column: &[u32]) -> F64x8 {
    let row: &[u32; ROW] = column.first_chunk().expect("columns hold whole rows");
    F64x8::new(row.map(f64::from))
}

/// Where whole numbers are equal.
#[inline(always)]
fn equal(a: F64x8, b: F64x8) -> <F64x8 as Doubles>::Mask {
    (a - b).abs().lt(F64x8::splat(0.5))
}

/// Finds points and outward normals of what all rows hit, in double precision from the surfaces
/// themselves: points are no farther off them than rounding takes them.
pub(super) fn solve(world: &World, work: &mut Workspace) {
    let spheres = &world.spheres;
    match Few::of(spheres) {
        Some(few) => solve_rows(world, work, |hits| few.struck(hits)),
        None => solve_rows(world, work, |hits| struck(spheres, hits)),
    }
    if !world.cut.is_empty() {
        (0..work.len()).for_each(|row| solve_cut(world, work, row));
        for first in (0..work.len()).step_by(ROW) {
            let normal = work.surface.normal.load(first);
            work.surface.face(first, normal, load(&work.rays.direction, first));
        }
    }
}

/// The same where no sphere is cut; `struck` finds centers and radii.
#[inline(always)]
fn solve_rows(
    world: &World,
    work: &mut Workspace,
    struck: impl Fn(&[u32; ROW]) -> (Vec3<F64x8>, F64x8),
) {
    for first in (0..work.len()).step_by(ROW) {
        let hits = work.hits.sphere[first..].first_chunk().expect("columns hold whole rows");
        // As often beside the spheres: samples of a pixel are neighbors.
        if *hits != [MISS; ROW] {
            let struck = struck(hits);
            solve_row(world, work, first, struck);
        }
    }
}

/// The same for eight rows; of those that hit nothing, anything.
#[inline(always)]
fn solve_row(
    world: &World,
    work: &mut Workspace,
    first: usize,
    (center, radius): (Vec3<F64x8>, F64x8),
) {
    let hit = numbers(&work.hits.sphere[first..]);
    let missed = equal(hit, F64x8::splat(f64::from(MISS)));
    let grounded = equal(hit, F64x8::splat(f64::from(GROUND)));
    let (origin, direction) = (load(&work.rays.origin, first), load(&work.rays.direction, first));
    let t = row(&work.hits.t[first..]);
    let mut toward = (origin - center) + direction * t;
    let through = equal(hit, numbers(&work.rays.own[first..])) & !missed;
    if through.bits() != 0 {
        let exit = exit(work.surface.normal.load(first), direction);
        toward = Vec3::select(through, exit, toward);
    }
    let scale = toward.inverse_length();
    let mut normal = toward * scale;
    // Of a sphere that is smaller than rounding, the ray is all that is known.
    let known = scale.lt(F64x8::splat(f64::INFINITY)) & F64x8::splat(0.0).lt(scale);
    if (known | missed | grounded).bits() != ALL {
        normal = Vec3::select(known, normal, -(direction * direction.inverse_length()));
    }
    let mut point = center + normal * radius;
    if let Some(ground) = &world.ground
        && grounded.bits() != 0
    {
        let (foot, up) = foot(ground, origin + direction * t);
        point = Vec3::select(grounded, foot, point);
        normal = Vec3::select(grounded, up, normal);
    }
    work.surface.point.set_row(first, point);
    work.surface.normal.set_row(first, normal);
    work.surface.face(first, normal, direction);
}

/// What is below or above a point on the ground, and the ground's normal.
#[inline(always)]
fn foot(ground: &Ground, point: Vec3<F64x8>) -> (Vec3<F64x8>, Vec3<F64x8>) {
    let up = Vec3::from(ground.normal).map(F64x8::splat);
    let off = up.dot_unfused(point) - F64x8::splat(ground.height);
    (point - up * off, up)
}

/// Where chords leave spheres, from where they entered: mirrored at the plane across the chord's
/// middle. It does not use the origin, which was rounded.
#[inline(always)]
fn exit(entry: Vec3<F64x8>, direction: Vec3<F64x8>) -> Vec3<F64x8> {
    let length2 = direction.dot_unfused(direction);
    entry - direction * (F64x8::splat(2.0) * entry.dot_unfused(direction) / length2)
}

/// Mends what spheres that are cut show instead: points of caps, and of spheres from their caps.
#[cold]
fn solve_cut(world: &World, work: &mut Workspace, row: usize) {
    let hit = work.hits.sphere[row];
    if hit == GROUND || hit == MISS {
        return;
    }
    let (ray, own, t) = (work.rays.exact(row), work.rays.own[row], work.hits.t[row]);
    if let Some(normal) = world.cut.cap(&ray, own, t) {
        work.surface.point.set(row, ray.at(t).as_vec3());
        work.surface.normal.set(row, normal);
        return;
    }
    let (center, radius) = world.spheres.exact(hit as usize);
    if own == hit && world.cut.divides(center, radius) {
        let normal = leaving(ray.at_from(center, t), ray.direction.normalize());
        work.surface.point.set(row, (center + normal * radius).as_vec3());
        work.surface.normal.set(row, normal);
    }
}

/// The outward unit normal where a ray leaves a sphere, from the point seen from the center and the unit
/// direction. Rounding may move the origin of a ray that grazes the sphere out of it: it leaves all the
/// same.
fn leaving(toward: DVec3, direction: DVec3) -> DVec3 {
    let least = toward.length() * f64::from(f32::EPSILON);
    let outward = (least - toward.dot(direction)).max(0.0);
    (toward + direction * outward).normalize_or(direction)
}

/// Distance from a point of a sphere, with outward unit `normal`, through the inside to where
/// `direction` leaves.
#[inline(always)]
pub fn chord<D: Doubles>(normal: Vec3<D>, radius: D, direction: Vec3<D>) -> D {
    let length2 = direction.dot_unfused(direction);
    let t = D::splat(-2.0) * radius * normal.dot_unfused(direction) / length2;
    D::select(D::splat(0.0).lt(t), t, D::splat(0.0))
}

/// The same from a point of the inside, `offset` from the center.
pub(super) fn far_end(offset: DVec3, radius: f64, direction: DVec3) -> f64 {
    let (a, b) = (direction.length_squared(), -offset.dot(direction));
    let outside = offset.length_squared() - radius * radius;
    ((b + (b * b - a * outside).max(0.0).sqrt()) / a).max(0.0)
}
