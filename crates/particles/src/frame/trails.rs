//! Trails of the particles of a frame, in columns.

use crate::categories::RowChange;
use glam::DVec3;

/// Earlier positions of particles, as vectors from where they are now. They don't cross the periodic cell: each is the nearest
/// periodic image of the position to the one after it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trails {
    /// One step per earlier frame, the last one first: columns x, y and z, with one row per particle.
    pub steps: Vec<[Vec<f64>; 3]>,
}

impl Trails {
    /// Returns whether there are no earlier positions.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Returns the vectors from particle `row` to its earlier positions, the last one first. It must be less than the number of
    /// particles.
    pub fn of(&self, row: usize) -> impl Iterator<Item = DVec3> + '_ {
        self.steps.iter().map(move |[x, y, z]| DVec3::new(x[row], y[row], z[row]))
    }

    /// Multiplies all vectors by a factor.
    pub fn scale(&mut self, factor: f64) {
        self.columns().flatten().for_each(|value| *value *= factor);
    }

    /// Changes the rows.
    pub(crate) fn change(&mut self, change: RowChange) {
        self.columns().for_each(|column| change.apply(column));
    }

    fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.steps.iter_mut().flatten()
    }
}
