//! The sphereflake of the Standard Procedural Databases (Haines, "A Proposal for Standard Graphics
//! Environments", IEEE Computer Graphics and Applications 1987).

use super::group::{GenerateError, Group, require_radius, reserve_spheres};
use crate::elementary;
use crate::scene::{Rgb, Spheres};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// A sphere at the origin with nine spheres of a third of its radius on it, each with nine more,
/// and so on: `(9^(level + 1) - 1) / 8` spheres, parents before their children.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphereflake {
    /// Generations below the first sphere; 4 gives Haines' 7381 spheres.
    pub level: u32,
    /// Radius of the first sphere, more than 0.
    pub radius: f64,
}

impl Default for Sphereflake {
    fn default() -> Self {
        Self { level: 4, radius: 0.5 }
    }
}

/// A sphere that may have children.
struct Parent {
    center: DVec3,
    radius: f64,
    /// Unit vector from the grandparent to the parent.
    direction: DVec3,
    level: u32,
}

impl Sphereflake {
    /// Number of spheres, saturating.
    pub(super) fn len(&self) -> u64 {
        let power = 9_u64.saturating_pow(self.level.saturating_add(1));
        if power == u64::MAX { u64::MAX } else { (power - 1) / 8 }
    }

    pub(super) fn generate(&self) -> Result<Group, GenerateError> {
        require_radius(self.radius)?;
        let mut spheres = reserve_spheres(self.len(), "level")?;
        let root = Parent {
            center: DVec3::ZERO,
            radius: self.radius,
            direction: DVec3::Z,
            level: self.level,
        };
        grow(&mut spheres, &root, &directions());
        Ok(Group { spheres, ..Group::default() })
    }
}

/// Appends a sphere and its descendants. The recursion is as deep as there are levels, 10 at most.
fn grow(spheres: &mut Spheres, parent: &Parent, directions: &[DVec3; 9]) {
    spheres.push(parent.center, parent.radius, 0, Rgb::ONE);
    if parent.level == 0 {
        return;
    }
    let turn = DQuat::from_rotation_arc(DVec3::Z, parent.direction);
    for &direction in directions {
        let direction = (turn * direction).normalize();
        let child = Parent {
            center: parent.center + direction * (parent.radius * 4.0 / 3.0),
            radius: parent.radius / 3.0,
            direction,
            level: parent.level - 1,
        };
        grow(spheres, &child, directions);
    }
}

/// Returns the directions of the children of a sphere whose own parent is below it along z.
fn directions() -> [DVec3; 9] {
    let diagonal = FRAC_1_SQRT_2;
    let trio = [DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 1.0, -1.0)];
    let axis = DVec3::new(diagonal, -diagonal, 0.0);
    let tilt = elementary::rotation(axis, elementary::asin(2.0 / 6.0_f64.sqrt()));
    std::array::from_fn(|child| {
        let third = elementary::rotation(DVec3::Z, (child / 3) as f64 * TAU / 3.0);
        third * (tilt * (trio[child % 3] * diagonal))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_first_child_are_as_published() {
        for (level, count) in [(0, 1), (1, 10), (2, 91), (4, 7_381), (7, 5_380_840)] {
            assert_eq!(Sphereflake { level, radius: 0.5 }.len(), count);
        }
        let spheres = Sphereflake::default().generate().unwrap_or_default().spheres;
        let first = DVec3::new(0.272_166, 0.272_166, 0.544_331);
        assert!(spheres.center(1).distance(first) < 1e-6, "{}", spheres.center(1));
        assert!((spheres.radius[1] - 1.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn children_touch_their_parent() {
        let spheres = Sphereflake { level: 1, radius: 3.0 }.generate().unwrap_or_default().spheres;
        assert!((1..10).all(|row| (spheres.center(row).length() - 4.0).abs() < 1e-14));
    }

    #[test]
    fn positions_agree_with_haines_program() {
        let text = include_str!("../../../../../tests/data/sphereflake.txt");
        let numbers = |line: &str| -> Vec<f64> {
            line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
        };
        let golden: Vec<_> = text.lines().map(numbers).filter(|row| row.len() == 5).collect();
        assert_eq!(golden.len(), 132);
        let spheres = Sphereflake::default().generate().unwrap_or_default().spheres;
        assert_eq!(spheres.len(), 7381);
        for sphere in golden {
            let row = sphere[0] as usize;
            let own = [spheres.x[row], spheres.y[row], spheres.z[row], spheres.radius[row]];
            // The file has six digits.
            let near = sphere[1..].iter().zip(own).all(|(golden, own)| (golden - own).abs() < 2e-6);
            assert!(near, "row {row}: {sphere:?} {own:?}");
        }
    }
}
