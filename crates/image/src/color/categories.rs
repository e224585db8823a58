//! Categorical colors.

use super::{Rgb, srgb};

/// Number of distinct colors.
pub const CATEGORIES: usize = COLORS.len();

/// Thirty colors of which no two are near, for usual color vision, protanopia and deuteranopia: the least distances by
/// CIEDE2000 are 12.7, 8.7 and 8.7, and 17.3, 11.9 and 12.6 among the first ten.
///
/// The first ten are those of Petroff, "Accessible Color Sequences for Data Visualization", 2021, arXiv:2107.02270. The others
/// were found by a search, and are in an order in which each one is as far as possible from those before it.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]
const COLORS: [u32; 30] = [
    0x3F90DA, 0xFFA90E, 0xBD1F01, 0x94A4A2, 0x832DB6, 0xA96B59, 0xE76300, 0xB9AC70, 0x717581, 0x92DADD,
    0x00483C, 0x54486C, 0x00C0FC, 0xF0E4C0, 0xF03CB4, 0x009C78, 0x780C00, 0x84003C, 0xC0E484, 0x1830FC,
    0xD8F0E4, 0x3C6C30, 0xF0F048, 0x90C09C, 0x3C6C60, 0xFC9CC0, 0x3C2490, 0x1890A8, 0x006CFC, 0xB43C60,
];

/// Returns the linear color of a category by its index from 0. Colors repeat from [`CATEGORIES`] on.
pub fn category(index: usize) -> Rgb {
    srgb(COLORS[index % COLORS.len()])
}

#[cfg(test)]
mod tests;
