//! Formatting of numbers with significant digits.

/// Maximum number of digits; more could be artifacts of decimal conversion.
const MOST: i32 = 15;

/// Default number of digits.
const USUAL: i32 = 6;

/// Resolution relative to the range of values.
const STEP: f64 = 1e-5;

/// Minimum number of digits of a value that is small compared to the range of its column.
const LEAST: i32 = 4;

/// Formats a coordinate or a length in a scene of this size.
pub(super) fn length(value: f64, size: f64) -> String {
    rounded(value, digits(value, size))
}

/// Formats a value of a column whose values differ by at most `range`.
pub(super) fn value(value: f64, range: f64) -> String {
    rounded(value, digits(value, range).max(LEAST))
}

/// Returns the difference of the maximum and the minimum.
pub(super) fn range(values: &[f64]) -> f64 {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) =
        (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    if low < high { high - low } else { 0.0 }
}

/// Returns the number of digits of a value that resolves differences in a range.
fn digits(value: f64, range: f64) -> i32 {
    let step = range * STEP;
    if step > 0.0 && step.is_finite() { exponent(value) - exponent(step) + 1 } else { USUAL }
}

/// Returns the decimal exponent of the first digit.
fn exponent(value: f64) -> i32 {
    let scientific = format!("{value:e}");
    scientific.rsplit_once('e').and_then(|(_, request)| request.parse().ok()).unwrap_or(0)
}

/// Formats a value with a number of digits; integers with all digits.
fn rounded(value: f64, digits: i32) -> String {
    let whole = value.fract() == 0.0 && value.abs() < 1e15;
    if whole || !value.is_finite() {
        return value.to_string();
    }
    if digits < 1 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.*e}", digits.min(MOST) as usize - 1);
    let rounded: f64 = scientific.parse().unwrap_or(value);
    let plain = (1e-4..1e9).contains(&rounded.abs());
    if plain { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_the_digits_that_differ_in_the_scene() {
        for (number, size, expected) in [
            (0.1 + 0.2, 10.0, "0.3"),
            (f64::from(1.2_f32), 10.0, "1.2"),
            (12.345_678_9, 200.0, "12.346"),
            (1e6 + 0.123_456_789, 1.0, "1000000.12346"),
            (-3.0, 1e-3, "-3"),
            (6.1e-17, 3.0, "0"),
            (1.234_567_89e-9, 2e-9, "1.23457e-9"),
            (1.234_567_891e12 + 0.5, 2e12, "1.23457e12"),
            (123_456_789_012.0, 1e12, "123456789012"),
            (0.1, 0.0, "0.1"),
            (1.0 / 3.0, f64::INFINITY, "0.333333"),
        ] {
            assert_eq!(length(number, size), expected, "{number} in {size}");
        }
    }

    #[test]
    fn small_values_keep_significant_digits() {
        assert_eq!(value(1.234_567e-8, 1e3), "1.235e-8");
        assert_eq!(value(-0.834_000_000_000_000_1, 2.0), "-0.834");
        assert_eq!(value(f64::NAN, 1.0), "NaN");
        assert_eq!(range(&[f64::NAN, 3.0, -1.5, f64::INFINITY]), 4.5);
        assert_eq!((range(&[]), range(&[2.0])), (0.0, 0.0));
    }
}
