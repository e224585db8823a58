//! Scales: maps from numbers to colors.

use super::map::{Map, between};
use super::{Range, Rgb, srgb};
use rayon::prelude::*;

/// A map from numbers to colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Color map.
    pub map: Map,
    /// True if the map is reversed.
    pub reversed: bool,
    /// Range of numbers.
    pub range: Range,
    /// Color of numbers below the range; `None` for that of its low end.
    pub below: Option<Rgb>,
    /// Color of numbers above the range; `None` for that of its high end.
    pub above: Option<Rgb>,
    /// Color of NaN, and without `below` of numbers that have no logarithm on a logarithmic scale.
    pub missing: Rgb,
}

impl Scale {
    /// Creates a scale. Numbers outside of the range get the colors of its ends; NaN, and on a logarithmic scale what has no
    /// logarithm, is middle gray, `#808080`.
    pub fn new(map: Map, range: Range) -> Self {
        let missing = srgb(0x80_80_80);
        Self { map, reversed: false, range, below: None, above: None, missing }
    }

    /// Returns the linear color of a number.
    pub fn color(&self, value: f64) -> Rgb {
        self.pick(value, |position| self.map.at(position))
    }

    /// Returns the linear colors of numbers: the same as [`Scale::color`] for each, but faster.
    pub fn colors(&self, values: &[f64]) -> Vec<Rgb> {
        let rows = self.map.rows();
        let at = |position| between(position, |row| rows[row]);
        values.par_iter().map(|&value| self.pick(value, at)).collect()
    }

    /// Returns the linear color at a position in the range: 0 is the low end, 1 the high end.
    pub fn at(&self, position: f64) -> Rgb {
        self.map.at(if self.reversed { 1.0 - position } else { position })
    }

    fn pick(&self, value: f64, at: impl Fn(f64) -> Rgb) -> Rgb {
        let position = self.range.position(value);
        let outside = match position {
            position if position.is_nan() => Some(self.missing),
            position if position < 0.0 && self.range.is_undefined(value) => {
                self.below.or(Some(self.missing))
            }
            position if position < 0.0 => self.below,
            position if position > 1.0 => self.above,
            _ => None,
        };
        let position = if self.reversed { 1.0 - position } else { position };
        outside.unwrap_or_else(|| at(position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Spacing;

    fn scale() -> Scale {
        Scale::new(Map::Plasma, Range::new(10.0, 1000.0, Spacing::Logarithmic).unwrap())
    }

    #[test]
    fn numbers_have_the_colors_of_their_positions() {
        let at = |position: f64| Map::Plasma.at(position);
        let expected = [
            (10.0, at(0.0)),
            (100.0, at(0.5)),
            (1000.0, at(1.0)),
            (1e9, at(1.0)),
            (f64::INFINITY, at(1.0)),
            (1.0, at(0.0)),
            (0.0, srgb(0x80_80_80)),
            (-5.0, srgb(0x80_80_80)),
            (f64::NAN, srgb(0x80_80_80)),
        ];
        for (value, color) in expected {
            assert_eq!(scale().color(value), color, "{value}");
        }
        let reversed = Scale { reversed: true, ..scale() };
        for (value, color) in [(10.0, at(1.0)), (1000.0, at(0.0)), (1e9, at(0.0)), (1e-9, at(1.0))]
        {
            assert_eq!(reversed.color(value), color, "{value}");
        }
    }

    #[test]
    fn numbers_outside_may_have_colors_of_their_own() {
        let scale = Scale {
            below: Some(Rgb::X),
            above: Some(Rgb::Y),
            missing: Rgb::Z,
            reversed: true,
            ..scale()
        };
        let colors = scale.colors(&[9.9, 0.0, 1000.1, f64::INFINITY, f64::NAN, 10.0, 1000.0]);
        assert_eq!(colors[..5], [Rgb::X, Rgb::X, Rgb::Y, Rgb::Y, Rgb::Z]);
        assert_eq!(colors[5..], [Map::Plasma.at(1.0), Map::Plasma.at(0.0)]);
    }

    #[test]
    fn columns_have_the_colors_of_their_numbers() {
        let values: Vec<f64> = (0..500).map(|i| f64::from(i) * 2.5 - 20.0).collect();
        for reversed in [false, true] {
            let scale = Scale { reversed, ..scale() };
            let colors = scale.colors(&values);
            assert!(values.iter().zip(&colors).all(|(value, color)| scale.color(*value) == *color));
        }
    }

    #[test]
    fn positions_are_reversed_too() {
        assert_eq!(scale().at(0.25), Map::Plasma.at(0.25));
        assert_eq!(Scale { reversed: true, ..scale() }.at(0.25), Map::Plasma.at(0.75));
    }
}
