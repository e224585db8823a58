//! Ranges of numbers, and positions in them.

use crate::elementary::ln;
use rayon::prelude::*;

/// Spacing of numbers between the ends of a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Spacing {
    /// Equal differences are equal steps.
    #[default]
    Linear,
    /// Equal ratios are equal steps; for positive numbers.
    Logarithmic,
}

/// The numbers from a low to a high end: finite, and positive with logarithmic spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
    spacing: Spacing,
}

/// Reasons why a range is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RangeError {
    /// An end is not finite, or the low end is above the high end.
    #[error("invalid range from {low} to {high}; give two finite numbers, the lower one first")]
    Ends {
        /// The low end.
        low: f64,
        /// The high end.
        high: f64,
    },
    /// A logarithmic range that does not start above 0.
    #[error("a logarithmic range cannot begin at {0}; give a number more than 0, or use linear")]
    NotPositive(f64),
    /// No value for a range.
    #[error("none of the values is finite; give the range")]
    Empty,
    /// No value for a logarithmic range.
    #[error("none of the values is finite and more than 0; give the range, or use linear")]
    NonePositive,
}

impl Range {
    /// From 0 to 1, with linear spacing.
    pub const UNIT: Self = Self { low: 0.0, high: 1.0, spacing: Spacing::Linear };

    /// Creates the range from `low` to `high`, which may be equal.
    ///
    /// # Errors
    /// [`RangeError::Ends`] and [`RangeError::NotPositive`].
    pub fn new(low: f64, high: f64, spacing: Spacing) -> Result<Self, RangeError> {
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(RangeError::Ends { low, high });
        }
        if spacing == Spacing::Logarithmic && low <= 0.0 {
            return Err(RangeError::NotPositive(low));
        }
        Ok(Self { low, high, spacing })
    }

    /// Returns the least range that contains all finite values, and only positive ones if `spacing` is
    /// logarithmic.
    ///
    /// # Errors
    /// [`RangeError::Empty`] and [`RangeError::NonePositive`] if there is no such value.
    pub fn of(values: &[f64], spacing: Spacing) -> Result<Self, RangeError> {
        let least = if spacing == Spacing::Logarithmic { 0.0 } else { f64::NEG_INFINITY };
        let (low, high) = values
            .par_iter()
            .filter(|value| value.is_finite() && **value > least)
            .fold(
                || (f64::INFINITY, f64::NEG_INFINITY),
                |(low, high), &value| (low.min(value), high.max(value)),
            )
            .reduce(|| (f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        match spacing {
            _ if low <= high => Ok(Self { low, high, spacing }),
            Spacing::Linear => Err(RangeError::Empty),
            Spacing::Logarithmic => Err(RangeError::NonePositive),
        }
    }

    /// Returns the low end.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// Returns the high end.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Returns the spacing of numbers between the ends.
    pub fn spacing(&self) -> Spacing {
        self.spacing
    }

    /// Returns whether a value has no position: NaN, and 0 or less with logarithmic spacing.
    pub fn is_undefined(&self, value: f64) -> bool {
        value.is_nan() || self.spacing == Spacing::Logarithmic && value <= 0.0
    }

    /// Returns the position of a value: 0 at the low end, 1 at the high end, less or more outside; NaN
    /// for NaN. If the ends are equal, their position is 0.5.
    pub fn position(&self, value: f64) -> f64 {
        if value.is_nan() {
            return f64::NAN;
        }
        // Halves, so that no difference overflows.
        let along = |number: f64| match self.spacing {
            Spacing::Linear => number / 2.0,
            Spacing::Logarithmic => ln(number.max(0.0)),
        };
        let (low, high) = (along(self.low), along(self.high));
        let offset = along(value) - low;
        if high > low {
            offset / (high - low)
        } else if offset == 0.0 {
            0.5
        } else {
            offset * f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Spacing::{Linear, Logarithmic};

    #[test]
    fn positions_are_fractions_of_the_range() {
        let linear = Range::new(-2.0, 6.0, Linear).unwrap();
        let at = [-2.0, 0.0, 6.0, 8.0, -10.0, f64::INFINITY].map(|value| linear.position(value));
        assert_eq!(at, [0.0, 0.25, 1.0, 1.25, -1.0, f64::INFINITY]);
        let logarithmic = Range::new(1e-2, 1e2, Logarithmic).unwrap();
        for (value, position) in [(1e-2, 0.0), (1e-1, 0.25), (1.0, 0.5), (1e2, 1.0), (1e4, 1.5)] {
            assert!((logarithmic.position(value) - position).abs() < 1e-15, "{value}");
        }
        for value in [0.0, -1.0, f64::NEG_INFINITY] {
            assert_eq!(logarithmic.position(value), f64::NEG_INFINITY, "{value}");
        }
        assert!(linear.position(f64::NAN).is_nan() && logarithmic.position(f64::NAN).is_nan());
    }

    #[test]
    fn extremes_do_not_overflow_and_a_point_is_in_the_middle() {
        let widest = Range::new(f64::MIN, f64::MAX, Linear).unwrap();
        assert_eq!([f64::MIN, 0.0, f64::MAX].map(|v| widest.position(v)), [0.0, 0.5, 1.0]);
        for spacing in [Linear, Logarithmic] {
            let point = Range::new(3.0, 3.0, spacing).unwrap();
            let at = [2.0, 3.0, 4.0].map(|value| point.position(value));
            assert_eq!(at, [f64::NEG_INFINITY, 0.5, f64::INFINITY]);
        }
    }

    #[test]
    fn ranges_ignore_values_that_are_not_finite() {
        let values = [f64::NAN, 3.0, f64::INFINITY, -1.0, 0.0, 0.5, f64::NEG_INFINITY];
        assert_eq!(Range::of(&values, Linear), Range::new(-1.0, 3.0, Linear));
        assert_eq!(Range::of(&values, Logarithmic), Range::new(0.5, 3.0, Logarithmic));
        assert_eq!(Range::of(&[f64::NAN], Linear), Err(RangeError::Empty));
        assert_eq!(Range::of(&[0.0, -1.0], Logarithmic), Err(RangeError::NonePositive));
        assert_eq!(Range::of(&[-1.0, -1.0], Linear), Range::new(-1.0, -1.0, Linear));
    }

    #[test]
    fn ends_are_checked() {
        for (low, high) in [(2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            let message = Range::new(low, high, Linear).unwrap_err().to_string();
            assert!(message.contains("the lower one first"), "{message}");
        }
        assert_eq!(Range::new(0.0, 1.0, Logarithmic), Err(RangeError::NotPositive(0.0)));
    }
}
