//! Rows of double precision: as little as the decision about hits needs.

use super::{F32x16, F64x8, Mask, WideMask};
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
    /// The result of comparisons.
    type Mask: Mask;

    /// `x` in every lane.
    fn splat(x: f64) -> Self;
    /// Square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
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
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
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
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        wide::Select::select(mask.0, yes, no)
    }
}

/// The first eight numbers of a column, in double precision.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn load_doubles(column: &[f32]) -> F64x8 {
    exact(column.first_chunk().expect("columns hold whole rows"))
}

/// Eight numbers in double precision. Not by `map`, which may become a call and a way through memory.
#[inline(always)]
fn exact(row: &[f32; 8]) -> F64x8 {
    let mut doubles = [0.0; 8];
    for (double, &single) in doubles.iter_mut().zip(row) {
        *double = f64::from(single);
    }
    F64x8::new(doubles)
}

/// Writes numbers to the first eight places of a column, rounded to single precision.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn store_rounded(row: F64x8, column: &mut [f32]) {
    column[..8].copy_from_slice(&rounded(row));
}

#[inline(always)]
fn rounded(row: F64x8) -> [f32; 8] {
    let mut singles = [0.0; 8];
    for (single, double) in singles.iter_mut().zip(row.to_array()) {
        *single = double as f32;
    }
    singles
}

/// Writes the lanes in which `mask` is true to the first eight places of a column.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn store_where(mask: WideMask<F64x8>, row: F64x8, column: &mut [f64]) {
    let place: &mut [f64; 8] = column.first_chunk_mut().expect("columns hold whole rows");
    *place = wide::Select::select(mask.0, row, F64x8::new(*place)).to_array();
}

/// Rounds two rows of eight to one of sixteen.
#[inline(always)]
pub fn narrow([low, high]: [F64x8; 2]) -> F32x16 {
    bytemuck::cast([rounded(low), rounded(high)])
}

/// Returns the numbers in double precision.
#[inline(always)]
pub fn widen(row: F32x16) -> [F64x8; 2] {
    let [low, high]: [[f32; 8]; 2] = bytemuck::cast(row);
    [exact(&low), exact(&high)]
}
