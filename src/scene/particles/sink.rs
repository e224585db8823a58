//! Where readers put particles: it scales, drops what is no sphere, and counts what it dropped.

use super::{Particles, ReadOptions};
use crate::memory;
use crate::scene::error::clipped;
use crate::scene::{Rgb, SceneError, Spheres};
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;

/// Most unknown names that a warning lists.
const LISTED: usize = 5;

/// One row of a file.
pub(super) struct Row<'r> {
    /// In the file's unit.
    pub(super) center: DVec3,
    /// In the file's unit; `None` for the one that the user gave.
    pub(super) radius: Option<f64>,
    /// Empty if the file names none.
    pub(super) material: &'r str,
    pub(super) color: Rgb,
}

/// The particles of a file that is being read.
pub(super) struct Sink<'a> {
    path: &'a Path,
    options: &'a ReadOptions,
    particles: Particles,
    rows_by_name: HashMap<String, u32>,
    not_finite: u64,
    not_positive: u64,
    lacks_radii: bool,
}

impl<'a> Sink<'a> {
    pub(super) fn new(path: &'a Path, options: &'a ReadOptions) -> Self {
        Self {
            path,
            options,
            particles: Particles::default(),
            rows_by_name: HashMap::new(),
            not_finite: 0,
            not_positive: 0,
            lacks_radii: false,
        }
    }

    /// Whether the user gave a radius, which goes before those of a table.
    pub(super) fn has_radius(&self) -> bool {
        self.options.radius.is_some()
    }

    /// Takes a row.
    pub(super) fn push(&mut self, row: &Row) -> Result<(), SceneError> {
        let center = row.center * self.options.scale;
        self.lacks_radii |= row.radius.is_none();
        let radius = match row.radius {
            Some(radius) => radius * self.options.scale,
            None => self.options.radius.unwrap_or(1.0),
        };
        if !center.is_finite() || !radius.is_finite() {
            self.not_finite += 1;
        } else if radius <= 0.0 {
            self.not_positive += 1;
        } else if self.particles.spheres.len() as u64 >= Spheres::MAX {
            let message = format!("holds more than {} particles", Spheres::MAX);
            return Err(SceneError::whole_file(self.path, message));
        } else {
            self.check_room()?;
            let material = self.material(row.material);
            self.particles.spheres.push(center, radius, material, row.color);
        }
        Ok(())
    }

    /// Adds a warning.
    pub(super) fn warn(&mut self, message: &str) {
        let message = clipped(message);
        self.particles.warnings.push(format!("{}: {message}", self.path.display()));
    }

    /// Warns of things that were passed over, if there are any; `reason` begins the sentence.
    pub(super) fn warn_of(&mut self, reason: &str, names: &[String]) {
        if names.is_empty() {
            return;
        }
        let listed = names[..names.len().min(LISTED)].join(", ");
        let more = if names.len() > LISTED { ", ..." } else { "" };
        self.warn(&format!("{reason}: {listed}{more}"));
    }

    /// What was read.
    pub(super) fn finish(mut self) -> Result<Particles, SceneError> {
        let dropped = self.not_finite + self.not_positive;
        let count = self.particles.spheres.len();
        if count == 0 && dropped == 0 {
            return Err(SceneError::whole_file(self.path, "holds no particles"));
        }
        let reasons = format!(
            "{} not finite, {} with a radius of 0 or less",
            self.not_finite, self.not_positive
        );
        if count == 0 {
            let message = format!("none of its {dropped} rows is a sphere: {reasons}");
            return Err(SceneError::whole_file(self.path, message));
        }
        if dropped > 0 {
            let total = count as u64 + dropped;
            self.warn(&format!("{dropped} of {total} rows were dropped: {reasons}"));
        }
        if self.lacks_radii && self.options.radius.is_none() {
            let radius = half_spacing(&self.particles.spheres);
            self.particles.spheres.radius.fill(radius);
            self.warn(&format!(
                "no radii in the file, so half of the mean spacing is taken: radius = {radius}"
            ));
        }
        Ok(self.particles)
    }

    /// Before columns grow, which take twice the memory then: whether there is so much.
    fn check_room(&self) -> Result<(), SceneError> {
        let count = self.particles.spheres.len() as u64;
        if !count.is_power_of_two() {
            return Ok(());
        }
        memory::check(2 * count * Spheres::BYTES).map_err(|shortage| {
            let message = format!("holds more than {count} particles, which need {shortage}");
            SceneError::whole_file(self.path, message)
        })
    }

    fn material(&mut self, name: &str) -> u32 {
        if let Some(&row) = self.rows_by_name.get(name) {
            return row;
        }
        let row = self.particles.material_names.len() as u32;
        self.rows_by_name.insert(name.to_owned(), row);
        self.particles.material_names.push(name.to_owned());
        row
    }
}

/// Half of the edge of the cube, square or line that each particle has for itself; 1 for a single
/// place. Rounded to two digits: it is a guess, and should look like one.
fn half_spacing(spheres: &Spheres) -> f64 {
    let extent = |column: &Vec<f64>| {
        let least = column.iter().copied().fold(f64::INFINITY, f64::min);
        column.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
    };
    let extents: Vec<f64> = [&spheres.x, &spheres.y, &spheres.z]
        .map(extent)
        .into_iter()
        .filter(|extent| *extent > 0.0 && extent.is_finite())
        .collect();
    if extents.is_empty() {
        return 1.0;
    }
    // Products of lengths could overflow where means of logarithms do not.
    let logarithms: f64 = extents.iter().map(|extent| extent.ln()).sum();
    let spacing = ((logarithms - (spheres.len() as f64).ln()) / extents.len() as f64).exp();
    format!("{:.1e}", spacing / 2.0).parse().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guessed_radii_follow_the_spacing_in_any_dimension() {
        let mut line = Spheres::default();
        let mut plane = Spheres::default();
        for row in 0..100 {
            let [first, second] = [row % 10, row / 10].map(f64::from);
            line.push(DVec3::new(f64::from(row) * 3.0, 5.0, 5.0), 1.0, 0, Rgb::ONE);
            plane.push(DVec3::new(first * 2.0, 0.0, second * 2.0), 1.0, 0, Rgb::ONE);
        }
        assert_eq!(half_spacing(&line), 1.5);
        assert_eq!(half_spacing(&plane), 0.9);
        let mut point = Spheres::default();
        point.push(DVec3::ONE, 7.0, 0, Rgb::ONE);
        assert_eq!(half_spacing(&point), 1.0);
    }
}
