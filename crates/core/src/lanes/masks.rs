//! Truth values of lanes.

use std::ops::{BitAnd, BitOr, Not};

/// One truth value per lane.
pub trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> + Send + Sync
{
    /// Bit `i` is set if lane `i` is true.
    fn bits(self) -> u32;
}

impl Mask for bool {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

/// A comparison's result: all bits of a lane set, or none. A type of its own, so that masks cannot
/// be added up by mistake.
#[derive(Clone, Copy, Debug)]
pub struct WideMask<W>(pub(super) W);

impl<W: BitAnd<Output = W>> BitAnd for WideMask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl<W: BitOr<Output = W>> BitOr for WideMask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl<W: Not<Output = W>> Not for WideMask<W> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// In place `i` the bit of lane `i`.
pub(super) const fn places<const WIDTH: usize>() -> [i32; WIDTH] {
    let (mut row, mut i) = ([0; WIDTH], 0);
    while i < WIDTH {
        row[i] = 1 << i;
        i += 1;
    }
    row
}
