//! Categorical colors.

use super::{Rgb, srgb};

/// Number of distinct colors: ten hues, the same darker, and lighter.
pub const CATEGORIES: usize = SHADES.len() * HUES.len();

/// Ten colors that are distinguishable with any color vision, dark enough on white and light enough on
/// black: Petroff, "Accessible Color Sequences for Data Visualization", 2021, arXiv:2107.02270.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]
const HUES: [u32; 10] = [
    0x3F90DA, 0xFFA90E, 0xBD1F01, 0x94A4A2, 0x832DB6, 0xA96B59, 0xE76300, 0xB9AC70, 0x717581,
    0x92DADD,
];

/// Fractions of a hue and of white, in linear light, that are mixed for a shade.
const SHADES: [[f32; 2]; 3] = [[1.0, 0.0], [0.3, 0.0], [0.7, 0.3]];

/// Returns the linear color of a category by its index from 0. Colors repeat from [`CATEGORIES`] on.
pub fn category(index: usize) -> Rgb {
    let [hue, white] = SHADES[index / HUES.len() % SHADES.len()];
    srgb(HUES[index % HUES.len()]) * hue + Rgb::splat(white)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn categories_differ_and_then_colors_repeat() {
        for index in 0..CATEGORIES {
            // The cube root is nearly as light as the eye takes it.
            let lightness = |index| category(index).to_array().map(f32::cbrt);
            let differences = (0..index).map(|other| {
                let pairs = lightness(index).into_iter().zip(lightness(other));
                pairs.map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
            });
            let least = differences.fold(f32::INFINITY, f32::min);
            assert!(least > 0.08, "{index}: {least}");
            assert_eq!(category(index + CATEGORIES), category(index));
        }
        assert_eq!(category(0), srgb(0x3F_90_DA));
    }
}
