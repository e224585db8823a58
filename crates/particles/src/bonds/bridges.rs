//! Contacts of metals across anions, which are no bonds: radii of metals are those of metallic bonds, and so large
//! that atoms on either side of an anion are within them.

use super::Bonds;
use super::components::{Adjacency, Near};
use super::rules::TOLERANCE;
use crate::{Element, ParticleFrame};
use rayon::prelude::*;

/// Elements that form anions, with their electronegativities (Pauling's scale, as revised by Allred, Journal of
/// Inorganic and Nuclear Chemistry 17, 1961).
const ANIONS: [(&str, f64); 12] = [
    ("H", 2.20),
    ("N", 3.04),
    ("O", 3.44),
    ("F", 3.98),
    ("P", 2.19),
    ("S", 2.58),
    ("Cl", 3.16),
    ("As", 2.18),
    ("Se", 2.55),
    ("Br", 2.96),
    ("Te", 2.10),
    ("I", 2.66),
];

/// Electronegativity of carbon, which bonds to metals as often as it stands between them and oxygen.
const CARBON: f64 = 2.55;

/// Elements that are neither metals nor anions. Silicon, germanium and antimony are cations beside anions, as metals are.
const NONMETALS: [&str; 10] = ["He", "B", "C", "Ne", "Ar", "Kr", "Xe", "At", "Rn", "Og"];

/// Metals whose hydrides are of ions.
const ALKALI: [&str; 6] = ["Li", "Na", "K", "Rb", "Cs", "Fr"];

/// Returns whether an element is an alkali metal.
pub(super) fn is_alkali(element: Element) -> bool {
    ALKALI.contains(&element.symbol())
}

/// The role of the atoms of a type.
#[derive(Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools, reason = "facts that do not exclude each other")]
struct Species {
    is_metal: bool,
    is_anion: bool,
    is_hydrogen: bool,
    is_alkali: bool,
    electronegativity: f64,
    covalent_radius: f64,
}

impl Species {
    fn of(element: Element) -> Self {
        let symbol = element.symbol();
        let anion = ANIONS.iter().find(|(own, _)| *own == symbol);
        let carbon = if symbol == "C" { CARBON } else { 0.0 };
        Self {
            is_metal: anion.is_none() && !NONMETALS.contains(&symbol),
            is_anion: anion.is_some(),
            is_hydrogen: symbol == "H",
            is_alkali: is_alkali(element),
            electronegativity: anion.map_or(carbon, |(_, own)| *own),
            covalent_radius: element.covalent_radius().unwrap_or(0.0),
        }
    }
}

/// Removes what covalent radii take for bonds of a metal across an anion: those to another metal if an anion is bonded
/// to both, and those to an atom between which and the metal a more electronegative one is bonded to both, such as the
/// phosphorus of a phosphate or the carbon of a carboxylate, if they are longer than the sum of the radii, and
/// relatively longer than the bond of the metal to the anion. Also those of alkali metals to hydrogen that is no hydride, as far
/// as only these are bonded.
pub(super) fn remove_bridged(bonds: &mut Bonds, frame: &ParticleFrame) {
    let species = |kind: &crate::Kind| kind.element.map_or_else(Species::default, Species::of);
    let table: Vec<Species> = frame.kinds.table.iter().map(species).collect();
    let has = |role: fn(&Species) -> bool| table.iter().any(role);
    if bonds.is_empty() || !has(|own| own.is_metal) || !has(|own| own.is_anion) {
        return;
    }
    let contacts =
        Contacts { adjacency: Adjacency::new(bonds, frame.len()), bonds, frame, table: &table };
    let keep: Vec<bool> = (0..bonds.len())
        .into_par_iter()
        .map(|bond| !contacts.is_bridged(bond) && !contacts.is_loose(bond))
        .collect();
    let mut keep = keep.into_iter();
    bonds.map(|bond| keep.next().unwrap_or(true).then_some(bond));
}

/// Contacts by covalent radii, and the roles of their atoms.
struct Contacts<'c> {
    adjacency: Adjacency,
    bonds: &'c Bonds,
    frame: &'c ParticleFrame,
    table: &'c [Species],
}

impl Contacts<'_> {
    fn species(&self, row: u32) -> Species {
        self.table[self.frame.kinds.codes.code(row as usize) as usize]
    }

    fn near(&self, row: u32) -> impl Iterator<Item = Near> {
        self.adjacency.near(self.bonds, row)
    }

    /// Returns the length of a contact relative to the sum of the covalent radii.
    fn stretch(&self, bond: usize) -> f64 {
        let (first, second, _) = self.bonds.bond(bond);
        let ends = [first, second];
        let positions = ends.map(|row| self.frame.position(row as usize));
        let length = self.bonds.vector(bond, positions, self.frame.cell.as_ref()).length();
        let radii: f64 = ends.iter().map(|&row| self.species(row).covalent_radius).sum();
        length / (radii * self.frame.unit.per_angstrom())
    }

    /// Returns whether a contact of an alkali metal to hydrogen is too long for hydrogen that is bonded to something
    /// else, as in water and borohydrides.
    fn is_loose(&self, bond: usize) -> bool {
        let (first, second, _) = self.bonds.bond(bond);
        let [own, other] = [first, second].map(|row| self.species(row));
        let hydrogen =
            match (own.is_hydrogen && other.is_alkali, other.is_hydrogen && own.is_alkali) {
                (true, _) => first,
                (_, true) => second,
                (false, false) => return false,
            };
        let radii = own.covalent_radius + other.covalent_radius;
        self.stretch(bond) * radii > radii + TOLERANCE
            && self.near(hydrogen).any(|near| !self.species(near.row).is_alkali)
    }

    fn is_bridged(&self, bond: usize) -> bool {
        let (first, second, shift) = self.bonds.bond(bond);
        let shift = shift.map(i32::from);
        let [own, other] = [first, second].map(|row| self.species(row));
        let (metal, partner, shift) = match (own.is_metal, other.is_metal) {
            (true, _) => (first, second, shift),
            (false, true) => (second, first, shift.map(|edge| -edge)),
            (false, false) => return false,
        };
        let are_metals = own.is_metal && other.is_metal;
        let weaker = self.species(partner).electronegativity;
        let stretch = if are_metals { f64::INFINITY } else { self.stretch(bond) };
        if stretch <= 1.0 {
            return false;
        }
        self.near(metal).any(|anion| {
            let species = self.species(anion.row);
            let joins = |near: Near| {
                let place = [0, 1, 2].map(|edge| shift[edge] + near.shift[edge]);
                near.row == anion.row && place == anion.shift
            };
            species.is_anion
                && species.electronegativity > weaker
                && self.near(partner).any(joins)
                && self.stretch(anion.bond) < stretch
        })
    }
}
