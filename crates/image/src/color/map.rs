//! Color maps: from 0..=1 to colors.

use super::custom_map::CustomMap;
use super::tables::{CIVIDIS, COOLWARM, INFERNO, MAGMA, PLASMA, ROWS, TURBO, Table, VIRIDIS};
use super::{Rgb, srgb};
use crate::suggest;
use std::str::FromStr;

/// A published color map. All except [`Map::Turbo`] are perceptually uniform.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Map {
    /// Dark blue over green to yellow.
    #[default]
    Viridis,
    /// Dark blue to yellow: nearly the same for color-blind readers.
    Cividis,
    /// Black over red to pale yellow.
    Inferno,
    /// Black over purple to pale pink.
    Magma,
    /// Blue over red to yellow.
    Plasma,
    /// A rainbow: more contrast, but not perceptually uniform.
    Turbo,
    /// Blue over gray to red, for data with a midpoint.
    Coolwarm,
    /// Evenly spaced colors of one's own.
    Custom(CustomMap),
}

impl Map {
    /// All published maps.
    pub const ALL: [Self; 7] = [
        Self::Viridis,
        Self::Cividis,
        Self::Inferno,
        Self::Magma,
        Self::Plasma,
        Self::Turbo,
        Self::Coolwarm,
    ];

    /// Returns the published name, in lower case, or the colors of a map of one's own.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Cividis => "cividis",
            Self::Inferno => "inferno",
            Self::Magma => "magma",
            Self::Plasma => "plasma",
            Self::Turbo => "turbo",
            Self::Coolwarm => "coolwarm",
            Self::Custom(own) => own.text(),
        }
    }

    /// Returns the map with this name, in any case, or of colors with commas between them.
    pub fn named(name: &str) -> Option<Self> {
        name.parse().ok()
    }

    /// Returns the linear color at `position`: 0 is the low end, 1 the high end; positions outside are
    /// clamped, and NaN counts as 0. At multiples of 1/255 it is the published color to all 8 bits.
    pub fn at(self, position: f64) -> Rgb {
        let table = self.table();
        between(position, |row| srgb(table[row]))
    }

    /// Returns the rows of the table, linear.
    pub(super) fn rows(self) -> Vec<Rgb> {
        self.table().iter().map(|&color| srgb(color)).collect()
    }

    fn table(self) -> &'static Table {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::Cividis => &CIVIDIS,
            Self::Inferno => &INFERNO,
            Self::Magma => &MAGMA,
            Self::Plasma => &PLASMA,
            Self::Turbo => &TURBO,
            Self::Coolwarm => &COOLWARM,
            Self::Custom(own) => own.table(),
        }
    }
}

impl FromStr for Map {
    type Err = String;

    /// Parses the name of a published map, in any case, or colors with commas between them, as in `navy,white,firebrick`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text.contains(',') {
            return CustomMap::of_colors(text).map(Self::Custom);
        }
        let found = Self::ALL.into_iter().find(|map| map.name().eq_ignore_ascii_case(text));
        found.ok_or_else(|| {
            let help = suggest::help(text, Self::ALL.into_iter().map(Self::name), "maps are");
            format!("unknown color map `{text}`; {help}, or colors as in navy,white,firebrick")
        })
    }
}

/// Interpolates the color at a position between two rows.
pub(super) fn between(position: f64, row: impl Fn(usize) -> Rgb) -> Rgb {
    let inside = if position > 0.0 { position.min(1.0) } else { 0.0 };
    let scaled = inside * (ROWS - 1) as f64;
    let first = (scaled as usize).min(ROWS - 2);
    row(first).lerp(row(first + 1), (scaled - first as f64) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::tone::srgb_encode;

    fn codes(color: Rgb) -> [u64; 3] {
        color.to_array().map(|value| (srgb_encode(f64::from(value)) * 255.0).round() as u64)
    }

    /// Sums of (row + 1) times the code of each channel, computed with matplotlib 3.11.
    #[test]
    fn maps_are_those_of_matplotlib_to_8_bits() {
        let truths = [
            (Map::Viridis, [3_454_698, 5_792_254, 3_155_439]),
            (Map::Cividis, [5_520_313, 5_215_135, 3_315_503]),
            (Map::Inferno, [6_871_560, 4_161_232, 2_244_502]),
            (Map::Magma, [6_912_143, 4_028_590, 4_039_299]),
            (Map::Plasma, [7_200_131, 4_251_230, 2_791_813]),
            (Map::Turbo, [5_808_590, 4_515_755, 1_988_674]),
            (Map::Coolwarm, [6_974_266, 4_798_890, 4_821_893]),
        ];
        for (map, truth) in truths {
            let mut sums = [0; 3];
            for row in 0..ROWS {
                let codes = codes(map.at(row as f64 / 255.0));
                (0..3).for_each(|channel| sums[channel] += (row as u64 + 1) * codes[channel]);
            }
            assert_eq!(sums, truth, "{}", map.name());
        }
    }

    #[test]
    fn known_colors_are_where_they_should_be() {
        assert_eq!(codes(Map::Viridis.at(0.0)), [0x44, 0x01, 0x54]);
        assert_eq!(codes(Map::Viridis.at(1.0)), [0xFD, 0xE7, 0x25]);
        // The gray in the middle of its paper.
        assert_eq!(codes(Map::Coolwarm.at(0.5)), [0xDD; 3]);
        assert_eq!(codes(Map::Magma.at(0.0)), [0, 0, 4]);
    }

    #[test]
    fn positions_beyond_the_ends_are_clamped() {
        for map in Map::ALL {
            assert_eq!(map.at(-0.1), map.at(0.0));
            assert_eq!(map.at(f64::INFINITY), map.at(1.0));
            assert_eq!(map.at(f64::NAN), map.at(0.0));
        }
    }

    #[test]
    fn colors_change_smoothly() {
        for map in Map::ALL {
            let color = |step: u32| map.at(f64::from(step) / 4000.0);
            let jump = |step: u32| (color(step + 1) - color(step)).abs().max_element();
            let most = (0..4000).map(jump).fold(0.0, f32::max);
            assert!(most < 0.004, "{}: {most}", map.name());
        }
    }

    #[test]
    fn names_find_their_maps() {
        assert!(Map::ALL.into_iter().all(|map| Map::named(map.name()) == Some(map)));
        assert_eq!(Map::named("Viridis"), Some(Map::Viridis));
        assert_eq!(Map::named("jet"), None);
    }
}
