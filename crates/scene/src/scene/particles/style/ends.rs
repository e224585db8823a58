//! Ranges of color maps: numbers, percentiles, or the extremes of the values.

use super::summary::ColumnSummary;
use crate::color::{Range, RangeError, Spacing};
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// An end of a color map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ColorEnd {
    /// The minimum or the maximum of the values.
    #[default]
    Extreme,
    /// This number.
    Number(f64),
    /// A percentile of the finite values, with linear interpolation: 0 to 100.
    Percentile(f64),
}

/// The ends of a color map, the lower one first. Numbers beyond them are clamped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ColorEnds {
    /// The low end.
    pub low: ColorEnd,
    /// The high end.
    pub high: ColorEnd,
}

impl ColorEnds {
    /// Creates the ends from two numbers.
    pub fn numbers(low: f64, high: f64) -> Self {
        Self { low: ColorEnd::Number(low), high: ColorEnd::Number(high) }
    }

    /// Returns whether the ends depend on the values.
    pub fn depend_on_values(self) -> bool {
        let is_number = |end| matches!(end, ColorEnd::Number(_));
        !(is_number(self.low) && is_number(self.high))
    }

    /// Returns whether percentiles of the values are needed.
    pub(super) fn needs_percentiles(self) -> bool {
        [self.low, self.high].iter().any(|end| matches!(end, ColorEnd::Percentile(_)))
    }

    /// Returns the range of these values.
    ///
    /// # Errors
    /// The ends need values, but there are none; or they are not in order.
    pub(super) fn range(
        self,
        summary: &ColumnSummary,
        spacing: Spacing,
    ) -> Result<Range, RangeError> {
        let none = match spacing {
            Spacing::Linear => RangeError::Empty,
            Spacing::Logarithmic => RangeError::NonePositive,
        };
        let extreme = |row: usize| summary.extremes.map(|extremes| extremes[row]);
        let value = |end, row| match end {
            ColorEnd::Number(number) => Some(number),
            ColorEnd::Extreme => extreme(row),
            ColorEnd::Percentile(percent) => summary.percentile(percent),
        };
        match (value(self.low, 0), value(self.high, 1)) {
            (Some(low), Some(high)) => Range::new(low, high, spacing),
            _ => Err(none),
        }
    }
}

impl FromStr for ColorEnds {
    type Err = String;

    /// Parses `auto`, or two ends: numbers, percentiles as in `2%`, or `auto`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "auto" {
            return Ok(Self::default());
        }
        let ends = text
            .split_once(',')
            .and_then(|(low, high)| Some(Self { low: end(low.trim())?, high: end(high.trim())? }));
        let in_order = |ends: &Self| match (ends.low, ends.high) {
            (ColorEnd::Number(low), ColorEnd::Number(high))
            | (ColorEnd::Percentile(low), ColorEnd::Percentile(high)) => low <= high,
            _ => true,
        };
        ends.filter(in_order).ok_or_else(|| {
            "give two ends, the lower one first, as in -1,2.5 or 2%,98% or 0,auto; or auto"
                .to_owned()
        })
    }
}

/// Parses one end.
fn end(text: &str) -> Option<ColorEnd> {
    if text == "auto" {
        return Some(ColorEnd::Extreme);
    }
    let (number, is_percent) = match text.strip_suffix('%') {
        Some(number) => (number.trim_end(), true),
        None => (text, false),
    };
    let number: f64 = number.parse().ok().filter(|number: &f64| number.is_finite())?;
    if is_percent {
        return (0.0..=100.0).contains(&number).then_some(ColorEnd::Percentile(number));
    }
    Some(ColorEnd::Number(number))
}

impl Display for ColorEnds {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.low, self.high)
    }
}

impl Display for ColorEnd {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Extreme => write!(f, "auto"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Percentile(percent) => write!(f, "{percent}%"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_numbers_percentiles_or_extremes() {
        use ColorEnd::{Extreme, Number, Percentile};
        let ends = |low, high| Ok(ColorEnds { low, high });
        for (text, expected) in [
            ("-1, 2.5", ends(Number(-1.0), Number(2.5))),
            ("auto", ends(Extreme, Extreme)),
            ("2%,98%", ends(Percentile(2.0), Percentile(98.0))),
            ("0,98 %", ends(Number(0.0), Percentile(98.0))),
            ("2%,auto", ends(Percentile(2.0), Extreme)),
            ("auto,-5", ends(Extreme, Number(-5.0))),
        ] {
            assert_eq!(text.parse::<ColorEnds>(), expected, "{text}");
        }
        for text in [
            "", "1", "2,1", "1,inf", "nan,1", "1,2,3", "a,b", "98%,2%", "-1%,5", "0,101%", "%,1",
            "nan%,1",
        ] {
            let error = text.parse::<ColorEnds>().expect_err(text);
            assert!(error.contains("the lower one first"), "{error}");
        }
        for text in ["-1,2.5", "2%,auto", "auto,98%"] {
            assert_eq!(text.parse::<ColorEnds>().unwrap().to_string(), text);
        }
    }
}
