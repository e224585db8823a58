//! Derives elements from type names.

use crate::element::{is_virtual_site, of_atom_name};
use crate::{Element, Kind, Kinds, number, schema::Naming};

/// Fraction of particles without an element above which names are not read as elements.
const NO_SYMBOLS: f64 = 0.5;
const NO_NAMES: f64 = 0.1;

/// Returns the type for a name.
pub(crate) fn kind(name: &str, naming: Naming) -> Kind {
    let virtual_site = is_virtual_site(name, "");
    let is_number = number::whole(name.as_bytes()).is_some();
    let is_type = is_number && naming == Naming::Types;
    let element = if virtual_site || is_type { None } else { Element::from_label(name) };
    Kind { name: name.to_owned(), element, virtual_site }
}

/// Returns the type of an atom of a molecule, by its name and that of its residue.
pub(crate) fn of_atom(name: &str, residue: &str) -> Kind {
    let virtual_site = is_virtual_site(name, residue);
    let element = if virtual_site { None } else { of_atom_name(name, residue) };
    Kind { name: name.to_owned(), element, virtual_site }
}

/// Removes all elements if too many particles have none: then names that look like symbols are
/// something else, such as beads of a coarse-grained model.
pub(crate) fn drop_uncertain_elements(kinds: &mut Kinds, naming: Naming) {
    let limit = match naming {
        Naming::Symbols => NO_SYMBOLS,
        Naming::Types => 0.0,
        Naming::Names => NO_NAMES,
    };
    let mut counts = vec![0_u64; kinds.table.len()];
    (0..kinds.codes.len()).for_each(|row| counts[kinds.codes.code(row) as usize] += 1);
    let none = |(kind, count): (&Kind, &u64)| {
        if kind.element.is_none() && !kind.virtual_site { *count } else { 0 }
    };
    let unknown: u64 = kinds.table.iter().zip(&counts).map(none).sum();
    if unknown as f64 > limit * kinds.codes.len() as f64 {
        kinds.table.iter_mut().for_each(|kind| kind.element = None);
    }
}
