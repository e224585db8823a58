//! Shapes of the particles of a frame, in columns: ellipsoids and their orientations.

use crate::categories::RowChange;
use glam::{DQuat, DVec3};

/// Particles that are ellipsoids, in columns. Row `i` of every column belongs to particle `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// Semi-axes along the particle's own x, y and z, relative to its radius: the longest is 1, and all three are where
    /// it is a sphere. Empty if all particles are spheres.
    pub semi_axes: Vec<DVec3>,
    /// Rotations of the particle's axes to those of the file, unit quaternions. Empty if no particle is turned.
    pub orientation: Vec<DQuat>,
}

impl Shapes {
    /// Returns whether all particles are spheres.
    pub fn is_empty(&self) -> bool {
        self.semi_axes.is_empty()
    }

    /// Returns whether particle `row` is a sphere. It must be less than the number of particles.
    pub fn is_sphere(&self, row: usize) -> bool {
        self.semi_axes.get(row).is_none_or(|axes| *axes == DVec3::ONE)
    }

    /// Returns the rotation of particle `row`, which must be less than the number of particles.
    pub fn orientation_of(&self, row: usize) -> DQuat {
        self.orientation.get(row).copied().unwrap_or(DQuat::IDENTITY)
    }

    /// Changes the rows.
    pub(crate) fn change(&mut self, change: RowChange) {
        change.apply(&mut self.semi_axes);
        change.apply(&mut self.orientation);
    }

    /// Turns all particles.
    pub(crate) fn rotate(&mut self, rotation: DQuat) {
        if self.orientation.is_empty() {
            self.orientation = vec![DQuat::IDENTITY; self.semi_axes.len()];
        }
        self.orientation.iter_mut().for_each(|own| *own = (rotation * *own).normalize());
    }
}
