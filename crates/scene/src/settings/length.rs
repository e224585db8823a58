//! Lengths on paper, and the pixels that they are at a resolution.

use super::{Settings, Value};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};
use std::num::NonZeroU16;
use std::str::FromStr;

/// A length on paper: whole in English Metric Units (ECMA-376), so that multiples of a hundredth of a millimeter, an inch
/// or a point are exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Length(u32);

/// Units of a [`Length`] per inch.
const PER_INCH: u64 = 914_400;

/// Units of length with their size in those of a [`Length`], in the order in which they are preferred.
const UNITS: [(&str, f64); 4] =
    [("mm", 36_000.0), ("in", 914_400.0), ("pt", 12_700.0), ("cm", 360_000.0)];

/// The units in a sentence.
const NAMES: &str = "mm, cm, in or pt";

/// Width and height of an image on paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Paper {
    /// Width.
    pub width: Length,
    /// Height.
    pub height: Length,
    /// True if the height is not given: it follows from the width, and from the aspect that the image had before.
    pub keeps_aspect: bool,
}

impl Length {
    /// Pixels per inch where lengths are given, but no resolution.
    pub const RESOLUTION: NonZeroU16 = NonZeroU16::new(300).unwrap();

    /// Returns a length in points, of which an inch has 72.
    pub const fn points(points: u16) -> Self {
        Self(points as u32 * 12_700)
    }

    /// Returns the nearest number of pixels at a resolution in pixels per inch.
    pub fn pixels(self, resolution: NonZeroU16) -> u32 {
        ((u64::from(self.0) * u64::from(resolution.get()) + PER_INCH / 2) / PER_INCH) as u32
    }

    /// Returns the number of pixels, not rounded, at a resolution in pixels per inch.
    pub fn exact_pixels(self, resolution: NonZeroU16) -> f64 {
        f64::from(self.0) * f64::from(resolution.get()) / PER_INCH as f64
    }

    /// Returns this length times a ratio of two numbers.
    fn scaled(self, numerator: u32, denominator: u32) -> Self {
        let denominator = u64::from(denominator.max(1));
        let units = (u64::from(self.0) * u64::from(numerator) + denominator / 2) / denominator;
        Self(units.clamp(1, u32::MAX.into()) as u32)
    }
}

impl Paper {
    /// Returns the size of a width and a height; without a height, in the aspect of an image of `pixels`.
    pub(super) fn new(width: Length, height: Option<Length>, [across, down]: [u32; 2]) -> Self {
        let keeps_aspect = height.is_none();
        Self { width, height: height.unwrap_or_else(|| width.scaled(down, across)), keeps_aspect }
    }

    /// Returns the size as [`paper_size`] parses it; without a height that follows from the default aspect.
    pub(crate) fn text(self) -> String {
        let Settings { width, height, .. } = Settings::default();
        if self == Self::new(self.width, None, [width, height]) {
            return self.width.to_string();
        }
        format!("{}x{}", self.width, self.height)
    }

    /// Returns width and height in pixels.
    pub(super) fn pixels(self, resolution: NonZeroU16) -> [u32; 2] {
        [self.width, self.height].map(|length| length.pixels(resolution))
    }
}

impl FromStr for Length {
    type Err = String;

    /// Parses a number with its unit, as in `85mm`.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let read = |(unit, size): &(&str, f64)| -> Option<f64> {
            text.strip_suffix(unit)?.trim_end().parse::<f64>().ok().map(|number| number * size)
        };
        let units = UNITS.iter().find_map(read).map(f64::round);
        let units = units.filter(|units| (1.0..=f64::from(u32::MAX)).contains(units));
        units.map(|units| Self(units as u32)).ok_or_else(|| {
            format!("give a length greater than 0 with its unit, {NAMES}, as in 85mm")
        })
    }
}

impl Display for Length {
    /// As it is parsed, in the unit in which it has the fewest decimals.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let number =
            |(unit, size): &(&'static str, f64)| ((f64::from(self.0) / size).to_string(), *unit);
        let decimals = |text: &str| text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let best = UNITS.iter().map(number).min_by_key(|(number, _)| decimals(number));
        let (number, unit) = best.unwrap_or_default();
        write!(f, "{number}{unit}")
    }
}

/// Parses the size of an image on paper: `85mm`, whose height keeps the aspect, or `85mm x 60mm`.
///
/// # Errors
/// It is none.
pub fn paper_size(text: &str) -> Result<Value, String> {
    let (width, height) = match text.split_once(['x', 'X']) {
        Some((width, height)) => (width, Some(height)),
        None => (text, None),
    };
    let length = |text: &str| {
        let example = "as in 85mm or 85mmx60mm";
        text.parse().map_err(|_| format!("give lengths with their unit, {NAMES}, {example}"))
    };
    let size: (Length, Option<Length>) = (length(width)?, height.map(length).transpose()?);
    Ok(Value::Paper { width: size.0, height: size.1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(text: &str) -> Length {
        text.parse().expect(text)
    }

    #[test]
    fn lengths_are_exact_and_read_back() {
        let same = [("25.4mm", "1in"), ("2.54 cm", "1in"), ("72pt", "1in"), ("85mm", "8.5cm")];
        for (a, b) in same {
            assert_eq!(length(a), length(b));
        }
        assert_eq!(Length::points(7), length("7pt"));
        for text in ["85mm", "7pt", "0.01mm", "63.75mm", "2.5mm", "100mm"] {
            assert_eq!(length(text).to_string(), text);
        }
        for text in ["3.3in", "0.001pt", "1.23456789cm", "4600in"] {
            assert_eq!(length(&length(text).to_string()), length(text));
        }
        let wrong =
            ["", "85", "mm", "0mm", "-1mm", "NaNmm", "infin", "1e9mm", "5m", "5px", "1,5mm"];
        for text in wrong {
            assert!(text.parse::<Length>().is_err(), "{text}");
        }
    }

    #[test]
    fn pixels_are_the_nearest() {
        for (text, inches) in [("85mm", 85.0 / 25.4), ("240pt", 240.0 / 72.0), ("3.3in", 3.3)] {
            for dpi in [1_u16, 72, 254, 300, 600, 1200] {
                let resolution = NonZeroU16::new(dpi).unwrap();
                let pixels = inches * f64::from(dpi);
                assert_eq!(length(text).pixels(resolution), pixels.round() as u32, "{text} {dpi}");
                assert!((length(text).exact_pixels(resolution) - pixels).abs() < 1e-3 * pixels);
            }
        }
    }

    #[test]
    fn sizes_follow_the_resolution_in_either_order() {
        let paper = paper_size("85mm").unwrap();
        let dpi = |dpi| ("dpi", Value::Whole(dpi));
        let changed = |values: &[(&'static str, Value)]| {
            let mut settings = Settings { width: 1000, height: 500, ..Settings::default() };
            settings.change(values);
            (settings.width, settings.height, settings.dpi.map(NonZeroU16::get))
        };
        assert_eq!(changed(&[("size", paper)]), (1004, 502, Some(300)));
        assert_eq!(changed(&[("size", paper), dpi(600)]), (2008, 1004, Some(600)));
        assert_eq!(changed(&[dpi(600), ("size", paper)]), (2008, 1004, Some(600)));
        let whole = paper_size("85mm x 6cm").unwrap();
        assert_eq!(changed(&[("size", whole), dpi(254)]), (850, 600, Some(254)));
        assert_eq!(changed(&[dpi(150)]), (1000, 500, Some(150)));
        for text in ["85", "85mmx", "85mmx60", "x60mm", "85mmx60mmx3mm", "85mmx0mm", "800x600"] {
            assert!(paper_size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn pixels_that_are_set_otherwise_are_no_paper_size() {
        let mut settings = Settings::default();
        settings.change(&[("size", paper_size("85mmx60mm").unwrap())]);
        assert_eq!(settings.paper().map(Paper::text).as_deref(), Some("85mmx60mm"));
        settings.width += 1;
        assert_eq!(settings.paper(), None);
        let pixels = (settings.width, settings.height);
        settings.change(&[("dpi", Value::Whole(600))]);
        assert_eq!((settings.width, settings.height), pixels);
    }
}
