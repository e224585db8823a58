//! Derives elements from atom names in molecules, for files without a column of elements.

use super::Element;

/// Residues whose atom names begin with the element: amino acids, nucleotides and water.
const STANDARD: [&str; 52] = [
    "ALA", "ARG", "ASN", "ASP", "ASH", "CYS", "CYX", "CYM", "GLN", "GLU", "GLH", "GLY", "HIS",
    "HID", "HIE", "HIP", "HSD", "HSE", "HSP", "ILE", "LEU", "LYS", "LYN", "MET", "PHE", "PRO",
    "SER", "THR", "TRP", "TYR", "VAL", "ACE", "NME", "A", "C", "G", "U", "DA", "DC", "DG", "DT",
    "ADE", "CYT", "GUA", "THY", "URA", "SOL", "HOH", "WAT", "TIP3", "TIP4", "SPC",
];

/// Water residues whose models have virtual sites.
const WATER: [&str; 16] = [
    "SOL", "HOH", "WAT", "H2O", "TIP", "TIP4", "TIP5", "TP4", "TP5", "T4P", "T5P", "T4E", "TP4E",
    "OPC", "SPC", "TIP3",
];

/// Residues of coarse-grained models that are one bead of water or ion: `W` is not tungsten.
const BEADS: [&str; 5] = ["W", "WF", "PW", "WN", "ION"];

/// Ion names of CHARMM.
const IONS: [(&str, &str); 8] = [
    ("SOD", "Na"),
    ("CLA", "Cl"),
    ("POT", "K"),
    ("CAL", "Ca"),
    ("CES", "Cs"),
    ("LIT", "Li"),
    ("RUB", "Rb"),
    ("BAR", "Ba"),
];

/// Atom types of `AutoDock` that are no symbols of their elements (`AD4.1_bound.dat`): acceptors of hydrogen bonds, aromatic
/// carbon, hydrogens of donors, carbons where rings are closed, and water.
const PDBQT_TYPES: [(&str, &str); 14] = [
    ("A", "C"),
    ("CG", "C"),
    ("G", "C"),
    ("GA", "C"),
    ("J", "C"),
    ("Q", "C"),
    ("HD", "H"),
    ("HS", "H"),
    ("NA", "N"),
    ("NS", "N"),
    ("OA", "O"),
    ("OS", "O"),
    ("SA", "S"),
    ("W", "O"),
];

/// Two-letter elements in atom names outside of [`STANDARD`] residues, although their first letter is
/// an element too.
const LONG: [&str; 7] = ["CL", "BR", "SI", "SE", "FE", "CU", "PT"];

/// One-letter elements in atom names.
const SHORT: &str = "HCNOPSFIBKD";

/// Returns whether this is a virtual site of a water model, with a charge or mass but no atom: `MW`,
/// `M`, `EP` or `LP`, with or without a number; or a ghost of quantum chemistry, which has basis functions but no nucleus: `Bq`.
pub(in super::super) fn is_virtual_site(name: &str, residue: &str) -> bool {
    let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    match stem {
        "MW" | "EP" | "LP" | "EPW" => true,
        "Bq" => residue.is_empty(),
        "M" | "IW" => residue.is_empty() || is_one_of(residue, &WATER),
        _ => false,
    }
}

/// Returns the element of the atom `name` of a residue; `None` if it cannot be derived.
pub(in super::super) fn of_atom_name(name: &str, residue: &str) -> Option<Element> {
    let letters = letters(name);
    if is_one_of(residue, &BEADS) && self::letters(residue) == letters {
        return None;
    }
    ion(letters, residue).or_else(|| by_first_letters(letters, residue))
}

/// Returns the element of an atom name in four columns, the first of which is blank for one-letter
/// elements (PDB); `aligned` is the untrimmed name.
pub(in super::super) fn of_aligned_name(aligned: &str, residue: &str) -> Option<Element> {
    let name = aligned.trim();
    let symbol = aligned.get(..2).unwrap_or_default();
    // `HG11` fills all columns, but is not mercury.
    let full = name.len() == 4 && name.starts_with('H');
    if !full && !is_one_of(residue, &STANDARD) {
        let letters = letters(name);
        let ion = if residue.eq_ignore_ascii_case(letters) { ion(letters, residue) } else { None };
        return ion
            .or_else(|| Element::from_symbol(symbol))
            .or_else(|| of_atom_name(name, residue));
    }
    of_atom_name(name, residue)
}

/// Returns the element of an atom type of `AutoDock`, as PDBQT has them; `None` if it is none. Those of closed rings are
/// numbered, as in `CG0`.
pub(in super::super) fn of_autodock_type(name: &str) -> Option<Element> {
    let name = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let own = PDBQT_TYPES.iter().find(|(own, _)| own.eq_ignore_ascii_case(name));
    Element::from_symbol(own.map_or(name, |(_, symbol)| symbol))
}

/// Returns the element whose symbol, with its capitals, begins the symbol of a group or ion, such as `OH2` and
/// `O2-(H2O)`.
pub(in super::super) fn of_group(name: &str) -> Option<Element> {
    let is_end = |end: usize| !name[end..].starts_with(|letter: char| letter.is_ascii_lowercase());
    let symbols = (1..=2).rev().filter_map(|end| name.get(..end).filter(|_| is_end(end)));
    let found = symbols.filter_map(|symbol| Some((symbol, Element::from_symbol(symbol)?)));
    { found }.find(|(symbol, element)| element.symbol() == *symbol).map(|(_, element)| element)
}

fn letters(name: &str) -> &str {
    let name = name.trim_start_matches(|letter: char| !letter.is_ascii_alphabetic());
    let end = name.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(name.len());
    &name[..end]
}

/// Returns the element of an ion: a residue with the same name as its atom.
fn ion(name: &str, residue: &str) -> Option<Element> {
    if let Some((_, symbol)) = IONS.iter().find(|(ion, _)| *ion == name) {
        return Element::from_symbol(symbol);
    }
    let alone = letters(residue).eq_ignore_ascii_case(name) || residue.eq_ignore_ascii_case("ION");
    if alone { Element::from_symbol(name) } else { None }
}

fn by_first_letters(name: &str, residue: &str) -> Option<Element> {
    let (first, pair) = (name.get(..1)?, name.get(..2));
    let lower = name.as_bytes().get(1).is_some_and(u8::is_ascii_lowercase);
    let long = pair.filter(|pair| {
        let outside = !is_one_of(residue, &STANDARD);
        lower || *pair == "SE" || outside && LONG.contains(pair)
    });
    if let Some(element) = long.and_then(Element::from_symbol) {
        return Some(element);
    }
    if SHORT.contains(first) { Element::from_symbol(first) } else { Element::from_symbol(pair?) }
}

fn is_one_of(residue: &str, list: &[&str]) -> bool {
    list.iter().any(|own| own.eq_ignore_ascii_case(residue))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symbol(element: Option<Element>) -> &'static str {
        element.map_or("-", Element::symbol)
    }

    #[test]
    fn names_in_molecules_begin_with_their_element() {
        for (name, residue, expected) in [
            ("CA", "ALA", "C"),
            ("1HB", "ALA", "H"),
            ("OW", "SOL", "O"),
            ("HG11", "VAL", "H"),
            ("SD", "MET", "S"),
            ("SE", "MSE", "Se"),
            ("SE", "MET", "Se"),
            ("CL1", "ALA", "C"),
            ("Cd1", "LIG", "Cd"),
            ("CL1", "LIG", "Cl"),
            ("NA", "NA", "Na"),
            ("NA", "HEM", "N"),
            ("NA", "NA+", "Na"),
            ("CL", "CL-", "Cl"),
            ("SOD", "SOD", "Na"),
            ("MG", "MG", "Mg"),
            ("FE", "HEM", "Fe"),
            ("Zn2", "X", "Zn"),
            ("D1", "DOD", "H"),
            ("GL1", "DPPC", "-"),
            ("W", "W", "-"),
            ("R5", "CHOL", "-"),
            ("", "", "-"),
            ("é", "", "-"),
        ] {
            assert_eq!(symbol(of_atom_name(name, residue)), expected, "{name} of {residue}");
        }
    }

    #[test]
    fn alignment_of_names_distinguishes_carbon_from_calcium() {
        for (name, residue, expected) in [
            (" CA ", "GLY", "C"),
            (" CA ", "LIG", "C"),
            ("CA  ", "LIG", "Ca"),
            ("POT ", "POT", "K"),
            ("CES ", "CES", "Cs"),
            ("SOD ", "SOD", "Na"),
            ("CLA ", "CLA", "Cl"),
            ("CAL ", "CAL", "Ca"),
            ("BAR ", "BAR", "Ba"),
            ("ZN  ", "ZN2", "Zn"),
            ("NA  ", "NA+", "Na"),
            ("CA  ", "GLY", "C"),
            ("HG21", "XYZ", "H"),
            ("HG  ", "XYZ", "Hg"),
            ("FE  ", "HEM", "Fe"),
            (" PB ", "ATP", "P"),
            ("    ", "", "-"),
            ("C", "LIG", "C"),
            ("1HB ", "LIG", "H"),
        ] {
            assert_eq!(symbol(of_aligned_name(name, residue)), expected, "{name:?} of {residue}");
        }
    }

    #[test]
    fn groups_and_types_of_autodock_have_elements() {
        for (name, expected) in [
            ("OH2", "O"),
            ("O2-(H2O)", "O"),
            ("NH4+", "N"),
            ("Vac", "-"),
            ("Cg", "-"),
            ("\u{e9}", "-"),
        ] {
            assert_eq!(symbol(of_group(name)), expected, "{name}");
        }
        for (name, expected) in [
            ("A", "C"),
            ("OA", "O"),
            ("NA", "N"),
            ("HD", "H"),
            ("CL", "Cl"),
            ("CG0", "C"),
            ("Fe", "Fe"),
            ("X", "-"),
        ] {
            assert_eq!(symbol(of_autodock_type(name)), expected, "{name}");
        }
    }

    #[test]
    fn virtual_sites_of_water_models_are_not_atoms() {
        for (name, residue) in [("MW", "SOL"), ("M", "HOH"), ("EP", "WAT"), ("LP2", "TIP5")] {
            assert!(is_virtual_site(name, residue), "{name}");
        }
        assert!(!is_virtual_site("OW", "SOL") && !is_virtual_site("M", "LIG"));
    }
}
