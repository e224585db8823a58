//! Distances, angles and dihedrals between points.

use super::particles::Cell;
use crate::elementary::{atan2, log10};
use glam::DVec3;
use spherule_particles::internals::nearest_image;

/// Number of significant digits of a distance whose unit says none.
const DIGITS: i32 = 4;

/// Sine of the angle between two lines up to which their plane is that of rounding.
const STRAIGHT: f64 = 1e-12;

/// A measure of two to four points: their distance, the angle at the second one, or the dihedral about the line from the second
/// to the third.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measure {
    /// The points.
    pub points: Vec<DVec3>,
    /// Name of the scene's unit, for distances; empty if it has none.
    pub unit: String,
}

impl Measure {
    /// Replaces each point after the first by its periodic image that is nearest to the one before it.
    pub fn with_nearest_images(mut self, cell: &Cell) -> Self {
        for at in 1..self.points.len() {
            let before = self.points[at - 1];
            self.points[at] = before + nearest_image(self.points[at] - before, Some(cell));
        }
        self
    }

    /// Returns the distance, or the angle in degrees; `None` for another number of points, and for an angle between lines of
    /// which one has no length or two are in one direction.
    ///
    /// The sign of a dihedral is that of the IUPAC: positive if, seen along the line from the second point to the third, the
    /// line to the fourth is clockwise from that to the first. It is within -180 and 180.
    pub fn value(&self) -> Option<f64> {
        match *self.points.as_slice() {
            [a, b] => Some(a.distance(b)),
            [a, b, c] => angle(a - b, c - b),
            [a, b, c, d] => {
                let axis = direction(c - b)?;
                let across = |line: DVec3| {
                    let across = direction(line)?.reject_from_normalized(axis);
                    (across.length() > STRAIGHT).then_some(across)
                };
                let (first, last) = (across(a - b)?, across(d - c)?);
                Some(atan2(axis.dot(first.cross(last)), first.dot(last)).to_degrees())
            }
            _ => None,
        }
        .filter(|value| value.is_finite())
    }

    /// Returns the value with its unit, as in `3.21 Å` or `109.5°`.
    pub fn text(&self) -> String {
        let Some(value) = self.value() else { return "undefined".to_owned() };
        if self.points.len() > 2 {
            // Not a negative zero.
            let rounded = (value * 10.0).round() / 10.0 + 0.0;
            return format!("{rounded:.1}\u{b0}").replacen('-', "\u{2212}", 1);
        }
        let number = match self.unit.as_str() {
            "\u{c5}" => format!("{value:.2}"),
            "nm" => format!("{value:.3}"),
            _ => significant(value),
        };
        let space = if self.unit.is_empty() { "" } else { "\u{a0}" };
        format!("{number}{space}{}", self.unit)
    }
}

/// Returns the angle between two vectors in degrees; `None` if one has no length.
fn angle(first: DVec3, second: DVec3) -> Option<f64> {
    let (first, second) = (direction(first)?, direction(second)?);
    Some(atan2(first.cross(second).length(), first.dot(second)).to_degrees())
}

/// Returns the unit vector of a direction; `None` if it has no length.
fn direction(vector: DVec3) -> Option<DVec3> {
    // Squares of components could overflow or vanish.
    let most = vector.abs().max_element();
    (most > 0.0 && most.is_finite()).then(|| (vector / most).normalize())
}

/// Returns a number of 0 or more with [`DIGITS`] digits.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = log10(value).floor() as i32;
    if (-4..7).contains(&exponent) {
        let decimals = (DIGITS - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}").replacen('-', "\u{2212}", 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{cos, sin};
    use proptest::prelude::*;

    fn measure(points: &[[f64; 3]], unit: &str) -> Measure {
        let points = points.iter().copied().map(DVec3::from_array).collect();
        Measure { points, unit: unit.to_owned() }
    }

    #[test]
    fn distances_and_angles_are_those_of_closed_forms() {
        assert_eq!(measure(&[[1.0, 2.0, 3.0], [4.0, 6.0, 15.0]], "").value(), Some(13.0));
        for degrees in [0.0, 1e-6, 30.0, 90.0, 109.471_220_634_490_7, 179.999_999, 180.0_f64] {
            let (x, y) = (cos(degrees.to_radians()), sin(degrees.to_radians()));
            for scale in [1.0, 1e-200, 1e150] {
                let points = [[scale, 0.0, 0.0], [0.0; 3], [x * scale, 0.0, y * scale]];
                let value = measure(&points, "").value().expect("an angle");
                assert!((value - degrees).abs() < 1e-9, "{degrees} {scale}: {value}");
            }
        }
    }

    #[test]
    fn dihedrals_have_the_sign_of_the_iupac() {
        for degrees in [-179.0, -120.0, -60.0, -1e-6, 0.0, 1e-6, 60.0, 90.0, 180.0_f64] {
            let (x, y) = (cos(degrees.to_radians()), sin(degrees.to_radians()));
            // Seen along z, with x to the right, y is downward.
            let points = [[2.0, 0.0, -0.3], [0.0; 3], [0.0, 0.0, 1.5], [x, y, 2.0]];
            let value = measure(&points, "").value().expect("a dihedral");
            assert!((value - degrees).abs() < 1e-9, "{degrees}: {value}");
            let mut backward = points;
            backward.reverse();
            assert!((measure(&backward, "").value().expect("a dihedral") - degrees).abs() < 1e-9);
            let mirrored = points.map(|[x, y, z]| [-x, y, z]);
            let mirrored = measure(&mirrored, "").value().expect("a dihedral");
            assert!((mirrored + value).abs() < 1e-9 || degrees == 180.0, "{mirrored}");
        }
    }

    #[test]
    fn angles_without_lines_are_undefined() {
        for points in [
            &[[1.0; 3], [1.0; 3], [2.0; 3]][..],
            &[[0.0; 3], [1.0; 3], [2.0; 3], [4.0, 0.0, 0.0]],
            &[[0.0; 3], [1.0; 3], [1.0; 3], [4.0, 0.0, 0.0]],
            &[[1.0; 3]],
            &[],
        ] {
            let own = measure(points, "nm");
            assert_eq!((own.value(), own.text()), (None, "undefined".to_owned()), "{points:?}");
        }
    }

    #[test]
    fn texts_have_units_and_sensible_digits() {
        let distance =
            |length: f64, unit: &str| measure(&[[0.0; 3], [length, 0.0, 0.0]], unit).text();
        assert_eq!(distance(3.214, "\u{c5}"), "3.21\u{a0}\u{c5}");
        assert_eq!(distance(0.321_44, "nm"), "0.321\u{a0}nm");
        assert_eq!(distance(12.3456, ""), "12.35");
        assert_eq!(distance(1234.56, ""), "1235");
        assert_eq!(distance(0.0, ""), "0");
        assert_eq!(distance(1.5e-9, "m"), "1.500e\u{2212}9\u{a0}m");
        let right = measure(&[[1.0, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0]], "nm");
        assert_eq!(right.text(), "90.0\u{b0}");
        let gauche = [[1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 1.0]];
        assert_eq!(measure(&gauche, "nm").text(), "\u{2212}90.0\u{b0}");
    }

    proptest! {
        #[test]
        fn images_are_the_nearest_of_all(
            corners in proptest::array::uniform4(proptest::array::uniform3(-9.0..9.0_f64)),
            periodic in any::<[bool; 3]>(),
        ) {
            let vectors = [
                DVec3::new(4.0, 0.0, 0.0),
                DVec3::new(1.9, 3.0, 0.0),
                DVec3::new(-1.9, 1.4, 6.0),
            ];
            let cell = Cell { origin: DVec3::X, vectors, periodic };
            let own = measure(&corners, "");
            let images = own.clone().with_nearest_images(&cell).points;
            prop_assert_eq!(images[0], own.points[0]);
            for at in 1..4 {
                let found = images[at].distance(images[at - 1]);
                let away = own.points[at] - own.points[at - 1];
                let steps = |edge: usize| if periodic[edge] { -12..=12 } else { 0..=0 };
                let all = steps(0).flat_map(|i| steps(1).map(move |j| (i, j)));
                let all = all.flat_map(|(i, j)| steps(2).map(move |k| [i, j, k].map(f64::from)));
                let nearest = all
                    .map(|edges| (away + cell.matrix() * DVec3::from(edges)).length())
                    .fold(f64::INFINITY, f64::min);
                prop_assert!((found - nearest).abs() < 1e-9, "{} {}", found, nearest);
            }
        }
    }
}
