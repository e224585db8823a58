//! Points and normals of hits.

use super::answers::FoundHit;
use super::columns::RayTable;
use super::scaled_ray::ScaledRay;
use super::{SphereTree, Surface};
use crate::exact;
use crate::intersect::{Pair, Pairs};
use crate::lanes::{Doubles, F64x8, Mask, set_bits};
use crate::ray::{ExactRay, Hits, Rays};
use crate::vec3::Vec3;
use glam::DVec3;

/// Beyond this many radii from a sphere, double precision shows its limits.
const FAR: f64 = (1 << 20) as f64;

/// Number of hits whose surfaces are computed together.
const LANES: usize = 8;

/// Hits of a chunk whose surfaces are still to be computed.
pub(super) struct PendingSurfaces {
    count: usize,
    /// Rows of rays in the chunk, and of spheres.
    pairs: [Pair; LANES],
    /// The caller's rows of the rays.
    of: [usize; LANES],
}

impl PendingSurfaces {
    pub(super) const NONE: Self =
        Self { count: 0, pairs: [Pair { row: 0, sphere: 0 }; LANES], of: [0; LANES] };

    /// Adds a hit; the caller flushes when it returns true.
    #[inline(always)]
    pub(super) fn push(&mut self, pair: Pair, of: usize) -> bool {
        (self.pairs[self.count % LANES], self.of[self.count % LANES]) = (pair, of);
        self.count += 1;
        self.count == LANES
    }
}

impl SphereTree {
    /// Returns the surface where a ray has hit a sphere; the ray is given in the tree's units as well.
    #[inline(always)]
    pub(super) fn surface(
        &self,
        ray: ([f32; 3], [f32; 3]),
        scaled: &ScaledRay,
        found: &FoundHit,
    ) -> Surface {
        // Strays have units of their own.
        let Some(stray) = found.sphere.checked_sub(self.spheres.len()) else {
            return scaled.surface(self.spheres.exact(found.sphere), found.t, self.scale[1]);
        };
        let (center, radius, _) = self.strays[stray];
        let scaled = ScaledRay::new(ray, self.stray_scale);
        let of = |scaled: ScaledRay| scaled.surface((center, radius), found.t, self.stray_scale[1]);
        scaled.map_or(Surface::default(), of)
    }

    /// Returns what [`SphereTree::surface`] does.
    #[inline(never)]
    pub(super) fn surface_of_ray(&self, ray: ([f32; 3], [f32; 3]), found: &FoundHit) -> Surface {
        let scaled = ScaledRay::new(ray, self.scale);
        scaled.map_or(Surface::default(), |scaled| self.surface(ray, &scaled, found))
    }

    /// Writes the surfaces of pending hits to the caller's rows.
    pub(super) fn flush_surfaces(
        &self,
        pending: &mut PendingSurfaces,
        rays: &Rays,
        hits: &Hits,
        table: &impl RayTable,
        unit: impl Fn(usize) -> f64,
        surfaces: &mut [Surface],
    ) {
        let count = std::mem::take(&mut pending.count);
        if count == 0 {
            return;
        }
        // Unused lanes repeat the first hit.
        let first = pending.pairs[0];
        pending.pairs[count..].fill(first);
        let t = pending.pairs.map(|pair| hits.t[pair.row as usize]);
        let pairs = Pairs::gather(rays, &self.spheres, &pending.pairs);
        let (clear, normal) = normals(&pairs, F64x8::new(t));
        let scale = F64x8::splat(self.scale[1]);
        let point = (normal * pairs.radius + pairs.center) * scale;
        let coordinates = |v: Vec3<F64x8>| [v.x, v.y, v.z].map(F64x8::to_array);
        let (point, normal) = (coordinates(point), coordinates(normal));
        for lane in 0..count {
            let row = |columns: &[[f64; LANES]; 3]| [0, 1, 2].map(|axis| columns[axis][lane]);
            surfaces[pending.of[lane]] = Surface { point: row(&point), normal: row(&normal) };
        }
        for lane in set_bits(!clear.bits() & ((1 << count) - 1)) {
            let (Pair { row, sphere }, of) = (pending.pairs[lane], pending.of[lane]);
            let t = hits.t[row as usize] * unit(row as usize);
            let found = FoundHit { sphere: sphere as usize, id: 0, t };
            surfaces[of] = self.surface_of_ray(table.row(of), &found);
        }
    }
}

impl ScaledRay {
    /// Returns the surface where the ray hits a sphere at a distance in the user's units.
    fn surface(&self, sphere: (DVec3, f64), t: f64, unscale: f64) -> Surface {
        let pair = Pairs::one(&self.ray, sphere.0, sphere.1);
        surface_of(&pair, || (self.ray, sphere), t / self.unit, unscale)
    }
}

/// Returns the surface where a ray hits a sphere, at a distance in their units; `of` returns both again.
#[inline(always)]
pub(super) fn surface_of(
    pair: &Pairs<f64>,
    of: impl Fn() -> (ExactRay, (DVec3, f64)),
    t: f64,
    unscale: f64,
) -> Surface {
    let (clear, normal) = normals(pair, t);
    let normal = if clear {
        normal
    } else {
        let (ray, (center, radius)) = of();
        exact::normal(&ray, center, radius).into()
    };
    let point = (normal * pair.radius + pair.center) * unscale;
    Surface { point: point.into(), normal: normal.into() }
}

/// Returns the outward unit normals where rays hit spheres at distances `t`, in lanes in which double precision
/// suffices, which are the first result. Every operation is rounded by itself, so lanes equal single values.
#[inline(always)]
fn normals<D: Doubles>(pairs: &Pairs<D>, t: D) -> (D::Mask, Vec3<D>) {
    // The difference first, which loses nothing where both are far from the coordinates' origin.
    let from_center = pairs.origin - pairs.center;
    let distance = from_center.dot_unfused(from_center).sqrt();
    let normal = from_center + pairs.direction * t;
    let inverse = normal.inverse_length();
    let finite = D::splat(0.0).lt(inverse) & inverse.lt(D::splat(f64::INFINITY));
    (!(pairs.radius * D::splat(FAR)).lt(distance) & finite, normal * inverse)
}
