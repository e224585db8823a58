//! Limits, ticks and labels of an axis.

use crate::report::{Axis, Scale, Style};

/// An axis with its limits.
#[derive(Clone, Debug)]
pub(super) struct AxisScale {
    log: bool,
    whole: bool,
    limits: [f64; 2],
    percent: bool,
}

/// Maximum number of ticks of an axis.
const MAX_TICKS: f64 = 8.0;

impl AxisScale {
    /// Returns an axis that contains the values.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let log = axis.scale == Scale::Log;
        let shown = values.filter(|&x| x.is_finite() && (x > 0.0 || !log));
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let found = shown.fold(none, |[low, high], x| [low.min(x), high.max(x)]);
        let usual = if log { [1.0, 10.0] } else { [0.0, 1.0] };
        let data = if found[0] <= found[1] { found } else { usual };
        let limits = axis.range.unwrap_or_else(|| if log { round_log(data) } else { round(data) });
        Self { log, whole: axis.scale == Scale::Whole, limits, percent: axis.unit == "%" }
    }

    /// Returns the position of a number: 0 at the lower limit, 1 at the upper. Clamps numbers beyond.
    pub(super) fn fraction(&self, x: f64) -> f64 {
        let [low, high] = self.limits;
        let fraction = if self.log {
            (x / low).max(f64::MIN_POSITIVE).log10() / (high / low).log10()
        } else {
            (x - low) / (high - low)
        };
        fraction.clamp(0.0, 1.0)
    }

    /// Returns whether the scale has a position for a number.
    pub(super) fn contains(&self, x: f64) -> bool {
        x.is_finite() && (x > 0.0 || !self.log)
    }

    /// Returns the ticks and their labels.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let ticks = if self.log { self.log_ticks() } else { self.linear_ticks() };
        ticks.into_iter().map(|x| (x, self.label(x))).collect()
    }

    fn linear_ticks(&self) -> Vec<f64> {
        let [low, high] = self.limits;
        let step = if self.whole { step(high - low).max(1.0) } else { step(high - low) };
        let first = (low / step).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last).map(|i| i as f64 * step).collect()
    }

    fn log_ticks(&self) -> Vec<f64> {
        let [low, high] = self.limits.map(f64::log10);
        let parts: &[f64] = if high - low > 3.5 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let stride = ((high - low) / MAX_TICKS).ceil().max(1.0) as usize;
        let inside = |x: &f64| (self.limits[0] * 0.999..=self.limits[1] * 1.001).contains(x);
        let decades = (low.floor() as i32..=high.ceil() as i32).step_by(stride);
        let ticks = decades.flat_map(|d| parts.iter().map(move |part| part * 10_f64.powi(d)));
        ticks.filter(inside).collect()
    }

    fn label(&self, x: f64) -> String {
        // Removes rounding errors of multiplied steps.
        let x = format!("{x:.6e}").parse().unwrap_or(x);
        let unit = if self.percent { " %" } else { "" };
        let number = match x {
            _ if x == 0.0 || (1e-4..1e6).contains(&f64::abs(x)) => x.to_string(),
            _ => Style::Power(0).write(x),
        };
        number + unit
    }
}

/// Returns a step of 1, 2 or 5 times a power of ten that gives at most `MAX_TICKS` ticks in a range.
fn step(range: f64) -> f64 {
    let least = range / MAX_TICKS;
    let decade = 10_f64.powf(least.log10().floor());
    let parts = [1.0, 2.0, 5.0, 10.0].map(|part| part * decade);
    parts.into_iter().find(|&step| step >= least * (1.0 - 1e-9)).unwrap_or(least)
}

/// Rounds limits outward to steps; the lower limit is at most 0.
fn round([low, high]: [f64; 2]) -> [f64; 2] {
    let (low, high) = (low.min(0.0), if high > low.min(0.0) { high } else { low + 1.0 });
    let step = step(high - low);
    [(low / step).floor() * step, (high / step - 1e-9).ceil() * step]
}

/// Rounds limits outward to 1 and 3 times powers of ten; for a range up to 100 to 1, 2 and 5 times.
fn round_log([low, high]: [f64; 2]) -> [f64; 2] {
    let parts: &[f64] = if (high / low).log10() > 2.0 { &[1.0, 3.0] } else { &[1.0, 2.0, 5.0] };
    let around = |x: f64| {
        let decade = x.log10().floor() as i32;
        (decade - 1..=decade + 1).flat_map(|d| parts.iter().map(move |part| part * 10_f64.powi(d)))
    };
    // Leaves a margin to the data.
    let (low, high) = (low / 1.05, high * 1.05);
    let below = around(low).filter(|&x| x <= low).fold(low / 10.0, f64::max);
    let above = around(high).filter(|&x| x >= high).fold(high * 10.0, f64::min);
    [below, above]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        let scale = AxisScale::new(axis, values.iter().copied());
        scale.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let linear = Axis::linear("", "");
        assert_eq!(labels(&linear, &[0.9, 2.7]), ["0", "0.5", "1", "1.5", "2", "2.5", "3"]);
        assert_eq!(labels(&Axis::whole(""), &[1.0, 2.0]), ["0", "1", "2"]);
        assert_eq!(labels(&linear, &[]), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        let log = Axis::log("", "");
        assert_eq!(labels(&log, &[3.0, 40.0]), ["2", "5", "10", "20", "50"]);
        assert_eq!(labels(&log, &[1.1e-5, 0.5]), ["1e-5", "0.0001", "0.001", "0.01", "0.1", "1"]);
        let percent = Axis { range: Some([1e-4, 100.0]), ..Axis::log("", "%") };
        assert_eq!(labels(&percent, &[0.0])[1], "0.001 %");
    }

    #[test]
    fn positions_are_monotonic() {
        let axis = Axis { range: Some([1e-4, 100.0]), ..Axis::log("", "") };
        let scale = AxisScale::new(&axis, std::iter::empty());
        let places = [1e-9, 1e-4, 1e-2, 1.0, 100.0, 1e5].map(|x| scale.fraction(x));
        assert!(places.is_sorted() && (places[0], places[5]) == (0.0, 1.0));
        assert!((places[3] - places[2] - (places[4] - places[3])).abs() < 1e-12);
        assert!(!scale.contains(0.0) && !scale.contains(f64::NAN) && scale.contains(1e-300));
    }

    #[test]
    fn data_of_any_size_has_an_axis() {
        for axis in [Axis::linear("", ""), Axis::log("", "")] {
            for data in [&[1e-30, 1e30][..], &[5.0, 5.0], &[0.0], &[-3.0, -2.0], &[f64::NAN]] {
                let scale = AxisScale::new(&axis, data.iter().copied());
                let ticks = scale.ticks();
                assert!((1..=17).contains(&ticks.len()), "{axis:?} {data:?} {ticks:?}");
            }
        }
    }
}
