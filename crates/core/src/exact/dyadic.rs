//! Numbers that never round: whole multiples of powers of two.

use crate::elementary::power_of_two;
use num_bigint::{BigInt, Sign};
use std::ops::{Add, Mul, Neg, Sub};

/// A whole number times a power of two.
#[derive(Clone, Debug)]
pub(super) struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    /// A finite number, exactly.
    pub(super) fn new(x: f64) -> Self {
        let bits = x.to_bits();
        let biased = (bits >> 52 & 0x7ff) as i64;
        let fraction = bits & ((1 << 52) - 1);
        // Subnormal numbers have the least exponent and no hidden bit.
        let (fraction, biased) =
            if biased == 0 { (fraction, 1) } else { (fraction | 1 << 52, biased) };
        let mantissa = BigInt::from(fraction);
        let mantissa = if x.is_sign_negative() { -mantissa } else { mantissa };
        Self { mantissa, exponent: biased - 1075 }
    }

    /// -1, 0 or 1.
    pub(super) fn sign(&self) -> i32 {
        match self.mantissa.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    /// Times itself.
    pub(super) fn square(&self) -> Self {
        self * self
    }

    /// Both mantissas at the lower one's exponent.
    fn aligned(&self, other: &Self) -> (BigInt, BigInt, i64) {
        let exponent = self.exponent.min(other.exponent);
        let shifted = |x: &Self| &x.mantissa << (x.exponent - exponent) as u64;
        (shifted(self), shifted(other), exponent)
    }

    /// The nearest number of double precision, but for one unit of its last place; infinite or 0
    /// beyond its range.
    pub(super) fn to_f64(&self) -> f64 {
        let surplus = self.mantissa.bits().saturating_sub(64);
        let top = &self.mantissa >> surplus;
        let top = i128::try_from(&top).unwrap_or(0) as f64;
        let exponent = self.exponent + surplus as i64;
        // In two steps, neither of which leaves the range where the result does not.
        let half = exponent.clamp(-2000, 2000) as i32 / 2;
        let rest = exponent.clamp(-2000, 2000) as i32 - half;
        top * power_of_two(half) * power_of_two(rest)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: Self) -> Dyadic {
        let (a, b, exponent) = self.aligned(other);
        Dyadic { mantissa: a + b, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: Self) -> Dyadic {
        let (a, b, exponent) = self.aligned(other);
        Dyadic { mantissa: a - b, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: Self) -> Dyadic {
        let mantissa = &self.mantissa * &other.mantissa;
        Dyadic { mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Neg for Dyadic {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, exponent: self.exponent }
    }
}

/// Scalar product.
pub(super) fn dot(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(x: f64) -> Dyadic {
        Dyadic::new(x)
    }

    #[test]
    fn numbers_go_in_and_out_unchanged() {
        for x in [0.0, 1.0, -1.5, 1e300, 1e-300, 5e-324, -f64::MAX, 0.1, 1.0 + f64::EPSILON] {
            assert_eq!(number(x).to_f64(), x);
        }
    }

    #[test]
    fn arithmetic_does_not_round() {
        let tiny = number(1e-200);
        let sum = &number(1e200) + &tiny;
        assert_eq!((&sum - &number(1e200)).to_f64(), 1e-200);
        assert_eq!((&tiny.square() - &tiny.square()).sign(), 0);
        assert!(tiny.square().sign() > 0);
    }
}
