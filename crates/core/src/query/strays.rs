//! Spheres that are so far out or so large that the others are a point beside them.
//!
//! Single precision cannot tell the others apart in units in which the largest coordinate is about 1. So a few such
//! spheres are left out of the tree, and each ray is tested against them one by one.

/// The most strays: each is tested against every ray.
const MOST: usize = 16;

/// How many times as large the coordinates of strays are.
const TIMES: f64 = (1 << 20) as f64;

/// Returns the largest extent of a sphere that is no stray: `extents` are those of spheres from the middle of the
/// coordinates, all positive.
pub(super) fn largest_of_most(extents: impl Iterator<Item = f64>) -> f64 {
    // The largest, in descending order.
    let mut largest = [0.0; MOST + 1];
    for extent in extents {
        if extent > largest[MOST] {
            let place = largest.partition_point(|&other| other >= extent);
            largest[place..].rotate_right(1);
            largest[place] = extent;
        }
    }
    let gap = |&i: &usize| largest[i] > 0.0 && largest[i - 1] > TIMES * largest[i];
    (1..=MOST).rev().find(gap).map_or(largest[0], |i| largest[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_spheres_beyond_a_gap_are_strays() {
        let most = |strays: &[f64], others: usize| {
            let others = (0..others).map(|i| 1.0 / (1 + i) as f64);
            largest_of_most(others.chain(strays.iter().copied()))
        };
        assert_eq!(most(&[], 100), 1.0);
        assert_eq!(most(&[1e6], 100), 1e6);
        assert_eq!(most(&[1e7], 100), 1.0);
        assert_eq!(most(&[1e7, 1e20, 1e13], 100), 1.0);
        assert_eq!(most(&[1e30; 16], 100), 1.0);
        assert_eq!(most(&[1e30; 17], 100), 1e30);
        assert_eq!(most(&[1e30, 1e20], 0), 1e20);
        assert_eq!(most(&[1e30], 0), 1e30);
        assert_eq!(largest_of_most(std::iter::empty()), 0.0);
    }
}
