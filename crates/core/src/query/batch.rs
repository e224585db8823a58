//! Batches of rays: those that single precision holds are traced in packets, the others one by one.

use super::columns::{RayColumns, Surface, Tally};
use super::scaled_ray::ScaledRay;
use super::{NOTHING, SphereTree, load};
use crate::bvh::{Query, Traversal, trace};
use crate::exact;
use crate::lanes::F32x16;
use crate::ray::{self, MISS, Rays};

/// Rays that are traced together.
pub(super) const CHUNK: usize = 2048;

/// A hit.
pub(super) struct FoundHit {
    /// The sphere's row in the tree.
    pub(super) sphere: usize,
    /// The sphere's row in the user's columns; [`NOTHING`] if nobody asks which.
    pub(super) id: u32,
    /// In units of the user's direction; unspecified if any hit was looked for.
    pub(super) t: f64,
}

impl SphereTree {
    /// Traces rays in chunks that stay in the second-level cache; `bound` is where the search for each
    /// ends.
    pub(super) fn run<Q: Query>(
        &self,
        columns: &RayColumns,
        bound: impl Fn(usize) -> f64,
        mut found: impl FnMut(usize, &FoundHit),
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
                |row: usize| plain.packets[row / load::PACKET] && !bound(first + row).is_nan();
            for (row, i) in rows.clone().enumerate() {
                // Nothing counts below 0: what is not plain is not traced here.
                let bound = if is_plain(row) { bound(i) * self.scale * stretch(row) } else { -1.0 };
                hits.set(row, bound, MISS);
            }
            tally.exact += trace::<F32x16, Q>(Traversal::Auto, self.tree(), &rays, &mut hits);
            for (row, i) in rows.enumerate() {
                if !is_plain(row) {
                    let hit = self.trace_one::<Q>(columns.row(i), bound(i), &mut tally);
                    if let Some(hit) = hit {
                        found(i, &hit);
                    }
                } else if hits.sphere[row] != MISS {
                    let sphere = hits.sphere[row] as usize;
                    let id = if Q::ANY { NOTHING } else { self.spheres.id[sphere] };
                    found(i, &FoundHit { sphere, id, t: hits.t[row] * unit(row) });
                }
            }
        }
        tally
    }

    pub(super) fn surface(
        &self,
        (origin, direction): ([f32; 3], [f32; 3]),
        found: &FoundHit,
    ) -> Surface {
        /// Beyond this many radii, double precision shows its limits.
        const FAR: f64 = (1 << 20) as f64;
        let Some(ScaledRay { ray, unit }) = self.scaled(origin, direction) else {
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
