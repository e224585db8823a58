//! Ticks: round numbers of a range, and their labels.

use super::{Range, Spacing};
use crate::elementary::{log10, power_of_ten};

/// A tick of a range.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Value, within the range.
    pub value: f64,
    /// Label: with a minus sign instead of a hyphen, and with a power of ten if the value is large or
    /// small.
    pub label: String,
}

/// Maximum number of ticks.
const MAX_TICKS: usize = 1000;

/// Returns at most `most` round numbers of a range (and at most a thousand), in ascending order and
/// evenly spaced.
///
/// In a linear range they are multiples of 1, 2 or 5 times a power of ten; in a logarithmic range of
/// several decades, powers of ten, perhaps times 1, 2 and 5. There are at least two if `most` is 5 or
/// more and the relative difference of the ends is more than 1e-9; for a range of one number, the
/// result is that number.
pub fn ticks(range: &Range, most: usize) -> Vec<Tick> {
    let most = most.clamp(1, MAX_TICKS);
    if range.low() == range.high() {
        return vec![Tick { value: range.low(), label: typeset(&format!("{}", range.low())) }];
    }
    let decades = match range.spacing() {
        Spacing::Linear => Vec::new(),
        Spacing::Logarithmic => logarithmic(range, most),
    };
    if decades.len() > 1 { labeled(&decades, range) } else { labeled(&linear(range, most), range) }
}

/// A round number: an integer times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Round {
    whole: f64,
    exponent: i32,
}

impl Round {
    fn value(self) -> f64 {
        // Divides by a power that is exact if its inverse is not.
        let power = power_of_ten(self.exponent.unsigned_abs().min(300));
        let rest = power_of_ten(self.exponent.unsigned_abs().saturating_sub(300));
        if self.exponent < 0 { self.whole / power / rest } else { self.whole * power * rest }
    }
}

/// Returns multiples of the least round step for which at most `most` are in the range.
fn linear(range: &Range, most: usize) -> Vec<Round> {
    // Slightly more than the range, so that round ends are in it despite rounding.
    let slack = 1e-9;
    let half = range.high() / 2.0 - range.low() / 2.0;
    // Differences below this are smaller than the rounding error.
    let finest = 1e-12 * range.low().abs().max(range.high().abs());
    let least = log10((half / most as f64).max(finest)).floor() as i32;
    let steps = (least..).flat_map(|exponent| [1, 2, 5].map(|whole| (f64::from(whole), exponent)));
    for (whole, exponent) in steps {
        let step = Round { whole, exponent }.value();
        let (first, last) = (range.low() / step - slack, range.high() / step + slack);
        if last.floor() - first.ceil() < most as f64 {
            let count = (last.floor() - first.ceil()) as usize + 1;
            let multiple = |i: usize| whole * (first.ceil() + i as f64);
            return (0..count).map(|i| Round { whole: multiple(i), exponent }).collect();
        }
    }
    Vec::new()
}

/// Returns powers of ten, with multiples or with gaps so that at most `most` are in the range; empty if
/// fewer than two.
fn logarithmic(range: &Range, most: usize) -> Vec<Round> {
    let slack = 1e-9;
    let (low, high) = (range.low() * (1.0 - slack), range.high() * (1.0 + slack));
    let (first, last) = (log10(low).floor() as i32, log10(high).ceil() as i32);
    let within = |wholes: &[u8], stride: i32| -> Vec<Round> {
        let exponents = (first..=last).filter(|exponent| exponent.rem_euclid(stride) == 0);
        exponents
            .flat_map(|exponent| wholes.iter().map(move |&w| Round { whole: w.into(), exponent }))
            .filter(|round| (low..=high).contains(&round.value()))
            .collect()
    };
    let dense = within(&[1, 2, 5], 1);
    if dense.len() <= most {
        return dense;
    }
    let mut powers = (1..=last - first + 1).map(|stride| within(&[1], stride));
    powers.find(|rounds| rounds.len() <= most).unwrap_or_default()
}

/// Labels numbers, all in one style.
fn labeled(rounds: &[Round], range: &Range) -> Vec<Tick> {
    let sizes = || rounds.iter().map(|round| round.value().abs()).filter(|&size| size > 0.0);
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    let plain = most < 1e5 && least >= 1e-4;
    let label = |round: &Round| if plain { decimal(*round) } else { scientific(*round) };
    let value = |round: &Round| round.value().clamp(range.low(), range.high());
    rounds.iter().map(|round| Tick { value: value(round), label: label(round) }).collect()
}

/// Formats a decimal number, such as `-0.25`.
fn decimal(round: Round) -> String {
    typeset(&format!("{:.*}", -round.exponent.min(0) as usize, round.value()))
}

/// Formats a power of ten such as `-2.5 x 10^4`, with as few digits as possible.
fn scientific(round: Round) -> String {
    if round.whole == 0.0 {
        return "0".to_owned();
    }
    let text = format!("{:e}", round.whole);
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent = round.exponent + exponent.parse::<i32>().unwrap_or(0);
    let power = format!("10{}", superscript(exponent));
    match digits {
        "1" => power,
        "-1" => format!("\u{2212}{power}"),
        _ => format!("{}\u{d7}{power}", typeset(digits)),
    }
}

/// Replaces the hyphen by a minus sign.
fn typeset(number: &str) -> String {
    number.replace('-', "\u{2212}")
}

fn superscript(exponent: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |digit: char| digit.to_digit(10).map_or('⁻', |digit| digits[digit as usize]);
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Spacing::{Linear, Logarithmic};
    use proptest::prelude::*;

    fn labels(low: f64, high: f64, spacing: Spacing, most: usize) -> String {
        let ticks = ticks(&Range::new(low, high, spacing).unwrap(), most);
        ticks.iter().map(|tick| tick.label.as_str()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn linear_ranges_have_round_numbers() {
        for (low, high, most, expected) in [
            (0.0, 1.0, 6, "0.0 0.2 0.4 0.6 0.8 1.0"),
            (0.0, 1.0, 5, "0.0 0.5 1.0"),
            (-1.3, 4.2, 7, "−1 0 1 2 3 4"),
            (0.1, 0.3, 5, "0.10 0.15 0.20 0.25 0.30"),
            (99.7, 100.2, 6, "99.7 99.8 99.9 100.0 100.1 100.2"),
            (0.0, 3e6, 4, "0 10⁶ 2×10⁶ 3×10⁶"),
            (-2.5e-7, 2.5e-7, 5, "−2×10⁻⁷ −10⁻⁷ 0 10⁻⁷ 2×10⁻⁷"),
            (1e-4, 5e-4, 6, "0.0001 0.0002 0.0003 0.0004 0.0005"),
            (3.5, 3.5, 5, "3.5"),
            (0.0, 100.0, 1, "0"),
        ] {
            assert_eq!(labels(low, high, Linear, most), expected, "{low} {high}");
        }
    }

    #[test]
    fn logarithmic_ranges_have_decades() {
        for (low, high, most, expected) in [
            (1e-2, 1e2, 6, "0.01 0.1 1 10 100"),
            (1.0, 1e6, 7, "10⁰ 10¹ 10² 10³ 10⁴ 10⁵ 10⁶"),
            (1e-9, 1e9, 7, "10⁻⁹ 10⁻⁶ 10⁻³ 10⁰ 10³ 10⁶ 10⁹"),
            (1.0, 30.0, 6, "1 2 5 10 20"),
            (1.5, 1.9, 6, "1.5 1.6 1.7 1.8 1.9"),
            (2e-6, 3e-5, 6, "2×10⁻⁶ 5×10⁻⁶ 10⁻⁵ 2×10⁻⁵"),
        ] {
            assert_eq!(labels(low, high, Logarithmic, most), expected, "{low} {high}");
        }
    }

    proptest! {
        #[test]
        fn ticks_rise_within_any_range(
            low in -1e3..1e3,
            size in -18.0..3.0,
            scale in -280..280,
            most in 1_usize..20,
        ) {
            let scale = 10_f64.powi(scale);
            let (low, high) = (low * scale, (low + 10_f64.powf(size)) * scale);
            let range = Range::new(low, high, Linear).unwrap();
            let ticks = ticks(&range, most);
            prop_assert!(ticks.len() <= most);
            // A step is at most 2.5 times the one before, which has too many.
            prop_assert!(ticks.len() > 1 || most < 5 || size < -6.0, "{:?}", ticks);
            prop_assert!(ticks.iter().all(|tick| (low..=high).contains(&tick.value)));
            prop_assert!(ticks.is_sorted_by(|a, b| a.value < b.value), "{:?}", ticks);
        }

        #[test]
        fn logarithmic_ticks_rise_too(
            low in -280.0..280.0,
            // Less than the largest number, which is 1.8e308.
            size in 0.001..28.0,
            most in 5_usize..12,
        ) {
            let (low, high) = (10_f64.powf(low), 10_f64.powf(low + size));
            let ticks = ticks(&Range::new(low, high, Logarithmic).unwrap(), most);
            prop_assert!((2..=most).contains(&ticks.len()), "{:?}", ticks);
            prop_assert!(ticks.is_sorted_by(|a, b| a.value < b.value), "{:?}", ticks);
        }
    }
}
