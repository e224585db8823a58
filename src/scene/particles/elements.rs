//! Radii and colors of the chemical elements.

use crate::scene::{Rgb, srgb};

/// Symbol, van der Waals radius in angstrom (Alvarez, "A cartography of the van der Waals
/// territories", Dalton Transactions 2013, DOI 10.1039/C3DT50599E; 0 where it has none) and Jmol's
/// sRGB color; row 0 is element 1.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]
const ELEMENTS: [(&str, f64, u32); 109] = [
    ("H", 1.20, 0xFFFFFF), ("He", 1.43, 0xD9FFFF), ("Li", 2.12, 0xCC80FF), ("Be", 1.98, 0xC2FF00),
    ("B", 1.91, 0xFFB5B5), ("C", 1.77, 0x909090), ("N", 1.66, 0x3050F8), ("O", 1.50, 0xFF0D0D),
    ("F", 1.46, 0x90E050), ("Ne", 1.58, 0xB3E3F5), ("Na", 2.50, 0xAB5CF2), ("Mg", 2.51, 0x8AFF00),
    ("Al", 2.25, 0xBFA6A6), ("Si", 2.19, 0xF0C8A0), ("P", 1.90, 0xFF8000), ("S", 1.89, 0xFFFF30),
    ("Cl", 1.82, 0x1FF01F), ("Ar", 1.94, 0x80D1E3), ("K", 2.73, 0x8F40D4), ("Ca", 2.62, 0x3DFF00),
    ("Sc", 2.58, 0xE6E6E6), ("Ti", 2.46, 0xBFC2C7), ("V", 2.42, 0xA6A6AB), ("Cr", 2.45, 0x8A99C7),
    ("Mn", 2.45, 0x9C7AC7), ("Fe", 2.44, 0xE06633), ("Co", 2.40, 0xF090A0), ("Ni", 2.40, 0x50D050),
    ("Cu", 2.38, 0xC88033), ("Zn", 2.39, 0x7D80B0), ("Ga", 2.32, 0xC28F8F), ("Ge", 2.29, 0x668F8F),
    ("As", 1.88, 0xBD80E3), ("Se", 1.82, 0xFFA100), ("Br", 1.86, 0xA62929), ("Kr", 2.07, 0x5CB8D1),
    ("Rb", 3.21, 0x702EB0), ("Sr", 2.84, 0x00FF00), ("Y", 2.75, 0x94FFFF), ("Zr", 2.52, 0x94E0E0),
    ("Nb", 2.56, 0x73C2C9), ("Mo", 2.45, 0x54B5B5), ("Tc", 2.44, 0x3B9E9E), ("Ru", 2.46, 0x248F8F),
    ("Rh", 2.44, 0x0A7D8C), ("Pd", 2.15, 0x006985), ("Ag", 2.53, 0xC0C0C0), ("Cd", 2.49, 0xFFD98F),
    ("In", 2.43, 0xA67573), ("Sn", 2.42, 0x668080), ("Sb", 2.47, 0x9E63B5), ("Te", 1.99, 0xD47A00),
    ("I", 2.04, 0x940094), ("Xe", 2.28, 0x429EB0), ("Cs", 3.48, 0x57178F), ("Ba", 3.03, 0x00C900),
    ("La", 2.98, 0x70D4FF), ("Ce", 2.88, 0xFFFFC7), ("Pr", 2.92, 0xD9FFC7), ("Nd", 2.95, 0xC7FFC7),
    ("Pm", 0.00, 0xA3FFC7), ("Sm", 2.90, 0x8FFFC7), ("Eu", 2.87, 0x61FFC7), ("Gd", 2.83, 0x45FFC7),
    ("Tb", 2.79, 0x30FFC7), ("Dy", 2.87, 0x1FFFC7), ("Ho", 2.81, 0x00FF9C), ("Er", 2.83, 0x00E675),
    ("Tm", 2.79, 0x00D452), ("Yb", 2.80, 0x00BF38), ("Lu", 2.74, 0x00AB24), ("Hf", 2.63, 0x4DC2FF),
    ("Ta", 2.53, 0x4DA6FF), ("W", 2.57, 0x2194D6), ("Re", 2.49, 0x267DAB), ("Os", 2.48, 0x266696),
    ("Ir", 2.41, 0x175487), ("Pt", 2.29, 0xD0D0E0), ("Au", 2.32, 0xFFD123), ("Hg", 2.45, 0xB8B8D0),
    ("Tl", 2.47, 0xA6544D), ("Pb", 2.60, 0x575961), ("Bi", 2.54, 0x9E4FB5), ("Po", 0.00, 0xAB5C00),
    ("At", 0.00, 0x754F45), ("Rn", 2.40, 0x428296), ("Fr", 0.00, 0x420066), ("Ra", 0.00, 0x007D00),
    ("Ac", 2.80, 0x70ABFA), ("Th", 2.93, 0x00BAFF), ("Pa", 2.88, 0x00A1FF), ("U", 2.71, 0x008FFF),
    ("Np", 2.82, 0x0080FF), ("Pu", 2.81, 0x006BFF), ("Am", 2.83, 0x545CF2), ("Cm", 3.05, 0x785CE3),
    ("Bk", 3.40, 0x8A4FE3), ("Cf", 3.05, 0xA136D4), ("Es", 2.70, 0xB31FD4), ("Fm", 0.00, 0xB31FBA),
    ("Md", 0.00, 0xB30DA6), ("No", 0.00, 0xBD0D87), ("Lr", 0.00, 0xC70066), ("Rf", 0.00, 0xCC0059),
    ("Db", 0.00, 0xD1004F), ("Sg", 0.00, 0xD90045), ("Bh", 0.00, 0xE00038), ("Hs", 0.00, 0xE6002E),
    ("Mt", 0.00, 0xEB0026),
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
    let (radius, color) = row
        .and_then(|row| ELEMENTS.get(row))
        .map_or((0.0, Rgb::splat(0.5)), |&(_, radius, color)| (radius, srgb(color)));
    let known = radius > 0.0;
    Element { radius: if known { radius } else { USUAL_RADIUS }, color, known }
}

#[cfg(test)]
mod tests {
    use super::*;

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
