//! Exact queries for other programs: columns of spheres in, hits out.
//!
//! A [`SphereTree`] takes spheres and rays bit by bit as they are, of any scale, directions of any
//! length, and answers which sphere a ray hits first, or whether it hits any, as arithmetic without
//! rounding would. To keep the conservative test within its range it multiplies coordinates
//! by a power of two, which is exact, and nothing else is done to them.

mod answers;
mod batch;
mod chunk;
mod columns;
mod error;
mod found;
mod load;
mod plain_ray;
mod reorder;
mod scaled_ray;
mod strays;
mod surface;

pub use columns::{Hit, Hits, NOTHING, RayColumns, RayRows, Surface, Tally};
pub use error::QueryError;

use crate::bvh::Bvh;
use crate::bvh::builders::{Builder, Item, Precise, build_items, collected};
use crate::bvh::{Any, ClosestRounded, Tree};
use crate::elementary;
use crate::lanes::F32x4;
use crate::spheres::Spheres;
use crate::vec3::Vec3 as Coordinates;
use answers::Occlusion;
use columns::{RayTable, same_length};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use scaled_ray::{REACH, REACH_IN_LEAVES, ScaledRay};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use strays::Largest;

/// Number of spheres that are worth a task.
const TASK: usize = 1 << 12;

/// Spheres, ready for exact queries.
#[derive(Clone, Debug)]
pub struct SphereTree {
    spheres: Spheres,
    bvh: Bvh,
    /// A power of two, which makes the largest coordinate in the tree about 1, and its reciprocal.
    scale: [f64; 2],
    /// [`SphereTree::scale`] in single precision, in lanes; NaN if it is beyond that, so that no product is exact.
    single_scale: [F32x4; 2],
    /// No ray in the tree's units is traced with others whose origin has a larger coordinate; in lanes.
    reach: F32x4,
    /// Centers, radii and ids of the spheres that are not in the tree ([`strays`]), in their own units.
    strays: Vec<(DVec3, f64, u32)>,
    /// A power of two, which makes their largest coordinate about 1, and its reciprocal.
    stray_scale: [f64; 2],
    invalid: usize,
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

    /// Builds the tree over spheres in rows of centers, with a column of radii; otherwise as
    /// [`SphereTree::from_columns`].
    ///
    /// ```
    /// use spherule_core::SphereTree;
    ///
    /// let rows = SphereTree::from_centers(&[[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]], &[1.0, 0.5])?;
    /// let columns = SphereTree::from_columns(&[0.0, 3.0], &[1.0, 4.0], &[2.0, 5.0], &[1.0, 0.5])?;
    /// for direction in [[0.1, 1.0, 2.0], [3.1, 4.0, 5.0], [1.0, 0.0, 0.0]] {
    ///     assert_eq!(rows.intersect([0.0; 3], direction), columns.intersect([0.0; 3], direction));
    /// }
    /// assert!(rows.intersect([0.0; 3], [3.1, 4.0, 5.0]).is_some());
    /// assert!(SphereTree::from_centers(&[[0.0; 3]], &[]).is_err());
    /// # Ok::<(), spherule_core::QueryError>(())
    /// ```
    ///
    /// # Errors
    /// Columns of different lengths, or more than [`Spheres::MAX`] spheres.
    pub fn from_centers(centers: &[[f32; 3]], radius: &[f32]) -> Result<Self, QueryError> {
        same_length(centers.len(), &[radius.len()])?;
        Self::build(centers.len(), |i| {
            let [x, y, z] = centers[i];
            [x, y, z, radius[i]]
        })
    }

    fn build(count: usize, row: impl Fn(usize) -> [f32; 4] + Sync) -> Result<Self, QueryError> {
        if count > Spheres::MAX {
            return Err(QueryError::TooMany(count));
        }
        let is_valid = |[x, y, z, radius]: [f32; 4]| {
            x.is_finite()
                && y.is_finite()
                && z.is_finite()
                && radius > 0.0
                && radius < f32::INFINITY
        };
        let extent = |[x, y, z, radius]: [f32; 4]| {
            f64::from(x.abs().max(y.abs()).max(z.abs())) + f64::from(radius)
        };
        // The largest extents, and how many spheres are valid.
        let census = |chunk: usize| {
            let rows = (chunk * TASK..count.min((chunk + 1) * TASK)).map(&row);
            rows.filter(|&row| is_valid(row)).fold(
                (Largest::NONE, 0),
                |(mut largest, valid), row| {
                    largest.add(extent(row));
                    (largest, valid + 1)
                },
            )
        };
        let sum = |a: (Largest, usize), b: (Largest, usize)| (a.0.union(&b.0), a.1 + b.1);
        let chunks = (0..count.div_ceil(TASK)).into_par_iter();
        let (largest, valid) = chunks.map(census).reduce(|| (Largest::NONE, 0), sum);
        let most = largest.of_most();
        let [scale, unscale] = scale_of(most);
        let stray_scale = scale_of(largest.of_all());
        let scaled = |i: usize| row(i).map(|value| f64::from(value) * scale);
        let (is_rounded, is_fine) = (AtomicBool::new(false), AtomicBool::new(false));
        let item = |i: usize| {
            let scaled = scaled(i);
            let sphere = scaled.map(|value| value as f32);
            if sphere.map(f64::from) != scaled {
                is_rounded.store(true, Relaxed);
            }
            if !Coordinates::from(Vec3::from_slice(&sphere[..3])).is_coarse() {
                is_fine.store(true, Relaxed);
            }
            Item { sphere, id: i as u32 }
        };
        let mut strays = Vec::new();
        let items = if valid == count && most == largest.of_all() {
            collected(count, item)
        } else {
            let mut items = Vec::with_capacity(valid);
            for i in (0..count).filter(|&i| is_valid(row(i))) {
                if extent(row(i)) > most {
                    let wide = row(i).map(|value| f64::from(value) * stray_scale[0]);
                    let (center, radius) = split(wide);
                    strays.push((center, radius, i as u32));
                } else {
                    items.push(item(i));
                }
            }
            items
        };
        let mut precise = Precise::default();
        let is_rounded = is_rounded.into_inner();
        if is_rounded {
            // Scales so far apart that the smallest numbers leave single precision.
            precise.id = items.iter().map(|item| item.id).collect();
            precise.sphere = precise.id.iter().map(|&i| split(scaled(i as usize))).collect();
        }
        let (mut spheres, bvh) = build_items(items, &precise, Builder::default());
        spheres.coarse = !is_rounded && !is_fine.into_inner();
        let reach = (bvh.mean_leaf_extent() * REACH_IN_LEAVES).clamp(4.0, REACH);
        let (scale, invalid) = ([scale, unscale], count - valid);
        let (single_scale, reach) = (single_scale(scale).map(F32x4::splat), F32x4::splat(reach));
        Ok(Self { spheres, bvh, scale, single_scale, reach, strays, stray_scale, invalid })
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
    #[inline]
    pub fn intersect(&self, [x, y, z]: [f32; 3], [dx, dy, dz]: [f32; 3]) -> Option<Hit> {
        self.intersect_numbers(x, y, z, dx, dy, dz)
    }

    /// [`SphereTree::intersect`] for numbers in registers: arrays would go through memory, where what was written one by
    /// one cannot be read at once without delay.
    #[inline(never)]
    fn intersect_numbers(&self, x: f32, y: f32, z: f32, dx: f32, dy: f32, dz: f32) -> Option<Hit> {
        let (origin, direction) = ([x, y, z], [dx, dy, dz]);
        let hit = self.intersect_plain(origin, direction, f64::INFINITY);
        hit.unwrap_or_else(|_| self.intersect_closely(origin, direction, f64::INFINITY))
    }

    /// Returns what [`SphereTree::intersect`] does if it is hit at a distance less than `t_max`, in units of the direction's
    /// length: what lies farther is not looked at. A true distance that is less by no more than half a unit of the last place
    /// is rounded to `t_max`. `None` if `t_max` is NaN.
    ///
    /// ```
    /// let tree = spherule_core::SphereTree::from_columns(&[0.0], &[0.0], &[5.0], &[1.0])?;
    /// let hit = |t_max| tree.intersect_within([0.0; 3], [0.0, 0.0, 2.0], t_max).map(|hit| hit.t);
    /// assert_eq!([hit(1.0), hit(2.0), hit(2.5)], [None, None, Some(2.0)]);
    /// # Ok::<(), spherule_core::QueryError>(())
    /// ```
    #[inline]
    pub fn intersect_within(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        t_max: f64,
    ) -> Option<Hit> {
        let ([x, y, z], [dx, dy, dz]) = (origin, direction);
        self.intersect_numbers_within(x, y, z, dx, dy, dz, t_max)
    }

    /// [`SphereTree::intersect_within`] for numbers in registers, as [`SphereTree::intersect_numbers`].
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "a struct would go through memory")]
    fn intersect_numbers_within(
        &self,
        x: f32,
        y: f32,
        z: f32,
        dx: f32,
        dy: f32,
        dz: f32,
        t_max: f64,
    ) -> Option<Hit> {
        let (origin, direction) = ([x, y, z], [dx, dy, dz]);
        let hit = self.intersect_plain(origin, direction, t_max);
        hit.unwrap_or_else(|_| self.intersect_closely(origin, direction, t_max))
    }

    /// Does what [`SphereTree::intersect_within`] does for any ray.
    #[inline(never)]
    fn intersect_closely(&self, origin: [f32; 3], direction: [f32; 3], t_max: f64) -> Option<Hit> {
        let ray = (origin, direction);
        let scaled = ScaledRay::new(ray, self.scale).filter(|_| !t_max.is_nan())?;
        let tally = &mut Tally::default();
        let found = self.trace_scaled::<ClosestRounded>(ray, &scaled, t_max, tally)?;
        let Surface { point, normal } = self.surface(ray, &scaled, &found);
        Some(Hit { sphere: found.id, t: found.t, point, normal })
    }

    /// Returns whether a ray hits anything at a distance less than `t_max`, in units of the
    /// direction's length.
    #[inline]
    pub fn occluded(&self, origin: [f32; 3], direction: [f32; 3], t_max: f64) -> bool {
        let ([x, y, z], [dx, dy, dz]) = (origin, direction);
        self.occluded_numbers(x, y, z, dx, dy, dz, t_max)
    }

    /// [`SphereTree::occluded`] for numbers in registers, as [`SphereTree::intersect_numbers`].
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "a struct would go through memory")]
    fn occluded_numbers(
        &self,
        x: f32,
        y: f32,
        z: f32,
        dx: f32,
        dy: f32,
        dz: f32,
        t_max: f64,
    ) -> bool {
        let (origin, direction) = ([x, y, z], [dx, dy, dz]);
        let occluded = self.occluded_plain(origin, direction, t_max);
        occluded.unwrap_or_else(|| self.occluded_closely(origin, direction, t_max))
    }

    /// Does what [`SphereTree::occluded`] does for any ray.
    #[inline(never)]
    fn occluded_closely(&self, origin: [f32; 3], direction: [f32; 3], t_max: f64) -> bool {
        self.trace_one::<Any>((origin, direction), t_max, &mut Tally::default()).is_some()
    }

    /// Finds the first hit of each ray: of spheres at equal distances, the one of the lowest row.
    ///
    /// Rays in an order, as those of the pixels of an image are, are traced in that order. If a thousand and more come in none,
    /// they are sorted before, which takes up to 13 MB; the thread keeps them for its next call.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn intersect_columns(&self, rays: &RayColumns, hits: Hits) -> Result<Tally, QueryError> {
        self.intersect_all(rays, hits)
    }

    /// Finds whether each ray hits anything nearer than its bound in `t`. The order of rays matters as little as to
    /// [`SphereTree::intersect_columns`].
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn occluded_columns(
        &self,
        rays: &RayColumns,
        t: &[f64],
        occluded: &mut [bool],
    ) -> Result<Tally, QueryError> {
        self.occluded_all(rays, t, occluded)
    }

    /// Does what [`SphereTree::intersect_columns`] does, for rays in rows.
    ///
    /// ```
    /// use spherule_core::{Hits, RayRows, SphereTree};
    ///
    /// let tree = SphereTree::from_columns(&[0.0], &[0.0], &[5.0], &[1.0])?;
    /// let rays = RayRows { origin: &[[0.0; 3]; 2], direction: &[[0.0, 0.0, 2.0], [0.0, 1.0, 0.0]] };
    /// let (mut t, mut sphere) = ([f64::INFINITY; 2], [0; 2]);
    /// tree.intersect_rows(&rays, Hits { t: &mut t, sphere: &mut sphere, surface: None })?;
    /// assert_eq!((t, sphere), ([2.0, f64::INFINITY], [0, spherule_core::NOTHING]));
    /// # Ok::<(), spherule_core::QueryError>(())
    /// ```
    ///
    /// # Errors
    /// Slices of different lengths.
    pub fn intersect_rows(&self, rays: &RayRows, hits: Hits) -> Result<Tally, QueryError> {
        self.intersect_all(rays, hits)
    }

    /// Does what [`SphereTree::occluded_columns`] does, for rays in rows.
    ///
    /// # Errors
    /// Slices of different lengths.
    pub fn occluded_rows(
        &self,
        rays: &RayRows,
        t: &[f64],
        occluded: &mut [bool],
    ) -> Result<Tally, QueryError> {
        self.occluded_all(rays, t, occluded)
    }

    fn intersect_all(&self, rays: &impl RayTable, mut hits: Hits) -> Result<Tally, QueryError> {
        let surfaces = hits.surface.as_ref().map_or(hits.t.len(), |column| column.len());
        rays.check(&[hits.t.len(), hits.sphere.len(), surfaces])?;
        hits.sphere.fill(NOTHING);
        Ok(self.run::<ClosestRounded>(rays, &mut hits, None))
    }

    fn occluded_all(
        &self,
        rays: &impl RayTable,
        t: &[f64],
        occluded: &mut [bool],
    ) -> Result<Tally, QueryError> {
        rays.check(&[t.len(), occluded.len()])?;
        occluded.fill(false);
        Ok(self.run::<Any>(rays, &mut Occlusion { t, occluded }, None))
    }
}

/// A power of two that makes a number about 1, and its reciprocal; 1 for 0.
fn scale_of(largest: f64) -> [f64; 2] {
    let exponent = if largest > 0.0 { elementary::ceil_log2(largest) } else { 0 };
    [-exponent, exponent].map(elementary::power_of_two)
}

/// A scale and its reciprocal in single precision; NaN if they are beyond that.
fn single_scale(scale: [f64; 2]) -> [f32; 2] {
    let single = scale.map(|x| x as f32);
    let holds = single.map(f64::from) == scale && single.iter().all(|x| x.is_normal());
    if holds { single } else { [f32::NAN; 2] }
}

fn split([x, y, z, radius]: [f64; 4]) -> (DVec3, f64) {
    (DVec3::new(x, y, z), radius)
}
