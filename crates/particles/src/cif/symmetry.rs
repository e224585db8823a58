//! Symmetry operations in the notation of CIF: `-x+y, y+1/2, z`.

use crate::{Cell, number};
use glam::{DMat3, DVec3};

/// Distance in angstrom below which images of an atom coincide: coordinates of special positions have
/// few digits.
pub(super) const SAME: f64 = 0.1;

/// Fractional coordinates this close below 1 are 0 up to rounding.
const ROUNDING: f64 = 1e-9;

/// Translations of symmetry operations are multiples of this fraction of an edge.
const TRANSLATION_STEPS: f64 = 24.0;

/// A symmetry operation on fractional coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Operation {
    pub(super) matrix: DMat3,
    pub(super) shift: DVec3,
}

impl Operation {
    pub(super) const IDENTITY: Self = Self { matrix: DMat3::IDENTITY, shift: DVec3::ZERO };

    /// Parses an operation; returns `None` if it doesn't map a lattice to itself.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text: String = text.chars().filter(|letter| !letter.is_whitespace()).collect();
        let mut rows = text.split(',').map(row);
        let [x, y, z] = [rows.next()??, rows.next()??, rows.next()??];
        let matrix = DMat3::from_cols(x.0, y.0, z.0).transpose();
        let kept = matrix.determinant().abs() == 1.0 && rows.next().is_none();
        kept.then_some(Self { matrix, shift: DVec3::new(x.1, y.1, z.1) })
    }

    /// Returns the composition of `first` and then this operation.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self { matrix: self.matrix * first.matrix, shift: self.matrix * first.shift + self.shift }
    }

    /// Returns the inverse operation.
    pub(super) fn inverse(&self) -> Self {
        let matrix = self.matrix.inverse();
        Self { matrix, shift: -(matrix * self.shift) }
    }

    /// Returns the operation without rounding errors, and with its translation in the cell.
    pub(super) fn rounded(&self) -> Self {
        let columns = self.matrix.to_cols_array().map(f64::round);
        let shift = (self.shift * TRANSLATION_STEPS).round();
        let shift = shift - TRANSLATION_STEPS * (shift / TRANSLATION_STEPS).floor();
        Self { matrix: DMat3::from_cols_array(&columns), shift: shift / TRANSLATION_STEPS }
    }

    /// Returns whether two operations are equal up to a lattice translation.
    pub(super) fn same(&self, other: &Self) -> bool {
        let away = self.shift - other.shift;
        // Translations may be written with few digits, such as 0.333.
        self.matrix == other.matrix && (away - away.round()).abs().max_element() < 0.01
    }

    /// Returns the image of a position, wrapped into the cell.
    pub(super) fn image(&self, place: DVec3) -> DVec3 {
        let image = self.matrix * place + self.shift;
        let share = |value: f64| {
            let share = value - value.floor();
            if share < 1.0 - ROUNDING { share } else { 0.0 }
        };
        DVec3::from(image.to_array().map(share))
    }
}

/// Parses a component: the factors of x, y and z, each -1, 0 or 1, and the translation.
fn row(text: &str) -> Option<(DVec3, f64)> {
    let (mut factors, mut shift) = (DVec3::ZERO, 0.0);
    let mut rest = text;
    while !rest.is_empty() {
        let (sign, term) = match rest.as_bytes()[0] {
            b'-' => (-1.0, &rest[1..]),
            b'+' => (1.0, &rest[1..]),
            _ => (1.0, rest),
        };
        let end = term.find(['+', '-']).unwrap_or(term.len());
        match &term[..end] {
            "x" | "X" => factors.x += sign,
            "y" | "Y" => factors.y += sign,
            "z" | "Z" => factors.z += sign,
            term => shift += sign * fraction(term)?,
        }
        rest = &term[end..];
    }
    let usual = factors.abs().max_element() == 1.0;
    (usual && shift.is_finite()).then_some((factors, shift))
}

/// Parses a fraction such as `1/2`, or a number.
fn fraction(text: &str) -> Option<f64> {
    let number = |text: &str| number::parse(text.as_bytes());
    match text.split_once('/') {
        Some((above, below)) => Some(number(above)? / number(below)?),
        None => number(text),
    }
}

/// Returns the minimum-image distance between two points in fractional coordinates.
pub(super) fn distance(one: DVec3, other: DVec3, cell: &Cell) -> f64 {
    let away = one - other;
    (cell.cartesian((away - away.round()).to_array()) - cell.origin).length()
}

/// Returns all symmetry-equivalent positions in the cell, each once, in fractional coordinates.
pub(super) fn images(place: DVec3, operations: &[Operation], cell: &Cell) -> Vec<DVec3> {
    let mut images: Vec<DVec3> = Vec::new();
    for operation in operations {
        let image = operation.image(place);
        if !images.iter().any(|other| distance(image, *other, cell) < SAME) {
            images.push(image);
        }
    }
    images
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_are_read_in_all_their_spellings() {
        let expected = Operation {
            matrix: DMat3::from_cols(DVec3::NEG_X, DVec3::X + DVec3::Y, DVec3::Z),
            shift: DVec3::new(0.0, 0.5, 0.25),
        };
        for text in ["-x+y,y+1/2,z+1/4", "y - x, 1/2 + Y, .25+z", "-X+Y,+Y+0.5,+Z+1/4"] {
            assert_eq!(Operation::parse(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn invalid_operations_are_refused() {
        for text in [
            "",
            "x,y",
            "x,y,z,x",
            "x,y,",
            "x,y,w",
            "x,y,2",
            "x,x,z",
            "x+x,y,z",
            "x,y,z+1/0",
            "x+y,x-y,z",
            "x,y,z--",
            "x,\u{e4},z",
        ] {
            assert_eq!(Operation::parse(text), None, "{text}");
        }
    }

    #[test]
    fn images_of_special_positions_are_merged() {
        let cell = Cell::of_lengths([4.0, 4.0, 6.0], [90.0, 90.0, 120.0]).expect("a cell");
        let three = ["x,y,z", "-y,x-y,z", "-x+y,-x,z"].map(|text| Operation::parse(text).unwrap());
        assert_eq!(images(DVec3::new(0.1, 0.2, 0.3), &three, &cell).len(), 3);
        // On the axis, even if written with few digits.
        let axis = images(DVec3::new(0.3333, 0.6667, -1e-12), &three, &cell);
        assert_eq!(axis, [DVec3::new(0.3333, 0.6667, 0.0)]);
    }
}
