//! Numbers that never round: whole multiples of powers of two.

use crate::elementary::power_of_two;
use num_bigint::{BigInt, Sign};
use std::ops::{Add, Mul, Neg, Sub};

/// A whole number times a power of two.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    /// A finite number, exactly.
    pub(crate) fn new(x: f64) -> Self {
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
    pub(crate) fn sign(&self) -> i32 {
        match self.mantissa.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    /// Times itself.
    pub(crate) fn square(&self) -> Self {
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
    pub(crate) fn to_f64(&self) -> f64 {
        let surplus = self.mantissa.bits().saturating_sub(64);
        let top = &self.mantissa >> surplus;
        let top = i128::try_from(&top).unwrap_or(0) as f64;
        times_power(top, self.exponent + surplus as i64)
    }
}

/// `x` times a power of two, in two steps, neither of which leaves the range where the result does not.
fn times_power(x: f64, exponent: i64) -> f64 {
    let exponent = exponent.clamp(-2000, 2000) as i32;
    let half = exponent / 2;
    x * power_of_two(half) * power_of_two(exponent - half)
}

/// A number `sign sqrt(radicand)`; the sign is -1, 0 or 1, the radicand not negative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignedRoot<'a> {
    pub(crate) sign: i32,
    pub(crate) radicand: &'a Dyadic,
}

/// The nearest number of double precision to `(b + root) / a`, which is positive and in the range
/// of normal numbers; of two that are equally near the even one. `a` is positive.
pub(super) fn nearest_root(a: &Dyadic, b: &Dyadic, root: SignedRoot) -> f64 {
    /// Bits of the quotient: those of the result, one to round by, and one that says whether more follow.
    const BITS: u64 = 55;
    let SignedRoot { sign, radicand: q } = root;
    // Binary places with which `b` and `q` are whole.
    let mut places = (-b.exponent).max((1 - q.exponent).div_euclid(2));
    loop {
        let whole = |x: &Dyadic, places: i64| &x.mantissa << (x.exponent + places) as u64;
        let square = whole(q, 2 * places);
        let root = square.sqrt();
        let rounded = &root * &root != square;
        // Rounded down, so that the quotient is as well.
        let root = if sign < 0 { -(root + i32::from(rounded)) } else { root };
        let sum = whole(b, places) + root;
        let quotient = &sum / &a.mantissa;
        let bits = quotient.bits();
        if bits >= BITS {
            let surplus = bits - BITS;
            let inexact = rounded || &quotient * &a.mantissa != sum;
            let more = inexact || quotient.trailing_zeros().is_some_and(|zeros| zeros < surplus);
            let top = u64::try_from(quotient >> surplus).unwrap_or(0) << 1 | u64::from(more);
            return times_power(top as f64, surplus as i64 - 1 - places - a.exponent);
        }
        places += (BITS + 1 - bits) as i64;
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
pub(crate) fn dot(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

/// Vector product.
pub(crate) fn cross(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
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
