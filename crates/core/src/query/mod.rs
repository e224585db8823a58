//! Exact queries for other programs: columns of spheres in, hits out.
//!
//! A [`SphereTree`] takes spheres and rays bit by bit as they are, of any scale, directions of any
//! length, and answers which sphere a ray hits first, or whether it hits any, as arithmetic without
//! rounding would. To keep the conservative test within its range it multiplies coordinates
//! by a power of two, which is exact, and nothing else is done to them.

mod batch;
mod chunk;
mod columns;
mod load;
mod reorder;
mod scaled_ray;
mod strays;
mod surface;

pub use columns::{Hit, Hits, NOTHING, RayColumns, Surface, Tally};

use crate::bvh::Bvh;
use crate::bvh::builders::{Builder, build};
use crate::bvh::{Any, ClosestRounded, Tree};
use crate::elementary;
use crate::spheres::Spheres;
use crate::vec3::Vec3 as Coordinates;
use batch::Occlusion;
use columns::same_length;
use glam::{DVec3, Vec3};
use scaled_ray::{REACH, REACH_IN_LEAVES};

/// Spheres, ready for exact queries.
#[derive(Clone, Debug)]
pub struct SphereTree {
    spheres: Spheres,
    bvh: Bvh,
    /// A power of two, which makes the largest coordinate in the tree about 1, and its reciprocal.
    scale: [f64; 2],
    /// No ray in the tree's units is traced with others whose origin has a larger coordinate.
    reach: f64,
    /// Centers, radii and ids of the spheres that are not in the tree ([`strays`]), in their own units.
    strays: Vec<(DVec3, f64, u32)>,
    /// A power of two, which makes their largest coordinate about 1, and its reciprocal.
    stray_scale: [f64; 2],
    invalid: usize,
}

/// The reason why a tree cannot be built, or columns cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueryError {
    /// Columns differ in length.
    #[error("the columns differ in length: one has {expected} rows and another {found}")]
    Lengths {
        /// Length of the first column.
        expected: usize,
        /// Length of another column.
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
        let extent = |i: usize| {
            let [x, y, z, radius] = wide(i);
            DVec3::new(x, y, z).abs().max_element() + radius
        };
        let extents = || (0..count).filter(|&i| valid(i)).map(extent);
        let largest = strays::largest_of_most(extents());
        let [scale, unscale] = scale_of(largest);
        let scaled = |i: usize| wide(i).map(|value| value * scale);
        let mut spheres = Spheres::with_capacity(count);
        let mut strays = Vec::new();
        let mut rounded = false;
        for i in (0..count).filter(|&i| valid(i)) {
            if extent(i) > largest {
                strays.push((wide(i), i as u32));
                continue;
            }
            let single = scaled(i).map(|value| value as f32);
            rounded |= single.map(f64::from) != scaled(i);
            let [x, y, z, radius] = single;
            spheres.push(Vec3::new(x, y, z), radius, i as u32);
        }
        if rounded {
            // Scales so far apart that the smallest numbers leave single precision.
            spheres.precise = spheres.id.iter().map(|&i| split(scaled(i as usize))).collect();
        }
        let stray_scale = scale_of(extents().fold(0.0, f64::max));
        let stray = |(row, id): ([f64; 4], u32)| {
            let (center, radius) = split(row.map(|value| value * stray_scale[0]));
            (center, radius, id)
        };
        let strays: Vec<_> = strays.into_iter().map(stray).collect();
        let invalid = count - spheres.len() - strays.len();
        let bvh = build(&mut spheres, Builder::default());
        spheres.coarse = !rounded
            && (0..spheres.len()).all(|i| Coordinates::from(spheres.center(i)).is_coarse());
        let reach = (f64::from(bvh.mean_leaf_extent()) * REACH_IN_LEAVES).clamp(4.0, REACH);
        let scale = [scale, unscale];
        Ok(Self { spheres, bvh, scale, reach, strays, stray_scale, invalid })
    }

    /// Number of spheres that can be hit.
    pub fn len(&self) -> usize {
        self.spheres.len() + self.strays.len()
    }

    /// Returns whether nothing can be hit.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Spheres that were left out because they are invalid.
    pub fn invalid_spheres(&self) -> usize {
        self.invalid
    }

    fn tree(&self) -> Tree<'_> {
        Tree { bvh: &self.bvh, spheres: &self.spheres }
    }

    /// Bytes of tree and spheres.
    pub fn bytes(&self) -> usize {
        self.spheres.bytes() + self.bvh.bytes() + size_of_val(self.strays.as_slice())
    }

    /// Returns the first hit of a ray: of spheres at equal distances, the one of the lowest row. `None`
    /// if the ray hits nothing, or is invalid.
    pub fn intersect(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<Hit> {
        let ray = (origin, direction);
        let found = self.trace_one::<ClosestRounded>(ray, f64::INFINITY, &mut Tally::default())?;
        let Surface { point, normal } = self.surface(ray, &found);
        Some(Hit { sphere: found.id, t: found.t, point, normal })
    }

    /// Returns whether a ray hits anything at a distance less than `t_max`, in units of the
    /// direction's length.
    pub fn occluded(&self, origin: [f32; 3], direction: [f32; 3], t_max: f64) -> bool {
        self.trace_one::<Any>((origin, direction), t_max, &mut Tally::default()).is_some()
    }

    /// Finds the first hit of each ray: of spheres at equal distances, the one of the lowest row.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn intersect_columns(
        &self,
        rays: &RayColumns,
        mut hits: Hits,
    ) -> Result<Tally, QueryError> {
        let surfaces = hits.surface.as_ref().map_or(hits.t.len(), |column| column.len());
        rays.check(&[hits.t.len(), hits.sphere.len(), surfaces])?;
        hits.sphere.fill(NOTHING);
        Ok(self.run::<ClosestRounded>(rays, &mut hits))
    }

    /// Finds whether each ray hits anything nearer than its bound in `t`.
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
        Ok(self.run::<Any>(rays, &mut Occlusion { t, occluded }))
    }
}

/// A power of two that makes a number about 1, and its reciprocal; 1 for 0.
fn scale_of(largest: f64) -> [f64; 2] {
    let exponent = if largest > 0.0 { elementary::ceil_log2(largest) } else { 0 };
    [-exponent, exponent].map(elementary::power_of_two)
}

fn split([x, y, z, radius]: [f64; 4]) -> (DVec3, f64) {
    (DVec3::new(x, y, z), radius)
}
