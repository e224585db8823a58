//! Area-preserving maps from the unit square to the disk, the hemisphere and the sphere.
//!
//! All use the concentric map, which keeps strata compact: neighbors in the square stay neighbors on
//! the sphere, so that low-discrepancy points keep their advantage. Local directions have z along the
//! axis; [`Basis`](super::Basis) transforms them to world axes.

use super::angles::octant_sine_cosine;
use super::hash::ONE_BELOW;
use crate::lanes::Lanes;
use crate::vec3;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

/// Returns the next point of a low-discrepancy sequence in the unit square (Roberts, "The Unreasonable
/// Effectiveness of Quasirandom Sequences", 2018).
#[inline(always)]
pub fn next_in_square<L: Lanes>([u, v]: [L; 2]) -> [L; 2] {
    let step = |x: L, by: f32| {
        let (x, one) = (x + L::splat(by), L::splat(1.0));
        L::select(x.lt(one), x, x - one).min(L::splat(ONE_BELOW))
    };
    [step(u, 0.754_877_7), step(v, 0.569_840_3)]
}

/// Density of [`uniform_sphere`] per steradian.
pub const UNIFORM_SPHERE_PDF: f32 = FRAC_1_PI / 4.0;

/// Maps `u` in [0, 1) to (-1, 1), odd about the middle of the grid of multiples of 2^-24.
///
/// Neither end is reached, and on that grid the result is exact and never 0.
#[inline(always)]
pub(super) fn centered<L: Lanes>(u: L) -> L {
    L::splat(2.0) * u - L::splat(ONE_BELOW)
}

/// Returns points in the unit disk, uniform by area, from two numbers in [0, 1) each.
///
/// Shirley & Chiu, "A Low Distortion Map Between Disk and Square", JGT 1997.
#[inline(always)]
pub fn concentric_disk<L: Lanes>(u: [L; 2]) -> [L; 2] {
    concentric(u).0
}

/// Returns the point of [`concentric_disk`] and its distance from the center, which is less than 1 even
/// if the coordinates are rounded. `1 - distance^2` is uniform in (0, 1].
#[inline(always)]
fn concentric<L: Lanes>([u, v]: [L; 2]) -> ([L; 2], L) {
    let (a, b) = (centered(u), centered(v));
    let steep = a.abs().lt(b.abs());
    let (longer, shorter) = (L::select(steep, b, a), L::select(steep, a, b));
    let (zero, radius) = (L::splat(0.0), longer.abs());
    let ratio = L::select(zero.lt(radius), shorter / longer, zero);
    let (sine, cosine) = octant_sine_cosine(L::splat(FRAC_PI_4) * ratio);
    let (along, across) = (longer * cosine, longer * sine);
    ([L::select(steep, across, along), L::select(steep, along, across)], radius)
}

/// Samples a local direction on the upper hemisphere with the density of [`cosine_hemisphere_pdf`].
///
/// Its z is more than 0: no sample lies in the tangent plane.
#[inline]
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    cosine_hemispheres(u).into()
}

/// [`cosine_hemisphere`] for a row of numbers.
#[inline(always)]
pub fn cosine_hemispheres<L: Lanes>(u: [L; 2]) -> vec3::Vec3<L> {
    let ([x, y], radius) = concentric(u);
    let one = L::splat(1.0);
    vec3::Vec3::new(x, y, ((one - radius) * (one + radius)).sqrt())
}

/// Returns the density of [`cosine_hemisphere`] per steradian: cos / pi; 0 for a cosine of 0 or less.
#[inline]
pub fn cosine_hemisphere_pdf(cosine: f32) -> f32 {
    cosine.max(0.0) * FRAC_1_PI
}

/// Samples a direction on the whole sphere with the density [`UNIFORM_SPHERE_PDF`].
#[inline]
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    cap::<f32>(u, 2.0).into()
}

/// Samples a direction uniform over the spherical cap about +z of height `height`, 0..=2: 1 - cos of
/// its half-angle.
///
/// Lambert's azimuthal equal-area projection, inverted: the squared distance from the disk's center
/// becomes 1 - cos.
#[inline(always)]
pub fn cap<L: Lanes>(u: [L; 2], height: L) -> vec3::Vec3<L> {
    let ([x, y], radius) = concentric(u);
    let drop = height * radius * radius;
    let scale = (height * (L::splat(2.0) - drop)).sqrt();
    vec3::Vec3::new(x * scale, y * scale, L::splat(1.0) - drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::ONE_BELOW;
    use crate::sampling::statistics::{Grid, assert_chi_squared, random_pairs};
    use glam::Vec2;
    use std::f64::consts::PI;

    #[test]
    fn hemisphere_and_sphere_follow_their_densities() {
        let samples =
            |of: fn([f32; 2]) -> Vec3| random_pairs(1_000_000, 3).map(move |u| Some(of(u)));
        let cosine = |direction: Vec3| cosine_hemisphere_pdf(direction.z);
        let sphere = Grid::cone(Vec3::Z, PI);
        Grid::hemisphere(Vec3::Z).check(samples(cosine_hemisphere), cosine, Some(0.0));
        sphere.check(samples(cosine_hemisphere), cosine, Some(0.0));
        sphere.check(samples(uniform_sphere), |_| UNIFORM_SPHERE_PDF, Some(0.0));
    }

    #[test]
    fn disk_is_uniform() {
        const CELLS: usize = 12;
        let mut observed = vec![0_u64; CELLS * CELLS];
        for u in random_pairs(100_000, 11) {
            let point = Vec2::from(concentric_disk(u)).as_dvec2();
            let turn = (point.y.atan2(point.x) / (2.0 * PI) + 1.0).fract();
            let ring = (point.length_squared() * CELLS as f64) as usize;
            observed[ring.min(CELLS - 1) * CELLS + (turn * CELLS as f64) as usize % CELLS] += 1;
        }
        assert_chi_squared(&observed, &[1.0 / (CELLS * CELLS) as f64; CELLS * CELLS]);
    }

    #[test]
    fn corners_and_middle_of_the_square() {
        let extremes = [0.0, f32::EPSILON / 2.0, 0.5 - f32::EPSILON / 4.0, 0.5, ONE_BELOW];
        for u in extremes {
            for v in extremes {
                let direction = cosine_hemisphere([u, v]);
                assert!(direction.z > 3e-4 && direction.is_normalized(), "{u} {v}: {direction}");
                assert!(concentric([u, v]).1 < 1.0);
                assert!(uniform_sphere([u, v]).is_normalized());
            }
        }
    }

    #[test]
    fn the_disk_map_is_symmetric() {
        for [u, v] in random_pairs(1000, 5) {
            let mirrored = [ONE_BELOW - u, ONE_BELOW - v];
            assert_eq!(concentric_disk([u, v]), concentric_disk(mirrored).map(|x: f32| -x));
        }
    }
}
