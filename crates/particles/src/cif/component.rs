//! Ligand definitions in mmCIF: the table `_chem_comp_atom`, one component in each data block
//! (<https://www.wwpdb.org/data/ccd>).

use super::rows::Rows;

/// Prefix of the columns.
pub(super) const ATOMS: &str = "_chem_comp_atom.";

/// Columns of coordinates, in order of preference: of a model, ideal, and those of restraints.
const COORDINATES: [[&str; 3]; 3] = [
    ["model_Cartn_x", "model_Cartn_y", "model_Cartn_z"],
    ["pdbx_model_Cartn_x_ideal", "pdbx_model_Cartn_y_ideal", "pdbx_model_Cartn_z_ideal"],
    ["x", "y", "z"],
];

/// Other columns with the names that the table of atoms has for them.
const EITHER_NAME: [(&str, &str); 2] = [("comp_id", "label_comp_id"), ("atom_id", "label_atom_id")];

/// The atoms of a component, as listed.
#[derive(Default)]
pub(super) struct Component {
    names: Vec<String>,
    rows: Vec<Rows>,
    /// Values outside of a loop, which are those of the only atom.
    single: Option<Rows>,
}

/// The atoms of a component in the columns of `_atom_site`.
pub(super) struct ComponentAtoms {
    pub(super) names: Vec<String>,
    pub(super) rows: Vec<Rows>,
    /// Number of atoms without coordinates.
    pub(super) nowhere: usize,
}

impl Component {
    /// Returns whether there are no atoms.
    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.single.is_none()
    }

    /// Sets the columns of a loop, without their prefix.
    pub(super) fn set_names(&mut self, names: Vec<String>) {
        *self = Self { names, ..Self::default() };
    }

    /// Adds an atom of the loop.
    pub(super) fn push(&mut self, row: &Rows) {
        self.rows.push(row.clone());
    }

    /// Adds a value outside of a loop, unless there was a loop.
    pub(super) fn push_item(&mut self, name: &str, value: &[u8]) {
        if self.single.is_none() && !self.names.is_empty() {
            return;
        }
        self.names.push(name.to_owned());
        self.single.get_or_insert_with(|| Rows::new(1)).push(value);
    }

    /// Returns the atoms that have coordinates, those of the kind that most atoms have; `None` if no atom has any.
    pub(super) fn atoms(mut self) -> Option<ComponentAtoms> {
        self.rows.extend(self.single);
        let column = |name: &str| self.names.iter().position(|own| own.eq_ignore_ascii_case(name));
        let has = |row: &Rows, axes: [usize; 3]| {
            axes.iter().all(|&axis| !matches!(row.field(axis), b"." | b"?"))
        };
        let mut best: Option<(usize, [usize; 3])> = None;
        for axes in COORDINATES {
            let [Some(x), Some(y), Some(z)] = axes.map(column) else { continue };
            let count = self.rows.iter().filter(|row| has(row, [x, y, z])).count();
            if count > best.map_or(0, |(most, _)| most) {
                best = Some((count, [x, y, z]));
            }
        }
        let (count, axes) = best?;
        let nowhere = self.rows.len() - count;
        self.rows.retain(|row| has(row, axes));
        for (from, to) in EITHER_NAME {
            self.names.iter_mut().filter(|name| *name == from).for_each(|name| to.clone_into(name));
        }
        for (axis, name) in axes.into_iter().zip(["Cartn_x", "Cartn_y", "Cartn_z"]) {
            name.clone_into(&mut self.names[axis]);
        }
        Some(ComponentAtoms { names: self.names, rows: self.rows, nowhere })
    }
}
