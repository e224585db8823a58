//! What a render held in memory, in words.

use indicatif::BinaryBytes;

/// From so many spheres on all memory is said to be theirs.
const MANY: u64 = 100_000;

/// Bytes for each of so many spheres, whose columns and tree take `columns` in all, and what the
/// process held at most, if that is known.
pub(super) fn describe(spheres: u64, columns: usize, peak: Option<u64>) -> String {
    let each = |bytes: u64| bytes as f64 / spheres.max(1) as f64;
    let columns = each(columns as u64);
    let columns = format!("{columns:.1} bytes for each sphere and its part of the tree");
    match peak {
        Some(peak) if spheres >= MANY => {
            format!("{columns}; {:.1} at most, {} in all", each(peak), BinaryBytes(peak))
        }
        Some(peak) => format!("{columns}; {} at most in all", BinaryBytes(peak)),
        None => columns,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_beside_spheres_counts_where_they_are_many() {
        let columns = "26.8 bytes for each sphere and its part of the tree";
        assert_eq!(describe(10, 268, None), columns);
        assert_eq!(describe(10, 268, Some(1 << 20)), format!("{columns}; 1.00 MiB at most in all"));
        let many = describe(1 << 20, (1 << 20) * 268 / 10, Some(64 << 20));
        assert_eq!(many, format!("{columns}; 64.0 at most, 64.00 MiB in all"));
        assert!(describe(0, 0, None).starts_with("0.0 bytes"));
    }
}
