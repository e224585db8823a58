//! Radii and names of the chemical elements.

use crate::color::elements::jmol;
use crate::scene::Rgb;

/// Symbol, van der Waals radius in angstrom (Alvarez, "A cartography of the van der Waals
/// territories", Dalton Transactions 2013, DOI 10.1039/C3DT50599E; 0 where it has none);
/// row 0 is element 1.
#[rustfmt::skip]
const ELEMENTS: [(&str, f64); 109] = [
    ("H", 1.20), ("He", 1.43), ("Li", 2.12), ("Be", 1.98), ("B", 1.91), ("C", 1.77), ("N", 1.66),
    ("O", 1.50), ("F", 1.46), ("Ne", 1.58), ("Na", 2.50), ("Mg", 2.51), ("Al", 2.25), ("Si", 2.19),
    ("P", 1.90), ("S", 1.89), ("Cl", 1.82), ("Ar", 1.94), ("K", 2.73), ("Ca", 2.62), ("Sc", 2.58),
    ("Ti", 2.46), ("V", 2.42), ("Cr", 2.45), ("Mn", 2.45), ("Fe", 2.44), ("Co", 2.40), ("Ni", 2.40),
    ("Cu", 2.38), ("Zn", 2.39), ("Ga", 2.32), ("Ge", 2.29), ("As", 1.88), ("Se", 1.82), ("Br", 1.86),
    ("Kr", 2.07), ("Rb", 3.21), ("Sr", 2.84), ("Y", 2.75), ("Zr", 2.52), ("Nb", 2.56), ("Mo", 2.45),
    ("Tc", 2.44), ("Ru", 2.46), ("Rh", 2.44), ("Pd", 2.15), ("Ag", 2.53), ("Cd", 2.49), ("In", 2.43),
    ("Sn", 2.42), ("Sb", 2.47), ("Te", 1.99), ("I", 2.04), ("Xe", 2.28), ("Cs", 3.48), ("Ba", 3.03),
    ("La", 2.98), ("Ce", 2.88), ("Pr", 2.92), ("Nd", 2.95), ("Pm", 0.00), ("Sm", 2.90), ("Eu", 2.87),
    ("Gd", 2.83), ("Tb", 2.79), ("Dy", 2.87), ("Ho", 2.81), ("Er", 2.83), ("Tm", 2.79), ("Yb", 2.80),
    ("Lu", 2.74), ("Hf", 2.63), ("Ta", 2.53), ("W", 2.57), ("Re", 2.49), ("Os", 2.48), ("Ir", 2.41),
    ("Pt", 2.29), ("Au", 2.32), ("Hg", 2.45), ("Tl", 2.47), ("Pb", 2.60), ("Bi", 2.54), ("Po", 0.00),
    ("At", 0.00), ("Rn", 2.40), ("Fr", 0.00), ("Ra", 0.00), ("Ac", 2.80), ("Th", 2.93), ("Pa", 2.88),
    ("U", 2.71), ("Np", 2.82), ("Pu", 2.81), ("Am", 2.83), ("Cm", 3.05), ("Bk", 3.40), ("Cf", 3.05),
    ("Es", 2.70), ("Fm", 0.00), ("Md", 0.00), ("No", 0.00), ("Lr", 0.00), ("Rf", 0.00), ("Db", 0.00),
    ("Sg", 0.00), ("Bh", 0.00), ("Hs", 0.00), ("Mt", 0.00),
];

/// Radius of an atom whose element is unknown, or has none in the table, in angstrom.
pub(super) const USUAL_RADIUS: f64 = 1.7;

/// What an atom looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Element {
    /// Angstrom.
    pub(super) radius: f64,
    pub(super) color: Rgb,
    /// Whether the table has a radius for it.
    pub(super) known: bool,
}

/// The element that a file calls so: a symbol in any case, alone or with a number after it, or an
/// atomic number.
pub(super) fn element(name: &str) -> Element {
    let symbol = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let row = match name.parse::<usize>() {
        Ok(number) => number.checked_sub(1),
        Err(_) => ELEMENTS.iter().position(|(own, ..)| own.eq_ignore_ascii_case(symbol)),
    };
    let radius = row.and_then(|row| ELEMENTS.get(row)).map_or(0.0, |element| element.1);
    let number = row.and_then(|row| u8::try_from(row + 1).ok());
    let color = number.and_then(jmol).unwrap_or(Rgb::splat(0.5));
    let known = radius > 0.0;
    Element { radius: if known { radius } else { USUAL_RADIUS }, color, known }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::srgb;

    #[test]
    fn names_of_all_kinds_find_their_element() {
        let iron = element("Fe");
        assert_eq!((iron.radius, iron.color, iron.known), (2.44, srgb(0xE0_66_33), true));
        for name in ["FE", "fe", "Fe12", "26"] {
            assert_eq!(element(name), iron, "{name}");
        }
        assert_eq!((element("H").radius, element("C").radius), (1.2, 1.77));
        assert_eq!((element("118").known, element("0").known), (false, false));
    }

    #[test]
    fn unknown_names_are_gray_and_of_usual_size() {
        for name in ["", "Q", "1e9", "ä", "99999999999999999999"] {
            let unknown = element(name);
            assert_eq!((unknown.radius, unknown.known), (USUAL_RADIUS, false), "{name}");
        }
        // Polonium has a color, but no radius.
        assert_eq!((element("Po").color, element("Po").known), (srgb(0xAB_5C_00), false));
    }
}
