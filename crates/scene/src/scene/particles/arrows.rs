//! Arrows for the vectors of particles: velocities, forces, dipoles, spins.

use crate::scene::Rgb;
use glam::DVec3;
use spherule_particles::internals::retain;
use std::str::FromStr;

/// Words for usual vectors, with the columns of their components; synonyms of these are found too.
const WORDS: [(&str, [&str; 3]); 4] = [
    ("velocity", ["vx", "vy", "vz"]),
    ("force", ["fx", "fy", "fz"]),
    ("dipole", ["mux", "muy", "muz"]),
    ("spin", ["spx", "spy", "spz"]),
];

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
    pub(super) fn share(self) -> f64 {
        match self {
            Self::Tail => 0.0,
            Self::Middle => 0.5,
            Self::Head => 1.0,
        }
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
    pub(super) vectors: Vec<DVec3>,
    /// The part of each arrow that is before its sphere's center.
    pub(super) before: f64,
    /// The color of all; `None` for that of each sphere.
    pub(super) color: Option<Rgb>,
}

/// The parts of an arrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrow {
    /// The ends of the shaft, of which the second is within the head.
    pub(super) shaft: [DVec3; 2],
    /// The radius of the shaft.
    pub(super) radius: f64,
    /// The apex and the center of the base of the head.
    pub(super) head: [DVec3; 2],
    /// The radius of the head's base.
    pub(super) head_radius: f64,
}

impl Arrows {
    /// Appends copies of rows.
    pub(super) fn append_rows(&mut self, rows: &[u32]) {
        if !self.vectors.is_empty() {
            let copies: Vec<DVec3> = rows.iter().map(|&row| self.vectors[row as usize]).collect();
            self.vectors.extend(copies);
        }
    }

    /// Returns the parts of the arrow of a sphere; `None` if it has none.
    pub(super) fn of(&self, row: usize, center: DVec3) -> Option<Arrow> {
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
    pub(super) fn retain(&mut self, keep: &[bool]) {
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
