//! Random spheres on a plane.

use super::group::{GenerateError, Group, require, require_radii, reserve_spheres};
use super::random::Random;
use crate::scene::{ConductorFresnel, Material, NamedMaterial, Rgb};
use glam::DVec3;

/// `count` times `count` spheres of random size at random positions, which rest on the plane y = 0
/// about the origin: the paper's field. Each stays in its own unit square, so that none overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Spheres along each side, 1 or more.
    pub count: u64,
    /// Least and greatest radius, more than 0 and at most 0.5; uniform between them.
    pub radius: [f64; 2],
    /// True if each sphere has its own color; glass stays clear.
    pub colors: bool,
    /// Fractions of diffuse, metal and glass spheres, 0 or more and not all 0; only their ratios count.
    /// Their materials are called `diffuse`, `metal` and `glass`. `None`: one material that the scene
    /// chooses.
    pub mix: Option<[f64; 3]>,
}

const GLASS: u32 = 2;

impl Default for Field {
    fn default() -> Self {
        Self { count: 20, radius: [0.1, 0.45], colors: true, mix: None }
    }
}

impl Field {
    /// Number of spheres, saturating.
    pub(super) fn len(&self) -> u64 {
        self.count.saturating_mul(self.count)
    }

    pub(super) fn generate(&self, seed: u64) -> Result<Group, GenerateError> {
        require_radii(self.radius)?;
        require(
            self.radius[1] <= 0.5,
            "radius",
            "must be at most 0.5: each cell is a unit square",
        )?;
        let [diffuse_end, metal_end] = self.thresholds()?;
        let mut spheres = reserve_spheres(self.len(), "count")?;
        let mut random = Random::new(seed);
        let side = self.count as f64;
        for cell in 0..self.len() {
            let corner = [cell % self.count, cell / self.count].map(|at| at as f64 - side / 2.0);
            let radius = random.between(self.radius[0], self.radius[1]);
            // Positions are drawn so that the sphere stays in its cell.
            let [x, z] = corner.map(|low| random.between(low + radius, low + 1.0 - radius));
            let fraction = random.unit();
            let material = u32::from(fraction >= diffuse_end) + u32::from(fraction >= metal_end);
            let color = random.pleasant_color();
            let colored = self.colors && material != GLASS;
            let color = if colored { color } else { Rgb::ONE };
            spheres.push(DVec3::new(x, radius, z), radius, material, color);
        }
        let materials = if self.mix.is_some() { materials() } else { Vec::new() };
        Ok(Group { spheres, materials })
    }

    /// Returns the ends of the diffuse and the metal spheres in 0..1.
    fn thresholds(&self) -> Result<[f64; 2], GenerateError> {
        let Some(mix) = self.mix else { return Ok([1.0; 2]) };
        let total: f64 = mix.iter().sum();
        let valid = mix.iter().all(|part| *part >= 0.0) && total > 0.0 && total.is_finite();
        require(valid, "mix", "must be [diffuse, metal, glass], each 0 or more, not all 0")?;
        // Without glass the last threshold is 1, whatever the rounding.
        let metal_end = if mix[2] > 0.0 { (mix[0] + mix[1]) / total } else { 1.0 };
        let diffuse_end = if mix[1] > 0.0 { mix[0] / total } else { metal_end };
        Ok([diffuse_end, metal_end])
    }
}

/// Returns the materials of a mix, in the order of its fractions.
fn materials() -> Vec<NamedMaterial> {
    let metal = ConductorFresnel::Schlick(Rgb::splat(0.95));
    let named = |name: &str, material| NamedMaterial { name: name.to_owned(), material };
    vec![
        named("diffuse", Material::Lambertian { color: Rgb::splat(0.9) }),
        named("metal", Material::Conductor { fresnel: metal, roughness: 0.1 }),
        named("glass", Material::Dielectric { ior: 1.5, color: Rgb::ONE }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_rest_on_the_plane_and_stay_in_their_cells() {
        for radius in [[0.1, 0.45], [0.5, 0.5], [1e-9, 0.5]] {
            let field = Field { count: 30, radius, ..Field::default() };
            let spheres = field.generate(7).unwrap_or_default().spheres;
            assert_eq!(spheres.len(), 900);
            for row in 0..900 {
                let (center, own) = (spheres.center(row), spheres.radius[row]);
                assert!(center.y == own && radius[0] <= own && own <= radius[1]);
                for (coordinate, cell) in [(center.x, row % 30), (center.z, row / 30)] {
                    let low = cell as f64 - 15.0;
                    // Sums of two doubles near 15 round by up to 2e-15.
                    let inside =
                        low - 4e-15 <= coordinate - own && coordinate + own <= low + 1.0 + 4e-15;
                    assert!(inside, "{coordinate} {own} {low}");
                }
            }
        }
    }

    #[test]
    fn spheres_do_not_overlap() {
        let spheres = Field::default().generate(2).unwrap_or_default().spheres;
        for first in 0..spheres.len() {
            for second in 0..first {
                let distance = spheres.center(first).distance(spheres.center(second));
                assert!(distance >= (spheres.radius[first] + spheres.radius[second]) - 1e-14);
            }
        }
    }

    #[test]
    fn mixes_keep_their_fractions() {
        let mix = Some([6.0, 3.0, 1.0]);
        let field = Field { count: 100, mix, ..Field::default() };
        let group = field.generate(1).unwrap_or_default();
        for (material, fraction) in [(0, 0.6), (1, 0.3), (2, 0.1)] {
            let rows = group.spheres.material.iter().filter(|row| **row == material).count();
            // Five standard deviations of a binomial count.
            let deviation = 5.0 * f64::sqrt(10_000.0 * fraction * (1.0 - fraction));
            assert!((rows as f64 - 10_000.0 * fraction).abs() < deviation, "{material}: {rows}");
        }
        let clear = |row: usize| group.spheres.material[row] != GLASS;
        assert!((0..10_000).all(|row| clear(row) || group.spheres.color[row] == Rgb::ONE));
        let positions = Field { count: 100, ..Field::default() }.generate(1).unwrap_or_default();
        assert_eq!(positions.spheres.x, group.spheres.x);
    }

    #[test]
    fn a_fraction_of_zero_gives_no_sphere() {
        for (mix, only) in [([0.1, 0.0, 0.0], 0), ([0.0, 0.3, 0.0], 1), ([0.0, 0.0, 7.0], 2)] {
            let field = Field { mix: Some(mix), ..Field::default() };
            let spheres = field.generate(1).unwrap_or_default().spheres;
            assert!((0..400).all(|row| spheres.material_of(row) == only), "{mix:?}");
        }
    }
}
