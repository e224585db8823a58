//! A face-centered cubic crystal.

use super::group::{GenerateError, Group, require, require_radius, reserve_spheres};
use super::random::Random;
use crate::scene::Rgb;
use glam::DVec3;
use std::f64::consts::SQRT_2;

/// Touching spheres at the sites of a face-centered cubic crystal about the origin, with thermal
/// displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Unit cells along each edge, 1 or more; every cell has four spheres.
    pub count: u64,
    /// Radius, more than 0; neighbors are two radii apart and cells `2 sqrt(2)` radii wide.
    pub radius: f64,
    /// Standard deviation of the displacement along each axis, in distances between neighbors, 0 or
    /// more; 0.03 is a warm crystal.
    pub jitter: f64,
}

impl Default for Lattice {
    fn default() -> Self {
        Self { count: 10, radius: 0.5, jitter: 0.0 }
    }
}

/// Sites in a unit cell, in fractional coordinates.
const SITES: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];

impl Lattice {
    /// Number of spheres, saturating.
    pub(super) fn len(&self) -> u64 {
        self.count.saturating_pow(3).saturating_mul(4)
    }

    pub(super) fn generate(&self, seed: u64) -> Result<Group, GenerateError> {
        require_radius(self.radius)?;
        let jitter = self.jitter.is_finite() && self.jitter >= 0.0;
        require(jitter, "jitter", "must be finite and 0 or more")?;
        let mut spheres = reserve_spheres(self.len(), "count")?;
        let mut random = Random::new(seed);
        let deviation = self.jitter * 2.0 * self.radius;
        for cell in 0..self.count.pow(3) {
            for site in SITES {
                let displacement = [(); 3].map(|()| random.normal());
                let center = self.center(cell, site) + DVec3::from_array(displacement) * deviation;
                spheres.push(center, self.radius, 0, Rgb::ONE);
            }
        }
        Ok(Group { spheres, ..Group::default() })
    }

    /// Returns the center of a sphere without displacement.
    fn center(&self, cell: u64, site: [f64; 3]) -> DVec3 {
        let side = self.count;
        let corner = [cell % side, cell / side % side, cell / (side * side)].map(|at| at as f64);
        // The bounds of all sites are half a cell less than the cells.
        let middle = (side as f64 - 0.5) / 2.0;
        let cells = DVec3::from_array(corner) + DVec3::from_array(site) - middle;
        cells * (2.0 * SQRT_2 * self.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_inner_sphere_touches_twelve() {
        let spheres = Lattice::default().generate(0).unwrap_or_default().spheres;
        assert_eq!(spheres.len(), 4000);
        let middle = (0..4000).min_by(|&first, &second| {
            spheres.center(first).length().total_cmp(&spheres.center(second).length())
        });
        let center = spheres.center(middle.unwrap_or_default());
        let distances = (0..4000).map(|row| spheres.center(row).distance(center));
        let touching = distances.clone().filter(|distance| (distance - 1.0).abs() < 1e-12).count();
        let nearer = distances.filter(|&distance| distance < 0.999_999).count();
        assert_eq!((touching, nearer), (12, 1));
        let mean = (0..4000).map(|row| spheres.center(row)).sum::<DVec3>() / 4000.0;
        assert!(mean.length() < 1e-12);
    }

    #[test]
    fn displacements_have_their_deviation() {
        let warm = Lattice { jitter: 0.03, radius: 2.0, ..Lattice::default() };
        let cold = Lattice { jitter: 0.0, ..warm };
        let [warm, cold] =
            [&warm, &cold].map(|lattice| lattice.generate(3).unwrap_or_default().spheres);
        let square: f64 =
            warm.x.iter().zip(&cold.x).map(|(warm, cold)| (warm - cold).powi(2)).sum();
        let deviation = (square / 4000.0).sqrt();
        // Standard error of a deviation from 4000 numbers: 1.1 %.
        assert!((deviation / (0.03 * 4.0) - 1.0).abs() < 0.06, "{deviation}");
    }
}
