//! Ascending numbers in messages, as in `3, 17-20`.

/// Formats ascending numbers, some perhaps equal, as at most this many ranges.
pub(super) fn ranges(numbers: &[u64], most: usize) -> String {
    let text = |range: &[u64]| match range {
        [first, .., last] if first != last => format!("{first}-{last}"),
        _ => range.first().map_or_else(String::new, u64::to_string),
    };
    let all = numbers.chunk_by(|a, b| a + 1 >= *b);
    let more = if all.clone().count() > most { ", ..." } else { "" };
    all.take(most).map(text).collect::<Vec<_>>().join(", ") + more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_numbers_are_ranges() {
        assert_eq!(ranges(&[3, 5, 6, 7, 9], 8), "3, 5-7, 9");
        assert_eq!(ranges(&[4, 4], 8), "4");
        let odd: Vec<u64> = (0..20).map(|i| 2 * i).collect();
        assert_eq!(ranges(&odd, 8), "0, 2, 4, 6, 8, 10, 12, 14, ...");
    }
}
