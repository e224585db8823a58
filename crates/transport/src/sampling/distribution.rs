//! Discrete distributions: choice by weight.
//!
//! The choice inverts the cumulative distribution, which increases with the index: strata of the draw
//! become strata of the choice, and the remainder of the draw is as well stratified within it. An alias
//! table would be as fast but separates neighbors, which turns low-discrepancy points into random ones.
//! With a guide table (Chen & Asau, "On Generating Random Variates from an Empirical Distribution",
//! AIIE Transactions 1974) nearly every draw takes one or two steps.

use super::hash::ONE_BELOW;

/// Draws are multiples of 2^-24, and so is every probability: choice and probability agree exactly.
const RESOLUTION: f64 = 16_777_216.0;

/// A discrete distribution over `0..count()`.
#[derive(Clone, Debug)]
pub struct Distribution {
    /// `count() + 1` multiples of 2^-24 from 0 to 1, not decreasing.
    cumulative: Box<[f32]>,
    /// One entry per slot and one more: the index that the slot's lower end chooses. The number of
    /// slots is a power of two, so that the slot of a draw is exact.
    guide: Box<[u32]>,
}

/// The result of a draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Less than the distribution's `count()`; its weight is more than 0.
    pub index: usize,
    /// Probability of this index, more than 0.
    pub pmf: f32,
    /// Position of the draw within the index's interval, in [0, 1): a draw for further decisions.
    pub remainder: f32,
}

impl Distribution {
    /// Creates a distribution with probabilities proportional to weights. A weight that is not finite
    /// and more than 0 counts as 0 and is never chosen; `None` if this is so for all.
    ///
    /// Probabilities are rounded to multiples of 2^-24, but no positive weight is rounded to 0 if there
    /// are at most 2^23 weights.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let positive = |weight: f64| if weight.is_finite() { weight.max(0.0) } else { 0.0 };
        let largest = weights.iter().copied().map(positive).fold(0.0, f64::max);
        if largest == 0.0 {
            return None;
        }
        // Scaled, so that no sum overflows; weights that underflow here count as 0.
        let scaled = || weights.iter().map(|&weight| positive(weight) / largest);
        let total: f64 = scaled().sum();
        let count = scaled().filter(|&weight| weight > 0.0).count() as f64;
        let reserved = if count > RESOLUTION / 2.0 { 0.0 } else { 1.0 };
        let shared = RESOLUTION - reserved * count;

        let (mut sum, mut rank) = (0.0, 0.0);
        let cumulative = std::iter::once(0.0)
            .chain(scaled().map(|weight| {
                sum += weight;
                rank += if weight > 0.0 { reserved } else { 0.0 };
                ((rank + (sum / total * shared).round()) / RESOLUTION) as f32
            }))
            .collect();
        Some(Self::from_cumulative(cumulative))
    }

    /// Creates equal probabilities for `count` indices; `None` if `count` is 0.
    pub fn uniform(count: usize) -> Option<Self> {
        Self::new(&vec![1.0; count])
    }

    fn from_cumulative(cumulative: Box<[f32]>) -> Self {
        let count = cumulative.len() - 1;
        let slots = count.next_power_of_two();
        let mut index = 0;
        let guide = (0..=slots)
            .map(|slot| {
                let end = (slot as f32 / slots as f32).min(ONE_BELOW);
                while cumulative[index + 1] <= end {
                    index += 1;
                }
                index as u32
            })
            .collect();
        Self { cumulative, guide }
    }

    /// Number of indices, 1 or more.
    pub fn count(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// Cumulative probabilities, from 0 to 1: one more than indices.
    pub(crate) fn cumulative(&self) -> &[f32] {
        &self.cumulative
    }

    /// Chooses an index by a draw in [0, 1); the index does not decrease as the draw increases.
    #[inline]
    pub fn sample(&self, u: f32) -> Choice {
        let u = u.min(ONE_BELOW);
        let index = self.find(u);
        let (start, pmf) = self.interval(index);
        Choice { index, pmf, remainder: ((u - start) / pmf).min(ONE_BELOW) }
    }

    /// Returns the index that a draw below 1 chooses.
    #[inline]
    pub fn find(&self, u: f32) -> usize {
        let slots = self.guide.len() - 1;
        let slot = (u * slots as f32) as usize;
        let (low, high) = (self.guide[slot] as usize, self.guide[slot + 1] as usize);
        let between = &self.cumulative[low + 1..=high];
        low + between.partition_point(|&end| end <= u)
    }

    /// Returns the first draw that chooses an index, and the probability of the index.
    #[inline]
    pub(super) fn interval(&self, index: usize) -> (f32, f32) {
        (self.cumulative[index], self.pmf(index))
    }

    /// Returns the probability of an index below [`Distribution::count`].
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.cumulative[index + 1] - self.cumulative[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::{assert_chi_squared, random_pairs};
    use proptest::prelude::*;

    #[test]
    fn draws_follow_the_weights() {
        let weights: Vec<f64> = (0..100).map(|i| f64::from(i % 7) * f64::from(i)).collect();
        let total: f64 = weights.iter().sum();
        let distribution = Distribution::new(&weights).expect("there are positive weights");
        let mut observed = vec![0_u64; weights.len()];
        for [u, _] in random_pairs(1_000_000, 6) {
            observed[distribution.sample(u).index] += 1;
        }
        let probabilities: Vec<f64> = weights.iter().map(|weight| weight / total).collect();
        assert_chi_squared(&observed, &probabilities);
    }

    #[test]
    fn nothing_to_choose_from() {
        let hopeless: [&[f64]; 4] =
            [&[], &[0.0, -0.0], &[-1.0, f64::NAN], &[f64::INFINITY, f64::NEG_INFINITY]];
        for weights in hopeless {
            assert!(Distribution::new(weights).is_none(), "{weights:?}");
        }
        assert!(Distribution::uniform(0).is_none());
    }

    #[test]
    fn small_weights_keep_a_positive_probability() {
        let weights = [1e-30, 1.0, 0.0, 1e-30, f64::NAN];
        let distribution = Distribution::new(&weights).expect("there are positive weights");
        let step = f32::EPSILON / 2.0;
        let probabilities: Vec<f32> = (0..5).map(|i| distribution.pmf(i)).collect();
        assert_eq!(probabilities, [step, 1.0 - 2.0 * step, 0.0, step, 0.0]);
        assert_eq!(distribution.sample(0.0).index, 0);
        assert_eq!(distribution.sample(ONE_BELOW).index, 3);
    }

    #[test]
    fn huge_weights_do_not_overflow() {
        let distribution = Distribution::new(&[f64::MAX; 4]).expect("the weights are positive");
        assert!((0..4).all(|index| distribution.pmf(index) == 0.25));
    }

    #[test]
    fn a_single_entry_returns_the_random_number_unchanged() {
        let distribution = Distribution::uniform(1).expect("there is one");
        for u in [0.0, 0.25, ONE_BELOW] {
            assert_eq!(distribution.sample(u), Choice { index: 0, pmf: 1.0, remainder: u });
        }
    }

    #[test]
    fn strata_are_kept() {
        let distribution = Distribution::uniform(8).expect("there are eight");
        for i in 0..64 {
            let Choice { index, pmf, remainder } = distribution.sample((i as f32 + 0.5) / 64.0);
            assert_eq!(((index as f32 + remainder) * 8.0) as usize, i);
            assert_eq!(pmf, 0.125);
        }
    }

    proptest! {
        #[test]
        fn sample_and_pmf_agree(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-9..1e9_f64, 0.1..1.0], 1..70),
            bits in prop::collection::vec(0_u32..1 << 24, 50),
        ) {
            let Some(distribution) = Distribution::new(&weights) else {
                prop_assert!(weights.iter().all(|&weight| weight == 0.0));
                return Ok(());
            };
            let sum: f64 = (0..weights.len()).map(|i| f64::from(distribution.pmf(i))).sum();
            prop_assert_eq!(sum, 1.0);
            for u in bits.into_iter().map(|bits| bits as f32 / (1 << 24) as f32) {
                let Choice { index, pmf, remainder } = distribution.sample(u);
                prop_assert!(weights[index] > 0.0 && pmf == distribution.pmf(index));
                prop_assert!((0.0..1.0).contains(&remainder));
                let start: f64 = (0..index).map(|i| f64::from(distribution.pmf(i))).sum();
                let recovered = start + f64::from(pmf) * f64::from(remainder);
                prop_assert!((recovered - f64::from(u)).abs() < 1e-7);
            }
        }

        #[test]
        fn probabilities_are_proportional(weights in prop::collection::vec(0.0..1.0_f64, 1..70)) {
            if let Some(distribution) = Distribution::new(&weights) {
                let total: f64 = weights.iter().sum();
                for (index, weight) in weights.iter().enumerate() {
                    let error = f64::from(distribution.pmf(index)) - weight / total;
                    prop_assert!(error.abs() < 80.0 / RESOLUTION);
                }
            }
        }
    }
}
