//! The way in which arrows for the vectors of particles are drawn.

use crate::scene::particles::model::median;
use crate::scene::particles::orientation::bounds_of_centers;
use crate::scene::particles::select::expression::numbers;
use crate::scene::particles::{ArrowCentering, ArrowSizes, Arrows, Particles, VectorColumns};
use crate::scene::{FileError, Rgb};
use glam::DVec3;
use std::path::Path;

/// Length of the arrow of the median vector, relative to the median radius of particles, where no scale is given.
const USUAL_LENGTH: f64 = 4.0;

/// Radius of the shaft of the median arrow, relative to the median radius of particles, where none is given.
const USUAL_RADIUS: f64 = 0.25;

/// Length of an arrow, relative to that of the median vector, from which it may be an outlier that is shortened.
const OUTLIER: f64 = 10.0;

/// The way in which vectors are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrowStyle {
    /// The columns of the vectors.
    pub columns: VectorColumns,
    /// Length of an arrow for a vector of length 1, in the unit of positions, more than 0; `None` for one that makes the median
    /// arrow four times as long as the median radius of particles.
    pub scale: Option<f64>,
    /// Radius of shafts, more than 0; `None` for a quarter of the median radius of particles. Short arrows are thinner.
    pub radius: Option<f64>,
    /// The color of all arrows; `None` for that of each particle.
    pub color: Option<Rgb>,
    /// The place of arrows.
    pub centering: ArrowCentering,
}

impl ArrowStyle {
    /// Arrows for vectors, as they are drawn without further choices.
    pub fn new(columns: VectorColumns) -> Self {
        Self { columns, scale: None, radius: None, color: None, centering: ArrowCentering::Tail }
    }

    /// Gives particles their arrows. Vectors that are 0 or not finite have none; arrows that would be longer than all else,
    /// and far longer than the others, are shortened.
    pub(super) fn apply(&self, path: &Path, particles: &mut Particles) -> Result<(), FileError> {
        let mut vectors = self.vectors(path, particles)?;
        let Some((own, limit)) = self.sizes_of(&vectors, particles) else {
            particles.frame.warnings.push(format!(
                "{}: no arrows, as all vectors of {} are 0 or missing",
                path.display(),
                self.columns.0.join(", ")
            ));
            return Ok(());
        };
        let first_frame = particles.first_frame.as_ref();
        let of_first = first_frame.and_then(|first| first.arrow_sizes);
        let scale = self.scale.or(of_first.map(|sizes| sizes.scale)).unwrap_or(own.scale);
        let radius = self.radius.or(of_first.map(|sizes| sizes.radius)).unwrap_or(own.radius);
        let limit = first_frame.and_then(|first| first.arrow_limit).unwrap_or(limit);
        let mut shortened = 0_u64;
        for vector in &mut vectors {
            *vector *= scale;
            let length = vector.length();
            if length > limit && length.is_finite() {
                *vector *= limit / length;
                shortened += 1;
            }
        }
        if shortened > 0 {
            let file = path.display();
            particles.frame.warnings.push(format!(
                "{file}: arrows shortened to {limit:.3}: {shortened}, longer than the whole picture and more than \
                 {OUTLIER} times the median; --select leaves their particles out"
            ));
        }
        particles.arrows = Arrows {
            vectors,
            sizes: Some(ArrowSizes { scale, radius }),
            before: self.centering.share(),
            color: self.color,
        };
        Ok(())
    }

    /// Returns the sizes of the arrows of particles, and the length to which they are limited; `None` if all vectors are 0 or
    /// missing.
    pub(in crate::scene::particles) fn sizes(
        &self,
        path: &Path,
        particles: &Particles,
    ) -> Result<Option<(ArrowSizes, f64)>, FileError> {
        Ok(self.sizes_of(&self.vectors(path, particles)?, particles))
    }

    fn sizes_of(&self, vectors: &[DVec3], particles: &Particles) -> Option<(ArrowSizes, f64)> {
        let lengths: Vec<f64> =
            vectors.iter().map(|v| v.length()).filter(|&v| v > 0.0 && v.is_finite()).collect();
        let vector = median(&lengths)?;
        let size = median(&particles.spheres.radius).unwrap_or(1.0);
        let scale = self.scale.unwrap_or(USUAL_LENGTH * size / vector);
        let radius = self.radius.unwrap_or(USUAL_RADIUS * size);
        let [low, high] = bounds_of_centers(&particles.spheres);
        let extent = if vectors.is_empty() { 0.0 } else { low.distance(high) };
        let limit = f64::max(extent, OUTLIER * scale * vector);
        Some((ArrowSizes { scale, radius }, limit))
    }

    /// Takes the sizes of other arrows for those that were not chosen.
    pub fn fix(&mut self, sizes: ArrowSizes) {
        self.scale.get_or_insert(sizes.scale);
        self.radius.get_or_insert(sizes.radius);
    }

    /// Returns the vector of each particle, turned as its frame was.
    fn vectors(&self, path: &Path, particles: &Particles) -> Result<Vec<DVec3>, FileError> {
        let column = |name: &String| numbers(path, particles, name, "vectors");
        let [x, y, z] = &self.columns.0;
        let (x, y, z) = (column(x)?, column(y)?, column(z)?);
        let vector = |row: usize| particles.frame.rotation * DVec3::new(x[row], y[row], z[row]);
        Ok((0..particles.spheres.len()).map(vector).collect())
    }
}
