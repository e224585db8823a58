//! Percentiles of numbers.

/// Returns the percentile of some finite numbers, with linear interpolation between neighbors in order, as NumPy has it; `None`
/// of no numbers. `percent` is 0 to 100. Changes the order of the numbers.
pub fn percentile(values: &mut [f64], percent: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let place = (percent / 100.0 * last as f64).clamp(0.0, last as f64);
    let row = place as usize;
    let (_, &mut low, above) = values.select_nth_unstable_by(row, f64::total_cmp);
    let high = above.iter().copied().min_by(f64::total_cmp).unwrap_or(low);
    let share = place - row as f64;
    // Numbers that are equal stay what they are, and no difference overflows.
    Some(if low == high { low } else { low * (1.0 - share) + high * share })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_whole_numbers_are_known() {
        // Not in order.
        let mut values: Vec<f64> = (0..100).map(|row| f64::from(row * 37 % 100 + 1)).collect();
        for percent in [0.0, 2.0, 25.0, 50.0, 62.5, 98.0, 99.5, 100.0] {
            let found = percentile(&mut values, percent).unwrap();
            assert!((found - (1.0 + 0.99 * percent)).abs() < 1e-12, "{percent}: {found}");
        }
        assert_eq!(percentile(&mut values, 0.0), Some(1.0));
        assert_eq!(percentile(&mut values, 100.0), Some(100.0));
    }

    #[test]
    fn few_and_extreme_numbers_have_percentiles() {
        assert_eq!(percentile(&mut [], 50.0), None);
        assert_eq!(percentile(&mut [7.5], 98.0), Some(7.5));
        assert_eq!(percentile(&mut [f64::MAX, f64::MIN], 50.0), Some(0.0));
        assert_eq!(percentile(&mut [0.1, 0.1, 0.1], 33.3), Some(0.1));
        assert_eq!(percentile(&mut [3.0, 1.0], 25.0), Some(1.5));
    }
}
