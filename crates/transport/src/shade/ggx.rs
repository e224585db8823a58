//! The GGX microfacet distribution, isotropic, sampled by visible normals.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; Heitz,
//! "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014; Dupuy and
//! Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.

use crate::lanes::Lanes;
use crate::sampling::cap;
use crate::vec3::Vec3;
use std::f32::consts::PI;

/// Returns the density of microfacet normals by solid angle, projected: integrates to 1 with the
/// cosine.
#[inline(always)]
pub fn distribution<L: Lanes>(alpha: L, normal: Vec3<L>) -> L {
    let a2 = alpha * alpha;
    // Not 1 - z^2, which would cancel for small alpha.
    let slope2 = normal.x * normal.x + normal.y * normal.y;
    let t = normal.z * normal.z + slope2 / a2;
    L::splat(1.0) / (L::splat(PI) * a2 * t * t)
}

/// Returns Smith's auxiliary function Lambda.
#[inline(always)]
pub fn lambda<L: Lanes>(alpha: L, direction: Vec3<L>) -> L {
    let one = L::splat(1.0);
    let tangent2 =
        (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
    ((one + alpha * alpha * tangent2).sqrt() - one) * L::splat(0.5)
}

/// Returns the density by solid angle of the normals that are visible from `outgoing`.
#[inline(always)]
pub fn visible_normal_pdf<L: Lanes>(alpha: L, outgoing: Vec3<L>, normal: Vec3<L>) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let seen = outgoing.z * (one + lambda(alpha, outgoing));
    outgoing.dot(normal).max(zero) / seen * distribution(alpha, normal)
}

/// Samples normals in proportion to their visible area from `outgoing`.
#[inline(always)]
pub fn sample_visible_normal<L: Lanes>(alpha: L, outgoing: Vec3<L>, u: [L; 2]) -> Vec3<L> {
    // Stretching transforms the surface to the unit hemisphere.
    let stretched = Vec3::new(alpha * outgoing.x, alpha * outgoing.y, outgoing.z).normalize();
    // The normal mirrors `stretched` to a point of the cap, which is the mirror image of the axis.
    let halfway = cap(u, L::splat(1.0) + stretched.z) + stretched;
    let up = halfway.z.max(L::splat(0.0));
    upward(Vec3::new(alpha * halfway.x, alpha * halfway.y, up))
}

/// Normalizes vectors; a zero vector becomes z.
#[inline(always)]
pub fn upward<L: Lanes>(direction: Vec3<L>) -> Vec3<L> {
    let long = L::splat(0.0).lt(direction.dot(direction));
    Vec3::select_lanes(long, direction.normalize(), Vec3::splat(0.0, 0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::{Grid, random_pairs};
    use crate::sampling::uniform_sphere;
    use crate::shade::tests::{at, numbers};
    use glam::Vec3;
    use std::f32::consts::TAU;

    /// Checks that the projected area of the facets is that of the surface, and that the density of
    /// visible ones integrates to 1.
    #[test]
    fn densities_integrate_to_one() {
        let n = 400_000;
        for alpha in [0.2, 0.5, 1.0] {
            let outgoing = Vec3::new(0.8, 0.0, 0.6);
            let (mut area, mut visible) = (0.0, 0.0);
            for u in numbers(7, n) {
                let mut normal = uniform_sphere([u[0], u[1]]);
                normal.z = normal.z.abs();
                area += f64::from(distribution(alpha, normal.into()) * normal.z);
                visible += f64::from(visible_normal_pdf(alpha, outgoing.into(), normal.into()));
            }
            let scale = f64::from(TAU) / n as f64;
            assert!((area * scale - 1.0).abs() < 0.05, "alpha {alpha}: {}", area * scale);
            assert!((visible * scale - 1.0).abs() < 0.05, "alpha {alpha}: {}", visible * scale);
        }
    }

    #[test]
    fn samples_follow_the_density() {
        for alpha in [0.02, 0.1, 0.3, 0.7, 1.0] {
            for cosine in [1.0, 0.7, 0.2, 0.02] {
                let outgoing = at(cosine);
                let samples = random_pairs(200_000, 8)
                    .map(|u| Some(sample_visible_normal(alpha, outgoing.into(), u).into()));
                let pdf = |normal: Vec3| visible_normal_pdf(alpha, outgoing.into(), normal.into());
                let grid = Grid { angle: 0.5 * f64::from(PI), ..Grid::lobe(Vec3::Z) };
                grid.check(samples, pdf, Some(0.0));
            }
        }
    }
}
