//! Colors of the chemical elements in common schemes for molecules.
#![allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]

use super::{Rgb, srgb};

/// Jmol's colors, sRGB; row 0 is element 1. It has none beyond meitnerium.
#[rustfmt::skip]
const JMOL: [u32; 109] = [
    0xFFFFFF, 0xD9FFFF, 0xCC80FF, 0xC2FF00, 0xFFB5B5, 0x909090, 0x3050F8, 0xFF0D0D, 0x90E050,
    0xB3E3F5, 0xAB5CF2, 0x8AFF00, 0xBFA6A6, 0xF0C8A0, 0xFF8000, 0xFFFF30, 0x1FF01F, 0x80D1E3,
    0x8F40D4, 0x3DFF00, 0xE6E6E6, 0xBFC2C7, 0xA6A6AB, 0x8A99C7, 0x9C7AC7, 0xE06633, 0xF090A0,
    0x50D050, 0xC88033, 0x7D80B0, 0xC28F8F, 0x668F8F, 0xBD80E3, 0xFFA100, 0xA62929, 0x5CB8D1,
    0x702EB0, 0x00FF00, 0x94FFFF, 0x94E0E0, 0x73C2C9, 0x54B5B5, 0x3B9E9E, 0x248F8F, 0x0A7D8C,
    0x006985, 0xC0C0C0, 0xFFD98F, 0xA67573, 0x668080, 0x9E63B5, 0xD47A00, 0x940094, 0x429EB0,
    0x57178F, 0x00C900, 0x70D4FF, 0xFFFFC7, 0xD9FFC7, 0xC7FFC7, 0xA3FFC7, 0x8FFFC7, 0x61FFC7,
    0x45FFC7, 0x30FFC7, 0x1FFFC7, 0x00FF9C, 0x00E675, 0x00D452, 0x00BF38, 0x00AB24, 0x4DC2FF,
    0x4DA6FF, 0x2194D6, 0x267DAB, 0x266696, 0x175487, 0xD0D0E0, 0xFFD123, 0xB8B8D0, 0xA6544D,
    0x575961, 0x9E4FB5, 0xAB5C00, 0x754F45, 0x428296, 0x420066, 0x007D00, 0x70ABFA, 0x00BAFF,
    0x00A1FF, 0x008FFF, 0x0080FF, 0x006BFF, 0x545CF2, 0x785CE3, 0x8A4FE3, 0xA136D4, 0xB31FD4,
    0xB31FBA, 0xB30DA6, 0xBD0D87, 0xC70066, 0xCC0059, 0xD1004F, 0xD90045, 0xE00038, 0xE6002E,
    0xEB0026,
];

/// `RasMol`'s colors, sRGB, by atomic number, after the wooden models of Corey, Pauling and Koltun.
#[rustfmt::skip]
const CPK: [(u8, u32); 28] = [
    (1, 0xFFFFFF), (2, 0xFFC0CB), (3, 0xB22222), (5, 0x00FF00), (6, 0xC8C8C8), (7, 0x8F8FFF),
    (8, 0xF00000), (9, 0xDAA520), (11, 0x0000FF), (12, 0x228B22), (13, 0x808090), (14, 0xDAA520),
    (15, 0xFFA500), (16, 0xFFC832), (17, 0x00FF00), (20, 0x808090), (22, 0x808090),
    (24, 0x808090), (25, 0x808090), (26, 0xFFA500), (28, 0xA52A2A), (29, 0xA52A2A),
    (30, 0xA52A2A), (35, 0xA52A2A), (47, 0x808090), (53, 0xA020F0), (56, 0xFFA500),
    (79, 0xDAA520),
];

/// Returns Jmol's color of the element with this atomic number, linear; `None` except for 1 to 109.
pub fn jmol(number: u8) -> Option<Rgb> {
    let row = usize::from(number).checked_sub(1)?;
    JMOL.get(row).map(|&color| srgb(color))
}

/// Returns the color of the element with this atomic number in the scheme CPK, linear, in the shades of
/// `RasMol` 2; `None` for elements without a color of their own, which `RasMol` shows in deep pink.
pub fn cpk(number: u8) -> Option<Rgb> {
    CPK.iter().find(|row| row.0 == number).map(|row| srgb(row.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn well_known_atoms_have_their_colors() {
        let cases = [
            (1, 0xFFFFFF, 0xFFFFFF),
            (6, 0x909090, 0xC8C8C8),
            (7, 0x3050F8, 0x8F8FFF),
            (8, 0xFF0D0D, 0xF00000),
            (16, 0xFFFF30, 0xFFC832),
            (26, 0xE06633, 0xFFA500),
            (79, 0xFFD123, 0xDAA520),
        ];
        for (number, first, second) in cases {
            assert_eq!(jmol(number), Some(srgb(first)), "{number}");
            assert_eq!(cpk(number), Some(srgb(second)), "{number}");
        }
    }

    #[test]
    fn elements_beyond_the_tables_have_no_color() {
        assert_eq!((jmol(0), jmol(110), jmol(255)), (None, None, None));
        assert_eq!((cpk(0), cpk(19), cpk(92)), (None, None, None));
        assert!((1..=109).all(|number| jmol(number).is_some()));
    }
}
