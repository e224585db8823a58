//! Interval arithmetic: each operation rounds outward, so an interval always contains the true number.
//!
//! The residual of a sum (Knuth's two-sum) or a product (a fused multiply-add) tells on which side of
//! the rounded result the true one lies. So bounds move only where something was rounded, and exact
//! results remain points: Knuth, "The Art of Computer Programming" 2, section 4.2.2; Moore, "Interval
//! Analysis", 1966. Residuals are exact without overflow and underflow, which products of four
//! single-precision numbers avoid.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// The numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Interval {
    pub(super) fn point(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// Returns the sign of all numbers in the interval; `None` if they differ.
    pub(super) fn sign(self) -> Option<Ordering> {
        let (low, high) = (self.low.partial_cmp(&0.0)?, self.high.partial_cmp(&0.0)?);
        (low == high).then_some(low)
    }

    pub(super) fn square(self) -> Self {
        let bounds = [self.low.abs(), self.high.abs()];
        let [least, most] = if bounds[0] < bounds[1] { bounds } else { [bounds[1], bounds[0]] };
        let least = if self.low <= 0.0 && self.high >= 0.0 { 0.0 } else { least };
        Self { low: product(least, least).low, high: product(most, most).high }
    }

    /// Returns the square roots of the nonnegative numbers.
    pub(super) fn sqrt(self) -> Self {
        let root = |x: f64| x.max(0.0).sqrt();
        Self { low: root(self.low).next_down().max(0.0), high: root(self.high).next_up() }
    }

    /// Divides by a positive interval; returns all numbers if the divisor may be 0.
    pub(super) fn divide(self, positive: Self) -> Self {
        if positive.low <= 0.0 {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let low = self.low / if self.low < 0.0 { positive.low } else { positive.high };
        let high = self.high / if self.high < 0.0 { positive.high } else { positive.low };
        Self { low: low.next_down(), high: high.next_up() }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { low: sum(self.low, other.low).low, high: sum(self.high, other.high).high }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let corners = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        corners.into_iter().reduce(Self::hull).unwrap_or(corners[0])
    }
}

impl Interval {
    fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

fn sum(a: f64, b: f64) -> Interval {
    let rounded = a + b;
    let part = rounded - a;
    around(rounded, (a - (rounded - part)) + (b - part))
}

fn product(a: f64, b: f64) -> Interval {
    let rounded = a * b;
    around(rounded, a.mul_add(b, -rounded))
}

/// Returns an interval that contains `rounded + residual`; only the sign of the residual matters.
fn around(rounded: f64, residual: f64) -> Interval {
    Interval {
        low: if residual < 0.0 { rounded.next_down() } else { rounded },
        high: if residual > 0.0 { rounded.next_up() } else { rounded },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    /// Returns a number of at most 53 bits in units of 2^-100.
    fn whole(x: f64) -> BigInt {
        let scaled = x * 100_f64.exp2();
        let bits = scaled.abs().to_bits();
        let (exponent, fraction) = ((bits >> 52) as i64 - 1075, bits & ((1 << 52) - 1) | 1 << 52);
        let magnitude = if scaled == 0.0 {
            BigInt::ZERO
        } else if exponent >= 0 {
            BigInt::from(fraction) << exponent
        } else {
            BigInt::from(fraction) >> -exponent
        };
        if x < 0.0 { -magnitude } else { magnitude }
    }

    #[test]
    fn exact_results_remain_points() {
        let (three, half) = (Interval::point(3.0), Interval::point(0.5));
        assert_eq!(three * half, Interval::point(1.5));
        assert_eq!(three - three, Interval::point(0.0));
        assert_eq!((three - three).sign(), Some(Ordering::Equal));
        assert_eq!((-half).square(), Interval::point(0.25));
    }

    #[test]
    fn rounded_results_lie_between_neighbors() {
        let (one, tiny) = (Interval::point(1.0), Interval::point(1e-30));
        let sum = one + tiny;
        assert_eq!((sum.low, sum.high), (1.0, 1.0_f64.next_up()));
        assert_eq!((sum - one).sign(), None);
        let third = one.divide(Interval::point(3.0));
        assert!(third.low < 1.0 / 3.0 && third.high > 1.0 / 3.0);
        let both = Interval { low: -1.0, high: 2.0 };
        assert_eq!(both.square(), Interval { low: 0.0, high: 4.0 });
        assert_eq!(both * both, Interval { low: -2.0, high: 4.0 });
        assert_eq!(one.divide(both).high, f64::INFINITY);
    }

    proptest! {
        #[test]
        fn true_sums_and_products_are_inside(a in -1e6_f32..1e6, b in -1e6_f32..1e6, c in -1_f32..1.) {
            // 24-bit numbers, so that no bits are lost below 2^-100.
            let [a, b, c] = [a, b, c].map(|x| f64::from((x * 1e5).round()));
            let [x, y, z] = [a, b, c].map(Interval::point);
            let found = (x * y + z) * x - y * z;
            let shift = 200;
            let big = |x: f64| BigInt::from(x as i64);
            let expected = ((big(a) * big(b) + big(c)) * big(a) - big(b) * big(c)) << 100;
            prop_assert!(whole(found.low) <= expected && expected <= whole(found.high), "{shift}");
            let root = x.square().sqrt();
            prop_assert!(root.low <= a.abs() && a.abs() <= root.high);
        }
    }
}
