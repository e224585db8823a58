//! The ellipsoids of a scene, in columns.

use super::{Rgb, Slice, SliceMode};
use glam::{DQuat, DVec3};

/// Ellipsoids in columns. Row `i` of every column belongs to ellipsoid `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ellipsoids {
    /// Centers.
    pub center: Vec<DVec3>,
    /// Semi-axes along x, y and z before the rotation, more than 0; the longest is at most [`Ellipsoids::MAX_RATIO`] times the
    /// shortest.
    pub semi_axes: Vec<DVec3>,
    /// Rotations, unit quaternions.
    pub orientation: Vec<DQuat>,
    /// Rows of [`Scene::materials`](super::Scene::materials), of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color.
    pub color: Vec<Rgb>,
}

impl Ellipsoids {
    /// Maximum number of ellipsoids in a scene.
    pub const MAX: usize = 1 << 30;

    /// Maximum ratio of two semi-axes of an ellipsoid.
    pub const MAX_RATIO: f64 = crate::ellipsoids::EllipsoidItem::MAX_RATIO;

    /// Returns the number of ellipsoids.
    pub fn len(&self) -> usize {
        self.center.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.center.is_empty()
    }

    /// Appends an ellipsoid.
    pub fn push(
        &mut self,
        center: DVec3,
        semi_axes: DVec3,
        orientation: DQuat,
        material: u32,
        color: Rgb,
    ) {
        self.center.push(center);
        self.semi_axes.push(semi_axes);
        self.orientation.push(orientation);
        self.material.push(material);
        self.color.push(color);
    }

    /// Moves the ellipsoids of another scene's columns, with the same materials, to the end.
    pub(crate) fn append(&mut self, other: &mut Self) {
        self.center.append(&mut other.center);
        self.semi_axes.append(&mut other.semi_axes);
        self.orientation.append(&mut other.orientation);
        self.material.append(&mut other.material);
        self.color.append(&mut other.color);
    }

    /// Returns the longest semi-axis of ellipsoid `row`.
    pub fn reach(&self, row: usize) -> f64 {
        self.semi_axes[row].max_element()
    }

    /// Returns the extent of ellipsoid `row` from its center in a direction, a unit vector.
    pub fn extent(&self, row: usize, direction: DVec3) -> f64 {
        (self.semi_axes[row] * (self.orientation[row].inverse() * direction)).length()
    }
}

impl Slice {
    /// Returns whether an ellipsoid is removed: as a sphere is, by its center; caps remove it if they leave nothing of it.
    pub fn drops_ellipsoid(&self, ellipsoids: &Ellipsoids, row: usize) -> bool {
        let depth = self.depth(ellipsoids.center[row]);
        match self.mode {
            SliceMode::Remove => depth > 0.0,
            SliceMode::Caps => depth >= ellipsoids.extent(row, self.normal),
            SliceMode::Hide => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn extents_are_those_of_the_turned_axes() {
        let mut ellipsoids = Ellipsoids::default();
        let turned = DQuat::from_rotation_z(FRAC_PI_2);
        ellipsoids.push(DVec3::X, DVec3::new(3.0, 2.0, 1.0), turned, 0, Rgb::ONE);
        for (direction, extent) in [(DVec3::X, 2.0), (DVec3::Y, 3.0), (DVec3::NEG_Z, 1.0)] {
            assert!((ellipsoids.extent(0, direction) - extent).abs() < 1e-12, "{direction}");
        }
        assert_eq!(ellipsoids.reach(0), 3.0);
        let slice = |distance, mode| Slice { normal: DVec3::X, distance, mode };
        let drops = |slice: Slice| slice.drops_ellipsoid(&ellipsoids, 0);
        assert!(drops(slice(-1.1, SliceMode::Caps)) && !drops(slice(-0.9, SliceMode::Caps)));
        assert!(drops(slice(0.9, SliceMode::Remove)) && !drops(slice(1.1, SliceMode::Remove)));
        assert!(!drops(slice(-9.0, SliceMode::Hide)));
    }
}
