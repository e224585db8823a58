//! Statistics of a value that was measured several times.

use serde::Serialize;

/// Median, minimum and maximum of repeated measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The median; of an even number of values, the mean of the two in the middle.
    pub median: f64,
    /// The minimum.
    pub least: f64,
    /// The maximum.
    pub greatest: f64,
}

impl Spread {
    /// Returns the statistics of values in any order; all NaN if there are none.
    pub fn from_values(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(&least), Some(&greatest)) = (sorted.first(), sorted.last()) else {
            return Self::exactly(f64::NAN);
        };
        let count = sorted.len();
        let median = f64::midpoint(sorted[(count - 1) / 2], sorted[count / 2]);
        Self { median, least, greatest }
    }

    /// Returns the spread of a value that does not vary.
    pub fn exactly(value: f64) -> Self {
        Self { median: value, least: value, greatest: value }
    }

    /// Returns the rates `amount / value`, for values that are times.
    pub fn rate(self, amount: f64) -> Self {
        let Self { median, least, greatest } = self;
        Self { median: amount / median, least: amount / greatest, greatest: amount / least }
    }

    /// Multiplies by a positive factor.
    pub fn times(self, factor: f64) -> Self {
        let Self { median, least, greatest } = self;
        Self { median: median * factor, least: least * factor, greatest: greatest * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        let spread = |values: &[f64]| Spread::from_values(values);
        let expected = Spread { median: 3.0, least: 1.0, greatest: 9.0 };
        assert_eq!(spread(&[9.0, 1.0, 3.0]), expected);
        assert_eq!(spread(&[4.0, 9.0, 1.0, 2.0]), expected);
        assert_eq!(spread(&[5.0]), Spread::exactly(5.0));
        assert!(spread(&[]).median.is_nan());
    }

    #[test]
    fn rates_swap_minimum_and_maximum() {
        let seconds = Spread { median: 2.0, least: 1.0, greatest: 4.0 };
        assert_eq!(seconds.rate(8.0), Spread { median: 4.0, least: 2.0, greatest: 8.0 });
        assert_eq!(seconds.times(2.0), Spread { median: 4.0, least: 2.0, greatest: 8.0 });
    }
}
