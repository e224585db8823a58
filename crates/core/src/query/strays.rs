//! Spheres that are so far out or so large that the others are a point beside them.
//!
//! Single precision cannot tell the others apart in units in which the largest coordinate is about 1. So a few such
//! spheres are left out of the tree, and each ray is tested against them one by one.

/// The most strays: each is tested against every ray.
const MOST: usize = 16;

/// How many times as large the coordinates of strays are.
const TIMES: f64 = (1 << 20) as f64;

/// The largest extents of spheres, from the middle of the coordinates: in descending order, all positive, and 0 where
/// there are no more spheres.
#[derive(Clone, Copy)]
pub(super) struct Largest([f64; MOST + 1]);

impl Largest {
    pub(super) const NONE: Self = Self([0.0; MOST + 1]);

    /// Adds the extent of a sphere.
    #[inline(always)]
    pub(super) fn add(&mut self, extent: f64) {
        if extent > self.0[MOST] {
            let place = self.0.partition_point(|&other| other >= extent);
            self.0[place..].rotate_right(1);
            self.0[place] = extent;
        }
    }

    /// Returns the largest of both.
    pub(super) fn union(mut self, other: &Self) -> Self {
        other.0.iter().for_each(|&extent| self.add(extent));
        self
    }

    /// The largest of all.
    pub(super) fn of_all(&self) -> f64 {
        self.0[0]
    }

    /// The largest of those that are no strays.
    pub(super) fn of_most(&self) -> f64 {
        let gap = |&i: &usize| self.0[i] > 0.0 && self.0[i - 1] > TIMES * self.0[i];
        (1..=MOST).rev().find(gap).map_or(self.0[0], |i| self.0[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_spheres_beyond_a_gap_are_strays() {
        let largest = |extents: &mut dyn Iterator<Item = f64>| {
            let mut largest = Largest::NONE;
            extents.for_each(|extent| largest.add(extent));
            largest
        };
        let most = |strays: &[f64], others: usize| {
            let others = largest(&mut (0..others).map(|i| 1.0 / (1 + i) as f64));
            let strays = largest(&mut strays.iter().copied());
            assert_eq!(others.union(&strays).0, strays.union(&others).0);
            others.union(&strays).of_most()
        };
        assert_eq!(most(&[], 100), 1.0);
        assert_eq!(most(&[1e6], 100), 1e6);
        assert_eq!(most(&[1e7], 100), 1.0);
        assert_eq!(most(&[1e7, 1e20, 1e13], 100), 1.0);
        assert_eq!(most(&[1e30; 16], 100), 1.0);
        assert_eq!(most(&[1e30; 17], 100), 1e30);
        assert_eq!(most(&[1e30, 1e20], 0), 1e20);
        assert_eq!(most(&[1e30], 0), 1e30);
        assert_eq!(most(&[], 0), 0.0);
    }
}
