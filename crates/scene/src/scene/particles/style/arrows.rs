//! Arrows for the vectors of particles: velocities, forces, dipoles, spins.

use super::columns::numbers;
use crate::scene::particles::Particles;
use crate::scene::particles::model::median;
use crate::scene::particles::orientation::bounds_of_centers;
use crate::scene::{FileError, Rgb};
use glam::DVec3;
use spherule_particles::internals::retain;
use std::path::Path;
use std::str::FromStr;

/// Words for usual vectors, with the columns of their components; synonyms of these are found too.
const WORDS: [(&str, [&str; 3]); 4] = [
    ("velocity", ["vx", "vy", "vz"]),
    ("force", ["fx", "fy", "fz"]),
    ("dipole", ["mux", "muy", "muz"]),
    ("spin", ["spx", "spy", "spz"]),
];

/// Length of the arrow of the median vector, relative to the median radius of particles, where no scale is given.
const USUAL_LENGTH: f64 = 4.0;

/// Radius of the shaft of the median arrow, relative to the median radius of particles, where none is given.
const USUAL_RADIUS: f64 = 0.25;

/// Length of an arrow, relative to that of the median vector, from which it may be an outlier that is shortened.
const OUTLIER: f64 = 10.0;

/// Radius of an arrow's head, relative to that of its shaft, as in OVITO.
const HEAD_RADIUS: f64 = 2.5;

/// Length of an arrow's head, relative to its radius.
const HEAD_LENGTH: f64 = 1.8;

/// Largest part of an arrow that its head takes: shorter arrows are thinner.
const HEAD_SHARE: f64 = 0.6;

/// The columns of the components of vectors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VectorColumns(
    /// The names for x, y and z, or expressions over columns.
    pub [String; 3],
);

impl FromStr for VectorColumns {
    type Err = String;

    /// Parses `velocity`, `force`, `dipole` or `spin`, the common part of three names, as in `mu` for `mux`, `muy` and `muz`, or
    /// three names or expressions, as in `a,b,c` and `-fx,max(fy, 0),0*fz`.
    fn from_str(text: &str) -> Result<Self, String> {
        let names: Vec<&str> = parts(text).into_iter().map(str::trim).collect();
        let fault = || format!("`{text}` is neither a vector nor three columns, as in vx,vy,vz");
        match names[..] {
            _ if names.iter().any(|name| name.is_empty()) => Err(fault()),
            [word] => {
                let usual = WORDS.iter().find(|(own, _)| own.eq_ignore_ascii_case(word));
                let names = usual.map_or_else(
                    || ["x", "y", "z"].map(|axis| format!("{word}{axis}")),
                    |(_, names)| names.map(str::to_owned),
                );
                Ok(Self(names))
            }
            [x, y, z] => Ok(Self([x, y, z].map(str::to_owned))),
            _ => Err(fault()),
        }
    }
}

/// Returns the parts of a text between commas that are in no parentheses.
fn parts(text: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    let is_between = |letter: char| {
        match letter {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => (),
        }
        letter == ',' && depth == 0
    };
    text.split(is_between).collect()
}

/// The place of an arrow at its particle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArrowCentering {
    /// The arrow starts at the particle's center.
    #[default]
    Tail,
    /// The particle is in the middle of the arrow.
    Middle,
    /// The arrow ends at the particle's center.
    Head,
}

impl ArrowCentering {
    /// All of them, with their names in options.
    pub const ALL: [(&'static str, Self); 3] =
        [("tail", Self::Tail), ("middle", Self::Middle), ("head", Self::Head)];

    /// The part of the arrow that is before the particle's center.
    fn share(self) -> f64 {
        match self {
            Self::Tail => 0.0,
            Self::Middle => 0.5,
            Self::Head => 1.0,
        }
    }
}

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

/// The sizes of arrows, which all frames of a sequence share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrowSizes {
    /// Length of the arrow for a vector of length 1.
    pub scale: f64,
    /// Radius of shafts.
    pub radius: f64,
}

/// The arrows of particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrows {
    /// The sizes; `None` if there are no arrows.
    pub sizes: Option<ArrowSizes>,
    /// From tail to head, one for each sphere; those that are 0 or not finite are not drawn. Empty if there are no arrows.
    pub(in super::super) vectors: Vec<DVec3>,
    /// The part of each arrow that is before its sphere's center.
    pub(in super::super) before: f64,
    /// The color of all; `None` for that of each sphere.
    pub(in super::super) color: Option<Rgb>,
}

/// The parts of an arrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Arrow {
    /// The ends of the shaft, of which the second is within the head.
    pub(in super::super) shaft: [DVec3; 2],
    /// The radius of the shaft.
    pub(in super::super) radius: f64,
    /// The apex and the center of the base of the head.
    pub(in super::super) head: [DVec3; 2],
    /// The radius of the head's base.
    pub(in super::super) head_radius: f64,
}

impl Arrows {
    /// Appends copies of rows.
    pub(in super::super) fn append_rows(&mut self, rows: &[u32]) {
        if !self.vectors.is_empty() {
            let copies: Vec<DVec3> = rows.iter().map(|&row| self.vectors[row as usize]).collect();
            self.vectors.extend(copies);
        }
    }

    /// Returns the parts of the arrow of a sphere; `None` if it has none.
    pub(in super::super) fn of(&self, row: usize, center: DVec3) -> Option<Arrow> {
        let vector = *self.vectors.get(row)?;
        let length = vector.length();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let along = vector / length;
        let thickest = length * HEAD_SHARE / (HEAD_LENGTH * HEAD_RADIUS);
        let radius = self.sizes?.radius.min(thickest);
        let head_radius = HEAD_RADIUS * radius;
        let tail = center - vector * self.before;
        let apex = tail + vector;
        let base = apex - along * (HEAD_LENGTH * head_radius);
        // The round end of the shaft is within the head; the other one does not reach beyond the tail.
        let reach = radius.min((base - tail).length());
        Some(Arrow { shaft: [tail + along * reach, base], radius, head: [apex, base], head_radius })
    }

    /// Keeps the rows for which `keep` is true.
    pub(in super::super) fn retain(&mut self, keep: &[bool]) {
        retain(&mut self.vectors, keep);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_are_words_stems_or_three_columns() {
        let columns = |text: &str| text.parse::<VectorColumns>().map(|columns| columns.0);
        assert_eq!(columns("Velocity"), Ok(["vx", "vy", "vz"].map(str::to_owned)));
        assert_eq!(columns("c_mu_"), Ok(["c_mu_x", "c_mu_y", "c_mu_z"].map(str::to_owned)));
        assert_eq!(columns("a, b,c[3]"), Ok(["a", "b", "c[3]"].map(str::to_owned)));
        let expressions = ["-vx", "max(vy, 0)", "0*vz"].map(str::to_owned);
        assert_eq!(columns("-vx, max(vy, 0),0*vz"), Ok(expressions));
        for bad in ["", "a,b", "a,,c", "a,b,c,d"] {
            assert!(columns(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn arrows_have_the_length_of_their_vectors() {
        for (length, before) in [(4.0, 0.0), (0.1, 0.5), (1.0, 1.0)] {
            let arrows = Arrows {
                vectors: vec![DVec3::Y * length, DVec3::ZERO, DVec3::X * f64::NAN],
                sizes: Some(ArrowSizes { scale: 1.0, radius: 0.1 }),
                before,
                color: None,
            };
            let arrow = arrows.of(0, DVec3::X).expect("an arrow");
            let tail = DVec3::new(1.0, -before * length, 0.0);
            assert!(arrow.head[0].distance(tail + DVec3::Y * length) < 1e-12);
            assert!(arrow.radius <= 0.1 && arrow.head_radius == HEAD_RADIUS * arrow.radius);
            let head = arrow.head[0].distance(arrow.head[1]);
            assert!((head - HEAD_LENGTH * arrow.head_radius).abs() < 1e-12);
            assert!(head <= HEAD_SHARE * length * 1.000_000_1);
            // Nothing reaches beyond the tail or out of the head.
            assert!(arrow.shaft[0].y - arrow.radius >= tail.y - 1e-12);
            assert_eq!(arrow.shaft[1], arrow.head[1]);
            assert!(arrows.of(1, DVec3::X).is_none() && arrows.of(2, DVec3::X).is_none());
        }
    }
}
