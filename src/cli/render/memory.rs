//! Text for the memory of a render.

use indicatif::BinaryBytes;

/// Number of spheres from which all memory is attributed to them.
const MANY: u64 = 100_000;

/// Formats the bytes per sphere, whose columns and tree take `columns` bytes in total, and the peak memory of
/// the process, if known.
pub(super) fn describe(spheres: u64, columns: usize, peak: Option<u64>) -> String {
    let each = |bytes: u64| bytes as f64 / spheres.max(1) as f64;
    let columns = each(columns as u64);
    let columns = format!("{columns:.1} bytes per sphere, including the tree");
    match peak {
        Some(peak) if spheres >= MANY => {
            format!("{columns}; peak {:.1} per sphere, {} in total", each(peak), BinaryBytes(peak))
        }
        Some(peak) => format!("{columns}; peak {} in total", BinaryBytes(peak)),
        None => columns,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_per_sphere_is_shown_for_many_spheres() {
        let columns = "26.8 bytes per sphere, including the tree";
        assert_eq!(describe(10, 268, None), columns);
        assert_eq!(describe(10, 268, Some(1 << 20)), format!("{columns}; peak 1.00 MiB in total"));
        let many = describe(1 << 20, (1 << 20) * 268 / 10, Some(64 << 20));
        assert_eq!(many, format!("{columns}; peak 64.0 per sphere, 64.00 MiB in total"));
        assert!(describe(0, 0, None).starts_with("0.0 bytes"));
    }
}
