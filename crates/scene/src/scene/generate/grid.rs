//! Equal spheres in rows.

use super::group::{GenerateError, Group, require, require_radius, reserve_spheres};
use crate::scene::Rgb;
use glam::DVec3;

/// `count` times `count` equal spheres that rest on the plane y = 0, about the origin: the paper's
/// grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Spheres along each side, 1 or more.
    pub count: u64,
    /// Distance between neighboring centers, more than 0.
    pub spacing: f64,
    /// Radius, more than 0; more than half of the spacing gives spheres that overlap.
    pub radius: f64,
}

impl Default for Grid {
    fn default() -> Self {
        Self { count: 20, spacing: 1.0, radius: 0.4 }
    }
}

impl Grid {
    /// Number of spheres, saturating.
    pub(super) fn len(&self) -> u64 {
        self.count.saturating_mul(self.count)
    }

    pub(super) fn generate(&self) -> Result<Group, GenerateError> {
        require_radius(self.radius)?;
        let spaced = self.spacing.is_finite() && self.spacing > 0.0;
        require(spaced, "spacing", "must be finite and more than 0")?;
        let mut spheres = reserve_spheres(self.len(), "count")?;
        let middle = (self.count - 1) as f64 / 2.0;
        for row in 0..self.count {
            for column in 0..self.count {
                let [x, z] = [column, row].map(|index| (index as f64 - middle) * self.spacing);
                spheres.push(DVec3::new(x, self.radius, z), self.radius, 0, Rgb::ONE);
            }
        }
        Ok(Group { spheres, ..Group::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_stand_in_rows_about_the_origin() {
        let grid = Grid { count: 3, spacing: 2.0, radius: 0.5 };
        let spheres = grid.generate().unwrap_or_default().spheres;
        assert_eq!(spheres.center(0), DVec3::new(-2.0, 0.5, -2.0));
        assert_eq!(spheres.center(4), DVec3::new(0.0, 0.5, 0.0));
        assert_eq!(spheres.center(8), DVec3::new(2.0, 0.5, 2.0));
        assert_eq!(spheres.radius, [0.5; 9]);
    }
}
