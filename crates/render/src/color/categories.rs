//! Categorical colors.

use super::{Rgb, srgb};

/// Number of distinct colors.
pub const CATEGORIES: usize = COLORS.len();

/// Ten colors that are distinguishable with any color vision, dark enough on white and light enough on
/// black: Petroff, "Accessible Color Sequences for Data Visualization", 2021, arXiv:2107.02270.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]
const COLORS: [u32; 10] = [
    0x3F90DA, 0xFFA90E, 0xBD1F01, 0x94A4A2, 0x832DB6, 0xA96B59, 0xE76300, 0xB9AC70, 0x717581,
    0x92DADD,
];

/// Returns the linear color of a category by its index from 0. Colors repeat from [`CATEGORIES`] on.
pub fn category(index: usize) -> Rgb {
    srgb(COLORS[index % CATEGORIES])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_categories_differ_and_then_colors_repeat() {
        for index in 0..CATEGORIES {
            assert!((0..index).all(|other| category(other) != category(index)));
            assert_eq!(category(index + CATEGORIES), category(index));
        }
        assert_eq!(category(0), srgb(0x3F_90_DA));
    }
}
