//! Exact queries for other programs: columns of spheres in, hits out.
//!
//! A [`SphereTree`] takes spheres and rays bit by bit as they are, of any scale, directions of any
//! length, and answers which sphere a ray hits first, or whether it hits any, as arithmetic without
//! rounding would. To keep the single-precision filter within its range it multiplies coordinates
//! by a power of two, which is exact, and nothing else is done to them.
//!
//! ```
//! use spherule::query::{Hits, RayColumns, SphereTree};
//!
//! let tree = SphereTree::from_columns(&[0.0, 3.0], &[0.0; 2], &[0.0; 2], &[1.0, 0.5])?;
//! let hit = tree.intersect([-5.0, 0.0, 0.0], [2.0, 0.0, 0.0]).expect("straight on");
//! assert_eq!((hit.sphere, hit.t), (0, 2.0));
//! assert!(!tree.occluded([-5.0, 0.0, 0.0], [2.0, 0.0, 0.0], 2.0));
//!
//! let rays = RayColumns {
//!     origin: [&[-5.0, 9.0], &[0.0, 0.0], &[0.0, 0.0]],
//!     direction: [&[2.0, -1.0], &[0.0, 0.0], &[0.0, 0.0]],
//! };
//! let (mut t, mut sphere) = ([f64::INFINITY; 2], [0; 2]);
//! tree.intersect_columns(&rays, Hits { t: &mut t, sphere: &mut sphere, surface: None })?;
//! assert_eq!((t, sphere), ([2.0, 5.5], [0, 1]));
//! assert_eq!(hit.normal, [-1.0, 0.0, 0.0]);
//! # Ok::<(), spherule::query::QueryError>(())
//! ```

mod alone;
mod plain;

use crate::bvh::Bvh;
use crate::bvh::build::{Builder, build};
use crate::bvh::walk::{Any, Closest, Method, Query, trace};
use crate::exact;
use crate::lanes::F32x16;
use crate::ray::{self, MISS, Rays};
use crate::spheres::Spheres;
use alone::Scaled;
use glam::{DVec3, Vec3};
use std::cell::Cell;

/// The sphere of a ray that hits nothing.
pub const NOTHING: u32 = MISS;

/// Rays that are traced together.
const CHUNK: usize = 2048;

/// Spheres, ready for exact queries.
#[derive(Clone, Debug)]
pub struct SphereTree {
    spheres: Spheres,
    bvh: Bvh,
    /// A power of two, which makes the largest coordinate about 1.
    scale: f64,
    invalid: usize,
}

/// Rays in columns: coordinate by coordinate, all of one length.
#[derive(Clone, Copy, Debug)]
pub struct RayColumns<'a> {
    /// Where rays start: x, y, z.
    pub origin: [&'a [f32]; 3],
    /// Where they go: x, y, z, of any length but 0.
    pub direction: [&'a [f32]; 3],
}

/// Where answers about rays go, and where their search ends: columns as long as those of the rays.
#[derive(Debug)]
pub struct Hits<'a> {
    /// On entry, hits not nearer than this do not count; infinity for no bound. On return the
    /// distance of the hit, in units of the direction's length, or unchanged.
    pub t: &'a mut [f64],
    /// On return the sphere's row in the columns that the tree was built from, or [`NOTHING`].
    pub sphere: &'a mut [u32],
    /// On return point and normal; unchanged where nothing is hit. `None` if nobody wants to know.
    pub surface: Option<&'a mut [Surface]>,
}

/// What a ray hits first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Row of the sphere in the columns that the tree was built from.
    pub sphere: u32,
    /// Distance in units of the direction's length, more than 0.
    pub t: f64,
    /// The point of the sphere, in the user's coordinates.
    pub point: [f64; 3],
    /// The outward unit normal.
    pub normal: [f64; 3],
}

/// Where a ray hits. Both are solved in double precision from the sphere itself, so the point is on
/// it up to the last bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// The point, in the user's coordinates.
    pub point: [f64; 3],
    /// The outward unit normal.
    pub normal: [f64; 3],
}

/// What was noticed on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Rays that are no rays: something is not finite, the direction is zero, or the bound is NaN. They
    /// hit nothing.
    pub invalid: u64,
    /// Decisions that took arithmetic without rounding.
    pub exact: u64,
}

/// Why a tree cannot be built, or columns cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueryError {
    /// Columns differ in length.
    #[error("the columns differ in length: one has {expected} rows and another {found}")]
    Lengths {
        /// Of the first column.
        expected: usize,
        /// Of another.
        found: usize,
    },
    /// Rows are numbers of 32 bits.
    #[error("{0} spheres are too many: at most {max} fit", max = Spheres::MAX)]
    TooMany(usize),
}

impl SphereTree {
    /// Builds the tree over spheres in columns.
    ///
    /// Spheres with a radius that is not more than 0, or with anything that is not finite, are
    /// never hit; [`SphereTree::invalid_spheres`] counts them.
    ///
    /// # Errors
    /// Columns of different lengths, or more than [`Spheres::MAX`] spheres.
    pub fn from_columns(
        x: &[f32],
        y: &[f32],
        z: &[f32],
        radius: &[f32],
    ) -> Result<Self, QueryError> {
        same_length(radius.len(), &[x.len(), y.len(), z.len()])?;
        Self::build(radius.len(), |i| [x[i], y[i], z[i], radius[i]])
    }

    /// Builds the tree over spheres in rows of x, y, z and radius; otherwise as
    /// [`SphereTree::from_columns`].
    ///
    /// # Errors
    /// More than [`Spheres::MAX`] spheres.
    pub fn from_rows(rows: &[[f32; 4]]) -> Result<Self, QueryError> {
        Self::build(rows.len(), |i| rows[i])
    }

    fn build(count: usize, row: impl Fn(usize) -> [f32; 4]) -> Result<Self, QueryError> {
        if count > Spheres::MAX {
            return Err(QueryError::TooMany(count));
        }
        let valid = |i: usize| {
            let [x, y, z, radius] = row(i);
            x.is_finite()
                && y.is_finite()
                && z.is_finite()
                && radius > 0.0
                && radius < f32::INFINITY
        };
        let wide = |i: usize| row(i).map(f64::from);
        let largest = (0..count).filter(|&i| valid(i)).fold(0.0, |largest: f64, i| {
            let [x, y, z, radius] = wide(i);
            largest.max(DVec3::new(x, y, z).abs().max_element() + radius)
        });
        let scale = if largest > 0.0 { (-largest.log2().ceil()).exp2() } else { 1.0 };
        let scaled = |i: usize| wide(i).map(|value| value * scale);
        let mut spheres = Spheres::with_capacity(count);
        let mut rounded = false;
        for i in (0..count).filter(|&i| valid(i)) {
            let single = scaled(i).map(|value| value as f32);
            rounded |= single.map(f64::from) != scaled(i);
            let [x, y, z, radius] = single;
            spheres.push(Vec3::new(x, y, z), radius, i as u32);
        }
        if rounded {
            // Scales so far apart that the smallest numbers leave single precision.
            spheres.precise = spheres.id.iter().map(|&i| split(scaled(i as usize))).collect();
        }
        let invalid = count - spheres.len();
        let bvh = build(&mut spheres, Builder::default());
        Ok(Self { spheres, bvh, scale, invalid })
    }

    /// Number of spheres that can be hit.
    pub fn len(&self) -> usize {
        self.spheres.len()
    }

    /// Whether nothing can be hit.
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty()
    }

    /// Spheres that were left out because they are invalid.
    pub fn invalid_spheres(&self) -> usize {
        self.invalid
    }

    /// Bytes of tree and spheres.
    pub fn bytes(&self) -> usize {
        self.spheres.bytes() + self.bvh.bytes()
    }

    /// What a ray hits first: of spheres at equal distances, the one of the lowest row. `None` if
    /// nothing, or if the ray is invalid.
    pub fn intersect(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<Hit> {
        let mut hit = None;
        self.run::<Closest>(
            &one(&origin, &direction),
            |_| f64::INFINITY,
            |_, found| {
                let Surface { point, normal } = self.surface((origin, direction), found);
                hit = Some(Hit { sphere: found.id, t: found.t, point, normal });
            },
        );
        hit
    }

    /// Whether a ray hits anything at a distance less than `t_max`, in units of the direction's
    /// length.
    pub fn occluded(&self, origin: [f32; 3], direction: [f32; 3], t_max: f64) -> bool {
        let mut hit = false;
        self.run::<Any>(&one(&origin, &direction), |_| t_max, |_, _| hit = true);
        hit
    }

    /// What each ray hits first: of spheres at equal distances, the one of the lowest row.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn intersect_columns(&self, rays: &RayColumns, hits: Hits) -> Result<Tally, QueryError> {
        let Hits { t, sphere, mut surface } = hits;
        let surfaces = surface.as_ref().map_or(t.len(), |column| column.len());
        rays.check(&[t.len(), sphere.len(), surfaces])?;
        sphere.fill(NOTHING);
        let t = Cell::from_mut(t).as_slice_of_cells();
        Ok(self.run::<Closest>(
            rays,
            |i| t[i].get(),
            |i, found| {
                t[i].set(found.t);
                sphere[i] = found.id;
                if let Some(surface) = &mut surface {
                    surface[i] = self.surface(rays.row(i), found);
                }
            },
        ))
    }

    /// Whether each ray hits anything nearer than `t`.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn occluded_columns(
        &self,
        rays: &RayColumns,
        t: &[f64],
        occluded: &mut [bool],
    ) -> Result<Tally, QueryError> {
        rays.check(&[t.len(), occluded.len()])?;
        occluded.fill(false);
        Ok(self.run::<Any>(rays, |i| t[i], |i, _| occluded[i] = true))
    }

    /// Traces rays in chunks that stay in the second-level cache; `bound` is where the search for each
    /// ends.
    fn run<Q: Query>(
        &self,
        columns: &RayColumns,
        bound: impl Fn(usize) -> f64,
        mut found: impl FnMut(usize, &Found),
    ) -> Tally {
        let mut tally = Tally::default();
        let count = columns.origin[0].len();
        // Powers of two: their reciprocals and products do not round.
        let inverse_scale = self.scale.recip();
        let mut rays = Rays::with_capacity(CHUNK.min(count));
        let mut hits = ray::Hits::with_capacity(CHUNK.min(count));
        for first in (0..count).step_by(CHUNK) {
            let rows = first..count.min(first + CHUNK);
            rays.truncate(0);
            let plain = self.load(columns, rows.clone(), &mut rays);
            let stretch = |row: usize| f64::from(plain.stretch[row]);
            let unit = |row: usize| f64::from(plain.shrink[row]) * inverse_scale;
            let is_plain =
                |row: usize| plain.packets[row / plain::PACKET] && !bound(first + row).is_nan();
            for (row, i) in rows.clone().enumerate() {
                // Nothing counts below 0: what is not plain is not traced here.
                let bound = if is_plain(row) { bound(i) * self.scale * stretch(row) } else { -1.0 };
                hits.set(row, bound, MISS);
            }
            tally.exact +=
                trace::<F32x16, Q>(Method::Auto, &self.bvh, &self.spheres, &rays, &mut hits);
            for (row, i) in rows.enumerate() {
                if !is_plain(row) {
                    let hit = self.trace_alone::<Q>(columns.row(i), bound(i), &mut tally);
                    if let Some(hit) = hit {
                        found(i, &hit);
                    }
                } else if hits.sphere[row] != MISS {
                    let sphere = hits.sphere[row] as usize;
                    let id = if Q::ANY { NOTHING } else { self.spheres.id[sphere] };
                    found(i, &Found { sphere, id, t: hits.t[row] * unit(row) });
                }
            }
        }
        tally
    }

    fn surface(&self, (origin, direction): ([f32; 3], [f32; 3]), found: &Found) -> Surface {
        /// Beyond this many radii, double precision shows its limits.
        const FAR: f64 = (1 << 20) as f64;
        let Some(Scaled { ray, unit }) = self.scaled(origin, direction) else {
            return Surface::default();
        };
        let (center, radius) = self.spheres.exact(found.sphere);
        let normal = if ray.origin.distance(center) > FAR * radius {
            exact::normal(&ray, center, radius)
        } else {
            ray.at_from(center, found.t / unit).normalize_or(-ray.direction.normalize())
        };
        let point = (center + normal * radius) / self.scale;
        Surface { point: point.to_array(), normal: normal.to_array() }
    }
}

/// A hit.
struct Found {
    /// The sphere's row in the tree.
    sphere: usize,
    /// The sphere's row in the user's columns; [`NOTHING`] if nobody asks which.
    id: u32,
    /// In units of the user's direction.
    t: f64,
}

impl RayColumns<'_> {
    /// Whether all columns agree in length.
    fn check(&self, others: &[usize]) -> Result<(), QueryError> {
        let [count, ..] = self.origin.map(<[f32]>::len);
        same_length(count, &self.origin.map(<[f32]>::len))?;
        same_length(count, &self.direction.map(<[f32]>::len))?;
        same_length(count, others)
    }

    fn row(&self, i: usize) -> ([f32; 3], [f32; 3]) {
        (self.origin.map(|column| column[i]), self.direction.map(|column| column[i]))
    }
}

/// A single ray in columns.
fn one<'a>(origin: &'a [f32; 3], direction: &'a [f32; 3]) -> RayColumns<'a> {
    let columns = |v: &'a [f32; 3]| v.each_ref().map(std::slice::from_ref);
    RayColumns { origin: columns(origin), direction: columns(direction) }
}

fn same_length(expected: usize, lengths: &[usize]) -> Result<(), QueryError> {
    match lengths.iter().find(|&&found| found != expected) {
        Some(&found) => Err(QueryError::Lengths { expected, found }),
        None => Ok(()),
    }
}

fn split([x, y, z, radius]: [f64; 4]) -> (DVec3, f64) {
    (DVec3::new(x, y, z), radius)
}
