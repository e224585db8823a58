//! Alternate locations of atoms in PDB and mmCIF: the conformer of each residue with the greatest
//! occupancy is drawn; the first in the list wins ties.

use super::frame::ParticleFrame;
use std::collections::HashMap;

/// The atoms of a model that have alternate locations.
#[derive(Default)]
pub(crate) struct Alternates {
    residues: HashMap<Vec<u8>, Vec<Alternate>>,
}

/// Identifiers of an atom at an alternate location.
#[derive(Clone, Copy)]
pub(crate) struct AlternateAtom<'a> {
    /// The indicator of the location, such as `B`.
    pub(crate) location: &'a [u8],
    /// Chain, number and insertion code of the residue.
    pub(crate) residue: [&'a [u8]; 3],
    pub(crate) residue_name: &'a [u8],
    pub(crate) name: &'a [u8],
    /// 1 if missing.
    pub(crate) occupancy: f64,
}

struct Alternate {
    row: usize,
    location: Vec<u8>,
    residue_name: Vec<u8>,
    name: Vec<u8>,
    occupancy: f64,
}

impl Alternates {
    /// Adds the atom of a row.
    pub(crate) fn add(&mut self, row: usize, atom: AlternateAtom) {
        let alternate = Alternate {
            row,
            location: atom.location.to_vec(),
            residue_name: atom.residue_name.to_vec(),
            name: atom.name.to_vec(),
            occupancy: atom.occupancy,
        };
        self.residues.entry(atom.residue.join(&0)).or_default().push(alternate);
    }

    /// Removes the atoms of all conformers but the main ones.
    pub(crate) fn choose(self, frame: &mut ParticleFrame) {
        let mut keep = vec![true; if self.residues.is_empty() { 0 } else { frame.len() }];
        for atoms in self.residues.values() {
            for atom in atoms {
                keep[atom.row] = false;
            }
            for atom in main_atoms(atoms) {
                keep[atom.row] = true;
            }
        }
        let lesser = keep.iter().filter(|keep| !**keep).count();
        if lesser > 0 {
            frame.retain(&keep);
            frame.warnings.push(format!(
                "{lesser} atoms at alternate locations are left out: of each residue, the conformer \
                 with the greatest occupancy is drawn"
            ));
        }
    }
}

/// Returns the atoms of a residue's main conformer, and those that only others have.
fn main_atoms(atoms: &[Alternate]) -> impl Iterator<Item = &Alternate> {
    let mut conformers: Vec<(&[u8], f64, f64)> = Vec::new();
    for atom in atoms {
        match conformers.iter_mut().find(|(location, ..)| *location == atom.location) {
            Some((_, sum, count)) => (*sum, *count) = (*sum + atom.occupancy, *count + 1.0),
            None => conformers.push((&atom.location, atom.occupancy, 1.0)),
        }
    }
    // A stable sort: the first in the list wins ties.
    conformers.sort_by(|one, other| (other.1 / other.2).total_cmp(&(one.1 / one.2)));
    let rank = move |atom: &Alternate| {
        conformers.iter().position(|(location, ..)| *location == atom.location)
    };
    let main = atoms.iter().min_by_key(|atom| rank(atom)).map(|atom| &atom.residue_name);
    // Conformers may be different residues: then atoms of the others don't belong to the main one.
    let mut chosen: HashMap<&[u8], &Alternate> = HashMap::new();
    for atom in atoms.iter().filter(|atom| Some(&atom.residue_name) == main) {
        let best = chosen.entry(&atom.name).or_insert(atom);
        if rank(atom) < rank(best) {
            *best = atom;
        }
    }
    chosen.into_values()
}
