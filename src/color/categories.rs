//! Colors that tell kinds of things apart.

use super::{Rgb, srgb};

/// How many kinds have colors of their own.
pub const CATEGORIES: usize = COLORS.len();

/// Ten colors that people with any color vision tell apart, dark enough on white and light enough on
/// black: Petroff, "Accessible Color Sequences for Data Visualization", 2021, arXiv:2107.02270.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]
const COLORS: [u32; 10] = [
    0x3F90DA, 0xFFA90E, 0xBD1F01, 0x94A4A2, 0x832DB6, 0xA96B59, 0xE76300, 0xB9AC70, 0x717581,
    0x92DADD,
];

/// The color of a kind, linear, by its place among them from 0. From [`CATEGORIES`] on colors come
/// again.
pub fn category(place: usize) -> Rgb {
    srgb(COLORS[place % CATEGORIES])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_kinds_differ_and_then_colors_repeat() {
        for place in 0..CATEGORIES {
            assert!((0..place).all(|other| category(other) != category(place)));
            assert_eq!(category(place + CATEGORIES), category(place));
        }
        assert_eq!(category(0), srgb(0x3F_90_DA));
    }
}
