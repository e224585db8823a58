//! Derives elements from type names.

use crate::element::{is_virtual_site, of_atom_name, of_group};
use crate::{
    Element, ElementSource, Kind, Kinds, ParticleFrame, error::listed, number, schema::Naming,
};
use std::collections::HashMap;

/// Fraction of particles without an element above which names are not read as elements.
const NO_SYMBOLS: f64 = 0.5;
const NO_NAMES: f64 = 0.1;

/// Returns the type for a name.
pub(crate) fn kind(name: &str, naming: Naming) -> Kind {
    let virtual_site = is_virtual_site(name, "");
    let is_number = number::whole(name.as_bytes()).is_some();
    // Types of GAFF and other force fields for molecules are in small letters: `ca` is an aromatic carbon.
    let is_small = name.len() == 2 && name.bytes().all(|letter| letter.is_ascii_lowercase());
    let is_type = (is_number || is_small) && naming == Naming::Types;
    let group = || if naming == Naming::Groups { of_group(name) } else { None };
    let found = || Element::from_label(name).or_else(group);
    let element = if virtual_site || is_type { None } else { found() };
    let source = match naming {
        Naming::Types => ElementSource::Type,
        Naming::Names => ElementSource::Name,
        Naming::Symbols | Naming::Groups if is_number => ElementSource::Number,
        Naming::Symbols | Naming::Groups => ElementSource::Symbol,
    };
    Kind { name: name.to_owned(), element, source, virtual_site }
}

/// Types of SYBYL that stand for no element: dummies, lone pairs, and sets of elements.
const NO_ELEMENT: [&str; 6] = ["Du", "LP", "Any", "Hal", "Het", "Hev"];

/// Returns the type of an atom in MOL2, by its type, its name and that of its residue. Types are those of SYBYL, which begin with
/// an element with its capitals and end with the hybridization after a point, or those of a force field, which are
/// no elements: then the name tells.
pub(crate) fn of_sybyl(kind: &str, name: &str, residue: &str) -> Kind {
    let own = self::kind(kind.split('.').next().unwrap_or(kind), Naming::Symbols);
    let symbol = own.name.trim_end_matches(|letter: char| !letter.is_ascii_alphabetic());
    let is_sybyl = own.element.is_some_and(|element| element.symbol() == symbol);
    if own.virtual_site || is_sybyl || NO_ELEMENT.contains(&symbol) {
        return Kind { source: ElementSource::Type, ..own };
    }
    match of_atom_name(name, residue) {
        Some(element) => Kind { element: Some(element), source: ElementSource::Name, ..own },
        None => Kind { source: ElementSource::Type, ..own },
    }
}

/// Returns the type of an atom of a molecule, by its name and that of its residue.
pub(crate) fn of_atom(name: &str, residue: &str) -> Kind {
    let virtual_site = is_virtual_site(name, residue);
    let element = if virtual_site { None } else { of_atom_name(name, residue) };
    Kind { name: name.to_owned(), element, source: ElementSource::Name, virtual_site }
}

/// Elements by names and by masses.
#[derive(Default)]
pub(crate) struct Weighing {
    /// Types whose names count although they are of other masses: each name with its mass.
    differing: HashMap<Kind, String>,
}

impl Weighing {
    /// Returns a type with its element by its own name and by its mass. Masses that differ by as much as simulations
    /// change them are those of the element that the name says.
    pub(crate) fn weigh(&mut self, kind: Kind, name: &str, mass: f64) -> Kind {
        let by_mass = Element::from_mass(mass);
        if kind.virtual_site {
            return kind;
        }
        match kind.element {
            Some(element) if element.may_have_mass(mass) => {
                if by_mass != kind.element {
                    self.differing.insert(kind.clone(), format!("`{name}` of mass {mass}"));
                }
                kind
            }
            _ if by_mass.is_some() => {
                Kind { element: by_mass, source: ElementSource::Mass, ..kind }
            }
            _ => kind,
        }
    }

    /// Adds a warning that counts the atoms whose names and masses say different elements.
    pub(crate) fn warn(&self, frame: &mut ParticleFrame) {
        let texts = frame.kinds.table.iter().map(|kind| self.differing.get(kind));
        let texts: Vec<Option<&String>> = texts.collect();
        let codes = &frame.kinds.codes;
        let count =
            (0..codes.len()).filter(|row| texts[codes.code(*row) as usize].is_some()).count();
        let names: Vec<&str> = texts.into_iter().flatten().map(String::as_str).collect();
        if count > 0 {
            let (atoms, have) = if count == 1 { ("atom", "has") } else { ("atoms", "have") };
            let reason = format!(
                "{count} {atoms} {have} the mass of another element or of none, and the names count"
            );
            frame.warnings.push(listed(&reason, &names));
        }
    }
}

/// Returns whether symbols are names of atoms of proteins: those of the backbone, and one that is no symbol.
fn are_of_proteins(table: &[Kind]) -> bool {
    let has = |name: &str| table.iter().any(|kind| kind.name == name);
    ["N", "CA", "C", "O"].into_iter().all(has)
        && ["CB", "HA", "HA1", "HA2", "OXT"].into_iter().any(has)
}

/// Removes all elements if too many particles have none: then names that look like symbols are
/// something else, such as beads of a coarse-grained model.
pub(crate) fn drop_uncertain_elements(kinds: &mut Kinds, naming: Naming) {
    if naming == Naming::Symbols && are_of_proteins(&kinds.table) {
        kinds.table.iter_mut().for_each(|kind| *kind = of_atom(&kind.name, ""));
    }
    let limit = match naming {
        Naming::Symbols | Naming::Groups => NO_SYMBOLS,
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
