//! Numbers with a bound of their error, kept up by every operation (running error analysis: Higham, "Accuracy and Stability
//! of Numerical Algorithms", 2002, section 3.3).

use glam::DVec3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Relative errors of distances above this are not put up with.
pub(crate) const COARSE: f64 = 1.0 / (1 << 30) as f64;

/// Twice the unit roundoff: room for the rounding of the bounds.
const ROUNDING: f64 = f64::EPSILON;

/// Factor that outweighs the rounding of a bound.
const GROWTH: f64 = 1.0 + 8.0 * f64::EPSILON;

/// More than any operation may lose to underflow.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;

/// A number, and a bound of its error; infinite or NaN where nothing is known.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    /// The number.
    pub(crate) value: f64,
    /// A bound of its error.
    pub(crate) error: f64,
}

impl Bounded {
    /// A number without error.
    #[inline(always)]
    pub(crate) fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// A rounded result, with the error that its operands bring.
    #[inline(always)]
    fn rounded(value: f64, error: f64) -> Self {
        Self { value, error: (error + value.abs() * ROUNDING) * GROWTH + UNDERFLOW }
    }

    /// -1 or 1 where the sign is certain.
    #[inline(always)]
    pub(crate) fn sign(self) -> Option<i32> {
        if self.value > self.error {
            Some(1)
        } else if self.value < -self.error {
            Some(-1)
        } else {
            None
        }
    }

    /// The square root of a number that is known to be positive.
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        // |sqrt(x) - sqrt(y)| = |x - y| / (sqrt(x) + sqrt(y)).
        let root = self.value.sqrt();
        Self::rounded(root, self.error / root)
    }

    /// The square.
    #[inline(always)]
    pub(crate) fn square(self) -> Self {
        self * self
    }
}

impl Add for Bounded {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::rounded(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Bounded {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Bounded {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

impl Mul for Bounded {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let error = self.value.abs() * other.error
            + other.value.abs() * self.error
            + self.error * other.error;
        Self::rounded(self.value * other.value, error)
    }
}

impl Div for Bounded {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, least) = (self.value / other.value, other.value.abs() - other.error);
        if least > 0.0 {
            Self::rounded(quotient, (self.error + quotient.abs() * other.error) / least)
        } else {
            Self { value: quotient, error: f64::INFINITY }
        }
    }
}

/// A vector of bounded numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundedVector(pub(super) [Bounded; 3]);

impl BoundedVector {
    /// A vector without error.
    #[inline(always)]
    pub(crate) fn exact(v: DVec3) -> Self {
        Self(v.to_array().map(Bounded::exact))
    }

    /// The difference of two vectors without error.
    #[inline(always)]
    pub(crate) fn between(from: DVec3, to: DVec3) -> Self {
        let (from, to) = (Self::exact(from), Self::exact(to));
        Self(std::array::from_fn(|i| to.0[i] - from.0[i]))
    }

    /// Scalar product.
    #[inline(always)]
    pub(crate) fn dot(&self, other: &Self) -> Bounded {
        let [x, y, z] = std::array::from_fn(|i| self.0[i] * other.0[i]);
        x + y + z
    }

    /// Vector product.
    #[inline(always)]
    pub(crate) fn cross(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.0[j] * other.0[k] - self.0[k] * other.0[j]
        }))
    }
}
