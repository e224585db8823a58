//! One numeric type for every width.
//!
//! Kernels are written once, over `L: Lanes`. `f32` is the one-lane case: it is the scalar tracer,
//! the fallback and the oracle that the wide ones are tested against. This is the only module
//! that names `wide`.
//!
//! Everything here rounds each lane as IEEE 754 says, without horizontal operations, so a lane's
//! result depends neither on how many lanes there are nor on the processor. `#[inline(always)]` is on everything that
//! takes or returns lanes here and in the kernels, because a wide value that crosses a real call
//! goes through memory. Long functions that several kernels call once for a row are not inlined: a copy in each would be
//! no faster, and take longer to compile.

mod across;
mod bits;
mod doubles;
mod fused;
mod masks;

pub use across::{
    Packing, columns_of, columns_of_points, greatest_of, least_lane, look_up, reverse_bits,
    shuffle, shuffle_numbers, transpose, truncated,
};
pub use bits::{bits, bits_of, first_lanes, numbers, set_bits};
pub use doubles::{Doubles, load_doubles, narrow, store_rounded, store_where, widen};
use masks::places;
pub use masks::{Mask, WideMask};
use std::ops::{Add, Div, Mul, Neg, Sub};
pub use wide::{
    f32x4 as F32x4, f32x8 as F32x8, f32x16 as F32x16, f64x8 as F64x8, u32x16 as U32x16,
};

/// The widest packet there is; columns of rays are padded to a multiple of it.
pub const MAX_LANES: usize = 16;

/// A row of `f32` values, one per ray.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
{
    /// Number of lanes: 1, 4, 8 or 16.
    const WIDTH: usize;
    /// The result of comparisons.
    type Mask: Mask;

    /// `x` in every lane.
    fn splat(x: f32) -> Self;
    /// The first `WIDTH` values of `column`.
    ///
    /// # Panics
    /// If there are fewer.
    fn load(column: &[f32]) -> Self;
    /// Writes the lanes to the first `WIDTH` places of `row`.
    ///
    /// # Panics
    /// If there are fewer.
    fn store(self, row: &mut [f32]);
    /// `self * factor + term`, rounded once on every processor.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `self * factor + term`, rounded once where the processor has an instruction for it, and twice
    /// elsewhere: for bounds that hold in both cases, and for nothing that an image shows.
    #[inline(always)]
    fn relaxed_mul_add(self, factor: Self, term: Self) -> Self {
        if fused::IN_HARDWARE { self.mul_add(factor, term) } else { self * factor + term }
    }
    /// Square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The lesser; `other` if either is NaN.
    fn min(self, other: Self) -> Self;
    /// The greater; `other` if either is NaN.
    fn max(self, other: Self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// True where the sign bit is set, also for -0.
    fn is_negative(self) -> Self::Mask;
    /// The greatest lanes of four parts.
    fn greatest_four(self) -> F32x4;
    /// The greatest lane.
    #[inline(always)]
    fn greatest(self) -> f32 {
        let [a, b, c, d] = self.greatest_four().to_array();
        Lanes::max(Lanes::max(a, b), Lanes::max(c, d))
    }
    /// True where all bits are equal, for lanes that hold other data than numbers.
    fn has_bits_of(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// True in lane `i` if bit `i` is set.
    fn lanes(bits: u32) -> Self::Mask;
    /// The first `WIDTH` values of a column of double precision, rounded to the nearest.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    fn load_rounded(column: &[f64]) -> Self {
        let mut row = [0.0; MAX_LANES];
        for (lane, &x) in row.iter_mut().zip(&column[..Self::WIDTH]) {
            *lane = x as f32;
        }
        Self::load(&row)
    }
    /// Lanes `first..first + 8` in double precision; 0 for those that there are not.
    #[inline(always)]
    fn doubles(self, first: usize) -> F64x8 {
        let mut row = [0.0; MAX_LANES];
        self.store(&mut row);
        load_doubles(&row[first..])
    }
}

impl Lanes for f32 {
    const WIDTH: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        x
    }
    #[inline(always)]
    fn load(column: &[f32]) -> Self {
        column[0]
    }
    #[inline(always)]
    fn store(self, row: &mut [f32]) {
        row[0] = self;
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        // Without the instruction, the standard library's is a call.
        if fused::IN_HARDWARE {
            Self::mul_add(self, factor, term)
        } else {
            fused::mul_add(self, factor, term)
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self.is_sign_negative()
    }
    #[inline(always)]
    fn greatest_four(self) -> F32x4 {
        F32x4::splat(self)
    }
    #[inline(always)]
    fn greatest(self) -> f32 {
        self
    }
    #[inline(always)]
    fn has_bits_of(self, other: Self) -> bool {
        self.to_bits() == other.to_bits()
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn lanes(bits: u32) -> bool {
        bits & 1 == 1
    }
}

macro_rules! impl_lanes {
    ($($wide:ident, $integers:ident: $width:literal),+ $(,)?) => {$(
        impl Mask for WideMask<wide::$wide> {
            #[inline(always)]
            fn bits(self) -> u32 {
                self.0.to_bitmask()
            }
        }

        impl Lanes for wide::$wide {
            const WIDTH: usize = $width;
            type Mask = WideMask<Self>;

            #[inline(always)]
            fn splat(x: f32) -> Self {
                Self::splat(x)
            }
            #[inline(always)]
            fn load(column: &[f32]) -> Self {
                let row: &[f32; $width] = column.first_chunk().expect("columns hold whole rows");
                Self::new(*row)
            }
            #[inline(always)]
            fn store(self, row: &mut [f32]) {
                row[..$width].copy_from_slice(&self.to_array());
            }
            #[inline(always)]
            #[expect(clippy::disallowed_methods, reason = "where there is an instruction, it is rounded once")]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                if fused::IN_HARDWARE {
                    self.mul_add(factor, term)
                } else {
                    let rows = [self, factor, term].map(Self::to_array);
                    Self::new(fused::mul_add_row(rows[0], rows[1], rows[2]))
                }
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
            fn min(self, other: Self) -> Self {
                // Only the instructions of x86 define which of two zeros, or of a number and NaN, is the
                // lesser.
                if cfg!(target_arch = "x86_64") {
                    self.fast_min(other)
                } else {
                    wide::Select::select(self.simd_lt(other), self, other)
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if cfg!(target_arch = "x86_64") {
                    self.fast_max(other)
                } else {
                    wide::Select::select(self.simd_gt(other), self, other)
                }
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                WideMask(self.simd_lt(other))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                WideMask(self.simd_le(other))
            }
            #[inline(always)]
            fn is_negative(self) -> Self::Mask {
                WideMask(self.is_sign_negative())
            }
            #[inline(always)]
            fn has_bits_of(self, other: Self) -> Self::Mask {
                let bits = |lanes: Self| -> wide::$integers { bytemuck::cast(lanes) };
                WideMask(bytemuck::cast(bits(self).simd_eq(bits(other))))
            }
            #[inline(always)]
            fn greatest_four(self) -> F32x4 {
                let quarters: [F32x4; $width / 4] = bytemuck::cast(self);
                quarters.into_iter().reduce(Lanes::max).unwrap_or(F32x4::splat(f32::NAN))
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                wide::Select::select(mask.0, yes, no)
            }
            #[inline(always)]
            fn lanes(bits: u32) -> Self::Mask {
                const BITS: wide::$integers = wide::$integers::new(places());
                let set = wide::$integers::splat(bits as i32) & BITS;
                WideMask(bytemuck::cast(set.simd_eq(BITS)))
            }
        }
    )+};
}

impl_lanes! { f32x4, i32x4: 4, f32x8, i32x8: 8, f32x16, i32x16: 16 }

#[cfg(test)]
mod tests;
