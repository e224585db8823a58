//! Numbers of copies of a periodic cell.

/// `NA,NB,NC`.
pub(super) fn copies(text: &str) -> Result<[u32; 3], String> {
    let counts: Option<Vec<u32>> = text.split(',').map(|count| count.trim().parse().ok()).collect();
    counts
        .and_then(|counts| <[u32; 3]>::try_from(counts).ok())
        .filter(|counts| !counts.contains(&0))
        .ok_or_else(|| "give three integers of at least 1, as in 2,2,1".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_counts_are_read_and_nothing_else() {
        assert_eq!(copies("2,3,1"), Ok([2, 3, 1]));
        assert_eq!(copies("2, 3, 1"), Ok([2, 3, 1]));
        for text in ["2,3", "2,3,1,1", "0,1,1", "-1,1,1", "1.5,1,1", "", "99999999999,1,1"] {
            assert!(copies(text).is_err(), "{text}");
        }
    }
}
