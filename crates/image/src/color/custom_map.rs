//! Color maps of one's own: evenly spaced colors.

use super::names;
use super::tables::{ROWS, Table};
use crate::image::tone::srgb_encode;
use std::sync::{Mutex, PoisonError};

/// A color map of 2 to 256 evenly spaced colors, interpolated in sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CustomMap {
    text: &'static str,
    table: &'static Table,
}

/// All maps that there are. Each is kept for good, which is 1 KiB for each that a user writes: so maps can be copied.
static KNOWN: Mutex<Vec<CustomMap>> = Mutex::new(Vec::new());

impl CustomMap {
    /// Returns the map of colors with commas between them, as in `navy,white,#b22222`.
    ///
    /// # Errors
    /// One of them is not a color, or there are fewer than 2 or more than 256.
    pub(super) fn of_colors(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split(',').map(str::trim).collect();
        if !(2..=ROWS).contains(&words.len()) {
            let count = words.len();
            return Err(format!("a color map has 2 to {ROWS} colors, but this one has {count}"));
        }
        let text = words.join(",");
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(own) = known.iter().find(|own| own.text == text) {
            return Ok(*own);
        }
        let codes = words.into_iter().map(codes).collect::<Result<Vec<_>, _>>()?;
        let table = Box::leak(Box::new(std::array::from_fn(|row| row_of(&codes, row))));
        let own = Self { text: Box::leak(text.into_boxed_str()), table };
        known.push(own);
        Ok(own)
    }

    /// Returns the colors as they were written.
    pub fn text(self) -> &'static str {
        self.text
    }

    pub(super) fn table(self) -> &'static Table {
        self.table
    }
}

/// Returns the sRGB codes of a color, 0 to 255.
fn codes(word: &str) -> Result<[f64; 3], String> {
    let color = names::of_name(word)?;
    Ok(color.to_array().map(|value| (srgb_encode(f64::from(value)) * 255.0).round()))
}

/// Returns a row of the table of evenly spaced colors. The interpolation is that of matplotlib's maps.
fn row_of(codes: &[[f64; 3]], row: usize) -> u32 {
    let scaled = (row * (codes.len() - 1)) as f64 / (ROWS - 1) as f64;
    let first = (scaled as usize).min(codes.len() - 2);
    let between = scaled - first as f64;
    let [low, high] = [codes[first], codes[first + 1]];
    let code =
        |channel: usize| (low[channel] + (high[channel] - low[channel]) * between).round() as u32;
    code(0) << 16 | code(1) << 8 | code(2)
}

#[cfg(test)]
mod tests {
    use crate::color::{Map, parse};

    #[test]
    fn colors_are_evenly_spaced() {
        let map: Map = "navy, white,#B22222".parse().unwrap();
        assert_eq!(map.name(), "navy,white,#B22222");
        assert_eq!(Some(map.at(0.0)), parse("navy"));
        assert_eq!(Some(map.at(1.0)), parse("#b22222"));
        // Half of 255 is between two rows.
        assert!((map.at(0.5) - parse("white").unwrap()).abs().max_element() < 0.01);
        let gray: Map = "black,white".parse().unwrap();
        assert_eq!(Some(gray.at(51.0 / 255.0)), parse("#333333"));
        assert_eq!(Map::named("navy,white,#B22222"), Some(map));
    }

    /// 256 colors are the rows of the table: maps of other programs are taken as they are.
    #[test]
    fn tables_of_256_colors_are_exact() {
        let words: Vec<String> =
            (0..256).map(|row| format!("#{:06x}", row * 65_793 % 0x100_0000)).collect();
        let map: Map = words.join(",").parse().unwrap();
        for (row, word) in words.iter().enumerate() {
            assert_eq!(Some(map.at(row as f64 / 255.0)), parse(word), "{row}");
        }
    }

    #[test]
    fn invalid_maps_are_refused() {
        for (text, part) in [("navy,wite", "wite"), ("jet", "jet"), ("navy,", "``")] {
            let message = text.parse::<Map>().unwrap_err();
            assert!(message.contains(part), "{message}");
        }
        let many = vec!["red"; 257].join(",");
        assert!(many.parse::<Map>().unwrap_err().contains("257"));
    }
}
