//! Chemical elements: symbols, labels, radii and masses.

mod names;
mod tables;

pub(super) use names::{
    is_virtual_site, of_aligned_name, of_atom_name, of_autodock_type, of_group,
};
use tables::{COVALENT, IONIC, MASSES, SYMBOLS, VAN_DER_WAALS};

/// A chemical element, by its atomic number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Element(u8);

/// Tolerance of masses in daltons: files round them, and some have 1 for hydrogen.
const MASS_TOLERANCE: f64 = 0.06;

/// Maximum mass in daltons that simulations with long steps move to a hydrogen from the atom that it is bonded to (Hopkins
/// et al., "Long-time-step molecular dynamics through hydrogen mass repartitioning", Journal of Chemical Theory and
/// Computation 2015), and number of hydrogens that may take it from an atom.
const MOVED: f64 = 3.1;
const TAKERS: f64 = 3.0;

/// Maximum mass in daltons that a united atom has of its hydrogens.
const UNITED: f64 = 4.1;

impl Element {
    /// Returns the element with this atomic number, 1 to 118.
    pub fn from_number(number: u64) -> Option<Self> {
        (1..=SYMBOLS.len() as u64).contains(&number).then_some(Self(number as u8))
    }

    /// Returns the element with this symbol, ignoring case; deuterium and tritium are hydrogen.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        let symbol = if ["D", "T", "d", "t"].contains(&symbol) { "H" } else { symbol };
        let row = SYMBOLS.iter().position(|own| own.eq_ignore_ascii_case(symbol))?;
        Self::from_number(row as u64 + 1)
    }

    /// Returns the element with this mass to within 0.06 daltons.
    pub fn from_mass(mass: f64) -> Option<Self> {
        let distance = |row: &usize| (MASSES[*row] - mass).abs();
        let row = (0..MASSES.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(&row) <= MASS_TOLERANCE).then(|| Self::from_number(row as u64 + 1)).flatten()
    }

    /// Returns whether an atom of this element may have this mass in a simulation: masses of hydrogens and of atoms with
    /// hydrogens may be repartitioned, or those of united atoms.
    pub(crate) fn may_have_mass(self, mass: f64) -> bool {
        let Some(more) = MASSES.get(self.row()).map(|own| mass - own) else { return false };
        let range = match self.symbol() {
            "H" => -MASS_TOLERANCE..=MOVED,
            "C" | "N" | "O" | "Si" | "P" | "S" => -TAKERS * MOVED..=UNITED,
            _ => -MASS_TOLERANCE..=MASS_TOLERANCE,
        };
        range.contains(&more)
    }

    /// Returns the element of a label: an atomic number, or a symbol in any case, optionally followed by a
    /// number, a charge, or a note in parentheses.
    pub fn from_label(label: &str) -> Option<Self> {
        if let Ok(number) = label.parse() {
            return Self::from_number(number);
        }
        let name = label.split('(').next().unwrap_or(label);
        let is_suffix = |letter: char| letter.is_ascii_digit() || "+-_".contains(letter);
        Self::from_symbol(name.trim_end_matches(is_suffix))
    }

    /// Returns the atomic number, 1 to 118.
    pub fn number(self) -> u8 {
        self.0
    }

    /// Returns the symbol, such as `Fe`.
    pub fn symbol(self) -> &'static str {
        SYMBOLS[self.row()]
    }

    /// Van der Waals radius in angstrom (Alvarez, "A cartography of the van der Waals territories",
    /// Dalton Transactions 2013); `None` for elements that have none there.
    pub fn van_der_waals_radius(self) -> Option<f64> {
        VAN_DER_WAALS.get(self.row()).copied().filter(|&radius| radius > 0.0)
    }

    /// Covalent radius in angstrom (Cordero et al., "Covalent radii revisited", Dalton Transactions
    /// 2008); `None` beyond curium.
    pub fn covalent_radius(self) -> Option<f64> {
        COVALENT.get(self.row()).copied()
    }

    /// Effective ionic radius in angstrom at a coordination of 6 (Shannon, "Revised effective ionic radii", Acta
    /// Crystallographica A32, 1976) of the commonest state of oxidation; `None` for elements that have none there.
    pub fn ionic_radius(self) -> Option<f64> {
        IONIC.get(self.row()).copied().filter(|&radius| radius > 0.0)
    }

    fn row(self) -> usize {
        usize::from(self.0) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radii(symbol: &str) -> (Option<f64>, Option<f64>) {
        let element = Element::from_symbol(symbol).expect("an element");
        (element.van_der_waals_radius(), element.covalent_radius())
    }

    #[test]
    fn radii_are_those_of_the_papers() {
        for (symbol, van_der_waals, covalent) in [
            ("H", 1.20, 0.31),
            ("C", 1.77, 0.76),
            ("N", 1.66, 0.71),
            ("O", 1.50, 0.66),
            ("P", 1.90, 1.07),
            ("S", 1.89, 1.05),
            ("Fe", 2.44, 1.32),
            ("Cs", 3.48, 2.44),
            ("Au", 2.32, 1.36),
            ("U", 2.71, 1.96),
        ] {
            assert_eq!(radii(symbol), (Some(van_der_waals), Some(covalent)), "{symbol}");
        }
        assert_eq!(radii("Po"), (None, Some(1.40)));
        assert_eq!(radii("Es"), (Some(2.70), None));
        assert_eq!(radii("Og"), (None, None));
    }

    #[test]
    fn ionic_radii_are_those_of_the_commonest_state() {
        for (symbol, radius) in [
            ("Li", 0.76),
            ("N", 1.46),
            ("O", 1.40),
            ("Na", 1.02),
            ("Cl", 1.81),
            ("Ti", 0.605),
            ("Mn", 0.83),
            ("Fe", 0.645),
            ("Sr", 1.18),
            ("I", 2.20),
            ("Cs", 1.67),
            ("Lu", 0.861),
            ("Pb", 1.19),
            ("U", 0.73),
            ("Cf", 0.95),
        ] {
            let found = Element::from_symbol(symbol).and_then(Element::ionic_radius);
            assert_eq!(found, Some(radius), "{symbol}");
        }
        for symbol in ["H", "He", "Xe", "At", "Ra", "Es", "Og"] {
            assert_eq!(Element::from_symbol(symbol).and_then(Element::ionic_radius), None);
        }
    }

    #[test]
    fn labels_of_all_kinds_find_their_element() {
        let iron = Element::from_symbol("Fe");
        assert_eq!(iron.map(Element::number), Some(26));
        for label in ["FE", "fe", "Fe12", "26", "Fe3+", "Fe2-", "Fe_1", "Fe(Iso=57)"] {
            assert_eq!(Element::from_label(label), iron, "{label}");
        }
        assert_eq!(Element::from_label("D").map(Element::symbol), Some("H"));
        for label in ["", "Q", "1e9", "ä", "0", "119", "99999999999999999999"] {
            assert_eq!(Element::from_label(label), None, "{label}");
        }
    }

    #[test]
    fn masses_find_their_element() {
        for (mass, symbol) in
            [(1.0, "H"), (12.011, "C"), (15.9994, "O"), (26.9815, "Al"), (55.85, "Fe")]
        {
            assert_eq!(Element::from_mass(mass).map(Element::symbol), Some(symbol), "{mass}");
        }
        for mass in [0.0, -1.0, 72.0, 500.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Element::from_mass(mass), None, "{mass}");
        }
    }

    #[test]
    fn repartitioned_masses_are_those_of_their_elements() {
        let may = |symbol: &str, mass: f64| {
            Element::from_symbol(symbol).is_some_and(|element| element.may_have_mass(mass))
        };
        for (symbol, mass) in
            [("H", 3.024), ("H", 4.032), ("C", 9.995), ("C", 5.963), ("N", 11.991), ("C", 15.035)]
        {
            assert!(may(symbol, mass), "{symbol} of {mass}");
        }
        for (symbol, mass) in
            [("H", 12.011), ("C", 40.078), ("N", 22.99), ("O", 0.0), ("K", 40.078), ("Es", 252.0)]
        {
            assert!(!may(symbol, mass), "{symbol} of {mass}");
        }
    }
}
