//! Bonds of crystals: the table `_geom_bond`, whose bonds all symmetry operations repeat (CIF core
//! dictionary, <https://www.iucr.org/resources/cif/dictionaries/cif_core>).

use super::occupancy::Positions;
use super::rows::Rows;
use super::symmetry::{Operation, SAME, distance};
use super::tokens::Tokens;
use crate::{
    Bonds, FileError,
    bonds::{End, Listed},
    number,
};
use glam::{DMat3, DVec3};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Row of atoms that have no coordinates, or aren't drawn.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Columns of both labels and of both symmetry codes.
const COLUMNS: [&str; 4] = [
    "_geom_bond_atom_site_label_1",
    "_geom_bond_atom_site_label_2",
    "_geom_bond_site_symmetry_1",
    "_geom_bond_site_symmetry_2",
];

/// Rows of atoms by their labels, which several may have; [`NOWHERE`] for those that aren't drawn.
pub(super) type Labels = HashMap<Vec<u8>, End<u32>>;

/// A bond of the table.
pub(super) struct ListedBond {
    labels: [Vec<u8>; 2],
    codes: [Vec<u8>; 2],
}

/// The listed atoms, by which the table names bonds.
pub(super) struct Geometry<'g> {
    /// Fractional coordinates.
    pub(super) positions: &'g [DVec3],
    pub(super) labels: &'g Labels,
    /// Symmetry operations in the order of the file.
    pub(super) declared: &'g [Operation],
}

/// Reads the rows of the table.
pub(super) fn read(tokens: &mut Tokens, tags: &[String]) -> Result<Vec<ListedBond>, FileError> {
    let columns = COLUMNS.map(|column| tags.iter().position(|tag| tag == column));
    let [Some(first), Some(second), one, other] = columns else {
        let error = tokens.error(format!("no column {} in this loop of bonds", COLUMNS[1]));
        return Err(error.with_help("a bond is between two atoms"));
    };
    let mut rows = Rows::new(tags.len());
    let mut bonds = Vec::new();
    while rows.read(tokens)? {
        let code = |column: Option<usize>| column.map_or(&b"."[..], |column| rows.field(column));
        bonds.push(ListedBond {
            labels: [first, second].map(|column| rows.field(column).to_vec()),
            codes: [one, other].map(|column| code(column).to_vec()),
        });
    }
    Ok(bonds)
}

impl Geometry<'_> {
    /// Returns the bonds between all images of the listed atoms.
    pub(super) fn bonds(
        &self,
        path: &Arc<Path>,
        listed: &[ListedBond],
        operations: &[Operation],
        images: Positions,
    ) -> Result<Bonds, FileError> {
        let mut rows_of = vec![Vec::new(); self.positions.len()];
        for (row, &atom) in images.rows.iter().enumerate() {
            rows_of[atom as usize].push(row as u32);
        }
        let identity = [Operation::IDENTITY];
        let operations = if operations.is_empty() { &identity[..] } else { operations };
        let mut bonds = Listed::default();
        for bond in listed {
            let ends = [0, 1].map(|end| match self.labels.get(&bond.labels[end]) {
                Some(End::Atom(row)) => {
                    End::from(self.operation(&bond.codes[end]).map(|own| (*row, own)))
                }
                Some(End::Ambiguous) => End::Ambiguous,
                Some(End::Nowhere) | None => End::Nowhere,
            });
            let Some(ends) = bonds.ends(ends) else { continue };
            if ends.iter().any(|(row, _)| *row == NOWHERE) {
                continue;
            }
            for operation in operations {
                let found = ends.map(|(atom, own)| {
                    let own = operation.after(&own);
                    let position = own.matrix * self.positions[atom as usize] + own.shift;
                    find(position, &rows_of[atom as usize], images)
                });
                let [Some((first, from)), Some((second, to))] = found else { continue };
                let shift = (to - from).to_array();
                if shift.iter().all(|edge| edge.abs() < 127.0) {
                    let shift = shift.map(|edge| edge as i8);
                    bonds.push(path, (first, second, shift))?;
                }
            }
        }
        Ok(bonds.finish())
    }

    /// Returns the operation of a symmetry code such as `3_655`: its number in the file, and the edges of the
    /// cell by which it is shifted, plus 5; `None` for other codes, and for operations that the file does not list.
    fn operation(&self, code: &[u8]) -> Option<Operation> {
        if matches!(code, b"." | b"?" | b"") {
            return Some(Operation::IDENTITY);
        }
        let mut parts = code.splitn(2, |&byte| byte == b'_');
        let number = parts.next().and_then(number::whole).unwrap_or(0) as usize;
        let cells = parts.next().unwrap_or(b"555");
        let digit = |byte: u8| f64::from(byte) - f64::from(b'5');
        let shift = match cells {
            [a, b, c] if cells.iter().all(u8::is_ascii_digit) => {
                DVec3::new(digit(*a), digit(*b), digit(*c))
            }
            _ => return None,
        };
        let moved = Operation { matrix: DMat3::IDENTITY, shift };
        let index = number.checked_sub(1)?;
        match self.declared.get(index) {
            Some(operation) => Some(moved.after(operation)),
            None => (index == 0).then_some(moved),
        }
    }
}

/// Returns the row of the image at a position in fractional coordinates, and the cell that it is in.
fn find(position: DVec3, rows: &[u32], images: Positions) -> Option<(u32, DVec3)> {
    let place = |row: &u32| images.places[*row as usize];
    let away = |row: &u32| distance(place(row), position, images.cell);
    let nearest = rows.iter().min_by(|one, other| away(one).total_cmp(&away(other)))?;
    (away(nearest) < SAME).then(|| (*nearest, (position - place(nearest)).round()))
}
