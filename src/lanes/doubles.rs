//! Rows of double precision: as little as the decision about hits needs.

use super::{F64x8, Mask, WideMask};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A row of `f64` values, as little as the decision about hits needs.
pub trait Doubles:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// What comparisons return.
    type Mask: Mask;

    /// `x` in every lane.
    fn splat(x: f64) -> Self;
    /// Square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
}

impl Doubles for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
}

impl Mask for WideMask<F64x8> {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bitmask()
    }
}

impl Doubles for F64x8 {
    type Mask = WideMask<Self>;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self::splat(x)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        WideMask(self.simd_lt(other))
    }
}
