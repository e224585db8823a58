//! Random spheres in a cube.

use super::group::{GenerateError, Group, require, require_radii, reserve_spheres};
use super::random::Random;
use crate::elementary::cbrt;
use crate::scene::Rgb;
use glam::DVec3;

/// Spheres of random size whose centers are uniform in a cube about the origin. They may overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Number of spheres, 1 or more.
    pub count: u64,
    /// Edge of the cube, more than 0; `None` is the cube root of `count`, which makes the mean spacing
    /// 1.
    pub size: Option<f64>,
    /// Least and greatest radius, more than 0; uniform between them. `None` is 0.2 to 0.4 of the mean
    /// spacing.
    pub radius: Option<[f64; 2]>,
    /// True if each sphere has its own color.
    pub colors: bool,
}

impl Default for Volume {
    fn default() -> Self {
        Self { count: 10_000, size: None, radius: None, colors: false }
    }
}

impl Volume {
    pub(super) fn generate(&self, seed: u64) -> Result<Group, GenerateError> {
        let across = cbrt(self.count as f64);
        let size = self.size.unwrap_or(across);
        let mut spheres = reserve_spheres(self.count, "count")?;
        require(size.is_finite() && size > 0.0, "size", "must be finite and more than 0")?;
        let radii =
            self.radius.unwrap_or_else(|| [0.2, 0.4].map(|fraction| fraction * (size / across)));
        require_radii(radii)?;
        let mut random = Random::new(seed);
        for _ in 0..self.count {
            let [x, y, z] = [(); 3].map(|()| random.between(-size / 2.0, size / 2.0));
            let radius = random.between(radii[0], radii[1]);
            let color = if self.colors { random.pleasant_color() } else { Rgb::ONE };
            spheres.push(DVec3::new(x, y, z), radius, 0, color);
        }
        Ok(Group { spheres, ..Group::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centers_fill_the_cube_and_radii_their_range() {
        let spheres = Volume::default().generate(1).unwrap_or_default().spheres;
        let half = 10_000_f64.cbrt() / 2.0;
        for column in [&spheres.x, &spheres.y, &spheres.z] {
            let least = column.iter().copied().fold(f64::INFINITY, f64::min);
            let greatest = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!(-half <= least && least < -0.99 * half);
            assert!(0.99 * half < greatest && greatest <= half);
        }
        assert!(spheres.radius.iter().all(|radius| (0.2..=0.4).contains(radius)));
    }

    #[test]
    fn sizes_scale_the_whole() {
        let volume = Volume { count: 1000, size: Some(1e-6), ..Volume::default() };
        let spheres = volume.generate(1).unwrap_or_default().spheres;
        assert!(spheres.radius.iter().all(|radius| (1.9e-8..=4.1e-8).contains(radius)));
        assert!(spheres.x.iter().all(|x| x.abs() <= 5e-7));
    }
}
