//! The GGX microfacet distribution, isotropic, sampled by visible normals.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; Heitz,
//! "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014; Dupuy and
//! Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.

use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Density of microfacet normals by solid angle, projected: integrates to 1 with the cosine.
pub fn distribution(alpha: f32, normal: Vec3) -> f32 {
    let a2 = alpha * alpha;
    // x^2 + y^2 instead of 1 - z^2, which would cancel for small alpha.
    let slope2 = normal.x * normal.x + normal.y * normal.y;
    let t = normal.z * normal.z + slope2 / a2;
    1.0 / (PI * a2 * t * t)
}

/// Smith's auxiliary function.
pub fn lambda(alpha: f32, direction: Vec3) -> f32 {
    let tangent2 =
        (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
    ((1.0 + alpha * alpha * tangent2).sqrt() - 1.0) / 2.0
}

/// Density of the normals that are visible from `outgoing`, by solid angle.
pub fn visible_normal_pdf(alpha: f32, outgoing: Vec3, normal: Vec3) -> f32 {
    let visible = outgoing.dot(normal).max(0.0) / (outgoing.z * (1.0 + lambda(alpha, outgoing)));
    visible * distribution(alpha, normal)
}

/// A normal in proportion to how much it is visible from `outgoing`.
pub fn sample_visible_normal(alpha: f32, outgoing: Vec3, u: [f32; 2]) -> Vec3 {
    // As if the surface were the unit hemisphere.
    let stretched = Vec3::new(alpha * outgoing.x, alpha * outgoing.y, outgoing.z).normalize();
    // Mirroring a point of the cap that `stretched` is the axis' mirror image of gives the normal.
    let z = (1.0 - u[1]).mul_add(1.0 + stretched.z, -stretched.z);
    let sine = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * u[0]).sin_cos();
    let halfway = Vec3::new(sine * cos_phi, sine * sin_phi, z) + stretched;
    Vec3::new(alpha * halfway.x, alpha * halfway.y, halfway.z.max(0.0)).normalize_or(Vec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::{Grid, random_pairs};
    use crate::sampling::uniform_sphere;
    use crate::shade::tests::{at, numbers};

    /// The projected area of the facets is that of the surface; visible ones have density 1.
    #[test]
    fn densities_integrate_to_one() {
        let n = 400_000;
        for alpha in [0.2, 0.5, 1.0] {
            let outgoing = Vec3::new(0.8, 0.0, 0.6);
            let (mut area, mut visible) = (0.0, 0.0);
            for u in numbers(7, n) {
                let mut normal = uniform_sphere([u[0], u[1]]);
                normal.z = normal.z.abs();
                area += f64::from(distribution(alpha, normal) * normal.z);
                visible += f64::from(visible_normal_pdf(alpha, outgoing, normal));
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
                let samples = random_pairs(400_000, 8)
                    .map(|u| Some(sample_visible_normal(alpha, outgoing, u)));
                let pdf = |normal| visible_normal_pdf(alpha, outgoing, normal);
                let grid = Grid { angle: 0.5 * f64::from(PI), ..Grid::lobe(Vec3::Z) };
                grid.check(samples, pdf, Some(0.0));
            }
        }
    }
}
