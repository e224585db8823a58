//! Summaries of colored columns, from which the frames of a sequence get one range and one color for each value.

use super::ColumnColors;
use super::labels;
use crate::color::{Range, RangeError, Rgb, Spacing, category, percentile};
use std::collections::BTreeSet;

/// Maximum number of values of a sequence that percentiles are computed from. Of more values, it is a random sample, whose
/// percentiles have a standard error of at most 0.025 percent.
const SAMPLE: usize = 1 << 22;

/// The values of a colored column in one frame, or in several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnSummary {
    /// The least and the greatest finite value that has a color.
    pub(super) extremes: Option<[f64; 2]>,
    /// True if there are values of 0 or less on a logarithmic scale.
    undefined: bool,
    /// Values for percentiles, if those are asked for.
    sample: Vec<f64>,
    /// Number of values of which `sample` is one.
    sampled: u64,
    /// The integers that have colors of their own; `None` if a color map is for them.
    labels: Option<BTreeSet<i64>>,
}

/// The meaning of colors in all frames of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedColors {
    /// The range of numbers.
    pub(super) range: Range,
    /// True for an end beyond which there are values.
    pub(super) beyond: [bool; 2],
    /// The integers that have colors of their own, in order; `None` if a color map is for them.
    pub(super) labels: Option<Vec<i64>>,
}

impl ColumnSummary {
    /// Summarizes the numbers of a column.
    pub(super) fn of(colors: &ColumnColors, values: &[f64]) -> Self {
        let range = Range::of(values, colors.spacing).ok();
        let is_logarithmic = colors.spacing == Spacing::Logarithmic;
        let least = if is_logarithmic { 0.0 } else { f64::NEG_INFINITY };
        let mut sample = Vec::new();
        if colors.ends.needs_percentiles() {
            sample.extend(values.iter().filter(|value| value.is_finite() && **value > least));
        }
        Self {
            extremes: range.map(|range| [range.low(), range.high()]),
            undefined: is_logarithmic && values.iter().any(|value| *value <= 0.0),
            sampled: sample.len() as u64,
            sample,
            labels: labels::of(colors, values),
        }
    }

    /// Adds the values of another frame.
    pub fn add(&mut self, other: &Self) {
        let Some([low, high]) = other.extremes else { return };
        let is_first = self.extremes.is_none();
        let [least, greatest] = self.extremes.unwrap_or([low, high]);
        self.extremes = Some([least.min(low), greatest.max(high)]);
        self.undefined |= other.undefined;
        for value in &other.sample {
            self.take(*value, SAMPLE);
        }
        self.labels = match (self.labels.take(), &other.labels) {
            (_, Some(labels)) if is_first => Some(labels.clone()),
            (Some(own), Some(labels)) => Some(own.union(labels).copied().collect()),
            _ => None,
        };
    }

    /// Takes a value into the sample of at most this many, in which all values have the same chance to be: Vitter, "Random
    /// Sampling with a Reservoir", 1985, algorithm R.
    fn take(&mut self, value: f64, most: usize) {
        self.sampled += 1;
        if self.sample.len() < most {
            self.sample.push(value);
            return;
        }
        let place = (u128::from(mixed(self.sampled)) * u128::from(self.sampled)) >> 64;
        if let Some(other) = self.sample.get_mut(place as usize) {
            *other = value;
        }
    }

    /// Returns a percentile of the values.
    pub(super) fn percentile(&self, percent: f64) -> Option<f64> {
        percentile(&mut self.sample.clone(), percent)
    }

    /// Returns the integer that a color stands for, by the name and the color of its category in this frame.
    pub fn label(&self, name: &str, color: Rgb) -> Option<i64> {
        let value = name.parse().ok()?;
        let labels = self.labels.as_ref()?;
        let row = labels.iter().position(|own| *own == value)?;
        (category(row) == color).then_some(value)
    }

    /// Returns the meaning of the colors for all frames that were added.
    ///
    /// # Errors
    /// The values have no range.
    pub fn share(&self, colors: &ColumnColors) -> Result<SharedColors, RangeError> {
        let range = colors.ends.range(self, colors.spacing)?;
        let [low, high] = self.extremes.unwrap_or([range.low(), range.high()]);
        // Values without a logarithm would have the color of those below.
        let beyond = [low < range.low() && !self.undefined, high > range.high()];
        let labels: Option<Vec<i64>> =
            self.labels.as_ref().map(|labels| labels.iter().copied().collect());
        let labels = labels.filter(|labels| labels::suit(colors, labels));
        Ok(SharedColors { range, beyond, labels })
    }
}

impl SharedColors {
    /// Returns the color of an integer, if integers have colors of their own.
    pub fn color_of(&self, label: i64) -> Option<Rgb> {
        let row = self.labels.as_ref()?.binary_search(&label).ok()?;
        Some(category(row))
    }
}

/// Returns bits that depend on all bits of a number: the finalizer of `SplitMix64`.
fn mixed(number: u64) -> u64 {
    let number = number.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let number = (number ^ number >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let number = (number ^ number >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    number ^ number >> 31
}

#[cfg(test)]
mod tests {
    use super::super::{ColorEnds, NumberColors};
    use super::*;

    fn by(column: &str, ends: &str) -> ColumnColors {
        let ends = ends.parse::<ColorEnds>().expect("ends");
        ColumnColors { column: column.to_owned(), ends, ..ColumnColors::default() }
    }

    /// The summary of frames.
    fn summary(colors: &ColumnColors, frames: &[&[f64]]) -> ColumnSummary {
        let mut all = ColumnSummary::default();
        for values in frames {
            all.add(&ColumnSummary::of(colors, values));
        }
        all
    }

    #[test]
    fn percentiles_are_those_of_all_frames() {
        let numbers: Vec<f64> = (1..=100).map(f64::from).collect();
        for (ends, [low, high], beyond) in [
            ("2%,98%", [2.98, 98.02], [true, true]),
            ("0,98%", [0.0, 98.02], [false, true]),
            ("25%,auto", [25.75, 100.0], [true, false]),
            ("auto,200", [1.0, 200.0], [false, false]),
            ("auto", [1.0, 100.0], [false, false]),
            ("10,20", [10.0, 20.0], [true, true]),
        ] {
            let colors = by("q", ends);
            let infinite = [f64::NAN, f64::INFINITY];
            for frames in [&[&numbers[..]][..], &[&numbers[60..], &infinite, &[], &numbers[..60]]] {
                let shared = summary(&colors, frames).share(&colors).expect("a range");
                let found = [shared.range.low(), shared.range.high()];
                let close = found.iter().zip([low, high]).all(|(a, b)| (a - b).abs() < 1e-12);
                assert!(close, "{ends}: {found:?}");
                assert_eq!((shared.beyond, shared.labels), (beyond, None), "{ends}");
            }
        }
        let crossed = by("q", "0,2%");
        let error = summary(&crossed, &[&[-2.0, -1.0]]).share(&crossed);
        assert!(matches!(error, Err(RangeError::Ends { .. })), "{error:?}");
    }

    #[test]
    fn logarithmic_ranges_are_of_positive_values() {
        let colors = ColumnColors { spacing: Spacing::Logarithmic, ..by("q", "50%,auto") };
        let shared =
            summary(&colors, &[&[-1.0, 0.0, 1.0, 2.0, 9.0]]).share(&colors).expect("a range");
        assert_eq!([shared.range.low(), shared.range.high()], [2.0, 9.0]);
        // Values without a logarithm stay gray.
        assert_eq!(shared.beyond, [false, false]);
        let shared = summary(&colors, &[&[1.0, 2.0, 9.0]]).share(&colors).expect("a range");
        assert_eq!(shared.beyond, [true, false]);
    }

    #[test]
    fn samples_of_many_values_have_nearly_their_percentiles() {
        const MOST: usize = 1 << 14;
        let mut all = ColumnSummary::default();
        (0..10 * MOST).for_each(|row| all.take(row as f64 / (10 * MOST) as f64, MOST));
        assert_eq!((all.sample.len(), all.sampled), (MOST, 10 * MOST as u64));
        for percent in [2.0, 50.0, 98.0] {
            // Four standard errors.
            let share: f64 = percent / 100.0;
            let most = 4.0 * (share * (1.0 - share) / MOST as f64).sqrt();
            let found = all.percentile(percent).expect("a percentile");
            assert!((found - share).abs() < most, "{percent}: {found}");
        }
    }

    #[test]
    fn integers_have_one_color_in_all_frames() {
        let colors = by("mol", "auto");
        let all = summary(&colors, &[&[7.0, 3.0], &[], &[9.0, 3.0]]);
        let shared = all.share(&colors).expect("labels");
        assert_eq!(shared.labels, Some(vec![3, 7, 9]));
        assert_eq!(shared.color_of(7), Some(category(1)));
        assert_eq!(shared.color_of(8), None);
        let first = ColumnSummary::of(&colors, &[7.0, 9.0]);
        assert_eq!(first.label("9", category(1)), Some(9));
        assert_eq!([first.label("9", Rgb::X), first.label("x", category(1))], [None; 2]);
        // Too many, or one that is no integer, in any frame.
        let many: Vec<f64> = (0..8).map(f64::from).collect();
        let more: Vec<f64> = (8..16).map(f64::from).collect();
        for frames in [[&many[..], &more], [&many, &[0.5]], [&[0.5], &many]] {
            assert_eq!(summary(&colors, &frames).share(&colors).expect("a range").labels, None);
        }
        let chosen = ColumnColors { numbers: NumberColors::Categories, ..by("q", "auto") };
        let shared = summary(&chosen, &[&many, &more]).share(&chosen).expect("labels");
        assert_eq!(shared.labels.map(|labels| labels.len()), Some(16));
    }
}
