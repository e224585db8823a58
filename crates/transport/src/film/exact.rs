//! Exact sums: sums without rounding, which do not depend on the order or grouping of their terms.
//!
//! A sum is stored in levels of double precision. The rounding error of a level goes to the next, by
//! the exact error of an addition (Knuth, "The Art of Computer Programming", volume 2, 4.2.2), so that
//! the sum of all levels is exact (Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast
//! Robust Geometric Predicates", 1997). With radiance in single precision most pixels need one level,
//! and nearly all others two.

use serde::{Deserialize, Serialize};

/// The values of three channels.
type Triple = [f64; 3];

/// Maximum number of levels, which no sum reaches: 2^40 squares of single precision have no bit below
/// 2^-298 and none above 2^296, and each level is at least 13 bits below the one before.
pub(super) const LEVELS: usize = 48;

/// An array of sums of three channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExactSums {
    /// Levels with one triple per sum, at least one; the sum of all levels is the value.
    levels: Vec<Vec<Triple>>,
}

/// Returns no sums.
impl Default for ExactSums {
    fn default() -> Self {
        Self::new(0)
    }
}

impl ExactSums {
    /// Creates `count` sums of 0.
    pub fn new(count: usize) -> Self {
        Self { levels: vec![vec![[0.0; 3]; count]] }
    }

    /// Returns whether the levels, read from a file, are finite and of the same size.
    pub(super) fn is_valid(&self) -> bool {
        let levels = (1..=LEVELS).contains(&self.levels.len());
        let same = self.levels.iter().all(|level| level.len() == self.len());
        levels && same && self.levels.iter().flatten().flatten().all(|term| term.is_finite())
    }

    /// Returns the levels of all sums.
    pub fn levels(&self) -> &[Vec<Triple>] {
        &self.levels
    }

    /// Replaces the sums by this number of levels of zeros.
    pub(super) fn restore(&mut self, levels: usize) {
        self.levels = vec![vec![[0.0; 3]; self.len()]; levels];
    }

    /// Returns the levels, to be filled with finite numbers.
    pub(super) fn levels_mut(&mut self) -> &mut [Vec<Triple>] {
        &mut self.levels
    }

    /// Returns the number of sums.
    pub fn len(&self) -> usize {
        self.levels.first().map_or(0, Vec::len)
    }

    /// Returns whether there are no sums.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds to a sum a number for each channel: finite, and no larger than the square of one of single
    /// precision.
    pub fn add(&mut self, index: usize, terms: Triple) {
        let mut terms = terms;
        for level in 0..LEVELS {
            if level == self.levels.len() {
                self.levels.push(vec![[0.0; 3]; self.len()]);
            }
            for (sum, term) in self.levels[level][index].iter_mut().zip(&mut terms) {
                (*sum, *term) = two_sum(*sum, *term);
            }
            if terms == [0.0; 3] {
                return;
            }
        }
    }

    /// Adds other sums one by one. Returns false, and does nothing, if their number differs.
    pub fn merge(&mut self, other: &Self) -> bool {
        let compatible = self.len() == other.len();
        for level in other.levels.iter().filter(|_| compatible) {
            level.iter().enumerate().for_each(|(index, &terms)| self.add(index, terms));
        }
        compatible
    }

    /// Returns the sums, rounded to the nearest numbers of double precision.
    pub fn rounded(&self) -> impl ExactSizeIterator<Item = Triple> + '_ {
        (0..self.len()).map(|index| match &self.levels[..] {
            [only] => only[index],
            [a, b] => std::array::from_fn(|channel| a[index][channel] + b[index][channel]),
            levels => std::array::from_fn(|channel| {
                nearest(levels.iter().map(|level| level[index][channel]))
            }),
        })
    }
}

/// Returns a rounded sum and its rounding error; if there is no overflow, both are exact.
pub(super) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Returns the number nearest to a sum; of two equally near, the even one.
fn nearest(terms: impl Iterator<Item = f64>) -> f64 {
    // Nonoverlapping parts in ascending order.
    let mut parts: Vec<f64> = Vec::new();
    for mut term in terms {
        parts.retain_mut(|part| {
            (term, *part) = two_sum(term, *part);
            *part != 0.0
        });
        parts.push(term);
    }
    let mut sum = parts.pop().unwrap_or(0.0);
    while let Some(part) = parts.pop() {
        let error;
        (sum, error) = two_sum(sum, part);
        if error == 0.0 {
            continue;
        }
        // If the error is half of a last place, the remaining parts decide the rounding.
        if parts.last().is_some_and(|rest| rest.is_sign_negative() == error.is_sign_negative()) {
            let other = sum + 2.0 * error;
            return if other - sum == 2.0 * error { other } else { sum };
        }
        break;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn one(terms: &[f64]) -> ExactSums {
        let mut sums = ExactSums::new(1);
        for &term in terms {
            sums.add(0, [term, 0.0, -term]);
        }
        sums
    }

    fn value(sums: &ExactSums) -> f64 {
        let [a, zero, b] = sums.rounded().next().expect("one sum");
        assert!(zero == 0.0 && a == -b);
        a
    }

    #[test]
    fn rounding_errors_are_kept() {
        assert_eq!(value(&one(&[1e16, 1.0, -1e16])), 1.0);
        assert_eq!(value(&one(&[1e300, 1.0, 1e-300, -1e300, -1.0])), 1e-300);
        assert_eq!(value(&one(&[])), 0.0);
        assert_eq!(one(&[0.25, 0.5]).levels().len(), 1);
    }

    #[test]
    fn halves_are_rounded_by_the_parts_below() {
        let half = 2f64.powi(-53);
        assert_eq!(nearest([1.0, half].into_iter()), 1.0);
        assert_eq!(nearest([1.0, half, 1e-40].into_iter()), 1.0 + f64::EPSILON);
        assert_eq!(nearest([1.0 + f64::EPSILON, half, -1e-40].into_iter()), 1.0 + f64::EPSILON);
        assert_eq!(nearest([1.0 + f64::EPSILON, half].into_iter()), 1.0 + 2.0 * f64::EPSILON);
    }

    #[test]
    fn values_that_are_not_finite_end_the_loop() {
        let mut sums = one(&[1.0]);
        sums.add(0, [f64::NAN, f64::MAX, f64::INFINITY]);
        sums.add(0, [1.0, f64::MAX, 1.0]);
        assert!(sums.rounded().all(|sums| sums.iter().all(|sum| !sum.is_finite())));
    }

    /// Any magnitude of squares of single precision.
    fn term() -> impl Strategy<Value = f64> {
        (-1.0..1.0, -250..250_i32).prop_map(|(digits, exponent)| digits * 2f64.powi(exponent))
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        #[test]
        fn neither_order_nor_grouping_matters(
            terms in prop::collection::vec(term(), 1..40).prop_shuffle(),
            cut in 0..40_usize,
        ) {
            let whole = value(&one(&terms));
            let mut sorted = terms.clone();
            sorted.sort_by(f64::total_cmp);
            prop_assert_eq!(value(&one(&sorted)), whole);
            let (front, back) = sorted.split_at(cut.min(sorted.len()));
            let mut merged = one(back);
            prop_assert!(merged.merge(&one(front)));
            prop_assert_eq!(value(&merged), whole);
        }
    }
}
